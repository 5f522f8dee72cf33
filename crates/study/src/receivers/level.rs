//! Where the ground is, where a model has no terrain: on the level on which most of it stands.

use glam::{DVec2, UVec2};
use umbrae_core::{Bounds, Caster, SurfaceKind};

/// On what the objects of a model stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundLevel {
    /// Half of them stand no higher, half no lower; scene space.
    pub level: f64,
    /// The lowest foot.
    pub lowest: f64,
    /// The highest foot.
    pub highest: f64,
    /// How many objects that is about: what is above a lower one (a roof that is an object of its own, a window) stands on that and not on the ground.
    pub objects: usize,
}

/// Objects are looked at from above, in so many squares each way.
const SQUARES: usize = 1024;

impl GroundLevel {
    /// Of `casters`, without their terrain; `kinds` as for [`super::Terrain::new`]. Level 0 where there is nothing else.
    pub fn of(casters: &[Caster], kinds: &[Vec<SurfaceKind>]) -> Self {
        let is_terrain = |kinds: &&Vec<SurfaceKind>| kinds.iter().all(|&kind| kind == SurfaceKind::Terrain);
        let mut objects: Vec<Bounds> = casters
            .iter()
            .zip(kinds)
            .filter(|(caster, kinds)| !is_terrain(kinds) && !caster.bounds.is_empty())
            .map(|(caster, _)| caster.bounds)
            .collect();
        objects.sort_by(|a, b| a.min.z.total_cmp(&b.min.z));
        let whole = objects.iter().fold(Bounds::EMPTY, |whole, bounds| whole.union(*bounds));
        let mut plan = Plan::new(whole);
        let feet: Vec<f64> =
            objects.iter().filter(|bounds| plan.is_first_in_middle_of(bounds)).map(|bounds| bounds.min.z).collect();
        match feet.as_slice() {
            [] => Self { level: 0.0, lowest: 0.0, highest: 0.0, objects: 0 },
            [lowest, .., highest] => {
                Self { level: feet[feet.len() / 2], lowest: *lowest, highest: *highest, objects: feet.len() }
            }
            [only] => Self { level: *only, lowest: *only, highest: *only, objects: 1 },
        }
    }
}

/// Which squares of the plan something stands on.
struct Plan {
    origin: DVec2,
    squares_per_metre: DVec2,
    is_taken: Vec<bool>,
}

impl Plan {
    fn new(whole: Bounds) -> Self {
        let size = whole.size().truncate().max(DVec2::splat(1e-9));
        let is_taken = vec![false; SQUARES * SQUARES];
        Self { origin: whole.min.truncate(), squares_per_metre: SQUARES as f64 / size, is_taken }
    }

    fn square(&self, at: DVec2) -> UVec2 {
        ((at - self.origin) * self.squares_per_metre).as_uvec2().min(UVec2::splat(SQUARES as u32 - 1))
    }

    /// Whether nothing was there before; now `bounds` is.
    fn is_first_in_middle_of(&mut self, bounds: &Bounds) -> bool {
        let index = |x: u32, y: u32| y as usize * SQUARES + x as usize;
        let middle = self.square(bounds.center().truncate());
        let is_first = !self.is_taken[index(middle.x, middle.y)];
        let (low, high) = (self.square(bounds.min.truncate()), self.square(bounds.max.truncate()));
        for y in low.y..=high.y {
            self.is_taken[index(low.x, y)..=index(high.x, y)].fill(true);
        }
        is_first
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, Vec3};
    use umbrae_core::{Mesh, Object, Scene, shapes};

    use super::*;

    fn level(boxes: &[[[f32; 3]; 2]]) -> GroundLevel {
        let objects = boxes.iter().map(|[min, max]| {
            let mesh = Mesh::new(shapes::cuboid(Vec3::from_array(*min), Vec3::from_array(*max))).expect("a good box");
            Object::new("box", Arc::new(mesh), DAffine3::IDENTITY)
        });
        let casters = Caster::of_scene(&Scene { objects: objects.collect(), ..Scene::default() });
        let kinds: Vec<_> = casters.iter().map(|c| vec![SurfaceKind::Unknown; c.mesh.triangles().len()]).collect();
        GroundLevel::of(&casters, &kinds)
    }

    #[test]
    fn a_city_stands_where_most_of_its_houses_do() {
        let house = |x: f32, z: f32| [[x, 0.0, z], [x + 8.0, 8.0, z + 10.0]];
        let found = level(&[house(0.0, 1.0), house(10.0, 1.2), house(20.0, -3.0), house(30.0, 1.1), house(40.0, 5.0)]);
        assert!((found.level - 1.1).abs() < 1e-6 && found.objects == 5);
        assert!((found.lowest + 3.0).abs() < 1e-6 && (found.highest - 5.0).abs() < 1e-6);
    }

    #[test]
    fn a_house_of_many_parts_stands_on_its_slab() {
        let slab = [[0.0, 0.0, -0.3], [10.0, 10.0, 0.0]];
        let part = |z: f32| [[1.0, 1.0, z], [9.0, 9.0, z + 0.3]];
        let found = level(&[part(6.0), part(3.0), slab, part(0.0), part(9.0)]);
        assert!((found.level + 0.3).abs() < 1e-6 && found.objects == 1);
    }
}
