//! What is on the wrong side of a smooth silhouette, and goes over to the other.
//!
//! ```text
//!     lit  *------.-'p-----* dark      The silhouette cuts triangles into pieces. They and the triangles that it leaves whole
//!           \   .'  /  \  /             are a closed surface again. If each lit piece faced the light and each dark one faced
//!         lit\.' lit/dark\/             away from it, a point would be counted as often as the surface is lit between it and
//!           p *----/------* dark        the light: nowhere below 0, and 0 in the light alone.
//! ```
//!
//! Normals promise as much, and triangles break it: where a surface folds or is coarse, a piece that is lit by its normals shows the light its back. What
//! lies under it is counted once less, and where that leaves nothing, light falls through the body: pinholes, in the middle of a shadow. So a
//! lit piece that is turned away is taken out of the light cap, a dark one that faces the light is added to it, and the silhouette goes round
//! it. Each of them raises counts and lowers none; with all of them no leak can be left, whatever the normals are. O. Mattausch et al. 2012 do not speak of it.
//!
//! Most need not go over: far behind them, the silhouette counts 1 or more as it is, for a fold has lit pieces over it and under it. Where the surface is
//! hollow along the light they do all the same: rays that leave the body there soon meet it again, and what they meet would be lit through all of the body,
//! whatever is counted far behind. Only what is smaller than a shadow may be off is spared that.
//!
//! The surface is free to be where it suits, but on the silhouette. Its vertices are those of the mesh, moved into the body where that is a saddle
//! ([`SmoothBody::inner_places`]): there a straight line between two of its points runs outside of it, and a piece with such a border would be seen
//! beyond the outline.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::LightPosition;

use super::added::{Added, Corner, Walk, place, undirected};
use super::body::SmoothBody;
use super::cut::Cutter;
use super::maker::Maker;
use super::volume::Smoothness;
use super::winding::Windings;
use super::{AT_ONCE, TRIANGLES_AT_ONCE};

/// Vertices are moved inward by so many times the most that an edge bends inward there.
pub(super) const SADDLE: f64 = 4.0;

/// The part of the surface on which a piece lies by its normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Lit,
    Dark,
}

/// Pieces that are on the wrong side, walked so that they face the light.
#[derive(Debug, Default, Clone)]
pub(super) struct WrongPieces {
    /// These go over.
    pub(super) hollow: Vec<[Corner; 3]>,
    /// And these if there is light far behind them.
    pub(super) others: Vec<[Corner; 3]>,
}

/// What is needed while pieces go over.
#[derive(Debug, Default, Clone)]
pub(super) struct FacingScratch {
    pub(super) wrong: WrongPieces,
    /// The points that stand for vertices of the caster, moved inward.
    pub(super) point_of_inner: FxHashMap<u32, u32>,
    /// What the silhouette gains: parts of it meet, and meet what it was before, and cancel.
    gained: FxHashMap<[u32; 2], i32>,
    windings: Windings,
}

/// More than 0 where a triangle between `corners` faces `light`, and less where it faces away.
#[inline]
fn towards([a, b, c]: [DVec3; 3], light: LightPosition) -> f64 {
    (b - a).cross(c - a).dot(light.offset_from(a))
}

impl SmoothBody {
    /// Where the vertices of the caster are taken for to be.
    ///
    /// By how much they are moved: a curve that bends inward by b in its middle is 4 b t (1 - t) below its chord, nearly. The line from a point of the outline, on the
    /// curve, to the vertex, moved by 4 b, is (1 - t) 4 b below it, and that is nowhere less. Ends of creases stay, for the silhouette runs through them.
    pub(super) fn inner_places(&self) -> Vec<Vec3> {
        let mut most_m = vec![0.0_f64; self.wedge_of_vertex.len()];
        for e in 0..self.bends.len() {
            let bulge = self.curve_of_edge(e).bulge(0.5);
            for w in self.ends(e) {
                let most_m = &mut most_m[self.vertex_of_wedge[w as usize] as usize];
                *most_m = most_m.max(-bulge.dot(self.normal(w)));
            }
        }
        for v in self.creases.iter().flat_map(|crease| crease.vertices) {
            most_m[v as usize] = 0.0;
        }
        let moved = |(&w, most_m): (&u32, f64)| (self.place(w) - self.normal(w) * (SADDLE * most_m)).as_vec3();
        self.wedge_of_vertex.iter().zip(most_m).map(moved).collect()
    }
}

impl Cutter<'_> {
    /// The pieces of a triangle that the curve at hand cuts, from the edge between the first corner, which is lit, and the second, which is not.
    pub(super) fn check_pieces(&self, corners: [u32; 3], has_two_turned: bool, added: &mut Added) {
        let is_hollow = || self.is_hollow(corners);
        let [first, second, third] = corners.map(|w| Corner::Inner(self.body.vertex_of_wedge[w as usize]));
        let mut to = added.curve[0];
        for i in 1..added.curve.len() {
            let from = to;
            to = added.curve[i];
            self.check([first, from, to], Part::Lit, is_hollow, added);
            self.check([from, second, to], Part::Dark, is_hollow, added);
        }
        if has_two_turned {
            self.check([first, to, third], Part::Lit, is_hollow, added);
        } else {
            self.check([to, second, third], Part::Dark, is_hollow, added);
        }
    }

    /// What the triangles add that the silhouette does not cut.
    pub(super) fn look_at_whole_triangles(&self) -> Vec<Added> {
        let heights = self.body.planes.as_ref().map(|planes| planes.under(self.light));
        let look = |(chunk, triangles): (usize, &[[u32; 3]])| {
            let mut added = Added::default();
            for (corners, t) in triangles.iter().zip(chunk * TRIANGLES_AT_ONCE..) {
                let part = match corners.iter().map(|&w| self.turned[w as usize]).sum::<i8>() {
                    0 => Part::Dark,
                    3 => Part::Lit,
                    _ => continue,
                };
                if heights.is_some_and(|heights| match part {
                    Part::Lit => heights.surely_faces(t),
                    Part::Dark => heights.surely_faces_away(t),
                }) {
                    continue;
                }
                if self.is_facing_checked() {
                    let piece = corners.map(|w| Corner::Inner(self.body.vertex_of_wedge[w as usize]));
                    self.check(piece, part, || self.is_hollow(*corners), &mut added);
                }
                if part == Part::Lit && towards(corners.map(|w| self.body.place(w)), self.light) < 0.0 {
                    added.may_be_away.push(t as u32);
                }
            }
            added
        };
        self.body.wedges.mesh.triangles().par_chunks(TRIANGLES_AT_ONCE).enumerate().map(look).collect()
    }

    /// Notes `piece` if it shows the light its back though it is lit, or its front though it is dark, and then asks whether it `is_hollow` there. What is seen edge on
    /// shows neither.
    pub(super) fn check(&self, piece: [Corner; 3], part: Part, is_hollow: impl FnOnce() -> bool, added: &mut Added) {
        let towards = towards(piece.map(|corner| self.place(added, corner)), self.light);
        let [a, b, c] = piece;
        let facing = match part {
            Part::Lit if towards < 0.0 => [a, c, b],
            Part::Dark if towards > 0.0 => piece,
            _ => return,
        };
        let wrong = if is_hollow() { &mut added.wrong.hollow } else { &mut added.wrong.others };
        wrong.push(facing);
    }

    /// Whether the surface at a triangle is hollow along the light: the farther one goes with its rays, the more its normals turn towards it. Not if the triangle is smaller than a
    /// shadow may be off.
    fn is_hollow(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|w| self.body.place(w));
        if !self.is_seen(a.distance(b).max(b.distance(c)).max(c.distance(a)), a) {
            return false;
        }
        let [at_a, at_b, at_c] = corners.map(|w| self.body.height(w, self.light));
        let (ab, ac, ahead) = (b - a, c - a, -self.light.offset_from(a));
        // The rays' direction in the triangle's plane, as parts of two of its sides; times a number above 0.
        let (along_ab, along_ac) = (ab.dot(ahead), ac.dot(ahead));
        let of_ab = ac.length_squared() * along_ab - ab.dot(ac) * along_ac;
        let of_ac = ab.length_squared() * along_ac - ab.dot(ac) * along_ab;
        of_ab * (at_b - at_a) + of_ac * (at_c - at_a) >= 0.0
    }

    /// Whether what is `length_m` long, and at `place`, is larger than a shadow may be off.
    pub(super) fn is_seen(&self, length_m: f64, place: DVec3) -> bool {
        match self.smoothness {
            Smoothness::Accurate => true,
            Smoothness::Smooth(precision) => length_m > precision.chord_m(place, self.light),
        }
    }
}

impl Maker<'_> {
    /// Takes the lit pieces that were noted out of the light cap and the dark ones into it, but for those that are shaded anyway, and leads the silhouette
    /// round them.
    pub(super) fn move_over(&mut self) {
        let WrongPieces { mut hollow, mut others } = std::mem::take(&mut self.scratch.facing.wrong);
        if hollow.is_empty() && others.is_empty() {
            return;
        }
        let mut windings = std::mem::take(&mut self.scratch.facing.windings);
        if !others.is_empty() {
            windings.wind(self.volume, &self.body.loose_bounds(), self.light);
        }
        let (body, points) = (self.body, self.volume.points.as_slice());
        let is_needed =
            |piece: &&[Corner; 3]| !windings.goes_round_all(piece.map(|corner| place(corner, body, points, &[])));
        let needed: Vec<[Corner; 3]> = others.par_iter().with_min_len(AT_ONCE).filter(is_needed).copied().collect();
        for piece in hollow.iter().chain(&needed) {
            let [a, b, c] = piece.map(|corner| self.point_of(corner, 0));
            self.volume.faces.push([a, b, c]);
            for side in [[a, b], [b, c], [c, a]] {
                let (edge, times) = undirected((side, 1));
                *self.scratch.facing.gained.entry(edge).or_default() += times;
            }
        }
        self.add_gained();
        hollow.clear();
        others.clear();
        let facing = &mut self.scratch.facing;
        (facing.wrong, facing.windings) = (WrongPieces { hollow, others }, windings);
        facing.point_of_inner.clear();
    }

    fn add_gained(&mut self) {
        let gained = &mut self.scratch.facing.gained;
        self.volume.sides.retain(|&side| {
            let (edge, times) = undirected((side, 1));
            match gained.get_mut(&edge) {
                Some(left) if *left * times < 0 => {
                    *left += times;
                    false
                }
                _ => true,
            }
        });
        // In an order that is the same on every run.
        let mut left: Vec<Walk<u32>> = gained.drain().filter(|&(_, times)| times != 0).collect();
        left.sort_unstable();
        for ([low, high], times) in left {
            let side = if times > 0 { [low, high] } else { [high, low] };
            self.volume.sides.extend(std::iter::repeat_n(side, times.unsigned_abs() as usize));
        }
    }
}
