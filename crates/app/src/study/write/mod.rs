//! The files of a study, one writer each.

mod bits;
mod footprints;
mod geotiff;
mod legend;
mod maps;
mod moving;
mod parameters;
mod perspective;
mod receivers_csv;
mod report;
mod run_json;
mod shadows_geojson;
mod sheet;
mod tables;

use std::sync::atomic::{AtomicBool, Ordering};

use super::folder::Folder;
use super::results::Results;
use crate::talk::Talk;

use self::footprints::footprints;
use self::shadows_geojson::Shadows;

/// Pictures for the report, besides maps.
#[derive(Debug, Default)]
pub(super) struct Shown {
    /// Plans, in the order in which they are to be seen.
    maps: Vec<maps::NamedMap>,
    /// Views, where there is an adapter to draw them.
    perspectives: Vec<perspective::Perspective>,
}

/// Writes everything but the report and `run.json`; adds to the warnings of `results` what could not be written. When `stop` is set, what takes long is left
/// out.
///
/// # Errors
///
/// When a file can't be written.
pub(super) fn write_all(
    results: &mut Results,
    wants: Wants,
    folder: &mut Folder,
    stop: &AtomicBool,
    talk: &Talk,
) -> anyhow::Result<Shown> {
    let mut said = Vec::new();
    let footprints = footprints(results);
    for state in &results.states {
        geotiff::write_hours(results, state, folder)?;
        bits::write(results, state, folder)?;
        bits::write_fractions(results, state, folder)?;
    }
    geotiff::write_difference(results, folder)?;
    receivers_csv::write(results, folder)?;
    tables::write(results, folder)?;
    let mut shadows: Vec<Option<Shadows>> = Vec::new();
    for state in results.states.iter().filter(|_| !stop.load(Ordering::Relaxed)) {
        shadows.push(shadows_geojson::write(results, state, folder, &mut said)?);
    }
    let last_shadows = shadows.pop().flatten().filter(|_| wants.by_object);
    let mut maps = maps::write(results, &footprints, last_shadows.as_ref(), folder)?;
    if let Some(state) = results.last() {
        maps.extend(moving::write(results, state, &footprints, folder)?);
    }
    let mut perspectives = Vec::new();
    if let Some(state) = results.last().filter(|_| wants.perspective && !stop.load(Ordering::Relaxed)) {
        match perspective::write(results, state, folder) {
            Ok(drawn) => perspectives = drawn,
            // All else is there without.
            Err(error) => talk.note(&format!("no perspective picture: {error:#}")),
        }
    }
    for warning in said {
        talk.warning(&warning);
        results.warnings.push(warning);
    }
    Ok(Shown { maps, perspectives })
}

/// What is written only if it is asked for, or unless it is not.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wants {
    /// The profile in the colours of objects.
    pub(super) by_object: bool,
    /// A picture that needs an adapter.
    pub(super) perspective: bool,
}

/// Writes the report, and last what was done and how long it took, as that names the other files.
///
/// # Errors
///
/// When one can't be written.
pub(super) fn write_report(results: &Results, shown: &Shown, folder: &mut Folder) -> anyhow::Result<()> {
    report::write(results, shown, folder)?;
    run_json::write(results, folder)
}
