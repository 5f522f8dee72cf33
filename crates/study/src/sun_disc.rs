//! The sun as a disc, as seen from a point.
//!
//! ```text
//!        up
//!      .-|-.        A direction near the sun is a place on the plane across the way to the sun's middle, in units of the
//!     |  +--|across  disc's radius there (a gnomonic projection): what is straight in space is straight here, and the disc is
//!      '---'        the unit disc. A plane through the point is a line, and what is on one side of it a half-plane.
//! ```
//!
//! The disc is [`SUN_DIAMETER_RAD`] wide all year (it is 1.7 % wider in January, and as much narrower in July), equally bright all over (the real
//! one is darker towards its edge), and round (the air flattens it by up to a sixth on the horizon). Areas on the plane differ from solid angles by
//! three parts in a hundred thousand at most.

use std::sync::LazyLock;

use glam::{DVec2, DVec3};
use umbrae_core::{SUN_DIAMETER_RAD, disc_share};

/// The tangent of half the sun's diameter: the radius of its disc at a distance of one.
pub(crate) static SUN_TANGENT: LazyLock<f64> = LazyLock::new(|| (0.5 * SUN_DIAMETER_RAD).tan());

/// Where the sun's disc is, with axes on it.
///
/// ```
/// use glam::{DVec2, DVec3};
/// use umbrae_study::SunDisc;
///
/// // The horizon halves a disc that is just rising.
/// let rising = SunDisc::new(DVec3::X);
/// assert!((rising.share_above_horizon() - 0.5).abs() < 1e-12);
/// // Its edge is a quarter of a degree from its middle.
/// let edge = rising.direction(DVec2::X);
/// assert!((edge.angle_between(DVec3::X).to_degrees() - 0.2665).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunDisc {
    to_sun: DVec3,
    /// Across the way to the sun, as long as the disc's radius is at a distance of one.
    across: DVec3,
    up: DVec3,
}

impl SunDisc {
    /// The disc about the unit vector `to_sun`.
    pub fn new(to_sun: DVec3) -> Self {
        let (across, up) = to_sun.any_orthonormal_pair();
        Self { to_sun, across: *SUN_TANGENT * across, up: *SUN_TANGENT * up }
    }

    /// Towards a place on the disc: the origin is its middle, and its edge is at a distance of one. Not of unit length.
    pub fn direction(&self, place: DVec2) -> DVec3 {
        self.to_sun + place.x * self.across + place.y * self.up
    }

    /// How much of it is above a level horizon, 0 to 1.
    pub fn share_above_horizon(&self) -> f64 {
        let horizon = self.half_plane(DVec3::Z);
        if horizon.holds_disc() {
            return 1.0;
        }
        if horizon.misses_disc() {
            return 0.0;
        }
        disc_share([horizon.of_square().as_slice()]).clamp(0.0, 1.0)
    }

    /// The places in whose directions `normal` points: those on its side of the plane through the eye. All of them for a zero vector.
    pub(crate) fn half_plane(&self, normal: DVec3) -> HalfPlane {
        let slope = DVec2::new(normal.dot(self.across), normal.dot(self.up));
        let (length, offset) = (slope.length(), normal.dot(self.to_sun));
        if length > 0.0 {
            HalfPlane { normal: slope / length, offset: offset / length }
        } else {
            HalfPlane { normal: DVec2::X, offset: if offset < 0.0 { f64::NEG_INFINITY } else { f64::INFINITY } }
        }
    }
}

/// The places `p` with `normal . p + offset >= 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HalfPlane {
    /// A unit vector.
    normal: DVec2,
    /// How far inside the middle of the disc is.
    pub(crate) offset: f64,
}

impl HalfPlane {
    /// How far inside `place` is; negative outside.
    #[inline]
    pub(crate) fn depth(&self, place: DVec2) -> f64 {
        self.normal.dot(place) + self.offset
    }

    /// Whether all of the disc is inside.
    #[inline]
    pub(crate) fn holds_disc(&self) -> bool {
        self.offset >= 1.0
    }

    /// Whether nothing of the disc is inside.
    #[inline]
    pub(crate) fn misses_disc(&self) -> bool {
        self.offset <= -1.0
    }

    /// The other half.
    pub(crate) fn flipped(self) -> Self {
        Self { normal: -self.normal, offset: -self.offset }
    }

    /// What it has of the square around the disc, counter-clockwise.
    fn of_square(self) -> Vec<DVec2> {
        let (mut inside, mut outside) = (Vec::new(), Vec::new());
        split(&SQUARE, &self, &mut inside, &mut outside);
        inside
    }
}

/// The square around the disc, counter-clockwise.
pub(crate) const SQUARE: [DVec2; 4] =
    [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0)];

/// What is so near to a line is on it: a thousand times what rounding does, and a strip of the disc so wide is nothing.
pub(crate) const ON_LINE: f64 = 1e-12;

/// Adds what a convex `polygon` has in `half_plane` to `inside`, and the rest to `outside`; both turn as it does. Where all of its corners are on one side, or on
/// the line, the other is left with less than three.
#[inline]
pub(crate) fn split(polygon: &[DVec2], half_plane: &HalfPlane, inside: &mut Vec<DVec2>, outside: &mut Vec<DVec2>) {
    let Some(&last) = polygon.last() else { return };
    let (mut from, mut from_depth) = (last, half_plane.depth(last));
    for &to in polygon {
        let to_depth = half_plane.depth(to);
        let crosses = (from_depth > ON_LINE && to_depth < -ON_LINE) || (from_depth < -ON_LINE && to_depth > ON_LINE);
        if crosses {
            let crossing = from + (to - from) * (from_depth / (from_depth - to_depth));
            inside.push(crossing);
            outside.push(crossing);
        }
        if to_depth >= -ON_LINE {
            inside.push(to);
        }
        if to_depth <= ON_LINE {
            outside.push(to);
        }
        (from, from_depth) = (to, to_depth);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn the_horizon_leaves_of_a_rising_disc_what_a_half_plane_leaves() {
        for i in -12..=12 {
            let height = f64::from(i) / 10.0;
            let altitude = (height * *SUN_TANGENT).atan();
            let disc = SunDisc::new(DVec3::new(0.6 * altitude.cos(), 0.8 * altitude.cos(), altitude.sin()));
            let t = (-height).clamp(-1.0, 1.0);
            let expected = (t.acos() - t * (1.0 - t * t).sqrt()) / PI;
            let share = disc.share_above_horizon();
            assert!((share - expected).abs() < 1e-9, "at {height} radii: {share}, not {expected}");
        }
    }

    #[test]
    fn the_two_parts_of_a_split_polygon_are_as_large_as_it() {
        let area = |ring: &[DVec2]| -> f64 {
            ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| 0.5 * a.perp_dot(*b)).sum()
        };
        let disc = SunDisc::new(DVec3::new(0.48, 0.6, 0.64));
        for i in 0..200 {
            let turn = f64::from(i);
            let normal = DVec3::new(turn.sin(), turn.cos(), (turn * 0.37).sin() * 0.01) - disc.to_sun * 0.96;
            let half_plane =
                disc.half_plane(normal.reject_from(disc.to_sun) + disc.to_sun * 0.004 * (turn * 1.7).cos());
            let (mut inside, mut outside) = (Vec::new(), Vec::new());
            split(&SQUARE, &half_plane, &mut inside, &mut outside);
            assert!((area(&inside) + area(&outside) - 4.0).abs() < 1e-12, "{half_plane:?}");
            assert!(inside.iter().all(|&p| half_plane.depth(p) > -1e-9), "{half_plane:?}");
            assert!(outside.iter().all(|&p| half_plane.depth(p) < 1e-9), "{half_plane:?}");
        }
    }
}
