//! A triangle mesh that was checked once and is trusted from then on.

use glam::{Vec2, Vec3};
use rustc_hash::FxHashMap;

use crate::Bounds;

/// Triangles as a file gives them: nothing checked, nothing welded.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Corner positions, in object space, metres.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` each; counter-clockwise seen from outside, where there is an outside.
    pub triangles: Vec<[u32; 3]>,
    /// One index into [`crate::Scene::materials`] for each triangle; empty means material 0 for all.
    pub triangle_materials: Vec<u32>,
    /// Linear colours that multiply the material's, one for each position; empty means white.
    pub vertex_colors: Vec<Vec3>,
    /// Where the corners of each triangle are on its material's texture, (0, 0) the top left; empty means (0, 0) for all.
    pub corner_uvs: Vec<[Vec2; 3]>,
    /// The direction in which the surface that the triangles stand for faces at the corners of each, object space, any length; zero
    /// where a corner has none, and empty where none has. What is not finite counts as none.
    pub corner_normals: Vec<[Vec3; 3]>,
    /// One for each position; vertices with different keys are not welded though their positions are equal, because something
    /// will move them apart. Empty means equal keys for all.
    pub weld_keys: Vec<u32>,
}

/// Why a [`Surface`] is not a [`Mesh`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {index}, but there are only {vertex_count} vertices")]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// How many there are.
        vertex_count: usize,
    },
    /// A used coordinate is not a number, or infinite, or too large for exact work in `f32`.
    #[error(
        "vertex {vertex} is at ({}, {}, {}); coordinates must be finite and below {MAX_COORDINATE:e}",
        position.x, position.y, position.z
    )]
    BadPosition {
        /// Index of the vertex, from 0.
        vertex: u32,
        /// Where it is.
        position: Vec3,
    },
    /// There are more vertices or triangles than 32-bit indices can name.
    #[error("{count} {what} are more than a mesh can hold; split the model")]
    TooLarge {
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// There is no triangle with three different corners.
    #[error("no triangle is left ({read} read, {degenerate} of them with two equal corners)")]
    NoTriangles {
        /// Triangles in the surface.
        read: usize,
        /// Those that were dropped.
        degenerate: usize,
    },
    /// An optional list has neither no entry nor one for each element.
    #[error("{count} {what} were given for {expected}")]
    WrongLength {
        /// The list and what it goes with.
        what: &'static str,
        /// Its length.
        count: usize,
        /// The length it should have.
        expected: usize,
    },
}

/// Coordinates at or above this overflow in products of four of them, which facing tests and projections make.
pub(crate) const MAX_COORDINATE: f32 = 1e18;

/// What [`Mesh::new`] was given and what became of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeshCounts {
    /// Triangles in the surface, degenerate ones included.
    pub triangles_read: usize,
    /// Positions in the surface, unused ones included.
    pub vertices_read: usize,
    /// Triangles dropped because two of their corners are at bit-equal positions.
    pub degenerate_triangles: usize,
    /// Corners of the kept triangles whose normal was not finite, so that they have none.
    pub unusable_normals: usize,
}

/// A welded triangle mesh.
///
/// Every index is in range, every coordinate is finite, no two vertices have bit-equal positions (-0 counts as
/// 0), every vertex is used, and no triangle has two equal corners. Nothing is promised about closedness, manifoldness or
/// winding: see [`crate::Topology`].
///
/// ```
/// use glam::Vec3;
/// use umbrae_core::{Mesh, Surface};
///
/// // Two triangles that repeat their common corners weld into one sheet of four vertices.
/// let (a, b, c, d) = (Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y);
/// let mesh = Mesh::new(Surface {
///     positions: vec![a, b, c, a, c, d],
///     triangles: vec![[0, 1, 2], [3, 4, 5]],
///     ..Surface::default()
/// })?;
/// assert_eq!(mesh.positions().len(), 4);
/// # Ok::<(), umbrae_core::MeshError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    triangle_materials: Vec<u32>,
    corner_colors: Vec<[Vec3; 3]>,
    corner_uvs: Vec<[Vec2; 3]>,
    corner_normals: Vec<[Vec3; 3]>,
    source_vertices: Vec<u32>,
    counts: MeshCounts,
}

impl Mesh {
    /// Checks `surface`, welds vertices at bit-equal positions, drops triangles with two equal corners.
    ///
    /// Vertices keep the order in which triangles first use them, triangles keep theirs. Never merges by distance.
    /// Linear in the size of the surface.
    ///
    /// # Errors
    ///
    /// See [`MeshError`]; unused vertices are dropped unlooked at, so theirs may be anything.
    pub fn new(surface: Surface) -> Result<Self, MeshError> {
        let Surface {
            positions,
            triangles,
            triangle_materials,
            vertex_colors,
            corner_uvs,
            mut corner_normals,
            weld_keys,
        } = surface;
        for (what, count) in [("vertices", positions.len()), ("triangles", triangles.len())] {
            // A triangle index and a direction share 32 bits in `Topology`.
            if count >= (u32::MAX / 8) as usize {
                return Err(MeshError::TooLarge { what, count });
            }
        }
        check_length("materials of triangles", triangle_materials.len(), triangles.len())?;
        check_length("colours of vertices", vertex_colors.len(), positions.len())?;

        check_length("texture coordinates of triangles", corner_uvs.len(), triangles.len())?;
        check_length("normals of triangles", corner_normals.len(), triangles.len())?;
        check_length("weld keys of vertices", weld_keys.len(), positions.len())?;

        let mut weld = Weld::new(&positions, &weld_keys);
        let mut kept = Vec::with_capacity(triangles.len());
        let mut kept_materials = Vec::with_capacity(triangles.len());
        let mut corner_colors = Vec::new();
        let mut kept_uvs = Vec::new();
        let mut unusable_normals = 0;
        for (t, corners) in triangles.iter().enumerate() {
            let mut welded = [0; 3];
            for (to, &index) in welded.iter_mut().zip(corners) {
                *to = weld.vertex(t, index)?;
            }
            let [a, b, c] = welded;
            if a == b || b == c || c == a {
                continue;
            }
            kept.push(welded);
            kept_materials.push(triangle_materials.get(t).copied().unwrap_or(0));
            if !vertex_colors.is_empty() {
                corner_colors.push(corners.map(|index| vertex_colors[index as usize]));
            }
            kept_uvs.extend(corner_uvs.get(t));
            if let Some(&normals) = corner_normals.get(t) {
                unusable_normals += normals.iter().filter(|normal| !normal.is_finite()).count();
                // In place, since they are the largest of the lists.
                corner_normals[kept.len() - 1] = normals.map(unit_or_zero);
            }
        }
        let counts = MeshCounts {
            triangles_read: triangles.len(),
            vertices_read: positions.len(),
            degenerate_triangles: triangles.len() - kept.len(),
            unusable_normals,
        };
        if kept.is_empty() {
            return Err(MeshError::NoTriangles {
                read: counts.triangles_read,
                degenerate: counts.degenerate_triangles,
            });
        }
        corner_normals.truncate(kept.len());
        if corner_normals.iter().flatten().all(|&normal| normal == Vec3::ZERO) {
            corner_normals = Vec::new();
        }
        let (positions, source_vertices) = weld.finish(&mut kept);
        Ok(Self {
            positions,
            triangles: kept,
            triangle_materials: kept_materials,
            corner_colors,
            corner_uvs: kept_uvs,
            corner_normals,
            source_vertices,
            counts,
        })
    }

    /// The welded positions, object space, metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Indices into [`Mesh::positions`], three different ones each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// For each triangle, its index into [`crate::Scene::materials`].
    pub fn triangle_materials(&self) -> &[u32] {
        &self.triangle_materials
    }

    /// For each triangle, the linear colours of its corners; empty when the surface had none.
    pub fn corner_colors(&self) -> &[[Vec3; 3]] {
        &self.corner_colors
    }

    /// For each triangle, where its corners are on its texture; empty when the surface did not say.
    pub fn corner_uvs(&self) -> &[[Vec2; 3]] {
        &self.corner_uvs
    }

    /// For each triangle, the normals that the surface gave its corners: object space, each of unit length or zero, which says that
    /// the corner has none. Empty when no corner has one.
    ///
    /// Corners at one position may have different ones: there the surface has a crease.
    pub fn corner_normals(&self) -> &[[Vec3; 3]] {
        &self.corner_normals
    }

    /// For each of [`Mesh::positions`] the index of the first of the surface's positions that became it.
    pub fn source_vertices(&self) -> &[u32] {
        &self.source_vertices
    }

    /// The mesh of those triangles that `is_in` says, which must be at least one, and for each of its positions the index in this mesh.
    pub(crate) fn part(&self, is_in: impl Fn(usize) -> bool) -> (Self, Vec<u32>) {
        let kept: Vec<usize> = (0..self.triangles.len()).filter(|&t| is_in(t)).collect();
        let mut part_from_whole = vec![UNSEEN; self.positions.len()];
        let mut vertices = Vec::new();
        let triangles = kept.iter().map(|&t| {
            self.triangles[t].map(|whole| {
                let to = &mut part_from_whole[whole as usize];
                if *to == UNSEEN {
                    *to = vertices.len() as u32;
                    vertices.push(whole);
                }
                *to
            })
        });
        let triangles: Vec<[u32; 3]> = triangles.collect();
        let part = Self {
            positions: vertices.iter().map(|&v| self.positions[v as usize]).collect(),
            triangle_materials: kept.iter().map(|&t| self.triangle_materials[t]).collect(),
            corner_colors: kept.iter().filter_map(|&t| self.corner_colors.get(t).copied()).collect(),
            corner_uvs: kept.iter().filter_map(|&t| self.corner_uvs.get(t).copied()).collect(),
            corner_normals: kept.iter().filter_map(|&t| self.corner_normals.get(t).copied()).collect(),
            source_vertices: vertices.iter().map(|&v| self.source_vertices[v as usize]).collect(),
            counts: MeshCounts { triangles_read: kept.len(), vertices_read: vertices.len(), ..MeshCounts::default() },
            triangles,
        };
        (part, vertices)
    }

    /// The same mesh with those triangles turned over that `is_in` says: they are walked the other way round, and their normals point the other way.
    pub(crate) fn turned_over(&self, is_in: impl Fn(usize) -> bool) -> Self {
        let mut mesh = self.clone();
        for t in (0..mesh.triangles.len()).filter(|&t| is_in(t)) {
            mesh.triangles[t].swap(1, 2);
            if let Some(colors) = mesh.corner_colors.get_mut(t) {
                colors.swap(1, 2);
            }
            if let Some(uvs) = mesh.corner_uvs.get_mut(t) {
                uvs.swap(1, 2);
            }
            if let Some([a, b, c]) = mesh.corner_normals.get(t).copied() {
                mesh.corner_normals[t] = [-a, -c, -b];
            }
        }
        mesh
    }

    /// The same mesh with every material index raised by `first`, for a scene whose list already has that many.
    pub(crate) fn with_materials_after(&self, first: u32) -> Self {
        let mut mesh = self.clone();
        for material in &mut mesh.triangle_materials {
            *material += first;
        }
        mesh
    }

    /// What was read and what was dropped.
    pub fn counts(&self) -> MeshCounts {
        self.counts
    }

    /// The smallest box that holds the mesh, object space.
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.positions.iter().map(|p| p.as_dvec3()))
    }
}

fn check_length(what: &'static str, count: usize, expected: usize) -> Result<(), MeshError> {
    if count == 0 || count == expected { Ok(()) } else { Err(MeshError::WrongLength { what, count, expected }) }
}

/// `normal` with unit length; zero where it has no direction.
fn unit_or_zero(normal: Vec3) -> Vec3 {
    // In `f64` no length overflows, and none that is not 0 vanishes.
    let unit = normal.as_dvec3().try_normalize().unwrap_or_default().as_vec3();
    // Adding +0 turns -0 into +0, as for positions: equal normals are then bit-equal.
    unit + Vec3::ZERO
}

/// Not yet looked at by [`Weld`].
const UNSEEN: u32 = u32::MAX;

/// Gives bit-equal positions one index, in the order in which they are asked for.
struct Weld<'a> {
    positions: &'a [Vec3],
    keys: &'a [u32],
    /// For each source vertex its welded index, or [`UNSEEN`].
    welded_from_source: Vec<u32>,
    welded_from_bits: FxHashMap<[u32; 4], u32>,
    welded: Vec<Vec3>,
    /// For each welded vertex the source vertex that was first.
    sources: Vec<u32>,
}

impl<'a> Weld<'a> {
    fn new(positions: &'a [Vec3], keys: &'a [u32]) -> Self {
        Self {
            positions,
            keys,
            welded_from_source: vec![UNSEEN; positions.len()],
            welded_from_bits: FxHashMap::with_capacity_and_hasher(positions.len(), rustc_hash::FxBuildHasher),
            welded: Vec::with_capacity(positions.len()),
            sources: Vec::with_capacity(positions.len()),
        }
    }

    fn vertex(&mut self, triangle: usize, index: u32) -> Result<u32, MeshError> {
        let vertex_count = self.positions.len();
        let seen = self.welded_from_source.get_mut(index as usize).ok_or(MeshError::IndexOutOfRange {
            triangle,
            index,
            vertex_count,
        })?;
        if *seen == UNSEEN {
            // Adding +0 turns -0 into +0 and changes nothing else.
            let position = self.positions[index as usize] + Vec3::ZERO;
            let is_good = position.is_finite() && position.abs().max_element() < MAX_COORDINATE;
            if !is_good {
                return Err(MeshError::BadPosition { vertex: index, position });
            }
            let next = self.welded.len() as u32;
            let [x, y, z] = position.to_array().map(f32::to_bits);
            let key = self.keys.get(index as usize).copied().unwrap_or(0);
            *seen = *self.welded_from_bits.entry([x, y, z, key]).or_insert(next);
            if *seen == next {
                self.welded.push(position);
                self.sources.push(index);
            }
        }
        Ok(*seen)
    }

    /// Drops the vertices that only degenerate triangles used, and renumbers `triangles`; positions and source vertices.
    fn finish(self, triangles: &mut [[u32; 3]]) -> (Vec<Vec3>, Vec<u32>) {
        let mut final_from_welded = vec![UNSEEN; self.welded.len()];
        let mut used = Vec::with_capacity(self.welded.len());
        let mut sources = Vec::with_capacity(self.welded.len());
        for corner in triangles.iter_mut().flatten() {
            let to = &mut final_from_welded[*corner as usize];
            if *to == UNSEEN {
                *to = used.len() as u32;
                used.push(self.welded[*corner as usize]);
                sources.push(self.sources[*corner as usize]);
            }
            *corner = *to;
        }
        (used, sources)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Surface {
        Surface {
            positions: positions.iter().map(|&p| Vec3::from(p)).collect(),
            triangles: triangles.to_vec(),
            ..Surface::default()
        }
    }

    #[test]
    fn negative_zero_welds_with_zero() {
        let mesh = Mesh::new(surface(
            &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, -0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
            &[[0, 1, 2], [3, 4, 5]],
        ))
        .expect("a good surface");
        assert_eq!(mesh.positions().len(), 4);
        assert!(mesh.positions().iter().all(|p| p.x.to_bits() != (-0.0_f32).to_bits()));
    }

    #[test]
    fn positions_one_ulp_apart_stay_apart() {
        let next = f32::from_bits(1.0_f32.to_bits() + 1);
        let mesh = Mesh::new(surface(&[[1.0, 0.0, 0.0], [next, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]))
            .expect("a thin but good surface");
        assert_eq!(mesh.positions().len(), 3);
    }

    #[test]
    fn a_triangle_whose_corners_weld_is_dropped_and_counted_and_its_vertices_go() {
        let mesh = Mesh::new(surface(
            &[[9.0, 9.0, 9.0], [9.0, 9.0, 9.0], [7.0, 7.0, 7.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            &[[0, 1, 2], [3, 4, 5]],
        ))
        .expect("one triangle is good");
        assert_eq!(mesh.counts().degenerate_triangles, 1);
        assert_eq!((mesh.positions().len(), mesh.triangles().len()), (3, 1));
    }

    #[test]
    fn a_bad_index_and_a_bad_coordinate_are_named() {
        let bad_index = Mesh::new(surface(&[[0.0; 3]; 3], &[[0, 1, 7]])).expect_err("vertex 7 is missing");
        assert_eq!(bad_index.to_string(), "triangle 0 uses vertex 7, but there are only 3 vertices");
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            let error = Mesh::new(surface(&[[0.0; 3], [1.0, bad, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]));
            assert!(matches!(error, Err(MeshError::BadPosition { vertex: 1, .. })), "{bad}: {error:?}");
        }
    }

    #[test]
    fn corners_that_weld_keep_normals_of_their_own_and_those_of_dropped_triangles_go() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let with_normals = |corner_normals: Vec<[Vec3; 3]>| {
            let triangles = [[0, 1, 1], [0, 1, 2], [2, 1, 0]];
            Mesh::new(Surface { corner_normals, ..surface(&corners, &triangles) })
        };
        let mesh = with_normals(vec![
            [Vec3::NAN; 3],
            [Vec3::new(0.0, 0.0, 1e-30), Vec3::ZERO, Vec3::new(4e30, -0.0, 0.0)],
            [Vec3::NAN, Vec3::NEG_Y, Vec3::new(f32::INFINITY, 0.0, 0.0)],
        ])
        .expect("two triangles are good");
        assert_eq!(mesh.corner_normals(), [[Vec3::Z, Vec3::ZERO, Vec3::X], [Vec3::ZERO, Vec3::NEG_Y, Vec3::ZERO]]);
        assert_eq!((mesh.counts().unusable_normals, mesh.positions().len()), (2, 3));
        assert!(mesh.corner_normals()[0][2].y.is_sign_positive(), "-0 is +0");
        let (part, _) = mesh.part(|t| t == 1);
        assert_eq!(part.corner_normals(), &mesh.corner_normals()[1..]);
        assert_eq!(mesh.with_materials_after(3).corner_normals(), mesh.corner_normals());

        assert!(with_normals(vec![[Vec3::ZERO; 3]; 3]).expect("good").corner_normals().is_empty());
        let short = with_normals(vec![[Vec3::Z; 3]; 2]).expect_err("one is missing");
        assert_eq!(short.to_string(), "2 normals of triangles were given for 3");
    }

    #[test]
    fn an_unused_bad_vertex_does_no_harm() {
        let mesh =
            Mesh::new(surface(&[[f32::NAN; 3], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[1, 2, 3]]));
        assert!(mesh.is_ok());
    }
}
