//! The same body where its caster has moved to, without making it anew.
//!
//! Which corners share a normal was decided where the body was made; a fold that closes or opens while it moves makes no crease there and takes none
//! away. Wedges, edges and creases stay, and so does what is known of how they are bent. Nothing is searched for in a tree, which would have to
//! be made again: each wedge and each edge between wedges is looked at once for a light.

use glam::DVec3;

use crate::{Bounds, Caster, LightPosition};

use super::body::{MOST_BULGE, SmoothBody, longest_edge_m};
use super::normals::{corner_angles_rad, face_normal};

impl SmoothBody {
    /// Moves the body to where `caster` is now, which is the one that it was made of, or one with the same mesh.
    ///
    /// Normals become the means of those of the triangles that meet there, weighted by angle as in [`super::corner_normals`], whatever they were before: over
    /// the same corners, so that a file's own normals, and those of corners that stood alone because they were too far from the mean, are not kept.
    /// A caster that was turned inside out on the way casts a closed shadow, but no right one. Takes about a tenth of a microsecond a triangle.
    ///
    /// # Panics
    ///
    /// If the caster has fewer vertices than the one that the body was made of.
    pub fn pose_to(&mut self, caster: &Caster) {
        for (place, &v) in self.wedges.positions.iter_mut().zip(&self.vertex_of_wedge) {
            *place = caster.positions[v as usize];
        }
        self.wedges.bounds = caster.bounds;
        let mut sums = vec![DVec3::ZERO; self.normals.len()];
        for (t, corners) in self.wedges.mesh.triangles().iter().enumerate() {
            let face = face_normal(&self.wedges, t);
            for (&w, angle_rad) in corners.iter().zip(corner_angles_rad(&self.wedges, t)) {
                sums[w as usize] += face * angle_rad;
            }
        }
        for (normal, sum) in self.normals.iter_mut().zip(sums) {
            *normal = sum.normalize_or_zero().as_vec3();
        }
        self.longest_edge_m = longest_edge_m(&self.wedges);
        self.bend();
        (self.finder, self.planes) = (None, None);
    }

    /// [`SmoothBody::loose_bounds`] where `caster`, the one that the body was made of, is now, without moving the body there. The caster's box may be wider than
    /// its positions need, if something takes them from there by as much as the box is wider; then curves are that much longer too.
    ///
    /// Linear in the number of edges.
    pub fn loose_bounds_at(&self, caster: &Caster) -> Bounds {
        let held = Bounds::of_points(caster.positions.iter().map(|p| p.as_dvec3()));
        let bounds = caster.bounds;
        let wider_m = (held.min - bounds.min).max(bounds.max - held.max).max_element().max(0.0);
        let grown = DVec3::splat(MOST_BULGE * (longest_edge_m(caster) + 2.0 * wider_m));
        Bounds { min: bounds.min - grown, max: bounds.max + grown }
    }

    /// Of each wedge, 1 where it is turned to `light`, else 0; and the edges from one that is to one that is not.
    pub(super) fn find(&self, light: LightPosition, turned: &mut Vec<i8>, found: &mut Vec<[u32; 2]>) {
        if let Some(finder) = &self.finder {
            finder.turned(light, turned);
            finder.find(light, found);
            return;
        }
        turned.clear();
        found.clear();
        turned.extend((0..self.normals.len() as u32).map(|w| i8::from(self.height(w, light) > 0.0)));
        for edge in self.wedges.topology.edges() {
            match [edge.low, edge.high].map(|w| turned[w as usize]) {
                [1, 0] => found.push([edge.low, edge.high]),
                [0, 1] => found.push([edge.high, edge.low]),
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::shapes;
    use crate::smooth::tests::caster_of;
    use crate::{Precision, SmoothVolume, Smoothness, corner_normals};

    const CREASE_RAD: f64 = 0.76;

    fn body_of(caster: &Caster) -> SmoothBody {
        SmoothBody::new(caster, &corner_normals(caster, &[], CREASE_RAD)).expect("it is round")
    }

    /// Bent about the x axis, more where z is more.
    fn bent(caster: &Caster, by: f64) -> Caster {
        let mut bent = caster.clone();
        for p in &mut bent.positions {
            let (sin, cos) = (by * f64::from(p.z)).sin_cos();
            *p = DVec3::new(p.x.into(), f64::from(p.y) * cos - sin, f64::from(p.y) * sin + cos * f64::from(p.z))
                .as_vec3();
        }
        bent.bounds = Bounds::of_points(bent.positions.iter().map(|p| p.as_dvec3()));
        bent
    }

    fn suns() -> impl Iterator<Item = LightPosition> {
        (0..12).map(|i| {
            let (sin, cos) = (0.7 * f64::from(i) + 0.1).sin_cos();
            LightPosition::directional(DVec3::new(cos, sin, 0.3 - 0.1 * f64::from(i % 7))).expect("not zero")
        })
    }

    #[test]
    fn a_body_that_has_moved_is_the_one_that_would_be_made_there() {
        let smoothness = Smoothness::Smooth(Precision::in_world(0.01));
        let cylinder = caster_of(shapes::cylinder(Vec3::NEG_Z, 1.0, 2.0, 24));
        let mut posed = body_of(&cylinder);
        for by in [0.0, 0.15, -0.1] {
            let there = bent(&cylinder, by);
            let made = body_of(&there);
            posed.pose_to(&there);
            assert_eq!(posed.normals.len(), made.normals.len(), "the crease angle splits both alike");
            for (a, b) in posed.normals.iter().zip(&made.normals) {
                assert!(a.distance(*b) < 1e-5, "{a} is not {b}");
            }
            for light in suns() {
                let [ours, theirs] = [&posed, &made].map(|body| SmoothVolume::new(body, light, &smoothness));
                let length_m = |volume: &SmoothVolume| -> f64 {
                    let of =
                        |side: &[u32; 2]| volume.points[side[0] as usize].distance(volume.points[side[1] as usize]);
                    volume.sides.iter().map(of).sum::<f32>().into()
                };
                assert!((length_m(&ours) - length_m(&theirs)).abs() < 1e-3 * length_m(&theirs));
                assert!(length_m(&ours) > 4.0);
            }
        }
    }

    #[test]
    fn no_curve_leaves_the_box_that_is_told_beforehand() {
        let tube = caster_of(shapes::tube(&[Vec3::ZERO, Vec3::X, Vec3::new(1.5, 1.0, 0.5)], 0.3, 6));
        let mut body = body_of(&tube);
        for by in [0.0, 0.9] {
            let there = bent(&tube, by);
            let foretold = body.loose_bounds_at(&there);
            body.pose_to(&there);
            assert_eq!(foretold, body.loose_bounds());
            for light in suns() {
                let volume = SmoothVolume::new(&body, light, &Smoothness::Smooth(Precision::in_world(1e-3)));
                assert!(volume.points.iter().all(|p| foretold.union(Bounds::of_points([p.as_dvec3()])) == foretold));
            }
        }
    }
}
