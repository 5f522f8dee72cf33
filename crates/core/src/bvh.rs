//! A tree of boxes that finds the few triangles a ray could meet.
//!
//! ```text
//!       ray
//!        \    ______________________
//!         \  |  ____        _____   |    one node holds the boxes of up to four children; those that the ray
//!          \ | |    |      |     |  |    meets are looked into from the nearest on, and only as long as
//!           \| |____|      |     |  |    nothing nearer was hit
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
//! it, to the last bit. The interval of the box of a triangle that is hit is not empty, as [`PAD`] shows, and the
//! triangle's parameter is clamped to it. So no node above can be skipped while that parameter is still wanted.

use std::ops::{ControlFlow, Range};

use glam::Vec3A;
use rayon::prelude::*;

/// Planes of `N` boxes, side by side: smallest x, y, z, then largest x, y, z.
pub(crate) type Planes<const N: usize> = [[f32; N]; 6];

/// How far the interval of a box is widened at both ends, as a part of M, the largest |t| at which the line meets the
/// box's two planes across z, the ray's longest axis.
///
/// The triangle test moves a corner A (seen from the origin) by rounding: across the ray, its x becomes
/// `A.x d.z (1 + e) - A.z d.x (1 + f)` with |e| and |f| just over 2 u, where u = 2^-53. At the t where a triangle
/// so moved meets the ray, the mean of this over its corners is 0. Divided by d.z d.x that is: the mean of A.z / d.z,
/// which is t but for 2 u M, is that of A.x / d.x, which is in the slab of x but for 2 u of where the slab begins or
/// ends. Only slabs that begin or end within 2 M matter, as |t| is at most M: 6 u M in all. The inverse, the product
/// and the last sum of [`Slabs::interval`] add 7 u M. The next power of 2 is 16.
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

    fn of(pieces: &[Piece]) -> Self {
        pieces.iter().fold(Self::EMPTY, |e, p| e.union(p.extent))
    }

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

/// Children of a node.
const WIDTH: usize = 4;
/// The most triangles that a leaf may have.
const MAX_LEAF: usize = 8;
/// What testing the boxes of a cut costs, in triangle tests. From 1 to 2 the time is the same; at 1.6 even loose
/// triangles take less than 100 bytes each.
const NODE_COST: f64 = 1.6;
/// On each axis one more than the places where a cut is tried. Measured: 16 saves 2 % of the tests, 32 saves 4 %.
const BINS: usize = 8;
/// Below this many levels the surface area decides, from there on the number of pieces, so that no input, however
/// uneven, makes the tree deeper than [`MAX_LEVELS`]. Real models have 10 to 14.
const AREA_LEVELS: usize = 24;
/// Quartering brings 2^32 pieces down to 1 in 16 levels.
const MAX_LEVELS: usize = AREA_LEVELS + 16;
/// Subtrees with fewer pieces are not worth handing to another thread.
const MIN_PARALLEL: usize = 8192;

/// Where a child is: `count` pieces from place `start` on or, if `count` is 0, the node `start` further on than its
/// parent. Being relative, it stays right when a subtree that another thread built is appended.
#[derive(Debug, Clone, Copy, Default)]
struct Link {
    start: u32,
    count: u32,
}

/// Up to four children, the rest empty boxes that no ray meets; exactly two cache lines.
#[derive(Debug, Clone)]
#[repr(align(64))]
struct Node {
    planes: Planes<WIDTH>,
    links: [Link; WIDTH],
}

impl Node {
    /// A node with the boxes of `runs`, not yet linked to anything.
    fn new(runs: &[Run]) -> Self {
        let mut planes: Planes<WIDTH> =
            std::array::from_fn(|plane| [if plane < 3 { f32::INFINITY } else { f32::NEG_INFINITY }; WIDTH]);
        for (lane, run) in runs.iter().enumerate() {
            for axis in 0..3 {
                planes[axis][lane] = run.extent.min[axis];
                planes[axis + 3][lane] = run.extent.max[axis];
            }
        }
        Self { planes, links: [Link::default(); WIDTH] }
    }
}

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
            let all = Run { start: 0, count: pieces.len(), extent: Extent::of(pieces), is_leaf: false };
            let root = grow(pieces, all, 0, &mut nodes);
            if root.count > 0 {
                let mut node = Node::new(&[all]);
                node.links[0] = root;
                nodes.push(node);
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
        // Each level leaves all but one of its children waiting.
        // All bits 0, which is quickest to make.
        let mut waiting = [(0.0, Link::default()); MAX_LEVELS * (WIDTH - 1) + 1];
        waiting[0].0 = f64::NEG_INFINITY;
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (near, link) = waiting[height];
            if near > t_max {
                continue;
            }
            if link.count > 0 {
                let start = link.start as usize;
                t_max = leaf(start..start + link.count as usize, t_max)?;
                continue;
            }
            let node = &self.nodes[link.start as usize];
            let (near, far) = slabs.interval(&node.planes);
            let bottom = height;
            for i in 0..WIDTH {
                if near[i] <= far[i] && near[i] <= t_max && far[i] >= t_min {
                    let Link { start, count } = node.links[i];
                    let child = Link { start: if count > 0 { start } else { link.start + start }, count };
                    // Nearest on top.
                    let mut at = height;
                    while at > bottom && waiting[at - 1].0 < near[i] {
                        waiting[at] = waiting[at - 1];
                        at -= 1;
                    }
                    waiting[at] = (near[i], child);
                    height += 1;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// Pieces at neighbouring places.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// The place of the first one.
    start: usize,
    count: usize,
    extent: Extent,
    /// Whether it is known not to be worth cutting.
    is_leaf: bool,
}

/// Appends the subtree over `pieces`, which are those of `run`, to `nodes`. A link to a node that it gives back counts
/// from the start of `nodes`.
fn grow(pieces: &mut [Piece], run: Run, level: usize, nodes: &mut Vec<Node>) -> Link {
    let runs = divide(pieces, run, level);
    if runs.len() == 1 {
        return Link { start: run.start as u32, count: run.count as u32 };
    }
    let here = nodes.len();
    nodes.push(Node::new(&runs));
    let from_here = |Link { start, count }: Link, subtree_start: usize| Link {
        start: if count > 0 { start } else { (subtree_start + start as usize - here) as u32 },
        count,
    };
    let mut rest = pieces;
    let children: Vec<_> = runs
        .into_iter()
        .map(|run| {
            let (pieces, others) = std::mem::take(&mut rest).split_at_mut(run.count);
            rest = others;
            (pieces, run)
        })
        .collect();
    let subtree = |(pieces, run)| {
        let mut nodes = Vec::new();
        (grow(pieces, run, level + 1, &mut nodes), nodes)
    };
    if run.count >= MIN_PARALLEL {
        let subtrees: Vec<_> = children.into_par_iter().map(subtree).collect();
        for (lane, (link, mut subtree)) in subtrees.into_iter().enumerate() {
            nodes[here].links[lane] = from_here(link, nodes.len());
            nodes.append(&mut subtree);
        }
    } else {
        for (lane, (pieces, run)) in children.into_iter().enumerate() {
            let link = grow(pieces, run, level + 1, nodes);
            nodes[here].links[lane] = from_here(link, 0);
        }
    }
    Link { start: here as u32, count: 0 }
}

/// Cuts `pieces`, which are those of `run`, into up to [`WIDTH`] runs, each time the one that the most rays meet.
fn divide(pieces: &mut [Piece], run: Run, level: usize) -> Vec<Run> {
    let mut runs = Vec::with_capacity(WIDTH);
    runs.push(run);
    while runs.len() < WIDTH {
        let size = |run: &Run| if level < AREA_LEVELS { run.extent.half_area() } else { run.count as f64 };
        let largest =
            (0..runs.len()).filter(|&i| !runs[i].is_leaf).max_by(|&i, &j| size(&runs[i]).total_cmp(&size(&runs[j])));
        let Some(i) = largest else { break };
        let Run { start, count, extent, .. } = runs[i];
        let first = start - run.start;
        if let Some((left, extents)) = cut(&mut pieces[first..first + count], &extent, level) {
            runs[i] = Run { start, count: left, extent: extents[0], is_leaf: false };
            runs.insert(i + 1, Run { start: start + left, count: count - left, extent: extents[1], is_leaf: false });
        } else {
            runs[i].is_leaf = true;
        }
    }
    runs
}

/// Brings `pieces` into two parts; says how many are in the first one, and the boxes of both. `None` to make them a
/// leaf.
fn cut(pieces: &mut [Piece], extent: &Extent, level: usize) -> Option<(usize, [Extent; 2])> {
    if pieces.len() == 1 {
        return None;
    }
    let centers = pieces.iter().fold(Extent::EMPTY, |e, p| e.with(p.center()));
    if level < AREA_LEVELS
        && let Some((grid, best)) = cheapest_cut(pieces, &centers)
    {
        let cost_as_leaf = pieces.len() as f64 * extent.half_area();
        if pieces.len() > MAX_LEAF || best.cost + NODE_COST * extent.half_area() < cost_as_leaf {
            let count = partition(pieces, |piece| grid.bins(piece)[best.axis] < best.bin as f32);
            return Some((count, best.extents));
        }
    }
    if pieces.len() <= MAX_LEAF {
        return None;
    }
    // All in one place, or an uneven input that went too deep: halve by number.
    let size = (centers.max - centers.min).to_array();
    let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    let count = pieces.len() / 2;
    pieces.select_nth_unstable_by(count, |a, b| a.center()[axis].total_cmp(&b.center()[axis]));
    let (left, right) = pieces.split_at(count);
    Some((count, [Extent::of(left), Extent::of(right)]))
}

/// Gives each piece, on each axis, one of [`BINS`] bins of equal width.
struct Grid {
    min: Vec3A,
    scale: Vec3A,
}

impl Grid {
    fn new(centers: &Extent) -> Self {
        Self { min: centers.min, scale: BINS as f32 / (centers.max - centers.min) }
    }

    /// On each axis the bin, plus less than 1; an axis without width, which divides 0 by 0, has the last bin alone.
    fn bins(&self, piece: &Piece) -> Vec3A {
        const LAST: Vec3A = Vec3A::splat((BINS - 1) as f32);
        ((piece.center() - self.min) * self.scale).min(LAST)
    }
}

/// Pieces whose bin on `axis` is below `bin` go left.
struct Cut {
    axis: usize,
    bin: usize,
    extents: [Extent; 2],
    /// Half areas times numbers of pieces, both sides.
    cost: f64,
}

/// The cut between two bins that makes a ray test the fewest triangles; `None` if on each axis all are in one bin.
fn cheapest_cut(pieces: &[Piece], centers: &Extent) -> Option<(Grid, Cut)> {
    let grid = Grid::new(centers);
    let mut bins = [[(Extent::EMPTY, 0_u32); BINS]; 3];
    for piece in pieces {
        let places = grid.bins(piece).to_array();
        for (bins, place) in bins.iter_mut().zip(places) {
            let (extent, number) = &mut bins[place as i32 as usize];
            *extent = extent.union(piece.extent);
            *number += 1;
        }
    }
    let mut best: Option<Cut> = None;
    for (axis, bins) in bins.iter().enumerate() {
        // What lies below each bin, then what lies from it on.
        let mut below = [(Extent::EMPTY, 0); BINS];
        for bin in 1..BINS {
            let ((extent, number), (more, count)) = (below[bin - 1], bins[bin - 1]);
            below[bin] = (extent.union(more), number + count);
        }
        let mut above = (Extent::EMPTY, 0);
        for bin in (1..BINS).rev() {
            above = (above.0.union(bins[bin].0), above.1 + bins[bin].1);
            if below[bin].1 == 0 || bins[bin].1 == 0 {
                continue;
            }
            let cost = [below[bin], above].map(|(extent, number)| extent.half_area() * f64::from(number)).iter().sum();
            if best.as_ref().is_none_or(|b| cost < b.cost) {
                best = Some(Cut { axis, bin, extents: [below[bin].0, above.0], cost });
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

#[cfg(test)]
mod tests;
