//! What an object does in a picture: who casts, and what is glass.

use std::sync::Arc;

use crate::{AlphaMode, Material, Object, Scene};

/// What an object does in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Role {
    /// Whether it casts a shadow.
    pub casts: bool,
    /// Whether what is behind it shows through: it is drawn last and hides nothing.
    pub is_glass: bool,
    /// Whether parts of it are cut out by its texture. What is cut out still casts.
    pub is_cutout: bool,
}

impl Default for Role {
    /// Opaque and casting.
    fn default() -> Self {
        Self { casts: true, is_glass: false, is_cutout: false }
    }
}

impl Role {
    /// The role of a surface of `material` when nobody says otherwise: what is blended is glass and casts nothing.
    pub fn of_material(material: &Material) -> Self {
        let is_glass = material.alpha_mode == AlphaMode::Blend;
        let is_cutout = matches!(material.alpha_mode, AlphaMode::Mask { .. });
        Self { casts: !is_glass, is_glass, is_cutout }
    }

    /// Whether something behind a triangle of it may be seen through that triangle.
    pub fn is_see_through(self) -> bool {
        self.is_glass || self.is_cutout
    }
}

impl Scene {
    /// Gives each triangle the role that `role_of` says for its object and material, and splits objects in which triangles have
    /// several. Parts keep the object's name, and stand where the object stood.
    ///
    /// A part of a closed body is open, and is counted as such.
    pub fn assign_roles(&mut self, role_of: impl Fn(&Object, &Material) -> Role) {
        let objects = std::mem::take(&mut self.objects);
        for object in objects {
            let roles: Vec<Role> = self.materials.iter().map(|material| role_of(&object, material)).collect();
            let role_of_triangle =
                |t: usize| roles.get(object.mesh.triangle_materials()[t] as usize).copied().unwrap_or_default();
            let mut present: Vec<Role> = (0..object.mesh.triangles().len()).map(role_of_triangle).collect();
            present.sort_unstable();
            present.dedup();
            if let &[role] = present.as_slice() {
                self.objects.push(Object { role, ..object });
                continue;
            }
            for role in present {
                let (mesh, vertices) = object.mesh.part(|t| role_of_triangle(t) == role);
                let pose = object.pose.as_ref().map(|pose| pose.of_vertices(&vertices));
                self.objects.push(Object { role, mesh: Arc::new(mesh), pose, ..object.clone() });
            }
        }
    }
}
