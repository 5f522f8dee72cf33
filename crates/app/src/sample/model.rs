//! How the samples are put together: parts with a paint make an object, objects make a scene.

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3, Mat3, Vec2, Vec3};
use umbrae_core::{Light, Material, Mesh, NamedCamera, Object, Scene, Surface, shapes};

/// A material of the scene that is being built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Paint(u32);

/// What one object is made of.
#[derive(Debug, Default)]
pub(super) struct Parts(Vec<(Paint, Surface)>);

impl Parts {
    pub(super) fn add(&mut self, paint: Paint, part: Surface) {
        self.0.push((paint, part));
    }

    pub(super) fn add_all(&mut self, paint: Paint, parts: impl IntoIterator<Item = Surface>) {
        self.0.extend(parts.into_iter().map(|part| (paint, part)));
    }

    /// All parts of `other`, moved.
    pub(super) fn add_moved(&mut self, other: Parts, to_from_other: Affine3A) {
        self.0.extend(other.0.into_iter().map(|(paint, part)| (paint, shapes::transformed(part, to_from_other))));
    }

    /// One mesh; its triangles come paint by paint, as a glTF file groups them.
    pub(super) fn into_mesh(mut self) -> Mesh {
        self.0.sort_by_key(|&(paint, _)| paint);
        let surface = shapes::joined(self.0.into_iter().map(|(paint, mut part)| {
            part.triangle_materials = vec![paint.0; part.triangles.len()];
            part
        }));
        Mesh::new(surface).expect("samples are made of good triangles")
    }
}

/// A scene that is being built.
#[derive(Debug, Default)]
pub(super) struct Model(Scene);

impl Model {
    /// A new material of this linear colour.
    pub(super) fn paint(&mut self, name: &str, base_color: [f32; 3]) -> Paint {
        self.0.materials.push(Material::new(name, base_color.into()));
        Paint(self.0.materials.len() as u32 - 1)
    }

    /// A new object in scene space.
    pub(super) fn add(&mut self, name: impl Into<String>, parts: Parts) {
        self.place(name, Arc::new(parts.into_mesh()), DAffine3::IDENTITY);
    }

    /// A new object that may share its mesh.
    pub(super) fn place(&mut self, name: impl Into<String>, mesh: Arc<Mesh>, world_from_object: DAffine3) {
        self.0.objects.push(Object::new(name, mesh, world_from_object));
    }

    pub(super) fn add_light(&mut self, light: Light) {
        self.0.lights.push(light);
    }

    /// A new camera, upright, that looks from `eye` to `target`.
    pub(super) fn add_camera(&mut self, name: &str, eye: DVec3, target: DVec3, fov_y_deg: f64) {
        let forward = (target - eye).normalize_or_zero();
        let right = forward.cross(DVec3::Z).normalize_or_zero();
        self.0.cameras.push(NamedCamera {
            name: name.to_owned(),
            eye,
            forward,
            up: right.cross(forward),
            fov_y_rad: fov_y_deg.to_radians(),
            near: 0.1,
        });
    }

    pub(super) fn into_scene(self) -> Scene {
        self.0
    }
}

/// Puts something on the ground at `at`, turned counter-clockwise by `angle_rad`.
///
/// Every entry is an `f32`, so that a file holds it exactly.
pub(super) fn standing(at: Vec2, angle_rad: f32, scale: f32) -> DAffine3 {
    let turned = Affine3A::from_mat3_translation(
        Mat3::from_rotation_z(angle_rad) * Mat3::from_diagonal(Vec3::splat(scale)),
        at.extend(0.0),
    );
    DAffine3::from_cols_array(&turned.to_cols_array().map(f64::from))
}

/// The body with the outline `outline_yz`, seen from the east, between two places on the x axis.
pub(super) fn profile(outline_yz: &[Vec2], west: f32, east: f32) -> Surface {
    // x, y, z of the prism become y, z, x.
    let turn = Affine3A::from_cols_array(&[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    shapes::transformed(shapes::prism(outline_yz, west, east), turn)
}

/// The box with this middle of its base, and these full lengths along x, y and z.
pub(super) fn block(base: Vec3, size: Vec3) -> Surface {
    let half = Vec3::new(0.5 * size.x, 0.5 * size.y, 0.0);
    shapes::cuboid(base - half, base + half.with_z(size.z))
}

/// A flat bar from `from` to `to`, which differ in plan: `width` across, and upright from `bottom` to `top`.
pub(super) fn wall(from: Vec2, to: Vec2, width: f32, bottom: f32, top: f32) -> Surface {
    let across = (to - from).perp().normalize_or_zero() * (0.5 * width);
    shapes::prism(&[from - across, to - across, to + across, from + across], bottom, top)
}
