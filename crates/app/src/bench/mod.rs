//! `umbrae bench`: how fast parts of this program are, on models of one's own.
//!
//! ```text
//!   lights   under which silhouettes are found          on_cpu   times of the finders on the CPU
//!   report   the table and the JSON                     on_gpu   and on the GPU
//!   memory   the most that this process has used        growth   of times with triangles
//!   finer    a model of more triangles                  plot     a picture of that
//!   smooth   frames with smooth silhouettes
//! ```

mod finer;
mod growth;
mod lights;
mod memory;
mod on_cpu;
mod on_gpu;
mod plot;
mod report;
mod smooth;

use std::path::Path;

use anyhow::ensure;
use umbrae_core::{Caster, Finder, FinderKind};
use umbrae_render::{AdapterChoice, Gpu};

use crate::cache::Cache;
use crate::cli::{BenchCommand, SilhouettesArgs};
use crate::model::load_one;
use crate::output::write_to_stdout;
use crate::talk::Talk;

use self::lights::Lights;
use self::report::ModelTimes;

/// Measures what `what` says, and prints it.
///
/// # Errors
///
/// When a model can't be read; then nothing is printed.
pub fn run(what: &BenchCommand, talk: &Talk) -> anyhow::Result<()> {
    match what {
        BenchCommand::Silhouettes(args) => match &args.grow {
            Some(plot) => growth::run(args, plot, talk),
            None => silhouettes(args, talk),
        },
        BenchCommand::Smooth(args) => smooth::run(args, talk),
    }
}

fn silhouettes(args: &SilhouettesArgs, talk: &Talk) -> anyhow::Result<()> {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()));
    let mut notes = Vec::new();
    if let Err(error) = &gpu {
        notes.push(format!("gpu and gpu-basic are left out: {error}"));
    }
    let mut measured = Vec::new();
    let cache = args.cache.as_deref().map(Cache::new).transpose()?;
    let make = |caster: &Caster, kind| match &cache {
        Some(cache) => cache.finder(caster, kind, talk),
        None => Finder::new(caster, kind),
    };
    for path in &args.models {
        let casters = casters(path, args, talk)?;
        measured.push(measure((path, &casters), args, make, gpu.as_ref().ok(), &mut notes)?);
    }
    // After all that can go wrong: an error is one sentence.
    notes.iter().for_each(|note| talk.note(note));
    let text = match (args.json, measured.as_slice()) {
        (true, [one]) => format!("{}\n", serde_json::to_string(&one.json())?),
        (true, several) => {
            let all: Vec<_> = several.iter().map(ModelTimes::json).collect();
            format!("{}\n", serde_json::to_string_pretty(&all)?)
        }
        (false, all) => all.iter().map(ModelTimes::table).collect::<Vec<_>>().join("\n"),
    };
    write_to_stdout(text.as_bytes())
}

fn casters(path: &Path, args: &SilhouettesArgs, talk: &Talk) -> anyhow::Result<Vec<Caster>> {
    let scene = load_one(path, &args.load.options(), talk)?.scene;
    ensure!(scene.triangle_count() > 0, "`{}` has no triangle, and so no silhouette", path.display());
    Ok(Caster::of_scene(&scene))
}

fn measure(
    (path, casters): (&Path, &[Caster]),
    args: &SilhouettesArgs,
    make: impl Fn(&Caster, FinderKind) -> Finder,
    gpu: Option<&Gpu>,
    notes: &mut Vec<String>,
) -> anyhow::Result<ModelTimes> {
    let lights = Lights::new(casters, args.lights as usize);
    let (mut finders, edges_between_faces) = on_cpu::measure(casters, &lights, make)?;
    for (gpu, way) in gpu.into_iter().flat_map(|gpu| on_gpu::SOURCES.map(|way| (gpu, way))) {
        match on_gpu::measure(gpu, casters, &lights.apart, way) {
            Ok(times) => finders.push(times),
            Err(error) => notes.push(format!("`{}`: {} is left out: {error:#}", path.display(), way.0)),
        }
    }
    Ok(ModelTimes {
        model: path.display().to_string(),
        adapter: gpu.map(|gpu| gpu.label.clone()),
        triangles: casters.iter().map(|caster| caster.mesh.triangles().len()).sum(),
        edges: casters.iter().map(|caster| caster.topology.edges().len()).sum(),
        edges_between_faces,
        lights: lights.apart.len(),
        minutes: lights.minutes.len(),
        finders,
        peak_bytes: memory::peak_bytes(),
    })
}
