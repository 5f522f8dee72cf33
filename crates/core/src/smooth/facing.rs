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
//! Most need not go over: behind them, the silhouette counts 1 or more as it is, for a fold has lit pieces over it and under it.
//!
//! The surface is free to be where it suits, but on the silhouette. Its vertices are those of the mesh, moved into the body where that is a saddle
//! ([`SmoothBody::inner_places`]): there a straight line between two of its points runs outside of it, and a piece with such a border would be seen
//! beyond the outline.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::LightPosition;

use super::AT_ONCE;
use super::body::SmoothBody;
use super::maker::{Maker, Walk, undirected};
use super::winding::Windings;

/// Vertices are moved inward by so many times the most that an edge bends inward there.
pub(super) const SADDLE: f64 = 4.0;
/// Fewer triangles than this are not worth another thread.
const TRIANGLES_AT_ONCE: usize = 4096;

/// A corner of a piece: a point of the volume, or a vertex of the caster, moved inward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Corner {
    Point(u32),
    Vertex(u32),
}

use Corner::{Point, Vertex};

impl Corner {
    fn place(self, points: &[Vec3], inner: &[Vec3]) -> DVec3 {
        match self {
            Point(p) => points[p as usize],
            Vertex(v) => inner[v as usize],
        }
        .as_dvec3()
    }
}

/// The part of the surface on which a piece lies by its normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Lit,
    Dark,
}

/// What is needed while pieces go over.
#[derive(Debug, Default, Clone)]
pub(super) struct FacingScratch {
    /// Pieces that are on the wrong side, walked so that they face the light.
    wrong: Vec<[Corner; 3]>,
    /// The points that stand for vertices of the caster, moved inward.
    point_of_vertex: FxHashMap<u32, u32>,
    /// What the silhouette gains: parts of it meet, and meet what it was before, and cancel.
    gained: FxHashMap<[u32; 2], i32>,
    windings: Windings,
}

/// `piece`, walked so that it faces `light`, if it shows it its back though it is lit, or its front though it is dark. What is seen edge on shows neither.
fn facing(piece: [Corner; 3], places: [DVec3; 3], part: Part, light: LightPosition) -> Option<[Corner; 3]> {
    let ([a, b, c], [at_a, at_b, at_c]) = (piece, places);
    let towards = (at_b - at_a).cross(at_c - at_a).dot(light.offset_from(at_a));
    match part {
        Part::Lit => (towards < 0.0).then_some([a, c, b]),
        Part::Dark => (towards > 0.0).then_some(piece),
    }
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

impl Maker<'_> {
    /// The pieces of a triangle that the scratch's curve cuts, from the edge between the first corner, which is lit, and the second, which is not.
    pub(super) fn check_pieces(&mut self, corners: [u32; 3], has_two_turned: bool) {
        let [first, second, third] = corners.map(|w| Vertex(self.body.vertex_of_wedge[w as usize]));
        let mut to = Point(self.scratch.curve[0]);
        for i in 1..self.scratch.curve.len() {
            let from = to;
            to = Point(self.scratch.curve[i]);
            self.check([first, from, to], Part::Lit);
            self.check([from, second, to], Part::Dark);
        }
        if has_two_turned {
            self.check([first, to, third], Part::Lit);
        } else {
            self.check([to, second, third], Part::Dark);
        }
    }

    /// All the triangles that the silhouette does not cut.
    pub(super) fn check_whole_triangles(&mut self) {
        let (body, turned) = (self.body, self.volume.turned.as_slice());
        let wrong = |corners: &[u32; 3]| {
            let part = match corners.iter().map(|&w| turned[w as usize]).sum::<i8>() {
                0 => Part::Dark,
                3 => Part::Lit,
                _ => return None,
            };
            let piece = corners.map(|w| Vertex(body.vertex_of_wedge[w as usize]));
            facing(piece, piece.map(|corner| corner.place(&[], &body.inner)), part, self.light)
        };
        let triangles = body.wedges.mesh.triangles().par_iter().with_min_len(TRIANGLES_AT_ONCE);
        let wrong: Vec<[Corner; 3]> = triangles.filter_map(wrong).collect();
        self.scratch.facing.wrong.extend(wrong);
    }

    /// Notes `piece` if it is on the wrong side.
    pub(super) fn check(&mut self, piece: [Corner; 3], part: Part) {
        let places = piece.map(|corner| corner.place(&self.volume.points, &self.body.inner));
        self.scratch.facing.wrong.extend(facing(piece, places, part, self.light));
    }

    /// Takes the lit pieces that were noted out of the light cap and the dark ones into it, but for those that are shaded anyway, and leads the silhouette
    /// round them.
    pub(super) fn move_over(&mut self) {
        let mut wrong = std::mem::take(&mut self.scratch.facing.wrong);
        if wrong.is_empty() {
            return;
        }
        let mut windings = std::mem::take(&mut self.scratch.facing.windings);
        windings.wind(self.volume, &self.body.loose_bounds(), self.light);
        let (points, inner) = (self.volume.points.as_slice(), self.body.inner.as_slice());
        let is_needed =
            |piece: &&[Corner; 3]| !windings.goes_round_all(piece.map(|corner| corner.place(points, inner)));
        let needed: Vec<[Corner; 3]> = wrong.par_iter().with_min_len(AT_ONCE).filter(is_needed).copied().collect();
        for piece in &needed {
            let [a, b, c] = piece.map(|corner| self.point_of(corner));
            self.volume.faces.push([a, b, c]);
            for side in [[a, b], [b, c], [c, a]] {
                let (edge, times) = undirected((side, 1));
                *self.scratch.facing.gained.entry(edge).or_default() += times;
            }
        }
        self.add_gained();
        wrong.clear();
        let facing = &mut self.scratch.facing;
        (facing.wrong, facing.windings) = (wrong, windings);
        facing.point_of_vertex.clear();
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
        let mut left: Vec<Walk> = gained.drain().filter(|&(_, times)| times != 0).collect();
        left.sort_unstable();
        for ([low, high], times) in left {
            let side = if times > 0 { [low, high] } else { [high, low] };
            self.volume.sides.extend(std::iter::repeat_n(side, times.unsigned_abs() as usize));
        }
    }

    fn point_of(&mut self, corner: Corner) -> u32 {
        match corner {
            Point(p) => p,
            Vertex(v) if self.body.inner[v as usize] == self.body.place_of_vertex(v) => self.vertex(v),
            Vertex(v) => *self.scratch.facing.point_of_vertex.entry(v).or_insert_with(|| {
                self.volume.points.push(self.body.inner[v as usize]);
                self.volume.points.len() as u32 - 1
            }),
        }
    }
}
