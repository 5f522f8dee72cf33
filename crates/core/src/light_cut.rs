//! What reaches into a light that has a size.
//!
//! Soft shadows are those of silhouettes that lie between the light and what it shines on. Where a surface cuts the light itself, the border of what it hides
//! runs over that surface, on no silhouette, and is not to be found.

use glam::DVec3;

use crate::{ConvexRegion, Extent, Light, Sphere};

/// A triangle must pass through a rectangle by more than this part of its half diagonal, so that lamps may be flush with what they are mounted on.
const FLUSH: f64 = 1e-6;

impl Light {
    /// Whether the triangle reaches into the light: nearer to its middle than its radius, or through its rectangle. Never into a point or the sun's disc.
    pub fn is_cut_by(&self, corners: [DVec3; 3]) -> bool {
        let middle = self.position.homogeneous().truncate();
        match self.extent {
            Extent::Point | Extent::Disc { .. } => false,
            Extent::Sphere { radius_m } => distance_to_triangle(middle, corners) < radius_m,
            Extent::Rectangle { half_right, half_up } => {
                let flush_m = FLUSH * self.extent.radius_m();
                let normal = half_right.cross(half_up).normalize_or_zero();
                let heights = corners.map(|corner| (corner - middle).dot(normal));
                let is_through = heights.iter().any(|&h| h > flush_m) && heights.iter().any(|&h| h < -flush_m);
                is_through && {
                    let mut region = ConvexRegion::default();
                    for half in [half_right, -half_right, half_up, -half_up] {
                        region.add(middle + half, -half.normalize_or_zero(), 0.0);
                    }
                    region.add(middle, normal, flush_m);
                    region.add(middle, -normal, flush_m);
                    region.meets_triangle(corners)
                }
            }
        }
    }
}

impl Light {
    /// Whether the surface of `sphere` reaches into the light. Never into a point or the sun's disc.
    pub fn is_cut_by_sphere(&self, sphere: &Sphere) -> bool {
        let off = sphere.center - self.position.homogeneous().truncate();
        let [nearest_m, farthest_m] = match self.extent {
            Extent::Point | Extent::Disc { .. } => return false,
            Extent::Sphere { radius_m } => [off.length() - radius_m, off.length() + radius_m],
            Extent::Rectangle { half_right, half_up } => {
                let within = [half_right, half_up]
                    .map(|half| half * (off.dot(half) / half.length_squared()).clamp(-1.0, 1.0))
                    .into_iter()
                    .sum();
                let corners = [half_right + half_up, half_right - half_up];
                let farthest_m = corners.iter().flat_map(|&c| [off.distance(c), off.distance(-c)]).fold(0.0, f64::max);
                [off.distance(within), farthest_m]
            }
        };
        nearest_m < sphere.radius && sphere.radius < farthest_m
    }
}

/// From `point` to the nearest point of the triangle, which may be as thin as a line; not a number if it is a point.
pub fn distance_to_triangle(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let sides = [[a, b], [b, c], [c, a]];
    let is_above = |[from, to]: [DVec3; 2]| (to - from).cross(point - from).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && sides.into_iter().all(is_above) {
        return (point - a).dot(normal).abs();
    }
    let to_side = |[from, to]: [DVec3; 2]| {
        let along = to - from;
        let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        point.distance(from + along * share)
    };
    sides.map(to_side).into_iter().fold(f64::NAN, f64::min)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::LightPosition;

    fn lamp(extent: Extent) -> Light {
        Light { extent, ..Light::new("lamp", LightPosition::point(DVec3::new(1.0, 2.0, 4.0)), Vec3::ONE) }
    }

    /// Triangles about the lamp's middle.
    fn around(corners: [[f64; 3]; 3]) -> [DVec3; 3] {
        corners.map(|corner| DVec3::new(1.0, 2.0, 4.0) + DVec3::from(corner))
    }

    #[test]
    fn a_ball_is_cut_by_what_is_nearer_than_its_radius() {
        let ball = lamp(Extent::Sphere { radius_m: 0.5 });
        let wall = |x: f64| around([[x, -9.0, -9.0], [x, 9.0, -9.0], [x, 0.0, 9.0]]);
        assert_eq!([0.0, 0.49, 0.51].map(|x| ball.is_cut_by(wall(x))), [true, true, false]);
        let corner = |x: f64| around([[x, 0.0, 0.0], [3.0, 1.0, 0.0], [3.0, 0.0, 1.0]]);
        assert_eq!([0.49, 0.51].map(|x| ball.is_cut_by(corner(x))), [true, false]);
        assert!(ball.is_cut_by(around([[0.1, 0.0, 0.0], [0.1, 0.1, 0.0], [0.1, 0.0, 0.1]])), "wholly inside");
        let line = |x: f64| around([[x, -1.0, 0.0], [x, 2.0, 0.0], [x, 1.0, 0.0]]);
        assert_eq!([0.49, 0.51].map(|x| ball.is_cut_by(line(x))), [true, false]);
    }

    #[test]
    fn a_sphere_cuts_a_light_unless_it_misses_or_holds_it() {
        let sphere = |x: f64, y: f64, radius: f64| Sphere {
            name: String::new(),
            center: DVec3::new(1.0 + x, 2.0 + y, 4.0),
            radius,
            base_color: Vec3::ONE,
        };
        let ball = lamp(Extent::Sphere { radius_m: 0.5 });
        let cut = [(2.0, 1.4), (2.0, 1.6), (2.0, 2.4), (2.0, 2.6), (0.0, 0.1), (0.0, 0.4), (0.0, 0.6)];
        let expected = [false, true, true, false, true, true, false];
        assert_eq!(cut.map(|(x, radius)| ball.is_cut_by_sphere(&sphere(x, 0.0, radius))), expected);
        assert!(ball.is_cut_by_sphere(&sphere(0.45, 0.0, 0.1)), "its surface is partly inside");
        let panel = lamp(Extent::Rectangle { half_right: DVec3::Y * 0.4, half_up: DVec3::X * 0.6 });
        let cut =
            [(2.0, 0.0, 1.3), (2.0, 0.0, 1.5), (2.0, 0.0, 2.7), (0.0, 0.0, 0.1), (0.0, 0.0, 0.8), (0.0, 1.0, 0.5)];
        let expected = [false, true, false, true, false, false];
        assert_eq!(cut.map(|(x, y, radius)| panel.is_cut_by_sphere(&sphere(x, y, radius))), expected);
        assert!(!lamp(Extent::Point).is_cut_by_sphere(&sphere(0.0, 0.0, 1.0)));
    }

    #[test]
    fn a_rectangle_is_cut_by_what_goes_through_it_and_not_by_what_it_is_mounted_on() {
        let panel = lamp(Extent::Rectangle { half_right: DVec3::Y * 0.4, half_up: DVec3::X * 0.6 });
        let wall = |x: f64| around([[x, -9.0, -9.0], [x, 9.0, -9.0], [x, 0.0, 9.0]]);
        assert_eq!([0.0, 0.59, 0.61].map(|x| panel.is_cut_by(wall(x))), [true, true, false]);
        let level = |z: f64| around([[-9.0, -9.0, z], [9.0, -9.0, z], [0.0, 9.0, z]]);
        assert_eq!([0.0, 1e-8, 0.1].map(|z| panel.is_cut_by(level(z))), [false; 3]);
        let hanging = |top: f64| around([[0.1, 0.1, top], [0.2, 0.1, -1.0], [0.1, 0.2, -1.0]]);
        assert_eq!([-0.1, 0.0, 0.1].map(|top| panel.is_cut_by(hanging(top))), [false, false, true]);
    }

    #[test]
    fn nothing_cuts_a_point_or_the_sun() {
        let through = around([[-1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]]);
        assert!(!lamp(Extent::Point).is_cut_by(through));
        let sun = Light {
            extent: Extent::Disc { radius_rad: 0.1 },
            ..Light::new("sun", LightPosition::sun(1.0, 1.0), Vec3::ONE)
        };
        assert!(!sun.is_cut_by(through));
    }
}
