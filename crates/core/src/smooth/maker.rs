//! How a smooth volume is made: triangle by triangle, then crease by crease.
//!
//! [`super::volume`] has the picture.

use glam::DVec3;
use rayon::prelude::*;

use crate::{Edge, LightPosition};

use super::AT_ONCE;
use super::body::{Crease, Side, SmoothBody};
use super::crossing::{INSET, MOST_INSET, Solved, Solver};
use super::curve::Curve;
use super::facing::{Corner, FacingScratch, Part};
use super::straight::{StraightScratch, straighten};
use super::volume::{SmoothVolume, Smoothness};

/// What is needed while a volume is made; kept, so that none is asked for in each frame.
#[derive(Debug, Default, Clone)]
pub(super) struct SmoothScratch {
    found: Vec<[u32; 2]>,
    crossings: Vec<Crossing>,
    /// For each wedge edge its crossing; `NONE` but while a volume is made.
    crossing_of_edge: Vec<u32>,
    point_of_vertex: Vec<u32>,
    pub(super) curve: Vec<u32>,
    pub(super) facing: FacingScratch,
    straight: StraightScratch,
}

const NONE: u32 = u32::MAX;

/// From a point to another, so often.
pub(super) type Walk = ([u32; 2], i32);

/// Where the silhouette crosses a wedge edge.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    edge: u32,
    /// From the caster's lower vertex to the higher.
    u: f64,
    /// On the curve that the edge stands for.
    smooth: DVec3,
    normal: DVec3,
    /// Of [`SmoothVolume::points`].
    p: u32,
    q: u32,
}

impl SmoothVolume {
    /// [`SmoothVolume::new`] in the memory that there is.
    pub(super) fn make(
        &mut self,
        body: &SmoothBody,
        light: LightPosition,
        smoothness: &Smoothness,
        scratch: &mut SmoothScratch,
    ) {
        self.points.clear();
        self.sides.clear();
        self.faces.clear();
        self.folds.clear();
        self.vertices.clear();
        body.find(light, &mut self.turned, &mut scratch.found);
        scratch.crossing_of_edge.resize(body.wedges.topology.edges().len(), NONE);
        scratch.point_of_vertex.resize(body.vertex_of_wedge.len(), NONE);
        scratch.crossings.clear();
        let found = std::mem::take(&mut scratch.found);
        let mut maker = Maker { volume: self, body, light, smoothness, scratch, radius_m: body.wedges.bounds.radius() };
        maker.add_crossings(&found);
        maker.add_triangles();
        if maker.is_facing_checked() {
            maker.check_whole_triangles();
        }
        for crease in &body.creases {
            maker.add_crease(crease);
        }
        maker.move_over();
        if let Smoothness::Smooth(precision) = smoothness {
            straighten(self, light, precision, &mut scratch.straight);
        }
        for crossing in &scratch.crossings {
            scratch.crossing_of_edge[crossing.edge as usize] = NONE;
        }
        for &(vertex, _) in &self.vertices {
            scratch.point_of_vertex[vertex as usize] = NONE;
        }
        scratch.found = found;
    }
}

pub(super) struct Maker<'a> {
    pub(super) volume: &'a mut SmoothVolume,
    pub(super) body: &'a SmoothBody,
    pub(super) light: LightPosition,
    smoothness: &'a Smoothness,
    pub(super) scratch: &'a mut SmoothScratch,
    radius_m: f64,
}

impl Maker<'_> {
    fn is_turned(&self, w: u32) -> bool {
        self.volume.turned[w as usize] > 0
    }

    /// Whether all that is lit is to face the light. On the mesh itself, that would make the silhouette the discrete one.
    fn is_facing_checked(&self) -> bool {
        matches!(self.smoothness, Smoothness::Smooth(_))
    }

    /// The triangles at the edges that are crossed.
    fn add_triangles(&mut self) {
        let topology = &self.body.wedges.topology;
        for i in 0..self.scratch.crossings.len() {
            let e = self.scratch.crossings[i].edge as usize;
            let Edge { low, high } = topology.edges()[e];
            let is_upward = self.is_turned(low);
            let turned = if is_upward { low } else { high };
            for (t, direction) in topology.triangles_on_edge(e) {
                // Each triangle that the silhouette crosses is left by it once, over an edge that goes from light to dark.
                if (direction > 0) == is_upward {
                    self.add_triangle(t, e, turned);
                }
            }
        }
    }

    /// Triangle `t`, whose edge `exit` goes from `turned` to a wedge that is not.
    fn add_triangle(&mut self, t: usize, exit: usize, turned: u32) {
        let corners = self.body.wedges.mesh.triangles()[t];
        let k = corners.iter().position(|&w| w == turned).expect("the edge is the triangle's");
        let [first, second, third] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let has_two_turned = self.is_turned(third);
        let entry = if has_two_turned { [second, third] } else { [third, first] };
        let entry = self.body.wedges.topology.edge_between(entry[0], entry[1]).expect("the edge is the triangle's");
        let (a, b) = (self.crossing(exit), self.crossing(entry));
        // The edge that is not crossed, in the direction of the curve.
        let beside = [if has_two_turned { first } else { second }, third];
        self.add_curve(a, b, beside);
        if self.is_facing_checked() {
            self.check_pieces([first, second, third], has_two_turned);
        }
        let dark = [third, second].map(|w| self.vertex(self.body.vertex_of_wedge[w as usize]));
        // The cycle from the fin's foot at the exit, along the curve, down to the fold, and back along the dark corners.
        let foot = a.q;
        for i in 1..self.scratch.curve.len() {
            let [from, to] = [self.scratch.curve[i - 1], self.scratch.curve[i]];
            self.volume.sides.push([from, to]);
            self.volume.faces.push([foot, from, to]);
        }
        self.volume.faces.push([foot, b.p, b.q]);
        if has_two_turned {
            self.volume.folds.push([foot, b.q, dark[1]]);
        } else {
            self.volume.folds.extend([[foot, b.q, dark[0]], [foot, dark[0], dark[1]]]);
        }
    }

    /// The points from `a` to `b`, both with, become the scratch's curve; `beside` are the ends of the third edge of their triangle.
    fn add_curve(&mut self, a: Crossing, b: Crossing, beside: [u32; 2]) {
        self.scratch.curve.clear();
        self.scratch.curve.push(a.p);
        if let Smoothness::Smooth(precision) = self.smoothness {
            let curve = Curve::on_surface(a.smooth, b.smooth, [a.normal, b.normal]);
            let crease = self.crease_beside(beside);
            let nearness = [self.nearness(a, beside[0]), self.nearness(b, beside[1])];
            let moved = |u: f64| {
                // The surface bends with the crease at its border, of which normals say nothing; else one could cross the other.
                crease.map_or(DVec3::ZERO, |crease| crease.bulge(u) * (nearness[0] + (nearness[1] - nearness[0]) * u))
            };
            let pieces = curve.pieces([0.0, 1.0], precision.chord_m(a.smooth, self.light));
            let beside_pieces =
                crease.map_or(1, |crease| crease.pieces([0.0, 1.0], precision.chord_m(a.smooth, self.light)));
            self.add_inner_points(&curve, [0.0, 1.0], pieces.max(beside_pieces), moved);
        }
        self.scratch.curve.push(b.p);
    }

    /// The curve between two wedges, from the first to the second, if that is a crease.
    fn crease_beside(&self, [from, to]: [u32; 2]) -> Option<Curve> {
        let e = self.body.wedges.topology.edge_between(from, to)?;
        let curve = self.body.crease_curve(e)?;
        Some(if self.body.ends(e)[0] == from { curve } else { curve.reversed() })
    }

    /// 1 where a crossing is at wedge `w`, an end of its edge, and 0 where it is at the other end.
    fn nearness(&self, crossing: Crossing, w: u32) -> f64 {
        if self.body.ends(crossing.edge as usize)[0] == w { 1.0 - crossing.u } else { crossing.u }
    }

    /// Points of `curve` between `ends`, so that there are so many `pieces`, each moved by `moved`, are added to the scratch's curve.
    fn add_inner_points(&mut self, curve: &Curve, ends: [f64; 2], pieces: u32, moved: impl Fn(f64) -> DVec3) {
        for i in 1..pieces {
            let u = ends[0] + (ends[1] - ends[0]) * f64::from(i) / f64::from(pieces);
            let p = self.point(curve.at(u) + moved(u));
            self.scratch.curve.push(p);
        }
    }

    /// The crossing of wedge edge `e`, one of whose ends is turned to the light.
    fn crossing(&mut self, e: usize) -> Crossing {
        let known = self.scratch.crossing_of_edge[e];
        if known != NONE {
            return self.scratch.crossings[known as usize];
        }
        let solved = self.solver().solve(e);
        self.add_crossing(solved)
    }

    fn solver(&self) -> Solver<'_> {
        let Self { body, light, smoothness, radius_m, .. } = *self;
        Solver { body, light, smoothness, radius_m }
    }

    fn add_crossing(&mut self, Solved { edge, u, smooth, normal, foot }: Solved) -> Crossing {
        let (p, q) = (self.point(smooth), self.point(foot));
        let crossing = Crossing { edge, u, smooth, normal, p, q };
        self.scratch.crossing_of_edge[edge as usize] = self.scratch.crossings.len() as u32;
        self.scratch.crossings.push(crossing);
        crossing
    }

    /// The crossings of all edges that were `found`: most of what a volume takes, and each is found for itself.
    fn add_crossings(&mut self, found: &[[u32; 2]]) {
        let solver = self.solver();
        let edge = |&[turned, other]: &[u32; 2]| solver.body.wedges.topology.edge_between(turned, other);
        let solved = found.par_iter().with_min_len(AT_ONCE).filter_map(edge).map(|e| solver.solve(e));
        for solved in solved.collect::<Vec<Solved>>() {
            self.add_crossing(solved);
        }
    }

    fn point(&mut self, place: DVec3) -> u32 {
        self.volume.points.push(place.as_vec3());
        self.volume.points.len() as u32 - 1
    }

    /// The point that is vertex `v` of the caster, of which `wedge` is one.
    pub(super) fn vertex(&mut self, v: u32) -> u32 {
        let known = self.scratch.point_of_vertex[v as usize];
        if known != NONE {
            return known;
        }
        let p = self.volume.points.len() as u32;
        self.volume.points.push(self.body.place_of_vertex(v));
        self.volume.vertices.push((v, p));
        self.scratch.point_of_vertex[v as usize] = p;
        p
    }

    /// Whether the ends of an edge, the lower vertex first, are lit on that side of it.
    fn lit_ends(&self, side: &Side) -> [bool; 2] {
        self.body.ends(side.edge as usize).map(|w| self.is_turned(w))
    }

    /// What is lit on one side of a crease and not on the other: its part of the silhouette runs along the crease.
    fn add_crease(&mut self, crease: &Crease) {
        let first = self.lit_ends(&crease.sides[0]);
        if first[0] == first[1] && crease.sides.iter().all(|side| self.lit_ends(side) == first) {
            return;
        }
        let [low, high] = crease.vertices.map(|v| self.vertex(v));
        // Places along the crease in order, and how often what is lit begins there less ends there, as the sides walk.
        let mut places: Vec<(f64, u32, i32)> = vec![(0.0, low, 0), (1.0, high, 0)];
        let mut left_over: Vec<Walk> = Vec::new();
        for side in &crease.sides {
            let (e, direction) = (side.edge, side.direction);
            let mut walk = |path: &[u32]| left_over.extend(path.windows(2).map(|w| ([w[0], w[1]], direction)));
            match self.lit_ends(side) {
                [true, true] => {
                    walk(&[low, high]);
                    places[0].2 += direction;
                    places[1].2 -= direction;
                }
                [true, false] => {
                    let c = self.crossing(e as usize);
                    walk(&[low, high, c.q, c.p]);
                    places[0].2 += direction;
                    places.push((c.u, c.p, -direction));
                }
                [false, true] => {
                    let c = self.crossing(e as usize);
                    walk(&[c.p, c.q, low, high]);
                    places.push((c.u, c.p, direction));
                    places[1].2 -= direction;
                }
                [false, false] => {}
            }
        }
        // The crease's own ends stay the first and the last, whatever rounding has made of the others.
        places[2..].sort_by(|a, b| a.0.total_cmp(&b.0));
        places[1..].rotate_left(1);
        let first_run = left_over.len();
        self.add_runs(crease, &places, &mut left_over);
        self.volume.faces.extend(cone(low, &left_over));
        if self.is_facing_checked() {
            self.check_crease(crease, [low, high], &left_over[first_run..]);
        }
    }

    /// The pieces between the straight lines from corner to corner of the triangles at a crease, and the curve along it, which `runs` walk backward: on either
    /// side of the silhouette a cone from the lower end.
    fn check_crease(&mut self, crease: &Crease, [low, high]: [u32; 2], runs: &[Walk]) {
        let check = |maker: &mut Self, [from, to]: [u32; 2], times: i32, part: Part| {
            if from != low && to != low {
                let [from, to] = if times > 0 { [from, to] } else { [to, from] };
                // A crease with more than two sides may walk it several times, and has as many pieces there.
                for _ in 0..times.unsigned_abs() {
                    maker.check([low, to, from].map(Corner::Point), part);
                }
            }
        };
        for &(walk, times) in runs {
            check(self, walk, times, Part::Lit);
            check(self, walk, -times, Part::Dark);
        }
        for side in &crease.sides {
            let [is_low_lit, is_high_lit] = self.lit_ends(side);
            if is_low_lit != is_high_lit {
                // What is between the lower end and the crossing is a straight line through the apex.
                let beyond = [self.crossing(side.edge as usize).p, high];
                check(self, beyond, side.direction, if is_high_lit { Part::Lit } else { Part::Dark });
            }
        }
    }

    /// The sides between `places` along the crease; they are taken from what is left over.
    fn add_runs(&mut self, crease: &Crease, places: &[(f64, u32, i32)], left_over: &mut Vec<Walk>) {
        let e = crease.sides[0].edge as usize;
        let mut times = 0;
        for pair in places.windows(2) {
            times += pair[0].2;
            if times == 0 {
                continue;
            }
            let [(from, start, _), (to, end, _)] = [pair[0], pair[1]];
            self.scratch.curve.clear();
            self.scratch.curve.push(start);
            if let Smoothness::Smooth(precision) = self.smoothness {
                let curve = self.body.curve_of_edge(e);
                let sunk = self.sunk(crease, &curve);
                let pieces = curve.pieces([from, to], precision.chord_m(curve.start, self.light));
                self.add_inner_points(&curve, [from, to], pieces, |u| sunk * (4.0 * u * (1.0 - u)));
            }
            self.scratch.curve.push(end);
            for i in 1..self.scratch.curve.len() {
                let [a, b] = [self.scratch.curve[i - 1], self.scratch.curve[i]];
                let side = if times > 0 { [a, b] } else { [b, a] };
                self.volume.sides.extend(std::iter::repeat_n(side, times.unsigned_abs() as usize));
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

/// The same walk from the lower point to the higher.
pub(super) fn undirected(([a, b], times): Walk) -> Walk {
    if a < b { ([a, b], times) } else { ([b, a], -times) }
}

/// Faces from `apex` whose boundary takes away the cycle of `walks`.
fn cone(apex: u32, walks: &[Walk]) -> Vec<[u32; 3]> {
    let mut edges: Vec<Walk> =
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
