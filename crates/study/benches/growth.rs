//! How the engine's time grows with receivers, suns and triangles, each by ten and by a hundred.
//!
//! `cargo bench -p umbrae-study --bench growth [THREADS]`; one thread unless more are asked for. Medians of three.

#![expect(clippy::print_stdout, reason = "the table is what one runs this for")]

#[path = "../examples/city/mod.rs"]
mod city;

use std::sync::atomic::AtomicBool;

use umbrae_study::{Blockers, Packets};
use web_time::Instant;

/// 6,000 triangles.
const BOXES: usize = 500;
const RECEIVERS: usize = 25_000;
const SUNS: usize = 15;
const FACTORS: [usize; 3] = [1, 10, 100];
const ROUNDS: usize = 3;

fn main() {
    // `cargo bench` adds options, of which there are none here.
    let threads = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
    println!("{threads} thread(s); times in seconds; prepare: tree and packets, on all of them");
    for (what, by) in [("receivers", [1, 0, 0]), ("suns", [0, 1, 0]), ("triangles", [0, 0, 1])] {
        let mut last: Option<f64> = None;
        for factor in FACTORS {
            let scaled = |base: usize, i: usize| if by[i] == 1 { base * factor } else { base };
            let (receivers, suns, boxes) = (scaled(RECEIVERS, 0), scaled(SUNS, 1), scaled(BOXES, 2));
            let mut times: Vec<[f64; 2]> =
                (0..ROUNDS).map(|_| pool.install(|| measure(boxes, receivers, suns))).collect();
            times.sort_by(|a, b| a[1].total_cmp(&b[1]));
            let [prepare_s, engine_s] = times[ROUNDS / 2];
            let exponent = last.map_or(String::new(), |last| format!(", exponent {:.2}", (engine_s / last).log10()));
            println!(
                "{what:>9} x{factor:<3} {receivers:>9} receivers {suns:>5} suns {:>8} triangles: prepare {prepare_s:.3}, engine {engine_s:.4}{exponent}",
                boxes * 12
            );
            last = Some(engine_s);
        }
    }
}

/// Seconds to prepare and to decide.
fn measure(boxes: usize, receivers: usize, suns: usize) -> [f64; 2] {
    let casters = city::casters(boxes);
    let receivers = city::receivers(boxes, receivers);
    let suns: Vec<_> = city::suns(suns).into_iter().map(Some).collect();
    let start = Instant::now();
    let (blockers, packets) = (Blockers::new(&casters), Packets::new(&receivers));
    let prepare_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let exposure = blockers.expose(&receivers, &packets, 0..packets.len(), &suns, &AtomicBool::new(false), || {});
    assert!(exposure.is_some_and(|exposure| exposure.lit.iter().any(|&word| word != 0)), "the sun shines somewhere");
    [prepare_s, start.elapsed().as_secs_f64()]
}
