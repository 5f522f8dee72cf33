//! A second look at a sample of verdicts: one ray each, in double precision, by a method that shares nothing with the engine.

use std::fs::File;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use umbrae_study::{Blockers, Receivers};

use super::fractions::from_byte;
use super::results::{Check, DiscCheck, State};
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
    let of_receiver = |(&receiver, row): (&usize, &Vec<u8>)| {
        let (position, normal) = (receivers.positions[receiver], receivers.normals[receiver]);
        let mut check = Check { receivers: 1, ..Check::default() };
        for &(step, to_sun) in &steps {
            check.verdicts += 1;
            let sees = |from: DVec3| blockers.sees(from, normal, to_sun);
            if sees(position) == bit(row, step) {
                continue;
            }
            if beside(blockers, position).any(|place| sees(place) != sees(position)) {
                check.undecided += 1;
            } else {
                check.disagreements += 1;
            }
        }
        check
    };
    Ok(chosen.par_iter().zip(&rows).map(of_receiver).reduce(Check::default, Check::plus))
}

/// However long the period, so many shares are a sample: each takes a millisecond or less.
const MOST_SHARES: usize = 8_000;
/// Of each receiver so many more that are neither nothing nor all.
const MOST_PARTIAL: usize = 4;
/// Rays to a disc: first so many squared…
const FIRST_SIDE: u32 = 16;
/// …and where those find a share that differs by more than this, which is one and a half standard deviations of the worst scene…
const NOTICED: f64 = 0.05;
/// …so many squared, which is decisive beyond five standard deviations of the worst scene and what is lost by keeping shares in bytes.
const DECISIVE_SIDE: u32 = 64;
const DECISIVE: f64 = 5.0 * 0.5 / DECISIVE_SIDE as f64 + 1.0 / 255.0;

/// Estimates by rays what `fractions` say of the sun's disc, for about `sample` receivers of `state`, spread evenly, at some steps each and at some more at which they
/// see part.
///
/// # Errors
///
/// When the shares can't be read.
pub(super) fn check_disc(
    sample: usize,
    state: &State,
    fractions: &File,
    situation: &Situation,
    receivers: &Receivers,
    suns: &[Option<DVec3>],
) -> anyhow::Result<DiscCheck> {
    let computed: Vec<usize> = (0..receivers.len()).filter(|&r| state.sums[r].is_some()).collect();
    let sample = sample.min(computed.len());
    let chosen = (0..sample).map(|i| computed[i * computed.len() / sample]);
    let days: Vec<(usize, DVec3)> = suns.iter().enumerate().filter_map(|(step, sun)| Some((step, (*sun)?))).collect();
    let every = (sample * days.len()).div_ceil(MOST_SHARES).max(1);
    let rows = chosen.map(|receiver| Ok((receiver, read_row(fractions, receiver, suns.len())?)));
    let rows = rows.collect::<std::io::Result<Vec<_>>>()?;
    let of_receiver = |(i, (receiver, row)): (usize, &(usize, Vec<u8>))| {
        let (position, normal) = (receivers.positions[*receiver], receivers.normals[*receiver]);
        // Not the same steps for each; and as few see part, some of those besides.
        let is_partial = |&&(step, _): &&(usize, DVec3)| (1..u8::MAX).contains(&row[step]);
        let steps = days.iter().skip(i % every).step_by(every).chain(days.iter().filter(is_partial).take(MOST_PARTIAL));
        let look = |&(step, to_sun): &(usize, DVec3)| {
            let share = from_byte(row[step]);
            let by_rays = |side| situation.blockers.visible_share_by_rays(position, normal, to_sun, side);
            let first = share - by_rays(FIRST_SIDE);
            let is_noticed = first.abs() > NOTICED;
            let difference = if is_noticed { share - by_rays(DECISIVE_SIDE) } else { first };
            let differs = is_noticed && difference.abs() > DECISIVE;
            let is_edge = differs && is_found_beside(&situation.blockers, (position, normal), to_sun, share);
            DiscCheck {
                shares: 1,
                partial: u64::from(share > 0.0 && share < 1.0),
                disagreements: u64::from(differs && !is_edge),
                undecided: u64::from(is_edge),
                sum_of_differences: difference,
                largest_difference: difference.abs(),
            }
        };
        steps.map(look).fold(DiscCheck::default(), DiscCheck::plus)
    };
    // In order, so that sums are the same on every run.
    let checks: Vec<DiscCheck> = rows.par_iter().enumerate().map(of_receiver).collect();
    Ok(checks.into_iter().fold(DiscCheck::default(), DiscCheck::plus))
}

/// Whether rays find the `share` of the sun's disc, or less here and more there, within a margin of a receiver: as where that is in the plane of a face.
fn is_found_beside(blockers: &Blockers, (position, normal): (DVec3, Vec3), to_sun: DVec3, share: f64) -> bool {
    let places = std::iter::once(position).chain(beside(blockers, position));
    let found: Vec<f64> =
        places.map(|place| blockers.visible_share_by_rays(place, normal, to_sun, DECISIVE_SIDE)).collect();
    let (least, most) = found.iter().fold((1.0_f64, 0.0_f64), |(least, most), &at| (least.min(at), most.max(at)));
    (least - DECISIVE..=most + DECISIVE).contains(&share)
}

/// The places that are a [margin](Blockers::margin_m) from `position` along an axis.
fn beside(blockers: &Blockers, position: DVec3) -> impl Iterator<Item = DVec3> + use<> {
    let margin = blockers.margin_m();
    DVec3::AXES.into_iter().flat_map(move |axis| [position + margin * axis, position - margin * axis])
}

impl DiscCheck {
    /// Both together.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            shares: self.shares + other.shares,
            partial: self.partial + other.partial,
            disagreements: self.disagreements + other.disagreements,
            undecided: self.undecided + other.undecided,
            sum_of_differences: self.sum_of_differences + other.sum_of_differences,
            largest_difference: self.largest_difference.max(other.largest_difference),
        }
    }

    /// By how much shares are more than rays say, on average.
    pub(crate) fn mean_difference(self) -> f64 {
        self.sum_of_differences / self.shares.max(1) as f64
    }
}

impl Check {
    /// Whether nothing differs.
    pub(super) fn is_right(self) -> bool {
        self.disagreements == 0 && self.disc.is_none_or(|disc| disc.disagreements == 0)
    }

    /// Both together.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            receivers: self.receivers + other.receivers,
            verdicts: self.verdicts + other.verdicts,
            disagreements: self.disagreements + other.disagreements,
            undecided: self.undecided + other.undecided,
            disc: self.disc.or(other.disc),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DAffine3;
    use umbrae_core::{Caster, Mesh, Object, Topology, shapes};

    use super::*;

    /// Near an edge a millimetre changes the share, and still no other share than those found there is right.
    #[test]
    fn a_wrong_share_beside_a_near_edge_is_no_matter_of_rounding() {
        // A board half a metre above what it shades.
        let board = shapes::cuboid(Vec3::new(0.0, -9.0, 0.5), Vec3::new(9.0, 9.0, 0.6));
        let mesh = Arc::new(Mesh::new(board).expect("a good shape"));
        let object = Object::new("board", mesh.clone(), DAffine3::IDENTITY);
        let blockers = Blockers::new(&[Caster::new(&object, Arc::new(Topology::new(&mesh)))]);
        let receiver = (DVec3::ZERO, Vec3::Z);
        let by_rays = blockers.visible_share_by_rays(receiver.0, receiver.1, DVec3::Z, DECISIVE_SIDE);
        assert!((by_rays - 0.5).abs() < DECISIVE, "the edge is right above: {by_rays}");
        let is_found = |share: f64| is_found_beside(&blockers, receiver, DVec3::Z, share);
        assert_eq!([0.0, 0.1, 0.5, 0.9, 1.0].map(is_found), [false, false, true, false, false]);
        // In the plane of its side, which a ray meets or not.
        let below = (DVec3::new(0.0, 0.0, 0.55), Vec3::NEG_X);
        let sun = DVec3::new(-1.0, 0.0, 1.0).normalize_or_zero();
        assert!([0.0, 1.0].iter().any(|&share| is_found_beside(&blockers, below, sun, share)));
    }
}
