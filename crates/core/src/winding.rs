//! Where the eye stands with respect to closed bodies, which decides how they may be counted.
//!
//! Counting only the faces that turn to the light ([`Counting::Facing`]) is right where a body's winding number is
//! not negative: outside, and inside a body wound outwards. Within a body wound inwards, or in a pocket where a surface
//! passes through itself the wrong way, it would call dark points lit. What a picture shows can be reached from the near
//! rectangle without crossing a surface, so the winding number there is the winding number of all of it.
//!
//! Not in the papers, which assume an eye outside of solid bodies, wound outwards.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::{Bounds, Camera, Caster, ConvexRegion, Counting};

/// The near rectangle is taken to be this much thicker than it is, relative to its distance from the origin: `f32`
/// rounding on the GPU moves it by no more.
const SLACK: f64 = 4e-6;

/// For each component of `caster` the cheapest [`Counting`] that is right for everything `camera` can see.
///
/// Open, non-manifold and inconsistently wound components always count every triangle; a closed one does when the near rectangle cuts it, or
/// lies where its winding number is negative. Cheap where the eye is outside the boxes; else linear in the triangles.
pub fn counting_for_view(caster: &Caster, camera: &Camera) -> Vec<Counting> {
    let mut counting = Counting::outside(caster);
    let rectangle = camera.near_rectangle();
    let near_bounds = Bounds::of_points(rectangle);
    let scale = camera.eye().abs().max_element().max(near_bounds.max.abs().max_element());
    let slack = SLACK * scale.max(caster.bounds.max.abs().max_element()).max(caster.bounds.min.abs().max_element());
    let widened =
        Bounds { min: caster.bounds.min - DVec3::splat(slack), max: caster.bounds.max + DVec3::splat(slack) };
    if !near_bounds.meets(&widened) {
        return counting;
    }

    let near_region = near_rectangle_region(camera, slack);
    let middle = camera.eye() + camera.axes()[2] * camera.near();
    let mut winding = vec![0; counting.len()];
    for (t, &component) in caster.topology.component_of_triangle().iter().enumerate() {
        let component = component as usize;
        if counting[component] == Counting::Every {
            continue;
        }
        let corners = caster.corners(t).map(|p| p.as_dvec3());
        if near_region.meets_triangle(corners) {
            counting[component] = Counting::Every;
        } else {
            winding[component] += crossings_above(middle, corners);
        }
    }
    for (counting, winding) in counting.iter_mut().zip(winding) {
        if winding < 0 {
            *counting = Counting::Every;
        }
    }
    counting
}

/// The near rectangle as a thin slab.
fn near_rectangle_region(camera: &Camera, slack: f64) -> ConvexRegion {
    let [right, up, forward] = camera.axes();
    let [top_left, _, bottom_right, _] = camera.near_rectangle();
    let mut region = ConvexRegion::default();
    for (point, inwards) in [
        (top_left, forward),
        (top_left, -forward),
        (top_left, right),
        (top_left, -up),
        (bottom_right, -right),
        (bottom_right, up),
    ] {
        region.add(point, inwards, slack);
    }
    region
}

/// How often, with sign, the upward ray from `p` leaves through the triangle: +1 through its back, -1 through its front, else 0.
///
/// Exact, and half-open on shared edges, so that the sum over a closed surface is its winding number wherever `p` is off it.
fn crossings_above(p: DVec3, corners: [DVec3; 3]) -> i32 {
    let highest = corners.iter().map(|c| c.z).fold(f64::NEG_INFINITY, f64::max);
    if highest < p.z {
        return 0;
    }
    let flat = |v: DVec3| Coord { x: v.x, y: v.y };
    let mut around = 0;
    for i in 0..3 {
        let (u, v) = (corners[i], corners[(i + 1) % 3]);
        if (u.y <= p.y) == (v.y <= p.y) {
            continue;
        }
        // Counts the edge where it crosses the ray from p along +x.
        let side = orient2d(flat(u), flat(v), flat(p));
        if u.y <= p.y && side > 0.0 {
            around += 1;
        } else if u.y > p.y && side < 0.0 {
            around -= 1;
        }
    }
    if around == 0 {
        return 0;
    }
    let solid = |v: DVec3| Coord3D { x: v.x, y: v.y, z: v.z };
    // Positive where p is below a triangle that is counter-clockwise seen from above.
    let below = orient3d(solid(corners[0]), solid(corners[1]), solid(corners[2]), solid(p)) * f64::from(around);
    if below > 0.0 { around } else { 0 }
}
