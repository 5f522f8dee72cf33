//! The engine: which of 64 neighbours the sun reaches.
//!
//! ```text
//!            to the sun
//!         /  /  /  /  /         All rays of a packet are parallel, so it looks along a shaft: a rectangle across the
//!        /  /[face]/  /         rays (u, v), open towards the sun. Boxes of the tree that miss the shaft are left out;
//!       /  /  /  /  /           faces that meet it are projected along the sun, and each receiver is asked on which
//!      . . . . . . .            side of their edges, and of their planes, it is.
//! ```
//!
//! A receiver is in shadow where it is inside of the shadow volume of any face. All numbers here are `f32` about the packet's middle, so that rounding grows with
//! the distance between receiver and face and not with the size of the city. Nothing is decided on rounding: a receiver that is nearer than a margin to an
//! edge or plane that matters is given back as `near`, and rays in `f64` decide.

use super::beam::{Beam, Care};
use super::cell::{Cell, Projections};
use super::faces::Faces;
use super::lanes::{LANES, Lanes, OnLanes, Points, on_best_lanes};
use super::light_space::LightSpace;
use super::tree::Leaf;
use super::walk::{Asked, Question, Walker};

/// What is known of a packet under a sun.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Shade {
    /// In shadow for certain.
    pub(super) shadow: u64,
    /// To be settled by rays; disjoint from `shadow`.
    pub(super) near: u64,
}

/// Calls `answer` with the index of each light that is not `None`, and what is known.
pub(super) fn shade_all(asked: Asked<'_>, answer: impl FnMut(usize, Shade)) {
    on_best_lanes(Shading(asked, answer));
}

struct Shading<'a, F>(Asked<'a>, F);

impl<F: FnMut(usize, Shade)> OnLanes for Shading<'_, F> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self(Asked { tree, cell, lights, care }, mut answer) = self;
        let mut walker = Walker::new(tree);
        for (i, light) in lights.iter().enumerate() {
            if let Some(light) = light {
                let mut shaft = Shaft::<L>::new(cell, light, care);
                walker.put(&mut shaft);
                answer(i, shaft.shade());
            }
        }
    }
}

struct Shaft<'a, L> {
    /// Settled are those in shadow.
    beam: Beam<'a, L>,
    /// Across the rays.
    receivers: Projections<2>,
    near: u64,
}

impl<'a, L: Lanes> Shaft<'a, L> {
    #[inline(always)]
    fn new(cell: &'a Cell, light: &'a LightSpace, care: Care) -> Self {
        let turned_away = cell.turned_from::<L>(light.to_sun.of, 0.0);
        let beam = Beam::new(cell, light, care, !cell.used | turned_away);
        Self { beam, receivers: Projections::new(), near: 0 }
    }

    #[inline(always)]
    fn shade(&self) -> Shade {
        let (shadow, used) = (self.beam.settled, self.beam.cell.used);
        Shade { shadow: shadow & used, near: self.near & !shadow & used }
    }

    /// Casts face `i` on `groups`.
    #[inline(always)]
    fn cast(&mut self, faces: &Faces, i: usize, mut groups: u8) {
        let Beam { cell, light, .. } = self.beam;
        let margin = faces.margin(i);
        while groups != 0 {
            let g = groups.trailing_zeros() as usize;
            groups &= groups - 1;
            let points = cell.groups[g].load::<L>();
            let across = self.receivers.of_group(g, &points, [&light.across, &light.up]);
            let depth = faces.inside(i, across, faces.below(i, &points));
            self.near |= u64::from(depth.greater(L::splat(-margin))) << (g * LANES);
            self.beam.settle(g, depth.greater(L::splat(margin)));
        }
    }
}

impl<L: Lanes> Question for Shaft<'_, L> {
    #[inline(always)]
    fn meets(&self, middles: &Points, halves: &Points) -> u8 {
        self.beam.meets(&self.beam.boxes(middles, halves), L::splat(0.0))
    }

    #[inline(always)]
    fn ask(&mut self, _number: u32, leaf: &Leaf) -> bool {
        let zero = L::splat(0.0);
        let seen = self.beam.see(leaf);
        let faces_sun = leaf.two_sided | seen.facing.greater(zero);
        let mut hits = leaf.used & faces_sun & self.beam.meets(&seen.extents, zero);
        if hits == 0 {
            return false;
        }
        let faces = self.beam.faces(&seen, zero);
        let before = self.beam.settled;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let groups = self.beam.groups_at(&faces, i);
            if groups != 0 {
                self.cast(&faces, i, groups);
            }
        }
        self.beam.settled != before
    }

    #[inline(always)]
    fn is_settled(&self) -> bool {
        self.beam.is_settled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blockers::clutter::{CARE, clutter};
    use crate::blockers::lanes::Plain;

    #[test]
    fn every_processor_finds_the_same_bits() {
        let (tree, asked) = clutter();
        let mut seen = Shade::default();
        for (cell, lights) in &asked {
            let asked = Asked { tree: &tree, cell, lights, care: CARE };
            let (mut plain, mut best) = (Vec::new(), Vec::new());
            Shading(asked, |i, shade| plain.push((i, shade))).run::<Plain>();
            shade_all(asked, |i, shade| best.push((i, shade)));
            assert_eq!(plain, best);
            for (_, shade) in best {
                seen = Shade { shadow: seen.shadow | shade.shadow, near: seen.near | shade.near };
            }
        }
        assert!(seen.shadow != 0 && seen.near != 0, "the scene has shadows and edges");
    }
}
