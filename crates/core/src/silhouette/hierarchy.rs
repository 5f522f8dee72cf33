//! Packets, and a tree over them: nodes of sixteen children, split where they are spread widest.

use borsh::{BorshDeserialize, BorshSerialize};
use rayon::prelude::*;

use super::edges::Edges;
use super::faces::{Faces, FramedLight, WORD};
use super::packets::Packet;
use super::simd::{self, CHILDREN};

/// Binary splits that make the children of a node.
const SPLITS: u32 = CHILDREN.ilog2();
/// With fewer edges than this, threads cost more than they save.
const MANY: usize = 1 << 12;

/// A child of a node, in 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, BorshDeserialize, BorshSerialize)]
pub(super) struct Child(u32);

/// What a child is: a node or a packet, and its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ChildKind {
    Node(u32),
    Packet(u32),
}

impl Child {
    /// No child: its place in a node is never asked for.
    pub(super) const NONE: Self = Self(u32::MAX);

    fn node(number: usize) -> Self {
        Self((number as u32) << 1)
    }

    fn packet(number: usize) -> Self {
        Self((number as u32) << 1 | 1)
    }

    pub(super) fn kind(self) -> ChildKind {
        if self.0 & 1 == 0 { ChildKind::Node(self.0 >> 1) } else { ChildKind::Packet(self.0 >> 1) }
    }
}

/// What a tree keeps of its edges to tell whether a light can have any of them in its silhouette.
pub(super) trait Bound: Clone + Send + Sync {
    /// The bounds of a node's children, as they are tested: all at once.
    type Sixteen: std::fmt::Debug + Clone + PartialEq + BorshDeserialize + BorshSerialize;
    /// Of at most sixteen.
    fn sixteen(bounds: &[Self]) -> Self::Sixteen;
    /// How the light is turned to each child; what is said of places without one does not matter.
    ///
    /// With `edge_on` the light counts as in a plane where it is no higher or lower than that; without, every face is turned up or down.
    fn look(sixteen: &Self::Sixteen, hyperplane: [f32; 4], edge_on: Option<f32>) -> Look;
    /// What holds all that each of `bounds` holds.
    fn join(bounds: &[Self]) -> Self;
}

/// How a light is turned to the children of a node: bit `i` for child `i`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Look {
    /// Any of its edges may be silhouette.
    pub(super) open: u16,
    /// All of its edges are silhouette, and walked from start to end.
    pub(super) forward: u16,
    /// All of its edges are silhouette, and walked back.
    pub(super) backward: u16,
}

/// How edges are bounded and kept together.
pub(super) trait Bounding<B, const N: usize>: Sync {
    /// Where a pair is, for splitting: pairs with similar keys stay together.
    fn key(&self, pair: u32) -> [f32; N];
    /// What holds `pairs`.
    fn bound(&self, pairs: &[u32]) -> B;
}

/// Two trees: closed components, and others, where a light may also be in a plane.
#[derive(Debug, Clone, PartialEq, BorshDeserialize, BorshSerialize)]
pub(super) struct Trees<B: Bound> {
    #[borsh(bound(serialize = "", deserialize = ""))]
    closed: Tree<B>,
    #[borsh(bound(serialize = "", deserialize = ""))]
    others: Tree<B>,
}

impl<B: Bound> Trees<B> {
    /// Arranges the pairs of `edges`, on all threads of the rayon pool; the same trees on every run.
    pub(super) fn new<const N: usize>(edges: &Edges, faces: &Faces, by: &impl Bounding<B, N>) -> Self {
        let tree = |pairs: std::ops::Range<usize>| Tree::new(pairs, edges, faces, by);
        Self { closed: tree(0..edges.closed_pairs), others: tree(edges.closed_pairs..edges.pairs.len()) }
    }

    /// Adds the pairs that are silhouette under `light` to `found`, and returns how many were tested one by one. `open` is scratch.
    pub(super) fn find(&self, light: &FramedLight, open: &mut Open, found: &mut Vec<[u32; 2]>) -> usize {
        self.closed.find(light, true, open, found) + self.others.find(light, false, open, found)
    }

    /// Whether no number in them leads out of them, or to a vertex that is not among `vertices`.
    pub(super) fn are_whole(&self, vertices: usize) -> bool {
        [&self.closed, &self.others].iter().all(|tree| tree.is_whole(vertices))
    }

    pub(super) fn bytes(&self) -> usize {
        self.closed.bytes() + self.others.bytes()
    }
}

/// A tree with bounds of kind `B`.
#[derive(Debug, Clone, PartialEq, BorshDeserialize, BorshSerialize)]
struct Tree<B: Bound> {
    /// The first is the root; none where there is no edge.
    #[borsh(bound(serialize = "", deserialize = ""))]
    nodes: Vec<Node<B>>,
    /// In the order in which the tree is walked.
    packets: Vec<Packet>,
}

#[derive(Debug, Clone, PartialEq, BorshDeserialize, BorshSerialize)]
struct Node<B: Bound> {
    #[borsh(bound(serialize = "", deserialize = ""))]
    bounds: B::Sixteen,
    children: [Child; CHILDREN],
    /// The first of these are there.
    child_count: u32,
    /// The packets below: the first, and the one after the last.
    packets: [u32; 2],
}

/// What a search has still to look at; scratch memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Open {
    nodes: Vec<u32>,
    packets: Vec<u32>,
    /// Packets that are silhouette as a whole: the first, the one after the last, and whether they are walked forward.
    whole: Vec<([u32; 2], bool)>,
}

/// So many packets are fetched before they are looked at.
const AHEAD: usize = 3;

impl<B: Bound> Tree<B> {
    fn new<const N: usize>(
        pairs: std::ops::Range<usize>,
        edges: &Edges,
        faces: &Faces,
        by: &impl Bounding<B, N>,
    ) -> Self {
        let item = |pair: usize| Item { key: by.key(pair as u32), pair: pair as u32 };
        let mut items: Vec<Item<N>> = pairs.into_par_iter().map(item).collect();
        let mut tree = Self { nodes: Vec::new(), packets: Vec::new() };
        if items.is_empty() {
            return tree;
        }
        let root = match arrange(&mut items, edges, faces, by) {
            Shape::Node(children, _) => children,
            packet => vec![packet],
        };
        tree.add(root);
        tree
    }

    /// Adds a node and all below it.
    fn add(&mut self, shapes: Vec<Shape<B>>) -> Child {
        let number = self.nodes.len();
        let bounds: Vec<B> = shapes.iter().map(Shape::bound).collect();
        let first = self.packets.len() as u32;
        self.nodes.push(Node {
            bounds: B::sixteen(&bounds),
            children: [Child::NONE; CHILDREN],
            child_count: shapes.len() as u32,
            packets: [first; 2],
        });
        for (i, shape) in shapes.into_iter().enumerate() {
            self.nodes[number].children[i] = match shape {
                Shape::Packet(packet, _) => {
                    self.packets.push(*packet);
                    Child::packet(self.packets.len() - 1)
                }
                Shape::Node(children, _) => self.add(children),
            };
        }
        self.nodes[number].packets[1] = self.packets.len() as u32;
        Child::node(number)
    }

    fn find(&self, light: &FramedLight, is_closed: bool, open: &mut Open, found: &mut Vec<[u32; 2]>) -> usize {
        open.packets.clear();
        open.whole.clear();
        open.nodes.extend((!self.nodes.is_empty()).then_some(0));
        let edge_on = (!is_closed).then_some(light.edge_on);
        while let Some(number) = open.nodes.pop() {
            let node = &self.nodes[number as usize];
            let look = B::look(&node.bounds, light.hyperplane, edge_on);
            let is_child = |mask: u16| u32::from(mask) & ((1 << node.child_count) - 1);
            for child in places(is_child(look.open)).map(|i| node.children[i]) {
                match child.kind() {
                    ChildKind::Node(number) => open.nodes.push(number),
                    ChildKind::Packet(number) => open.packets.push(number),
                }
            }
            for (mask, is_forward) in [(look.forward, true), (look.backward, false)] {
                for child in places(is_child(mask)).map(|i| node.children[i]) {
                    let packets = match child.kind() {
                        ChildKind::Node(number) => self.nodes[number as usize].packets,
                        ChildKind::Packet(number) => [number, number + 1],
                    };
                    open.whole.push((packets, is_forward));
                }
            }
        }
        for &([start, end], is_forward) in &open.whole {
            self.packets[start as usize..end as usize].iter().for_each(|packet| packet.add_all(is_forward, found));
        }
        // Packets are far apart, so the next ones are on their way while one is looked at: half the time on a million edges.
        let mut tested = 0;
        for (i, &number) in open.packets.iter().enumerate() {
            if let Some(&soon) = open.packets.get(i + AHEAD) {
                simd::prefetch(&self.packets[soon as usize]);
            }
            tested += self.packets[number as usize].add_silhouette(light, is_closed, found);
        }
        tested
    }

    /// Whether every node but the root, and every packet, is the child of one node that comes before it, so that each is met once at most.
    fn is_whole(&self, vertices: usize) -> bool {
        let mut is_met = [vec![false; self.nodes.len()], vec![false; self.packets.len()]];
        let mut meets = |number: usize, child: Child| {
            let (kind, at, is_after) = match child.kind() {
                ChildKind::Node(at) => (0, at as usize, at as usize > number),
                ChildKind::Packet(at) => (1, at as usize, true),
            };
            is_after && is_met[kind].get_mut(at).is_some_and(|is_met| !std::mem::replace(is_met, true))
        };
        let is_range = |[start, end]: [u32; 2]| start <= end && end as usize <= self.packets.len();
        self.nodes.iter().enumerate().all(|(number, node)| {
            let children = node.children.get(..node.child_count as usize);
            is_range(node.packets) && children.is_some_and(|all| all.iter().all(|&child| meets(number, child)))
        }) && self.packets.iter().all(|packet| packet.is_whole(vertices))
    }

    fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())
    }
}

/// The places of the bits in `mask`.
fn places(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (mask != 0).then(|| mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        place
    })
}

/// A pair while it is sorted.
#[derive(Clone, Copy)]
struct Item<const N: usize> {
    key: [f32; N],
    pair: u32,
}

enum Shape<B> {
    Packet(Box<Packet>, B),
    Node(Vec<Self>, B),
}

impl<B: Clone> Shape<B> {
    fn bound(&self) -> B {
        let (Self::Packet(_, bound) | Self::Node(_, bound)) = self;
        bound.clone()
    }
}

fn arrange<const N: usize, B: Bound>(
    items: &mut [Item<N>],
    edges: &Edges,
    faces: &Faces,
    by: &impl Bounding<B, N>,
) -> Shape<B> {
    let is_held = |items: &[Item<N>]| Packet::holds(items.iter().map(|item| edges.pairs[item.pair as usize]));
    if is_held(items) {
        let pairs: Vec<u32> = items.iter().map(|item| item.pair).collect();
        return Shape::Packet(Box::new(Packet::new(&pairs, edges, faces)), by.bound(&pairs));
    }
    let is_large = items.len() >= MANY;
    let mut parts = vec![items];
    for _ in 0..SPLITS {
        let mut finer = Vec::with_capacity(2 * parts.len());
        for part in parts {
            if is_held(part) {
                finer.push(part);
            } else {
                finer.extend(split(part));
            }
        }
        parts = finer;
    }
    let children: Vec<Shape<B>> = if is_large {
        parts.into_par_iter().map(|part| arrange(part, edges, faces, by)).collect()
    } else {
        parts.into_iter().map(|part| arrange(part, edges, faces, by)).collect()
    };
    let bounds: Vec<B> = children.iter().map(Shape::bound).collect();
    Shape::Node(children, B::join(&bounds))
}

/// Splits `items`, of which there are at least two, into halves across the widest axis of their keys.
fn split<const N: usize>(items: &mut [Item<N>]) -> [&mut [Item<N>]; 2] {
    let (mut min, mut max) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
    for item in items.iter() {
        for axis in 0..N {
            min[axis] = min[axis].min(item.key[axis]);
            max[axis] = max[axis].max(item.key[axis]);
        }
    }
    let width = |axis: &usize| max[*axis] - min[*axis];
    let widest = (0..N).max_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0);
    // Full packets where there is a choice.
    let half = items.len() / 2;
    let full = half.next_multiple_of(WORD);
    let middle = if full < items.len() { full } else { half };
    // By number where keys are equal, so that the tree does not depend on how the sorting is done.
    items.select_nth_unstable_by(middle, |a, b| a.key[widest].total_cmp(&b.key[widest]).then(a.pair.cmp(&b.pair)));
    let (low, high) = items.split_at_mut(middle);
    [low, high]
}
