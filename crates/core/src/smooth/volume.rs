//! The shadow volume of a smooth body: extruded from its smooth silhouette, closed where that leaves the mesh.
//!
//! ```text
//!            p0 ----- p1 ----- p2          a triangle with a corner d that is turned away from the light. It is
//!           /|  fin        .-'/            in the light cap as a whole; the fold takes away what lies behind
//!     lit  / | . - ' - '     / lit         the accurate silhouette (q0 .. q2, moved into the body a little),
//!         q0 ---------------q2             the fin rises from there to the smooth silhouette (p0 p1 p2),
//!           \     fold     /               and from that the sides go to infinity. Its neighbours share
//!             \          /                 the path d, q0, p0 and the path p2, q2, d.
//!               \      /
//!                  d
//! ```
//!
//! Light cap, folds and fins together have the smooth silhouette as their boundary, whatever the normals and the rounding: each closes a cycle of
//! directed edges that its neighbours walk the other way. So the volume is closed, on any closed mesh.
//!
//! Source: O. Mattausch et al. 2012, section 4. Departures: the light cap has whole triangles, those with any corner turned to the light, so that it covers the very
//! pixels that the surface covers; what is between it and the accurate silhouette is dark by its normals, whatever is counted there. One triangle fans over
//! each fin, where the paper has a strip to a point of the accurate silhouette for each one of the smooth. The paper's offset of 0.15 against light leaks
//! is here a part of the edge's length, and of the fold alone: the smooth silhouette stays where it is.

use std::cell::RefCell;

use glam::Vec3;
use rayon::prelude::*;

use crate::{Bounds, Caster, Chain, LightPosition, ShadowVolume, Stack, most_overlaps_of, needs_light_cap};

use super::AT_ONCE;
use super::body::SmoothBody;
use super::maker::SmoothScratch;
use super::precision::Precision;

/// With a cosine to the light below this, a triangle may be turned away for all that `f32` can tell.
const EDGE_ON: f32 = 1e-5;

/// Which silhouette a volume is extruded from: the curves of Mattausch et al. 2012, or what they start from.
#[derive(Debug, Clone, PartialEq)]
pub enum Smoothness {
    /// Where normals interpolated along the mesh's edges turn away from the light; on the mesh itself (A. Hertzmann and D. Zorin 2000).
    Accurate,
    /// Moved onto the curved surface that the normals tell of, and cut as finely as that is curved.
    Smooth(Precision),
}

/// What is extruded and what closes it, in points of its own.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SmoothVolume {
    /// Scene space; what the others are made of. Some are vertices of the caster.
    pub points: Vec<Vec3>,
    /// The silhouette, each piece as the lit side walks it. As many arrive at a point as leave it.
    pub sides: Vec<[u32; 2]>,
    /// Fins, and what goes over to the other side of the silhouette.
    pub faces: Vec<[u32; 3]>,
    /// What is within the body, where nothing is seen: z-pass needs none of it.
    pub folds: Vec<[u32; 3]>,
    /// Vertices of the caster that are among the points, and which they are.
    pub vertices: Vec<(u32, u32)>,
    /// Of each wedge, 1 where it is turned to the light, else 0; then padding.
    pub(super) turned: Vec<i8>,
    /// Among these are all the triangles of the light cap that show the light their backs: those that the silhouette cuts, and some more.
    pub(super) may_be_away: Vec<u32>,
}

thread_local! {
    /// Its tables are as large as meshes, and what is left in them is nothing: each thread keeps one.
    static SCRATCH: RefCell<SmoothScratch> = RefCell::default();
}

impl SmoothVolume {
    /// The volume of `body` under `light`.
    ///
    /// Linear in the number of silhouette edges but for the search, which is [`crate::NormalFinder`]'s, and one look at each vertex and crease.
    pub fn new(body: &SmoothBody, light: LightPosition, smoothness: &Smoothness) -> Self {
        let mut volume = Self::default();
        // Taken, not borrowed: while this thread waits for others, it may be given another volume to make.
        let mut scratch = SCRATCH.take();
        volume.make(body, light, smoothness, &mut scratch);
        SCRATCH.set(scratch);
        volume
    }

    /// Whether triangle `t` is in the light cap: any of its corners is turned to the light.
    fn is_in_cap(&self, body: &SmoothBody, t: usize) -> bool {
        body.wedges.mesh.triangles()[t].iter().any(|&w| self.turned[w as usize] > 0)
    }

    /// Faces and folds.
    pub fn closing(&self) -> impl ExactSizeIterator<Item = [u32; 3]> + Clone {
        (0..self.faces.len() + self.folds.len())
            .map(|i| if i < self.faces.len() { self.faces[i] } else { self.folds[i - self.faces.len()] })
    }

    /// The light cap. Linear in the number of triangles.
    pub fn chain(&self, body: &SmoothBody) -> Chain {
        let triangles = 0..body.wedges.mesh.triangles().len();
        Chain::from_coefficients(triangles.map(|t| i8::from(self.is_in_cap(body, t))).collect())
    }

    /// The same volume as one over a caster whose positions are those of `caster` and then the points of this: with folds and fins in its
    /// light cap. For counting on the CPU.
    pub fn flattened(&self, body: &SmoothBody, caster: &Caster) -> (Vec<Vec3>, ShadowVolume) {
        let first = caster.positions.len() as u32;
        let mut renamed: Vec<u32> = (first..first + self.points.len() as u32).collect();
        for &(vertex, point) in &self.vertices {
            renamed[point as usize] = vertex;
        }
        let name = |p: u32| renamed[p as usize];
        let triangles = caster.mesh.triangles().iter().enumerate();
        let cap = triangles.filter(|&(t, _)| self.is_in_cap(body, t)).map(|(_, &corners)| corners);
        let light_cap: Vec<[u32; 3]> = cap.chain(self.closing().map(|face| face.map(name))).collect();
        let sides = self.sides.iter().map(|side| side.map(name)).collect();
        let positions = [caster.positions.as_slice(), &self.points].concat();
        (positions, ShadowVolume { sides, most_triangles: light_cap.len(), light_cap })
    }

    /// A number that the count of the volume is nowhere above, nor below its negative, so that a narrow counter is used only where it can't wrap; one no better than
    /// `enough` is as good as any.
    ///
    /// A count is what the silhouette winds around the ray from the light, less what faces behind the point add to it and more what they take away: no
    /// more of these than there are faces, on one ray, that are turned away from the light. Linear in the number of triangles, and parallel.
    pub fn most_overlaps(&self, body: &SmoothBody, caster: &Caster, light: LightPosition, enough: u32) -> u32 {
        let (positions, volume) = if needs_light_cap(caster, light) {
            self.flattened(body, caster)
        } else {
            let sides = self.sides.clone();
            (self.points.clone(), ShadowVolume { sides, light_cap: Vec::new(), most_triangles: usize::MAX >> 1 })
        };
        let bounds = self.bounds(caster);
        let around = |enough| most_overlaps_of((&positions, &bounds), &volume, light, enough);
        let stacked = || {
            let stack = Stack::new(self.turned_away(caster, light), &bounds, light);
            (stack.most_roughly(), stack)
        };
        let (around_roughly, (stacked, stack)) = rayon::join(|| around(enough / 2), stacked);
        let most = around_roughly.saturating_add(stacked);
        if most <= enough {
            return most;
        }
        let stacked = stacked.min(stack.most_closely());
        around(enough.saturating_sub(stacked)).saturating_add(stacked)
    }

    /// The box of the caster, and of the silhouette, which may bulge out of it.
    pub fn bounds(&self, caster: &Caster) -> Bounds {
        caster.bounds.union(Bounds::of_points(self.points.iter().map(|p| p.as_dvec3())))
    }

    /// The faces and the triangles of the light cap that show the light their backs.
    fn turned_away<'a>(
        &'a self,
        caster: &'a Caster,
        light: LightPosition,
    ) -> impl ParallelIterator<Item = [Vec3; 3]> + 'a {
        let homogeneous = light.homogeneous().as_vec4();
        let is_away = move |[a, b, c]: &[Vec3; 3]| {
            let (normal, to_light) = ((*b - *a).cross(*c - *a), homogeneous.truncate() - *a * homogeneous.w);
            normal.dot(to_light) <= EDGE_ON * normal.length() * to_light.length()
        };
        let cap = self.may_be_away.par_iter().with_min_len(AT_ONCE).map(|&t| caster.corners(t as usize));
        let closing = self.faces.par_iter().chain(&self.folds).with_min_len(AT_ONCE);
        cap.chain(closing.map(|face| face.map(|p| self.points[p as usize]))).filter(is_away)
    }

    /// The silhouette as closed loops of points, each without its first one again.
    ///
    /// Where several pass one point, which of them goes on where is arbitrary, but the same on every run.
    pub fn loops(&self) -> Vec<Vec<u32>> {
        let mut sorted = self.sides.clone();
        sorted.sort_unstable();
        let mut is_walked = vec![false; sorted.len()];
        let mut loops = Vec::new();
        for start in 0..sorted.len() {
            let mut at = start;
            let mut corners = Vec::new();
            while !is_walked[at] {
                is_walked[at] = true;
                let [from, to] = sorted[at];
                corners.push(from);
                let first = sorted.partition_point(|side| side[0] < to);
                let next = (first..sorted.len()).take_while(|&i| sorted[i][0] == to).find(|&i| !is_walked[i]);
                at = next.unwrap_or(start);
            }
            if !corners.is_empty() {
                loops.push(corners);
            }
        }
        loops
    }
}
