//! `run.json`: what was done with what, so that it can be done again.

use std::io::Write as _;

use serde_json::{Map, Value, json};

use super::parameters::parameters;
use crate::model::{LoadedFile, format_name};
use crate::study::folder::Folder;
use crate::study::results::Results;

/// Writes it. The files it names are those that `folder` has so far.
pub(super) fn write(results: &Results, folder: &mut Folder) -> anyhow::Result<()> {
    let parameters: Map<String, Value> =
        parameters(results).into_iter().map(|(name, value)| (name.to_ascii_lowercase(), value.into())).collect();
    let sums = || results.states.iter().flat_map(|state| &state.sums).flatten();
    let [error_largest_s, error_mean_s] = results.error_bounds_s();
    let groups: Vec<Value> = (results.receivers.groups.iter())
        .map(|group| json!({ "name": group.name, "on": super::receivers_csv::on(group), "receivers": group.range.len() }))
        .collect();
    let run = json!({
        "models": results.models.files.iter().map(model).collect::<Vec<_>>(),
        "software": concat!("umbrae ", env!("CARGO_PKG_VERSION")),
        "partial": results.is_partial,
        "inputs": results.inputs,
        "options": results.options,
        "parameters": parameters,
        "receivers": {
            "count": results.receivers.len(),
            "inside_solids": results.last().map_or(0, |state| state.is_inside.iter().filter(|&&inside| inside).count()),
            "computed": sums().count(),
            "groups": groups,
        },
        "states": results.states.iter().map(|state| state.name).collect::<Vec<_>>(),
        "triangles": results.models.scene.triangle_count(),
        "undecided_verdicts": sums().map(|sum| u64::from(sum.undecided)).sum::<u64>(),
        "error_bound_s": { "largest": error_largest_s, "mean": error_mean_s },
        "check": results.check,
        "verdicts": results.verdicts,
        "timings": results.timings,
        "threads": rayon::current_num_threads(),
        "warnings": results.warnings,
        "files": folder.names(),
    });
    let text = serde_json::to_string_pretty(&run)?;
    folder.write("run.json", |file| Ok(writeln!(file, "{text}")?))
}

fn model(file: &LoadedFile) -> Value {
    json!({
        "path": file.path,
        "format": format_name(file.format),
        "crs": file.crs.as_ref().map(|crs| format!("EPSG:{}", crs.epsg())),
        "source_crs": file.source_crs.as_ref().map(|crs| format!("EPSG:{}", crs.epsg())),
        "warnings": file.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}
