//! The real models that lie beside the project.

use std::path::{Path, PathBuf};

/// The folder of the models. Without it a test has nothing to do, which is a failure where CI is set.
#[expect(clippy::print_stderr, reason = "a test that does nothing says so")]
pub(crate) fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "there is no {}", folder.display());
    eprintln!("skipped: there is no {}", folder.display());
    None
}
