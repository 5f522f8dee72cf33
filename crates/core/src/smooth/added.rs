//! What triangles and creases add to a volume: found on many threads, each with names of its own for what is not a point of the volume yet.

use glam::{DVec3, Vec3};

use super::body::SmoothBody;
use super::facing::WrongPieces;

/// A corner of what is added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Corner {
    /// A point of the volume.
    Point(u32),
    /// A point that is added, by its number among them.
    Own(u32),
    /// A vertex of the caster.
    Vertex(u32),
    /// The same, [moved inward](SmoothBody::inner_places).
    Inner(u32),
}

/// From a corner to another, so often.
pub(super) type Walk<C> = ([C; 2], i32);

/// What some of a body's triangles or creases add.
#[derive(Debug, Default)]
pub(super) struct Added {
    pub(super) points: Vec<Vec3>,
    pub(super) sides: Vec<[Corner; 2]>,
    pub(super) faces: Vec<[Corner; 3]>,
    /// Straight ones, from a crossing to another.
    pub(super) fins: Vec<[u32; 2]>,
    pub(super) folds: Vec<[Corner; 3]>,
    pub(super) wrong: WrongPieces,
    /// Triangles of the light cap that may show the light their backs.
    pub(super) may_be_away: Vec<u32>,
    /// The part of the silhouette at hand.
    pub(super) curve: Vec<Corner>,
}

impl Added {
    pub(super) fn point(&mut self, place: DVec3) -> Corner {
        self.points.push(place.as_vec3());
        Corner::Own(self.points.len() as u32 - 1)
    }
}

/// Where `corner` is; `points` are those of the volume, `own` those that are added.
#[inline]
pub(super) fn place(corner: Corner, body: &SmoothBody, points: &[Vec3], own: &[Vec3]) -> DVec3 {
    match corner {
        Corner::Point(p) => points[p as usize],
        Corner::Own(p) => own[p as usize],
        Corner::Vertex(v) => body.place_of_vertex(v),
        Corner::Inner(v) => body.inner[v as usize],
    }
    .as_dvec3()
}

/// The same walk from the lower corner to the higher.
pub(super) fn undirected<C: Ord>(([a, b], times): Walk<C>) -> Walk<C> {
    if a < b { ([a, b], times) } else { ([b, a], -times) }
}
