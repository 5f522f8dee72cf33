//! Times the engine on a city of boxes, and writes what it was asked and what it answered, for other programs to be asked the same.
//!
//! ```text
//! cargo run --release -p umbrae-study --example city_hours -- BOXES RECEIVERS SUNS [THREADS] [DIR]
//! ```
//!
//! The city: boxes of 12 triangles on a jittered 40 m grid, turned by up to 90 degrees, 10 to 26 m wide and 6 to 45 m high; receivers in a grid on the
//! ground over all of it; the sun of an equinox at 52.52 degrees north, from rise to set.

use std::error::Error;
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DVec2, DVec3, Vec3};
use umbrae_core::{Caster, Mesh, Object, Scene, shapes};
use umbrae_study::{Blockers, GroundGrid, Packets, Receivers, Solids, Terrain};
use web_time::Instant;

const CELL_M: f64 = 40.0;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, otherwise: usize| args.get(i).map_or(Ok(otherwise), |arg| arg.parse::<usize>());
    let (boxes, receivers, suns, threads) = (number(0, 500)?, number(1, 250_000)?, number(2, 145)?, number(3, 1)?);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;

    let casters = Caster::of_scene(&city(boxes));
    let suns = day(suns);
    let side = (boxes as f64).sqrt().ceil() * CELL_M;
    let spacing = side / (receivers as f64).sqrt();
    let grid = GroundGrid::covering(DVec2::ZERO, DVec2::splat(side), spacing * (1.0 + 1e-12), 0.0);
    let mut receivers = Receivers::default();
    // No solids: another program does not know them either.
    receivers.add_ground(grid, &Terrain::new(&[], &[]), &Solids::new(&[], &[]));

    let start = Instant::now();
    let blockers = Blockers::new(&casters);
    let prepare_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let packets = Packets::new(&receivers);
    let sort_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let lights: Vec<_> = suns.iter().copied().map(Some).collect();
    let exposure = blockers
        .expose(&receivers, &packets, 0..packets.len(), &lights, &AtomicBool::new(false), || {})
        .ok_or("stopped")?;
    let engine_s = start.elapsed().as_secs_f64();
    let tests = receivers.len() * suns.len();
    let lit: u64 = exposure.lit.iter().map(|word| u64::from(word.count_ones())).sum();
    writeln!(
        io::stdout(),
        "{{\"triangles\": {}, \"receivers\": {}, \"suns\": {}, \"threads\": {threads}, \"prepare_s\": {prepare_s:.4}, \"sort_s\": {sort_s:.4}, \
         \"engine_s\": {engine_s:.4}, \"million_tests_per_s\": {:.1}, \"lit\": {lit}, \"undecided\": {}}}",
        casters.iter().map(|c| c.mesh.triangles().len()).sum::<usize>(),
        receivers.len(),
        suns.len(),
        tests as f64 / engine_s / 1e6,
        exposure.undecided.len(),
    )?;
    if let Some(folder) = args.get(4) {
        write(Path::new(folder), &casters, &receivers, &suns, &packets, &exposure)?;
    }
    Ok(())
}

/// Raw little-endian arrays: `triangles.f32` (9 numbers each), `receivers.f64`, `suns.f64` (3 each), `lit.u8` (a row of suns for each receiver).
fn write(
    folder: &Path,
    casters: &[Caster],
    receivers: &Receivers,
    suns: &[DVec3],
    packets: &Packets,
    exposure: &umbrae_study::Exposure,
) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let corners = casters.iter().flat_map(|c| (0..c.mesh.triangles().len()).flat_map(|t| c.corners(t)));
    let triangles: Vec<u8> = corners.flat_map(|c| c.to_array()).flat_map(f32::to_le_bytes).collect();
    let bytes =
        |points: &[DVec3]| -> Vec<u8> { points.iter().flat_map(DVec3::to_array).flat_map(f64::to_le_bytes).collect() };
    std::fs::write(folder.join("triangles.f32"), triangles)?;
    std::fs::write(folder.join("receivers.f64"), bytes(&receivers.positions))?;
    std::fs::write(folder.join("suns.f64"), bytes(suns))?;
    let mut lit = vec![0_u8; receivers.len() * suns.len()];
    for packet in 0..packets.len() {
        for (lane, &r) in packets.members(packet).iter().enumerate() {
            for step in 0..suns.len() {
                lit[r as usize * suns.len() + step] = u8::from(exposure.is_lit(packet, lane, step));
            }
        }
    }
    Ok(std::fs::write(folder.join("lit.u8"), lit)?)
}

fn city(boxes: usize) -> Scene {
    let columns = (boxes as f64).sqrt().ceil() as usize;
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let objects = (0..boxes).map(|i| {
        let size = Vec3::new(random.between(10.0, 26.0), random.between(10.0, 26.0), random.between(6.0, 45.0));
        let mesh =
            Mesh::new(shapes::cuboid(-0.5 * size.with_z(0.0), size.with_z(0.0) * 0.5 + size.with_x(0.0).with_y(0.0)));
        let jitter = DVec2::new(f64::from(random.between(-6.0, 6.0)), f64::from(random.between(-6.0, 6.0)));
        let at = CELL_M * (DVec2::new((i % columns) as f64, (i / columns) as f64) + 0.5) + jitter;
        let turn = f64::from(random.between(0.0, 90.0)).to_radians();
        let place = DAffine3::from_translation(at.extend(0.0)) * DAffine3::from_rotation_z(turn);
        Object::new(format!("box {i}"), Arc::new(mesh.expect("a box is a mesh")), place)
    });
    Scene { objects: objects.collect(), ..Scene::default() }
}

/// Directions at even hour angles while the sun of 21 March is up in Berlin.
fn day(count: usize) -> Vec<DVec3> {
    let (latitude, declination) = (52.52_f64.to_radians(), 0.2_f64.to_radians());
    let half_day = (-latitude.tan() * declination.tan()).acos();
    (0..count)
        .map(|i| {
            let hour = half_day * (2.0 * (i as f64 + 0.5) / count as f64 - 1.0);
            let east = -declination.cos() * hour.sin();
            let north = latitude.cos() * declination.sin() - latitude.sin() * declination.cos() * hour.cos();
            let up = latitude.sin() * declination.sin() + latitude.cos() * declination.cos() * hour.cos();
            DVec3::new(east, north, up)
        })
        .collect()
}

/// The same city on every machine (`SplitMix64`).
struct Random(u64);

impl Random {
    fn between(&mut self, min: f32, max: f32) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 24) as f32;
        min + unit * (max - min)
    }
}
