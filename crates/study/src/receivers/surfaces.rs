//! Points on roofs and walls.

use glam::{DVec2, DVec3, IVec3, Vec3};
use rustc_hash::FxHashMap;
use umbrae_core::{Caster, Material, SurfaceKind};

use super::plan;

/// A point on a surface.
pub(super) struct Sample {
    pub(super) position: DVec3,
    /// Unit vector, out of the side from which the corners go round counter-clockwise.
    pub(super) normal: Vec3,
    /// Square metres that it stands for.
    pub(super) area: f32,
}

/// What the triangles of `caster` are parts of: what their materials say; else terrain, if the object is called "ground" or has "terrain" in its
/// name; else by which way they face: up, a roof; to the side, a wall; down, the base.
///
/// Steeper than 80 degrees is a wall. Which way a sheet faces is not to be trusted, so it counts as a roof from both sides where
/// its component is not closed.
pub fn kind_of_triangles(caster: &Caster, materials: &[Material]) -> Vec<SurfaceKind> {
    /// Sine of 10 degrees.
    const WALL: f32 = 0.173_648;
    let name = caster.name.to_lowercase();
    let is_terrain = name == "ground" || name.split(|c: char| !c.is_alphanumeric()).any(|word| word == "terrain");
    let topology = &caster.topology;
    (0..caster.mesh.triangles().len())
        .map(|t| {
            let said = caster.mesh.triangle_materials().get(t).and_then(|&m| materials.get(m as usize));
            match said.map(|material| material.surface) {
                Some(SurfaceKind::Unknown) | None if is_terrain => SurfaceKind::Terrain,
                Some(SurfaceKind::Unknown) | None => {
                    let [a, b, c] = caster.corners(t);
                    let up = (b - a).cross(c - a).normalize_or_zero().z;
                    let is_closed = topology.components()[topology.component_of_triangle()[t] as usize].is_closed;
                    match up {
                        _ if up.abs() < WALL => SurfaceKind::Wall,
                        _ if up > 0.0 || !is_closed => SurfaceKind::Roof,
                        _ => SurfaceKind::Base,
                    }
                }
                Some(kind) => kind,
            }
        })
        .collect()
}

/// The middles of the squares of `spacing` metres into which the planes of the triangles of kind `surface` are divided; all triangles in one plane share its
/// squares. A face between the middles has one point, in its largest triangle.
pub(super) fn samples(caster: &Caster, kinds: &[SurfaceKind], surface: SurfaceKind, spacing: f64) -> Vec<Sample> {
    assert_eq!(kinds.len(), caster.mesh.triangles().len(), "a kind for each triangle");
    let mut faces: FxHashMap<(IVec3, i64), Vec<usize>> = FxHashMap::default();
    let mut in_order = Vec::new();
    for (t, _) in kinds.iter().enumerate().filter(|(_, kind)| **kind == surface) {
        let Some((normal, _)) = normal_and_area(caster, t) else { continue };
        let offset = normal.dot(caster.corners(t)[0].as_dvec3());
        let key = ((normal * NORMAL_STEPS).round().as_ivec3(), (offset / OFFSET_M).round() as i64);
        let face = faces.entry(key).or_insert_with(|| {
            in_order.push(key);
            Vec::new()
        });
        face.push(t);
    }
    in_order.iter().flat_map(|key| samples_of_face(caster, &faces[key], spacing)).collect()
}

/// Triangles are in one plane if their normals and offsets round to the same multiples: of a thousandth, and of 2 cm.
const NORMAL_STEPS: f64 = 1000.0;
const OFFSET_M: f64 = 0.02;

fn samples_of_face(caster: &Caster, triangles: &[usize], spacing: f64) -> Vec<Sample> {
    let of = |t: usize| normal_and_area(caster, t).expect("only triangles with an area are in faces");
    let total: f64 = triangles.iter().map(|&t| of(t).1).sum();
    // Along the contour and up the slope, so that the rows of a facade are level.
    let across = plan(of(triangles[0]).0).perp().extend(0.0).try_normalize().unwrap_or(DVec3::X);
    let up = of(triangles[0]).0.cross(across);
    let mut samples = Vec::new();
    for &t in triangles {
        let corners = caster.corners(t).map(Vec3::as_dvec3);
        let normal = of(t).0;
        let flat = corners.map(|c| DVec2::new(c.dot(across), c.dot(up)) / spacing);
        for middle in middles_within(flat) {
            let Some(weights) = weights_at(flat, middle) else { continue };
            let position = corners.iter().zip(weights).map(|(&corner, weight)| weight * corner).sum();
            samples.push(Sample { position, normal: normal.as_vec3(), area: 0.0 });
        }
    }
    if samples.is_empty() {
        let largest = triangles.iter().copied().max_by(|&a, &b| of(a).1.total_cmp(&of(b).1));
        let largest = largest.expect("a face has a triangle");
        let position = caster.corners(largest).map(Vec3::as_dvec3).iter().sum::<DVec3>() / 3.0;
        samples.push(Sample { position, normal: of(largest).0.as_vec3(), area: 0.0 });
    }
    let share = (total / samples.len() as f64) as f32;
    for sample in &mut samples {
        sample.area = share;
    }
    samples
}

/// The points with halves for coordinates in the box of a triangle.
fn middles_within(corners: [DVec2; 3]) -> impl Iterator<Item = DVec2> {
    let min = corners.iter().fold(DVec2::INFINITY, |min, c| min.min(*c)).floor();
    let max = corners.iter().fold(DVec2::NEG_INFINITY, |max, c| max.max(*c)).ceil();
    let count = (max - min).max(DVec2::ZERO);
    (0..count.y as usize).flat_map(move |row| {
        (0..count.x as usize).map(move |column| min + DVec2::new(column as f64 + 0.5, row as f64 + 0.5))
    })
}

/// The weights of the corners at `p`; `None` outside. A point on an edge that two triangles of one face share belongs to one of them:
/// the edge is asked from the same end, and only one triangle is on the side to which a zero belongs.
fn weights_at(corners: [DVec2; 3], p: DVec2) -> Option<[f64; 3]> {
    let [a, b, c] = corners;
    let turn = (b - a).perp_dot(c - a).signum();
    let mut weights = [0.0; 3];
    for (i, weight) in weights.iter_mut().enumerate() {
        let (from, to) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
        let is_forward = (from.x, from.y) < (to.x, to.y);
        let (low, high) = if is_forward { (from, to) } else { (to, from) };
        let side = turn * if is_forward { 1.0 } else { -1.0 };
        let doubled_area = (high - low).perp_dot(p - low);
        let is_within = if side > 0.0 { doubled_area >= 0.0 } else { doubled_area < 0.0 };
        if !is_within {
            return None;
        }
        *weight = doubled_area.abs();
    }
    let sum: f64 = weights.iter().sum();
    (sum > 0.0).then(|| weights.map(|weight| weight / sum))
}

/// Unit normal and area; `None` for triangles that are lines.
fn normal_and_area(caster: &Caster, t: usize) -> Option<(DVec3, f64)> {
    let [a, b, c] = caster.corners(t).map(Vec3::as_dvec3);
    let cross = (b - a).cross(c - a);
    Some((cross.try_normalize()?, 0.5 * cross.length()))
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use std::sync::Arc;
    use umbrae_core::{Mesh, Object, Topology, shapes};

    use super::*;

    fn cuboid(min: Vec3, max: Vec3) -> Caster {
        let mesh = Arc::new(Mesh::new(shapes::cuboid(min, max)).expect("a good box"));
        let topology = Arc::new(Topology::new(&mesh));
        Caster::new(&Object::new("house", mesh, DAffine3::IDENTITY), topology)
    }

    #[test]
    fn a_box_has_a_roof_four_walls_and_a_base() {
        let house = cuboid(Vec3::ZERO, Vec3::new(4.0, 6.0, 8.0));
        let kinds = kind_of_triangles(&house, &[Material::default()]);
        let count = |kind| kinds.iter().filter(|k| **k == kind).count();
        assert_eq!([SurfaceKind::Roof, SurfaceKind::Wall, SurfaceKind::Base].map(count), [2, 8, 2]);
    }

    #[test]
    fn samples_stand_for_the_whole_area_and_none_for_a_square_of_another() {
        let house = cuboid(Vec3::ZERO, Vec3::new(4.0, 6.0, 8.0));
        let kinds = kind_of_triangles(&house, &[Material::default()]);
        for (kind, area, count) in [(SurfaceKind::Roof, 24.0, 24), (SurfaceKind::Wall, 160.0, 160)] {
            let samples = samples(&house, &kinds, kind, 1.0);
            let sum: f32 = samples.iter().map(|s| s.area).sum();
            assert!((sum - area).abs() < 1e-3, "{kind:?}: {sum} of {area}");
            assert_eq!(samples.len(), count, "{kind:?}: each square has its middle in one triangle");
        }
        assert_eq!(samples(&house, &kinds, SurfaceKind::Roof, 100.0).len(), 1);
    }
}
