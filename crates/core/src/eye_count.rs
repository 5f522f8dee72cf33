//! How many volumes hold the near rectangle: the number that lets z-pass count from within a shadow.
//!
//! Source: the lecture notes "Shadow volumes", section 3: where N volumes hold the viewpoint, a point is lit where its count is -N. The
//! viewpoint must be read as the near rectangle, where counting starts: the eye itself may be in a volume that no point of the rectangle
//! is in. M. McGuire et al. 2003, section 3, say that no number will do where a volume crosses the rectangle; there is none then.

use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::winding::near_rectangle_region;
use crate::{Bounds, Camera, Caster, Chain, ConvexRegion, LightPosition, ShadowVolume};

/// Where in the near rectangle counting is tried, in its width and height. No two are on a line through a third or on a diagonal, where
/// models that are built to the camera have their edges.
const TRIED: [[f64; 2]; 6] = [[0.5, 0.5], [0.37, 0.58], [0.71, 0.33], [0.18, 0.24], [0.83, 0.79], [0.29, 0.91]];
/// A directional light is looked for this many times farther away than anything is from anything else.
const FAR: f64 = 1e3;

/// The near rectangle and the light.
#[derive(Debug, Clone)]
pub(crate) struct NearPlace {
    rectangle: [DVec3; 4],
    region: ConvexRegion,
    light: LightPosition,
}

impl NearPlace {
    pub(crate) fn new(camera: &Camera, light: LightPosition, slack: f64) -> Self {
        Self { rectangle: camera.near_rectangle(), region: near_rectangle_region(camera, slack), light }
    }

    /// The number of volumes over `chain` that hold all of the rectangle; `pyramid` holds it and the light.
    pub(crate) fn count(
        &self,
        caster: &Caster,
        chain: &Chain,
        volume: &ShadowVolume,
        pyramid: &ConvexRegion,
    ) -> Option<u32> {
        let at = |i: u32| caster.positions[i as usize].as_dvec3();
        // A side crosses the rectangle where its edge is between the rectangle and the light; a light cap where it is in it.
        if volume.sides.iter().any(|edge| pyramid.meets_segment(edge.map(at)))
            || volume.light_cap.iter().any(|triangle| self.region.meets_triangle(triangle.map(at)))
        {
            return None;
        }
        let [a, b, _, d] = self.rectangle;
        let places = TRIED.map(|[x, y]| a + (b - a) * x + (d - a) * y);
        places.into_iter().find_map(|place| count_at(place, caster, chain, self.light))
    }
}

/// How often triangles of `chain` are between `place` and the light; `None` where one is met at its border.
fn count_at(place: DVec3, caster: &Caster, chain: &Chain, light: LightPosition) -> Option<u32> {
    let end = if light.is_directional() {
        // A light far away will do: the count is the same for all directions that edges are not close to.
        let reach = Bounds::of_points([place]).union(caster.bounds).radius();
        place + light.homogeneous().truncate() * (FAR * reach)
    } else {
        light.homogeneous().truncate()
    };
    let mut count = 0;
    for (t, &times) in chain.coefficients().iter().enumerate() {
        if times != 0 {
            count += i32::from(times) * crossing(place, end, caster.corners(t).map(glam::Vec3::as_dvec3))?;
        }
    }
    u32::try_from(count).ok()
}

/// +1 where the way from `p` to `q` comes out of the front of the triangle, -1 out of its back, 0 where it misses. Exact.
fn crossing(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> Option<i32> {
    let way = Bounds::of_points([p, q]);
    if !way.meets(&Bounds::of_points([a, b, c])) {
        return Some(0);
    }
    let [from, to] = [turn(a, b, c, p), turn(a, b, c, q)];
    if from * to > 0 {
        return Some(0);
    }
    let around = [turn(p, q, a, b), turn(p, q, b, c), turn(p, q, c, a)];
    if around.contains(&1) && around.contains(&-1) {
        return Some(0);
    }
    if from == 0 || to == 0 || around.contains(&0) {
        return None;
    }
    Some(-from)
}

/// +1 where `d` is on the side of `abc` from which it is counter-clockwise, -1 on the other, 0 in its plane.
fn turn(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i32 {
    let [a, b, c, d] = [a, b, c, d].map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
    // Positive below, that is where `abc` is seen clockwise.
    let below = orient3d(a, b, c, d);
    if below == 0.0 { 0 } else { -below.signum() as i32 }
}
