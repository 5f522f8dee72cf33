//! The real models, which live beside the project.

#![expect(clippy::print_stdout, reason = "a skipped test must say so")]

use std::path::{Path, PathBuf};

/// The data folder; `None`, said aloud, in a user's checkout, which has none.
pub(crate) fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "the data folder {} is missing", folder.display());
    println!("skipped: there is no data folder {}", folder.display());
    None
}

/// Every model that should load: all of `gltf` and `mesh`, and the glTF files of `city`; in order.
pub(crate) fn models(folder: &Path) -> Vec<PathBuf> {
    let mut models = Vec::new();
    for (sub, endings) in [("gltf", &["glb", "gltf"][..]), ("mesh", &["obj", "ply", "stl"]), ("city", &["glb"])] {
        collect(&folder.join(sub), endings, &mut models);
    }
    models.sort();
    models
}

fn collect(folder: &Path, endings: &[&str], into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the data folder is complete") {
        let path = entry.expect("the data folder can be read").path();
        if path.is_dir() {
            collect(&path, endings, into);
        } else if path.extension().is_some_and(|e| endings.iter().any(|ending| e.eq_ignore_ascii_case(ending))) {
            into.push(path);
        }
    }
}
