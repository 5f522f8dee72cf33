//! Which points are inside of buildings.
//!
//! A point is inside of a closed surface if a line from it to anywhere far away meets the surface an odd number of times. Models of
//! cities leave out what nobody sees: the floors on which buildings stand, the walls between them. So several lines are asked, and the
//! majority is right: upwards, and if that is odd, four to the sides. (Down is where surfaces are missing.) A canopy, which is
//! above but not beside, is no solid.

use glam::DVec3;
use rayon::prelude::*;
use umbrae_core::{Caster, RayCaster, SurfaceKind};

/// Everything that can hold a point inside.
#[derive(Debug, Clone)]
pub struct Solids {
    rays: RayCaster,
    /// For each part, whether it is closed by itself.
    is_closed: Vec<bool>,
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

/// Of the lines to the sides, how many must be odd.
const MAJORITY: usize = 3;

impl Solids {
    /// All triangles of `casters` but terrain; `kinds` as for [`super::Terrain::new`].
    pub fn new(casters: &[Caster], kinds: &[Vec<SurfaceKind>]) -> Self {
        let triangles: Vec<Vec<[u32; 3]>> = casters
            .iter()
            .zip(kinds)
            .map(|(caster, kinds)| {
                let all = caster.mesh.triangles().iter().zip(kinds);
                all.filter(|(_, kind)| **kind != SurfaceKind::Terrain).map(|(triangle, _)| *triangle).collect()
            })
            .collect();
        let parts = casters.iter().zip(&triangles);
        Self {
            rays: RayCaster::new(parts.map(|(caster, triangles)| (caster.positions.as_slice(), triangles.as_slice()))),
            is_closed: casters.iter().map(|c| c.topology.components().iter().all(|part| part.is_closed)).collect(),
        }
    }

    /// For each of `points`, whether it is inside of a solid. About a microsecond each, on all threads.
    pub fn hold(&self, points: &[DVec3]) -> Vec<bool> {
        points.par_iter().map(|&point| self.holds(point)).collect()
    }

    fn holds(&self, point: DVec3) -> bool {
        let above = self.crossings(point, UP);
        if above.is_empty() {
            return false;
        }
        let beside = TO_THE_SIDES.map(|direction| self.crossings(point, direction));
        let is_odd =
            |crossings: &[u32], of: &dyn Fn(u32) -> bool| crossings.iter().filter(|&&part| of(part)).count() % 2 == 1;
        let is_inside_of = |of: &dyn Fn(u32) -> bool| {
            is_odd(&above, of) && beside.iter().filter(|crossings| is_odd(crossings, of)).count() >= MAJORITY
        };
        // Open parts may be walls and roofs of one building, so they are also asked together.
        above.iter().any(|&part| is_inside_of(&|other| other == part))
            || is_inside_of(&|part| !self.is_closed[part as usize])
    }

    /// The part of each triangle that is met.
    fn crossings(&self, point: DVec3, direction: DVec3) -> Vec<u32> {
        let mut parts = Vec::new();
        self.rays.for_each_hit(point, direction, 0.0, f64::INFINITY, |hit| parts.push(hit.part));
        parts
    }
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
