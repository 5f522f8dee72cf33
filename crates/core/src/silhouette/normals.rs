//! Where the smooth surface that a mesh stands for turns away from the light: edges whose ends' normals say so.
//!
//! ```text
//!       light                    A vertex v with the normal n is turned to the light where the light
//!         \     n1                is above its tangent plane: the dual point (n, -v . n). Edges from a
//!      n0  \   /                  vertex that is to one that is not carry the points of the smooth
//!        \__\_/____ lit           silhouette, and are found as other edges are: by the tree in dual
//!       v0    v1                  space, with vertices for faces.
//! ```
//!
//! Source: A. Hertzmann and D. Zorin, "Illustrating smooth surfaces", 2000; G. Wallner 2007, section 4, has their dual points.

use glam::Vec3;

use crate::{Caster, LightPosition};

use super::dual::{self, Ends};
use super::edges::Edges;
use super::faces::Faces;
use super::facing::Facing;
use super::hierarchy::{Open, Trees};

/// Finds edges of one caster across which its vertex normals turn away from a light.
#[derive(Debug, Clone)]
pub struct NormalFinder {
    tangents: Faces,
    trees: Trees<Ends>,
}

impl NormalFinder {
    /// For the vertices of `caster` with one of `normals` each, of any length; a normal of length 0 is turned to no light.
    ///
    /// Takes about half a microsecond for each edge, and 70 bytes.
    ///
    /// # Panics
    ///
    /// If there are not as many normals as the caster has vertices.
    pub fn new(caster: &Caster, normals: &[Vec3]) -> Self {
        assert_eq!(normals.len(), caster.positions.len(), "each vertex has a normal");
        let tangents = Faces::of_vertices(caster, normals);
        let edges = Edges::of_vertices(&caster.topology);
        let trees = dual::trees(&tangents, &edges);
        Self { tangents, trees }
    }

    /// Writes to `found` the edges with one end turned to `light` and one not, each as `[turned, not turned]`, and returns how many were tested.
    ///
    /// A vertex is turned to the light where the height of the light above its tangent plane is more than 0. In no particular order, but
    /// the same on every run.
    pub fn find(&self, light: LightPosition, found: &mut Vec<[u32; 2]>) -> usize {
        found.clear();
        self.trees.find(&self.tangents.framed(light), &mut Open::default(), found)
    }

    /// Writes to `turned`, for each vertex, 1 where it is turned to `light`, else 0; after them come zeros to the next multiple of 64. By the same
    /// arithmetic as [`NormalFinder::find`], 16 vertices or so at once.
    pub fn turned(&self, light: LightPosition, turned: &mut Vec<i8>) {
        let mut facing = Facing::default();
        facing.tell(&self.tangents, &self.tangents.framed(light));
        turned.clear();
        turned.extend_from_slice(facing.coefficients());
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DVec3};

    use super::*;
    use crate::{Mesh, Object, Surface, Topology};

    /// A closed net of `n` times `n` quads, round like a tyre, and its normals.
    fn tyre(n: u32) -> (Caster, Vec<Vec3>) {
        let angle = |i: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        let place = |i: u32, j: u32| {
            let ((s, c), (t, d)) = (angle(i).sin_cos(), angle(j).sin_cos());
            let normal = DVec3::new(c * d, s * d, t);
            (DVec3::new(c, s, 0.0) * 2.0 + normal * 0.7, normal)
        };
        let places: Vec<(DVec3, DVec3)> = (0..n * n).map(|v| place(v / n, v % n)).collect();
        let at = |i: u32, j: u32| i % n * n + j % n;
        let quads = (0..n * n).map(|v| (v / n, v % n));
        let triangles = quads.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        let positions = places.iter().map(|(p, _)| p.as_vec3()).collect();
        let surface = Surface { positions, triangles: triangles.collect(), ..Surface::default() };
        let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
        let topology = Arc::new(Topology::new(&mesh));
        let caster = Caster::new(&Object::new("tyre", mesh, DAffine3::IDENTITY), topology);
        (caster, places.iter().map(|(_, normal)| 3.0 * normal.as_vec3()).collect())
    }

    #[test]
    fn edges_on_which_normals_turn_away_are_found_and_no_others() {
        let (tyre, normals) = tyre(48);
        let finder = NormalFinder::new(&tyre, &normals);
        let mut found = Vec::new();
        for i in 0..64 {
            let (sin, cos) = f64::from(i).sin_cos();
            let way = DVec3::new(cos, sin, 0.1 * f64::from(i % 9) - 0.4);
            let light = match i % 3 {
                0 => LightPosition::directional(way).expect("not zero"),
                1 => LightPosition::point(9.0 * way),
                _ => LightPosition::point(2.3 * way),
            };
            let tested = finder.find(light, &mut found);
            found.sort_unstable();
            let height = |v: u32| {
                let (p, n) = (tyre.positions[v as usize].as_dvec3(), normals[v as usize].as_dvec3());
                light.offset_from(p).dot(n)
            };
            let mut expected: Vec<[u32; 2]> = Vec::new();
            for edge in tyre.topology.edges() {
                match (height(edge.low) > 0.0, height(edge.high) > 0.0) {
                    (true, false) => expected.push([edge.low, edge.high]),
                    (false, true) => expected.push([edge.high, edge.low]),
                    _ => {}
                }
            }
            expected.sort_unstable();
            assert_eq!(found, expected, "under {light:?}");
            assert!(!found.is_empty() && tested < tyre.topology.edges().len() * 3 / 4, "{tested} edges tested");
        }
    }
}
