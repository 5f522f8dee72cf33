//! The church: a tower with a spire to the west, a nave with aisles, a choir with an apse to the east.

use std::f32::consts::{FRAC_PI_8, TAU};

use glam::{Affine3A, Vec2, Vec3};
use umbrae_core::shapes;

use super::Paints;
use super::roofs::Roof;
use crate::sample::model::{Parts, block, profile};

/// All of it, the crossing of nave and aisles at the origin; 58 m high.
pub(super) fn parts(paints: &Paints) -> Parts {
    let mut parts = Parts::default();
    nave(&mut parts, paints);
    choir(&mut parts, paints);
    tower(&mut parts, paints);
    parts
}

fn nave(parts: &mut Parts, paints: &Paints) {
    let roof = Roof { length: 30.0, span: 12.0, eaves: 12.0, slope: 1.25, overhang: 0.4 };
    parts.add(paints.render, roof.gabled_walls());
    parts.add(paints.tiles[0], roof.gabled());
    for side in [-1.0, 1.0] {
        let outline = [(5.7, 0.0), (11.0, 0.0), (11.0, 6.0), (5.7, 9.2)].map(Vec2::from);
        let slab = [(11.5, 5.6), (11.5, 5.9), (5.8, 9.35), (5.8, 9.05)].map(Vec2::from);
        // The southern aisle is the northern one seen in a mirror.
        let mirror = Affine3A::from_scale(Vec3::new(1.0, side, 1.0));
        parts.add(paints.render, shapes::transformed(profile(&outline, -14.2, 14.2), mirror));
        parts.add(paints.tiles[0], shapes::transformed(profile(&slab, -14.6, 14.6), mirror));
        for bay in 0..6 {
            let x = -11.6 + 4.64 * bay as f32;
            parts.add(paints.window, block(Vec3::new(x, 11.0 * side, 1.8), Vec3::new(1.2, 0.2, 3.0)));
            parts.add(paints.window, block(Vec3::new(x, 6.0 * side, 9.7), Vec3::new(1.1, 0.2, 1.6)));
        }
        for buttress in 0..7 {
            let x = -13.9 + 4.64 * buttress as f32;
            parts.add(paints.stone, block(Vec3::new(x, 11.2 * side, 0.0), Vec3::new(0.7, 1.6, 4.7)));
        }
    }
}

fn choir(parts: &mut Parts, paints: &Paints) {
    let roof = Roof { length: 11.0, span: 9.4, eaves: 11.0, slope: 1.25, overhang: 0.35 };
    let to_choir = Affine3A::from_translation(Vec3::new(19.2, 0.0, 0.0));
    parts.add(paints.render, shapes::transformed(roof.gabled_walls(), to_choir));
    parts.add(paints.tiles[0], shapes::transformed(roof.gabled(), to_choir));
    let middle = Vec3::new(24.0, 0.0, 0.0);
    // Turned by half a side, so that a flat wall looks east.
    let turned = Affine3A::from_translation(middle) * Affine3A::from_rotation_z(FRAC_PI_8);
    parts.add(paints.render, shapes::transformed(shapes::cylinder(Vec3::ZERO, 4.9, 10.6, 8), turned));
    let hat = [(5.4, 10.3), (5.4, 10.6), (0.0, 16.6)].map(Vec2::from);
    parts.add(paints.tiles[0], shapes::transformed(shapes::revolution(Vec3::ZERO, &hat, 8), turned));
    for wall in -1..=1 {
        let turn = Affine3A::from_translation(middle) * Affine3A::from_rotation_z(TAU / 8.0 * wall as f32);
        let apothem = 4.9 * FRAC_PI_8.cos();
        let window = block(Vec3::new(apothem, 0.0, 3.2), Vec3::new(0.2, 1.2, 5.6));
        parts.add(paints.window, shapes::transformed(window, turn));
    }
    for side in [-1.0, 1.0] {
        parts.add(paints.window, block(Vec3::new(19.5, 4.7 * side, 3.2), Vec3::new(1.3, 0.2, 5.6)));
    }
}

fn tower(parts: &mut Parts, paints: &Paints) {
    const HEIGHT: f32 = 31.0;
    let middle = Vec3::new(-18.6, 0.0, 0.0);
    parts.add(paints.render, block(middle, Vec3::new(8.6, 8.6, HEIGHT)));
    parts.add(paints.stone, block(middle, Vec3::new(9.2, 9.2, 1.4)));
    for (z, size) in [(11.0, 8.9), (20.6, 8.9), (HEIGHT - 0.5, 9.3)] {
        parts.add(paints.stone, block(middle.with_z(z), Vec3::new(size, size, 0.7)));
    }
    for quarter in 0..4 {
        let turn = Affine3A::from_translation(middle) * Affine3A::from_rotation_z(TAU / 4.0 * quarter as f32);
        let mut side = Parts::default();
        for y in [-1.5, 1.5] {
            side.add(paints.window, block(Vec3::new(4.3, y, 22.6), Vec3::new(0.2, 1.3, 5.4)));
        }
        side.add(paints.window, block(Vec3::new(4.3, 0.0, 13.6), Vec3::new(0.2, 1.2, 3.2)));
        side.add(
            paints.clock,
            shapes::transformed(shapes::cylinder(Vec3::ZERO, 1.2, 0.3, 16), upright_disc(4.2, 18.9)),
        );
        // A pinnacle on every corner of the tower.
        side.add(paints.copper, shapes::cone(Vec3::new(3.9, 3.9, HEIGHT), 0.75, 5.0, 6));
        parts.add_moved(side, turn);
    }
    parts.add(paints.timber, block(middle - 4.3 * Vec3::X, Vec3::new(0.24, 2.6, 4.4)));
    let spire = [(4.5, 0.0), (3.4, 2.4), (0.0, 26.6)].map(Vec2::from);
    let to_spire = Affine3A::from_translation(middle.with_z(HEIGHT)) * Affine3A::from_rotation_z(FRAC_PI_8);
    parts.add(paints.copper, shapes::transformed(shapes::revolution(Vec3::ZERO, &spire, 8), to_spire));
    parts.add(paints.clock, shapes::strut(middle.with_z(HEIGHT + 25.0), middle.with_z(58.0), 0.1, 6));
}

/// A disc that lay on the ground, upright and looking east, at a distance from the axis and a height.
fn upright_disc(out: f32, up: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(out, 0.0, up)) * Affine3A::from_rotation_y(TAU / 4.0)
}
