//! The town wall: stretches with battlements, round towers where it turns, gates on the main streets.

use glam::{Affine3A, Vec2, Vec3};
use umbrae_core::shapes;

use super::Paints;
use super::roofs::Roof;
use crate::sample::model::{Model, Parts, block, standing, wall};

/// What stands at a bend of the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Post {
    Tower,
    Gate(&'static str),
}

/// The bends of the wall, counter-clockwise.
const POSTS: [(Vec2, Post); 16] = [
    (Vec2::new(149.0, 5.0), Post::Gate("east")),
    (Vec2::new(146.0, 68.0), Post::Tower),
    (Vec2::new(112.0, 96.0), Post::Tower),
    (Vec2::new(78.0, 119.0), Post::Tower),
    (Vec2::new(-10.0, 123.0), Post::Gate("north")),
    (Vec2::new(-80.0, 120.0), Post::Tower),
    (Vec2::new(-116.0, 95.0), Post::Tower),
    (Vec2::new(-147.0, 68.0), Post::Tower),
    (Vec2::new(-150.0, 7.0), Post::Gate("west")),
    (Vec2::new(-148.0, -60.0), Post::Tower),
    (Vec2::new(-114.0, -94.0), Post::Tower),
    (Vec2::new(-78.0, -120.0), Post::Tower),
    (Vec2::new(-7.0, -124.0), Post::Gate("south")),
    (Vec2::new(78.0, -118.0), Post::Tower),
    (Vec2::new(114.0, -93.0), Post::Tower),
    (Vec2::new(148.0, -58.0), Post::Tower),
];

const HEIGHT: f32 = 6.4;
const THICKNESS: f32 = 1.7;
/// From the middle of a gate to where the wall begins, inside the gate's pier.
const GATE_HALF: f32 = 4.2;

/// Adds "wall 1" to "wall 16", "tower 1" to "tower 12" and "gate east", "gate north", ...
pub(super) fn add(model: &mut Model, paints: &Paints) {
    let mut towers = 0;
    for (i, &(at, post)) in POSTS.iter().enumerate() {
        let (next, next_post) = POSTS[(i + 1) % POSTS.len()];
        let along = (next - at).normalize_or_zero();
        let shortened = |post: Post| if post == Post::Tower { 0.0 } else { GATE_HALF };
        let stretch = stretch(at + along * shortened(post), next - along * shortened(next_post), i, paints);
        model.add(format!("wall {}", i + 1), stretch);
        match post {
            Post::Tower => {
                towers += 1;
                model.place(
                    format!("tower {towers}"),
                    tower(towers, paints).into_mesh().into(),
                    standing(at, 0.0, 1.0),
                );
            }
            Post::Gate(name) => {
                let (before, _) = POSTS[(i + POSTS.len() - 1) % POSTS.len()];
                let through = standing(at, (next - before).to_angle(), 1.0);
                model.place(format!("gate {name}"), gate(paints).into_mesh().into(), through);
            }
        }
    }
}

/// A straight piece of wall, its outside on the right of the way from `from` to `to`.
fn stretch(from: Vec2, to: Vec2, index: usize, paints: &Paints) -> Parts {
    let mut parts = Parts::default();
    let along = (to - from).normalize_or_zero();
    // Stretches of two heights in turn, or their tops would coincide where they meet inside a tower.
    let top = HEIGHT + 0.3 * (index % 2) as f32;
    parts.add(paints.stone, wall(from, to, THICKNESS, 0.0, top));
    let outward = -along.perp() * (0.5 * THICKNESS - 0.2);
    parts.add(paints.stone, wall(from + outward, to + outward, 0.5, top - 0.2, top + 0.5));
    let count = ((to - from).length() / 3.6).floor();
    for merlon in 0..count as u16 {
        let at = from + outward + (to - from) * ((f32::from(merlon) + 0.5) / count);
        parts.add(paints.stone, wall(at - 0.95 * along, at + 0.95 * along, 0.56, top + 0.3, top + 1.5));
    }
    parts
}

fn tower(index: u8, paints: &Paints) -> Parts {
    let mut parts = Parts::default();
    let height = 10.0 + 1.3 * f32::from(index % 3);
    let body = [(3.9, 0.0), (3.6, 1.2), (3.5, height - 2.0), (4.0, height - 1.4), (4.0, height)].map(Vec2::from);
    parts.add(paints.stone, shapes::revolution(Vec3::ZERO, &body, 12));
    let hat = [(4.6, -0.2), (4.6, 0.1), (0.0, 6.2)].map(Vec2::from);
    parts.add(paints.tiles[usize::from(index) % 2], shapes::revolution(Vec3::new(0.0, 0.0, height), &hat, 12));
    for loophole in 0..3 {
        let turn = Affine3A::from_rotation_z(2.1 * loophole as f32);
        let slit = block(Vec3::new(3.5, 0.0, height - 5.0), Vec3::new(0.3, 0.4, 1.4));
        parts.add(paints.window, shapes::transformed(slit, turn));
    }
    parts
}

/// Two piers and a gatehouse over the way between them; the wall runs along x.
fn gate(paints: &Paints) -> Parts {
    let mut parts = Parts::default();
    for side in [-1.0, 1.0] {
        parts.add(paints.stone, block(Vec3::new(4.2 * side, 0.0, 0.0), Vec3::new(3.6, 6.4, 7.0)));
        parts.add(paints.window, block(Vec3::new(2.4 * side, 3.0, 9.2), Vec3::new(1.0, 0.2, 1.6)));
        parts.add(paints.window, block(Vec3::new(2.4 * side, -3.0, 9.2), Vec3::new(1.0, 0.2, 1.6)));
    }
    let roof = Roof { length: 11.2, span: 6.0, eaves: 12.4, slope: 1.1, overhang: 0.5 };
    // The gatehouse has its floor over the way.
    parts.add(paints.render, block(Vec3::new(0.0, 0.0, 5.2), Vec3::new(roof.length, roof.span, 7.25)));
    parts.add(paints.tiles[1], roof.hipped());
    parts
}
