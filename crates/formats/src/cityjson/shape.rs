//! The surfaces of a city object, cut into triangles.

use std::ops::Range;

use glam::{DAffine3, DMat3, DVec3};
use umbrae_core::Surface;

use super::city::vertex_at;
use super::document::Geometry;
use super::surfaces::PolygonOf;
use crate::error::quoted;
use crate::json::Nested;
use crate::look::Looks;
use crate::polygon::{Cut, Triangulator};
use crate::warnings::{Warnings, Words};

/// Whose surfaces they are.
#[derive(Debug, Clone)]
pub(super) struct Source<'a> {
    pub(super) id: &'a str,
    pub(super) kind: &'a str,
    /// What its indices count from.
    pub(super) vertices: Range<usize>,
}

/// Cuts the surfaces of one city object at a time.
pub(super) struct Shaper<'a> {
    vertices: &'a [DVec3],
    origin: DVec3,
    triangulator: Triangulator,
    /// For each vertex the last object that used it, counted from 1, and its index there.
    local: Vec<(u32, u32)>,
    object: u32,
    /// Of the polygon at hand: its vertices, outer ring first, where holes begin, and its corners in space.
    ring: Vec<usize>,
    hole_starts: Vec<u32>,
    corners: Vec<DVec3>,
}

impl<'a> Shaper<'a> {
    /// For objects whose corners are among `vertices`, which are put about `origin`.
    pub(super) fn new(vertices: &'a [DVec3], origin: DVec3) -> Self {
        Self {
            vertices,
            origin,
            triangulator: Triangulator::new(),
            local: vec![(0, 0); vertices.len()],
            object: 0,
            ring: Vec::new(),
            hole_starts: Vec::new(),
            corners: Vec::new(),
        }
    }

    /// All surfaces of `geometries` as one.
    pub(super) fn surface(
        &mut self,
        source: &Source<'_>,
        geometries: &[&Geometry],
        looks: &mut Looks,
        warnings: &mut Warnings,
    ) -> Surface {
        self.object += 1;
        let mut surface = Surface::default();
        for geometry in geometries {
            let result = geometry.for_each_surface(|polygon| {
                if let Err((words, what)) = self.read(polygon, source, warnings) {
                    warnings.add_one(words, || format!("city object {}: {what}", quoted(source.id)));
                    return;
                }
                if polygon.semantic == "ClosureSurface" {
                    let words = [
                        "closure surface, which in reality is open, is shown as a wall",
                        "closure surfaces, which in reality are open, are shown as walls",
                    ];
                    warnings.add_one(words, || format!("city object {}", quoted(source.id)));
                }
                let material = looks.material_of(source.kind, polygon.semantic);
                if self.cut(&mut surface, material) == Cut::Fan {
                    let words = [
                        "polygon that crosses itself or has no area was cut as a fan",
                        "polygons that cross themselves or have no area were cut as fans",
                    ];
                    warnings.add_one(words, || format!("city object {}", quoted(source.id)));
                }
            });
            if let Err(message) = result {
                let words = [
                    "geometry was cut off where it is badly nested",
                    "geometries were cut off where they are badly nested",
                ];
                warnings.add_one(words, || format!("city object {}: {message}", quoted(source.id)));
            }
        }
        surface
    }

    /// Reads the rings of `polygon`; of one that is no polygon, what is wrong.
    fn read(
        &mut self,
        polygon: PolygonOf<'_>,
        source: &Source<'_>,
        warnings: &mut Warnings,
    ) -> Result<(), (Words, String)> {
        self.ring.clear();
        self.hole_starts.clear();
        for (number, ring) in polygon.rings.iter().enumerate() {
            let start = self.ring.len();
            for corner in ring.list().unwrap_or(std::slice::from_ref(ring)) {
                let vertex = vertex_at(corner, &source.vertices).ok_or_else(|| no_vertex(corner, source))?;
                if self.ring[start..].last() != Some(&vertex) {
                    self.ring.push(vertex);
                }
            }
            // Some close their rings, as in GML.
            if self.ring.len() > start + 1 && self.ring.last() == Some(&self.ring[start]) {
                self.ring.pop();
            }
            let count = self.ring.len() - start;
            if count >= 3 {
                if number > 0 {
                    self.hole_starts.push(start as u32);
                }
                continue;
            }
            let what = format!("{count} of them in ring {number}");
            if number == 0 {
                let words = [
                    "surface of fewer than three corners was skipped",
                    "surfaces of fewer than three corners were skipped",
                ];
                return Err((words, what));
            }
            self.ring.truncate(start);
            let words =
                ["hole of fewer than three corners was skipped", "holes of fewer than three corners were skipped"];
            warnings.add_one(words, || format!("city object {}: {what}", quoted(source.id)));
        }
        if self.ring.is_empty() {
            let words = ["surface without a ring was skipped", "surfaces without a ring were skipped"];
            return Err((words, "its list is empty".to_owned()));
        }
        Ok(())
    }

    /// Adds the triangles of the polygon at hand.
    fn cut(&mut self, surface: &mut Surface, material: u32) -> Cut {
        self.corners.clear();
        self.corners.extend(self.ring.iter().map(|&v| self.vertices[v]));
        for &vertex in &self.ring {
            let local = &mut self.local[vertex];
            if local.0 != self.object {
                *local = (self.object, surface.positions.len() as u32);
                surface.positions.push((self.vertices[vertex] - self.origin).as_vec3());
            }
        }
        let (ring, local) = (&self.ring, &self.local);
        let add = |t: [u32; 3]| surface.triangles.push(t.map(|i| local[ring[i as usize]].1));
        let cut = self.triangulator.triangulate_with_holes(&self.corners, &self.hole_starts, add);
        surface.triangle_materials.resize(surface.triangles.len(), material);
        cut
    }
}

fn no_vertex(corner: &Nested, source: &Source<'_>) -> (Words, String) {
    let words = [
        "surface was skipped because it names a vertex that does not exist",
        "surfaces were skipped because they name vertices that do not exist",
    ];
    (words, format!("vertex {corner}, of {}", source.vertices.len()))
}

/// The place of an instance about its anchor: a matrix of four rows, of which the last is 0, 0, 0, 1.
pub(super) fn affine_of(matrix: Option<&[f64]>) -> Result<DAffine3, String> {
    let Some(matrix) = matrix else { return Ok(DAffine3::IDENTITY) };
    let wrong = |what: String| format!("its transformationMatrix {what}");
    let matrix: &[f64; 16] = matrix.try_into().map_err(|_| wrong(format!("has {} numbers, not 16", matrix.len())))?;
    let [rows @ .., last] = matrix.as_chunks::<4>().0 else { return Err(wrong("has no rows".to_owned())) };
    if *last != [0.0, 0.0, 0.0, 1.0] {
        return Err(wrong(format!("ends with {last:?}, not [0, 0, 0, 1]")));
    }
    let row = |i: usize| DVec3::new(rows[i][0], rows[i][1], rows[i][2]);
    let linear = DMat3::from_cols(row(0), row(1), row(2)).transpose();
    let translation = DVec3::new(rows[0][3], rows[1][3], rows[2][3]);
    let is_good = linear.is_finite() && translation.is_finite() && linear.determinant() != 0.0;
    if !is_good {
        return Err(wrong("flattens what it moves, or has numbers that are not finite".to_owned()));
    }
    Ok(DAffine3 { matrix3: linear, translation })
}
