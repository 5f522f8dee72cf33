//! Space as the sun sees it: across its rays, and along them.

use super::lanes::{Lanes, dot};

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

/// Eight boxes along the axes of light space, each from where to where.
#[derive(Clone, Copy)]
pub(super) struct Extents<L> {
    pub(super) u: [L; 2],
    pub(super) v: [L; 2],
    pub(super) w: [L; 2],
}

impl<L: Lanes> Extents<L> {
    /// The farthest that any reaches from the origin, along an axis.
    #[inline(always)]
    pub(super) fn reach(&self) -> L {
        let Self { u, v, w } = self;
        let [u, v, w] = [u[1].abs().max(u[0].abs()), v[1].abs().max(v[0].abs()), w[1].abs().max(w[0].abs())];
        u.max(v).max(w)
    }
}

impl LightSpace {
    /// Of boxes that are given by middles and half sizes.
    #[inline(always)]
    pub(super) fn extents<L: Lanes>(&self, middles: &[L; 3], halves: &[L; 3]) -> Extents<L> {
        Extents {
            u: span(middles, halves, &self.across),
            v: span(middles, halves, &self.up),
            w: span(middles, halves, &self.to_sun),
        }
    }
}

#[inline(always)]
fn span<L: Lanes>(middles: &[L; 3], halves: &[L; 3], axis: &Axis) -> [L; 2] {
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
