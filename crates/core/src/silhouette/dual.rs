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
//! Where all first ends of a box's edges are on one side and all second ends on the other, its edges are silhouette without a test. For that to happen, ends of
//! edges that are alike must come in the same order: the first is farther along the axis on which the two differ most (`edges.rs`). Buildings have such boxes,
//! scanned bodies hardly any.
//!
//! Rounding of products and sums is monotone, so the height of the least corner, rounded, is no more than that of any point in the box, rounded: no edge
//! is ever missed, and no box need be widened.

use borsh::{BorshDeserialize, BorshSerialize};

use super::edges::Edges;
use super::faces::Faces;
use super::hierarchy::{Bound, Bounding, Look, Trees};
use super::simd::{self, CHILDREN};

/// The trees over the pairs of `edges`.
pub(super) fn trees(faces: &Faces, edges: &Edges) -> Trees<Ends> {
    Trees::new(edges, faces, &Segments { faces, edges })
}

/// Boxes in dual space around the first ends of edges, and around the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends([Box4; 2]);

/// A box in four dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Box4 {
    min: [f32; 4],
    max: [f32; 4],
}

/// Sixteen boxes.
#[derive(Debug, Clone, PartialEq, BorshDeserialize, BorshSerialize)]
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

impl Boxes {
    fn new(bounds: impl Iterator<Item = Box4>) -> Self {
        let mut boxes = Self { min: [[0.0; CHILDREN]; 4], max: [[0.0; CHILDREN]; 4] };
        for (i, bounds) in bounds.enumerate() {
            for axis in 0..4 {
                boxes.min[axis][i] = bounds.min[axis];
                boxes.max[axis][i] = bounds.max[axis];
            }
        }
        boxes
    }

    /// Which of the boxes the light is above all of, and which it is above nothing of.
    fn sides(&self, hyperplane: [f32; 4], edge_on: Option<f32>) -> [u16; 2] {
        // G. Wallner's index: the signs of the light's coordinates name the lowest corner, and their opposites the highest.
        let (mut lowest, mut highest) = (self.min.each_ref(), self.max.each_ref());
        for axis in 0..4 {
            if hyperplane[axis] < 0.0 {
                std::mem::swap(&mut lowest[axis], &mut highest[axis]);
            }
        }
        simd::sides(lowest, highest, hyperplane, edge_on)
    }
}

impl Bound for Ends {
    type Sixteen = [Boxes; 2];

    fn sixteen(bounds: &[Self]) -> [Boxes; 2] {
        [0, 1].map(|end| Boxes::new(bounds.iter().map(|ends| ends.0[end])))
    }

    fn look(boxes: &[Boxes; 2], hyperplane: [f32; 4], edge_on: Option<f32>) -> Look {
        let [[first_up, first_down], [second_up, second_down]] =
            boxes.each_ref().map(|boxes| boxes.sides(hyperplane, edge_on));
        let is_uniform = (first_up & second_up) | (first_down & second_down);
        // In open components a light may be in the plane of a face besides, and an edge be there twice.
        let is_between = |up: u16, down: u16| if edge_on.is_none() { up & down } else { 0 };
        let (forward, backward) = (is_between(first_up, second_down), is_between(second_up, first_down));
        Look { open: !(is_uniform | forward | backward), forward, backward }
    }

    fn join(bounds: &[Self]) -> Self {
        Self([0, 1].map(|end| bounds.iter().fold(Box4::EMPTY, |all, ends| all.union(ends.0[end]))))
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

impl Bounding<Ends, 4> for Segments<'_> {
    fn key(&self, pair: u32) -> [f32; 4] {
        let [a, b] = self.ends(pair);
        std::array::from_fn(|i| a[i] + b[i])
    }

    fn bound(&self, pairs: &[u32]) -> Ends {
        let around = |end: usize| {
            let points = pairs.iter().map(|&pair| self.ends(pair)[end]);
            points.fold(Box4::EMPTY, |bounds, point| bounds.union(Box4 { min: point, max: point }))
        };
        Ends([around(0), around(1)])
    }
}
