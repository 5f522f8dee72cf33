//! A tree over the surface itself: where its parts are, and how far their normals spread.
//!
//! ```text
//!      \  |  /        The points of a part are in a sphere, its normals in a cone. A light that is
//!       \ | /         high enough above every plane through a point of the one with a normal of
//!      .-'''-.        the other lights all of the part; one as far below, nothing. Either way the
//!     (  part )       part has no silhouette.
//!      '-...-'
//! ```
//!
//! Sources: P. Sander et al., "Silhouette clipping", 2000, for the hierarchy of cones; The Dark Mod uses one for its shadow volumes. Theirs hold triangles,
//! and look for edges between lit and unlit parts afterwards; this holds edges, with the normals of both faces, so that nothing is
//! left to look for, and its leaves are packets.

use std::f32::consts::{FRAC_PI_2, PI};

use borsh::{BorshDeserialize, BorshSerialize};
use glam::Vec3;

use crate::Caster;

use super::edges::Edges;
use super::faces::Faces;
use super::hierarchy::{Bound, Bounding, Look, Trees};
use super::simd::CHILDREN;

/// Planes are rounded, and pass the corners of their faces within rounding; so are the bounds.
const ROUNDING: f32 = 4e-6;

/// The trees over the pairs of `edges`, of `caster`.
pub(super) fn trees(caster: &Caster, faces: &Faces, edges: &Edges) -> Trees<Cone> {
    Trees::new(edges, faces, &Bends { faces, edges, places: faces.places(caster) })
}

/// Where edges are, and where their faces are turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cone {
    min: Vec3,
    max: Vec3,
    /// Of length 1.
    axis: Vec3,
    /// The angle between the axis and a normal, at most.
    spread_rad: f32,
}

/// Sixteen cones and the spheres of their points.
#[derive(Debug, Clone, PartialEq, BorshDeserialize, BorshSerialize)]
pub(super) struct Cones {
    middle: [[f32; CHILDREN]; 3],
    radius: [f32; CHILDREN],
    axis: [[f32; CHILDREN]; 3],
    /// Of the spread; -1 where the cone is too wide to tell anything.
    cosine: [f32; CHILDREN],
    sine: [f32; CHILDREN],
}

impl Bound for Cone {
    type Sixteen = Cones;

    fn sixteen(bounds: &[Self]) -> Cones {
        let zero = [0.0; CHILDREN];
        let mut cones = Cones { middle: [zero; 3], radius: zero, axis: [zero; 3], cosine: zero, sine: zero };
        for (i, cone) in bounds.iter().enumerate() {
            let middle = (cone.min + cone.max) / 2.0;
            for axis in 0..3 {
                cones.middle[axis][i] = middle[axis];
                cones.axis[axis][i] = cone.axis[axis];
            }
            cones.radius[i] = (cone.max - middle).length();
            let is_narrow = cone.spread_rad < FRAC_PI_2;
            (cones.sine[i], cones.cosine[i]) = if is_narrow { cone.spread_rad.sin_cos() } else { (1.0, -1.0) };
        }
        cones
    }

    fn look(cones: &Cones, [x, y, z, w]: [f32; 4], edge_on: Option<f32>) -> Look {
        let margin = edge_on.unwrap_or(0.0) + ROUNDING;
        let mut open = 0;
        for i in 0..CHILDREN {
            let [cx, cy, cz] = cones.middle.map(|axis| axis[i]);
            let [ax, ay, az] = cones.axis.map(|axis| axis[i]);
            let (vx, vy, vz) = (x - w * cx, y - w * cy, z - w * cz);
            let along = vx * ax + vy * ay + vz * az;
            let across = (vx * vx + vy * vy + vz * vz - along * along).max(0.0).sqrt();
            // Above, or below, the planes through the middle: the height over that of them which the light is nearest to.
            let height = along.abs() * cones.cosine[i] - across * cones.sine[i];
            open |= u16::from(height <= w * cones.radius[i] + margin) << i;
        }
        Look { open, ..Look::default() }
    }

    fn join(bounds: &[Self]) -> Self {
        let axis = bounds.iter().map(|cone| cone.axis).sum::<Vec3>().normalize_or(Vec3::Z);
        // An axis of length 0 has no angle with any.
        let angle = |cone: &Self| if cone.axis == Vec3::ZERO { PI } else { axis.angle_between(cone.axis) };
        Self {
            min: bounds.iter().fold(Vec3::INFINITY, |min, cone| min.min(cone.min)),
            max: bounds.iter().fold(Vec3::NEG_INFINITY, |max, cone| max.max(cone.max)),
            axis,
            spread_rad: bounds.iter().map(|cone| angle(cone) + cone.spread_rad).fold(0.0, f32::max),
        }
    }
}

/// Pairs as places with two normals.
struct Bends<'a> {
    faces: &'a Faces,
    edges: &'a Edges,
    /// Of the vertices.
    places: Vec<Vec3>,
}

impl Bends<'_> {
    /// Of length 1, or 0 for a triangle without area: that faces no light, wherever it is.
    fn normals(&self, pair: u32) -> [Vec3; 2] {
        self.edges.pairs[pair as usize].map(|face| {
            let [x, y, z, _] = self.faces.plane(face);
            Vec3::new(x, y, z)
        })
    }

    fn ends(&self, pair: u32) -> [Vec3; 2] {
        self.edges.pair_ends[pair as usize].map(|vertex| self.places[vertex as usize])
    }
}

impl Bounding<Cone, 6> for Bends<'_> {
    fn key(&self, pair: u32) -> [f32; 6] {
        let [normal, place] = [self.normals(pair), self.ends(pair)].map(|[a, b]| a + b);
        [normal.x, normal.y, normal.z, place.x, place.y, place.z]
    }

    fn bound(&self, pairs: &[u32]) -> Cone {
        let each = |&pair: &u32| {
            let [a, b] = self.ends(pair);
            self.normals(pair).map(|axis| Cone { min: a.min(b), max: a.max(b), axis, spread_rad: 0.0 })
        };
        Cone::join(&pairs.iter().flat_map(each).collect::<Vec<_>>())
    }
}
