//! Where the eye and the light stand with respect to closed bodies, which decides how they may be counted.
//!
//! ```text
//!   w = 0   ______________        On the way from a point P to the light L, a closed surface is crossed so
//!          |  w = 1       |       often from its front (F) and from its back (B) that
//!    P * ==B=====>* L     |
//!          |______________|           F - B = w(P) - w(L)      (w: winding number)
//! ```
//!
//! So where w(P) >= w(L), no F means no B: counting the triangles that face the light ([`Counting::Facing`]) finds every
//! occluder. That is the textbook's case: eye and light outside. Where w(P) < w(L), no B means no F, and those that face away
//! ([`Counting::FacingAway`]) must be counted: a lamp in a closed lampshade, a room of a body wound inwards. What a picture shows can
//! be reached from the near rectangle without crossing a surface, so P's winding number is that of the near rectangle; where the surface cuts
//! the rectangle, or holds the light, it is not one number and every triangle must count.
//!
//! Not in the papers, which assume eye and light outside of solid bodies, wound outwards.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::{Bounds, Camera, Caster, ConvexRegion, Counting, LightPosition};

/// Regions are widened by this much of the coordinates' size: `f32` rounding on the GPU moves things by no more.
const SLACK: f64 = 4e-6;

/// For each component of a caster, how often it winds around a place; `None` where its surface passes through the place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Windings(Vec<Option<i32>>);

impl Windings {
    /// Around the near rectangle of `camera`. Cheap where it is outside the caster's box, else linear in the triangles.
    pub fn of_near_rectangle(caster: &Caster, camera: &Camera) -> Self {
        let rectangle = camera.near_rectangle();
        let middle = camera.eye() + camera.axes()[2] * camera.near();
        let slack = slack(&caster.bounds, camera.eye());
        Self::of_place(caster, &Bounds::of_points(rectangle), middle, slack, || near_rectangle_region(camera, slack))
    }

    /// Around `light`: nowhere for a directional one. Cheap as [`Windings::of_near_rectangle`].
    pub fn of_light(caster: &Caster, light: LightPosition) -> Self {
        let position = light.homogeneous().truncate();
        if light.is_directional() { Self::outside(caster) } else { Self::of_point(caster, position) }
    }

    /// Around `point`. Cheap as [`Windings::of_near_rectangle`].
    pub fn of_point(caster: &Caster, point: DVec3) -> Self {
        let slack = slack(&caster.bounds, point);
        let place = Bounds { min: point, max: point };
        Self::of_place(caster, &place, point, slack, || {
            let mut region = ConvexRegion::default();
            for axis in DVec3::AXES {
                region.add(point, axis, slack);
                region.add(point, -axis, slack);
            }
            region
        })
    }

    fn outside(caster: &Caster) -> Self {
        Self(vec![Some(0); caster.topology.components().len()])
    }

    /// Around a connected place that has `bounds`, holds `point`, and is `region()`.
    fn of_place(
        caster: &Caster,
        bounds: &Bounds,
        point: DVec3,
        slack: f64,
        region: impl FnOnce() -> ConvexRegion,
    ) -> Self {
        let mut windings = Self::outside(caster);
        if !bounds.meets(&widened(&caster.bounds, slack)) {
            return windings;
        }
        let region = region();
        for (t, &component) in caster.topology.component_of_triangle().iter().enumerate() {
            let component = component as usize;
            if !caster.topology.components()[component].is_closed {
                continue;
            }
            if let Some(winding) = windings.0[component] {
                let corners = caster.corners(t).map(glam::Vec3::as_dvec3);
                let is_cut = region.meets_triangle(corners);
                windings.0[component] = (!is_cut).then(|| winding + crossings_above(point, corners));
            }
        }
        windings
    }
}

impl Counting {
    /// For each component of `caster` the cheapest counting that is right between `light` and everything that can be reached from
    /// `seen` without crossing a surface.
    pub fn choose(caster: &Caster, seen: &Windings, light: &Windings) -> Vec<Self> {
        let places = seen.0.iter().zip(&light.0);
        let of = |is_closed, seen: Option<i32>, light: Option<i32>| match (seen, light) {
            (Some(seen), Some(light)) if is_closed && seen >= light => Self::Facing,
            (Some(_), Some(_)) if is_closed => Self::FacingAway,
            _ => Self::Every,
        };
        caster.topology.components().iter().zip(places).map(|(c, (&s, &l))| of(c.is_closed, s, l)).collect()
    }

    /// How a closed component within `bounds` counts, of a caster within `caster`, when no triangle may be looked at: as
    /// [`Counting::choose`] would have it, or [`Counting::Every`] where the light or the near rectangle might be inside.
    pub fn of_box(bounds: &Bounds, caster: &Bounds, camera: &Camera, light: LightPosition) -> Self {
        let is_around = |place: Bounds, at: DVec3| place.meets(&widened(bounds, slack(caster, at)));
        let position = light.homogeneous().truncate();
        let is_around_light = !light.is_directional() && is_around(Bounds { min: position, max: position }, position);
        let is_around_eye = || is_around(Bounds::of_points(camera.near_rectangle()), camera.eye());
        if is_around_light || is_around_eye() { Self::Every } else { Self::Facing }
    }
}

fn slack(caster: &Bounds, place: DVec3) -> f64 {
    let reach = |p: DVec3| p.abs().max_element();
    SLACK * reach(place).max(reach(caster.min)).max(reach(caster.max))
}

fn widened(bounds: &Bounds, by: f64) -> Bounds {
    Bounds { min: bounds.min - DVec3::splat(by), max: bounds.max + DVec3::splat(by) }
}

/// The near rectangle as a thin slab.
pub(crate) fn near_rectangle_region(camera: &Camera, slack: f64) -> ConvexRegion {
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DAffine3;

    use super::*;
    use crate::{Mesh, Object, Topology, shapes};

    fn box_caster(mirror: bool) -> Caster {
        let surface = shapes::cuboid(glam::Vec3::splat(-1.0), glam::Vec3::ONE);
        let mesh = Arc::new(Mesh::new(surface).expect("a box is a good mesh"));
        let topology = Arc::new(Topology::new(&mesh));
        let scale = DVec3::new(if mirror { -1.0 } else { 1.0 }, 1.0, 1.0);
        Caster::new(&Object::new("box", mesh, DAffine3::from_scale(scale)), topology)
    }

    #[test]
    fn a_box_winds_once_around_what_it_holds_and_backwards_when_mirrored() {
        for (caster, inside) in [(box_caster(false), 1), (box_caster(true), -1)] {
            let winding = |x, y, z| Windings::of_point(&caster, DVec3::new(x, y, z)).0;
            assert_eq!(winding(0.2, 0.3, -0.4), [Some(inside)]);
            // On diagonals and edges of the faces above, where a careless count sees two or none.
            assert_eq!(winding(0.0, 0.0, 0.0), [Some(inside)]);
            assert_eq!(winding(0.5, 0.5, 0.0), [Some(inside)]);
            assert_eq!(winding(1.0, 0.0, 0.0), [None], "on a face");
            assert_eq!(winding(0.2, 0.3, -1.5), [Some(0)], "below: in and out again");
            assert_eq!(winding(0.2, 0.3, 1.5), [Some(0)]);
        }
    }

    #[test]
    fn a_lamp_in_a_closed_box_makes_the_faces_count_that_turn_away_from_it() {
        let caster = box_caster(false);
        let [inside, outside] = [DVec3::ZERO, DVec3::splat(3.0)].map(|p| Windings::of_point(&caster, p));
        assert_eq!(Counting::choose(&caster, &outside, &inside), [Counting::FacingAway]);
        assert_eq!(Counting::choose(&caster, &inside, &outside), [Counting::Facing]);
        assert_eq!(Counting::choose(&caster, &outside, &outside), [Counting::Facing]);
        assert_eq!(Counting::choose(&caster, &inside, &inside), [Counting::Facing]);
    }

    #[test]
    fn a_box_alone_tells_that_eye_and_light_are_outside() {
        let bounds = box_caster(false).bounds;
        let camera = |eye| Camera::new(eye, DVec3::new(0.1, 0.2, 0.3), 1.0, 0.05, [4, 3]).expect("a good camera");
        let [near, far] = [DVec3::splat(0.9), DVec3::splat(3.0)];
        let counting = |eye, light| Counting::of_box(&bounds, &bounds, &camera(eye), light);
        assert_eq!(counting(far, LightPosition::point(DVec3::splat(2.0))), Counting::Facing);
        assert_eq!(counting(far, LightPosition::sun(1.0, 1.0)), Counting::Facing);
        assert_eq!(counting(far, LightPosition::point(near)), Counting::Every);
        assert_eq!(counting(near, LightPosition::sun(1.0, 1.0)), Counting::Every);
        // Within rounding of a face.
        assert_eq!(counting(far, LightPosition::point(DVec3::new(1.0 + 1e-6, 0.0, 0.0))), Counting::Every);
    }
}
