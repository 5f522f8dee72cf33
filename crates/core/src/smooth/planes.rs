//! How the triangles of a body lie, once for all lights: nearly all of them face the way that their normals do, and that is told without a look at their corners.

use glam::{DVec3, Vec4};
use rayon::prelude::*;

use crate::LightPosition;

use super::body::SmoothBody;

/// A light higher than this above a plane, as a part of its distance, is above it for all that `f32` can tell.
const SURELY: f32 = 1e-5;

/// For each triangle the planes through its corners, where they are and [where they are moved](SmoothBody::inner_places).
#[derive(Debug, Clone)]
pub(super) struct Planes {
    planes: Vec<[Vec4; 2]>,
    /// No coordinate is more.
    farthest: f32,
}

/// The planes of a body and a light.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heights<'a> {
    planes: &'a [[Vec4; 2]],
    light: Vec4,
    unsure: f32,
}

impl Planes {
    pub(super) fn new(body: &SmoothBody) -> Self {
        let planes = body.wedges.mesh.triangles().par_iter().map(|corners| {
            [
                plane(corners.map(|w| body.place(w))),
                plane(corners.map(|w| body.inner[body.vertex_of_wedge[w as usize] as usize].as_dvec3())),
            ]
        });
        let places = body.wedges.positions.iter().chain(&body.inner);
        Self { planes: planes.collect(), farthest: places.map(|p| p.abs().max_element()).fold(0.0, f32::max) }
    }

    pub(super) fn under(&self, light: LightPosition) -> Heights<'_> {
        let light = light.homogeneous().as_vec4();
        let unsure = SURELY * (light.truncate().length() + light.w * self.farthest);
        Heights { planes: &self.planes, light, unsure }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.planes.as_slice())
    }
}

impl Heights<'_> {
    /// Whether triangle `t` faces the light, where its corners are and where they are moved.
    pub(super) fn surely_faces(&self, t: usize) -> bool {
        self.planes[t].iter().all(|plane| plane.dot(self.light) > self.unsure)
    }

    /// Whether triangle `t` faces away where its corners are moved.
    pub(super) fn surely_faces_away(&self, t: usize) -> bool {
        self.planes[t][1].dot(self.light) < -self.unsure
    }
}

/// The plane's unit normal, and minus its height above the origin; 0 if there is none.
fn plane([a, b, c]: [DVec3; 3]) -> Vec4 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal.extend(-normal.dot(a)).as_vec4()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use crate::smooth::tests::{body_of, caster_of, lights};

    #[test]
    fn what_is_sure_is_so_and_most_is_sure() {
        let body = body_of(&caster_of(shapes::torus(glam::Vec3::new(3.0, -40.0, 1.0), 1.0, 0.4, 24, 12)));
        let planes = Planes::new(&body);
        let (mut sure, mut all) = (0, 0);
        for light in lights() {
            let heights = planes.under(light);
            for (t, corners) in body.wedges.mesh.triangles().iter().enumerate() {
                let towards = |places: [DVec3; 3]| {
                    let [a, b, c] = places;
                    (b - a).cross(c - a).dot(light.offset_from(a))
                };
                let own = towards(corners.map(|w| body.place(w)));
                let inner = towards(corners.map(|w| body.inner[body.vertex_of_wedge[w as usize] as usize].as_dvec3()));
                assert!(!heights.surely_faces(t) || (own > 0.0 && inner > 0.0), "{t}: {own} and {inner}");
                assert!(!heights.surely_faces_away(t) || inner < 0.0, "{t}: {inner}");
                sure += usize::from(heights.surely_faces(t) || heights.surely_faces_away(t));
                all += 1;
            }
        }
        assert!(10 * sure > 9 * all, "{sure} of {all}");
    }
}
