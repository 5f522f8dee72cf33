//! Materials, lights and cameras of a glTF file.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3, Vec4};
use umbrae_core::{AlphaMode, Cone, Light, LightPosition, Material, NamedCamera, Texture};

use super::document::{self, Document};
use super::texture::{Textures, UvSource};
use crate::error::quoted;
use crate::warnings::Warnings;

/// The materials of a file with all they need; none yet for primitives that have none.
pub(super) struct Looks {
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Arc<Texture>>,
    /// For each material, if it has a texture.
    pub(super) uv_sources: Vec<Option<UvSource>>,
}

/// The materials of `document`, whose textures `textures` reads.
pub(super) fn materials(document: &Document, mut textures: Textures<'_>, warnings: &mut Warnings) -> Looks {
    let (mut materials, mut uv_sources) = (Vec::new(), Vec::new());
    for material in &document.materials {
        let texture = material.pbr_metallic_roughness.base_color_texture.as_ref();
        let texture = texture.and_then(|texture| textures.of_material(texture, warnings));
        let base_color_texture = texture.map(|(index, _)| index);
        let least_alpha = base_color_texture.map_or(1.0, |index| textures.least_alpha(index));
        materials.push(Material { base_color_texture, ..material_of(material, least_alpha, warnings) });
        uv_sources.push(texture.map(|(_, source)| source));
    }
    Looks { materials, textures: textures.read, uv_sources }
}

/// How much is left of a surface's opacity that lets all light through: enough to see that it is there.
const OPACITY_OF_GLASS: f32 = 0.3;

/// A material without its texture, which has alpha of `least_alpha` and more. One that says it is cut out or blended, but is whole everywhere, is opaque:
/// some programs say so of everything.
fn material_of(material: &document::Material, least_alpha: f32, warnings: &mut Warnings) -> Material {
    let name = material.name.clone().unwrap_or_default();
    let [red, green, blue, alpha] = material.pbr_metallic_roughness.base_color_factor.unwrap_or([1.0; 4]);
    let given = Vec4::new(red, green, blue, alpha);
    let factor = given.clamp(Vec4::ZERO, Vec4::ONE);
    if given != factor {
        let words = ["base colour was brought into 0 to 1", "base colours were brought into 0 to 1"];
        warnings.add_one(words, || format!("({red}, {green}, {blue}, {alpha}) of material {}", quoted(&name)));
    }
    let mut alpha = factor.w;
    let cutoff = material.alpha_cutoff.unwrap_or(0.5).max(0.0);
    let mut alpha_mode = match material.alpha_mode.as_deref() {
        None | Some("OPAQUE") => AlphaMode::Opaque,
        Some("BLEND") if alpha * least_alpha >= 1.0 => AlphaMode::Opaque,
        Some("BLEND") => AlphaMode::Blend,
        Some("MASK") if alpha * least_alpha >= cutoff => AlphaMode::Opaque,
        Some("MASK") => {
            let words = ["cut-out material casts as full triangles", "cut-out materials cast as full triangles"];
            warnings.add_one(words, || quoted(&name));
            AlphaMode::Mask { cutoff }
        }
        Some(other) => {
            let words = [
                "alpha mode is unknown, so its material is opaque",
                "alpha modes are unknown, so their materials are opaque",
            ];
            warnings.add_one(words, || format!("{} of material {}", quoted(other), quoted(&name)));
            AlphaMode::Opaque
        }
    };
    let transmitted = material.extensions.transmission.as_ref().map_or(0.0, |t| t.transmission_factor.clamp(0.0, 1.0));
    if transmitted > 0.0 {
        let words =
            ["transmitting material is drawn as plain glass", "transmitting materials are drawn as plain glass"];
        warnings.add_one(words, || quoted(&name));
        if alpha_mode == AlphaMode::Opaque {
            alpha = 1.0;
        }
        alpha *= 1.0 - transmitted * (1.0 - OPACITY_OF_GLASS);
        alpha_mode = AlphaMode::Blend;
    }
    Material { alpha, alpha_mode, ..Material::new(name, factor.truncate()) }
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
