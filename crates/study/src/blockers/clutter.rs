//! Faces all about, for tests that decide the same receivers in several ways.

use glam::{DVec3, Vec3};

use crate::PACKET;
use crate::random::Random;

use super::beam::Care;
use super::cell::Cell;
use super::light_space::LightSpace;
use super::quads::Quad;
use super::tree::Tree;

pub(super) const CARE: Care = Care { margin: 1e-3, pad: 2e-3 };

/// Receivers, and the suns to ask for; `None` for those that are down.
pub(super) type Asked = (Cell, Vec<Option<LightSpace>>);

/// Half of the faces are seen from both sides. A full packet of receivers is asked for, and one of 13.
pub(super) fn clutter() -> (Tree, [Asked; 2]) {
    let mut random = Random(1);
    let mut point = |size: f64| (DVec3::new(random.unit(), random.unit(), random.unit()) - 0.5) * size;
    let quads = (0..500).map(|i| {
        let (at, a, b) = (point(60.0).as_vec3(), point(12.0).as_vec3(), point(12.0).as_vec3());
        let corners = [at, at + a, at + a + b, at + b];
        Quad { corners, normal: a.cross(b).normalize_or(Vec3::Z), is_two_sided: i % 2 == 0 }
    });
    let tree = Tree::new(quads.collect());
    let asked = [PACKET, 13].map(|count| {
        let receivers: Vec<_> = (0..count)
            .map(|i| (point(30.0).to_array(), if i % 3 == 0 { point(1.0).as_vec3().to_array() } else { [0.0; 3] }))
            .collect();
        let sun = |i| (i % 7 != 0).then(|| LightSpace::new(point(2.0).normalize_or(DVec3::Z)));
        (Cell::new(&receivers), (0..200).map(sun).collect())
    });
    (tree, asked)
}
