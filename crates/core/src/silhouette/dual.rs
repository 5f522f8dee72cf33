//! Edges in dual space: segments between the planes of their faces, cut by the hyperplane of the light.
//!
//! ```text
//!     primal                       dual
//!       \ light                      . b           An edge is silhouette exactly when the light's
//!     a  \__ b                       /             hyperplane separates the dual points of its two
//!    ____/                  ------- / -------      faces. A tree of boxes over the segments leads
//!                             L    a               to those near the hyperplane.
//! ```
//!
//! Source: G. Wallner 2007, section 4, after A. Hertzmann and D. Zorin 2000 and J. Claes et al. 2001. His tree has cells of fixed places, sixteen in
//! each, down to a depth of four, and an edge is in the smallest cell that holds both ends, which for many is a large one. Here a node
//! has sixteen children too, but each is a tight box around both ends of its edges, split at the median of the axis on which they are spread widest,
//! to a depth that follows from their number. His test of a cell is kept: of the corners where the light is highest and
//! lowest above the box, found from the signs of the light's coordinates, one is above and one below. Sixteen boxes are tested at once, and
//! the leaves are packets of 64 edges.
//!
//! Rounding of products and sums is monotone, so the height of the least corner, rounded, is no more than that of any point in the box, rounded: no edge
//! is ever missed, and no box need be widened.

use super::edges::Edges;
use super::faces::Faces;
use super::hierarchy::{Bound, Bounding, Trees};
use super::simd::{self, CHILDREN};

/// The trees over the pairs of `edges`.
pub(super) fn trees(faces: &Faces, edges: &Edges) -> Trees<Box4> {
    Trees::new(edges, faces, &Segments { faces, edges })
}

/// A box in dual space that holds both ends of its edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Box4 {
    min: [f32; 4],
    max: [f32; 4],
}

/// Sixteen boxes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Boxes {
    min: [[f32; CHILDREN]; 4],
    max: [[f32; CHILDREN]; 4],
}

impl Box4 {
    const EMPTY: Self = Self { min: [f32::INFINITY; 4], max: [f32::NEG_INFINITY; 4] };

    fn union(self, other: Self) -> Self {
        Self {
            min: std::array::from_fn(|i| self.min[i].min(other.min[i])),
            max: std::array::from_fn(|i| self.max[i].max(other.max[i])),
        }
    }
}

impl Bound for Box4 {
    type Sixteen = Boxes;

    fn sixteen(bounds: &[Self]) -> Boxes {
        // A box that is not there is infinitely high above every light: inside out.
        let mut boxes = Boxes { min: [[f32::INFINITY; CHILDREN]; 4], max: [[f32::NEG_INFINITY; CHILDREN]; 4] };
        for (i, bounds) in bounds.iter().enumerate() {
            for axis in 0..4 {
                boxes.min[axis][i] = bounds.min[axis];
                boxes.max[axis][i] = bounds.max[axis];
            }
        }
        boxes
    }

    fn open(boxes: &Boxes, hyperplane: [f32; 4], margin: f32) -> u16 {
        // G. Wallner's index: the signs of the light's coordinates name the lowest corner, and their opposites the highest.
        let (mut lowest, mut highest) = (boxes.min.each_ref(), boxes.max.each_ref());
        for axis in 0..4 {
            if hyperplane[axis] < 0.0 {
                std::mem::swap(&mut lowest[axis], &mut highest[axis]);
            }
        }
        simd::cut(lowest, highest, hyperplane, margin)
    }

    fn join(bounds: &[Self]) -> Self {
        bounds.iter().fold(Self::EMPTY, |all, &bounds| all.union(bounds))
    }
}

/// Pairs as segments between dual points.
struct Segments<'a> {
    faces: &'a Faces,
    edges: &'a Edges,
}

impl Segments<'_> {
    fn ends(&self, pair: u32) -> [[f32; 4]; 2] {
        self.edges.pairs[pair as usize].map(|face| self.faces.plane(face))
    }
}

impl Bounding<Box4, 4> for Segments<'_> {
    fn key(&self, pair: u32) -> [f32; 4] {
        let [a, b] = self.ends(pair);
        std::array::from_fn(|i| a[i] + b[i])
    }

    fn bound(&self, pairs: &[u32]) -> Box4 {
        let points = pairs.iter().flat_map(|&pair| self.ends(pair));
        points.fold(Box4::EMPTY, |bounds, point| bounds.union(Box4 { min: point, max: point }))
    }
}
