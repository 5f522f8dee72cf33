//! How much of a round light something covers.
//!
//! ```text
//!        .---b         A loop covers, of a disc about the origin, the sum over its edges a -> b of the signed area
//!      .'   /|'.       in which the disc meets the triangle (0, a, b): chords count as triangles, what is outside of the
//!     |   /  |  |      disc as the sector behind which it lies. Areas that the loop winds around twice count twice.
//!     |  0---|--|--a
//!      '.    | .'
//!        '---'
//! ```
//!
//! Source: the signed sum over silhouette edges is that of U. Assarsson and T. Akenine-Möller, "A geometry-based soft shadow volume
//! algorithm using graphics hardware", 2003, section 5; the areas here are in closed form and not looked up.

use std::f64::consts::TAU;

use glam::DVec2;

/// The mean diameter of the sun as it is seen from the earth.
pub const SUN_DIAMETER_RAD: f64 = 0.533_f64.to_radians();

/// Twice the signed area in which the unit disc about the origin meets the triangle (0, a, b); positive when that turns counter-clockwise.
///
/// Between minus and plus pi: that much is covered by a half-plane through the origin. 0 for an edge on a line through the origin. Exact to
/// rounding for any finite `a` and `b`.
pub fn disc_sector(a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let (squared, doubled, rest) = (along.length_squared(), a.dot(along), a.length_squared() - 1.0);
    let discriminant = doubled * doubled - squared * rest;
    if discriminant <= 0.0 || squared == 0.0 {
        return angle(a, b);
    }
    // Where the line meets the circle; the stable form of each root.
    let root = discriminant.sqrt();
    let (first, second) = (-doubled - root, -doubled + root);
    let (enter, leave) = (first / squared, second / squared);
    if leave <= 0.0 || enter >= 1.0 {
        return angle(a, b);
    }
    let chord_start = if enter > 0.0 { a + along * enter } else { a };
    let chord_end = if leave < 1.0 { a + along * leave } else { b };
    let mut twice = chord_start.perp_dot(chord_end);
    if enter > 0.0 {
        twice += angle(a, chord_start);
    }
    if leave < 1.0 {
        twice += angle(chord_end, b);
    }
    twice
}

/// The share of the unit disc that closed `loops` wind around, each as often as it does: 1 for one counter-clockwise loop around all of it.
pub fn disc_share<'a>(loops: impl IntoIterator<Item = &'a [DVec2]>) -> f64 {
    let of_loop = |corners: &[DVec2]| -> f64 {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(&a, &b)| disc_sector(a, b)).sum()
    };
    loops.into_iter().map(of_loop).sum::<f64>() / TAU
}

/// The share of the unit disc that the chord from `a` to `b`, both in it, cuts off from the sector between them: positive; a half for a
/// chord through the origin.
///
/// [`disc_sector`] of any edge is its sector less this, for the part of the edge that is in the disc; turned round where the edge goes clockwise.
pub fn disc_segment(a: DVec2, b: DVec2) -> f64 {
    (angle(a, b).abs() - a.perp_dot(b).abs()) / TAU
}

/// From `a` to `b` about the origin, between minus and plus pi: twice the area of that sector of the unit disc.
fn angle(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b).atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn a_half_plane_at_distance_t_leaves_the_known_share() {
        for i in -19..20 {
            let t = f64::from(i) / 20.0;
            let far = 50.0;
            let square = [(t, -far), (far, -far), (far, far), (t, far)].map(DVec2::from);
            let expected = (t.acos() - t * (1.0 - t * t).sqrt()) / PI;
            assert!((disc_share([square.as_slice()]) - expected).abs() < 1e-12, "at {t}");
        }
    }

    #[test]
    fn shares_of_random_triangles_are_those_of_a_fine_grid() {
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        for _ in 0..40 {
            let corners: [DVec2; 3] = std::array::from_fn(|_| DVec2::new(random(), random()) * 1.8);
            let n = 400;
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
            let (mut inside, mut all) = (0.0, 0.0);
            for p in (0..n * n).map(|i| DVec2::new(at(i % n), at(i / n))).filter(|p| p.length() < 1.0) {
                let sides = [0, 1, 2].map(|i| (corners[(i + 1) % 3] - corners[i]).perp_dot(p - corners[i]));
                all += 1.0;
                if sides.iter().all(|&s| s > 0.0) {
                    inside += 1.0;
                } else if sides.iter().all(|&s| s < 0.0) {
                    inside -= 1.0;
                }
            }
            let share = disc_share([corners.as_slice()]);
            assert!((share - inside / all).abs() < 2e-3, "{corners:?}: {share} and {}", inside / all);
        }
    }

    #[test]
    fn a_loop_around_the_disc_covers_it_once_and_one_beside_it_nothing() {
        let square = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(DVec2::from);
        let beside = square.map(|p| p + DVec2::new(9.0, 0.0));
        let back: Vec<DVec2> = square.iter().rev().copied().collect();
        assert!((disc_share([square.as_slice()]) - 1.0).abs() < 1e-12);
        assert!(disc_share([beside.as_slice()]).abs() < 1e-12);
        assert!((disc_share([square.as_slice(), square.as_slice()]) - 2.0).abs() < 1e-12, "wound around twice");
        assert!((disc_share([square.as_slice(), &back])).abs() < 1e-12);
    }
}
