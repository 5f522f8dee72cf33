//! Where a smooth silhouette crosses the edges of a mesh.

use glam::DVec3;

use crate::LightPosition;

use super::body::SmoothBody;
use super::curve::Curve;
use super::volume::Smoothness;

/// How far the fold is moved into the body, in lengths of the edge that it meets.
pub(super) const INSET: f64 = 0.02;
/// And at most, in radii of the body.
pub(super) const MOST_INSET: f64 = 2e-3;

/// So often a crossing is improved.
const STEPS: u32 = 3;

/// What it takes to find a crossing.
pub(super) struct Solver<'a> {
    pub(super) body: &'a SmoothBody,
    pub(super) light: LightPosition,
    pub(super) smoothness: &'a Smoothness,
    pub(super) radius_m: f64,
}

/// Where the silhouette crosses a wedge edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pub(super) edge: u32,
    /// From the caster's lower vertex to the higher.
    pub(super) u: f64,
    /// On the curve that the edge stands for.
    pub(super) smooth: DVec3,
    pub(super) normal: DVec3,
    /// On the mesh, and a little into the body: where the fin begins.
    pub(super) foot: DVec3,
}

impl Solver<'_> {
    /// The crossing of wedge edge `e`, one of whose ends is turned to the light.
    pub(super) fn solve(&self, e: usize) -> Crossing {
        let ends = self.body.ends(e);
        let [low, high] = ends.map(|w| self.body.height(w, self.light));
        // Which end is turned to the light has been decided in f32, so that u may be beyond an end by rounding.
        let u = low / (low - high);
        let u = if u.is_finite() { u.clamp(0.0, 1.0) } else { 0.5 };
        let [start, end] = ends.map(|w| self.body.place(w));
        let normals = ends.map(|w| self.body.normal(w));
        let inset_m = (INSET * start.distance(end)).min(MOST_INSET * self.radius_m);
        let straight = normals[0].lerp(normals[1], u).normalize_or_zero();
        let (u, smooth, normal) = match self.smoothness {
            Smoothness::Accurate => (u, start.lerp(end, u), straight),
            Smoothness::Smooth(_) => {
                let curve = self.body.curve_of_edge(e);
                let u = refined(&curve, normals, self.light, [low, high], u);
                (u, curve.at(u), curve.normal(u, normals))
            }
        };
        let foot = start.lerp(end, u) - straight * inset_m;
        Crossing { edge: e as u32, u, smooth, normal, foot }
    }
}

/// Where the surface along `curve` turns away from `light`, from heights of opposite signs at its ends and a first guess.
///
/// The paper stops at the guess, which takes normals and places between vertices for linear. Between them the surface is curved, and where it
/// is curved little along the light, a silhouette that is off by little on the surface is off by much in the shadow. Regula falsi, in the
/// Illinois form, gains a digit or two in each step.
fn refined(curve: &Curve, normals: [DVec3; 2], light: LightPosition, [low, high]: [f64; 2], guess: f64) -> f64 {
    let height = |u: f64| curve.normal(u, normals).dot(light.offset_from(curve.at(u)));
    let (mut a, mut b) = ((0.0, low), (1.0, high));
    let mut u = guess;
    for _ in 0..STEPS {
        let h = height(u);
        if (h > 0.0) == (a.1 > 0.0) {
            a = (u, h);
            b.1 *= 0.5;
        } else {
            b = (u, h);
            a.1 *= 0.5;
        }
        let next = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        if !next.is_finite() {
            break;
        }
        u = next.clamp(0.0, 1.0);
    }
    u
}
