//! A caster as a smooth body: its surface split at creases, once for all lights.
//!
//! ```text
//!    A vertex with several normals becomes as many wedges. An edge over which the surface is smooth is
//!    one edge between wedges; a crease is two, one for each side, with the same two ends.
//!
//!         . n1                   ____ wedge edge of the upper side
//!         |  ___ n2   crease    ____  wedge edge of the right side
//!    -----+'
//!         |
//! ```

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{Bounds, Caster, Edge, LightPosition, Mesh, NormalFinder, Surface, Topology};

use super::curve::Curve;
use super::normals::{has_outside, is_flat};
use super::planes::Planes;

/// Normals closer than this are one: below what rounding to `f32` leaves of them.
const SAME_NORMAL: f32 = 1e-5;

/// Normals with less than this sine between them have no common tangent of their own.
const NEARLY_PARALLEL: f64 = 1e-3;

/// A crease may bend into the triangles beside it by this part of their height: else the silhouette of one that is thin and flat would turn inside out.
const MOST_INWARD: f64 = 0.2;

/// Curves are nowhere farther from the mesh than this many times its longest edge. A cubic whose tangents are at most twice as long as its chord is within
/// half of that of it; what lies between the curves of two edges has a chord of at most two edges, so that it is within one of that, and may be moved by half as
/// a crease beside it bends; and a tenth is for insets and rounding.
pub(super) const MOST_BULGE: f64 = 2.1;

/// A caster whose silhouettes are those of a smooth surface through its vertices.
#[derive(Debug, Clone)]
pub struct SmoothBody {
    /// The mesh split at creases: vertices are wedges, triangles are the caster's.
    pub(super) wedges: Caster,
    pub(super) vertex_of_wedge: Vec<u32>,
    /// One of those of each vertex.
    pub(super) wedge_of_vertex: Vec<u32>,
    /// Unit length or 0, scene space, of each wedge.
    pub(super) normals: Vec<Vec3>,
    /// How each wedge edge is bent.
    pub(super) bends: Vec<Bend>,
    pub(super) creases: Vec<Crease>,
    /// Of each crease, from its lower vertex to the higher: they take longer to find than others, and several edges ask for one.
    pub(super) crease_curves: Vec<Curve>,
    /// None where the body has moved: then each wedge and edge is looked at.
    pub(super) finder: Option<NormalFinder>,
    /// None where the body has moved: then each triangle is looked at.
    pub(super) planes: Option<Planes>,
    pub(super) longest_edge_m: f64,
    /// Of each vertex of the caster: where pieces of the surface have it that must face the light, or not.
    pub(super) inner: Vec<Vec3>,
}

/// How an edge between wedges is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bend {
    /// The surface goes on over it.
    Smooth,
    /// One side of this crease, which has two.
    Crease(u32),
    /// More than two triangles meet there, and nothing is known.
    Straight,
}

/// An edge of the caster whose sides have different normals.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Crease {
    /// Of the caster, the lower first.
    pub(super) vertices: [u32; 2],
    pub(super) sides: Vec<Side>,
}

/// One triangle at an edge of the caster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Side {
    pub(super) triangle: u32,
    pub(super) edge: u32,
    /// +1 where the triangle walks from the edge's lower vertex to the higher, else -1.
    pub(super) direction: i32,
}

/// Why a caster has no smooth silhouettes; it casts the exact shadow of its triangles then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotSmooth {
    /// A component is open, or its triangles are not wound consistently: it has no outside.
    #[error("its surface is not closed, or its faces are not wound alike")]
    Open,
    /// What its triangles enclose is outside of it: it is turned inside out.
    #[error("its surface is turned inside out")]
    InsideOut,
    /// Every normal is its triangle's.
    #[error("its faces are flat")]
    Flat,
    /// Something behind it may be seen through it.
    #[error("it is glass or has cut-outs")]
    SeeThrough,
}

impl SmoothBody {
    /// `caster` with `normals` for the corners of its triangles, unit length, scene space (see [`super::corner_normals`]).
    ///
    /// Takes about two microseconds a triangle, and 280 bytes.
    ///
    /// # Errors
    ///
    /// [`NotSmooth`], if the caster is better off with its discrete silhouette.
    ///
    /// # Panics
    ///
    /// If there are not as many normals as triangles.
    pub fn new(caster: &Caster, normals: &[[Vec3; 3]]) -> Result<Self, NotSmooth> {
        let triangles = caster.mesh.triangles();
        assert_eq!(normals.len(), triangles.len(), "each triangle has three normals");
        if caster.role.is_see_through() {
            return Err(NotSmooth::SeeThrough);
        }
        if !has_outside(&caster.topology) {
            return Err(NotSmooth::Open);
        }
        if volume_m3(caster) < 0.0 {
            return Err(NotSmooth::InsideOut);
        }
        if normals.iter().enumerate().all(|(t, corners)| is_flat(caster, t, corners)) {
            return Err(NotSmooth::Flat);
        }
        let split = Split::new(caster, normals);
        let wedges = split.caster(caster);
        let (bends, creases) = find_creases(caster, &wedges.topology, &split.vertex_of_wedge);
        let finder = Some(NormalFinder::new(&wedges, &split.normals));
        let Split { vertex_of_wedge, normals, .. } = split;
        let mut wedge_of_vertex = vec![0; caster.positions.len()];
        for (&v, w) in vertex_of_wedge.iter().zip(0..) {
            wedge_of_vertex[v as usize] = w;
        }
        let longest_edge_m = longest_edge_m(&wedges);
        let (crease_curves, inner) = (Vec::new(), Vec::new());
        let mut body = Self {
            wedges,
            vertex_of_wedge,
            wedge_of_vertex,
            normals,
            bends,
            creases,
            crease_curves,
            finder,
            planes: None,
            longest_edge_m,
            inner,
        };
        body.bend();
        body.planes = Some(Planes::new(&body));
        Ok(body)
    }

    /// Where wedge `w` is, scene space.
    pub(super) fn place(&self, w: u32) -> DVec3 {
        self.wedges.positions[w as usize].as_dvec3()
    }

    /// Where vertex `v` of the caster is.
    pub(super) fn place_of_vertex(&self, v: u32) -> Vec3 {
        self.wedges.positions[self.wedge_of_vertex[v as usize] as usize]
    }

    pub(super) fn normal(&self, w: u32) -> DVec3 {
        self.normals[w as usize].as_dvec3()
    }

    /// How far `light` is above the tangent plane of wedge `w`, times its distance if it has one: n.(l - v).
    pub(super) fn height(&self, w: u32, light: LightPosition) -> f64 {
        self.normal(w).dot(light.offset_from(self.place(w)))
    }

    /// The wedges at the ends of wedge edge `e`, in the order of the caster's vertices.
    pub(super) fn ends(&self, e: usize) -> [u32; 2] {
        let edge = self.wedges.topology.edges()[e];
        let [low, high] = [edge.low, edge.high];
        let is_turned = self.vertex_of_wedge[low as usize] > self.vertex_of_wedge[high as usize];
        if is_turned { [high, low] } else { [low, high] }
    }

    /// The curve that wedge edge `e` stands for, from its lower vertex of the caster to the higher; the same for both sides of a crease.
    pub(super) fn curve_of_edge(&self, e: usize) -> Curve {
        let ends = self.ends(e);
        let [start, end] = ends.map(|w| self.place(w));
        match self.bends[e] {
            Bend::Straight => Curve::straight(start, end),
            Bend::Smooth => Curve::on_surface(start, end, ends.map(|w| self.normal(w))),
            Bend::Crease(crease) => self.crease_curves[crease as usize],
        }
    }

    /// Finds what follows from where wedges and their normals are.
    pub(super) fn bend(&mut self) {
        self.crease_curves = self.creases.par_iter().map(|crease| self.curve_along(crease)).collect();
        self.inner = self.inner_places();
    }

    fn curve_along(&self, crease: &Crease) -> Curve {
        let [a, b] = crease.sides[..] else {
            let [start, end] = crease.vertices.map(|v| self.place_of_vertex(v).as_dvec3());
            return Curve::straight(start, end);
        };
        let edges = [a, b].map(|side| side.edge as usize);
        let [ends, others] = edges.map(|e| self.ends(e));
        let [start, end] = ends.map(|w| self.place(w));
        let chord = end - start;
        let direction = |i: usize| {
            let (a, b) = (self.normal(ends[i]), self.normal(others[i]));
            let along = a.cross(b);
            if along.length() > NEARLY_PARALLEL { along * along.dot(chord).signum() } else { chord - a * a.dot(chord) }
        };
        let curve = Curve::along(start, end, [direction(0), direction(1)]);
        let heights = edges.into_iter().filter_map(|e| self.height_over(e, start, end));
        curve.flattened(heights.map(|inward| curve.share_within(inward * MOST_INWARD)).fold(1.0, f64::min))
    }

    /// The curve of wedge edge `e` if it is one side of a crease.
    pub(super) fn crease_curve(&self, e: usize) -> Option<Curve> {
        matches!(self.bends[e], Bend::Crease(_)).then(|| self.curve_of_edge(e))
    }

    /// From wedge edge `e`, which is from `start` to `end`, at a right angle to the third corner of its triangle.
    fn height_over(&self, e: usize, start: DVec3, end: DVec3) -> Option<DVec3> {
        let (t, _) = self.wedges.topology.triangles_on_edge(e).next()?;
        let edge = self.wedges.topology.edges()[e];
        let third = self.wedges.mesh.triangles()[t].into_iter().find(|&w| w != edge.low && w != edge.high)?;
        let (chord, off) = (end - start, self.place(third) - start);
        Some(off - chord * (off.dot(chord) / chord.length_squared().max(f64::MIN_POSITIVE)))
    }

    /// A box that holds every curve of the body, on edges and between them.
    pub fn loose_bounds(&self) -> Bounds {
        let bounds = self.wedges.bounds;
        let grown = DVec3::splat(MOST_BULGE * self.longest_edge_m);
        Bounds { min: bounds.min - grown, max: bounds.max + grown }
    }

    /// Bytes that this takes.
    pub fn bytes(&self) -> usize {
        let edges = self.wedges.topology.edges().len();
        size_of_val(self.vertex_of_wedge.as_slice())
            + 2 * size_of_val(self.normals.as_slice())
            + size_of_val(self.inner.as_slice())
            + edges * (size_of::<Bend>() + if self.finder.is_some() { 94 } else { 24 })
            + self.planes.as_ref().map_or(0, Planes::bytes)
            + self.wedges.mesh.triangles().len() * 56
            + self.creases.len() * (size_of::<Crease>() + size_of::<Curve>() + 16)
    }
}

/// The longest edge of `caster`.
pub(super) fn longest_edge_m(caster: &Caster) -> f64 {
    let length_m = |e: &Edge| caster.positions[e.low as usize].distance(caster.positions[e.high as usize]);
    caster.topology.edges().iter().map(length_m).fold(0.0, f32::max).into()
}

/// The triangles at wedge edge `e`.
pub(super) fn sides_of(wedges: &Topology, vertex_of_wedge: &[u32], e: u32) -> impl Iterator<Item = Side> {
    let edge = wedges.edges()[e as usize];
    let is_turned = vertex_of_wedge[edge.low as usize] > vertex_of_wedge[edge.high as usize];
    let turn = if is_turned { -1 } else { 1 };
    let side = move |(t, direction)| Side { triangle: t as u32, edge: e, direction: turn * direction };
    wedges.triangles_on_edge(e as usize).map(side)
}

/// What the triangles of `caster` enclose, less cavities; below 0 where they are wound the wrong way round.
fn volume_m3(caster: &Caster) -> f64 {
    let middle = caster.bounds.center();
    let of = |t| {
        let [a, b, c] = caster.corners(t).map(|p| p.as_dvec3() - middle);
        a.dot(b.cross(c)) / 6.0
    };
    (0..caster.mesh.triangles().len()).map(of).sum()
}

/// Wedges as they are found.
struct Split {
    triangles: Vec<[u32; 3]>,
    vertex_of_wedge: Vec<u32>,
    normals: Vec<Vec3>,
}

impl Split {
    /// In the order in which triangles first use them, which is that of a mesh's vertices.
    fn new(caster: &Caster, corner_normals: &[[Vec3; 3]]) -> Self {
        let mut split = Self { triangles: Vec::new(), vertex_of_wedge: Vec::new(), normals: Vec::new() };
        let mut wedges_of_vertex: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for (corners, normals) in caster.mesh.triangles().iter().zip(corner_normals) {
            split.triangles.push(std::array::from_fn(|i| {
                let known = wedges_of_vertex.entry(corners[i]).or_default();
                let is_same = |&&w: &&u32| split.normals[w as usize].distance(normals[i]) <= SAME_NORMAL;
                if let Some(&w) = known.iter().find(is_same) {
                    return w;
                }
                let w = split.normals.len() as u32;
                known.push(w);
                split.vertex_of_wedge.push(corners[i]);
                split.normals.push(normals[i]);
                w
            }));
        }
        split
    }

    fn caster(&self, whole: &Caster) -> Caster {
        let positions: Vec<Vec3> = self.vertex_of_wedge.iter().map(|&v| whole.positions[v as usize]).collect();
        let surface = Surface {
            positions: positions.clone(),
            triangles: self.triangles.clone(),
            // Nothing is welded: what is at one place is kept apart on purpose.
            weld_keys: (0..positions.len() as u32).collect(),
            ..Surface::default()
        };
        let mesh = Arc::new(Mesh::new(surface).expect("a mesh split at creases is as good as it was"));
        debug_assert_eq!(mesh.triangles(), self.triangles, "wedges are in the order in which triangles use them");
        let topology = Arc::new(Topology::new(&mesh));
        Caster { mesh, topology, positions, ..whole.clone() }
    }
}

/// How each wedge edge is bent, and the creases in the order of the caster's edges.
fn find_creases(caster: &Caster, wedges: &Topology, vertex_of_wedge: &[u32]) -> (Vec<Bend>, Vec<Crease>) {
    let mut keyed: Vec<([u32; 2], u32)> = wedges
        .edges()
        .iter()
        .zip(0..)
        .map(|(edge, e)| {
            let [a, b] = [edge.low, edge.high].map(|w| vertex_of_wedge[w as usize]);
            ([a.min(b), a.max(b)], e)
        })
        .collect();
    keyed.sort_unstable();
    debug_assert!(keyed.len() >= caster.topology.edges().len());
    let mut bends = vec![Bend::Straight; keyed.len()];
    let mut creases = Vec::new();
    for group in keyed.chunk_by(|a, b| a.0 == b.0) {
        let vertices = group[0].0;
        let mut sides = Vec::new();
        for &(_, e) in group {
            sides.extend(sides_of(wedges, vertex_of_wedge, e));
        }
        match (group, sides.len()) {
            ([(_, e)], 2) => bends[*e as usize] = Bend::Smooth,
            (&[(_, a), (_, b)], 2) => {
                [a, b].into_iter().for_each(|e| bends[e as usize] = Bend::Crease(creases.len() as u32));
            }
            _ => {}
        }
        if group.len() > 1 {
            creases.push(Crease { vertices, sides });
        }
    }
    (bends, creases)
}
