//! Bodies and roofs of houses, with the ridge along x over the middle of the base.
//!
//! ```text
//!          ridge              The slab of a roof lies with the upper edge of the walls inside it, and
//!           /\                overhangs on all sides, so no two faces coincide.
//!         //  \\
//!       //______\\ eaves
//!      / |      | \
//!        |      |
//! ```

use glam::{DVec3, Vec2};
use umbrae_core::{Surface, shapes};

use crate::sample::model::profile;

/// How a roof sits on a house.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roof {
    /// Along the ridge.
    pub(super) length: f32,
    /// Across the ridge.
    pub(super) span: f32,
    /// Height of the walls.
    pub(super) eaves: f32,
    /// Rise over run.
    pub(super) slope: f32,
    /// How far the roof reaches over the walls.
    pub(super) overhang: f32,
}

impl Roof {
    const THICKNESS: f32 = 0.3;
    /// How far the slab's lower face is below the upper edge of the walls.
    const SUNK: f32 = 0.1;

    /// Height of the upper face over a place `y` across the ridge.
    pub(super) fn height(&self, y: f32) -> f32 {
        self.eaves + (0.5 * self.span - y.abs()) * self.slope + Self::THICKNESS - Self::SUNK
    }

    /// Height of the ridge.
    pub(super) fn ridge(&self) -> f32 {
        self.height(0.0)
    }

    /// Walls up to a roof of two slopes, gables included: 16 triangles.
    pub(super) fn gabled_walls(&self) -> Surface {
        let half = 0.5 * self.span;
        let top = self.eaves + half * self.slope;
        let outline = [(-half, 0.0), (half, 0.0), (half, self.eaves), (0.0, top), (-half, self.eaves)];
        profile(&outline.map(Vec2::from), -0.5 * self.length, 0.5 * self.length)
    }

    /// A slab of two slopes: 20 triangles.
    pub(super) fn gabled(&self) -> Surface {
        let half = 0.5 * self.span + self.overhang;
        let at = |y: f32, down: f32| Vec2::new(y, self.height(y) - down);
        let (upper, lower) = (0.0, Self::THICKNESS);
        let outline =
            [at(-half, lower), at(0.0, lower), at(half, lower), at(half, upper), at(0.0, upper), at(-half, upper)];
        let end = 0.5 * self.length + 0.6 * self.overhang;
        profile(&outline, -end, end)
    }

    /// A body of four slopes on a flat soffit: 16 triangles, or 12 where it is square and ends in a point.
    pub(super) fn hipped(&self) -> Surface {
        let half = 0.5 * Vec2::new(self.length, self.span) + self.overhang;
        let ridge_half = (half.x - half.y).max(0.0);
        let soffit = self.eaves - Self::SUNK;
        let fascia = soffit + Self::THICKNESS;
        let rectangle = |half: Vec2, z: f32| -> Vec<DVec3> {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| (half * Vec2::new(x, y)).extend(z).as_dvec3())
                .into()
        };
        let eaves = [rectangle(half, soffit), rectangle(half, fascia)];
        let top = fascia + half.y.min(half.x) * self.slope;
        if ridge_half == 0.0 {
            return shapes::loft(&[eaves[0].clone(), eaves[1].clone(), vec![DVec3::new(0.0, 0.0, top.into())]]);
        }
        // The lower part as a box without its lid, then the slopes up to the two ends of the ridge.
        let mut roof = shapes::loft(&eaves);
        roof.triangles.truncate(roof.triangles.len() - 2);
        let ridge = [-ridge_half, ridge_half].map(|x| Vec2::new(x, 0.0).extend(top));
        roof.positions.extend(ridge);
        roof.triangles.extend([[4, 5, 9], [4, 9, 8], [5, 6, 9], [6, 7, 8], [6, 8, 9], [7, 4, 8]]);
        roof
    }
}
