//! A city of boxes that is the same on every machine: what the engine is measured on.

use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3, Vec3};
use umbrae_core::{Caster, Mesh, Object, Scene, shapes};
use umbrae_study::{GroundGrid, Receivers, Solids, Terrain};

const CELL_M: f64 = 40.0;

/// Boxes of 12 triangles, 10 to 26 m wide and 6 to 45 m high, turned by up to 90 degrees, on a jittered grid of 40 m in a square.
pub(crate) fn casters(boxes: usize) -> Vec<Caster> {
    let columns = columns(boxes);
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let objects = (0..boxes).map(|i| {
        let size = Vec3::new(random.between(10.0, 26.0), random.between(10.0, 26.0), random.between(6.0, 45.0));
        let mesh =
            Mesh::new(shapes::cuboid(-0.5 * size.with_z(0.0), size.with_z(0.0) * 0.5 + size.with_x(0.0).with_y(0.0)));
        let jitter = DVec2::new(f64::from(random.between(-6.0, 6.0)), f64::from(random.between(-6.0, 6.0)));
        let at = CELL_M * (DVec2::new((i % columns) as f64, (i / columns) as f64) + 0.5) + jitter;
        let turn = f64::from(random.between(0.0, 90.0)).to_radians();
        let place = DAffine3::from_translation(at.extend(0.0)) * DAffine3::from_rotation_z(turn);
        Object::new(format!("box {i}"), Arc::new(mesh.expect("a box is a mesh")), place)
    });
    Caster::of_scene(&Scene { objects: objects.collect(), ..Scene::default() })
}

/// About `count` points in a square grid on the ground of the whole city. No solids are marked: another program does not know them either.
pub(crate) fn receivers(boxes: usize, count: usize) -> Receivers {
    let side = columns(boxes) as f64 * CELL_M;
    let spacing = side / (count as f64).sqrt();
    // Rounding must not add a row.
    let grid = GroundGrid::covering(DVec2::ZERO, DVec2::splat(side), spacing * (1.0 + 1e-12), 0.0);
    let mut receivers = Receivers::default();
    receivers.add_ground(grid, &Terrain::new(&[], &[]), &Solids::new(&[], &[]));
    receivers
}

fn columns(boxes: usize) -> usize {
    (boxes as f64).sqrt().ceil() as usize
}

/// Directions at even hour angles while the sun of 21 March is up in Berlin, by the rule of thumb that needs no almanac.
pub(crate) fn suns(count: usize) -> Vec<DVec3> {
    let (latitude, declination) = (52.52_f64.to_radians(), 0.2_f64.to_radians());
    let half_day = (-latitude.tan() * declination.tan()).acos();
    (0..count)
        .map(|i| {
            let hour = half_day * (2.0 * (i as f64 + 0.5) / count as f64 - 1.0);
            let east = -declination.cos() * hour.sin();
            let north = latitude.cos() * declination.sin() - latitude.sin() * declination.cos() * hour.cos();
            let up = latitude.sin() * declination.sin() + latitude.cos() * declination.cos() * hour.cos();
            DVec3::new(east, north, up)
        })
        .collect()
}

/// The same city on every machine (`SplitMix64`).
struct Random(u64);

impl Random {
    fn between(&mut self, min: f32, max: f32) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 24) as f32;
        min + unit * (max - min)
    }
}
