//! A tree of boxes over faces, eight children wide.
//!
//! Boxes are kept by middle and half size, as a shaft asks for them: along any direction a box reaches from its middle as far as the
//! half sizes times the direction's absolute components.

use glam::Vec3;

use super::lanes::{Eight, LANES, Points};
use super::quads::Quad;

/// Eight boxes and what is in them.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) middles: Points,
    /// Negative infinity where there is no child.
    pub(super) halves: Points,
    /// Index of a node, or with [`LEAF`] that of a leaf.
    pub(super) children: [u32; LANES],
}

/// Marks the index of a leaf.
pub(super) const LEAF: u32 = 1 << 31;

/// Eight faces.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    pub(super) corners: [Points; 4],
    pub(super) normals: Points,
    /// Bit `i`: face `i` blocks from both sides.
    pub(super) two_sided: u8,
    /// Bit `i`: there is a face `i`.
    pub(super) used: u8,
}

/// The faces, sorted into leaves; the first node is the root. Without any faces there is one node without children.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
}

#[derive(Debug, Clone, Copy)]
struct Bounds3 {
    min: Vec3,
    max: Vec3,
}

impl Bounds3 {
    const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    fn of(quads: &[Quad]) -> Self {
        quads.iter().flat_map(|q| q.corners).fold(Self::EMPTY, Self::including)
    }

    fn including(self, p: Vec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Half the surface; 0 if empty.
    fn surface(self) -> f32 {
        let size = (self.max - self.min).max(Vec3::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

impl Tree {
    /// Sorts `quads` into a tree; about a third of a microsecond for each.
    pub(super) fn new(mut quads: Vec<Quad>) -> Self {
        let mut tree = Self { nodes: Vec::new(), leaves: Vec::new() };
        tree.add_node(&mut quads);
        tree
    }

    fn add_node(&mut self, quads: &mut [Quad]) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node {
            middles: Points([Eight::ZERO; 3]),
            halves: Points([Eight([f32::NEG_INFINITY; LANES]); 3]),
            children: [0; LANES],
        });
        let parts = parts_of(quads);
        let mut rest = quads;
        for (i, len) in parts.into_iter().enumerate() {
            let (part, after) = rest.split_at_mut(len);
            rest = after;
            let bounds = Bounds3::of(part);
            // Half sizes are rounded up, so that no corner is outside.
            let middle = 0.5 * (bounds.min + bounds.max);
            let half = (bounds.max - middle).max(middle - bounds.min) * (1.0 + 2.0 * f32::EPSILON);
            for axis in 0..3 {
                self.nodes[index].middles.0[axis].0[i] = middle[axis];
                self.nodes[index].halves.0[axis].0[i] = half[axis];
            }
            self.nodes[index].children[i] =
                if part.len() <= LANES { self.add_leaf(part) | LEAF } else { self.add_node(part) };
        }
        index as u32
    }

    fn add_leaf(&mut self, quads: &[Quad]) -> u32 {
        let at = |i: usize| quads[i.min(quads.len() - 1)];
        let bits = |is: &dyn Fn(&Quad) -> bool| {
            quads.iter().enumerate().fold(0, |bits, (i, quad)| bits | u8::from(is(quad)) << i)
        };
        self.leaves.push(Leaf {
            corners: std::array::from_fn(|c| Points::from_fn(|i| at(i).corners[c].to_array())),
            normals: Points::from_fn(|i| at(i).normal.to_array()),
            two_sided: bits(&|quad| quad.is_two_sided),
            used: bits(&|_| true),
        });
        self.leaves.len() as u32 - 1
    }
}

/// Sorts `quads` into at most eight runs of neighbours, and returns their lengths.
fn parts_of(quads: &mut [Quad]) -> Vec<usize> {
    if quads.is_empty() {
        return Vec::new();
    }
    let mut parts = Vec::with_capacity(LANES);
    parts.push(0..quads.len());
    while parts.len() < LANES {
        let cost = |range: &std::ops::Range<usize>| Bounds3::of(&quads[range.clone()]).surface() * range.len() as f32;
        let dearest = parts
            .iter()
            .enumerate()
            .filter(|(_, range)| range.len() > LANES)
            .map(|(i, range)| (i, cost(range)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((i, _)) = dearest else { break };
        let range = parts[i].clone();
        let middle = range.start + split(&mut quads[range.clone()]);
        parts[i] = range.start..middle;
        parts.insert(i + 1, middle..range.end);
    }
    parts.into_iter().map(|range| range.len()).collect()
}

/// Where a split costs least, by the surfaces of the two boxes times what is in them (J. Goldsmith and J. Salmon 1987), tried at so many places.
const BINS: usize = 16;

/// Sorts `quads` into two runs and returns the length of the first, a multiple of a leaf if it can be; neither is empty.
fn split(quads: &mut [Quad]) -> usize {
    let middle = |quad: &Quad| quad.corners.iter().sum::<Vec3>();
    let middles = quads.iter().fold(Bounds3::EMPTY, |bounds, quad| bounds.including(middle(quad)));
    let size = middles.max - middles.min;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let along = |quad: &Quad| middle(quad)[axis];
    let scale = BINS as f32 / size[axis];
    let bin = |quad: &Quad| (((along(quad) - middles.min[axis]) * scale) as usize).min(BINS - 1);
    let mut bins = [(Bounds3::EMPTY, 0_usize); BINS];
    for quad in &*quads {
        let (bounds, count) = &mut bins[bin(quad)];
        *bounds = bounds.union(Bounds3::of(std::slice::from_ref(quad)));
        *count += 1;
    }
    let mut best = (f32::INFINITY, quads.len() / 2);
    let mut left = (Bounds3::EMPTY, 0);
    for first in 1..BINS {
        left = (left.0.union(bins[first - 1].0), left.1 + bins[first - 1].1);
        let right = bins[first..].iter().fold((Bounds3::EMPTY, 0), |sum, bin| (sum.0.union(bin.0), sum.1 + bin.1));
        let cost = left.0.surface() * left.1 as f32 + right.0.surface() * right.1 as f32;
        if left.1 > 0 && right.1 > 0 && cost < best.0 {
            best = (cost, left.1);
        }
    }
    // Full leaves are worth more than the best place.
    let rounded = (best.1 + LANES / 2) / LANES * LANES;
    let at = if (1..quads.len()).contains(&rounded) { rounded } else { best.1.clamp(1, quads.len() - 1) };
    quads.select_nth_unstable_by(at, |a, b| along(a).total_cmp(&along(b)));
    at
}
