//! The curve between two points of a smooth surface whose normals are known there.
//!
//! ```text
//!        t0 ->  .---.  -> t1        A cubic with the chord's ends and a tangent at each. Tangents are the chord,
//!             .'     '.             laid into the surface's tangent plane, and as long as those of the arc of a
//!          p0 --------- p1          circle that leaves the chord at the same angle.
//! ```
//!
//! Source: O. Mattausch et al. 2012, section 3.2, after L. Wang et al. 2008, who scale tangents by the length of such an arc. A cubic with those
//! is flatter than the arc: its middle misses the circle by 0.4 % of the height of an arc of 90 degrees. The scale here, 2 / (1 + cos) of the angle,
//! is the one with which it does not. Section 3.3 halves curves and takes the mean of two tangents for that in the middle; here each point is
//! evaluated on the one cubic, so that nothing depends on how often it is cut.

use glam::DVec3;

/// A curve is cut into at most so many pieces.
const MOST_PIECES: u32 = 256;

/// A cubic from `start` to `end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Curve {
    pub(super) start: DVec3,
    pub(super) end: DVec3,
    /// At the start and at the end, both as one goes from start to end.
    tangents: [DVec3; 2],
}

impl Curve {
    /// On a surface with the unit `normals` at start and end.
    pub(super) fn on_surface(start: DVec3, end: DVec3, normals: [DVec3; 2]) -> Self {
        let chord = end - start;
        Self::along(start, end, normals.map(|normal| chord - normal * normal.dot(chord)))
    }

    /// With tangents in these directions, of any length; 0 is the chord's, and what points back along it is turned round.
    pub(super) fn along(start: DVec3, end: DVec3, directions: [DVec3; 2]) -> Self {
        let chord = end - start;
        Self { start, end, tangents: directions.map(|direction| scaled(direction, chord)) }
    }

    /// Straight.
    pub(super) fn straight(start: DVec3, end: DVec3) -> Self {
        Self { start, end, tangents: [end - start; 2] }
    }

    /// The point at `u` from 0, the start, to 1, the end.
    pub(super) fn at(&self, u: f64) -> DVec3 {
        let (v, [first, last]) = (1.0 - u, self.tangents);
        // Weights of Bernstein's form: nothing is moved at the ends, and nothing on a straight line beside it.
        let on_chord = self.start.lerp(self.end, u * u * (3.0 - 2.0 * u));
        on_chord + (u * v) * (v * first - u * last)
    }

    /// The two inner control points of the curve as a cubic of Bézier's.
    pub(super) fn controls(&self) -> [DVec3; 2] {
        let [first, last] = self.tangents;
        [self.start + first / 3.0, self.end - last / 3.0]
    }

    /// Along the curve at `u`, of no particular length.
    pub(super) fn tangent(&self, u: f64) -> DVec3 {
        let [first, last] = self.tangents;
        6.0 * u * (1.0 - u) * (self.end - self.start) + (1.0 - u) * (1.0 - 3.0 * u) * first + u * (3.0 * u - 2.0) * last
    }

    /// The unit normal at `u` of a surface on which the curve lies, between those that it has at its ends: a curve over a bulge has seen
    /// more of the turn by its middle, or less, than a straight line between the normals has.
    pub(super) fn normal(&self, u: f64, [first, last]: [DVec3; 2]) -> DVec3 {
        let (between, along) = (first.lerp(last, u), self.tangent(u));
        let across = between - along * (between.dot(along) / along.length_squared().max(f64::MIN_POSITIVE));
        across.normalize_or(between)
    }

    /// How far the curve is from its chord at `u`.
    pub(super) fn bulge(&self, u: f64) -> DVec3 {
        self.at(u) - self.start.lerp(self.end, u)
    }

    /// From end to start.
    pub(super) fn reversed(&self) -> Self {
        let [first, last] = self.tangents;
        Self { start: self.end, end: self.start, tangents: [-last, -first] }
    }

    /// How much of the curve's bend, from 0 to 1, keeps it from going farther than `inward` in that direction from its chord.
    pub(super) fn share_within(&self, inward: DVec3) -> f64 {
        let off = |u: f64| self.bulge(u).dot(inward);
        let farthest = [0.25, 0.5, 0.75].map(off).into_iter().fold(0.0, f64::max);
        if farthest > inward.length_squared() { inward.length_squared() / farthest } else { 1.0 }
    }

    /// With that `share` of its bend.
    pub(super) fn flattened(&self, share: f64) -> Self {
        let chord = self.end - self.start;
        Self { tangents: self.tangents.map(|tangent| chord.lerp(tangent, share)), ..*self }
    }

    /// Into how many pieces of equal length in `u` the part from `from` to `to` must be cut so that no chord is farther than `epsilon_m` from
    /// the curve; 1 to 256.
    ///
    /// Taylor: a chord over a step h misses by at most h^2 / 8 of the second derivative, which is linear in u.
    pub(super) fn pieces(&self, [from, to]: [f64; 2], epsilon_m: f64) -> u32 {
        let (chord, [first, last]) = (self.end - self.start, self.tangents);
        let bend = [4.0 * first + 2.0 * last, 2.0 * first + 4.0 * last].map(|v| (6.0 * chord - v).length());
        let bend = bend[0].max(bend[1]);
        let count = (to - from).abs() * (bend / (8.0 * epsilon_m)).sqrt();
        // Not a number where nothing bends and nothing may.
        if count > 1.0 { (count.ceil() as u32).min(MOST_PIECES) } else { 1 }
    }
}

/// `direction` with the length with which the middle of a cubic lies on the arc that leaves `chord` in that direction.
fn scaled(direction: DVec3, chord: DVec3) -> DVec3 {
    let length = chord.length();
    let Some(unit) = direction.try_normalize() else { return chord };
    let cosine = unit.dot(chord) / length.max(f64::MIN_POSITIVE);
    let forward = if cosine < 0.0 { -unit } else { unit };
    forward * (2.0 * length / (1.0 + cosine.abs()))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn arc(angle_rad: f64) -> Curve {
        let place = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        Curve::on_surface(place(0.0), place(angle_rad), [place(0.0), place(angle_rad)])
    }

    #[test]
    fn an_arc_of_a_circle_stays_on_it() {
        for (angle_rad, error) in [(PI / 10.0, 1e-7), (PI / 5.0, 4e-6), (PI / 2.0, 3e-4)] {
            for i in 0..=100 {
                let off = (arc(angle_rad).at(f64::from(i) / 100.0).length() - 1.0).abs();
                assert!(off < error, "{off} on an arc of {angle_rad}");
            }
            assert!((arc(angle_rad).at(0.5).length() - 1.0).abs() < 1e-12, "its middle is on the circle");
        }
    }

    #[test]
    fn between_points_of_a_plane_it_is_straight() {
        let (start, end) = (DVec3::new(1.0, 2.0, 0.0), DVec3::new(4.0, -2.0, 0.0));
        let curve = Curve::on_surface(start, end, [DVec3::Z, DVec3::Z]);
        for i in 0..=10 {
            let u = f64::from(i) / 10.0;
            assert!((curve.at(u) - start.lerp(end, u)).length() < 1e-12);
        }
        assert_eq!(curve.pieces([0.0, 1.0], 1e-9), 1);
    }

    #[test]
    fn pieces_are_within_epsilon_and_not_many_more_than_needed() {
        let s_shaped = Curve::along(DVec3::ZERO, DVec3::X, [DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.3)]);
        for curve in [arc(PI / 5.0), arc(PI / 2.0), s_shaped] {
            for epsilon in [1e-2, 1e-3, 1e-4] {
                let n = curve.pieces([0.0, 1.0], epsilon);
                let missed = |n: u32| {
                    let piece = |i: u32| f64::from(i) / f64::from(n);
                    let off = |i: u32, k: u32| {
                        let (from, to) = (piece(i), piece(i + 1));
                        let share = f64::from(k) / 20.0;
                        let [a, b] = [from, to].map(|u| curve.at(u));
                        let p = curve.at(from + share * (to - from)) - a;
                        let chord = b - a;
                        (p - chord * (p.dot(chord) / chord.length_squared())).length()
                    };
                    (0..n).flat_map(|i| (0..=20).map(move |k| (i, k))).map(|(i, k)| off(i, k)).fold(0.0, f64::max)
                };
                assert!(missed(n) <= epsilon, "{n} pieces miss by {}", missed(n));
                assert!(n <= 2 || missed(n / 2) > epsilon, "{n} pieces are too many for {epsilon}");
            }
        }
    }

    #[test]
    fn odd_normals_and_points_that_coincide_give_finite_curves() {
        let (start, end) = (DVec3::ZERO, DVec3::X);
        for normals in [[DVec3::X, DVec3::X], [DVec3::ZERO, DVec3::Y], [DVec3::X, DVec3::NEG_X]] {
            let curve = Curve::on_surface(start, end, normals);
            assert!(curve.at(0.3).is_finite() && curve.at(0.3).length() < 2.0);
            assert!(curve.pieces([0.0, 1.0], 1e-3) <= MOST_PIECES);
            let point = Curve::on_surface(start, start, normals);
            assert_eq!((point.at(0.7), point.pieces([0.0, 1.0], 1e-3)), (start, 1));
        }
    }
}
