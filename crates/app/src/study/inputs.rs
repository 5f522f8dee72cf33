//! What a study is made of, by hashes: files for those who want to do it again, and all that the engine is given for resuming.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use anyhow::Context as _;
use bytemuck::cast_slice;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

use super::results::{Input, Results};
use crate::cast::Pattern;
use crate::cli::StudyArgs;

/// Bytes that are read at once.
const CHUNK_BYTES: usize = 1 << 16;

/// Every file that `args` name, with its hash.
///
/// # Errors
///
/// When one can't be read.
pub(super) fn inputs(args: &StudyArgs) -> anyhow::Result<Vec<Input>> {
    let models = args.models.iter().map(|path| (path, "model"));
    let existing = args.existing.iter().map(|path| (path, "existing"));
    let proposed = args.proposed.iter().map(|path| (path, "proposed"));
    let points = args.points.iter().map(|path| (path, "points"));
    models.chain(existing).chain(proposed).chain(points).map(|(path, role)| input(path, role)).collect()
}

fn input(path: &Path, role: &'static str) -> anyhow::Result<Input> {
    let cant = || format!("can't read `{}`", path.display());
    let mut file = File::open(path).with_context(cant)?;
    let (mut hasher, mut bytes) = (Sha256::new(), 0);
    let mut chunk = vec![0; CHUNK_BYTES];
    loop {
        let count = file.read(&mut chunk).with_context(cant)?;
        if count == 0 {
            break;
        }
        hasher.update(&chunk[..count]);
        bytes += count as u64;
    }
    Ok(Input { path: path.to_owned(), role, bytes, sha256: hex(&hasher.finalize()) })
}

/// What was asked, as it is reported.
pub(super) fn options(args: &StudyArgs) -> Value {
    json!({
        "spacing": args.spacing,
        "on": args.on.iter().map(|on| on.name()).collect::<Vec<_>>(),
        "cast": args.cast.iter().map(Pattern::text).collect::<Vec<_>>(),
        "no_cast": args.no_cast.iter().map(Pattern::text).collect::<Vec<_>>(),
        "glass_casts": args.glass_casts,
        "check": args.check,
        "ground": args.ground,
        "refine": args.refine,
        "dates": args.period.all_dates().iter().map(ToString::to_string).collect::<Vec<_>>(),
        "geometric": args.period.geometric,
        "lat": args.place.lat,
        "lon": args.place.lon,
        "min_altitude_deg": args.period.min_altitude,
        "north_deg": args.north,
        "solar_time": args.period.solar_time,
        "sun_disc": args.sun_disc,
        "step_s": args.period.step.as_secs_f64(),
        "tz": args.place.tz.as_ref().map(umbrae_study::Zone::name),
        "by_object": args.by_object,
        "rules": args.rules,
        "threads": args.threads,
        "resume": args.resume,
    })
}

/// Stands for everything that rows and sums depend on: what casts, who receives, when.
pub(super) fn key(results: &Results, inside: &[Vec<bool>]) -> String {
    let mut hasher = Sha256::new();
    hasher.update(env!("CARGO_PKG_VERSION"));
    for (caster, when) in results.models.casters.iter().zip(&results.models.when) {
        hasher.update([*when as u8, u8::from(caster.role.casts)]);
        hasher.update(cast_slice(&caster.positions));
        hasher.update(cast_slice(caster.mesh.triangles()));
    }
    for step in &results.timetable.steps {
        let time = [step.start, step.end].map(jiff::Timestamp::as_nanosecond);
        hasher.update(cast_slice(&time));
    }
    hasher.update([u8::from(results.refinement.is_some())]);
    hasher.update([u8::from(results.disc.is_some())]);
    for sun in results.disc.iter().flat_map(|disc| &disc.suns) {
        hasher.update(cast_slice(&sun.unwrap_or_default().to_array()));
    }
    for sun in &results.suns {
        hasher.update(cast_slice(&sun.unwrap_or_default().to_array()));
    }
    hasher.update(cast_slice(&results.receivers.positions));
    hasher.update(cast_slice(&results.receivers.normals));
    for inside in inside {
        hasher.update(cast_slice(&inside.iter().map(|&inside| u8::from(inside)).collect::<Vec<_>>()));
    }
    hex(&hasher.finalize())
}

pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
