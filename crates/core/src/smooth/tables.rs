//! A smooth body as numbers: what another processor needs to find the same silhouettes.

use glam::Vec3;

use super::body::{Bend, SmoothBody, sides_of};
use super::crossing::{INSET, MOST_INSET};
use super::facing::SADDLE;

/// In [`SmoothTables::bends`]: the edge is straight.
pub const NO_BEND: u32 = u32::MAX;

const NONE: u32 = u32::MAX;

/// What of a [`SmoothBody`] does not depend on a light.
///
/// A wedge is a vertex of the caster with one of the normals that meet there. Everything is in the order of the body: triangles are the caster's.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothTables {
    /// Of each wedge the caster's vertex.
    pub vertices: Vec<u32>,
    /// Of each wedge, where the body was made: unit length or 0, scene space.
    pub normals: Vec<Vec3>,
    /// Of each wedge where its vertex is taken for to be by pieces of the surface that must face the light if they are lit, or must not if they are dark:
    /// [`SmoothTables::SADDLE`] times the most that an edge there bends inward below the vertex, along the normal; scene space, where the body was made.
    pub inner: Vec<Vec3>,
    /// Of each wedge whether its vertex is the end of a crease, so that it stays where it is.
    pub is_end_of_crease: Vec<bool>,
    /// Of each triangle its wedges.
    pub triangles: Vec<[u32; 3]>,
    /// Of each triangle its edges: that from the first wedge to the second, and so on.
    pub triangle_edges: Vec<[u32; 3]>,
    /// Of each edge between wedges its ends, in the order of the caster's vertices.
    pub edges: Vec<[u32; 2]>,
    /// Of each edge the triangle that walks it in that order, and the one that walks it back; `u32::MAX` where there is none.
    pub edge_triangles: Vec<[u32; 2]>,
    /// Of each edge how it is bent: its own number where the surface goes on over it, that of the other side where it is a crease, or [`NO_BEND`].
    pub bends: Vec<u32>,
    /// Edges of the caster whose two sides have different normals.
    pub creases: Vec<TwoSidedCrease>,
}

/// A crease between two triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TwoSidedCrease {
    /// Of the caster, the lower first.
    pub vertices: [u32; 2],
    /// The edge between wedges on the side whose triangle walks from the lower vertex to the higher, and that on the other.
    pub edges: [u32; 2],
}

impl SmoothTables {
    /// The fold is moved into the body by so many lengths of the edge that it meets.
    pub const INSET: f64 = INSET;
    /// And at most by so many radii of the body's box.
    pub const MOST_INSET: f64 = MOST_INSET;
    /// By so many times the most that an edge bends inward there, vertices are moved inward.
    pub const SADDLE: f64 = SADDLE;
}

impl SmoothBody {
    /// The body as numbers; `None` where more than two triangles meet in a crease.
    ///
    /// Linear in the number of triangles.
    pub fn tables(&self) -> Option<SmoothTables> {
        let topology = &self.wedges.topology;
        let triangles = self.wedges.mesh.triangles().to_vec();
        let edge_between = |a, b| topology.edge_between(a, b).map(|e| e as u32);
        let edges_of = |&[a, b, c]: &[u32; 3]| {
            let edges = [edge_between(a, b), edge_between(b, c), edge_between(c, a)];
            edges.map(|e| e.expect("the edge is the triangle's"))
        };
        let triangle_edges = triangles.iter().map(edges_of).collect();
        let bend = |(&bend, e): (&Bend, u32)| match bend {
            Bend::Smooth => e,
            Bend::Crease(crease) => {
                let [a, b] = [0, 1].map(|i| self.creases[crease as usize].sides[i].edge);
                if a == e { b } else { a }
            }
            Bend::Straight => NO_BEND,
        };
        let creases = self.creases.iter().map(|crease| match crease.sides[..] {
            [a, b] if a.direction > 0 && b.direction < 0 => Some([a, b]),
            [b, a] if a.direction > 0 && b.direction < 0 => Some([a, b]),
            _ => None,
        });
        let creases = creases.zip(&self.creases).map(|(sides, crease)| {
            Some(TwoSidedCrease { vertices: crease.vertices, edges: sides?.map(|side| side.edge) })
        });
        let creases = creases.collect::<Option<Vec<_>>>()?;
        let triangles_of = |e: usize| {
            let mut of_edge = [NONE; 2];
            // Of a straight edge there may be more, and none is looked for.
            if self.bends[e] != Bend::Straight {
                let sides = sides_of(topology, &self.vertex_of_wedge, e as u32);
                sides.for_each(|side| of_edge[usize::from(side.direction < 0)] = side.triangle);
            }
            of_edge
        };
        let mut is_end_of_crease = vec![false; self.inner.len()];
        self.creases.iter().flat_map(|crease| crease.vertices).for_each(|v| is_end_of_crease[v as usize] = true);
        let vertices = || self.vertex_of_wedge.iter().map(|&v| v as usize);
        Some(SmoothTables {
            vertices: self.vertex_of_wedge.clone(),
            normals: self.normals.clone(),
            inner: vertices().map(|v| self.inner[v]).collect(),
            is_end_of_crease: vertices().map(|v| is_end_of_crease[v]).collect(),
            triangles,
            triangle_edges,
            edges: (0..topology.edges().len()).map(|e| self.ends(e)).collect(),
            edge_triangles: (0..topology.edges().len()).map(triangles_of).collect(),
            bends: self.bends.iter().zip(0..).map(bend).collect(),
            creases,
        })
    }
}
