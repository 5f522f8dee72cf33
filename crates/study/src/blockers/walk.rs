//! The way of a packet through the tree, sun after sun.

use super::beam::Care;
use super::cell::Cell;
use super::lanes::Points;
use super::light_space::LightSpace;
use super::tree::{LEAF, Leaf, Tree};

/// A packet and its suns.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) tree: &'a Tree,
    pub(super) cell: &'a Cell,
    /// One after the other as neighbours in time; `None` where none is asked for.
    pub(super) lights: &'a [Option<LightSpace>],
    pub(super) care: Care,
}

/// What is asked for one packet and one sun.
pub(super) trait Question {
    /// Which of eight boxes matter.
    fn meets(&self, middles: &Points, halves: &Points) -> u8;

    /// Asks the faces of `leaf`, which has this number; whether they settle any receiver.
    fn ask(&mut self, number: u32, leaf: &Leaf) -> bool;

    /// Whether nothing is left to be asked.
    fn is_settled(&self) -> bool;
}

/// Puts questions to a tree.
pub(super) struct Walker<'a> {
    tree: &'a Tree,
    /// The leaves that settled the last receivers, which the next sun asks first.
    recent: [u32; 2],
    /// Of nodes and leaves.
    stack: Vec<u32>,
}

impl<'a> Walker<'a> {
    pub(super) fn new(tree: &'a Tree) -> Self {
        Self { tree, recent: [u32::MAX; 2], stack: Vec::with_capacity(64) }
    }

    #[inline(always)]
    pub(super) fn put(&mut self, question: &mut impl Question) {
        let first = self.recent;
        for leaf in first {
            if leaf != u32::MAX {
                question.ask(leaf, &self.tree.leaves[leaf as usize]);
            }
        }
        self.stack.clear();
        self.stack.push(0);
        while let Some(at) = self.stack.pop() {
            if question.is_settled() {
                break;
            }
            if at & LEAF != 0 {
                let leaf = at & !LEAF;
                if leaf != first[0] && leaf != first[1] && question.ask(leaf, &self.tree.leaves[leaf as usize]) {
                    self.note(leaf);
                }
                continue;
            }
            let node = &self.tree.nodes[at as usize];
            let mut hits = question.meets(&node.middles, &node.halves);
            while hits != 0 {
                self.stack.push(node.children[hits.trailing_zeros() as usize]);
                hits &= hits - 1;
            }
        }
    }

    #[inline(always)]
    fn note(&mut self, leaf: u32) {
        if self.recent[0] != leaf {
            self.recent = [leaf, self.recent[0]];
        }
    }
}
