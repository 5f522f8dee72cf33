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
//! A face's shadow volume is bounded by the planes through its edges along the sun and by its own plane (F. C. Crow 1977; the light cap and sides of
//! `umbrae_core`). A receiver is in shadow where it is inside of any. All numbers here are `f32` about the packet's middle, so that rounding grows with
//! the distance between receiver and face and not with the size of the city. Nothing is decided on rounding: a receiver that is nearer than a margin to an
//! edge or plane that matters is given back as `near`, and rays in `f64` decide.

use super::lanes::{LANES, Lanes, Points};
use super::tree::{LEAF, Leaf, Tree};
use crate::PACKET;

/// Receivers of a packet are tested in so many groups.
const GROUPS: usize = PACKET / LANES;

/// What rounding may move a corner in light space, in parts of its distance: three differences and products with unit vectors, each rounded to 2^-24.
const ROUNDING: f32 = 1e-6;

/// A packet's receivers.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    /// About which everything is measured; `f32` like the corners of faces, so that differences are rounded once.
    pub(super) middle: [f32; 3],
    groups: [Points; GROUPS],
    /// The boxes of the groups.
    middles: Points,
    halves: Points,
    /// The farthest receiver from the middle, along an axis.
    reach: f32,
    /// Unit normals, unless all are open to all sides.
    normals: Option<Box<[Points; GROUPS]>>,
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
        let normals = receivers
            .iter()
            .any(|(_, normal)| *normal != [0.0; 3])
            .then(|| Box::new(std::array::from_fn(|g| Points::from_fn(|lane| at(g * LANES + lane).1))));
        let used = if receivers.len() == PACKET { u64::MAX } else { (1 << receivers.len()) - 1 };
        Self { middle, groups, middles, halves, reach, normals, used }
    }

    /// The lanes whose normals are not zero and not on the side of `to_sun`.
    #[inline(always)]
    fn turned_away(&self, to_sun: [f32; 3]) -> u64 {
        let Some(normals) = &self.normals else { return 0 };
        let mut bits = 0;
        for (g, normals) in normals.iter().enumerate() {
            let zero = Lanes::splat(0.0);
            let is_open = normals.dot([1.0; 3]).greater(zero) | zero.greater(normals.dot([1.0; 3]));
            let faces = normals.dot(to_sun).greater(zero);
            bits |= u64::from(is_open & !faces) << (g * LANES);
        }
        bits
    }
}

/// The axes of light space: two across the rays, one towards the sun; orthonormal.
#[derive(Debug, Clone, Copy)]
pub(super) struct LightSpace {
    across: [f32; 3],
    up: [f32; 3],
    to_sun: [f32; 3],
}

impl LightSpace {
    /// Light space of the unit vector `to_sun`.
    pub(super) fn new(to_sun: glam::DVec3) -> Self {
        let (across, up) = to_sun.any_orthonormal_pair();
        let round = |v: glam::DVec3| v.as_vec3().to_array();
        Self { across: round(across), up: round(up), to_sun: round(to_sun) }
    }
}

/// What is known of a packet under a sun.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Shade {
    /// In shadow for certain.
    pub(super) shadow: u64,
    /// To be settled by rays; disjoint from `shadow`.
    pub(super) near: u64,
}

/// The leaves in which the last shadows were found, which the next sun asks first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recent([u32; 2]);

impl Recent {
    /// None yet.
    pub(super) const NONE: Self = Self([u32::MAX; 2]);

    #[inline(always)]
    fn note(&mut self, leaf: u32) {
        if self.0[0] != leaf {
            self.0 = [leaf, self.0[0]];
        }
    }
}

/// Asks `tree` about `cell` under the sun of `light`.
///
/// `margin` is how far from an edge or plane a receiver must be to be certain, besides rounding; `pad` what boxes are widened by, at least the margin and the
/// rounding of the farthest.
#[inline(always)]
pub(super) fn shade(
    tree: &Tree,
    cell: &Cell,
    light: &LightSpace,
    margin: f32,
    pad: f32,
    recent: &mut Recent,
    stack: &mut Vec<u32>,
) -> Shade {
    let mut walk = Walk::new(cell, light, margin, pad);
    let first = recent.0;
    for leaf in first {
        if leaf != u32::MAX {
            walk.ask(&tree.leaves[leaf as usize]);
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
            if leaf != first[0] && leaf != first[1] && walk.ask(&tree.leaves[leaf as usize]) {
                recent.note(leaf);
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
    Shade { shadow: walk.shadow & cell.used, near: walk.near & !walk.shadow & cell.used }
}

struct Walk<'a> {
    cell: &'a Cell,
    light: &'a LightSpace,
    margin: f32,
    pad: f32,
    /// The groups' rectangles across the rays.
    group_u: [Lanes; 2],
    group_v: [Lanes; 2],
    /// The shaft: least and greatest across, and the lowest receiver along the rays.
    u: [f32; 2],
    v: [f32; 2],
    lowest: f32,
    /// The receivers across the rays, once they are asked for.
    projected: [[Lanes; 2]; GROUPS],
    is_projected: u8,
    shadow: u64,
    near: u64,
    /// Bit `g`: not all of group `g` is in shadow.
    alive: u8,
}

impl<'a> Walk<'a> {
    #[inline(always)]
    fn new(cell: &'a Cell, light: &'a LightSpace, margin: f32, pad: f32) -> Self {
        let span = |axis: [f32; 3]| {
            let (middle, half) = (cell.middles.dot(axis), cell.halves.dot(axis.map(f32::abs)));
            [middle - half, middle + half]
        };
        let (group_u, group_v) = (span(light.across), span(light.up));
        let mut walk = Self {
            cell,
            light,
            margin,
            pad,
            u: [group_u[0].least() - pad, group_u[1].greatest() + pad],
            v: [group_v[0].least() - pad, group_v[1].greatest() + pad],
            lowest: span(light.to_sun)[0].least() - pad,
            group_u,
            group_v,
            projected: [[Lanes::splat(0.0); 2]; GROUPS],
            is_projected: 0,
            shadow: !cell.used | cell.turned_away(light.to_sun),
            near: 0,
            alive: 0,
        };
        for g in 0..GROUPS {
            walk.alive |= u8::from((walk.shadow >> (g * LANES)) as u8 != u8::MAX) << g;
        }
        walk
    }

    /// Which of eight boxes meet the shaft, or seem to.
    #[inline(always)]
    fn meets(&self, middles: &Points, halves: &Points) -> u8 {
        let middles = middles.about(self.cell.middle);
        let span = |axis: [f32; 3]| {
            let (middle, half) = (middles.dot(axis), halves.dot(axis.map(f32::abs)));
            [middle - half, middle + half]
        };
        let ([u_min, u_max], [v_min, v_max]) = (span(self.light.across), span(self.light.up));
        let [_, top] = span(self.light.to_sun);
        Lanes::splat(self.u[1]).greater(u_min)
            & u_max.greater(Lanes::splat(self.u[0]))
            & Lanes::splat(self.v[1]).greater(v_min)
            & v_max.greater(Lanes::splat(self.v[0]))
            & top.greater(Lanes::splat(self.lowest))
    }

    /// Asks the faces of `leaf`; whether any casts on the packet.
    #[inline(always)]
    fn ask(&mut self, leaf: &Leaf) -> bool {
        let light = self.light;
        let corners = leaf.corners.map(|corners| corners.about(self.cell.middle));
        let u = corners.map(|corners| corners.dot(light.across));
        let v = corners.map(|corners| corners.dot(light.up));
        let w = corners.map(|corners| corners.dot(light.to_sun));
        let least = |of: &[Lanes; 4]| of[0].min(of[1]).min(of[2].min(of[3]));
        let greatest = |of: &[Lanes; 4]| of[0].max(of[1]).max(of[2].max(of[3]));
        let (u_min, u_max, v_min, v_max) = (least(&u), greatest(&u), least(&v), greatest(&v));
        let (w_min, w_max) = (least(&w), greatest(&w));
        let facing = leaf.normals.dot(light.to_sun);
        let mut hits = leaf.used
            & (leaf.two_sided | facing.greater(Lanes::splat(0.0)))
            & Lanes::splat(self.u[1]).greater(u_min)
            & u_max.greater(Lanes::splat(self.u[0]))
            & Lanes::splat(self.v[1]).greater(v_min)
            & v_max.greater(Lanes::splat(self.v[0]))
            & w_max.greater(Lanes::splat(self.lowest));
        let mut casts = false;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            // Widened by the pad, which is no less than the margin.
            let groups = self.alive
                & Lanes::splat(u_max.0[i] + self.pad).greater(self.group_u[0])
                & self.group_u[1].greater(Lanes::splat(u_min.0[i] - self.pad))
                & Lanes::splat(v_max.0[i] + self.pad).greater(self.group_v[0])
                & self.group_v[1].greater(Lanes::splat(v_min.0[i] - self.pad));
            if groups == 0 {
                continue;
            }
            let far = [u_min, u_max, v_min, v_max, w_min, w_max].map(|l| l.0[i].abs());
            let reach = far.into_iter().fold(self.cell.reach, f32::max);
            let across = std::array::from_fn(|c| [u[c].0[i], v[c].0[i]]);
            let corner = std::array::from_fn(|axis| corners[0].0[axis].0[i]);
            let normal = std::array::from_fn(|axis| leaf.normals.0[axis].0[i]);
            let face = Face::new(across, corner, normal, facing.0[i], self.margin + ROUNDING * reach);
            casts |= self.cast(&face, groups);
        }
        casts
    }

    #[inline(always)]
    fn cast(&mut self, face: &Face, mut groups: u8) -> bool {
        let before = self.shadow;
        while groups != 0 {
            let g = groups.trailing_zeros() as usize;
            groups &= groups - 1;
            let points = &self.cell.groups[g];
            if self.is_projected >> g & 1 == 0 {
                self.projected[g] = [points.dot(self.light.across), points.dot(self.light.up)];
                self.is_projected |= 1 << g;
            }
            let [u, v] = self.projected[g];
            let mut depth = points.dot(face.below) + Lanes::splat(face.below_offset);
            for [a, b, c] in face.edges {
                depth = depth.min(u * Lanes::splat(a) + v * Lanes::splat(b) + Lanes::splat(c));
            }
            let inside = depth.greater(Lanes::splat(face.margin));
            let near = depth.greater(Lanes::splat(-face.margin));
            self.shadow |= u64::from(inside) << (g * LANES);
            self.near |= u64::from(near) << (g * LANES);
            let is_dark = (self.shadow >> (g * LANES)) as u8 == u8::MAX;
            self.alive &= !(u8::from(is_dark) << g);
        }
        self.shadow != before
    }
}

/// A face's shadow volume: how far a point is inside of each of its planes, in metres.
struct Face {
    /// Times u, times v, plus.
    edges: [[f32; 3]; 4],
    /// The distance behind the face, seen from the sun: times the position, plus.
    below: [f32; 3],
    below_offset: f32,
    margin: f32,
}

impl Face {
    #[inline(always)]
    fn new(across: [[f32; 2]; 4], corner: [f32; 3], normal: [f32; 3], facing: f32, margin: f32) -> Self {
        // Seen from the sun the corners go round counter-clockwise where the normal faces it.
        let side = if facing > 0.0 { 1.0 } else { -1.0 };
        let edges = std::array::from_fn(|k| {
            let ([u, v], [next_u, next_v]) = (across[k], across[(k + 1) % 4]);
            let (du, dv) = (next_u - u, next_v - v);
            let length = (du * du + dv * dv).sqrt();
            // An edge along the sun, or a triangle's fourth. Without it the face is wider only where it is thinner than the margin.
            if length < margin {
                return [0.0, 0.0, f32::MAX];
            }
            let (a, b) = (-side * dv / length, side * du / length);
            [a, b, -(a * u + b * v)]
        });
        let below = normal.map(|n| -side * n);
        let below_offset = -(below[0] * corner[0] + below[1] * corner[1] + below[2] * corner[2]);
        Self { edges, below, below_offset, margin }
    }
}
