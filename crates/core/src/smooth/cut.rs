//! The triangles of a body that its silhouette cuts: what each adds to the volume.
//!
//! [`super::volume`] has the picture.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::{Edge, LightPosition};

use super::AT_ONCE;
use super::added::{Added, Corner, place};
use super::body::SmoothBody;
use super::crossing::Crossing;
use super::curve::Curve;
use super::fins::points_of;
use super::volume::Smoothness;

/// What is known once it is known where the silhouette crosses edges: all that it takes to go on anywhere.
pub(super) struct Cutter<'a> {
    pub(super) body: &'a SmoothBody,
    pub(super) light: LightPosition,
    pub(super) smoothness: &'a Smoothness,
    pub(super) radius_m: f64,
    /// Of each wedge, whether it is turned to the light.
    pub(super) turned: &'a [i8],
    pub(super) crossings: &'a [Crossing],
    /// For each wedge edge that is crossed, which of these it is.
    pub(super) crossing_of_edge: &'a [u32],
    /// Of the volume: two for each crossing.
    pub(super) points: &'a [Vec3],
}

/// Where the silhouette crosses an edge, and the two points there.
#[derive(Clone, Copy)]
pub(super) struct Crossed<'a> {
    pub(super) at: &'a Crossing,
    number: u32,
    /// On the silhouette.
    pub(super) p: Corner,
    /// The fin's foot.
    pub(super) q: Corner,
}

impl Cutter<'_> {
    #[inline]
    pub(super) fn is_turned(&self, w: u32) -> bool {
        self.turned[w as usize] > 0
    }

    /// Whether all that is lit is to face the light. On the mesh itself, that would make the silhouette the discrete one.
    pub(super) fn is_facing_checked(&self) -> bool {
        matches!(self.smoothness, Smoothness::Smooth(_))
    }

    /// The crossing of wedge edge `e`, one of whose ends is turned to the light.
    #[inline]
    pub(super) fn crossed(&self, e: usize) -> Crossed<'_> {
        let number = self.crossing_of_edge[e];
        let [p, q] = points_of(number).map(Corner::Point);
        Crossed { at: &self.crossings[number as usize], number, p, q }
    }

    #[inline]
    pub(super) fn place(&self, added: &Added, corner: Corner) -> DVec3 {
        place(corner, self.body, self.points, &added.points)
    }

    /// What the triangles at the edges that are crossed add.
    pub(super) fn cut_triangles(&self) -> Vec<Added> {
        let cut = |crossings: &[Crossing]| {
            let mut added = Added::default();
            crossings.iter().for_each(|crossing| self.cut_triangles_at(crossing.edge as usize, &mut added));
            added
        };
        self.crossings.par_chunks(AT_ONCE).map(cut).collect()
    }

    fn cut_triangles_at(&self, e: usize, added: &mut Added) {
        let topology = &self.body.wedges.topology;
        let Edge { low, high } = topology.edges()[e];
        let is_upward = self.is_turned(low);
        let turned = if is_upward { low } else { high };
        for (t, direction) in topology.triangles_on_edge(e) {
            // Each triangle that the silhouette crosses is left by it once, over an edge that goes from light to dark.
            if (direction > 0) == is_upward {
                self.cut_triangle(t, e, turned, added);
                added.may_be_away.push(t as u32);
            }
        }
    }

    /// Triangle `t`, whose edge `exit` goes from `turned` to a wedge that is not.
    fn cut_triangle(&self, t: usize, exit: usize, turned: u32, added: &mut Added) {
        let corners = self.body.wedges.mesh.triangles()[t];
        let k = corners.iter().position(|&w| w == turned).expect("the edge is the triangle's");
        let [first, second, third] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let has_two_turned = self.is_turned(third);
        let entry = if has_two_turned { [second, third] } else { [third, first] };
        let entry = self.body.wedges.topology.edge_between(entry[0], entry[1]).expect("the edge is the triangle's");
        let (a, b) = (self.crossed(exit), self.crossed(entry));
        // The edge that is not crossed, in the direction of the curve.
        let beside = [if has_two_turned { first } else { second }, third];
        self.add_curve(a, b, beside, added);
        if self.is_facing_checked() {
            self.check_pieces([first, second, third], has_two_turned, added);
        }
        let [third, second] = [third, second].map(|w| Corner::Vertex(self.body.vertex_of_wedge[w as usize]));
        // The cycle from the fin's foot at the exit, along the curve, down to the fold, and back along the dark corners.
        added.sides.extend(added.curve.windows(2).map(|piece| [piece[0], piece[1]]));
        if added.curve.len() == 2 {
            added.fins.push([a.number, b.number]);
        } else {
            added.faces.extend(added.curve.windows(2).map(|piece| [a.q, piece[0], piece[1]]));
            added.faces.push([a.q, b.p, b.q]);
        }
        if has_two_turned {
            added.folds.push([a.q, b.q, second]);
        } else {
            added.folds.extend([[a.q, b.q, third], [a.q, third, second]]);
        }
    }

    /// The points from `a` to `b`, both with, become the curve at hand; `beside` are the ends of the third edge of their triangle.
    fn add_curve(&self, a: Crossed<'_>, b: Crossed<'_>, beside: [u32; 2], added: &mut Added) {
        added.curve.clear();
        added.curve.push(a.p);
        if let Smoothness::Smooth(precision) = self.smoothness {
            let curve = Curve::on_surface(a.at.smooth, b.at.smooth, [a.at.normal, b.at.normal]);
            let crease = self.crease_beside(beside);
            let chord_m = precision.chord_m(a.at.smooth, self.light);
            let beside_pieces = crease.map_or(1, |crease| crease.pieces([0.0, 1.0], chord_m));
            let pieces = curve.pieces([0.0, 1.0], chord_m).max(beside_pieces);
            if pieces > 1 {
                let nearness = [self.nearness(a.at, beside[0]), self.nearness(b.at, beside[1])];
                let moved = |u: f64| {
                    // The surface bends with the crease at its border, of which normals say nothing; else one could cross the other.
                    crease
                        .map_or(DVec3::ZERO, |crease| crease.bulge(u) * (nearness[0] + (nearness[1] - nearness[0]) * u))
                };
                add_inner_points(&curve, [0.0, 1.0], pieces, moved, added);
            }
        }
        added.curve.push(b.p);
    }

    /// The curve between two wedges, from the first to the second, if that is a crease.
    fn crease_beside(&self, [from, to]: [u32; 2]) -> Option<Curve> {
        let e = self.body.wedges.topology.edge_between(from, to)?;
        let curve = self.body.crease_curve(e)?;
        Some(if self.body.ends(e)[0] == from { curve } else { curve.reversed() })
    }

    /// 1 where a crossing is at wedge `w`, an end of its edge, and 0 where it is at the other end.
    fn nearness(&self, crossing: &Crossing, w: u32) -> f64 {
        if self.body.ends(crossing.edge as usize)[0] == w { 1.0 - crossing.u } else { crossing.u }
    }
}

/// Points of `curve` between `ends`, so that there are so many `pieces`, each moved by `moved`, go on the curve at hand.
pub(super) fn add_inner_points(
    curve: &Curve,
    ends: [f64; 2],
    pieces: u32,
    moved: impl Fn(f64) -> DVec3,
    added: &mut Added,
) {
    for i in 1..pieces {
        let u = ends[0] + (ends[1] - ends[0]) * f64::from(i) / f64::from(pieces);
        let p = added.point(curve.at(u) + moved(u));
        added.curve.push(p);
    }
}
