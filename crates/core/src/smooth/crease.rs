//! What a body's creases add to its volume: the silhouette runs along them where one side is lit and the other is not.

use glam::DVec3;
use rayon::prelude::*;

use super::AT_ONCE;
use super::added::{Added, Corner, Walk, undirected};
use super::body::{Crease, Side};
use super::crossing::{INSET, MOST_INSET};
use super::curve::Curve;
use super::cut::{Cutter, add_inner_points};
use super::facing::Part;
use super::volume::Smoothness;

/// A place along a crease, the corner there, and how often what is lit begins there less ends there, as the sides walk.
type Place = (f64, Corner, i32);

impl Cutter<'_> {
    pub(super) fn go_along_creases(&self) -> Vec<Added> {
        let go = |creases: &[Crease]| {
            let mut added = Added::default();
            creases.iter().for_each(|crease| self.go_along(crease, &mut added));
            added
        };
        self.body.creases.par_chunks(AT_ONCE).map(go).collect()
    }

    /// Whether the ends of an edge, the lower vertex first, are lit on that side of it.
    fn lit_ends(&self, side: &Side) -> [bool; 2] {
        self.body.ends(side.edge as usize).map(|w| self.is_turned(w))
    }

    /// What is lit on one side of a crease and not on the other: its part of the silhouette runs along the crease.
    fn go_along(&self, crease: &Crease, added: &mut Added) {
        let first = self.lit_ends(&crease.sides[0]);
        if first[0] == first[1] && crease.sides.iter().all(|side| self.lit_ends(side) == first) {
            return;
        }
        let [low, high] = crease.vertices.map(Corner::Vertex);
        let mut places: Vec<Place> = vec![(0.0, low, 0), (1.0, high, 0)];
        let mut left_over: Vec<Walk<Corner>> = Vec::new();
        for side in &crease.sides {
            let (e, direction) = (side.edge as usize, side.direction);
            let mut walk = |path: &[Corner]| left_over.extend(path.windows(2).map(|w| ([w[0], w[1]], direction)));
            match self.lit_ends(side) {
                [true, true] => {
                    walk(&[low, high]);
                    places[0].2 += direction;
                    places[1].2 -= direction;
                }
                [true, false] => {
                    let c = self.crossed(e);
                    walk(&[low, high, c.q, c.p]);
                    places[0].2 += direction;
                    places.push((c.at.u, c.p, -direction));
                }
                [false, true] => {
                    let c = self.crossed(e);
                    walk(&[c.p, c.q, low, high]);
                    places.push((c.at.u, c.p, direction));
                    places[1].2 -= direction;
                }
                [false, false] => {}
            }
        }
        // The crease's own ends stay the first and the last, whatever rounding has made of the others.
        places[2..].sort_by(|a, b| a.0.total_cmp(&b.0));
        places[1..].rotate_left(1);
        let first_run = left_over.len();
        self.add_runs(crease, &places, &mut left_over, added);
        added.faces.extend(cone(low, &left_over));
        if self.is_facing_checked() {
            self.check_crease(crease, [low, high], &left_over[first_run..], added);
        }
    }

    /// The pieces between the straight lines from corner to corner of the triangles at a crease, and the curve along it, which `runs` walk backward: on either
    /// side of the silhouette a cone from the lower end.
    ///
    /// Those on the wrong side of a crease that is longer than a shadow may be off go over as those of hollow places do: on which side of them the body is, they do
    /// not tell.
    fn check_crease(&self, crease: &Crease, [low, high]: [Corner; 2], runs: &[Walk<Corner>], added: &mut Added) {
        let [from, to] = crease.vertices.map(|v| self.body.place_of_vertex(v).as_dvec3());
        let is_seen = || self.is_seen(from.distance(to), from);
        let mut check = |[from, to]: [Corner; 2], times: i32, part: Part| {
            if from != low && to != low {
                let [from, to] = if times > 0 { [from, to] } else { [to, from] };
                // A crease with more than two sides may walk it several times, and has as many pieces there.
                for _ in 0..times.unsigned_abs() {
                    self.check([low, to, from], part, is_seen, added);
                }
            }
        };
        for &(walk, times) in runs {
            check(walk, times, Part::Lit);
            check(walk, -times, Part::Dark);
        }
        for side in &crease.sides {
            let [is_low_lit, is_high_lit] = self.lit_ends(side);
            if is_low_lit != is_high_lit {
                // What is between the lower end and the crossing is a straight line through the apex.
                let beyond = [self.crossed(side.edge as usize).p, high];
                check(beyond, side.direction, if is_high_lit { Part::Lit } else { Part::Dark });
            }
        }
    }

    /// The sides between `places` along the crease; they are taken from what is left over.
    fn add_runs(&self, crease: &Crease, places: &[Place], left_over: &mut Vec<Walk<Corner>>, added: &mut Added) {
        let e = crease.sides[0].edge as usize;
        let mut times = 0;
        for pair in places.windows(2) {
            times += pair[0].2;
            if times == 0 {
                continue;
            }
            let [(from, start, _), (to, end, _)] = [pair[0], pair[1]];
            added.curve.clear();
            added.curve.push(start);
            if let Smoothness::Smooth(precision) = self.smoothness {
                let curve = self.body.curve_of_edge(e);
                let pieces = curve.pieces([from, to], precision.chord_m(curve.start, self.light));
                if pieces > 1 {
                    let sunk = self.sunk(crease, &curve);
                    add_inner_points(&curve, [from, to], pieces, |u| sunk * (4.0 * u * (1.0 - u)), added);
                }
            }
            added.curve.push(end);
            for piece in added.curve.windows(2) {
                let [a, b] = [piece[0], piece[1]];
                let side = if times > 0 { [a, b] } else { [b, a] };
                added.sides.extend(std::iter::repeat_n(side, times.unsigned_abs() as usize));
                left_over.push(([a, b], -times));
            }
        }
    }

    /// By how much the middle of a crease is moved into the body: not at all but where the curve goes into it, along one of its faces, which would
    /// then lie in the fin.
    fn sunk(&self, crease: &Crease, curve: &Curve) -> DVec3 {
        let normals = crease.sides.iter().flat_map(|side| self.body.ends(side.edge as usize));
        let outward = normals.map(|w| self.body.normal(w)).sum::<DVec3>().normalize_or_zero();
        let chord_m = curve.start.distance(curve.end);
        let bulge_m = (curve.at(0.5) - curve.start.midpoint(curve.end)).dot(outward);
        if bulge_m < -1e-6 * chord_m {
            -outward * (INSET * chord_m).min(MOST_INSET * self.radius_m)
        } else {
            DVec3::ZERO
        }
    }
}

/// Faces from `apex` whose boundary takes away the cycle of `walks`.
fn cone(apex: Corner, walks: &[Walk<Corner>]) -> Vec<[Corner; 3]> {
    let mut edges: Vec<Walk<Corner>> =
        walks.iter().map(|&walk| undirected(walk)).filter(|([a, b], _)| a != b && *a != apex && *b != apex).collect();
    edges.sort_unstable();
    let mut faces = Vec::new();
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        let [a, b] = group[0].0;
        let times: i32 = group.iter().map(|(_, times)| times).sum();
        let face = if times > 0 { [apex, b, a] } else { [apex, a, b] };
        faces.extend(std::iter::repeat_n(face, times.unsigned_abs() as usize));
    }
    faces
}
