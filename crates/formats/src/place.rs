//! Where a model goes: its axes turned to the scene's, its positions brought near an origin.

use std::mem;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use umbrae_core::{Bounds, Material, Mesh, MeshError, Object, Scene, Surface};

use crate::UpAxis;
use crate::error::Problem;
use crate::warnings::{Warnings, Words};

/// What is said of normals that a mesh was given and could not use.
pub(crate) const NORMAL_LEFT_OUT: Words =
    ["corner's normal is not finite and was left out", "corners' normals are not finite and were left out"];

/// What is said when one of several objects can't be used.
pub(crate) const OBJECT_SKIPPED: Words = ["object was skipped", "objects were skipped"];

/// A surface as an OBJ, PLY or STL file gives it: in the file's own axes, not yet near an origin.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Part {
    pub(crate) name: String,
    pub(crate) positions: Vec<DVec3>,
    /// The rest as in [`Surface`].
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) triangle_materials: Vec<u32>,
    pub(crate) vertex_colors: Vec<Vec3>,
    pub(crate) corner_uvs: Vec<[Vec2; 3]>,
    /// In the file's axes.
    pub(crate) corner_normals: Vec<[Vec3; 3]>,
}

impl UpAxis {
    /// Scene axes from the file's.
    pub(crate) fn scene_from_file(self) -> DMat3 {
        match self {
            Self::Y => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
            Self::Z => DMat3::IDENTITY,
        }
    }

    /// The same for one point, and exact: a matrix would turn -0 into 0 and infinity into NaN.
    fn point_in_scene(self, p: DVec3) -> DVec3 {
        match self {
            Self::Y => DVec3::new(p.x, -p.z, p.y),
            Self::Z => p,
        }
    }

    /// The same for a direction in `f32`.
    fn direction_in_scene(self, d: Vec3) -> Vec3 {
        match self {
            Self::Y => Vec3::new(d.x, -d.z, d.y),
            Self::Z => d,
        }
    }
}

/// Coordinates at or above this are refused, as by [`MeshError::BadPosition`]: products of several overflow `f32`.
pub(crate) const MAX_COORDINATE: f64 = 1e18;

/// Whether `p` is finite and not too far away to reason about.
pub(crate) fn is_in_range(p: DVec3) -> bool {
    p.is_finite() && p.abs().max_element() < MAX_COORDINATE
}

/// A model keeps its own coordinates, bit for bit, up to this many of its own sizes away from their zero; there
/// `f32` still resolves a millionth of its size.
const ORIGIN_DISTANCE: f64 = 8.0;

/// The origin of a scene whose content fills `bounds`: 0 unless it is far away, else whole metres near its middle.
pub(crate) fn origin_of(bounds: Bounds) -> DVec3 {
    if bounds.is_empty() || bounds.center().length() <= ORIGIN_DISTANCE * bounds.size().length() {
        return DVec3::ZERO;
    }
    bounds.center().floor()
}

/// The origin of a scene whose content has a place on earth: 0 within its own size, else whole metres near its middle.
///
/// Such content has no numbers to keep: a country seen from its own zero would have its vertices centimetres off. Points
/// that are not on earth (some programs write the least whole number for a height that they do not know) do not count,
/// unless there are no others.
pub(crate) fn origin_on_earth(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let (mut on_earth, mut all) = (Bounds::EMPTY, Bounds::EMPTY);
    for p in points {
        let one = Bounds::of_points([p]);
        all = all.union(one);
        if HEIGHTS_ON_EARTH.contains(&p.z) {
            on_earth = on_earth.union(one);
        }
    }
    let bounds = if on_earth.is_empty() { all } else { on_earth };
    if bounds.is_empty() || bounds.center().length() <= bounds.size().length() {
        return DVec3::ZERO;
    }
    bounds.center().floor()
}

/// From the deepest trench to above the highest mountain, in metres; in feet or millimetres nothing is lost but precision.
const HEIGHTS_ON_EARTH: std::ops::Range<f64> = -12_000.0..40_000.0;

/// The scene of `parts`, one object each. A part that is no mesh is skipped with a warning, unless it is the last.
///
/// `explain` is given a part that is no mesh, with its positions, and its number; it says where in the file the
/// reason lies.
pub(crate) fn scene_of_parts(
    parts: Vec<Part>,
    up: UpAxis,
    materials: Vec<Material>,
    warnings: &mut Warnings,
    explain: impl Fn(usize, &Part, &MeshError) -> Problem,
) -> Result<Scene, Problem> {
    let used = parts.iter().flat_map(|part| part.triangles.iter().flatten().map(|&i| part.positions.get(i as usize)));
    let usable = |p: &&DVec3| is_in_range(**p);
    let origin = origin_of(Bounds::of_points(used.flatten().filter(usable).map(|&p| up.point_in_scene(p))));

    let mut objects = Vec::new();
    let mut first_problem = None;
    for (index, mut part) in parts.into_iter().enumerate() {
        for normal in part.corner_normals.as_flattened_mut() {
            *normal = up.direction_in_scene(*normal);
        }
        let surface = Surface {
            positions: part.positions.iter().map(|&p| (up.point_in_scene(p) - origin).as_vec3()).collect(),
            triangles: mem::take(&mut part.triangles),
            triangle_materials: mem::take(&mut part.triangle_materials),
            vertex_colors: mem::take(&mut part.vertex_colors),
            corner_uvs: mem::take(&mut part.corner_uvs),
            corner_normals: mem::take(&mut part.corner_normals),
            ..Surface::default()
        };
        match Mesh::new(surface) {
            Ok(mesh) => {
                warnings.add(mesh.counts().unusable_normals, NORMAL_LEFT_OUT);
                objects.push(Object::new(part.name, Arc::new(mesh), DAffine3::IDENTITY));
            }
            Err(error) => {
                let problem = explain(index, &part, &error);
                warnings.add_one(OBJECT_SKIPPED, || problem.to_string());
                first_problem.get_or_insert(problem);
            }
        }
    }
    if objects.is_empty() {
        return Err(first_problem.unwrap_or_else(|| Problem::whole("there is no triangle in it")));
    }
    let materials = if materials.is_empty() { vec![Material::default()] } else { materials };
    Ok(Scene { origin, objects, materials, ..Scene::default() })
}

/// The linear value of an sRGB colour, channels 0 to 1; what is outside of that stays as far outside.
pub(crate) fn linear_from_srgb(color: Vec3) -> Vec3 {
    Vec3::from_array(color.to_array().map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle_at(offset: DVec3) -> Part {
        Part {
            name: "triangle".into(),
            positions: [DVec3::ZERO, DVec3::new(1.0 / 3.0, 0.0, 0.0), DVec3::new(0.0, 0.25, 2.0)]
                .map(|p| p + offset)
                .to_vec(),
            triangles: vec![[0, 1, 2]],
            ..Part::default()
        }
    }

    fn scene(part: Part, up: UpAxis) -> Scene {
        let explain = |_: usize, _: &Part, error: &MeshError| Problem::whole(error.to_string());
        scene_of_parts(vec![part], up, Vec::new(), &mut Warnings::default(), explain).expect("a good part")
    }

    #[test]
    fn what_is_up_in_the_file_is_up_in_the_scene() {
        let turned = scene(triangle_at(DVec3::ZERO), UpAxis::Y);
        assert_eq!(turned.objects[0].mesh.positions()[2], Vec3::new(0.0, -2.0, 0.25));
        let kept = scene(triangle_at(DVec3::ZERO), UpAxis::Z);
        assert_eq!(kept.objects[0].mesh.positions()[2], Vec3::new(0.0, 0.25, 2.0));
        for up in [UpAxis::Y, UpAxis::Z] {
            let p = DVec3::new(1.0, 2.0, 3.0);
            assert_eq!(up.scene_from_file() * p, up.point_in_scene(p));
            assert_eq!(up.direction_in_scene(p.as_vec3()).as_dvec3(), up.point_in_scene(p));
            assert_eq!(up.scene_from_file().determinant(), 1.0, "turned, not mirrored");
        }
    }

    #[test]
    fn a_model_near_zero_keeps_its_coordinates() {
        let scene = scene(triangle_at(DVec3::new(5.0, -3.0, 2.0)), UpAxis::Z);
        assert_eq!(scene.origin, DVec3::ZERO);
        assert_eq!(scene.objects[0].mesh.positions()[1].x, (5.0 + 1.0 / 3.0) as f32);
    }

    #[test]
    fn a_model_far_from_zero_loses_nothing() {
        let offset = DVec3::new(2.5e7, -4.0e6, 1.0e5);
        let far = scene(triangle_at(offset), UpAxis::Z);
        assert_eq!(far.origin, offset + DVec3::Z, "whole metres, near the middle");
        let third = far.objects[0].mesh.positions()[1].x;
        assert!((f64::from(third) - 1.0 / 3.0).abs() < 1e-8, "f32 at 2.5e7 would be off by up to 1 m: {third}");
    }

    #[test]
    fn a_part_that_is_no_mesh_is_skipped_unless_it_is_the_last() {
        let bad = Part { positions: vec![DVec3::NAN; 3], ..triangle_at(DVec3::ZERO) };
        let explain = |index: usize, _: &Part, error: &MeshError| Problem::whole(format!("{index}: {error}"));
        let mut warnings = Warnings::default();
        let parts = vec![bad.clone(), triangle_at(DVec3::ZERO)];
        let scene = scene_of_parts(parts, UpAxis::Z, Vec::new(), &mut warnings, explain).expect("one is good");
        assert_eq!((scene.objects.len(), scene.origin), (1, DVec3::ZERO));
        assert!(warnings.finish()[0].to_string().starts_with("1 object was skipped (first: 0: vertex 0 is at (NaN"));
        assert!(scene_of_parts(vec![bad], UpAxis::Z, Vec::new(), &mut Warnings::default(), explain).is_err());
    }

    #[test]
    fn black_and_white_are_the_same_in_srgb() {
        assert_eq!(linear_from_srgb(Vec3::ZERO), Vec3::ZERO);
        assert!((linear_from_srgb(Vec3::ONE) - Vec3::ONE).length() < 1e-6);
        assert!((linear_from_srgb(Vec3::splat(0.5)).x - 0.214_041).abs() < 1e-5);
    }
}
