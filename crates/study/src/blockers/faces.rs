//! The shadow volumes of faces under the sun.
//!
//! A face's shadow volume is bounded by the planes through its edges along the sun and by its own plane (F. C. Crow 1977; the light cap and sides of
//! `umbrae_core`).

use super::lanes::{Eight, Lanes, dot};
use super::light_space::{Extents, LightSpace, along, range};
use super::tree::Leaf;

/// What rounding may move a corner in light space, in parts of its distance: three differences and products with unit vectors, each rounded to 2^-24.
const ROUNDING: f32 = 1e-6;

/// A leaf's faces as the sun sees them.
pub(super) struct Seen<L> {
    /// Corner by corner, across the rays.
    u: [L; 4],
    v: [L; 4],
    pub(super) extents: Extents<L>,
    first_corner: [L; 3],
    normals: [L; 3],
    /// Positive where the normal is on the sun's side.
    pub(super) facing: L,
}

impl<L: Lanes> Seen<L> {
    /// About `origin`.
    #[inline(always)]
    pub(super) fn new(leaf: &Leaf, origin: [f32; 3], light: &LightSpace) -> Self {
        let [a, b, c, d] = &leaf.corners;
        let corners = [a.about::<L>(origin), b.about(origin), c.about(origin), d.about(origin)];
        let (u, v, w) = (along(&corners, &light.across), along(&corners, &light.up), along(&corners, &light.to_sun));
        let normals = leaf.normals.load::<L>();
        let facing = dot(&normals, light.to_sun.of);
        let extents = Extents { u: range(&u), v: range(&v), w: range(&w) };
        Self { u, v, extents, first_corner: corners[0], normals, facing }
    }
}

/// The shadow volumes of a leaf's faces: how far a point is inside of each of their planes, in metres or somewhat less.
pub(super) struct Faces {
    /// Times u, times v, plus.
    edges: [[Eight; 3]; 4],
    /// The distance behind the face, seen from the sun: times the position, plus.
    below: [Eight; 3],
    below_offset: Eight,
    margin: Eight,
    /// The rectangles that they take up across the rays, widened.
    u: [Eight; 2],
    v: [Eight; 2],
}

impl Faces {
    /// Of the faces that are `seen` by receivers no farther than `reach` from the origin. What is nearer to a plane than `margin` and rounding is not sure to be on
    /// either side, and rectangles are widened by `pad`.
    #[inline(always)]
    pub(super) fn new<L: Lanes>(seen: &Seen<L>, reach: f32, margin: f32, pad: L) -> Self {
        let Seen { u, v, extents, first_corner: corner, normals, facing } = seen;
        let reach = extents.reach().max(L::splat(reach));
        let margin = L::splat(margin).add(L::splat(ROUNDING).mul(reach));
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
            u: [extents.u[0].sub(pad).stored(), extents.u[1].add(pad).stored()],
            v: [extents.v[0].sub(pad).stored(), extents.v[1].add(pad).stored()],
        }
    }

    /// Metres, with rounding.
    #[inline(always)]
    pub(super) fn margin(&self, i: usize) -> f32 {
        self.margin.0[i]
    }

    /// Which of eight rectangles, those from `group_u` and `group_v`, that of face `i` meets.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, i: usize, group_u: &[L; 2], group_v: &[L; 2]) -> u8 {
        L::splat(self.u[1].0[i]).greater(group_u[0])
            & group_u[1].greater(L::splat(self.u[0].0[i]))
            & L::splat(self.v[1].0[i]).greater(group_v[0])
            & group_v[1].greater(L::splat(self.v[0].0[i]))
    }

    /// How far `points` are below the plane of face `i`.
    #[inline(always)]
    pub(super) fn below<L: Lanes>(&self, i: usize, points: &[L; 3]) -> L {
        dot(points, [self.below[0].0[i], self.below[1].0[i], self.below[2].0[i]]).add(L::splat(self.below_offset.0[i]))
    }

    /// How far points at `u` and `v` are inside of the edge of face `i` that they are least inside of; `most` where that is less.
    #[inline(always)]
    pub(super) fn inside<L: Lanes>(&self, i: usize, [u, v]: [L; 2], most: L) -> L {
        let mut least = most;
        for [a, b, c] in &self.edges {
            least = least.min(u.mul(L::splat(a.0[i])).add(v.mul(L::splat(b.0[i]))).add(L::splat(c.0[i])));
        }
        least
    }
}
