//! How much of the sun's disc receivers see.
//!
//! ```text
//!    packet x sun -> cones (cone.rs) -> nothing | all | faces that touch the cone
//!                                                              |
//!    receiver x sun x those faces -> what they leave of the disc (remainder.rs), in f64
//! ```

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Blockers;
use super::cone::{self, ConeShade, Touch};
use super::light_space::LightSpace;
use super::remainder::Remainder;
use super::tree::Leaf;
use super::walk::Asked;
use crate::{DiscExposure, Exposure, Packets, PartialSun, Receivers, SunDisc};

/// A disc and what of it is above the horizon.
#[derive(Debug, Clone, Copy)]
struct Sun {
    disc: SunDisc,
    share_above_horizon: f64,
}

impl Blockers {
    /// Finds for every receiver of `range` of `packets` how much of the sun's disc it sees at each step: `suns` has the unit vector towards the disc's middle, or `None`
    /// while it does not count.
    ///
    /// What is below a level horizon, behind the receiver's own plane, or behind any triangle is hidden; where triangles overlap it is so once. Each share is that of
    /// the exact geometry: right to about 1e-12, less for faces that are nearer than a centimetre (their distance is known to some 1e-14 of a large scene's size).
    /// A receiver inside of a closed surface is in the dark.
    ///
    /// Works on all threads of the current rayon pool, with the same answer for any number, and stops early, with `None`, soon after `stop` is set. `packet_done` is
    /// called after each packet, on any thread. Among houses it takes a few times as long as [`Blockers::expose`], and most of that for the few receivers
    /// that see part.
    pub fn expose_disc(
        &self,
        receivers: &Receivers,
        packets: &Packets,
        range: Range<usize>,
        suns: &[Option<DVec3>],
        stop: &AtomicBool,
        packet_done: impl Fn() + Sync,
    ) -> Option<DiscExposure> {
        let lights: Vec<_> = suns.iter().map(|sun| sun.map(LightSpace::new)).collect();
        let discs: Vec<_> = suns.iter().map(|sun| sun.map(Sun::new)).collect();
        let mut lit = vec![0; range.len() * suns.len()];
        let partial: Vec<Vec<PartialSun>> = if suns.is_empty() {
            Vec::new()
        } else {
            let rows = lit.par_chunks_mut(suns.len()).zip(range.clone());
            rows.map_init(Remainder::default, |remainder, (row, packet)| {
                if stop.load(Ordering::Relaxed) {
                    return None;
                }
                let partial =
                    self.expose_packet_to_discs(receivers, packets.members(packet), &discs, &lights, row, remainder);
                packet_done();
                Some(partial)
            })
            .collect::<Option<_>>()?
        };
        let mut partial = partial.concat();
        partial.par_sort_unstable_by_key(|partial| (partial.receiver, partial.step));
        let whole = Exposure { packets: range, step_count: suns.len(), lit, undecided: Vec::new() };
        Some(DiscExposure { whole, partial })
    }

    /// How much of the disc about the unit vector `to_sun` a receiver at `position`, open to the side of `normal` (zero: to all), sees; as
    /// [`Blockers::expose_disc`] finds it. Some microseconds.
    pub fn visible_share(&self, position: DVec3, normal: Vec3, to_sun: DVec3) -> f64 {
        let mut receivers = Receivers::default();
        receivers.positions.push(position);
        receivers.normals.push(normal);
        let (light, disc) = (LightSpace::new(to_sun), Sun::new(to_sun));
        let mut row = [0];
        let partial = self.expose_packet_to_discs(
            &receivers,
            &[0],
            &[Some(disc)],
            &[Some(light)],
            &mut row,
            &mut Remainder::default(),
        );
        partial.first().map_or(row[0] as f64, |partial| partial.share)
    }

    /// Fills `row`, a word for each sun, and returns who sees part.
    fn expose_packet_to_discs(
        &self,
        receivers: &Receivers,
        members: &[u32],
        discs: &[Option<Sun>],
        lights: &[Option<LightSpace>],
        row: &mut [u64],
        remainder: &mut Remainder,
    ) -> Vec<PartialSun> {
        let (cell, care) = self.cell(receivers, members);
        let asked = Asked { tree: &self.tree, cell: &cell, lights, care };
        let mut partial = Vec::new();
        cone::shade_all(asked, |step, ConeShade { dark, touched }, touches| {
            let Some(sun) = &discs[step] else { return };
            let free = cell.used & !dark & !touched;
            let is_up = sun.share_above_horizon >= 1.0;
            row[step] = if is_up { free } else { 0 };
            let mut settle = |lane: usize, share: f64| {
                if share >= 1.0 {
                    row[step] |= 1 << lane;
                } else if share > 0.0 {
                    partial.push(PartialSun { receiver: members[lane], step: step as u32, share });
                }
            };
            if !is_up {
                lanes(free).for_each(|lane| settle(lane, sun.share_above_horizon));
            }
            for lane in lanes(touched) {
                let r = members[lane] as usize;
                let seen = (receivers.positions[r], receivers.normals[r]);
                settle(lane, self.share_beside(seen, sun, touches, 1 << lane, remainder));
            }
        });
        partial
    }

    /// What the faces of `touches` that touch the receiver of `bit` leave it.
    fn share_beside(
        &self,
        (position, normal): (DVec3, Vec3),
        sun: &Sun,
        touches: &[Touch],
        bit: u64,
        remainder: &mut Remainder,
    ) -> f64 {
        remainder.clear();
        if sun.share_above_horizon < 1.0 {
            remainder.keep(&sun.disc, DVec3::Z);
        }
        if normal != Vec3::ZERO {
            remainder.keep(&sun.disc, normal.as_dvec3());
        }
        for touch in touches.iter().filter(|touch| touch.receivers & bit != 0) {
            let leaf = &self.tree.leaves[touch.leaf as usize];
            let face = touch.face as usize;
            let corners = corners(leaf, face).map(|corner| corner - position);
            remainder.hide(&sun.disc, &corners, leaf.two_sided >> face & 1 == 1);
        }
        remainder.share()
    }
}

impl Sun {
    fn new(to_sun: DVec3) -> Self {
        let disc = SunDisc::new(to_sun);
        Self { disc, share_above_horizon: disc.share_above_horizon() }
    }
}

fn corners(leaf: &Leaf, face: usize) -> [DVec3; 4] {
    leaf.corners.map(|corner| Vec3::from_array(corner.0.map(|axis| axis.0[face])).as_dvec3())
}

/// The lanes whose bits are set, in order.
fn lanes(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < u64::BITS as usize).then_some(lane)
    })
}
