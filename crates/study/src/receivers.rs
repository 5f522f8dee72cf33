//! Points that may be in the sun: on the ground, on surfaces, anywhere.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

/// All the points of a study, in groups that belong together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Receivers {
    /// Scene space, metres.
    pub positions: Vec<DVec3>,
    /// One unit vector for each position: the sun must be on its side. Zero where the receiver is open to all sides.
    pub normals: Vec<Vec3>,
    /// Inside a solid: no receiver at all, kept so that grids stay grids.
    pub is_inside: Vec<bool>,
    /// In order, each a range of the above; they cover all.
    pub groups: Vec<Group>,
}

/// Receivers that are reported together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// "ground", or the name of an object, or that of a file of points.
    pub name: String,
    /// What they are on.
    pub kind: GroupKind,
    /// Which ones.
    pub range: Range<usize>,
}

/// What receivers are on.
#[derive(Debug, Clone, PartialEq)]
pub enum GroupKind {
    /// A grid on the ground: rows from north to south, each from west to east.
    Ground {
        /// The centre of the first cell, scene space.
        first: DVec2,
        /// Metres between centres.
        spacing: f64,
        /// Cells from west to east.
        columns: usize,
        /// Cells from north to south.
        rows: usize,
    },
    /// Points on surfaces of one object.
    Surface {
        /// Index into the scene's objects.
        object: usize,
        /// What the surfaces are.
        surface: umbrae_core::SurfaceKind,
        /// Square metres that each receiver of the range stands for.
        areas: Vec<f32>,
    },
    /// Points that the user gave, with their names.
    Points {
        /// One for each receiver of the range.
        names: Vec<String>,
    },
}
