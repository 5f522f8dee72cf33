//! Convex regions as half-spaces, and what meets them.

use glam::{DVec3, DVec4};

use crate::Bounds;
use crate::few::Few;

/// The points on the inner side of every plane; may be unbounded.
///
/// A plane `(n, d)` has unit normal `n` and holds the points with `n . p + d >= 0`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConvexRegion {
    planes: Few<DVec4, 16>,
}

impl ConvexRegion {
    /// Adds the half-space through `point` on the side to which `normal` points, moved outwards by `slack`.
    ///
    /// A zero normal adds nothing: the region stays too large rather than wrong.
    pub fn add(&mut self, point: DVec3, normal: DVec3, slack: f64) {
        if let Some(n) = normal.try_normalize() {
            self.planes.push(n.extend(slack - n.dot(point)));
        }
    }

    /// Whether the homogeneous point is in the region; one at infinity (`w = 0`) is where the region reaches to infinity that way.
    pub fn contains(&self, point: DVec4) -> bool {
        self.planes.iter().all(|plane| plane.dot(point) >= 0.0)
    }

    /// The planes, each with its unit normal inwards.
    pub fn planes(&self) -> &[DVec4] {
        &self.planes
    }

    /// `false` only when no point of `bounds` is in the region. Looks at one plane at a time, so a box near a corner of the
    /// region may pass though it misses.
    pub fn may_meet_box(&self, bounds: &Bounds) -> bool {
        self.planes.iter().all(|plane| {
            let n = plane.truncate();
            let farthest = DVec3::select(n.cmpgt(DVec3::ZERO), bounds.max, bounds.min);
            n.dot(farthest) + plane.w >= 0.0
        })
    }

    /// Whether the region and the closed segment have a point in common.
    pub fn meets_segment(&self, ends: [DVec3; 2]) -> bool {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for plane in self.planes() {
            let (start, end) = (distance(plane, ends[0]), distance(plane, ends[1]));
            if start < 0.0 && end < 0.0 {
                return false;
            }
            if start < 0.0 {
                from = from.max(start / (start - end));
            } else if end < 0.0 {
                to = to.min(start / (start - end));
            }
        }
        from <= to
    }

    /// Whether the region and the closed triangle have a point in common.
    pub fn meets_triangle(&self, corners: [DVec3; 3]) -> bool {
        // Most triangles are outside one plane.
        let is_outside = |plane: &DVec4| corners.iter().all(|&p| distance(plane, p) < 0.0);
        if self.planes.iter().any(is_outside) {
            return false;
        }
        // Each plane adds a corner at most.
        let (mut polygon, mut clipped) = (Few::<DVec3, 20>::default(), Few::default());
        polygon.extend(corners);
        for plane in self.planes() {
            clipped.clear();
            for (i, &p) in polygon.iter().enumerate() {
                let q = polygon[(i + 1) % polygon.len()];
                let (at_p, at_q) = (distance(plane, p), distance(plane, q));
                if at_p >= 0.0 {
                    clipped.push(p);
                }
                if (at_p >= 0.0) != (at_q >= 0.0) {
                    clipped.push(p + (q - p) * (at_p / (at_p - at_q)));
                }
            }
            std::mem::swap(&mut polygon, &mut clipped);
            if polygon.is_empty() {
                return false;
            }
        }
        true
    }
}

fn distance(plane: &DVec4, p: DVec3) -> f64 {
    plane.truncate().dot(p) + plane.w
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_cube() -> ConvexRegion {
        let mut region = ConvexRegion::default();
        for axis in DVec3::AXES {
            region.add(DVec3::ZERO, axis, 0.0);
            region.add(DVec3::ONE, -axis, 0.0);
        }
        region
    }

    #[test]
    fn a_triangle_that_cuts_a_corner_with_all_vertices_outside_meets_the_cube() {
        let cut = [DVec3::new(1.4, 0.0, 0.5), DVec3::new(0.0, 1.4, 0.5), DVec3::new(1.4, 1.4, 0.5)];
        assert!(unit_cube().meets_triangle(cut));
    }

    #[test]
    fn a_triangle_that_passes_a_corner_closely_misses_the_cube() {
        let pass = [DVec3::new(2.1, 0.0, 0.5), DVec3::new(0.0, 2.1, 0.5), DVec3::new(2.1, 2.1, 0.5)];
        assert!(!unit_cube().meets_triangle(pass));
    }

    #[test]
    fn a_triangle_around_the_whole_cube_meets_it() {
        let around = [DVec3::new(-9.0, -9.0, 0.5), DVec3::new(9.0, -9.0, 0.5), DVec3::new(0.0, 9.0, 0.5)];
        assert!(unit_cube().meets_triangle(around));
    }
}
