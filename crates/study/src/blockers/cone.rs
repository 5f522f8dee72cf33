//! Which of 64 neighbours see all of the sun's disc, which nothing of it, and which must be looked at closer.
//!
//! ```text
//!        \  the disc  /        A receiver looks along a cone that is as wide at a distance of one as the disc's radius. As in `shaft.rs` a packet
//!         \  [face]  /         asks boxes and then faces; what is above a receiver by w is asked about with room of w times that on
//!          \        /          all sides.
//!           \  w   /
//!            \    /            A face that the cone does not meet does not matter. One that it is inside of makes the receiver dark. Everything
//!             \  /             between is written down, with the receivers that it touches, for `remainder.rs` to find the share.
//!              \/
//! ```
//!
//! Both are on the safe side. The places at which a receiver's cone meets a face's plane are one convex region; if it reached out of the face, it would reach an
//! edge, within the room that the edge's highest corner gives. So a receiver that is inside of all edges with room to spare, and below the plane, is dark by
//! this face alone. Where nothing hides all of the disc and no face touches a receiver's cone, all of it is seen.

use super::beam::{Beam, Care};
use super::cell::{Cell, Projections};
use super::faces::Faces;
use super::lanes::{Eight, LANES, Lanes, OnLanes, Points, on_best_lanes};
use super::light_space::LightSpace;
use super::tree::Leaf;
use super::walk::{Asked, Question, Walker};
use crate::sun_disc::SUN_TANGENT;

/// By how much the cone is wider than the disc, so that rounding its slope does not matter.
const WIDER: f64 = 1.0 + 1e-3;

/// What is known of a packet under a sun.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct ConeShade {
    /// Sees nothing for certain.
    pub(super) dark: u64,
    /// May see part; disjoint from `dark`. All others see everything.
    pub(super) touched: u64,
}

/// A face that some cones meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Touch {
    pub(super) leaf: u32,
    pub(super) face: u32,
    /// Whose cones.
    pub(super) receivers: u64,
}

/// Calls `answer` with the index of each light that is not `None`, what is known, and the faces that touch any receiver which is not dark.
pub(super) fn shade_all(asked: Asked<'_>, answer: impl FnMut(usize, ConeShade, &[Touch])) {
    on_best_lanes(Shading(asked, answer));
}

struct Shading<'a, F>(Asked<'a>, F);

impl<F: FnMut(usize, ConeShade, &[Touch])> OnLanes for Shading<'_, F> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self(Asked { tree, cell, lights, care }, mut answer) = self;
        let (mut walker, mut touches) = (Walker::new(tree), Vec::new());
        for (i, light) in lights.iter().enumerate() {
            if let Some(light) = light {
                touches.clear();
                let mut cones = Cones::<L>::new(cell, light, care, &mut touches);
                walker.put(&mut cones);
                let shade = cones.shade();
                answer(i, shade, &touches);
            }
        }
    }
}

struct Cones<'a, L> {
    /// Settled are those in the dark.
    beam: Beam<'a, L>,
    /// The cones' radius at a distance of one.
    slope: f32,
    /// In light space.
    receivers: Projections<3>,
    touched: u64,
    touches: &'a mut Vec<Touch>,
}

impl<'a, L: Lanes> Cones<'a, L> {
    #[inline(always)]
    fn new(cell: &'a Cell, light: &'a LightSpace, care: Care, touches: &'a mut Vec<Touch>) -> Self {
        let slope = (*SUN_TANGENT * WIDER) as f32;
        // Receivers that are turned so that the disc is behind their own plane are dark; those whose plane goes through it see part.
        let behind = cell.turned_from::<L>(light.to_sun.of, -slope);
        let partly = cell.turned_from::<L>(light.to_sun.of, slope) & !behind;
        let beam = Beam::new(cell, light, care, !cell.used | behind);
        Self { beam, slope, receivers: Projections::new(), touched: partly, touches }
    }

    #[inline(always)]
    fn shade(&self) -> ConeShade {
        let (dark, used) = (self.beam.settled, self.beam.cell.used);
        ConeShade { dark: dark & used, touched: self.touched & !dark & used }
    }

    /// How wide cones are at `top`, those of the lowest receivers.
    #[inline(always)]
    fn room(&self, top: L) -> L {
        L::splat(self.slope).mul(self.beam.height(top))
    }

    /// Casts face `i` on `groups`; gives back whom it touches and does not make dark.
    #[inline(always)]
    fn cast(&mut self, faces: &Faces, i: usize, top: f32, dip: f32, mut groups: u8) -> u64 {
        let Beam { cell, light, .. } = self.beam;
        let (margin, zero) = (L::splat(faces.margin(i)), L::splat(0.0));
        let mut touched = 0;
        while groups != 0 {
            let g = groups.trailing_zeros() as usize;
            groups &= groups - 1;
            let points = cell.groups[g].load::<L>();
            let [u, v, w] = self.receivers.of_group(g, &points, [&light.across, &light.up, &light.to_sun]);
            let height = L::splat(top).sub(w).max(zero);
            let edges = faces.inside(i, [u, v], L::splat(f32::MAX));
            let under = faces.below(i, &points);
            let room = height.mul(L::splat(self.slope)).add(margin);
            let room_under = height.mul(L::splat(dip)).add(margin);
            let dark = edges.greater(room) & under.greater(margin);
            let touches = edges.add(room).greater(zero) & under.add(room_under).greater(zero);
            touched |= u64::from(touches) << (g * LANES);
            self.beam.settle(g, dark);
        }
        touched &= !self.beam.settled;
        self.touched |= touched;
        touched
    }
}

impl<L: Lanes> Question for Cones<'_, L> {
    #[inline(always)]
    fn meets(&self, middles: &Points, halves: &Points) -> u8 {
        let boxes = self.beam.boxes(middles, halves);
        self.beam.meets(&boxes, self.room(boxes.w[1]))
    }

    #[inline(always)]
    fn ask(&mut self, number: u32, leaf: &Leaf) -> bool {
        let seen = self.beam.see(leaf);
        let top = seen.extents.w[1];
        let room = self.room(top);
        // A face of a closed surface that is turned from the sun's middle by less than the cone's slope may still face its edge.
        let faces_sun = leaf.two_sided | seen.facing.greater(L::splat(-self.slope));
        let mut hits = leaf.used & faces_sun & self.beam.meets(&seen.extents, room);
        if hits == 0 {
            return false;
        }
        let faces = self.beam.faces(&seen, room);
        // How fast the lowest of a cone's rays goes down to a plane that is seen nearly edge-on.
        let dip = L::splat(self.slope).sub(seen.facing.abs()).max(L::splat(0.0));
        let (top, dip): (Eight, Eight) = (top.stored(), dip.stored());
        let before = self.beam.settled;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let groups = self.beam.groups_at(&faces, i);
            if groups != 0 {
                let receivers = self.cast(&faces, i, top.0[i], dip.0[i], groups);
                if receivers != 0 {
                    self.touches.push(Touch { leaf: number, face: i as u32, receivers });
                }
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
    fn every_processor_finds_the_same_receivers_and_faces() {
        let (tree, asked) = clutter();
        let mut seen = ConeShade::default();
        for (cell, lights) in &asked {
            let asked = Asked { tree: &tree, cell, lights, care: CARE };
            let (mut plain, mut best) = (Vec::new(), Vec::new());
            Shading(asked, |i, shade, touches: &[Touch]| plain.push((i, shade, touches.to_vec()))).run::<Plain>();
            shade_all(asked, |i, shade, touches| best.push((i, shade, touches.to_vec())));
            assert_eq!(plain, best);
            for (_, shade, touches) in best {
                let by_faces = touches.iter().fold(0, |all, touch| all | touch.receivers);
                assert_eq!(shade.touched & shade.dark, 0);
                seen = ConeShade { dark: seen.dark | shade.dark, touched: seen.touched | shade.touched & by_faces };
            }
        }
        assert!(seen.dark != 0 && seen.touched != 0, "the scene has shadows and edges");
    }
}
