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

use super::lanes::{Eight, LANES, Lanes, Plain, Points, dot};
use super::shaft::{Care, Cell, Faces, GROUPS, LightSpace, ROUNDING, along, range, span};
use super::tree::{LEAF, Leaf, Tree};
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

/// Asks `tree` about `cell` under each of `lights`, one after the other as neighbours in time, and calls `answer` with the index of each that is not `None`, what
/// is known, and the faces that touch any receiver which is not dark.
pub(super) fn shade_all(
    tree: &Tree,
    cell: &Cell,
    lights: &[Option<LightSpace>],
    care: Care,
    answer: impl FnMut(usize, ConeShade, &[Touch]),
) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn with_avx2(
            tree: &Tree,
            cell: &Cell,
            lights: &[Option<LightSpace>],
            care: Care,
            answer: impl FnMut(usize, ConeShade, &[Touch]),
        ) {
            shade_in_order::<super::lanes::Avx>(tree, cell, lights, care, answer);
        }
        if is_x86_feature_detected!("avx2") {
            #[expect(unsafe_code, reason = "the processor was asked")]
            // SAFETY: the processor has AVX2.
            return unsafe { with_avx2(tree, cell, lights, care, answer) };
        }
    }
    shade_in_order::<Plain>(tree, cell, lights, care, answer);
}

#[inline(always)]
fn shade_in_order<L: Lanes>(
    tree: &Tree,
    cell: &Cell,
    lights: &[Option<LightSpace>],
    care: Care,
    mut answer: impl FnMut(usize, ConeShade, &[Touch]),
) {
    let mut recent = [u32::MAX; 2];
    let (mut stack, mut touches) = (Vec::with_capacity(64), Vec::new());
    for (i, light) in lights.iter().enumerate() {
        if let Some(light) = light {
            touches.clear();
            let shade = shade::<L>(tree, cell, light, care, &mut recent, &mut stack, &mut touches);
            answer(i, shade, &touches);
        }
    }
}

#[inline(always)]
fn shade<L: Lanes>(
    tree: &Tree,
    cell: &Cell,
    light: &LightSpace,
    care: Care,
    recent: &mut [u32; 2],
    stack: &mut Vec<u32>,
    touches: &mut Vec<Touch>,
) -> ConeShade {
    let mut walk = Walk::<L>::new(cell, light, care);
    let first = *recent;
    for leaf in first {
        if leaf != u32::MAX {
            walk.ask(leaf, &tree.leaves[leaf as usize], touches);
        }
    }
    stack.clear();
    stack.push(0);
    while let Some(at) = stack.pop() {
        if walk.alive == 0 {
            break;
        }
        if at & LEAF != 0 {
            let leaf = at & !LEAF;
            if leaf != first[0]
                && leaf != first[1]
                && walk.ask(leaf, &tree.leaves[leaf as usize], touches)
                && recent[0] != leaf
            {
                *recent = [leaf, recent[0]];
            }
            continue;
        }
        let node = &tree.nodes[at as usize];
        let mut hits = walk.meets(&node.middles, &node.halves);
        while hits != 0 {
            stack.push(node.children[hits.trailing_zeros() as usize]);
            hits &= hits - 1;
        }
    }
    ConeShade { dark: walk.dark & cell.used, touched: walk.touched & !walk.dark & cell.used }
}

struct Walk<'a, L> {
    cell: &'a Cell,
    light: &'a LightSpace,
    care: Care,
    /// The cone's radius at a distance of one.
    slope: f32,
    /// The groups' rectangles across the rays.
    group_u: [L; 2],
    group_v: [L; 2],
    /// The packet's: least and greatest across, and the lowest receiver along the rays.
    u: [f32; 2],
    v: [f32; 2],
    lowest: f32,
    /// The receivers in light space, once they are asked for.
    projected: [[Eight; 3]; GROUPS],
    is_projected: u8,
    dark: u64,
    touched: u64,
    /// Bit `g`: not all of group `g` is dark.
    alive: u8,
}

impl<'a, L: Lanes> Walk<'a, L> {
    #[inline(always)]
    fn new(cell: &'a Cell, light: &'a LightSpace, care: Care) -> Self {
        let (middles, halves) = (cell.middles.load::<L>(), cell.halves.load::<L>());
        let group_u = span(&middles, &halves, &light.across);
        let group_v = span(&middles, &halves, &light.up);
        let [lowest, _] = span(&middles, &halves, &light.to_sun);
        let slope = (*SUN_TANGENT * WIDER) as f32;
        let pad = care.pad;
        // Receivers that are turned so that the disc is behind their own plane are dark; those whose plane goes through it see part.
        let behind = cell.turned_from::<L>(light.to_sun.of, -slope);
        let partly = cell.turned_from::<L>(light.to_sun.of, slope) & !behind;
        let mut walk = Self {
            cell,
            light,
            care,
            slope,
            u: [group_u[0].stored().least() - pad, group_u[1].stored().greatest() + pad],
            v: [group_v[0].stored().least() - pad, group_v[1].stored().greatest() + pad],
            lowest: lowest.stored().least() - pad,
            group_u,
            group_v,
            projected: [[Eight::ZERO; 3]; GROUPS],
            is_projected: 0,
            dark: !cell.used | behind,
            touched: partly,
            alive: 0,
        };
        for g in 0..GROUPS {
            walk.alive |= u8::from((walk.dark >> (g * LANES)) as u8 != u8::MAX) << g;
        }
        walk
    }

    /// How wide cones are at `top`, those of the lowest receivers.
    #[inline(always)]
    fn room(&self, top: L) -> L {
        L::splat(self.slope).mul(top.sub(L::splat(self.lowest)).max(L::splat(0.0)))
    }

    /// Which of eight boxes meet any cone, or seem to.
    #[inline(always)]
    fn meets(&self, middles: &Points, halves: &Points) -> u8 {
        let (middles, halves) = (middles.about::<L>(self.cell.middle), halves.load::<L>());
        let [u_min, u_max] = span(&middles, &halves, &self.light.across);
        let [v_min, v_max] = span(&middles, &halves, &self.light.up);
        let [_, top] = span(&middles, &halves, &self.light.to_sun);
        self.are_near([u_min, u_max], [v_min, v_max], top, self.room(top))
    }

    /// Which of eight rectangles of light space, with `room` around them, meet the packet's and are not below it.
    #[inline(always)]
    fn are_near(&self, [u_min, u_max]: [L; 2], [v_min, v_max]: [L; 2], top: L, room: L) -> u8 {
        L::splat(self.u[1]).greater(u_min.sub(room))
            & u_max.add(room).greater(L::splat(self.u[0]))
            & L::splat(self.v[1]).greater(v_min.sub(room))
            & v_max.add(room).greater(L::splat(self.v[0]))
            & top.greater(L::splat(self.lowest))
    }

    /// Asks the faces of `leaf`; whether any makes a receiver dark.
    #[inline(always)]
    fn ask(&mut self, leaf_index: u32, leaf: &Leaf, touches: &mut Vec<Touch>) -> bool {
        let light = self.light;
        let about = self.cell.middle;
        let [a, b, c, d] = &leaf.corners;
        let corners = [a.about::<L>(about), b.about(about), c.about(about), d.about(about)];
        let (u, v) = (along(&corners, &light.across), along(&corners, &light.up));
        let [u_min, u_max] = range(&u);
        let [v_min, v_max] = range(&v);
        let [w_min, w_max] = range(&along(&corners, &light.to_sun));
        let normals = leaf.normals.load::<L>();
        let facing = dot(&normals, light.to_sun.of);
        let room = self.room(w_max);
        // A face of a closed surface that is turned from the sun's middle by less than the cone's slope may still face its edge.
        let mut hits = leaf.used
            & (leaf.two_sided | facing.greater(L::splat(-self.slope)))
            & self.are_near([u_min, u_max], [v_min, v_max], w_max, room);
        if hits == 0 {
            return false;
        }
        let reach_u = u_max.abs().max(u_min.abs());
        let reach_v = v_max.abs().max(v_min.abs());
        let reach_w = w_max.abs().max(w_min.abs());
        let reach = reach_u.max(reach_v).max(reach_w).max(L::splat(self.cell.reach));
        let margin = L::splat(self.care.margin).add(L::splat(ROUNDING).mul(reach));
        let faces = Faces::new(&u, &v, &corners[0], &normals, facing, margin);
        // How fast the lowest of a cone's rays goes down to a plane that is seen nearly edge-on.
        let dip = L::splat(self.slope).sub(facing.abs()).max(L::splat(0.0)).stored();
        let top = w_max.stored();
        let pad = room.add(L::splat(self.care.pad));
        let [u_min, u_max] = [u_min.sub(pad).stored(), u_max.add(pad).stored()];
        let [v_min, v_max] = [v_min.sub(pad).stored(), v_max.add(pad).stored()];
        let before = self.dark;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let groups = self.alive
                & L::splat(u_max.0[i]).greater(self.group_u[0])
                & self.group_u[1].greater(L::splat(u_min.0[i]))
                & L::splat(v_max.0[i]).greater(self.group_v[0])
                & self.group_v[1].greater(L::splat(v_min.0[i]));
            if groups != 0 {
                let receivers = self.cast(&faces, i, top.0[i], dip.0[i], groups);
                if receivers != 0 {
                    touches.push(Touch { leaf: leaf_index, face: i as u32, receivers });
                }
            }
        }
        self.dark != before
    }

    /// Casts face `i` on `groups`; gives back whom it touches and does not make dark.
    #[inline(always)]
    fn cast(&mut self, faces: &Faces, i: usize, top: f32, dip: f32, mut groups: u8) -> u64 {
        let below = [faces.below[0].0[i], faces.below[1].0[i], faces.below[2].0[i]];
        let margin = L::splat(faces.margin.0[i]);
        let mut touched = 0;
        while groups != 0 {
            let g = groups.trailing_zeros() as usize;
            groups &= groups - 1;
            let points = self.cell.groups[g].load::<L>();
            if self.is_projected >> g & 1 == 0 {
                let axes = [&self.light.across, &self.light.up, &self.light.to_sun];
                self.projected[g] = axes.map(|axis| dot(&points, axis.of).stored());
                self.is_projected |= 1 << g;
            }
            let [u, v, w] = [0, 1, 2].map(|axis| L::load(&self.projected[g][axis]));
            let height = L::splat(top).sub(w).max(L::splat(0.0));
            let mut edges = L::splat(f32::MAX);
            for [a, b, c] in &faces.edges {
                let across = u.mul(L::splat(a.0[i])).add(v.mul(L::splat(b.0[i]))).add(L::splat(c.0[i]));
                edges = edges.min(across);
            }
            let under = dot(&points, below).add(L::splat(faces.below_offset.0[i]));
            let room = height.mul(L::splat(self.slope)).add(margin);
            let room_under = height.mul(L::splat(dip)).add(margin);
            let zero = L::splat(0.0);
            let dark = edges.greater(room) & under.greater(margin);
            let touches = edges.add(room).greater(zero) & under.add(room_under).greater(zero);
            self.dark |= u64::from(dark) << (g * LANES);
            touched |= u64::from(touches) << (g * LANES);
            let is_dark = (self.dark >> (g * LANES)) as u8 == u8::MAX;
            self.alive &= !(u8::from(is_dark) << g);
        }
        touched &= !self.dark;
        self.touched |= touched;
        touched
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blockers::clutter::{CARE, clutter};

    #[test]
    fn every_processor_finds_the_same_receivers_and_faces() {
        let (tree, asked) = clutter();
        let mut seen = ConeShade::default();
        for (cell, lights) in asked {
            let (mut plain, mut best) = (Vec::new(), Vec::new());
            shade_in_order::<Plain>(&tree, &cell, &lights, CARE, |i, shade, touches| {
                plain.push((i, shade, touches.to_vec()));
            });
            shade_all(&tree, &cell, &lights, CARE, |i, shade, touches| best.push((i, shade, touches.to_vec())));
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
