//! Which points are inside of buildings.
//!
//! A line from a point inside of a closed surface to anywhere far away leaves the surface more often than it enters it; of any other surface one can only say
//! that it is met an odd number of times. Models of cities leave out what nobody sees: the floors on which buildings stand, the walls between them. So several
//! lines are asked, and the majority is right: upwards, and if that says inside, four to the sides. (Down is where surfaces are missing.) A canopy, which is
//! above but not beside, is no solid.

use glam::DVec3;
use rayon::prelude::*;
use umbrae_core::{Bounds, Caster, RayCaster, SurfaceKind};

use super::{LIFT_M, rays_against};

/// Everything that can hold a point inside.
#[derive(Debug, Clone)]
pub struct Solids {
    rays: RayCaster,
    parts: Vec<Part>,
}

#[derive(Debug, Clone, Copy)]
struct Part {
    /// Whether it is closed by itself.
    is_closed: bool,
    bounds: Bounds,
}

/// A triangle in the way.
struct Crossing {
    part: u32,
    /// 1 if the line comes out of it, -1 if it goes in.
    turn: i32,
}

/// Slightly off the axes, along which edges run.
const UP: DVec3 = DVec3::new(0.001_37, 0.000_71, 1.0);

/// As [`UP`], and slightly upwards, so that the ground is not met.
const TO_THE_SIDES: [DVec3; 4] = [
    DVec3::new(1.0, 0.031_7, 0.002_3),
    DVec3::new(-0.029_3, 1.0, 0.001_9),
    DVec3::new(-1.0, -0.037_1, 0.002_1),
    DVec3::new(0.032_9, -1.0, 0.001_7),
];

/// Of the lines to the sides, how many must agree.
const MAJORITY: usize = 3;

/// Walls that are objects of their own are looked for so far away, in metres: no building is wider.
const WIDEST_M: f64 = 500.0;

impl Solids {
    /// All triangles of `casters` but terrain; `kinds` as for [`super::Terrain::new`].
    pub fn new(casters: &[Caster], kinds: &[Vec<SurfaceKind>]) -> Self {
        Self {
            rays: rays_against(casters, kinds, |kind| kind != SurfaceKind::Terrain),
            parts: casters
                .iter()
                .map(|c| Part {
                    is_closed: c.topology.components().iter().all(|part| part.is_closed),
                    bounds: c.bounds,
                })
                .collect(),
        }
    }

    /// For each of `points`, whether it is inside of a solid: also if it lies on the floor of one, and not if it lies on a roof. On all threads, a
    /// microsecond or two for each, some more where something is above.
    pub fn hold(&self, points: &[DVec3]) -> Vec<bool> {
        points.par_iter().map(|&point| self.holds(point)).collect()
    }

    fn holds(&self, point: DVec3) -> bool {
        // What is on a floor is above it, and what is on a roof as well.
        let point = point + DVec3::new(0.0, 0.0, 0.5 * LIFT_M);
        let above = self.crossings(point, UP, f64::INFINITY);
        let mut parts: Vec<u32> = above.iter().map(|crossing| crossing.part).collect();
        parts.sort_unstable();
        parts.dedup();
        let is_inside_of = |part: &u32| {
            let Part { is_closed, bounds } = self.parts[*part as usize];
            let is_of_it = |crossing: &Crossing| crossing.part == *part;
            says_inside(&above, is_closed, is_of_it)
                && self.sides_agree(point, is_closed, is_of_it, |direction| way_out(&bounds, point, direction))
        };
        // Open parts may be walls and roofs of one building, so they are also asked together.
        let is_open = |crossing: &Crossing| !self.parts[crossing.part as usize].is_closed;
        parts.iter().any(is_inside_of)
            || (says_inside(&above, false, is_open) && self.sides_agree(point, false, is_open, |_| WIDEST_M))
    }

    /// Whether the majority of the lines to the sides, as long as `length` says, finds `point` inside.
    fn sides_agree(
        &self,
        point: DVec3,
        is_closed: bool,
        counts: impl Fn(&Crossing) -> bool,
        length: impl Fn(DVec3) -> f64,
    ) -> bool {
        let is_inside = |direction: &&DVec3| {
            says_inside(&self.crossings(point, **direction, length(**direction)), is_closed, &counts)
        };
        TO_THE_SIDES.iter().filter(is_inside).count() >= MAJORITY
    }

    fn crossings(&self, point: DVec3, direction: DVec3, length: f64) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        self.rays.for_each_hit(point, direction, 0.0, length, |hit| {
            let turn = if self.rays.normal(&hit).dot(direction) > 0.0 { 1 } else { -1 };
            crossings.push(Crossing { part: hit.part, turn });
        });
        crossings
    }
}

/// What a line's crossings, of those that `counts`, say: of a closed surface whether they add up to anything, else whether they are odd.
fn says_inside(crossings: &[Crossing], is_closed: bool, counts: impl Fn(&Crossing) -> bool) -> bool {
    let counted = crossings.iter().filter(|crossing| counts(crossing));
    if is_closed { counted.map(|crossing| crossing.turn).sum::<i32>() != 0 } else { counted.count() % 2 == 1 }
}

/// How far it is from a point within `bounds`, or near them, to their outside.
fn way_out(bounds: &Bounds, point: DVec3, direction: DVec3) -> f64 {
    let to = |axis: usize| {
        let end = if direction[axis] > 0.0 { bounds.max[axis] } else { bounds.min[axis] };
        (end - point[axis]) / direction[axis]
    };
    to(0).min(to(1)).max(0.0) + 1.0
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, Vec3};
    use umbrae_core::{Mesh, Object, Scene, Surface, shapes};

    use super::*;

    fn solids(surfaces: Vec<Surface>) -> Solids {
        let object =
            |surface| Object::new("part", Arc::new(Mesh::new(surface).expect("a good mesh")), DAffine3::IDENTITY);
        let scene = Scene { objects: surfaces.into_iter().map(object).collect(), ..Scene::default() };
        let casters = Caster::of_scene(&scene);
        let kinds: Vec<_> = casters.iter().map(|c| vec![SurfaceKind::Unknown; c.mesh.triangles().len()]).collect();
        Solids::new(&casters, &kinds)
    }

    /// A box without those faces for whose normal `leave_out` holds.
    fn box_without(min: Vec3, max: Vec3, leave_out: impl Fn(Vec3) -> bool) -> Surface {
        let mut surface = shapes::cuboid(min, max);
        let positions = surface.positions.clone();
        surface.triangles.retain(|t| {
            let [a, b, c] = t.map(|i| positions[i as usize]);
            !leave_out((b - a).cross(c - a).normalize_or_zero())
        });
        surface
    }

    #[test]
    fn a_house_without_a_floor_is_a_solid_and_a_canopy_is_none() {
        let house = box_without(Vec3::ZERO, Vec3::new(10.0, 10.0, 6.0), |n| n.z < -0.5);
        let canopy = box_without(Vec3::new(20.0, 0.0, 3.0), Vec3::new(30.0, 10.0, 4.0), |n| n.z < 0.5);
        let solids = solids(vec![house, canopy]);
        let points = [[5.0, 5.0, 0.0], [15.0, 5.0, 0.0], [25.0, 5.0, 0.0], [5.0, 5.0, 7.0]].map(DVec3::from_array);
        assert_eq!(solids.hold(&points), [true, false, false, false]);
    }

    #[test]
    fn a_point_on_the_floor_is_inside_and_one_on_the_roof_is_not() {
        let house = shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 6.0));
        let points = [[5.0, 5.0, 0.0], [5.0, 5.0, 6.0]].map(DVec3::from_array);
        assert_eq!(solids(vec![house]).hold(&points), [true, false]);
    }

    #[test]
    fn a_body_that_crosses_itself_is_solid_where_it_is_there_twice() {
        let mut both = shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 6.0));
        let other = shapes::cuboid(Vec3::new(5.0, 0.5, -0.5), Vec3::new(15.0, 9.5, 5.5));
        let first = both.positions.len() as u32;
        both.positions.extend(other.positions);
        both.triangles.extend(other.triangles.iter().map(|t| t.map(|i| first + i)));
        assert_eq!(solids(vec![both]).hold(&[DVec3::new(7.0, 5.0, 1.0)]), [true]);
    }

    #[test]
    fn walls_and_roof_that_are_objects_of_their_own_make_a_house() {
        let (min, max) = (Vec3::ZERO, Vec3::new(10.0, 10.0, 6.0));
        let solids = solids(vec![box_without(min, max, |n| n.z.abs() > 0.5), box_without(min, max, |n| n.z < 0.5)]);
        assert_eq!(solids.hold(&[DVec3::new(5.0, 5.0, 0.0), DVec3::new(5.0, 15.0, 0.0)]), [true, false]);
    }

    #[test]
    fn where_two_closed_houses_overlap_is_inside_and_under_a_bridge_is_not() {
        let a = shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 6.0));
        let b = shapes::cuboid(Vec3::new(5.0, 0.0, 0.0), Vec3::new(15.0, 10.0, 6.0));
        let bridge = shapes::cuboid(Vec3::new(-9.0, 0.0, 4.0), Vec3::new(-1.0, 10.0, 5.0));
        let points = [[7.0, 5.0, 1.0], [-5.0, 5.0, 1.0], [-5.0, 5.0, 4.5]].map(DVec3::from_array);
        assert_eq!(solids(vec![a, b, bridge]).hold(&points), [true, false, true]);
    }
}
