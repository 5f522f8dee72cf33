//! A tree of boxes that finds the few triangles a ray could meet.
//!
//! ```text
//!       ray
//!        \    ______________________
//!         \  |  ____        _____   |    one node holds the boxes of its two children; the child that the
//!          \ | |    |      |     |  |    ray enters first is looked into first, and the other one only
//!           \| |____|      |     |  |    if nothing nearer was hit
//!            \____\________|_____|__|
//!                  \
//! ```
//!
//! Sources: I. Wald, "On fast construction of SAH-based bounding volume hierarchies", IEEE Symposium on Interactive
//! Ray Tracing 2007 (the binned build); T. Ize, "Robust BVH ray traversal", JCGT 2(2), 2013 (boxes must never lose
//! what the triangle test finds). We depart from Ize in the padding, see [`PAD`].
//!
//! Why no hit is ever lost: boxes are the exact `f32` bounds of `f32` corners, and every operation of
//! [`Slabs::interval`] is monotone under rounding, so the interval of a box contains the interval of every box inside
//! it, to the last bit. A triangle's parameter is clamped to the interval of its own box, so no node above
//! it can be skipped while that parameter is still wanted.

use std::ops::{ControlFlow, Range};

use glam::Vec3A;

/// Planes of `N` boxes, side by side: smallest x, y, z, then largest x, y, z.
pub(crate) type Planes<const N: usize> = [[f32; N]; 6];

/// How far the interval of a box is widened, as a part of the largest parameter at which the line meets the box's
/// planes across the ray's longest axis z.
///
/// The triangle test moves a corner A by rounding: its x across the ray is `A.x d.z (1 + a) - A.z d.x (1 + b)` with
/// |a|, |b| just over 2 ulp (1 ulp here is 2^-53). A point of the triangle so moved, at parameter t, satisfies the slab of x to
/// within 2 ulp of A.x / d.x and of M, where M is the largest |A.z / d.z| in the box. |A.x / d.x| matters only up to 2 M,
/// as t itself is at most M: 6 ulp of M. The slab's own division, product and final subtraction add 7 more. 16 is
/// the next power of 2.
const PAD: f64 = 16.0 * (f64::EPSILON / 2.0);

/// A ray as boxes see it. Axis 2 is the one along which its direction is longest, whichever that is in space.
#[derive(Debug, Clone)]
pub(crate) struct Slabs {
    origin: [f64; 3],
    inverse: [f64; 3],
    /// For each axis, the index into [`Planes`] of the plane that the ray meets first.
    near: [usize; 3],
    far: [usize; 3],
}

impl Slabs {
    /// `axes` says which axis of space each of the three is; `origin` and `direction` are in that order, and the
    /// last component of `direction` is the longest.
    pub(crate) fn new(axes: [usize; 3], origin: [f64; 3], direction: [f64; 3]) -> Self {
        let is_negative = direction.map(f64::is_sign_negative);
        let plane = |i: usize, is_largest: bool| axes[i] + if is_largest { 3 } else { 0 };
        Self {
            origin,
            inverse: direction.map(f64::recip),
            near: std::array::from_fn(|i| plane(i, is_negative[i])),
            far: std::array::from_fn(|i| plane(i, !is_negative[i])),
        }
    }

    /// The parameters between which the ray is in each box, widened by [`PAD`]; out of order where it misses.
    #[inline]
    pub(crate) fn interval<const N: usize>(&self, planes: &Planes<N>) -> ([f64; N], [f64; N]) {
        // Rounding `plane - origin` is monotone, and the triangle test rounds `corner - origin` in the same way.
        let at = |plane: usize, axis: usize| {
            let mut t = [0.0; N];
            for (t, &x) in t.iter_mut().zip(&planes[plane]) {
                *t = (f64::from(x) - self.origin[axis]) * self.inverse[axis];
            }
            t
        };
        let [mut near, mut far] = [at(self.near[2], 2), at(self.far[2], 2)];
        let mut pad = [0.0; N];
        for i in 0..N {
            pad[i] = PAD * larger(far[i], -near[i]);
        }
        for axis in 0..2 {
            let [enter, leave] = [at(self.near[axis], axis), at(self.far[axis], axis)];
            for i in 0..N {
                // A ray along a plane, exactly in it, gives 0 * infinity here: not a number, and no bound.
                near[i] = larger(enter[i], near[i]);
                far[i] = smaller(leave[i], far[i]);
            }
        }
        for i in 0..N {
            near[i] -= pad[i];
            far[i] += pad[i];
        }
        (near, far)
    }
}

/// The larger one; `b` if either is not a number. One instruction, which `f64::max` is not.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller one; `b` if either is not a number.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// An axis-aligned box while the tree is built.
#[derive(Debug, Clone, Copy)]
struct Extent {
    min: Vec3A,
    max: Vec3A,
}

impl Extent {
    const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    fn with(self, point: Vec3A) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// Half the surface; in `f64`, so that it neither overflows nor vanishes.
    fn half_area(self) -> f64 {
        let [x, y, z] = (self.max - self.min).to_array().map(f64::from);
        x * y + y * z + z * x
    }
}

/// What the tree sorts: the box of one triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    extent: Extent,
    /// The caller's name for it.
    pub(crate) id: u32,
}

impl Piece {
    pub(crate) fn new(corners: &[[f32; 3]; 3], id: u32) -> Self {
        Self { extent: corners.iter().fold(Extent::EMPTY, |e, &c| e.with(Vec3A::from_array(c))), id }
    }

    fn center(&self) -> Vec3A {
        // Halved first, as the sum of two large `f32` can overflow.
        0.5 * self.extent.min + 0.5 * self.extent.max
    }
}

/// Where a child is: `count` pieces from `start` on or, if `count` is 0, the node `start` places after its parent.
/// Being relative, it stays right when a subtree that another thread built is appended.
#[derive(Debug, Clone, Copy, Default)]
struct Link {
    start: u32,
    count: u32,
}

/// Two children; exactly one cache line.
#[derive(Debug, Clone)]
#[repr(align(64))]
struct Node {
    planes: Planes<2>,
    links: [Link; 2],
}

impl Node {
    fn new(extents: [Extent; 2], links: [Link; 2]) -> Self {
        let [min, max] = [extents.map(|e| e.min.to_array()), extents.map(|e| e.max.to_array())];
        let plane = |p: usize| if p < 3 { min.map(|m| m[p]) } else { max.map(|m| m[p - 3]) };
        Self { planes: std::array::from_fn(plane), links }
    }
}

/// The most triangles that a leaf may have.
const MAX_LEAF: usize = 8;
/// What testing the two boxes of a node costs, in triangle tests.
const NODE_COST: f64 = 1.0;
/// Places at which a cut is tried on each axis, plus one.
const BINS: usize = 16;
/// Below this many levels the surface area decides; from there on every cut halves the number of pieces, so that no input, however
/// uneven, makes the tree deeper than [`MAX_LEVELS`]. Real models stay below 40.
const AREA_LEVELS: usize = 48;
/// Halving brings 2^32 pieces down to a leaf in 32 levels.
const MAX_LEVELS: usize = AREA_LEVELS + 32;
/// Subtrees with fewer pieces are not worth handing to another thread.
const MIN_PARALLEL: usize = 8192;

/// The tree. It knows pieces only by their place in the order into which [`Tree::new`] brought them.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    /// Builds the tree and brings `pieces` into its order, the same on every run and machine.
    ///
    /// # Panics
    ///
    /// If there are more than `u32::MAX` pieces.
    pub(crate) fn new(pieces: &mut [Piece]) -> Self {
        assert!(u32::try_from(pieces.len()).is_ok(), "{} triangles are more than 32 bits can name", pieces.len());
        let mut nodes = Vec::new();
        if !pieces.is_empty() {
            let extent = extent_of(pieces);
            let root = grow(pieces, &extent, 0, 0, &mut nodes);
            if root.count > 0 {
                nodes.push(Node::new([extent, Extent::EMPTY], [root, Link::default()]));
            }
        }
        nodes.shrink_to_fit();
        Self { nodes }
    }

    /// Bytes on the heap.
    #[cfg(test)]
    pub(crate) fn byte_count(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }

    /// Calls `leaf` with each run of places whose box the ray meets at some `t_min <= t <= t_max`, near ones first as
    /// far as that is cheap to know. `leaf` gives back what `t_max` is from then on, or breaks off.
    #[inline]
    pub(crate) fn visit(
        &self,
        slabs: &Slabs,
        t_min: f64,
        mut t_max: f64,
        mut leaf: impl FnMut(Range<usize>, f64) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        if self.nodes.is_empty() {
            return ControlFlow::Continue(());
        }
        // Each level leaves at most one child waiting.
        let mut waiting = [(0.0, Link::default()); MAX_LEVELS];
        let mut height = 0;
        let mut link = Link::default();
        loop {
            if link.count > 0 {
                let start = link.start as usize;
                t_max = leaf(start..start + link.count as usize, t_max)?;
            } else {
                let index = link.start as usize;
                let node = &self.nodes[index];
                let (near, far) = slabs.interval(&node.planes);
                let is_met = [0, 1].map(|i| near[i] <= far[i] && near[i] <= t_max && far[i] >= t_min);
                let child = |i: usize| {
                    let Link { start, count } = node.links[i];
                    Link { start: if count > 0 { start } else { link.start + start }, count }
                };
                if is_met[0] && is_met[1] {
                    let first = usize::from(near[1] < near[0]);
                    waiting[height] = (near[1 - first], child(1 - first));
                    height += 1;
                    link = child(first);
                    continue;
                }
                if is_met[0] || is_met[1] {
                    link = child(usize::from(is_met[1]));
                    continue;
                }
            }
            loop {
                if height == 0 {
                    return ControlFlow::Continue(());
                }
                height -= 1;
                let (near, next) = waiting[height];
                if near <= t_max {
                    link = next;
                    break;
                }
            }
        }
    }
}

fn extent_of(pieces: &[Piece]) -> Extent {
    pieces.iter().fold(Extent::EMPTY, |e, p| e.union(p.extent))
}

/// Appends the subtree over `pieces`, the first of which has place `first`, to `nodes`. A node's link is relative to
/// the start of `nodes`.
fn grow(pieces: &mut [Piece], extent: &Extent, first: usize, level: usize, nodes: &mut Vec<Node>) -> Link {
    let Some(middle) = cut(pieces, extent, level) else {
        return Link { start: first as u32, count: pieces.len() as u32 };
    };
    let (left, right) = pieces.split_at_mut(middle);
    let extents = [extent_of(left), extent_of(right)];
    let here = nodes.len();
    nodes.push(Node::new(extents, [Link::default(); 2]));
    let mut links = if left.len().min(right.len()) >= MIN_PARALLEL {
        let mut others = Vec::new();
        let (left, mut right) = rayon::join(
            || grow(left, &extents[0], first, level + 1, nodes),
            || grow(right, &extents[1], first + middle, level + 1, &mut others),
        );
        if right.count == 0 {
            right.start += nodes.len() as u32;
        }
        nodes.append(&mut others);
        [left, right]
    } else {
        [
            grow(left, &extents[0], first, level + 1, nodes),
            grow(right, &extents[1], first + middle, level + 1, nodes),
        ]
    };
    for link in links.iter_mut().filter(|link| link.count == 0) {
        link.start -= here as u32;
    }
    nodes[here].links = links;
    Link { start: here as u32, count: 0 }
}

/// Brings `pieces` into two parts and says where the second one begins; `None` to make them a leaf.
fn cut(pieces: &mut [Piece], extent: &Extent, level: usize) -> Option<usize> {
    if pieces.len() == 1 {
        return None;
    }
    let centers = pieces.iter().fold(Extent::EMPTY, |e, p| e.with(p.center()));
    if level < AREA_LEVELS
        && let Some((grid, best)) = cheapest_cut(pieces, &centers)
    {
        let cost_as_leaf = pieces.len() as f64 * extent.half_area();
        if pieces.len() > MAX_LEAF || best.cost + NODE_COST * extent.half_area() < cost_as_leaf {
            return Some(partition(pieces, |p| grid.bins(p)[best.axis] < best.bin));
        }
    }
    if pieces.len() <= MAX_LEAF {
        return None;
    }
    // All in one place, or an uneven input that went too deep: halve by number.
    let size = (centers.max - centers.min).to_array();
    let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    let middle = pieces.len() / 2;
    pieces.select_nth_unstable_by(middle, |a, b| a.center()[axis].total_cmp(&b.center()[axis]));
    Some(middle)
}

/// Gives each piece, on each axis, one of `count` bins of equal width.
struct Grid {
    min: Vec3A,
    scale: Vec3A,
    count: usize,
}

impl Grid {
    fn new(centers: &Extent, count: usize) -> Self {
        Self { min: centers.min, scale: Vec3A::splat(count as f32) / (centers.max - centers.min), count }
    }

    fn bins(&self, piece: &Piece) -> [usize; 3] {
        // An axis without width divides 0 by 0, and casting what is not a number gives bin 0.
        ((piece.center() - self.min) * self.scale).to_array().map(|x| (x as usize).min(self.count - 1))
    }
}

/// Pieces whose bin on `axis` is below `bin` go left.
struct Cut {
    axis: usize,
    bin: usize,
    /// Half areas times numbers of pieces, both sides.
    cost: f64,
}

/// The cut between two bins that makes a ray test the fewest triangles; `None` if all pieces are in one bin on each axis.
fn cheapest_cut(pieces: &[Piece], centers: &Extent) -> Option<(Grid, Cut)> {
    let count = pieces.len().clamp(4, BINS);
    let grid = Grid::new(centers, count);
    let mut bins = [[(Extent::EMPTY, 0_u32); BINS]; 3];
    for piece in pieces {
        for (bins, bin) in bins.iter_mut().zip(grid.bins(piece)) {
            let (extent, number) = &mut bins[bin];
            *extent = extent.union(piece.extent);
            *number += 1;
        }
    }
    let mut best: Option<Cut> = None;
    for (axis, bins) in bins.iter().enumerate() {
        // What lies below each bin, then what lies from it on.
        let mut below = [(0.0, 0); BINS];
        let mut sum = (Extent::EMPTY, 0);
        for (below, (extent, number)) in below.iter_mut().zip(&bins[..count]) {
            *below = (sum.0.half_area() * f64::from(sum.1), sum.1);
            sum = (sum.0.union(*extent), sum.1 + number);
        }
        sum = (Extent::EMPTY, 0);
        for bin in (1..count).rev() {
            sum = (sum.0.union(bins[bin].0), sum.1 + bins[bin].1);
            let (cost_below, number_below) = below[bin];
            if number_below == 0 || sum.1 == 0 {
                continue;
            }
            let cost = cost_below + sum.0.half_area() * f64::from(sum.1);
            if best.as_ref().is_none_or(|b| cost < b.cost) {
                best = Some(Cut { axis, bin, cost });
            }
        }
    }
    best.map(|best| (grid, best))
}

/// Brings those for which `is_left` holds to the front and says how many they are.
fn partition(pieces: &mut [Piece], is_left: impl Fn(&Piece) -> bool) -> usize {
    let (mut start, mut end) = (0, pieces.len());
    while start < end {
        if is_left(&pieces[start]) {
            start += 1;
        } else {
            end -= 1;
            pieces.swap(start, end);
        }
    }
    start
}
