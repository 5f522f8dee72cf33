//! How time grows with triangles: one model, made finer and finer.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use anyhow::ensure;
use glam::DAffine3;
use umbrae_core::{Caster, Finder, Mesh, Object, Topology};

use super::finer::Finer;
use super::lights::Lights;
use super::plot::{self, Line};
use super::{casters, memory, on_cpu};
use crate::cli::SilhouettesArgs;
use crate::output::{Output, write_to_stdout};
use crate::talk::Talk;

/// Five, from ten thousand to a million.
const SIZES: [usize; 5] = [10_000, 31_622, 100_000, 316_228, 1_000_000];
/// A line needs two points, and no fewer of them are a trend.
const LEAST_SIZES: usize = 3;

/// Measures the only model of `args` at ever more triangles, prints a table and draws it to `plot`.
///
/// # Errors
///
/// When there are several models, or one that can't be read or is too large to be made finer; or the plot can't be written.
pub(super) fn run(args: &SilhouettesArgs, plot: &Path, talk: &Talk) -> anyhow::Result<()> {
    let [path] = args.models.as_slice() else {
        anyhow::bail!("--grow makes one model finer, and {} are given", args.models.len());
    };
    let output = Output::create(plot)?;
    ensure!(!output.is_file_at(path), "--grow would overwrite the model `{}`; give another name", path.display());
    let mut finer = joined(&casters(path, args, talk)?);
    let sizes: Vec<usize> = SIZES.into_iter().filter(|&size| size >= finer.len()).collect();
    let most = SIZES[SIZES.len() - LEAST_SIZES];
    let count = finer.len();
    ensure!(
        sizes.len() >= LEAST_SIZES,
        "`{}` has {count} triangles, too many to grow to a million; give one of at most {most}",
        path.display()
    );
    let mut lines: Vec<Line> = Vec::new();
    let bar = talk.progress("measuring", sizes.len() as u64);
    for size in sizes {
        finer.refine_to(size);
        let mesh = Arc::new(Mesh::new(finer.surface())?);
        let topology = Arc::new(Topology::new(&mesh));
        let caster = Caster::new(&Object::new("grown", mesh, DAffine3::IDENTITY), topology);
        let casters = [caster];
        let lights = Lights::new(&casters, args.lights as usize);
        let (times, _) = on_cpu::measure(&casters, &lights, Finder::new)?;
        for (i, time) in times.iter().enumerate() {
            if i == lines.len() {
                lines.push(Line { name: time.label(), points: Vec::new() });
            }
            ensure!(time.is_equal, "{} does not find at {size} triangles what the scan finds", time.name);
            lines[i].points.push([finer.len() as f64, time.us.median]);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    output.finish(plot::svg(&lines).into_bytes())?;
    write_to_stdout(table(path, count, &lines).as_bytes())
}

/// All of `casters` as one, where they are.
fn joined(casters: &[Caster]) -> Finer {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for caster in casters {
        let first = positions.len() as u32;
        positions.extend_from_slice(&caster.positions);
        triangles.extend(caster.mesh.triangles().iter().map(|corners| corners.map(|v| first + v)));
    }
    Finer::new(positions, triangles)
}

fn table(path: &Path, triangles: usize, lines: &[Line]) -> String {
    let mut text = format!("`{}` of {triangles} triangles, made finer; median us for each light\n", path.display());
    let _ = write!(text, "{:<20}", "triangles");
    for [size, _] in lines.iter().take(1).flat_map(|line| &line.points) {
        let _ = write!(text, " {size:>10}");
    }
    text.push_str("  grows with n to the\n");
    for line in lines {
        let _ = write!(text, "{:<20}", line.name);
        for [_, us] in &line.points {
            let _ = write!(text, " {us:>10.1}");
        }
        let _ = writeln!(text, "  {:.2}", line.exponent());
    }
    if let Some(bytes) = memory::peak_bytes() {
        let _ = writeln!(text, "peak memory so far: {:.0} MiB", bytes as f64 / f64::from(1 << 20));
    }
    text
}
