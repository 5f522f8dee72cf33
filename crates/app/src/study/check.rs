//! A second look at a sample of verdicts: one ray each, in double precision, by a method that shares nothing with the engine.

use glam::DVec3;
use rayon::prelude::*;
use umbrae_study::Receivers;

use super::results::{Check, State};
use super::rows::{bit, read_row};
use super::scene::Situation;

/// However long the period, so many verdicts are a sample.
const MOST_VERDICTS: usize = 2_000_000;

/// Looks again at about `sample` receivers of `state`, spread evenly over all that have a sum, at every step, or every few of a long period.
///
/// # Errors
///
/// When the bits can't be read.
pub(super) fn check(
    sample: usize,
    state: &State,
    situation: &Situation,
    receivers: &Receivers,
    suns: &[Option<DVec3>],
) -> anyhow::Result<Check> {
    let computed: Vec<usize> = (0..receivers.len()).filter(|&r| state.sums[r].is_some()).collect();
    let sample = sample.min(computed.len());
    let chosen: Vec<usize> = (0..sample).map(|i| computed[i * computed.len() / sample]).collect();
    let days: Vec<(usize, DVec3)> = suns.iter().enumerate().filter_map(|(step, sun)| Some((step, (*sun)?))).collect();
    let every = (chosen.len() * days.len()).div_ceil(MOST_VERDICTS).max(1);
    let steps: Vec<(usize, DVec3)> = days.into_iter().step_by(every).collect();

    let stride = suns.len().div_ceil(8);
    let rows = chosen.iter().map(|&receiver| read_row(&state.rows, receiver, stride)).collect::<Result<Vec<_>, _>>()?;
    let blockers = &situation.blockers;
    let margin = blockers.margin_m();
    let of_receiver = |(&receiver, row): (&usize, &Vec<u8>)| {
        let (position, normal) = (receivers.positions[receiver], receivers.normals[receiver]);
        let mut check = Check { receivers: 1, ..Check::default() };
        for &(step, to_sun) in &steps {
            check.verdicts += 1;
            let sees = |from: DVec3| blockers.sees(from, normal, to_sun);
            if sees(position) == bit(row, step) {
                continue;
            }
            let is_edge = DVec3::AXES.iter().any(|&axis| {
                sees(position + margin * axis) != sees(position) || sees(position - margin * axis) != sees(position)
            });
            if is_edge {
                check.undecided += 1;
            } else {
                check.disagreements += 1;
            }
        }
        check
    };
    Ok(chosen.par_iter().zip(&rows).map(of_receiver).reduce(Check::default, Check::plus))
}

impl Check {
    /// Both together.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            receivers: self.receivers + other.receivers,
            verdicts: self.verdicts + other.verdicts,
            disagreements: self.disagreements + other.disagreements,
            undecided: self.undecided + other.undecided,
        }
    }
}
