//! What a block of receivers comes to: through the engine, and the hours of each.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;
use umbrae_study::{DiscExposure, Exposure, SunHours};
use web_time::Instant;

use super::fractions::fractions_of;
use super::results::Disc;
use super::rows::{bit, rows_of};
use super::sums::{SUM_BYTES, Sum};
use super::tiles::Job;

/// A row for each receiver, by receiver.
pub(super) type Rows = Vec<(usize, Vec<u8>)>;

/// The receivers of some packets, by receiver.
pub(super) struct Block {
    /// Bits.
    pub(super) rows: Rows,
    pub(super) sums: Vec<(usize, [u8; SUM_BYTES])>,
    /// Shares of the disc, where the sun is one.
    pub(super) fractions: Option<Rows>,
}

/// What hours are made of, besides the bits of the steps.
enum Source {
    /// Nothing else.
    Steps,
    /// Bits of minutes.
    Minutes(Rows),
    /// The disc's shares at each step, or minute: bits where all of it is seen, and the rest.
    Disc(Rows, DiscExposure),
}

impl Block {
    /// Computes packets `range` of `job`, and adds what the engine took to `engine_s`; `None` if `stop` was set before the end.
    pub(super) fn compute(job: &Job<'_>, range: &Range<usize>, stop: &AtomicBool, engine_s: &mut f64) -> Option<Self> {
        let start = Instant::now();
        let exposed = expose(job, range, stop);
        *engine_s += start.elapsed().as_secs_f64();
        let (source, exposure, fractions) = exposed?;
        let undecided_of = |receiver: usize| {
            let before = exposure.undecided.partition_point(|&(r, _)| (r as usize) < receiver);
            exposure.undecided[before..].iter().take_while(|&&(r, _)| r as usize == receiver).count() as u32
        };
        let rows = rows_of(&exposure, job.packets);
        let hours = |i: usize, receiver: usize, row: &[u8]| match (&source, job.refinement) {
            (Source::Disc(whole, disc), refinement) => {
                let steps = refinement.map_or(job.steps, |fine| &fine.timetable().steps);
                let partial = disc.of_receiver(receiver);
                SunHours::of_shares(steps, |step| DiscExposure::share(partial, step, bit(&whole[i].1, step)))
            }
            (Source::Minutes(minutes), Some(fine)) => {
                let at = (job.receivers.positions[receiver], job.receivers.normals[receiver]);
                fine.hours(job.blockers, at, 0..fine.suns().len(), |step| bit(&minutes[i].1, step))
            }
            _ => SunHours::of_steps(job.steps, |step| bit(row, step)),
        };
        let sum = |(i, (receiver, row)): (usize, &(usize, Vec<u8>))| {
            (*receiver, Sum::new(&hours(i, *receiver, row), undecided_of(*receiver)).to_bytes())
        };
        let sums = rows.par_iter().enumerate().map(sum).collect();
        Some(Self { rows, sums, fractions })
    }
}

/// Everything that the engine is asked, one after the other: the words of one are let go before those of the next are asked for.
fn expose(job: &Job<'_>, range: &Range<usize>, stop: &AtomicBool) -> Option<(Source, Exposure, Option<Rows>)> {
    let bits = |suns| job.blockers.expose(job.receivers, job.packets, range.clone(), suns, stop, || ());
    let shares = |suns| job.blockers.expose_disc(job.receivers, job.packets, range.clone(), suns, stop, || ());
    let (source, fractions) = match (job.disc, job.refinement) {
        (Some(Disc { suns, fine_suns }), refinement) => {
            let of_steps = shares(suns)?;
            let fractions = fractions_of(&of_steps, job.packets);
            let disc = if refinement.is_some() { shares(fine_suns)? } else { of_steps };
            (Source::Disc(rows_of(&disc.whole, job.packets), disc), Some(fractions))
        }
        (None, Some(fine)) => (Source::Minutes(rows_of(&bits(fine.suns())?, job.packets)), None),
        (None, None) => (Source::Steps, None),
    };
    Some((source, bits(job.suns)?, fractions))
}
