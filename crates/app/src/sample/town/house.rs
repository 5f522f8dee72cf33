//! One house: walls, roof, windows, a door, chimneys, dormers.

use std::f32::consts::FRAC_PI_2;

use glam::{Affine3A, Vec2, Vec3};
use umbrae_core::Surface;

use super::Paints;
use super::roofs::Roof;
use crate::random::Random;
use crate::sample::model::{Paint, Parts, block};

/// The storey height of the whole town.
const STOREY: f32 = 3.0;

/// What a house is to look like. It stands around the origin, its street to the south, its court to the north.
#[derive(Debug, Clone, Copy)]
pub(super) struct House {
    /// Along the street.
    pub(super) width: f32,
    /// From the street to the court.
    pub(super) depth: f32,
    pub(super) storeys: u8,
    /// Rise over run of the roof.
    pub(super) slope: f32,
    /// Whether the ridge runs from the street to the court, so that a gable looks onto the street.
    pub(super) is_gable_fronted: bool,
    pub(super) is_hipped: bool,
    /// Whether the west side has windows (at a street corner), and the east side.
    pub(super) side_windows: [bool; 2],
    pub(super) dormers: u8,
}

impl House {
    /// All of it, about 300 triangles.
    pub(super) fn parts(&self, paints: &Paints, random: &mut Random) -> Parts {
        let mut parts = Parts::default();
        let plaster = random.pick(&paints.plasters);
        let tiles = random.pick(&paints.tiles);
        let roof = self.roof(random);
        // The roof's own frame has the ridge along x.
        let from_roof = if self.is_gable_fronted { Affine3A::from_rotation_z(FRAC_PI_2) } else { Affine3A::IDENTITY };
        let mut top = Parts::default();
        if self.is_hipped {
            top.add(plaster, block(Vec3::ZERO, Vec3::new(roof.length, roof.span, roof.eaves + 0.05)));
            top.add(tiles, roof.hipped());
        } else {
            top.add(plaster, roof.gabled_walls());
            top.add(tiles, roof.gabled());
        }
        for side in 0..random.pick(&[1, 1, 2]) {
            let x = roof.length * (random.between(0.18, 0.34) - 0.55 * side as f32);
            let y = roof.span * random.between(-0.14, 0.14);
            let foot = Vec3::new(x, y, roof.ridge() - 0.3 * roof.span * roof.slope);
            let height = roof.ridge() + random.between(0.5, 1.1) - foot.z;
            top.add(paints.brick, block(foot, Vec3::new(0.85, 0.6, height)));
        }
        for dormer in 0..self.dormers {
            let x = roof.length * ((f32::from(dormer) + 0.5) / f32::from(self.dormers) - 0.5) * 0.86;
            let dormer = dormer_parts(&roof, plaster, tiles, paints.window);
            top.add_moved(dormer, Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)));
        }
        parts.add_moved(top, from_roof);

        let (half_width, half_depth) = (0.5 * self.width, 0.5 * self.depth);
        let mut facade = |width: f32, has_door: bool, to_side: Affine3A| {
            parts.add_moved(self.facade(width, has_door, paints, random), to_side);
        };
        let turned = |quarters: f32, out: f32| {
            Affine3A::from_rotation_z(quarters * FRAC_PI_2) * Affine3A::from_translation(Vec3::new(0.0, -out, 0.0))
        };
        facade(self.width, true, turned(0.0, half_depth));
        facade(self.width, false, turned(2.0, half_depth));
        for (has_windows, quarters) in self.side_windows.into_iter().zip([3.0, 1.0]) {
            if has_windows {
                facade(self.depth, false, turned(quarters, half_width));
            }
        }
        parts
    }

    fn roof(&self, random: &mut Random) -> Roof {
        let (length, span) = if self.is_gable_fronted { (self.depth, self.width) } else { (self.width, self.depth) };
        Roof {
            length,
            span,
            eaves: STOREY * f32::from(self.storeys) + random.between(0.2, 1.3),
            slope: self.slope,
            overhang: random.between(0.35, 0.55),
        }
    }

    /// The openings of one side, in the plane y = 0, seen from the south.
    fn facade(&self, width: f32, has_door: bool, paints: &Paints, random: &mut Random) -> Parts {
        let mut parts = Parts::default();
        // Fewer towards the court and the sides than towards the street.
        let columns = ((width - 1.0) / if has_door { 3.2 } else { 4.8 }).round().max(1.0) as u8;
        let spacing = (width - 0.8) / f32::from(columns);
        let door = random.pick(&(0..columns).collect::<Vec<_>>());
        for column in 0..columns {
            let x = spacing * (f32::from(column) + 0.5 - 0.5 * f32::from(columns));
            for storey in 0..self.storeys {
                let (size, sill, paint) = match (storey, has_door) {
                    (0, true) if column == door => (Vec3::new(1.3, 0.18, 2.3), 0.0, paints.timber),
                    _ => (Vec3::new(1.0, 0.14, 1.45), 0.95, paints.window),
                };
                parts.add(paint, opening(Vec2::new(x, STOREY * f32::from(storey) + sill), size));
            }
        }
        parts
    }
}

/// A thin box that stands a little proud of the wall, the middle of its lower edge at `foot` in the wall.
fn opening(foot: Vec2, size: Vec3) -> Surface {
    block(Vec3::new(foot.x, 0.0, foot.y), size)
}

/// A small gabled dormer on the southern slope of `roof`, over x = 0.
fn dormer_parts(roof: &Roof, plaster: Paint, tiles: Paint, window: Paint) -> Parts {
    const SETBACK: f32 = 1.1;
    const HEIGHT: f32 = 1.5;
    let front = SETBACK - 0.5 * roof.span;
    let sill = roof.height(front);
    let gable = Roof { length: 1.0, span: 1.5, eaves: HEIGHT + 0.7, slope: 0.8, overhang: 0.2 };
    // Back to where the main roof is as high as the dormer's ridge, and a little into it.
    let length = (gable.ridge() - 0.7) / roof.slope + 0.4;
    let gable = Roof { length, ..gable };
    let mut along_x = Parts::default();
    along_x.add(plaster, gable.gabled_walls());
    along_x.add(tiles, gable.gabled());
    along_x.add(window, block(Vec3::new(-0.5 * length, 0.0, 0.9), Vec3::new(0.12, 0.85, 1.15)));
    let mut parts = Parts::default();
    let to_front = Affine3A::from_translation(Vec3::new(0.0, front + 0.5 * length, sill - 0.7));
    parts.add_moved(along_x, to_front * Affine3A::from_rotation_z(FRAC_PI_2));
    parts
}
