//! The solar tables, which live beside the project.

#![expect(clippy::print_stdout, reason = "a skipped test must say so")]

use std::path::Path;

/// What is in the file `name` of the solar tables; `None`, said aloud, in a user's checkout, which has none.
pub(crate) fn solar(name: &str) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/solar");
    if folder.is_dir() {
        return Some(std::fs::read_to_string(folder.join(name)).expect("the data folder is complete"));
    }
    assert!(std::env::var_os("CI").is_none(), "the data folder {} is missing", folder.display());
    println!("skipped: there is no data folder {}", folder.display());
    None
}

/// The fields of the rows of a table, without its comments.
pub(crate) fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table.lines().filter(|line| !line.is_empty() && !line.starts_with('#')).map(|line| line.split(',').collect())
}
