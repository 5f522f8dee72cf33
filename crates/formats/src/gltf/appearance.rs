//! Materials, lights and cameras of a glTF file.

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Light, LightPosition, Material, NamedCamera};

use super::document;
use crate::error::quoted;
use crate::warnings::Warnings;

/// The materials, and what of them is left out.
pub(super) fn materials(materials: &[document::Material], warnings: &mut Warnings) -> Vec<Material> {
    materials.iter().map(|material| material_of(material, warnings)).collect()
}

fn material_of(material: &document::Material, warnings: &mut Warnings) -> Material {
    let name = material.name.clone().unwrap_or_default();
    let pbr = &material.pbr_metallic_roughness;
    if pbr.base_color_texture.is_some() {
        warnings.add(1, ["base colour texture is ignored", "base colour textures are ignored"]);
    }
    if material.extensions.transmission.is_some() || material.alpha_mode.as_deref().is_some_and(|mode| mode != "OPAQUE")
    {
        let words =
            ["transparent material is drawn and casts as opaque", "transparent materials are drawn and cast as opaque"];
        warnings.add_one(words, || quoted(&name));
    }
    let [red, green, blue, _] = pbr.base_color_factor.unwrap_or([1.0; 4]);
    let given = Vec3::new(red, green, blue);
    // A NaN becomes 0.
    let base_color = given.max(Vec3::ZERO).min(Vec3::ONE);
    if given != base_color {
        let words = ["base colour was brought into 0 to 1", "base colours were brought into 0 to 1"];
        warnings.add_one(words, || format!("({red}, {green}, {blue}) of material {}", quoted(&name)));
    }
    Material::new(name, base_color)
}

/// A light where its node is; it shines along the node's -z.
pub(super) fn light(
    light: &document::Light,
    name: String,
    world_from_node: &DAffine3,
    warnings: &mut Warnings,
) -> Option<Light> {
    let strength = Vec3::from(light.color) * light.intensity;
    let position = match light.kind.as_str() {
        "directional" => LightPosition::directional(world_from_node.transform_vector3(DVec3::Z)),
        "point" | "spot" => Some(world_from_node.translation).filter(|p| p.is_finite()).map(LightPosition::point),
        _ => None,
    };
    let Some(position) = position.filter(|_| strength.is_finite()) else {
        let words = ["light was skipped", "lights were skipped"];
        warnings.add_one(words, || {
            format!("{} is {} of strength {strength} in no usable place", quoted(&name), quoted(&light.kind))
        });
        return None;
    };
    if light.kind == "spot" {
        let words = [
            "spot light shines all around (spot cones are not applied)",
            "spot lights shine all around (spot cones are not applied)",
        ];
        warnings.add(1, words);
    }
    Some(Light::new(name, position, strength))
}

/// A camera where its node is; it looks along the node's -z, +y up.
pub(super) fn camera(
    camera: &document::Camera,
    name: String,
    world_from_node: &DAffine3,
    warnings: &mut Warnings,
) -> Option<NamedCamera> {
    let Some(perspective) = &camera.perspective else {
        let words = ["orthographic camera was skipped", "orthographic cameras were skipped"];
        warnings.add_one(words, || quoted(&name));
        return None;
    };
    let forward = world_from_node.transform_vector3(DVec3::NEG_Z).try_normalize();
    // A sheared node's y may not be across its z.
    let y = world_from_node.transform_vector3(DVec3::Y);
    let up = forward.and_then(|forward| y.reject_from_normalized(forward).try_normalize());
    let &document::Perspective { yfov, znear } = perspective;
    let eye = world_from_node.translation;
    let is_usable = eye.is_finite() && yfov > 0.0 && yfov < std::f64::consts::PI && znear > 0.0 && znear.is_finite();
    match (forward, up) {
        (Some(forward), Some(up)) if is_usable => {
            Some(NamedCamera { name, eye, forward, up, fov_y_rad: yfov, near: znear })
        }
        _ => {
            let words = ["camera was skipped", "cameras were skipped"];
            warnings.add_one(words, || format!("{} at {eye} with yfov {yfov} and znear {znear}", quoted(&name)));
            None
        }
    }
}
