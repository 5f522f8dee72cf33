//! Where a surface is cut out: the holes that a material's alpha makes, as a device that filters textures would see
//! them.
//!
//! Alpha is taken from the texture itself, never from a smaller copy of it, at the place on the texture that belongs to
//! the point that was hit.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::{AlphaMode, Caster, Hit, Material, Mesh, Texture, Wrap};

/// What is there where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Presence {
    Surface,
    Hole,
    /// Either, for all that can be said of a device.
    Unsure,
}

/// Devices filter with weights of 8 bits, in two steps, and some round the result of each step to 8 bits: of the
/// difference between the texels that are blended, so much may be lost or won.
const FILTER: f64 = 4.0 / 256.0;

/// Devices find a place between texels in steps of 1/256.
const SUBTEXEL: f64 = 1.0 / 256.0;

/// Alpha and cutoff are `f32`, and the texel's byte becomes one by a division: a few roundings (2^-24 each).
const ROUNDING: f64 = 4e-7;

/// The materials with holes, and which triangles of which caster have them.
#[derive(Debug)]
pub(super) struct CutOuts {
    /// For each caster its mesh, if some triangle of it may have holes.
    meshes: Vec<Option<Arc<Mesh>>>,
    /// For each material, if it may have holes.
    masks: Vec<Option<AlphaMask>>,
}

#[derive(Debug)]
struct AlphaMask {
    cutoff: f64,
    alpha: f64,
    texture: Option<Arc<Texture>>,
}

impl CutOuts {
    /// `None` where nothing has holes.
    ///
    /// # Panics
    ///
    /// If a material names a texture that is not there.
    pub(super) fn new(casters: &[Caster], materials: &[Material], textures: &[Arc<Texture>]) -> Option<Self> {
        let mask = |material: &Material| {
            let AlphaMode::Mask { cutoff } = material.alpha_mode else { return None };
            let texture = material.base_color_texture.map(|texture| textures[texture as usize].clone());
            Some(AlphaMask { cutoff: cutoff.into(), alpha: material.alpha.into(), texture })
        };
        let masks: Vec<Option<AlphaMask>> = materials.iter().map(mask).collect();
        let has_mask = |&material: &u32| masks.get(material as usize).is_some_and(Option::is_some);
        let meshes: Vec<Option<Arc<Mesh>>> = casters
            .iter()
            .map(|caster| {
                let has_holes = caster.role.is_cutout && caster.mesh.triangle_materials().iter().any(has_mask);
                has_holes.then(|| caster.mesh.clone())
            })
            .collect();
        meshes.iter().any(Option::is_some).then_some(Self { meshes, masks })
    }

    /// What is at `point` of the triangle that was hit, which has these corners.
    ///
    /// `blur` says how much of the corners' places on the texture may be lost when a device interpolates them.
    pub(super) fn presence(
        &self,
        hit: &Hit,
        corners: [DVec3; 3],
        point: DVec3,
        blur: impl FnOnce() -> f64,
    ) -> Presence {
        let Some(mesh) = &self.meshes[hit.part as usize] else { return Presence::Surface };
        let triangle = hit.triangle as usize;
        let material = mesh.triangle_materials()[triangle] as usize;
        let Some(Some(mask)) = self.masks.get(material) else { return Presence::Surface };
        let uvs = mesh.corner_uvs().get(triangle).map_or([DVec2::ZERO; 3], |uvs| uvs.map(glam::Vec2::as_dvec2));
        let weights = weights_at(point, corners);
        let uv = uvs[0] * weights.x + uvs[1] * weights.y + uvs[2] * weights.z;
        let uv_blur = uvs.iter().fold(DVec2::ZERO, |largest, uv| largest.max(uv.abs())) * blur();
        mask.presence(uv, uv_blur)
    }
}

impl AlphaMask {
    fn presence(&self, uv: DVec2, uv_blur: DVec2) -> Presence {
        let [least, most] = self.texture.as_ref().map_or([1.0; 2], |texture| alpha_between(texture, uv, uv_blur));
        if self.alpha * most < self.cutoff - ROUNDING {
            Presence::Hole
        } else if self.alpha * least >= self.cutoff + ROUNDING {
            Presence::Surface
        } else {
            Presence::Unsure
        }
    }
}

/// How much each corner counts at a point in the plane of a triangle; adds up to 1.
pub(super) fn weights_at(point: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let of = |p: DVec3, q: DVec3| (p - point).cross(q - point).dot(normal);
    let weights = DVec3::new(of(b, c), of(c, a), of(a, b));
    weights / weights.element_sum()
}

/// The least and the most that a device may find for the texture's alpha at `uv`, give or take `uv_blur`; anything
/// where that is texels.
fn alpha_between(texture: &Texture, uv: DVec2, uv_blur: DVec2) -> [f64; 2] {
    let size = DVec2::new(texture.size_px[0].into(), texture.size_px[1].into());
    let place = uv * size;
    let blur = uv_blur * size + SUBTEXEL;
    if blur.max_element() >= 1.0 {
        return [0.0, 1.0];
    }
    let texel = |x: f64, y: f64| f64::from(alpha_at(texture, [x, y])) / 255.0;
    let range =
        |values: &[f64]| values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, m], &v| [l.min(v), m.max(v)]);
    if texture.is_nearest {
        let (low, high) = ((place - blur).floor(), (place + blur).floor());
        return range(&[texel(low.x, low.y), texel(high.x, low.y), texel(low.x, high.y), texel(high.x, high.y)]);
    }
    // Texels have their values in their middles.
    let place = place - 0.5;
    let (low, share) = (place.floor(), place - place.floor());
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| texel(low.x + x, low.y + y));
    let mix = |a: f64, b: f64, share: f64| a + (b - a) * share;
    let alpha = mix(mix(corners[0], corners[1], share.x), mix(corners[2], corners[3], share.x), share.y);
    // Just beyond the four texels the next ones begin to count.
    let (low, high) = ((place - blur).floor(), (place + blur).floor() + 1.0);
    let [least, most] = range(
        &[
            range(&corners),
            range(&[texel(low.x, low.y), texel(high.x, low.y), texel(low.x, high.y), texel(high.x, high.y)]),
        ]
        .concat(),
    );
    // From one texel to the next alpha changes by no more than the difference of all these.
    let margin = (most - least) * (FILTER + blur.x + blur.y);
    [alpha - margin, alpha + margin]
}

/// The alpha of the texel in this column and row, which may be beyond the picture.
fn alpha_at(texture: &Texture, place: [f64; 2]) -> u8 {
    let [x, y] = [0, 1].map(|axis| wrapped(place[axis], texture.size_px[axis], texture.wrap[axis]));
    texture.rgba[4 * (y * texture.size_px[0] as usize + x) + 3]
}

/// The column (or row) of the picture that is seen at column `place` of the plane.
fn wrapped(place: f64, size: u32, wrap: Wrap) -> usize {
    let size = f64::from(size);
    let inside = match wrap {
        Wrap::Repeat => place.rem_euclid(size),
        Wrap::Mirror => {
            let in_pair = place.rem_euclid(2.0 * size);
            in_pair.min(2.0 * size - 1.0 - in_pair)
        }
        Wrap::Clamp => place,
    };
    // A place far beyond the picture may round up to its border.
    inside.clamp(0.0, size - 1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(alphas: &[u8], wrap: Wrap, is_nearest: bool) -> Texture {
        Texture {
            name: String::new(),
            size_px: [alphas.len() as u32, 1],
            rgba: alphas.iter().flat_map(|&alpha| [0, 0, 0, alpha]).collect(),
            wrap: [wrap; 2],
            is_nearest,
        }
    }

    fn middle(texture: &Texture, u: f64) -> f64 {
        let [least, most] = alpha_between(texture, DVec2::new(u, 0.5), DVec2::ZERO);
        f64::midpoint(least, most)
    }

    #[test]
    fn beyond_its_border_a_picture_repeats_or_is_mirrored_or_goes_on() {
        let columns = |wrap| [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|x| wrapped(x, 3, wrap));
        assert_eq!(columns(Wrap::Repeat), [0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
        assert_eq!(columns(Wrap::Mirror), [2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
        assert_eq!(columns(Wrap::Clamp), [0, 0, 0, 0, 1, 2, 2, 2, 2, 2]);
    }

    #[test]
    fn between_two_texels_alpha_is_blended_unless_the_texture_says_nearest() {
        let blended = texture(&[0, 255], Wrap::Clamp, false);
        for (u, expected) in [(0.1, 0.0), (0.25, 0.0), (0.5, 0.5), (0.6, 0.7), (0.75, 1.0), (0.9, 1.0)] {
            assert!((middle(&blended, u) - expected).abs() < 1e-12, "{u}: {}", middle(&blended, u));
        }
        let squares = texture(&[0, 255], Wrap::Clamp, true);
        assert_eq!([0.1, 0.4, 0.6, 0.9].map(|u| middle(&squares, u)), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(
            alpha_between(&squares, DVec2::new(0.501, 0.5), DVec2::ZERO),
            [0.0, 1.0],
            "within a step of the border"
        );
    }

    #[test]
    fn a_repeated_picture_is_blended_across_its_border() {
        assert!((middle(&texture(&[0, 255], Wrap::Repeat, false), 1.0) - 0.5).abs() < 1e-12);
        assert!(middle(&texture(&[0, 255], Wrap::Mirror, false), 0.0).abs() < 1e-12);
    }

    #[test]
    fn where_all_texels_are_alike_there_is_no_doubt() {
        let even = texture(&[128; 4], Wrap::Repeat, false);
        assert_eq!(alpha_between(&even, DVec2::new(0.37, 0.2), DVec2::splat(1e-6)), [128.0 / 255.0; 2]);
    }

    #[test]
    fn the_weights_at_a_corner_are_that_corner_alone() {
        let corners = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 1.0), DVec3::new(0.0, 7.0, -2.0)];
        for (corner, expected) in corners.into_iter().zip(DVec3::AXES) {
            assert!(weights_at(corner, corners).abs_diff_eq(expected, 1e-12));
        }
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        assert!(weights_at(middle, corners).abs_diff_eq(DVec3::splat(1.0 / 3.0), 1e-12));
    }
}
