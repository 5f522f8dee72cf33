//! The edges that may ever be silhouette: those between different faces, or with other than two.
//!
//! Nearly all are pairs: two faces walk the edge in opposite directions, and it is silhouette exactly where their coefficients differ. In dual space a
//! pair is the segment between two points. All others (borders, fans, faces that walk an edge the same way) are summed as they are.

use borsh::{BorshDeserialize, BorshSerialize};
use rayon::prelude::*;

use crate::{Caster, Topology};

use super::faces::{Faces, FramedLight};

/// Edges between faces, sorted by how they are tested.
#[derive(Debug, Clone, PartialEq, Default, BorshDeserialize, BorshSerialize)]
pub(super) struct Edges {
    /// The faces of each pair; the first walks it from its start to its end, the second back. Those of closed components come first.
    pub(super) pairs: Vec<[u32; 2]>,
    /// Start and end of each pair.
    pub(super) pair_ends: Vec<[u32; 2]>,
    /// How many of the pairs are of closed components.
    pub(super) closed_pairs: usize,
    /// Every other edge.
    pub(super) odd: Vec<OddEdge>,
    /// See [`OddEdge`].
    pub(super) odd_faces: Vec<OddFace>,
    /// How many edges there are, forgotten ones included.
    pub(super) count: usize,
}

/// An edge with the faces `odd_faces[first..last]`.
#[derive(Debug, Clone, Copy, PartialEq, BorshDeserialize, BorshSerialize)]
pub(super) struct OddEdge {
    pub(super) ends: [u32; 2],
    pub(super) first: u32,
    pub(super) last: u32,
}

/// How often a face walks an odd edge from start to end, less how often back.
#[derive(Debug, Clone, Copy, PartialEq, BorshDeserialize, BorshSerialize)]
pub(super) struct OddFace {
    pub(super) face: u32,
    pub(super) times: i32,
    is_closed: bool,
    /// A copy, so that odd edges are read in a row.
    plane: [f32; 4],
}

impl OddFace {
    /// The face's coefficient under `light`.
    pub(super) fn coefficient(&self, light: &FramedLight) -> i32 {
        light.coefficient(self.plane, self.is_closed)
    }
}

impl Edges {
    /// The edges of `caster` between `faces`. Linear in the number of edges; takes 16 bytes for each pair.
    pub(super) fn new(caster: &Caster, faces: &Faces) -> Self {
        let mut edges = Self::default();
        let mut pairs = Vec::with_capacity(caster.topology.edges().len());
        let mut around: Vec<OddFace> = Vec::new();
        for (e, edge) in caster.topology.edges().iter().enumerate() {
            around.clear();
            for (t, direction) in caster.topology.triangles_on_edge(e) {
                let face = faces.of_triangle[t];
                match around.iter_mut().find(|known| known.face == face) {
                    Some(known) => known.times += direction,
                    None => around.push(OddFace {
                        face,
                        times: direction,
                        is_closed: (face as usize) < faces.closed,
                        plane: faces.plane(face),
                    }),
                }
            }
            around.retain(|on| on.times != 0);
            match *around.as_slice() {
                [] => {}
                [a, b] if (a.times, b.times) == (1, -1) || (a.times, b.times) == (-1, 1) => {
                    let (first, second) = if is_farther(a.plane, b.plane) { (a, b) } else { (b, a) };
                    let ends = if first.times == 1 { [edge.low, edge.high] } else { [edge.high, edge.low] };
                    pairs.push(([first.face, second.face], ends));
                }
                _ => {
                    let first = edges.odd_faces.len() as u32;
                    edges.odd_faces.extend_from_slice(&around);
                    let last = edges.odd_faces.len() as u32;
                    edges.odd.push(OddEdge { ends: [edge.low, edge.high], first, last });
                }
            }
        }
        // In the order of their faces, and those of closed components come first.
        pairs.par_sort_unstable();
        edges.closed_pairs = pairs.partition_point(|([first, _], _)| (*first as usize) < faces.closed);
        (edges.pairs, edges.pair_ends) = pairs.into_iter().unzip();
        edges.count = edges.pairs.len() + edges.odd.len();
        edges
    }

    /// The edges of `topology` as pairs of their ends.
    pub(super) fn of_vertices(topology: &Topology) -> Self {
        let ends: Vec<[u32; 2]> = topology.edges().iter().map(|edge| [edge.low, edge.high]).collect();
        Self { closed_pairs: ends.len(), count: ends.len(), pair_ends: ends.clone(), pairs: ends, ..Self::default() }
    }

    /// Forgets the pairs, which are elsewhere.
    pub(super) fn drop_pairs(&mut self) {
        (self.pairs, self.pair_ends) = (Vec::new(), Vec::new());
    }

    /// The faces of an odd edge.
    pub(super) fn faces_of(&self, edge: &OddEdge) -> &[OddFace] {
        &self.odd_faces[edge.first as usize..edge.last as usize]
    }

    /// Adds those of the odd edges that are silhouette, for faces with coefficients `c`.
    pub(super) fn add_odd(&self, c: impl Fn(&OddFace) -> i32, found: &mut Vec<[u32; 2]>) {
        for edge in &self.odd {
            let m = self.faces_of(edge).iter().map(|on| on.times * c(on)).sum();
            super::add_side(found, edge.ends, m);
        }
    }

    /// Whether no number in them leads out of them, out of `faces` or out of `caster`; `has_pairs` is false where pairs were forgotten.
    pub(super) fn are_whole(&self, faces: &Faces, caster: &Caster, has_pairs: bool) -> bool {
        let is_face = |face: u32| (face as usize) < faces.len();
        let is_vertex = |vertex: &u32| (*vertex as usize) < caster.positions.len();
        let has_good_pairs = self.pairs.len() == self.pair_ends.len()
            && (if has_pairs { self.closed_pairs <= self.pairs.len() } else { self.pairs.is_empty() })
            && self.pairs.as_flattened().iter().all(|&face| is_face(face))
            && self.pair_ends.as_flattened().iter().all(is_vertex);
        // The coefficients of an edge are summed, and so often is it listed.
        let walks: u64 = self.odd_faces.iter().map(|on| u64::from(on.times.unsigned_abs())).sum();
        let ranges_follow = self.odd.iter().try_fold(0, |next, edge| {
            (edge.first == next && edge.first <= edge.last && edge.last as usize <= self.odd_faces.len())
                .then_some(edge.last)
        });
        has_good_pairs
            && ranges_follow.is_some()
            && walks <= 3 * caster.mesh.triangles().len() as u64
            && self.odd_faces.iter().all(|on| is_face(on.face))
            && self.odd.iter().all(|edge| edge.ends.iter().all(is_vertex))
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.pairs.as_slice())
            + size_of_val(self.pair_ends.as_slice())
            + size_of_val(self.odd.as_slice())
            + size_of_val(self.odd_faces.as_slice())
    }
}

/// Whether `a` is farther than `b` along the axis on which the two planes differ most.
fn is_farther(a: [f32; 4], b: [f32; 4]) -> bool {
    let difference = |axis: &usize| (a[*axis] - b[*axis]).abs();
    let widest = (0..4).max_by(|i, j| difference(i).total_cmp(&difference(j)).then(j.cmp(i))).unwrap_or(0);
    a[widest] > b[widest]
}
