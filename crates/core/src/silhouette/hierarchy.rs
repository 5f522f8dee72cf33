//! Packets, and a tree over them: nodes of sixteen children, split where they are spread widest.

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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    type Sixteen: std::fmt::Debug + Clone + PartialEq;
    /// Of at most sixteen.
    fn sixteen(bounds: &[Self]) -> Self::Sixteen;
    /// Bit `i` is set where an edge in child `i` may be silhouette, or the light no more than `margin` above or below a face there.
    fn open(sixteen: &Self::Sixteen, hyperplane: [f32; 4], margin: f32) -> u16;
    /// What holds all that each of `bounds` holds.
    fn join(bounds: &[Self]) -> Self;
}

/// How edges are bounded and kept together.
pub(super) trait Bounding<B, const N: usize>: Sync {
    /// Where a pair is, for splitting: pairs with similar keys stay together.
    fn key(&self, pair: u32) -> [f32; N];
    /// What holds `pairs`.
    fn bound(&self, pairs: &[u32]) -> B;
}

/// Two trees: closed components, and others, where a light may also be in a plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trees<B: Bound> {
    closed: Tree<B>,
    others: Tree<B>,
}

impl<B: Bound> Trees<B> {
    /// Arranges the pairs of `edges`, on all threads of the rayon pool; the same trees on every run.
    pub(super) fn new<const N: usize>(edges: &Edges, faces: &Faces, by: &impl Bounding<B, N>) -> Self {
        let tree = |pairs: std::ops::Range<usize>| Tree::new(pairs, edges, faces, by);
        Self { closed: tree(0..edges.closed_pairs), others: tree(edges.closed_pairs..edges.pairs.len()) }
    }

    /// Adds the pairs that are silhouette under `light` to `found`, and returns how many were tested. `open` is scratch.
    pub(super) fn find(&self, light: &FramedLight, open: &mut Open, found: &mut Vec<[u32; 2]>) -> usize {
        self.closed.find(light, true, open, found) + self.others.find(light, false, open, found)
    }

    pub(super) fn bytes(&self) -> usize {
        self.closed.bytes() + self.others.bytes()
    }
}

/// A tree with bounds of kind `B`.
#[derive(Debug, Clone, PartialEq)]
struct Tree<B: Bound> {
    /// The first is the root; none where there is no edge.
    nodes: Vec<Node<B>>,
    /// In the order in which the tree is walked.
    packets: Vec<Packet>,
}

#[derive(Debug, Clone, PartialEq)]
struct Node<B: Bound> {
    bounds: B::Sixteen,
    children: [Child; CHILDREN],
}

/// What a search has still to look at; scratch memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Open {
    nodes: Vec<u32>,
    packets: Vec<u32>,
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
        self.nodes.push(Node { bounds: B::sixteen(&bounds), children: [Child::NONE; CHILDREN] });
        for (i, shape) in shapes.into_iter().enumerate() {
            self.nodes[number].children[i] = match shape {
                Shape::Packet(packet, _) => {
                    self.packets.push(*packet);
                    Child::packet(self.packets.len() - 1)
                }
                Shape::Node(children, _) => self.add(children),
            };
        }
        Child::node(number)
    }

    fn find(&self, light: &FramedLight, is_closed: bool, open: &mut Open, found: &mut Vec<[u32; 2]>) -> usize {
        open.packets.clear();
        open.nodes.extend((!self.nodes.is_empty()).then_some(0));
        let margin = if is_closed { 0.0 } else { light.edge_on };
        while let Some(number) = open.nodes.pop() {
            let node = &self.nodes[number as usize];
            let mut left = B::open(&node.bounds, light.hyperplane, margin);
            while left != 0 {
                match node.children[left.trailing_zeros() as usize].kind() {
                    ChildKind::Node(number) => open.nodes.push(number),
                    ChildKind::Packet(number) => open.packets.push(number),
                }
                left &= left - 1;
            }
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

    fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())
    }
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
