//! How much of a square light an edge cuts off: the twin of [`crate::disc_segment`].
//!
//! ```text
//!     +-----------+       Seen from the middle, the edge a -> b hides the sector behind it but for the
//!     |  a__      |       triangle (0, a, b); the rest of the sector is what this tells. A sector's area is
//!     |  |  ``--b |       half the way along the border that it takes in, because the border is
//!     |   `. /    |       1 away from the middle on every side.
//!     |     0     |
//!     +-----------+
//! ```

use glam::DVec2;

/// The way around the square's border.
const AROUND: f64 = 8.0;
/// The square's area.
const AREA: f64 = 4.0;

/// The share of the square from (-1, -1) to (1, 1) that the chord from `a` to `b`, both in it, cuts off from the sector between them: positive; a
/// half for a chord through the origin. 0 where `a` or `b` is the origin.
pub fn square_segment(a: DVec2, b: DVec2) -> f64 {
    let turn = (along_border(b) - along_border(a)).abs();
    let sector = 0.5 * turn.min(AROUND - turn);
    (sector - 0.5 * a.perp_dot(b).abs()).max(0.0) / AREA
}

/// Where the ray from the origin through `v` meets the border, along it from the middle of the right side counter-clockwise; from -1 to 7.
fn along_border(v: DVec2) -> f64 {
    if v.x.abs() >= v.y.abs() {
        if v.x == 0.0 {
            return 0.0;
        }
        v.y / v.x + if v.x > 0.0 { 0.0 } else { 4.0 }
    } else {
        2.0 - v.x / v.y + if v.y > 0.0 { 0.0 } else { 4.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_chord_cuts_off_is_what_a_fine_grid_finds() {
        let mut seed = 11_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        for _ in 0..60 {
            let (a, b) = (DVec2::new(random(), random()), DVec2::new(random(), random()));
            let (a, b) = if a.perp_dot(b) > 0.0 { (a, b) } else { (b, a) };
            let n = 400;
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
            let is_cut_off = |p: DVec2| a.perp_dot(p) > 0.0 && p.perp_dot(b) > 0.0 && (b - a).perp_dot(p - a) < 0.0;
            let found = (0..n * n).filter(|i| is_cut_off(DVec2::new(at(i % n), at(i / n)))).count();
            let (share, found) = (square_segment(a, b), found as f64 / f64::from(n * n));
            assert!((share - found).abs() < 3e-3, "{a} to {b}: {share} and {found}");
        }
    }

    #[test]
    fn a_chord_through_the_middle_cuts_off_a_half() {
        for angle in [0.0, 0.3, 0.8, 1.2, 2.5] {
            let v = DVec2::from_angle(angle) * 0.7;
            assert!((square_segment(v, -v) - 0.5).abs() < 1e-12, "{angle}");
        }
    }
}
