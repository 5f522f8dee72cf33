//! The files of a study, one writer each.

mod footprints;
mod geotiff;
mod legend;
mod maps;
mod parameters;
mod receivers_csv;
mod run_json;
mod sheet;

use crate::talk::Talk;

use super::folder::Folder;
use super::results::Results;

/// Writes everything there is to write about `results` into `folder`.
///
/// # Errors
///
/// When a file can't be written.
pub(super) fn write_all(results: &Results, folder: &mut Folder, _talk: &Talk) -> anyhow::Result<()> {
    for state in &results.states {
        geotiff::write_hours(results, state, folder)?;
    }
    receivers_csv::write(results, folder)?;
    maps::write(results, folder)?;
    Ok(())
}

/// Writes what was done and how long it took: last, as it names the other files.
///
/// # Errors
///
/// When it can't be written.
pub(super) fn write_run(results: &Results, folder: &mut Folder) -> anyhow::Result<()> {
    run_json::write(results, folder)
}
