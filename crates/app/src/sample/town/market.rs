//! The market square: a town hall, a fountain and stalls.

use std::f32::consts::FRAC_PI_4;

use glam::{Affine3A, Vec2, Vec3};
use umbrae_core::shapes;

use super::Paints;
use super::roofs::Roof;
use crate::random::Random;
use crate::sample::model::{Model, Parts, block, profile, standing};

/// Adds "town hall", "fountain" and "stall 1", "stall 2", ...
pub(super) fn add(model: &mut Model, paints: &Paints, random: &mut Random) {
    model.place("town hall", town_hall(paints).into_mesh().into(), standing(Vec2::new(51.0, -26.0), 1.62, 1.0));
    model.place("fountain", fountain(paints).into_mesh().into(), standing(Vec2::new(12.0, -24.0), 0.0, 1.0));
    let places = (0..12).map(|i| (i % 6, i / 6)).filter(|&place| place != (3, 0));
    for (number, (column, row)) in (1..).zip(places) {
        let at = Vec2::new(2.0 + 5.6 * column as f32, -8.0 - 4.6 * row as f32);
        let jitter = Vec2::new(random.between(-0.4, 0.4), random.between(-0.3, 0.3));
        let stall = stall(random.pick(&[0, 1, 2, 2]), paints);
        let placed = standing(at + jitter, random.between(-0.08, 0.08), 1.0);
        model.place(format!("stall {number}"), stall.into_mesh().into(), placed);
    }
}

/// Its arcade looks west when turned by a quarter to the left; a turret rides on the roof.
fn town_hall(paints: &Paints) -> Parts {
    let mut parts = Parts::default();
    let roof = Roof { length: 26.0, span: 13.0, eaves: 10.6, slope: 0.95, overhang: 0.6 };
    parts.add(paints.plasters[1], block(Vec3::ZERO, Vec3::new(roof.length, roof.span, roof.eaves + 0.05)));
    parts.add(paints.tiles[0], roof.hipped());
    for column in 0..9 {
        let x = 2.9 * (column as f32 - 4.0);
        for (z, height) in [(4.6, 2.4), (7.9, 1.7)] {
            for y in [-6.5, 6.5] {
                parts.add(paints.window, block(Vec3::new(x, y, z), Vec3::new(1.2, 0.2, height)));
            }
        }
        if column % 2 == 0 {
            parts.add(paints.window, block(Vec3::new(x, -6.5, 0.0), Vec3::new(1.8, 0.22, 2.9)));
        }
    }
    for pillar in 0..8 {
        let x = 3.4 * (pillar as f32 - 3.5);
        parts.add(paints.stone, block(Vec3::new(x, 9.4, 0.0), Vec3::new(0.7, 0.7, 3.7)));
    }
    parts.add(paints.stone, block(Vec3::new(0.0, 8.0, 3.5), Vec3::new(25.2, 3.9, 0.5)));
    parts.add(paints.stone, block(Vec3::new(0.0, 9.8, 3.9), Vec3::new(25.2, 0.2, 0.9)));
    // The turret: a square box, an open lantern, a pointed hat.
    let ridge = Vec3::new(0.0, 0.0, 15.0);
    parts.add(paints.plasters[2], block(ridge, Vec3::new(3.2, 3.2, 5.0)));
    parts.add(paints.stone, block(ridge + 4.9 * Vec3::Z, Vec3::new(3.7, 3.7, 0.35)));
    let turned = Affine3A::from_translation(ridge) * Affine3A::from_rotation_z(0.5 * FRAC_PI_4);
    let hat = [(2.0, 7.6), (2.0, 7.8), (1.0, 9.0), (0.0, 13.0)].map(Vec2::from);
    parts.add(paints.copper, shapes::transformed(shapes::revolution(Vec3::ZERO, &hat, 8), turned));
    for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        parts.add(paints.timber, block(ridge + Vec3::new(1.05 * x, 1.05 * y, 5.1), Vec3::new(0.25, 0.25, 2.7)));
    }
    for side in [-1.0, 1.0] {
        let disc = Affine3A::from_translation(ridge + Vec3::new(0.0, 1.52 * side, 3.4))
            * Affine3A::from_rotation_x(-2.0 * FRAC_PI_4 * side);
        parts.add(paints.clock, shapes::transformed(shapes::cylinder(Vec3::ZERO, 0.95, 0.2, 16), disc));
    }
    parts
}

fn fountain(paints: &Paints) -> Parts {
    let mut parts = Parts::default();
    // A basin with a hollow, then a shaft with a bowl.
    let basin = [(3.6, 0.0), (3.6, 0.25), (3.1, 0.3), (3.2, 1.0), (2.8, 1.0), (2.7, 0.55), (0.0, 0.55)].map(Vec2::from);
    parts.add(paints.stone, shapes::revolution(Vec3::ZERO, &basin, 16));
    let shaft = [(0.5, 0.3), (0.3, 1.9), (1.3, 2.4), (1.3, 2.6), (0.3, 2.45), (0.22, 3.6), (0.45, 3.9), (0.0, 4.6)];
    parts.add(paints.stone, shapes::revolution(Vec3::ZERO, &shaft.map(Vec2::from), 12));
    parts
}

fn stall(cloth: usize, paints: &Paints) -> Parts {
    let mut parts = Parts::default();
    for (x, y) in [(1.6, 1.1), (-1.6, 1.1), (-1.6, -1.1), (1.6, -1.1)] {
        parts.add(paints.timber, shapes::strut(Vec3::new(x, y, 0.0), Vec3::new(x, y, 2.3), 0.08, 4));
    }
    parts.add(paints.timber, block(Vec3::new(0.0, -0.4, 0.7), Vec3::new(3.0, 1.3, 0.25)));
    let at = |y: f32, z: f32| Vec2::new(y, z);
    let cover = [at(-1.5, 2.1), at(0.0, 2.8), at(1.5, 2.1), at(1.5, 2.18), at(0.0, 2.92), at(-1.5, 2.18)];
    parts.add(paints.cloths[cloth], profile(&cover, -1.95, 1.95));
    parts
}
