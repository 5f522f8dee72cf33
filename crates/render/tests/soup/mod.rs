//! Random soups: shared vertices, random windings, fans.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Material, Mesh, Object, Scene, Surface};

/// A small seeded generator (SplitMix64): the same soups on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From -1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub(crate) fn point(&mut self, radius: f64) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed()) * radius
    }
}

/// Two objects, each of 22 triangles: some at random on common vertices, a fan of ten on one edge, and a few twice.
pub(crate) fn soup(random: &mut Random) -> Scene {
    let objects = (0..2)
        .map(|_| {
            let positions: Vec<Vec3> = (0..12).map(|_| random.point(4.0).as_vec3()).collect();
            let mut triangles: Vec<[u32; 3]> =
                (0..10).map(|_| std::array::from_fn(|_| random.below(positions.len()) as u32)).collect();
            // A fan of ten on one edge, and a few faces twice.
            triangles.extend((2..12).map(|i| if random.below(2) == 0 { [0, 1, i] } else { [1, 0, i] }));
            triangles.extend([triangles[3], triangles[5]]);
            let mesh =
                Mesh::new(Surface { positions, triangles, ..Surface::default() }).expect("triangles of its vertices");
            Object::new("soup", Arc::new(mesh), DAffine3::IDENTITY)
        })
        .collect();
    Scene { objects, materials: vec![Material::default()], ..Scene::default() }
}
