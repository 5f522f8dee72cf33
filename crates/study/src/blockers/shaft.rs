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

use super::lanes::{Eight, LANES, Lanes, Plain, Points, dot};
use super::tree::{LEAF, Leaf, Tree};
use crate::PACKET;

/// Receivers of a packet are tested in so many groups.
pub(super) const GROUPS: usize = PACKET / LANES;

/// What rounding may move a corner in light space, in parts of its distance: three differences and products with unit vectors, each rounded to 2^-24.
pub(super) const ROUNDING: f32 = 1e-6;

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

    /// The lanes whose normals are not zero and not on the side of `to_sun`.
    #[inline(always)]
    fn turned_away<L: Lanes>(&self, to_sun: [f32; 3]) -> u64 {
        self.turned_from::<L>(to_sun, 0.0)
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

/// The axes of light space: two across the rays, one towards the sun; orthonormal.
#[derive(Debug, Clone, Copy)]
pub(super) struct LightSpace {
    pub(super) across: Axis,
    pub(super) up: Axis,
    pub(super) to_sun: Axis,
}

/// A unit vector, and it without signs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    pub(super) of: [f32; 3],
    abs: [f32; 3],
}

impl LightSpace {
    /// Light space of the unit vector `to_sun`.
    pub(super) fn new(to_sun: glam::DVec3) -> Self {
        let (across, up) = to_sun.any_orthonormal_pair();
        let axis = |v: glam::DVec3| Axis { of: v.as_vec3().to_array(), abs: v.as_vec3().abs().to_array() };
        Self { across: axis(across), up: axis(up), to_sun: axis(to_sun) }
    }
}

/// How far boxes reach along `axis`: from, to.
#[inline(always)]
pub(super) fn span<L: Lanes>(middles: &[L; 3], halves: &[L; 3], axis: &Axis) -> [L; 2] {
    let (middle, half) = (dot(middles, axis.of), dot(halves, axis.abs));
    [middle.sub(half), middle.add(half)]
}

/// Corner by corner, how far along `axis`.
#[inline(always)]
pub(super) fn along<L: Lanes>(corners: &[[L; 3]; 4], axis: &Axis) -> [L; 4] {
    let [a, b, c, d] = corners;
    [dot(a, axis.of), dot(b, axis.of), dot(c, axis.of), dot(d, axis.of)]
}

/// The least and the greatest of four, lane by lane.
#[inline(always)]
pub(super) fn range<L: Lanes>(of: &[L; 4]) -> [L; 2] {
    [of[0].min(of[1]).min(of[2].min(of[3])), of[0].max(of[1]).max(of[2].max(of[3]))]
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

/// How certain a receiver must be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Care {
    /// How far from every edge and plane that matters, besides rounding.
    pub(super) margin: f32,
    /// What boxes are widened by: at least the margin and the rounding of the farthest.
    pub(super) pad: f32,
}

/// Asks `tree` about `cell` under each of `lights`, one after the other as neighbours in time, and calls `answer` with the index of each that is not `None`.
pub(super) fn shade_all(
    tree: &Tree,
    cell: &Cell,
    lights: &[Option<LightSpace>],
    care: Care,
    answer: impl FnMut(usize, Shade),
) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn with_avx2(
            tree: &Tree,
            cell: &Cell,
            lights: &[Option<LightSpace>],
            care: Care,
            answer: impl FnMut(usize, Shade),
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
    mut answer: impl FnMut(usize, Shade),
) {
    let mut recent = Recent::NONE;
    let mut stack = Vec::with_capacity(64);
    for (i, light) in lights.iter().enumerate() {
        if let Some(light) = light {
            answer(i, shade::<L>(tree, cell, light, care, &mut recent, &mut stack));
        }
    }
}

#[inline(always)]
fn shade<L: Lanes>(
    tree: &Tree,
    cell: &Cell,
    light: &LightSpace,
    Care { margin, pad }: Care,
    recent: &mut Recent,
    stack: &mut Vec<u32>,
) -> Shade {
    let mut walk = Walk::<L>::new(cell, light, margin, pad);
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

struct Walk<'a, L> {
    cell: &'a Cell,
    light: &'a LightSpace,
    margin: f32,
    pad: f32,
    /// The groups' rectangles across the rays.
    group_u: [L; 2],
    group_v: [L; 2],
    /// The shaft: least and greatest across, and the lowest receiver along the rays.
    u: [f32; 2],
    v: [f32; 2],
    lowest: f32,
    /// The receivers across the rays, once they are asked for.
    projected: [[Eight; 2]; GROUPS],
    is_projected: u8,
    shadow: u64,
    near: u64,
    /// Bit `g`: not all of group `g` is in shadow.
    alive: u8,
}

impl<'a, L: Lanes> Walk<'a, L> {
    #[inline(always)]
    fn new(cell: &'a Cell, light: &'a LightSpace, margin: f32, pad: f32) -> Self {
        let (middles, halves) = (cell.middles.load::<L>(), cell.halves.load::<L>());
        let group_u = span(&middles, &halves, &light.across);
        let group_v = span(&middles, &halves, &light.up);
        let [lowest, _] = span(&middles, &halves, &light.to_sun);
        let mut walk = Self {
            cell,
            light,
            margin,
            pad,
            u: [group_u[0].stored().least() - pad, group_u[1].stored().greatest() + pad],
            v: [group_v[0].stored().least() - pad, group_v[1].stored().greatest() + pad],
            lowest: lowest.stored().least() - pad,
            group_u,
            group_v,
            projected: [[Eight::ZERO; 2]; GROUPS],
            is_projected: 0,
            shadow: !cell.used | cell.turned_away::<L>(light.to_sun.of),
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
        let (middles, halves) = (middles.about::<L>(self.cell.middle), halves.load::<L>());
        let [u_min, u_max] = span(&middles, &halves, &self.light.across);
        let [v_min, v_max] = span(&middles, &halves, &self.light.up);
        let [_, top] = span(&middles, &halves, &self.light.to_sun);
        L::splat(self.u[1]).greater(u_min)
            & u_max.greater(L::splat(self.u[0]))
            & L::splat(self.v[1]).greater(v_min)
            & v_max.greater(L::splat(self.v[0]))
            & top.greater(L::splat(self.lowest))
    }

    /// Asks the faces of `leaf`; whether any casts on the packet.
    #[inline(always)]
    fn ask(&mut self, leaf: &Leaf) -> bool {
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
        let mut hits = leaf.used
            & (leaf.two_sided | facing.greater(L::splat(0.0)))
            & L::splat(self.u[1]).greater(u_min)
            & u_max.greater(L::splat(self.u[0]))
            & L::splat(self.v[1]).greater(v_min)
            & v_max.greater(L::splat(self.v[0]))
            & w_max.greater(L::splat(self.lowest));
        if hits == 0 {
            return false;
        }
        let reach_u = u_max.abs().max(u_min.abs());
        let reach_v = v_max.abs().max(v_min.abs());
        let reach_w = w_max.abs().max(w_min.abs());
        let reach = reach_u.max(reach_v).max(reach_w).max(L::splat(self.cell.reach));
        let margin = L::splat(self.margin).add(L::splat(ROUNDING).mul(reach));
        let faces = Faces::new(&u, &v, &corners[0], &normals, facing, margin);
        // Widened by the pad, which is no less than the margin.
        let pad = L::splat(self.pad);
        let [u_min, u_max] = [u_min.sub(pad).stored(), u_max.add(pad).stored()];
        let [v_min, v_max] = [v_min.sub(pad).stored(), v_max.add(pad).stored()];
        let mut casts = false;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let groups = self.alive
                & L::splat(u_max.0[i]).greater(self.group_u[0])
                & self.group_u[1].greater(L::splat(u_min.0[i]))
                & L::splat(v_max.0[i]).greater(self.group_v[0])
                & self.group_v[1].greater(L::splat(v_min.0[i]));
            if groups != 0 {
                casts |= self.cast(&faces, i, groups);
            }
        }
        casts
    }

    #[inline(always)]
    fn cast(&mut self, faces: &Faces, i: usize, mut groups: u8) -> bool {
        let before = self.shadow;
        let below = [faces.below[0].0[i], faces.below[1].0[i], faces.below[2].0[i]];
        while groups != 0 {
            let g = groups.trailing_zeros() as usize;
            groups &= groups - 1;
            let points = self.cell.groups[g].load::<L>();
            if self.is_projected >> g & 1 == 0 {
                let [u, v] = [dot(&points, self.light.across.of), dot(&points, self.light.up.of)];
                self.projected[g] = [u.stored(), v.stored()];
                self.is_projected |= 1 << g;
            }
            let [u, v] = [L::load(&self.projected[g][0]), L::load(&self.projected[g][1])];
            let mut depth = dot(&points, below).add(L::splat(faces.below_offset.0[i]));
            for [a, b, c] in &faces.edges {
                let across = u.mul(L::splat(a.0[i])).add(v.mul(L::splat(b.0[i]))).add(L::splat(c.0[i]));
                depth = depth.min(across);
            }
            let inside = depth.greater(L::splat(faces.margin.0[i]));
            let near = depth.greater(L::splat(-faces.margin.0[i]));
            self.shadow |= u64::from(inside) << (g * LANES);
            self.near |= u64::from(near) << (g * LANES);
            let is_dark = (self.shadow >> (g * LANES)) as u8 == u8::MAX;
            self.alive &= !(u8::from(is_dark) << g);
        }
        self.shadow != before
    }
}

/// The shadow volumes of a leaf's faces: how far a point is inside of each of their planes, in metres or somewhat less.
pub(super) struct Faces {
    /// Times u, times v, plus.
    pub(super) edges: [[Eight; 3]; 4],
    /// The distance behind the face, seen from the sun: times the position, plus.
    pub(super) below: [Eight; 3],
    pub(super) below_offset: Eight,
    pub(super) margin: Eight,
}

impl Faces {
    /// Of corners at `u` and `v` across the rays, the first of them at `corner`; `facing` is positive where the normal is on the sun's side.
    #[inline(always)]
    pub(super) fn new<L: Lanes>(
        u: &[L; 4],
        v: &[L; 4],
        corner: &[L; 3],
        normals: &[L; 3],
        facing: L,
        margin: L,
    ) -> Self {
        let zero = L::splat(0.0);
        // Seen from the sun the corners go round counter-clockwise where the normal faces it.
        let side = facing.select_greater(zero, L::splat(1.0), L::splat(-1.0));
        let mut edges = [[Eight::ZERO; 3]; 4];
        for (k, edge) in edges.iter_mut().enumerate() {
            let (du, dv) = (u[(k + 1) % 4].sub(u[k]), v[(k + 1) % 4].sub(v[k]));
            // Between the length and 1.5 times it, and without a root: distances come out too small, by less than a third.
            let length = du.abs().add(dv.abs());
            let scale = side.div(length.max(margin));
            let (a, b) = (zero.sub(dv.mul(scale)), du.mul(scale));
            let c = zero.sub(a.mul(u[k]).add(b.mul(v[k])));
            // An edge along the sun, or a triangle's fourth. Without it the face is wider only where it is thinner than the margin.
            let c = length.select_greater(margin, c, L::splat(f32::MAX));
            *edge = [
                length.select_greater(margin, a, zero).stored(),
                length.select_greater(margin, b, zero).stored(),
                c.stored(),
            ];
        }
        let away = zero.sub(side);
        let below = [away.mul(normals[0]), away.mul(normals[1]), away.mul(normals[2])];
        let height = below[0].mul(corner[0]).add(below[1].mul(corner[1])).add(below[2].mul(corner[2]));
        Self {
            edges,
            below: [below[0].stored(), below[1].stored(), below[2].stored()],
            below_offset: zero.sub(height).stored(),
            margin: margin.stored(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blockers::clutter::{CARE, clutter};

    #[test]
    fn every_processor_finds_the_same_bits() {
        let (tree, asked) = clutter();
        let mut seen = Shade::default();
        for (cell, lights) in asked {
            let (mut plain, mut best) = (Vec::new(), Vec::new());
            shade_in_order::<Plain>(&tree, &cell, &lights, CARE, |i, shade| plain.push((i, shade)));
            shade_all(&tree, &cell, &lights, CARE, |i, shade| best.push((i, shade)));
            assert_eq!(plain, best);
            for (_, shade) in best {
                seen = Shade { shadow: seen.shadow | shade.shadow, near: seen.near | shade.near };
            }
        }
        assert!(seen.shadow != 0 && seen.near != 0, "the scene has shadows and edges");
    }
}
