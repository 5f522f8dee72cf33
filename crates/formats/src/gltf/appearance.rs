//! Materials, lights and cameras of a glTF file.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Cone, Light, LightPosition, Material, NamedCamera};

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
    let range_m = light.range.filter(|_| !position.is_directional());
    let usable_range_m = range_m.filter(|range| *range > 0.0 && range.is_finite());
    if usable_range_m != range_m {
        let words = ["light's range was ignored", "lights' ranges were ignored"];
        warnings.add_one(words, || format!("{} m of {}", light.range.unwrap_or_default(), quoted(&name)));
    }
    let cone = if light.kind == "spot" { cone(&light.spot, &name, world_from_node, warnings) } else { None };
    Some(Light { cone, range_m: usable_range_m, ..Light::new(name, position, strength) })
}

/// The difference between a cone's angles that a file without any gets, in radians: a hundredth of a degree.
const LEAST_EDGE_RAD: f64 = 2e-4;

/// The cone of a spot light along the node's -z; its angles are brought into glTF's bounds, 0 <= inner < outer <= pi / 2.
fn cone(spot: &document::Spot, name: &str, world_from_node: &DAffine3, warnings: &mut Warnings) -> Option<Cone> {
    let Some(axis) = world_from_node.transform_vector3(DVec3::NEG_Z).try_normalize() else {
        let words =
            ["spot light points nowhere and shines all around", "spot lights point nowhere and shine all around"];
        warnings.add_one(words, || quoted(name));
        return None;
    };
    // JSON has no NaN.
    let outer_rad = spot.outer_cone_angle.clamp(LEAST_EDGE_RAD, FRAC_PI_2);
    let inner_rad = spot.inner_cone_angle.clamp(0.0, outer_rad - LEAST_EDGE_RAD);
    let moved = (outer_rad - spot.outer_cone_angle).abs().max((inner_rad - spot.inner_cone_angle).abs());
    // Rounding to f32 and back is no fault, and equal angles are how some programs write a hard edge.
    if moved > 2.0 * LEAST_EDGE_RAD {
        let words = ["spot light's angles were brought into range", "spot lights' angles were brought into range"];
        warnings.add_one(words, || {
            format!("inner {} and outer {} of {}", spot.inner_cone_angle, spot.outer_cone_angle, quoted(name))
        });
    }
    Some(Cone { axis, inner_rad, outer_rad })
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
    let is_usable = eye.is_finite() && yfov > 0.0 && yfov < PI && znear > 0.0 && znear.is_finite();
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
