//! How much of a light with a size an outline covers, seen from a point: what shaders find per pixel, in double precision.
//!
//! ```text
//!      -----C-----   light        Edges of a silhouette are projected from P onto the light, where they form closed loops. What they
//!       \   |   /                 cover is how often they wind around the light's centre, plus, for each edge, what its chord
//!        \  |  /                  takes away from that or adds to it: nothing for edges beside the light.
//!     ====\=|=/   caster
//!          \|/                    covered = w(C) - sum of m sigma segment(chord)
//!     ------P------ receiver
//! ```
//!
//! Only w(C), which is the count of the hard shadow volume, knows the whole outline; so each edge needs to be looked at only from where it is seen in
//! front of the light: in its penumbra wedge.
//!
//! Source: U. Assarsson and T. Akenine-Möller, "A geometry-based soft shadow volume algorithm using graphics hardware", 2003, sections 4
//! and 5. There a table is looked up; here the areas are in closed form, and the edge passes the centre on the side that the hard volume says.

use glam::{DVec2, DVec3};

use crate::disc::disc_segment;
use crate::square::square_segment;
use crate::{Extent, Light};

/// A light with a size as it is seen from one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightFace {
    point: DVec3,
    /// From the point to the light's centre; a direction for a directional light.
    to_center: DVec3,
    /// The light's plane has the normal `ahead`, and is `distance` away along it; infinitely for a directional light.
    ahead: DVec3,
    distance: f64,
    /// A way `e` from the point, with `w = e . ahead`, is seen at `(e . across, e . up) / w - shift`.
    across: DVec3,
    up: DVec3,
    shift: DVec2,
    is_square: bool,
}

impl LightFace {
    /// The face that `light` shows to `point`; `None` if it is a point or a direction, if the point is at its centre, or if it turns its back.
    pub fn new(light: &Light, point: DVec3) -> Option<Self> {
        let to_center = light.position.offset_from(point);
        let distance = to_center.length();
        let toward = to_center.try_normalize()?;
        let disc = |radius: f64, distance: f64| {
            let (across, up) = toward.any_orthonormal_pair();
            let (across, up) = (across / radius, up / radius);
            let shift = DVec2::ZERO;
            Self { point, to_center, ahead: toward, distance, across, up, shift, is_square: false }
        };
        match light.extent {
            Extent::Point => None,
            Extent::Disc { radius_rad } => Some(disc(radius_rad.tan(), f64::INFINITY)),
            Extent::Sphere { radius_m } => Some(disc(radius_m / distance, distance)),
            Extent::Rectangle { half_right, half_up } => {
                let ahead = -half_right.cross(half_up).try_normalize()?;
                let distance = ahead.dot(to_center);
                if distance <= 0.0 {
                    return None;
                }
                let of = |half: DVec3| half / half.length_squared();
                let shift = DVec2::new(of(half_right).dot(to_center), of(half_up).dot(to_center));
                let (across, up) = (of(half_right) * distance, of(half_up) * distance);
                Some(Self { point, to_center, ahead, distance, across, up, shift, is_square: true })
            }
        }
    }

    /// What the silhouette edge from `start` to `end`, as the lit side walks it, adds to the share of the light that is covered: between
    /// minus and plus a half.
    ///
    /// Only what is strictly between the point's plane and the light's counts. That is right for any caster but one that cuts through the light
    /// itself, whose cut is no edge. Where the edge passes the centre to rounding, the sign is a matter of rounding.
    pub fn edge_share(&self, start: DVec3, end: DVec3) -> f64 {
        let share = self.segment(start - self.point, end - self.point);
        if self.is_around_center(start, end) { -share } else { share }
    }

    /// Whether the centre is on the inner side of the edge: the side on which the hard volume counts.
    pub fn is_around_center(&self, start: DVec3, end: DVec3) -> bool {
        (start - self.point).dot((end - start).cross(self.to_center)) > 0.0
    }

    /// What the chord of an edge between two ways cuts off from its sector.
    fn segment(&self, start: DVec3, end: DVec3) -> f64 {
        let seen = |way: DVec3| {
            let z = way.dot(self.ahead);
            DVec3::new(way.dot(self.across) - self.shift.x * z, way.dot(self.up) - self.shift.y * z, z)
        };
        let (mut a, mut b) = (seen(start), seen(end));
        let (is_a_beyond, is_b_beyond) = (a.z > self.distance, b.z > self.distance);
        if (a.z <= 0.0 && b.z <= 0.0) || (is_a_beyond && is_b_beyond) {
            return 0.0;
        }
        if is_a_beyond {
            a = a.lerp(b, (self.distance - a.z) / (b.z - a.z));
        } else if is_b_beyond {
            b = b.lerp(a, (self.distance - b.z) / (a.z - b.z));
        }
        // The line on which the edge is seen: its nearest point to the centre, and the direction from a to b.
        let line = a.cross(b - a);
        let length = line.truncate().length();
        if length == 0.0 {
            return 0.0;
        }
        let normal = line.truncate() / length;
        let foot = -normal * (line.z / length);
        let along = DVec2::new(normal.y, -normal.x);
        // An end that is beside or behind the point is seen at infinity.
        let from = if a.z > 0.0 { along.dot(a.truncate()) / a.z } else { f64::NEG_INFINITY };
        let to = if b.z > 0.0 { along.dot(b.truncate()) / b.z } else { f64::INFINITY };
        let (mut low, mut high) = if self.is_square {
            let slab = |at: f64, step: f64| {
                if step == 0.0 {
                    return if at.abs() < 1.0 { (f64::NEG_INFINITY, f64::INFINITY) } else { (0.0, 0.0) };
                }
                let (first, second) = ((-1.0 - at) / step, (1.0 - at) / step);
                (first.min(second), first.max(second))
            };
            let ((a, b), (c, d)) = (slab(foot.x, along.x), slab(foot.y, along.y));
            (a.max(c), b.min(d))
        } else {
            let half = (1.0 - foot.length_squared()).max(0.0).sqrt();
            (-half, half)
        };
        (low, high) = (low.max(from), high.min(to));
        if low >= high {
            return 0.0;
        }
        let chord = [foot + along * low, foot + along * high];
        if self.is_square { square_segment(chord[0], chord[1]) } else { disc_segment(chord[0], chord[1]) }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::Vec3;

    use super::*;
    use crate::{LightPosition, disc_share};

    fn light(position: LightPosition, extent: Extent) -> Light {
        Light { extent, ..Light::new("lamp", position, Vec3::ONE) }
    }

    fn ball(radius_m: f64) -> Light {
        light(LightPosition::point(DVec3::new(0.3, -0.2, 4.0)), Extent::Sphere { radius_m })
    }

    fn panel() -> Light {
        let extent = Extent::Rectangle { half_right: DVec3::Y * 0.8, half_up: DVec3::X * 0.5 };
        light(LightPosition::point(DVec3::new(0.3, -0.2, 4.0)), extent)
    }

    fn sun() -> Light {
        let towards = LightPosition::directional(DVec3::new(0.3, 0.2, 0.8)).expect("a direction");
        light(towards, Extent::Disc { radius_rad: 0.2 })
    }

    fn random(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    /// Ways to points spread evenly over the light that the point sees.
    fn samples(light: &Light, point: DVec3, seed: &mut u64, count: usize) -> Vec<DVec3> {
        let center = light.position.offset_from(point);
        let (u, v) = center.try_normalize().expect("not at the centre").any_orthonormal_pair();
        let mut ways = Vec::new();
        while ways.len() < count {
            let (x, y) = (random(seed), random(seed));
            let in_disc = x * x + y * y < 1.0;
            match light.extent {
                Extent::Rectangle { half_right, half_up } => ways.push(center + half_right * x + half_up * y),
                Extent::Sphere { radius_m } if in_disc => ways.push(center + (u * x + v * y) * radius_m),
                Extent::Disc { radius_rad } if in_disc => ways.push(center + (u * x + v * y) * radius_rad.tan()),
                _ => {}
            }
        }
        ways
    }

    /// How often the way passes through the triangle, counted as its corners turn counter-clockwise seen from the light.
    fn crossings(point: DVec3, way: DVec3, [a, b, c]: [DVec3; 3], is_endless: bool) -> i32 {
        let normal = (b - a).cross(c - a);
        let t = normal.dot(a - point) / normal.dot(way);
        let at = point + way * t;
        let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| normal.dot((q - p).cross(at - p)) > 0.0);
        let is_between = t > 0.0 && (is_endless || t < 1.0);
        if is_between && sides == [true; 3] { normal.dot(way).signum() as i32 } else { 0 }
    }

    /// Whether the triangle cuts through the light, as far as a ball around that tells.
    fn cuts(light: &Light, point: DVec3, corners: [DVec3; 3]) -> bool {
        if light.position.is_directional() {
            return false;
        }
        let center = light.position.homogeneous().truncate();
        let ahead = match light.extent {
            Extent::Rectangle { half_right, half_up } => half_right.cross(half_up),
            _ => center - point,
        };
        let heights = corners.map(|corner| ahead.dot(corner - center));
        let ends: Vec<DVec3> = [(0, 1), (1, 2), (2, 0)]
            .into_iter()
            .filter(|&(i, j)| (heights[i] > 0.0) != (heights[j] > 0.0))
            .map(|(i, j)| corners[i].lerp(corners[j], heights[i] / (heights[i] - heights[j])) - center)
            .collect();
        let &[start, end] = ends.as_slice() else { return false };
        let along = end - start;
        let nearest = start + along * (-start.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        nearest.length() < light.extent.radius_m()
    }

    /// Any triangle but one that cuts the light: nearer to it than its radius, beyond it, behind the point, around both.
    #[test]
    fn random_triangles_cover_what_random_points_of_the_light_say() {
        let mut seed = 5;
        for light in [ball(0.7), ball(2.5), panel(), sun()] {
            let is_endless = light.position.is_directional();
            let mut partly = 0;
            for _ in 0..300 {
                let mut at = || DVec3::new(random(&mut seed), random(&mut seed), random(&mut seed));
                let point = at() * 0.5;
                let corners = [(); 3].map(|()| DVec3::new(0.15, -0.1, 2.0) + at() * DVec3::new(2.0, 2.0, 3.5));
                if cuts(&light, point, corners) {
                    continue;
                }
                let face = LightFace::new(&light, point).expect("it has a face");
                let edges = [[0, 1], [1, 2], [2, 0]].map(|[i, j]| face.edge_share(corners[i], corners[j]));
                let center = light.position.offset_from(point);
                let share = f64::from(crossings(point, center, corners, is_endless)) + edges.iter().sum::<f64>();
                let ways = samples(&light, point, &mut seed, 4000);
                let count: i32 = ways.iter().map(|&way| crossings(point, way, corners, is_endless)).sum();
                let expected = f64::from(count) / ways.len() as f64;
                assert!((share - expected).abs() < 0.04, "{share} and {expected} of {:?}: {corners:?}", light.extent);
                partly += usize::from((0.02..0.98).contains(&expected.abs()));
            }
            assert!(partly > 30, "{partly} were seen in part before {:?}", light.extent);
        }
    }

    #[test]
    fn shares_add_up_to_the_closed_form_of_the_projected_loop() {
        let (light, point) = (sun(), DVec3::ZERO);
        let face = LightFace::new(&light, point).expect("it has a face");
        let ahead = light.position.homogeneous().truncate();
        let (u, v) = ahead.any_orthonormal_pair();
        let mut seed = 9;
        for _ in 0..100 {
            let corners = [(); 5].map(|()| DVec2::new(random(&mut seed), random(&mut seed)) * 1.5);
            let heights = [(); 5].map(|()| 3.0 + 2.5 * random(&mut seed));
            let at = |i: usize| (ahead + (u * corners[i].x + v * corners[i].y) * 0.2_f64.tan()) * heights[i];
            let share: f64 = (0..5).map(|i| face.edge_share(at(i), at((i + 1) % 5))).sum();
            let expected = disc_share([corners.as_slice()]);
            // The hard count is missing, which is a whole number.
            let error = share - expected;
            assert!((error - error.round()).abs() < 1e-9, "{share} and {expected}");
        }
    }

    #[test]
    fn a_straight_edge_far_and_wide_leaves_the_known_share() {
        let light = sun();
        let face = LightFace::new(&light, DVec3::ZERO).expect("it has a face");
        let ahead = light.position.homogeneous().truncate();
        let (u, v) = ahead.any_orthonormal_pair();
        for i in -19..20 {
            let t = f64::from(i) / 20.0 + 0.001;
            let at = |across: f64| ahead * 7.0 + (u * t + v * across) * 7.0 * 0.2_f64.tan();
            // Covered is what is further along u, so that the edge runs against v.
            let hard = f64::from(u8::from(t < 0.0));
            let share = hard + face.edge_share(at(1e4), at(-1e4));
            assert!((share - (t.acos() - t * (1.0 - t * t).sqrt()) / PI).abs() < 1e-9, "{share} at {t}");
        }
    }

    #[test]
    fn a_rectangle_shows_no_face_to_its_back() {
        assert!(LightFace::new(&panel(), DVec3::new(0.0, 0.0, 1.0)).is_some());
        assert!(LightFace::new(&panel(), DVec3::new(0.0, 0.0, 5.0)).is_none());
        assert!(LightFace::new(&light(LightPosition::point(DVec3::Z), Extent::Point), DVec3::ZERO).is_none());
    }
}
