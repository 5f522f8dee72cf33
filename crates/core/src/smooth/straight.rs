//! Points that a silhouette can do without.
//!
//! ```text
//!       lit                        A silhouette has a point on each edge that it crosses, and on a fine mesh most of them are nearly
//!    a -----_____----- c           in a line. One that lies inward of the line between its neighbours is left out: so counts
//!          '--b--'                 are raised, by a sliver, and none is lowered. One that lies outward stays.
//!       dark
//! ```
//!
//! Volumes are drawn by their sides, so this is what smooth shadows cost less for.

use crate::LightPosition;

use super::fins::Fins;
use super::precision::Precision;
use super::volume::SmoothVolume;

/// A point is left out if it is not farther from the line than so many of its lengths,
const FLAT: f64 = 0.15;
/// and than so much of what a chord may be off.
const PART_OF_CHORD: f64 = 0.25;

/// So often; errors add up.
const ROUNDS: u32 = 2;

pub(super) const NONE: u32 = u32::MAX;
/// Of a point that several sides or fins leave or reach.
pub(super) const MANY: u32 = u32::MAX - 1;

/// What is needed while points are left out.
#[derive(Debug, Default, Clone)]
pub(super) struct StraightScratch {
    /// Of each point the one that the silhouette comes from, and the one that it goes to.
    beside: Vec<[u32; 2]>,
    /// Whether a line that leaves a point out ends there: another would make the error larger.
    is_end: Vec<bool>,
}

/// Makes `beside` that of `count` points and of `walks` from one to another.
pub(super) fn link(beside: &mut Vec<[u32; 2]>, count: usize, walks: &[[u32; 2]]) {
    beside.clear();
    beside.resize(count, [NONE; 2]);
    for &[from, to] in walks {
        for (point, end, other) in [(from, 1, to), (to, 0, from)] {
            let known = &mut beside[point as usize][end];
            *known = if *known == NONE { other } else { MANY };
        }
    }
}

/// Leaves out of `volume`, and of its `fins`, the points that it can do without under `light`. Linear in the numbers of points and sides.
pub(super) fn straighten(
    volume: &mut SmoothVolume,
    fins: &mut Fins,
    light: LightPosition,
    precision: &Precision,
    scratch: &mut StraightScratch,
) {
    link(&mut scratch.beside, volume.points.len(), &volume.sides);
    let place = |p: u32| volume.points[p as usize].as_dvec3();
    let can_go = |[a, b, c]: [u32; 3]| {
        let [from, point, to] = [a, b, c].map(place);
        let (along, off) = (to - from, point - from);
        let across = along.cross(off);
        let (off_m, length_m) = (across.length() / along.length(), along.length());
        // Between the two, and inward as the light sees it.
        (0.0..along.length_squared()).contains(&off.dot(along))
            && off_m <= FLAT * length_m
            && across.dot(light.offset_from(point)) >= 0.0
            && off_m <= PART_OF_CHORD * precision.chord_m(point, light)
    };
    let mut is_any_left_out = false;
    for _ in 0..ROUNDS {
        scratch.is_end.clear();
        scratch.is_end.resize(volume.points.len(), false);
        for b in 0..scratch.beside.len() as u32 {
            let beside = &mut scratch.beside;
            let [a, c] = beside[b as usize];
            let is_between = a < MANY && c < MANY && a != c && beside[a as usize][1] == b && beside[c as usize][0] == b;
            if is_between && !scratch.is_end[b as usize] && can_go([a, b, c]) {
                is_any_left_out = true;
                for end in [a, c] {
                    scratch.is_end[end as usize] = true;
                }
                (beside[a as usize][1], beside[c as usize][0]) = (c, a);
                beside[b as usize] = [NONE; 2];
                volume.faces.push(fins.merge([a, b, c]).unwrap_or([a, c, b]));
            }
        }
    }
    if is_any_left_out {
        volume.sides.retain_mut(|[from, to]| {
            let [_, next] = scratch.beside[*from as usize];
            if next == NONE {
                return false;
            }
            if next != MANY {
                *to = next;
            }
            true
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;

    /// What is left of a walk round `corners` under a sun above, whose precision is `epsilon_m`.
    fn left_of(corners: &[[f32; 2]], epsilon_m: f64) -> SmoothVolume {
        let n = corners.len() as u32;
        let points = corners.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect();
        let sides = (0..n).map(|i| [i, (i + 1) % n]).collect();
        let mut volume = SmoothVolume { points, sides, ..SmoothVolume::default() };
        let sun = LightPosition::directional(DVec3::Z).expect("not zero");
        let precision = Precision::in_world(epsilon_m);
        straighten(&mut volume, &mut Fins::default(), sun, &precision, &mut StraightScratch::default());
        volume
    }

    const DENTED: [[f32; 2]; 6] = [[0.0, 0.0], [5.0, 0.1], [10.0, 0.0], [10.0, 10.0], [5.0, 10.1], [0.0, 10.0]];

    #[test]
    fn a_point_that_lies_inward_goes_and_one_that_lies_outward_stays() {
        let volume = left_of(&DENTED, 1.0);
        assert_eq!(volume.sides, [[0, 2], [2, 3], [3, 4], [4, 5], [5, 0]]);
        assert_eq!(volume.faces, [[0, 2, 1]], "which faces the light");
    }

    #[test]
    fn nothing_goes_that_is_farther_off_than_may_be() {
        assert_eq!(left_of(&DENTED, 0.5).sides.len(), 6);
        let deep = [[0.0, 0.0], [5.0, 1.6], [10.0, 0.0], [5.0, 10.0]];
        assert_eq!(left_of(&deep, 100.0).sides.len(), 4);
    }

    #[test]
    fn an_arc_keeps_every_fourth_point_at_least() {
        let angles = (0..48).map(|i| std::f32::consts::TAU * i as f32 / 48.0);
        let hole: Vec<[f32; 2]> = angles.map(|angle| [angle.cos(), -angle.sin()]).collect();
        let volume = left_of(&hole, 100.0);
        assert!((12..20).contains(&volume.sides.len()), "{} sides", volume.sides.len());
    }
}
