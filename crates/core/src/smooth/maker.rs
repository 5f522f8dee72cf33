//! How a smooth volume is made: crossings first, then triangles and creases on all threads, then what goes over.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::LightPosition;

use super::AT_ONCE;
use super::added::{Added, Corner};
use super::body::SmoothBody;
use super::crossing::{Crossing, Solver};
use super::cut::Cutter;
use super::facing::FacingScratch;
use super::fins::Fins;
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
    pub(super) facing: FacingScratch,
    fins: Fins,
    straight: StraightScratch,
}

const NONE: u32 = u32::MAX;

impl SmoothVolume {
    /// What [`SmoothVolume::new`] adds to nothing, with the `scratch` that there is.
    pub(super) fn make(
        &mut self,
        body: &SmoothBody,
        light: LightPosition,
        smoothness: &Smoothness,
        scratch: &mut SmoothScratch,
    ) {
        scratch.fins.clear();
        body.find(light, &mut self.turned, &mut scratch.found);
        // Neighbours one after another: what is known of them is side by side in memory.
        scratch.found.sort_unstable();
        scratch.crossing_of_edge.resize(body.wedges.topology.edges().len(), NONE);
        scratch.point_of_vertex.resize(body.vertex_of_wedge.len(), NONE);
        let mut maker = Maker { volume: self, body, light, scratch };
        maker.add_crossings(smoothness);
        maker.add_surface(smoothness);
        maker.move_over();
        scratch.fins.link(scratch.crossings.len());
        if let Smoothness::Smooth(precision) = smoothness {
            straighten(self, &mut scratch.fins, light, precision, &mut scratch.straight);
        }
        scratch.fins.add_to(self);
        for crossing in &scratch.crossings {
            scratch.crossing_of_edge[crossing.edge as usize] = NONE;
        }
        for &(vertex, _) in &self.vertices {
            scratch.point_of_vertex[vertex as usize] = NONE;
        }
    }
}

pub(super) struct Maker<'a> {
    pub(super) volume: &'a mut SmoothVolume,
    pub(super) body: &'a SmoothBody,
    pub(super) light: LightPosition,
    pub(super) scratch: &'a mut SmoothScratch,
}

impl Maker<'_> {
    /// The crossings of all edges that were found, each found for itself, and their points.
    fn add_crossings(&mut self, smoothness: &Smoothness) {
        let (body, light) = (self.body, self.light);
        let solver = Solver { body, light, smoothness, radius_m: body.wedges.bounds.radius() };
        let SmoothScratch { found, crossings, crossing_of_edge, .. } = &mut *self.scratch;
        let solve = |&[turned, other]: &[u32; 2]| {
            let e = body.wedges.topology.edge_between(turned, other);
            solver.solve(e.expect("what is found are edges"))
        };
        found.par_iter().with_min_len(AT_ONCE).map(solve).collect_into_vec(crossings);
        for (crossing, number) in crossings.iter().zip(0..) {
            crossing_of_edge[crossing.edge as usize] = number;
            self.volume.points.extend([crossing.smooth, crossing.foot].map(DVec3::as_vec3));
        }
    }

    /// What the surface adds on either side of the silhouette.
    fn add_surface(&mut self, smoothness: &Smoothness) {
        let cutter = Cutter {
            body: self.body,
            light: self.light,
            smoothness,
            radius_m: self.body.wedges.bounds.radius(),
            turned: &self.volume.turned,
            crossings: &self.scratch.crossings,
            crossing_of_edge: &self.scratch.crossing_of_edge,
            points: &self.volume.points,
        };
        let beside_cuts = || rayon::join(|| cutter.go_along_creases(), || cutter.look_at_whole_triangles());
        let (cuts, (creases, whole)) = rayon::join(|| cutter.cut_triangles(), beside_cuts);
        for added in cuts.iter().chain(&creases).chain(&whole) {
            self.add(added);
        }
    }

    fn add(&mut self, added: &Added) {
        let first = self.volume.points.len() as u32;
        self.volume.points.extend(&added.points);
        for side in &added.sides {
            let side = side.map(|corner| self.point_of(corner, first));
            self.volume.sides.push(side);
        }
        for face in &added.faces {
            let face = face.map(|corner| self.point_of(corner, first));
            self.volume.faces.push(face);
        }
        for fold in &added.folds {
            let fold = fold.map(|corner| self.point_of(corner, first));
            self.volume.folds.push(fold);
        }
        let renamed = |corner| if let Corner::Own(p) = corner { Corner::Point(first + p) } else { corner };
        self.scratch.fins.extend(&added.fins);
        let wrong = &mut self.scratch.facing.wrong;
        wrong.hollow.extend(added.wrong.hollow.iter().map(|piece| piece.map(renamed)));
        wrong.others.extend(added.wrong.others.iter().map(|piece| piece.map(renamed)));
        self.volume.may_be_away.extend(&added.may_be_away);
    }

    /// The point that is `corner`, where points that are added begin at `first`.
    pub(super) fn point_of(&mut self, corner: Corner, first: u32) -> u32 {
        match corner {
            Corner::Point(p) => p,
            Corner::Own(p) => first + p,
            Corner::Vertex(v) => self.vertex(v),
            Corner::Inner(v) => self.inner(v),
        }
    }

    fn vertex(&mut self, v: u32) -> u32 {
        let known = self.scratch.point_of_vertex[v as usize];
        if known != NONE {
            return known;
        }
        let p = self.point(self.body.place_of_vertex(v));
        self.volume.vertices.push((v, p));
        self.scratch.point_of_vertex[v as usize] = p;
        p
    }

    fn inner(&mut self, v: u32) -> u32 {
        let place = self.body.inner[v as usize];
        if place == self.body.place_of_vertex(v) {
            return self.vertex(v);
        }
        let points = &mut self.volume.points;
        *self.scratch.facing.point_of_inner.entry(v).or_insert_with(|| {
            points.push(place);
            points.len() as u32 - 1
        })
    }

    fn point(&mut self, place: Vec3) -> u32 {
        self.volume.points.push(place);
        self.volume.points.len() as u32 - 1
    }
}
