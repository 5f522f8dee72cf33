//! Random soups: shared vertices, random windings, fans.

use std::sync::Arc;

use glam::{DAffine3, Vec3};
use umbrae_core::{Material, Mesh, Object, Scene, Surface};

use super::random::Random;

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
