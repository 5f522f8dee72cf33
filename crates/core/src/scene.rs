//! What a file becomes: named objects in one space, ready to cast.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use rustc_hash::FxHashMap;

use crate::{Bounds, Camera, CameraError, Light, Mesh, Pose, Role, Texture};

/// Everything that is lit and casts, with the cameras and lights that came with it.
///
/// Scene space is metres, x east, y north, z up, about `origin`; every position in here (transforms, cameras,
/// lights) is relative to it.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Where scene space is: a point of the scene plus this is a point of the model's own coordinates.
    pub origin: DVec3,
    /// What is drawn and casts; several may share one mesh.
    pub objects: Vec<Object>,
    /// Never empty when there are objects.
    pub materials: Vec<Material>,
    /// Pictures that materials name.
    pub textures: Vec<Arc<Texture>>,
    /// Cameras that came with the model.
    pub cameras: Vec<NamedCamera>,
    /// Lights that came with the model.
    pub lights: Vec<Light>,
}

/// One mesh in one place.
#[derive(Debug, Clone)]
pub struct Object {
    /// Unique within the scene only if the file's names were.
    pub name: String,
    /// Shared between instances.
    pub mesh: Arc<Mesh>,
    /// Scene space from object space; may mirror.
    pub world_from_object: DAffine3,
    /// How the mesh is bent, if it can be.
    pub pose: Option<Pose>,
    /// What it does in a picture.
    pub role: Role,
}

/// How a surface looks.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// As in the file; empty when it had none.
    pub name: String,
    /// Linear reflectance, each channel 0 to 1; multiplies the texture's.
    pub base_color: Vec3,
    /// 0 to 1; multiplies the texture's.
    pub alpha: f32,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Index into [`Scene::textures`].
    pub base_color_texture: Option<u32>,
    /// What its surfaces are a part of, where the file says so.
    pub surface: SurfaceKind,
}

/// What a surface of a city model is a part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SurfaceKind {
    /// The file does not say.
    #[default]
    Unknown,
    /// A roof of a building.
    Roof,
    /// An outer wall of a building, windows and doors included.
    Wall,
    /// The underside of a building, where it stands.
    Base,
    /// The surface of the earth, with roads and water; what buildings stand on.
    Terrain,
}

/// What a material's alpha means.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum AlphaMode {
    /// Nothing.
    #[default]
    Opaque,
    /// Where it is below `cutoff`, there is no surface.
    Mask {
        /// 0 to 1.
        cutoff: f32,
    },
    /// How much of the surface covers what is behind.
    Blend,
}

impl Default for Material {
    /// A light, slightly warm grey.
    fn default() -> Self {
        Self::new("", Vec3::new(0.62, 0.60, 0.57))
    }
}

impl Material {
    /// Opaque, without a texture.
    pub fn new(name: impl Into<String>, base_color: Vec3) -> Self {
        let name = name.into();
        Self {
            name,
            base_color,
            alpha: 1.0,
            alpha_mode: AlphaMode::Opaque,
            base_color_texture: None,
            surface: SurfaceKind::Unknown,
        }
    }
}

/// A camera that came with a model; its picture size is the user's choice.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCamera {
    /// As in the file.
    pub name: String,
    /// Scene space.
    pub eye: DVec3,
    /// Unit vector.
    pub forward: DVec3,
    /// Unit vector, across `forward`.
    pub up: DVec3,
    /// Full vertical angle.
    pub fov_y_rad: f64,
    /// Nothing nearer than this is seen.
    pub near: f64,
}

impl NamedCamera {
    /// The camera for a picture of `size_px` pixels.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the file's values or the size can't be used.
    pub fn with_size(&self, size_px: [u32; 2]) -> Result<Camera, CameraError> {
        Camera::with_up(self.eye, self.eye + self.forward, self.up, self.fov_y_rad, self.near, size_px)
    }
}

/// Why scenes can't be joined.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The offset between two origins can't be held.
    #[error(
        "the models are {distance_m:.0} m apart; models in one picture must be within {MAX_DISTANCE_M} m of each other"
    )]
    TooFarApart {
        /// Distance between the two origins.
        distance_m: f64,
    },
}

/// Positions are `f32` about one origin: at 100 km they are 8 mm apart.
const MAX_DISTANCE_M: f64 = 100_000.0;

impl Scene {
    /// The smallest box that holds every object, scene space; empty without objects.
    pub fn bounds(&self) -> Bounds {
        self.objects.iter().fold(Bounds::EMPTY, |bounds, object| bounds.union(object.bounds()))
    }

    /// Triangles drawn, instances counted each.
    pub fn triangle_count(&self) -> usize {
        self.objects.iter().map(|o| o.mesh.triangles().len()).sum()
    }

    /// Puts `other` into this scene, keeping this scene's origin.
    ///
    /// # Errors
    ///
    /// [`SceneError::TooFarApart`] when the two origins are too far apart for `f32` positions.
    pub fn add(&mut self, other: Scene) -> Result<(), SceneError> {
        if self.objects.is_empty() {
            *self = other;
            return Ok(());
        }
        let offset = other.origin - self.origin;
        let distance_m = offset.length();
        if distance_m > MAX_DISTANCE_M {
            return Err(SceneError::TooFarApart { distance_m });
        }
        let first_material = self.materials.len() as u32;
        let first_texture = self.textures.len() as u32;
        self.textures.extend(other.textures);
        self.materials.extend(other.materials.into_iter().map(|material| Material {
            base_color_texture: material.base_color_texture.map(|texture| first_texture + texture),
            ..material
        }));
        // Objects that shared a mesh still do.
        let mut moved: FxHashMap<*const Mesh, Arc<Mesh>> = FxHashMap::default();
        let mut mesh_after = |mesh: &Arc<Mesh>| {
            let moved =
                moved.entry(Arc::as_ptr(mesh)).or_insert_with(|| Arc::new(mesh.with_materials_after(first_material)));
            moved.clone()
        };
        self.objects.extend(other.objects.into_iter().map(|object| Object {
            mesh: mesh_after(&object.mesh),
            world_from_object: DAffine3::from_translation(offset) * object.world_from_object,
            ..object
        }));
        self.cameras.extend(other.cameras.into_iter().map(|c| NamedCamera { eye: c.eye + offset, ..c }));
        self.lights.extend(other.lights.into_iter().map(|l| Light { position: l.position.moved_by(offset), ..l }));
        Ok(())
    }
}

impl Object {
    /// An opaque object that casts and is not bent.
    pub fn new(name: impl Into<String>, mesh: Arc<Mesh>, world_from_object: DAffine3) -> Self {
        Self { name: name.into(), mesh, world_from_object, pose: None, role: Role::default() }
    }

    /// Where each of the mesh's positions is, scene space.
    pub fn positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.mesh.positions().iter().enumerate().map(|(v, &rest)| {
            let posed = self.pose.as_ref().map_or(rest.as_dvec3(), |pose| pose.position(v, rest));
            self.world_from_object.transform_point3(posed)
        })
    }

    /// The smallest box that holds the object, scene space.
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.positions())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn objects_that_share_a_mesh_still_do_in_a_scene_that_they_join() {
        let one_cube = || {
            let mesh = Arc::new(Mesh::new(shapes::cuboid(Vec3::ZERO, Vec3::ONE)).expect("a good box"));
            let object = Object::new("cube", mesh, DAffine3::IDENTITY);
            Scene { objects: vec![object.clone(), object], materials: vec![Material::default()], ..Scene::default() }
        };
        let mut scene = one_cube();
        scene.add(one_cube()).expect("they are at the same place");
        let [a, b, c, d] = scene.objects.as_slice() else { panic!("four objects") };
        assert!(Arc::ptr_eq(&a.mesh, &b.mesh) && Arc::ptr_eq(&c.mesh, &d.mesh));
        assert_eq!([a, c].map(|object| object.mesh.triangle_materials()[0]), [0, 1]);
    }
}
