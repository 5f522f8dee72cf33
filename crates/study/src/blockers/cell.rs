//! The receivers of a packet, in the order in which the processor takes them.

use super::lanes::{Eight, LANES, Lanes, Points, dot};
use super::light_space::Axis;
use crate::PACKET;

/// Receivers of a packet are tested in so many groups.
pub(super) const GROUPS: usize = PACKET / LANES;

/// A packet's receivers.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    /// About which everything is measured; `f32` like the corners of faces, so that differences are rounded once.
    pub(super) middle: [f32; 3],
    pub(super) groups: [Points; GROUPS],
    /// The boxes of the groups.
    pub(super) middles: Points,
    pub(super) halves: Points,
    /// The farthest receiver from the middle, along an axis.
    pub(super) reach: f32,
    /// Unit normals, unless all are open to all sides, and which lanes have one.
    normals: Option<(Box<[Points; GROUPS]>, u64)>,
    /// Which lanes are receivers.
    pub(super) used: u64,
}

impl Cell {
    /// Takes the receivers' positions and normals (zero: open to all sides), at most [`PACKET`] and at least one.
    pub(super) fn new(receivers: &[([f64; 3], [f32; 3])]) -> Self {
        let mut min = [f64::INFINITY; 3];
        let mut max = [f64::NEG_INFINITY; 3];
        for (p, _) in receivers {
            for axis in 0..3 {
                min[axis] = min[axis].min(p[axis]);
                max[axis] = max[axis].max(p[axis]);
            }
        }
        let middle: [f32; 3] = std::array::from_fn(|axis| (0.5 * (min[axis] + max[axis])) as f32);
        let at = |i: usize| receivers[i.min(receivers.len() - 1)];
        let groups: [Points; GROUPS] = std::array::from_fn(|g| {
            Points::from_fn(|lane| {
                let (p, _) = at(g * LANES + lane);
                std::array::from_fn(|axis| (p[axis] - f64::from(middle[axis])) as f32)
            })
        });
        let extent = |group: &Points, axis: usize| (group.0[axis].least(), group.0[axis].greatest());
        let middles = Points::from_fn(|g| {
            std::array::from_fn(|axis| {
                let (least, greatest) = extent(&groups[g], axis);
                0.5 * (least + greatest)
            })
        });
        let halves = Points::from_fn(|g| {
            std::array::from_fn(|axis| {
                let (least, greatest) = extent(&groups[g], axis);
                0.5 * (greatest - least)
            })
        });
        let reach = (0..3).map(|axis| (max[axis] - min[axis]) as f32).fold(0.0, f32::max);
        let has_normal = (0..PACKET).fold(0, |bits, i| bits | u64::from(at(i).1 != [0.0; 3]) << i);
        let normals = || std::array::from_fn(|g| Points::from_fn(|lane| at(g * LANES + lane).1));
        let normals = (has_normal != 0).then(|| (Box::new(normals()), has_normal));
        let used = if receivers.len() == PACKET { u64::MAX } else { (1 << receivers.len()) - 1 };
        Self { middle, groups, middles, halves, reach, normals, used }
    }

    /// The lanes whose normals are not zero and have no more than `most` along `to_sun`.
    #[inline(always)]
    pub(super) fn turned_from<L: Lanes>(&self, to_sun: [f32; 3], most: f32) -> u64 {
        let Some((normals, has_normal)) = &self.normals else { return 0 };
        let mut faces = 0;
        for (g, normals) in normals.iter().enumerate() {
            faces |= u64::from(dot(&normals.load::<L>(), to_sun).greater(L::splat(most))) << (g * LANES);
        }
        has_normal & !faces
    }
}

/// The receivers of a cell along some axes, found group by group when they are first asked for.
pub(super) struct Projections<const AXES: usize> {
    groups: [[Eight; AXES]; GROUPS],
    /// Bit `g`: those of group `g` are known.
    known: u8,
}

impl<const AXES: usize> Projections<AXES> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { groups: [[Eight::ZERO; AXES]; GROUPS], known: 0 }
    }

    /// `points` are those of group `g`; the axes are the same at each call.
    #[inline(always)]
    pub(super) fn of_group<L: Lanes>(&mut self, g: usize, points: &[L; 3], axes: [&Axis; AXES]) -> [L; AXES] {
        if self.known >> g & 1 == 0 {
            for (along, axis) in self.groups[g].iter_mut().zip(axes) {
                dot(points, axis.of).store(along);
            }
            self.known |= 1 << g;
        }
        let mut all = [L::splat(0.0); AXES];
        for (all, along) in all.iter_mut().zip(&self.groups[g]) {
            *all = L::load(along);
        }
        all
    }
}
