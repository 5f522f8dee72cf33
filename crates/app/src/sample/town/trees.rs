//! A few kinds of trees, each one mesh that many places share.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use umbrae_core::{Mesh, Surface, shapes};

use super::Paints;
use crate::random::Random;
use crate::sample::model::Parts;

/// Trees of about 8 m, with crowns of 2 to 3 m around the trunk; 140 triangles each.
pub(super) fn kinds(paints: &Paints, random: &mut Random) -> Vec<Arc<Mesh>> {
    (0..6).map(|kind| Arc::new(tree(kind, paints, random).into_mesh())).collect()
}

fn tree(kind: usize, paints: &Paints, random: &mut Random) -> Parts {
    let leaves = paints.leaves[kind % paints.leaves.len()];
    let mut parts = Parts::default();
    let trunk = [(0.32, 0.0), (0.2, 1.6), (0.0, 5.5)].map(Vec2::from);
    parts.add(paints.bark, shapes::revolution(Vec3::ZERO, &trunk, 6));
    let middle = Vec3::new(0.0, 0.0, random.between(4.6, 5.4));
    parts.add(leaves, blob(middle, random.between(2.0, 2.4), 1, random));
    for (turn, up) in [(0.0, -0.4), (2.6, 0.6)] {
        let out = Vec2::from_angle(turn + random.between(-0.4, 0.4)) * random.between(0.9, 1.3);
        let center = middle + out.extend(up + random.between(-0.2, 0.3));
        parts.add(leaves, blob(center, random.between(1.3, 1.7), 0, random));
    }
    parts
}

/// A ball of leaves, dented at random.
fn blob(center: Vec3, radius: f32, subdivisions: u32, random: &mut Random) -> Surface {
    let mut ball = shapes::icosphere(Vec3::ZERO, radius, subdivisions);
    for position in &mut ball.positions {
        *position = center + *position * random.between(0.86, 1.12);
    }
    ball
}
