//! The normals of the smooth surface that a mesh stands for: one for each corner of each triangle.
//!
//! ```text
//!      \  ^  /       Round a vertex, triangles whose edges bend less than the crease angle share one normal:
//!       \ | /        the mean of theirs, weighted by the angle that each has there. Over a crease the next
//!    ____\|/____     triangle begins a group of its own, so a vertex may have several.
//! ```
//!
//! Source for the weights: G. Thürmer and C. A. Wüthrich, "Computing vertex normals from polygonal facets", 1998.

use glam::{DVec3, Vec3};

use crate::{Caster, Object, Topology};

/// The cosine between a normal that a file gives and its triangle's below which it is not believed: 75 degrees.
const LEAST_GIVEN: f64 = 0.258_819_045_102_520_76;

/// With at least this cosine between them, a given normal is its triangle's own: 1 degree.
const OWN: f64 = 0.999_8;
/// A corner's normal with at least this cosine to its triangle's is flat: 0.1 degrees.
const FLAT: f64 = 0.999_998_5;

/// A unit normal, scene space, for each corner of each triangle of `caster`.
///
/// `given` are the file's, scene space, of any length, or empty; where one is zero, not finite or more than 75 degrees from its triangle's, it is
/// computed; and so are all where all are their triangles' own. Computed ones join triangles over edges that bend by at most `crease_rad`, and are the triangle's own where the others' mean is farther than that
/// from it (at the tip of a cone). A triangle without area has zeros. Takes about half a microsecond a triangle.
pub fn corner_normals(caster: &Caster, given: &[[Vec3; 3]], crease_rad: f64) -> Vec<[Vec3; 3]> {
    let computed = computed(caster, crease_rad);
    let is_own = |(t, given): (usize, &[Vec3; 3])| {
        let face = face_normal(caster, t);
        given.iter().all(|normal| normal.as_dvec3().normalize_or_zero().dot(face) >= OWN)
    };
    // Those of the triangles themselves tell how the file was written and nothing of a surface.
    if given.iter().enumerate().all(is_own) {
        return computed;
    }
    let believed = |(t, (given, computed)): (usize, (&[Vec3; 3], [Vec3; 3]))| {
        let face = face_normal(caster, t);
        std::array::from_fn(|i| {
            let unit = given[i].as_dvec3().try_normalize();
            unit.filter(|unit| unit.dot(face) >= LEAST_GIVEN).map_or(computed[i], DVec3::as_vec3)
        })
    };
    given.iter().zip(computed).enumerate().map(believed).collect()
}

/// The normals that the file gave the corners of `object`, scene space, of any length, for [`corner_normals`]; empty where it gave none or they are
/// those of another pose.
pub fn given_normals(object: &Object) -> Vec<[Vec3; 3]> {
    if object.pose.is_some() {
        return Vec::new();
    }
    // Normals are turned and stretched as planes are; a mirror turns triangles over, and normals have to be on their side.
    let matrix = object.world_from_object.matrix3;
    let Some(inverse) = matrix.try_inverse() else { return Vec::new() };
    let normal_matrix = inverse.transpose() * matrix.determinant().signum();
    let placed = |normal: &Vec3| (normal_matrix * normal.as_dvec3()).as_vec3();
    object.mesh.corner_normals().iter().map(|corners| corners.each_ref().map(placed)).collect()
}

fn computed(caster: &Caster, crease_rad: f64) -> Vec<[Vec3; 3]> {
    let least_cosine = crease_rad.cos();
    let triangles = caster.mesh.triangles();
    let faces: Vec<DVec3> = (0..triangles.len()).map(|t| face_normal(caster, t)).collect();
    let mut groups = Groups::of_corners(triangles.len());
    for (e, edge) in caster.topology.edges().iter().enumerate() {
        // Whatever meets at an edge, neighbours are joined that walk it in opposite directions, and so have one outside.
        let around: Vec<(usize, i32)> = caster.topology.triangles_on_edge(e).collect();
        let [(a, forward), (b, backward)] = around[..] else { continue };
        if forward != backward && faces[a].dot(faces[b]) >= least_cosine {
            for vertex in [edge.low, edge.high] {
                groups.join(corner_at(triangles, a, vertex), corner_at(triangles, b, vertex));
            }
        }
    }
    let mut sums = vec![DVec3::ZERO; 3 * triangles.len()];
    for (t, &face) in faces.iter().enumerate() {
        for (i, angle_rad) in corner_angles_rad(caster, t).into_iter().enumerate() {
            sums[groups.root(3 * t + i)] += face * angle_rad;
        }
    }
    let of_triangle = |(t, &face): (usize, &DVec3)| {
        [0, 1, 2].map(|i| {
            let mean = sums[groups.root(3 * t + i)].normalize_or_zero();
            if mean.dot(face) >= least_cosine { mean.as_vec3() } else { face.as_vec3() }
        })
    };
    faces.iter().enumerate().map(of_triangle).collect()
}

/// The unit normal of triangle `t`, scene space; 0 without area.
pub(super) fn face_normal(caster: &Caster, t: usize) -> DVec3 {
    let [a, b, c] = caster.corners(t).map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero()
}

/// The angles of triangle `t`; 0 where an edge has no length.
pub(super) fn corner_angles_rad(caster: &Caster, t: usize) -> [f64; 3] {
    let corners = caster.corners(t).map(Vec3::as_dvec3);
    [0, 1, 2].map(|i| {
        let [next, last] = [1, 2].map(|k| (corners[(i + k) % 3] - corners[i]).normalize_or_zero());
        next.cross(last).length().atan2(next.dot(last))
    })
}

/// Whether `normals` of the corners of triangle `t` are all its own; one without area has none.
pub(super) fn is_flat(caster: &Caster, t: usize, normals: &[Vec3; 3]) -> bool {
    let face = face_normal(caster, t);
    face == DVec3::ZERO || normals.iter().all(|normal| normal.as_dvec3().dot(face) >= FLAT)
}

fn corner_at(triangles: &[[u32; 3]], t: usize, vertex: u32) -> usize {
    3 * t + triangles[t].iter().position(|&v| v == vertex).unwrap_or_default()
}

/// Corners that share a normal.
struct Groups(Vec<u32>);

impl Groups {
    fn of_corners(triangles: usize) -> Self {
        Self((0..3 * triangles as u32).collect())
    }

    fn root(&self, mut corner: usize) -> usize {
        while self.0[corner] as usize != corner {
            corner = self.0[corner] as usize;
        }
        corner
    }

    /// The chains are as short as vertices have corners.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b) as u32;
    }
}

/// Whether every component of the mesh is closed and consistently wound, so that it has an outside.
pub(super) fn has_outside(topology: &Topology) -> bool {
    topology.components().iter().all(|component| component.is_closed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use crate::smooth::tests::caster_of;

    const CREASE: f64 = 0.76;

    #[test]
    fn on_a_sphere_they_point_away_from_its_middle() {
        for subdivisions in 0..3 {
            let sphere = caster_of(shapes::icosphere(Vec3::ONE, 2.0, subdivisions));
            for (t, normals) in corner_normals(&sphere, &[], CREASE).iter().enumerate() {
                for (place, normal) in sphere.corners(t).iter().zip(normals) {
                    assert!(normal.dot((place - Vec3::ONE) / 2.0) > 0.998, "{normal} at {place}");
                }
            }
        }
    }

    #[test]
    fn on_a_box_they_are_those_of_its_faces() {
        let cube = caster_of(shapes::cuboid(-Vec3::ONE, Vec3::ONE));
        for (t, normals) in corner_normals(&cube, &[], CREASE).iter().enumerate() {
            assert!(normals.iter().all(|normal| normal.as_dvec3().dot(face_normal(&cube, t)) > 1.0 - 1e-6));
        }
    }

    #[test]
    fn a_cylinder_is_round_about_and_sharp_at_its_rims() {
        let cylinder = caster_of(shapes::cylinder(Vec3::ZERO, 1.0, 2.0, 16));
        for (t, normals) in corner_normals(&cylinder, &[], CREASE).iter().enumerate() {
            let is_end = face_normal(&cylinder, t).z.abs() > 0.5;
            for (place, normal) in cylinder.corners(t).iter().zip(normals) {
                let expected = if is_end { normal.z.abs() } else { normal.dot(place.with_z(0.0).normalize_or_zero()) };
                assert!(expected > 0.9999, "{normal} at {place}");
            }
        }
    }

    #[test]
    fn a_cone_has_no_common_normal_at_its_tip() {
        let cone = caster_of(shapes::cone(Vec3::ZERO, 0.5, 1.5, 24));
        let normals = corner_normals(&cone, &[], CREASE);
        let at_tip = (0..normals.len()).flat_map(|t| [0, 1, 2].map(|i| (t, i)));
        for (t, i) in at_tip.filter(|&(t, i)| cone.corners(t)[i].z > 1.4) {
            assert!(normals[t][i].as_dvec3().dot(face_normal(&cone, t)) > 1.0 - 1e-6);
        }
    }

    #[test]
    fn given_ones_are_taken_unless_they_can_not_be_right() {
        let sphere = caster_of(shapes::icosphere(Vec3::ZERO, 1.0, 1));
        let tilted =
            |t: usize| (face_normal(&sphere, t) + 0.3 * face_normal(&sphere, t).any_orthonormal_vector()).as_vec3();
        let mut given: Vec<[Vec3; 3]> = (0..80).map(|t| [tilted(t) * 7.0; 3]).collect();
        given[3] = [Vec3::ZERO, Vec3::NAN, -tilted(3)];
        let computed = corner_normals(&sphere, &[], CREASE);
        let taken = corner_normals(&sphere, &given, CREASE);
        assert_eq!(taken[3], computed[3]);
        assert!(taken[4].iter().all(|normal| normal.distance(tilted(4).normalize_or_zero()) < 1e-6));
    }
}
