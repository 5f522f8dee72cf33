//! A real city repeated to a million triangles, ten million receivers, 145 suns: how long it takes and how much memory.
//!
//! `cargo bench -p umbrae --bench big_city [THREADS]`; two threads unless others are asked for. The city is Delfshaven of the data folder; receivers are
//! in a square grid on the ground, those inside of houses marked; the suns are those of an equinox day in Berlin.

#![expect(clippy::print_stdout, reason = "the figures are what one runs this for")]

#[path = "../../study/examples/city/mod.rs"]
#[expect(dead_code, reason = "only its suns are used here")]
mod city;

use std::path::Path;
use std::sync::atomic::AtomicBool;

use anyhow::Context as _;
use glam::{DAffine3, DVec3};
use umbrae_core::{Caster, Object, Scene, SurfaceKind};
use umbrae_formats::{LoadOptions, load};
use umbrae_study::{Blockers, GroundGrid, GroundLevel, Packets, Receivers, Solids, Terrain, kind_of_triangles};
use web_time::Instant;

const TRIANGLES: usize = 1_000_000;
const RECEIVERS: f64 = 10e6;
const SUNS: usize = 145;

fn main() -> anyhow::Result<()> {
    // `cargo bench` adds options, of which there are none here.
    let threads = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(2);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/city/3-20-DELFSHAVEN.city.json");
    let start = Instant::now();
    let took = |what: &str, start: Instant| println!("  {what}: {:.2} s", start.elapsed().as_secs_f64());

    let scene = repeated(&load(&path, &LoadOptions::default())?.scene);
    let casters = Caster::of_scene(&scene);
    let bounds = scene.bounds();
    println!(
        "{} triangles, {:.0} by {:.0} m, {threads} thread(s)",
        scene.triangle_count(),
        bounds.size().x,
        bounds.size().y
    );
    took("load and repeat", start);

    let now = Instant::now();
    let kinds: Vec<Vec<SurfaceKind>> =
        casters.iter().map(|caster| kind_of_triangles(caster, &scene.materials)).collect();
    let size = bounds.size().truncate();
    let grid = GroundGrid::covering(
        bounds.min.truncate(),
        bounds.max.truncate(),
        (size.x * size.y / RECEIVERS).sqrt(),
        GroundLevel::of(&casters, &kinds).level,
    );
    let mut receivers = Receivers::default();
    receivers.add_ground(grid, &Terrain::new(&casters, &kinds), &Solids::new(&casters, &kinds));
    took("receivers, and which are inside of houses", now);
    let inside = receivers.is_inside.iter().filter(|&&inside| inside).count();
    println!("  {} receivers, {inside} of them inside", receivers.len());

    let now = Instant::now();
    let blockers = Blockers::new(&casters);
    took("tree and ray caster", now);
    let now = Instant::now();
    let packets = Packets::new(&receivers);
    took("packets", now);

    let now = Instant::now();
    let suns: Vec<_> = city::suns(SUNS).into_iter().map(Some).collect();
    let exposure = blockers
        .expose(&receivers, &packets, 0..packets.len(), &suns, &AtomicBool::new(false), || {})
        .context("nobody stops it")?;
    took("engine", now);
    let lit: u64 = exposure.lit.iter().map(|word| u64::from(word.count_ones())).sum();
    let verdicts = (receivers.len() - inside) as f64 * SUNS as f64;
    println!(
        "  {:.1} M verdicts/s; {:.1} % lit; {} undecided",
        verdicts / now.elapsed().as_secs_f64() / 1e6,
        100.0 * lit as f64 / verdicts,
        exposure.undecided.len()
    );
    let every = packets.len() * umbrae_study::PACKET / 1000;
    println!("  {:?}", blockers.check(&receivers, &packets, &exposure, &suns, every));
    took("all of it", start);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    println!("  most memory: {}", status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("not known here"));
    Ok(())
}

/// Copies of `scene` side by side, as many as make [`TRIANGLES`].
fn repeated(scene: &Scene) -> Scene {
    let size = scene.bounds().size();
    let copies = TRIANGLES.div_ceil(scene.triangle_count());
    let columns = (copies as f64).sqrt().ceil() as usize;
    let objects = (0..copies).flat_map(|copy| {
        let by = DVec3::new((copy % columns) as f64 * size.x, (copy / columns) as f64 * size.y, 0.0);
        let moved = move |object: &Object| Object {
            world_from_object: DAffine3::from_translation(by) * object.world_from_object,
            ..object.clone()
        };
        scene.objects.iter().map(moved)
    });
    Scene { objects: objects.collect(), ..scene.clone() }
}
