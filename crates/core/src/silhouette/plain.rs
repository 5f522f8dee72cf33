//! The baseline: a loop over the edges, with two dot products for each.
//!
//! Source: the brute force of G. Wallner 2007, section 4. Here to be compared with.

use super::edges::Edges;
use super::faces::{Faces, FramedLight};

/// Planes as such a loop would have them: each in one place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlanesInRows {
    planes: Vec<[f32; 4]>,
    /// How many are of closed components.
    closed: usize,
}

impl PlanesInRows {
    pub(super) fn new(faces: &Faces) -> Self {
        let planes = (0..faces.len() as u32).map(|face| faces.plane(face)).collect();
        Self { planes, closed: faces.closed }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.planes.as_slice())
    }
}

/// Adds the silhouette under `light` to `found`.
pub(super) fn find(planes: &PlanesInRows, edges: &Edges, light: &FramedLight, found: &mut Vec<[u32; 2]>) {
    let coefficient = |face: u32| {
        let face = face as usize;
        light.coefficient(planes.planes[face], face < planes.closed)
    };
    for (&[a, b], &ends) in edges.pairs.iter().zip(&edges.pair_ends) {
        super::add_side(found, ends, coefficient(a) - coefficient(b));
    }
    edges.add_odd(|on| on.coefficient(light), found);
}
