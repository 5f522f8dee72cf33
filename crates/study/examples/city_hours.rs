//! Times the engine on a city of boxes, and writes what it was asked and what it answered, for other programs to be asked the same.
//!
//! ```text
//! cargo run --release -p umbrae-study --example city_hours -- BOXES RECEIVERS SUNS [THREADS] [DIR | --disc]
//! ```
//!
//! With `--disc` nothing is written, and the sun's disc is timed too.
//!
//! The city, its receivers and its suns are those of `city/mod.rs`.

mod city;

use std::error::Error;
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use glam::DVec3;
use umbrae_core::Caster;
use umbrae_study::{Blockers, Packets, Receivers};
use web_time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, otherwise: usize| args.get(i).map_or(Ok(otherwise), |arg| arg.parse::<usize>());
    let (boxes, receivers, suns, threads) = (number(0, 500)?, number(1, 250_000)?, number(2, 145)?, number(3, 1)?);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;

    let casters = city::casters(boxes);
    let suns = city::suns(suns);
    let receivers = city::receivers(boxes, receivers);

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
    if args.get(4).is_some_and(|last| last == "--disc") {
        return time_disc(&blockers, &receivers, &packets, &lights, engine_s);
    }
    if let Some(folder) = args.get(4) {
        write(Path::new(folder), &casters, &receivers, &suns, &packets, &exposure)?;
    }
    Ok(())
}

/// Says how long the disc takes, and how many receivers see part of it.
fn time_disc(
    blockers: &Blockers,
    receivers: &Receivers,
    packets: &Packets,
    lights: &[Option<DVec3>],
    engine_s: f64,
) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let exposure = blockers
        .expose_disc(receivers, packets, 0..packets.len(), lights, &AtomicBool::new(false), || {})
        .ok_or("stopped")?;
    let disc_s = start.elapsed().as_secs_f64();
    let tests = receivers.len() * lights.len();
    writeln!(
        io::stdout(),
        "{{\"disc_s\": {disc_s:.4}, \"million_shares_per_s\": {:.1}, \"times_engine\": {:.1}, \"partial\": {}, \"partial_percent\": {:.2}}}",
        tests as f64 / disc_s / 1e6,
        disc_s / engine_s,
        exposure.partial.len(),
        100.0 * exposure.partial.len() as f64 / tests as f64,
    )?;
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
