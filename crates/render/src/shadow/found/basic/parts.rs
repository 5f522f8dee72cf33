//! Casters in parts that the stencil can count, whatever the light.
//!
//! The silhouette is on the GPU alone, so that its own overlaps, which bound the counts of other ways ([`umbrae_core::most_overlaps`]), are not
//! known. But no point is in more volumes than there are triangles on the way from it to the light: at most all triangles of a part, and
//! at most two of a convex surface. That holds for every light, and is found once.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use umbrae_core::{Bounds, Caster, Component};

use crate::shadow::plan::MOST_OVERLAPS;

/// Triangles of a caster.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Part {
    /// Their numbers.
    pub(super) triangles: Vec<u32>,
    /// No line meets more of them, but for lines along them.
    pub(super) most_overlaps: u32,
}

/// The triangles of `caster` in as many parts as are needed for each to overlap itself at most [`MOST_OVERLAPS`] times; near ones together.
///
/// Takes about a microsecond a triangle.
pub(super) fn parts(caster: &Caster) -> Vec<Part> {
    let convex = convex_components(caster);
    let mut whole: Vec<u32> = (0..caster.mesh.triangles().len() as u32).collect();
    let mut parts = Vec::new();
    split(caster, &convex, &mut whole, &mut parts);
    parts
}

/// As [`parts`], wherever the vertices are.
pub(super) fn parts_anywhere(caster: &Caster) -> Vec<Part> {
    let convex = vec![false; caster.topology.components().len()];
    let mut whole: Vec<u32> = (0..caster.mesh.triangles().len() as u32).collect();
    let mut parts = Vec::new();
    split(caster, &convex, &mut whole, &mut parts);
    parts
}

/// Whether `parts`, of `caster` before it moved, overlap themselves no more often than was found then.
pub(super) fn still_holds(caster: &Caster, parts: &[Part]) -> bool {
    // No triangle is in more than itself, wherever it is.
    if parts.iter().all(|part| part.triangles.len() as u32 <= part.most_overlaps) {
        return true;
    }
    let convex = convex_components(caster);
    parts.iter().all(|part| most_overlaps(caster, &convex, &part.triangles) <= part.most_overlaps)
}

impl Part {
    /// All triangles of `caster`.
    pub(super) fn whole(caster: &Caster) -> Self {
        let count = caster.mesh.triangles().len() as u32;
        Self { triangles: (0..count).collect(), most_overlaps: count }
    }
}

fn split(caster: &Caster, convex: &[bool], triangles: &mut [u32], parts: &mut Vec<Part>) {
    let most_overlaps = most_overlaps(caster, convex, triangles);
    if most_overlaps <= MOST_OVERLAPS {
        parts.push(Part { triangles: triangles.to_vec(), most_overlaps });
        return;
    }
    let middle = |t: u32| caster.corners(t as usize).into_iter().sum::<Vec3>();
    let bounds = Bounds::of_points(triangles.iter().map(|&t| middle(t).as_dvec3()));
    let axis = bounds.size().max_position();
    let half = triangles.len() / 2;
    triangles.select_nth_unstable_by(half, |&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(&b)));
    let (low, high) = triangles.split_at_mut(half);
    split(caster, convex, low, parts);
    split(caster, convex, high, parts);
}

/// At most so many of `triangles` are met by a line, but for lines along them.
fn most_overlaps(caster: &Caster, convex: &[bool], triangles: &[u32]) -> u32 {
    let component = |t: &u32| caster.topology.component_of_triangle()[*t as usize];
    let (of_convex, others): (Vec<u32>, Vec<u32>) = triangles.iter().partition(|t| convex[component(t) as usize]);
    let mut bodies: Vec<u32> = of_convex.iter().map(component).collect();
    bodies.sort_unstable();
    bodies.dedup();
    ((2 * bodies.len()).min(of_convex.len()) + others.len()) as u32
}

/// Components with more triangles are not looked at for being convex, which takes as many steps as the square of their number.
const LARGEST_CONVEX: u32 = 128;
/// A corner that is out of a face's plane by no more than this, relative to the coordinates, is in it but for rounding.
const FLAT: f64 = 1e-6;
/// For each component whether it is a convex surface.
fn convex_components(caster: &Caster) -> Vec<bool> {
    let components = caster.topology.components();
    let mut triangles: Vec<Vec<usize>> = vec![Vec::new(); components.len()];
    for (t, &component) in caster.topology.component_of_triangle().iter().enumerate() {
        if components[component as usize].triangles <= LARGEST_CONVEX {
            triangles[component as usize].push(t);
        }
    }
    let slack = FLAT * caster.bounds.min.abs().max(caster.bounds.max.abs()).max_element();
    let corners = |t: &usize| caster.corners(*t).map(Vec3::as_dvec3);
    let of_component = |(of, component): (&Vec<usize>, &Component)| {
        let triangles: Vec<[DVec3; 3]> = of.iter().map(corners).collect();
        component.is_closed && !triangles.is_empty() && is_convex(&triangles, slack)
    };
    triangles.iter().zip(components).map(of_component).collect()
}

/// Whether the triangles of a closed surface are the border of a convex body, each part of it once, and wound alike.
fn is_convex(triangles: &[[DVec3; 3]], slack: f64) -> bool {
    let points = || triangles.iter().flatten();
    let middle = points().sum::<DVec3>() / points().count() as f64;
    // Seen from the middle, what is wound outwards fills all directions once: the solid angle is 4 pi.
    let covered = triangles.iter().map(|t| solid_angle(t.map(|p| p - middle))).sum::<f64>() / (4.0 * PI);
    if (covered.abs() - 1.0).abs() > 0.1 {
        return false;
    }
    triangles.iter().all(|&[a, b, c]| {
        let outwards = (b - a).cross(c - a).normalize_or_zero() * covered.signum();
        outwards.dot(middle - a) < -slack && points().all(|&p| outwards.dot(p - a) <= slack)
    })
}

/// That a triangle fills as seen from the origin, positive where its back is seen.
///
/// Source: A. van Oosterom and J. Strackee, "The solid angle of a plane triangle", 1983.
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [x, y, z] = [a, b, c].map(DVec3::length);
    2.0 * a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DAffine3;
    use umbrae_core::{Mesh, Object, Surface, Topology, shapes};

    use super::*;

    fn caster(surface: Surface) -> Caster {
        let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
        let topology = Arc::new(Topology::new(&mesh));
        Caster::new(&Object::new("", mesh, DAffine3::IDENTITY), topology)
    }

    fn stack(count: u32, height: f32) -> Surface {
        let plate = |i: u32| shapes::cuboid(Vec3::new(-1.0, -1.0, i as f32), Vec3::new(1.0, 1.0, i as f32 + height));
        shapes::joined((0..count).map(plate))
    }

    #[test]
    fn every_triangle_is_in_one_part() {
        let caster = caster(shapes::torus(Vec3::ZERO, 2.0, 0.5, 200, 100));
        let parts = parts(&caster);
        let mut all: Vec<u32> = parts.iter().flat_map(|part| part.triangles.clone()).collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..40_000));
        assert!(parts.iter().all(|part| part.most_overlaps <= MOST_OVERLAPS));
        assert_eq!(parts.len(), 512, "halves of halves with 78 triangles each, or 79");
    }

    #[test]
    fn a_stack_of_boxes_is_met_twice_a_box() {
        let few = parts(&caster(stack(60, 0.5)));
        assert_eq!(few.iter().map(|part| part.most_overlaps).collect::<Vec<_>>(), [120]);
        let many = parts(&caster(stack(300, 0.5)));
        // A line through the stack meets 600 faces.
        assert!(many.iter().map(|part| part.most_overlaps).sum::<u32>() >= 600);
        assert!(many.len() <= 8, "{} parts", many.len());
    }

    #[test]
    fn a_surface_that_goes_round_twice_or_lies_in_a_plane_is_not_convex() {
        let corners = |surface: Surface| -> Vec<[DVec3; 3]> {
            let corner = |i: u32| surface.positions[i as usize].as_dvec3();
            surface.triangles.iter().map(|t| t.map(corner)).collect()
        };
        let cube = corners(shapes::cuboid(Vec3::splat(-1.0), Vec3::ONE));
        let inwards: Vec<_> = cube.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let sheet = corners(shapes::sheet(Vec3::ZERO, Vec3::X, Vec3::Y, [2, 2]));
        let both_sides: Vec<_> = sheet.iter().flat_map(|&[a, b, c]| [[a, b, c], [a, c, b]]).collect();
        let mut dented = corners(shapes::icosphere(Vec3::ZERO, 1.0, 1));
        for corner in dented.iter_mut().flatten().filter(|corner| corner.z > 0.99) {
            corner.z = 0.2;
        }
        assert!(is_convex(&cube, 1e-6) && is_convex(&inwards, 1e-6));
        assert!(!is_convex(&[cube.clone(), cube].concat(), 1e-6));
        assert!(!is_convex(&both_sides, 1e-6));
        assert!(!is_convex(&dented, 1e-6));
    }
}
