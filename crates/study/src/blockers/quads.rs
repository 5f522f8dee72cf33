//! Triangles, in pairs where two make a convex quadrilateral in one plane: walls and roofs are made of such, and one quadrilateral costs
//! hardly more than one triangle.

use glam::{DVec3, Vec3};
use umbrae_core::Caster;

/// A planar convex face with three or four corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quad {
    /// In order around the face; a triangle's last corner stands twice.
    pub(super) corners: [Vec3; 4],
    /// Unit vector out of the side from which the corners go round counter-clockwise.
    pub(super) normal: Vec3,
    /// Whether it must block from both sides, because it is not part of a closed surface.
    pub(super) is_two_sided: bool,
}

/// How far the fourth corner may be from the plane of the other three, in parts of what a verdict leaves room for.
const BENT: f64 = 0.05;

/// The faces of `caster`. Triangles without area, which shade nothing, are left out.
///
/// `margin` is the distance within which verdicts are left to rays.
pub(super) fn quads_of(caster: &Caster, margin: f64) -> Vec<Quad> {
    let topology = &caster.topology;
    let triangles = caster.mesh.triangles();
    let mut neighbours = vec![[u32::MAX; 3]; triangles.len()];
    for e in 0..topology.edges().len() {
        let mut on_edge = topology.triangles_on_edge(e).map(|(t, _)| t);
        let (Some(a), Some(b), None) = (on_edge.next(), on_edge.next(), on_edge.next()) else { continue };
        let edge = &topology.edges()[e];
        for (t, other) in [(a, b), (b, a)] {
            let across = (0..3).find(|&i| triangles[t][i] != edge.low && triangles[t][i] != edge.high);
            // The corner across the edge; there is none where a triangle names a corner twice, which meshes don't.
            if let Some(i) = across {
                neighbours[t][i] = other as u32;
            }
        }
    }
    let mut is_used = vec![false; triangles.len()];
    let mut quads = Vec::with_capacity(triangles.len());
    for t in 0..triangles.len() {
        if is_used[t] {
            continue;
        }
        is_used[t] = true;
        let corners = caster.corners(t);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let is_two_sided = !topology.components()[topology.component_of_triangle()[t] as usize].is_closed;
        // The longest edge is the one that a triangulation has added, more often than not.
        let partner = (0..3)
            .filter_map(|i| {
                let other = *neighbours[t].get(i)? as usize;
                let (p, from, to) = (corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
                if other >= triangles.len() || is_used[other] {
                    return None;
                }
                let far = caster.corners(other).into_iter().find(|&corner| corner != from && corner != to)?;
                let quad = [p, from, far, to];
                is_flat_and_convex(quad.map(Vec3::as_dvec3), normal, BENT * margin).then_some((
                    from.distance_squared(to),
                    quad,
                    other,
                ))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let corners = match partner {
            Some((_, quad, other)) => {
                is_used[other] = true;
                quad
            }
            None => [corners[0], corners[1], corners[2], corners[2]],
        };
        quads.push(Quad { corners, normal: normal.as_vec3(), is_two_sided });
    }
    quads
}

fn is_flat_and_convex(corners: [DVec3; 4], normal: DVec3, bent: f64) -> bool {
    let is_flat = normal.dot(corners[2] - corners[0]).abs() <= bent;
    is_flat
        && (0..4).all(|i| {
            let [before, at, after] = [corners[(i + 3) % 4], corners[i], corners[(i + 1) % 4]];
            (at - before).cross(after - at).dot(normal) > 0.0
        })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DAffine3;
    use umbrae_core::{Mesh, Object, Scene, shapes};

    use super::*;

    #[test]
    fn a_box_has_six_faces_and_a_tetrahedron_four() {
        let quads = |surface| {
            let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
            let turned = DAffine3::from_rotation_z(0.7) * DAffine3::from_rotation_x(0.4);
            let scene = Scene { objects: vec![Object::new("it", mesh, turned)], ..Scene::default() };
            quads_of(&Caster::of_scene(&scene)[0], 1e-3).len()
        };
        assert_eq!(quads(shapes::cuboid(Vec3::ZERO, Vec3::new(20.0, 30.0, 40.0))), 6);
        let tetrahedron = umbrae_core::Surface {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            ..Default::default()
        };
        assert_eq!(quads(tetrahedron), 4);
    }
}
