//! The rays of a packet to one sun, and whose way is still to be looked along.

use super::cell::{Cell, GROUPS};
use super::faces::{Faces, Seen};
use super::lanes::{LANES, Lanes, Points};
use super::light_space::{Extents, LightSpace};
use super::tree::Leaf;

/// How certain a receiver must be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Care {
    /// How far from every edge and plane that matters, besides rounding.
    pub(super) margin: f32,
    /// What boxes are widened by: at least the margin and the rounding of the farthest.
    pub(super) pad: f32,
}

/// Parallel rays, in a rectangle across them and open towards the sun; who asks may widen them on their way.
pub(super) struct Beam<'a, L> {
    pub(super) cell: &'a Cell,
    pub(super) light: &'a LightSpace,
    care: Care,
    /// The groups' rectangles.
    group_u: [L; 2],
    group_v: [L; 2],
    /// The packet's, and the lowest receiver along the rays.
    u: [f32; 2],
    v: [f32; 2],
    lowest: f32,
    /// Of whom no more is asked.
    pub(super) settled: u64,
    /// Bit `g`: not all of group `g` is settled.
    alive: u8,
}

impl<'a, L: Lanes> Beam<'a, L> {
    #[inline(always)]
    pub(super) fn new(cell: &'a Cell, light: &'a LightSpace, care: Care, settled: u64) -> Self {
        let Extents { u, v, w: [lowest, _] } = light.extents(&cell.middles.load::<L>(), &cell.halves.load());
        let mut beam = Self {
            cell,
            light,
            care,
            u: [u[0].stored().least() - care.pad, u[1].stored().greatest() + care.pad],
            v: [v[0].stored().least() - care.pad, v[1].stored().greatest() + care.pad],
            lowest: lowest.stored().least() - care.pad,
            group_u: u,
            group_v: v,
            settled,
            alive: 0,
        };
        for g in 0..GROUPS {
            beam.alive |= u8::from((settled >> (g * LANES)) as u8 != u8::MAX) << g;
        }
        beam
    }

    #[inline(always)]
    pub(super) fn is_settled(&self) -> bool {
        self.alive == 0
    }

    /// How far each of eight boxes reaches.
    #[inline(always)]
    pub(super) fn boxes(&self, middles: &Points, halves: &Points) -> Extents<L> {
        self.light.extents(&middles.about(self.cell.middle), &halves.load())
    }

    /// How the sun sees the faces of `leaf`.
    #[inline(always)]
    pub(super) fn see(&self, leaf: &Leaf) -> Seen<L> {
        Seen::new(leaf, self.cell.middle, self.light)
    }

    /// How far `top` is above the lowest receiver; 0 where it is below.
    #[inline(always)]
    pub(super) fn height(&self, top: L) -> L {
        top.sub(L::splat(self.lowest)).max(L::splat(0.0))
    }

    /// Which of eight boxes of light space meet the rays, or seem to, where there is `room` around these.
    #[inline(always)]
    pub(super) fn meets(&self, Extents { u, v, w }: &Extents<L>, room: L) -> u8 {
        // Nothing is left of a room of 0 here once it is compiled.
        L::splat(self.u[1]).greater(u[0].sub(room))
            & u[1].greater(L::splat(self.u[0]).sub(room))
            & L::splat(self.v[1]).greater(v[0].sub(room))
            & v[1].greater(L::splat(self.v[0]).sub(room))
            & w[1].greater(L::splat(self.lowest))
    }

    /// The shadow volumes of faces, with `room` around the rays.
    #[inline(always)]
    pub(super) fn faces(&self, seen: &Seen<L>, room: L) -> Faces {
        Faces::new(seen, self.cell.reach, self.care.margin, room.add(L::splat(self.care.pad)))
    }

    /// The groups that face `i` may matter to.
    #[inline(always)]
    pub(super) fn groups_at(&self, faces: &Faces, i: usize) -> u8 {
        self.alive & faces.meets(i, &self.group_u, &self.group_v)
    }

    /// Some of group `g` are settled.
    #[inline(always)]
    pub(super) fn settle(&mut self, g: usize, some: u8) {
        self.settled |= u64::from(some) << (g * LANES);
        let are_all = (self.settled >> (g * LANES)) as u8 == u8::MAX;
        self.alive &= !(u8::from(are_all) << g);
    }
}
