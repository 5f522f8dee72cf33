//! The planes of a caster, one for each flat face, as points of dual space.
//!
//! ```text
//!    primal                          dual, four dimensions
//!    plane n . x = d                 point  (n, -d)
//!    light (x, y, z, w)              hyperplane through the origin, with that normal
//!    height of the light above       their product  h = n . xyz - d w,
//!    the plane                       whose sign is the side on which the point is
//! ```
//!
//! Any coefficients make a closed chain, so all triangles of one flat face may share one plane and one bit: their inner edges never
//! appear, whatever the rounding, and half the edges of a building are gone before a light is there. Triangles share a plane
//! when it passes them within rounding of their corners, so the answer is exact for corners moved by no more than that.
//!
//! Space is the caster's own: its box's middle is the origin and half the box's diagonal is 1. There a plane's `n` has length 1 and its `d`
//! is at most 1, so that dual points lie in the unit hypercube, and `f32` loses no more of a plane than it has lost of the corners.
//! G. Wallner 2007, section 4, scales each dual point to length 1 instead; then a product is no distance, and edge-on can't be told from it.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::{Caster, LightPosition};

/// Planes come in groups of as many as a word has bits.
pub(super) const WORD: usize = u64::BITS as usize;

/// Corners nearer to a plane than this, relative to the size of coordinates, may be in it: a few roundings of `f32`, 2^-24 each.
const IN_PLANE: f64 = 3e-7;

/// A triangle with less than this part of its longest edge as height has no good plane of its own.
const SLIVER: f64 = 1e-3;

/// The cosine between the normals of triangles that share a plane is at least this. Their corners say whether they are in one
/// plane; this says only that they are not folded upon each other.
const SAME_SIDE: f64 = 0.5;

/// What rounding may do to a height: a light and a plane are rounded to `f32`, and seven operations follow, on numbers of size 1.
const HEIGHT_ROUNDING: f64 = 4e-7;

/// A light nearer to a plane than this, relative to the size of coordinates (or with a cosine below it), is in the plane: the GPU's rounding
/// may put it on either side.
pub(crate) const EDGE_ON: f64 = 4e-7;

/// The planes of a caster's flat faces.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Faces {
    /// `[nx, ny, nz, -d]` of each face: those of closed components first, then padding to whole words, then the others and padding
    /// again. Padding is 0, and so is the plane of a triangle without area: no light is above it.
    pub(super) planes: [Vec<f32>; 4],
    /// How many of the planes, padding included, are of closed components; a multiple of [`WORD`].
    pub(super) closed: usize,
    /// The plane of each triangle.
    pub(super) of_triangle: Vec<u32>,
    /// How many faces there are, without padding.
    pub(super) count: usize,
    frame: Frame,
}

/// Where the space of the planes lies in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    middle: DVec3,
    /// The caster's size in it is 1.
    per_metre: f64,
    /// The largest of all coordinates in scene space.
    reach_m: f64,
}

/// A light among the planes of a caster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FramedLight {
    /// Of length 1, in four dimensions.
    pub(super) hyperplane: [f32; 4],
    /// A light that is no higher than this above a plane, nor lower, is in the plane.
    pub(super) edge_on: f32,
}

impl FramedLight {
    /// The coefficient of a face with that plane: 1 where it faces the light, else 0, or in components that are not closed -1 where
    /// it faces away. One light and one face at a time; [`super::facing::Facing`] has the same for many.
    pub(super) fn coefficient(&self, plane: [f32; 4], is_closed: bool) -> i32 {
        let h = height(plane, self.hyperplane);
        if is_closed { i32::from(h > 0.0) } else { i32::from(h > self.edge_on) - i32::from(h < -self.edge_on) }
    }
}

impl Faces {
    /// The faces of `caster`. Takes about 100 ns for each triangle, and 16 bytes for each face and 4 for each triangle.
    pub(super) fn new(caster: &Caster) -> Self {
        let frame = Frame::of(caster);
        let (mut of_triangle, count) = Growth::new(caster, frame.reach_m * IN_PLANE).grow();
        let planes = frame.planes(caster, &of_triangle, count);

        let mut is_closed = vec![false; count];
        let mut keys = vec![u32::MAX; count];
        for (t, &face) in of_triangle.iter().enumerate() {
            let component = caster.topology.component_of_triangle()[t];
            is_closed[face as usize] = caster.topology.components()[component as usize].is_closed;
            let key = &mut keys[face as usize];
            *key = frame.curve(caster.corners(t)[0]).min(*key);
        }
        // Neighbours in space are neighbours in memory, whatever order the file had.
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.par_sort_unstable_by_key(|&face| (!is_closed[face as usize], keys[face as usize], face));
        let closed_count = is_closed.iter().filter(|&&c| c).count();
        let closed = closed_count.next_multiple_of(WORD);
        let others = (count - closed_count).next_multiple_of(WORD);
        let mut place = vec![0; count];
        let mut sorted = [(); 4].map(|()| vec![0.0; closed + others]);
        for (i, &face) in order.iter().enumerate() {
            let i = if i < closed_count { i } else { i - closed_count + closed };
            place[face as usize] = i as u32;
            sorted.iter_mut().zip(planes[face as usize]).for_each(|(axis, x)| axis[i] = x);
        }
        of_triangle.iter_mut().for_each(|face| *face = place[*face as usize]);
        Self { planes: sorted, closed, of_triangle, count, frame }
    }

    /// The tangent planes of the vertices of `caster`, which have `normals`, one after the other; all as if of one closed component.
    pub(super) fn of_vertices(caster: &Caster, normals: &[Vec3]) -> Self {
        let frame = Frame::of(caster);
        let len = normals.len().next_multiple_of(WORD);
        let mut planes = [(); 4].map(|()| vec![0.0; len]);
        for (i, (place, normal)) in caster.positions.iter().zip(normals).enumerate() {
            let normal = normal.as_dvec3().normalize_or_zero();
            let d = normal.dot((place.as_dvec3() - frame.middle) * frame.per_metre);
            let plane = normal.extend(-d).as_vec4().to_array();
            planes.iter_mut().zip(plane).for_each(|(axis, x)| axis[i] = x);
        }
        Self { planes, closed: len, of_triangle: Vec::new(), count: normals.len(), frame }
    }

    /// How many planes there are, padding included.
    pub(super) fn len(&self) -> usize {
        self.planes[0].len()
    }

    pub(super) fn plane(&self, face: u32) -> [f32; 4] {
        [0, 1, 2, 3].map(|axis| self.planes[axis][face as usize])
    }

    /// 1 where a face, of whatever component, faces the light, -1 where it faces away, 0 where the light is in its plane.
    pub(super) fn turn(&self, face: u32, light: &FramedLight) -> i32 {
        light.coefficient(self.plane(face), false)
    }

    pub(super) fn framed(&self, light: LightPosition) -> FramedLight {
        self.frame.framed(light)
    }

    /// The caster's vertices in the space of the planes.
    pub(super) fn places(&self, caster: &Caster) -> Vec<Vec3> {
        let frame = &self.frame;
        caster.positions.iter().map(|p| ((p.as_dvec3() - frame.middle) * frame.per_metre).as_vec3()).collect()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<[f32; 4]>() * self.len() + size_of_val(self.of_triangle.as_slice())
    }
}

/// The height of a light above a plane. The one expression for it: what runs on many planes at once does the same operations in
/// the same order, without fusing any, and so gets the same bits.
pub(super) fn height([nx, ny, nz, nd]: [f32; 4], [x, y, z, w]: [f32; 4]) -> f32 {
    ((nx * x + ny * y) + nz * z) + nd * w
}

impl Frame {
    fn of(caster: &Caster) -> Self {
        let bounds = &caster.bounds;
        let radius = if bounds.is_empty() { 0.0 } else { bounds.radius() };
        let reach_m = bounds.min.abs().max(bounds.max.abs()).max_element();
        Self {
            middle: if bounds.is_empty() { DVec3::ZERO } else { bounds.center() },
            per_metre: if radius > 0.0 { radius.recip() } else { 1.0 },
            reach_m: if bounds.is_empty() { 0.0 } else { reach_m },
        }
    }

    fn framed(&self, light: LightPosition) -> FramedLight {
        let position = light.homogeneous().truncate();
        let (place, edge_on) = if light.is_directional() {
            (position.normalize_or_zero().extend(0.0), EDGE_ON)
        } else {
            let reach_m = self.reach_m.max(position.abs().max_element());
            (((position - self.middle) * self.per_metre).extend(1.0), EDGE_ON * reach_m * self.per_metre)
        };
        let length = place.length().max(f64::MIN_POSITIVE);
        let hyperplane = (place / length).as_vec4().to_array();
        FramedLight { hyperplane, edge_on: (edge_on / length + HEIGHT_ROUNDING) as f32 }
    }

    /// Where `p` is on a curve that fills space (G. M. Morton's): points near on it are near each other.
    fn curve(&self, p: Vec3) -> u32 {
        let place = (p.as_dvec3() - self.middle) * self.per_metre;
        // Ten bits on each axis, two apart.
        let spread = |x: f64| {
            let mut bits = ((x + 1.0) * 511.5) as u32;
            bits = (bits | bits << 16) & 0x0300_00FF;
            bits = (bits | bits << 8) & 0x0300_F00F;
            bits = (bits | bits << 4) & 0x030C_30C3;
            (bits | bits << 2) & 0x0924_9249
        };
        spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2
    }

    /// One plane for each of `count` faces: its normal is the sum of its triangles', and it is in the middle between their corners.
    fn planes(&self, caster: &Caster, face_of_triangle: &[u32], count: usize) -> Vec<[f32; 4]> {
        let placed = |p: Vec3| (p.as_dvec3() - self.middle) * self.per_metre;
        let mut normals = vec![DVec3::ZERO; count];
        for (t, &face) in face_of_triangle.iter().enumerate() {
            normals[face as usize] += area_vector(caster.corners(t).map(placed));
        }
        normals.iter_mut().for_each(|n| *n = n.normalize_or_zero());
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; count];
        for (t, &face) in face_of_triangle.iter().enumerate() {
            let (normal, [low, high]) = (normals[face as usize], &mut ranges[face as usize]);
            for corner in caster.corners(t).map(placed) {
                let d = normal.dot(corner);
                *low = low.min(d);
                *high = high.max(d);
            }
        }
        let plane = |(n, [low, high]): (&DVec3, &[f64; 2])| n.extend(-(low + high) / 2.0).as_vec4().to_array();
        normals.iter().zip(&ranges).map(plane).collect()
    }
}

/// Twice the triangle's area, along its normal.
fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Flat faces grown from one triangle each, over edges.
struct Growth<'a> {
    caster: &'a Caster,
    tolerance_m: f64,
    /// The edges of each triangle.
    edges: Vec<[u32; 3]>,
}

const NO_FACE: u32 = u32::MAX;

impl<'a> Growth<'a> {
    fn new(caster: &'a Caster, tolerance_m: f64) -> Self {
        let mut edges = vec![[0; 3]; caster.mesh.triangles().len()];
        let mut known = vec![0_u8; edges.len()];
        for e in 0..caster.topology.edges().len() {
            for (t, _) in caster.topology.triangles_on_edge(e) {
                edges[t][usize::from(known[t])] = e as u32;
                known[t] += 1;
            }
        }
        Self { caster, tolerance_m, edges }
    }

    /// The face of each triangle, and how many faces there are.
    fn grow(&self) -> (Vec<u32>, usize) {
        let mut faces = vec![NO_FACE; self.edges.len()];
        let mut count = 0;
        let mut front = Vec::new();
        // Slivers are taken into the faces of others where they fit, and only then have faces of their own.
        for takes_slivers in [false, true] {
            for seed in 0..faces.len() {
                if faces[seed] != NO_FACE {
                    continue;
                }
                let corners = self.corners(seed);
                let area = area_vector(corners);
                if !takes_slivers && is_sliver(corners, area) {
                    continue;
                }
                faces[seed] = count;
                front.push(seed);
                let normal = area.normalize_or_zero();
                while let Some(t) = front.pop() {
                    self.add_neighbours(t, normal, corners[0], &mut faces, &mut front);
                }
                count += 1;
            }
        }
        (faces, count as usize)
    }

    /// Adds the triangles beside `t` that are in its plane, which goes through `origin`, to its face and to `front`.
    fn add_neighbours(&self, t: usize, normal: DVec3, origin: DVec3, faces: &mut [u32], front: &mut Vec<usize>) {
        for &e in &self.edges[t] {
            // Where more than two meet, which of them go on in the plane is not asked.
            let mut on_edge = self.caster.topology.triangles_on_edge(e as usize);
            let (Some((u, u_walks)), Some((v, v_walks)), None) = (on_edge.next(), on_edge.next(), on_edge.next())
            else {
                continue;
            };
            let other = if u == t { v } else { u };
            if u_walks == v_walks || faces[other] != NO_FACE {
                continue;
            }
            let corners = self.corners(other);
            let is_in_plane = corners.iter().all(|&c| normal.dot(c - origin).abs() <= self.tolerance_m);
            let area = area_vector(corners);
            let is_same_side = normal.dot(area) >= SAME_SIDE * area.length() || is_sliver(corners, area);
            if is_in_plane && is_same_side && normal != DVec3::ZERO {
                faces[other] = faces[t];
                front.push(other);
            }
        }
    }

    fn corners(&self, t: usize) -> [DVec3; 3] {
        self.caster.corners(t).map(Vec3::as_dvec3)
    }
}

fn is_sliver([a, b, c]: [DVec3; 3], area: DVec3) -> bool {
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    area.length() <= SLIVER * longest
}
