//! How bright, and how far the ground reaches before it fades into the sky: nothing that a verdict depends on.

use glam::{DVec3, Vec3};
use umbrae_core::{Bounds, Light};

/// Exposure and fading of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Multiplies what lights give; ambient light is in display units already.
    pub exposure: f32,
    /// Surfaces fade into the sky from this distance from `fade_center_world`, in metres…
    pub fade_start_m: f32,
    /// …to this one.
    pub fade_end_m: f32,
    /// Scene space.
    pub fade_center_world: Vec3,
}

/// A white surface that faces the brightest light gets this much before tone mapping, if that light comes from straight above…
const KEY: f32 = 1.05;
/// …and up to this much less of the exposure is taken for granted from a light at the horizon: level ground gets little of it, and the eye opens.
const LOW_LIGHT: f64 = 0.5;

/// At half its range, glTF's window leaves a light 15 / 16 of its strength.
const RANGE_SHARE: f64 = 0.5;

/// The ground fades from 3 to 9 radii of the model: far enough for a low sun's shadows, near enough for no horizon line.
const FADE_RADII: [f32; 2] = [3.0, 9.0];

impl Look {
    /// Neither exposure nor fading.
    pub const NONE: Self =
        Self { exposure: 1.0, fade_start_m: f32::MAX, fade_end_m: f32::MAX, fade_center_world: Vec3::ZERO };

    /// Exposed for what `lights` give together in the middle of `model`, or on the surface of its bounding sphere where a light is inside; but not
    /// more than the brightest of them allows where it still has most of its strength.
    pub fn for_model(model: &Bounds, lights: &[Light]) -> Self {
        let radius = model.radius().max(f64::MIN_POSITIVE);
        let (mut together, mut brightest) = (DVec3::ZERO, 0.0_f64);
        for light in lights {
            let offset = light.position.offset_from(model.center());
            let height = (offset.z / offset.length().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let strength = light.strength.as_dvec3() * (1.0 - LOW_LIGHT * (1.0 - height));
            if light.position.is_directional() {
                together += strength;
                continue;
            }
            let distance = offset.length().max(radius);
            let range = light.range_m.unwrap_or(f64::INFINITY);
            together += strength / (distance * distance) * (1.0 - (distance / range).powi(4)).max(0.0);
            let bright_distance = distance.min(range * RANGE_SHARE);
            brightest = brightest.max(strength.max_element() / (bright_distance * bright_distance));
        }
        let brightest = brightest.max(together.max_element()) as f32;
        Self {
            exposure: if brightest > 0.0 { KEY / brightest } else { 1.0 },
            fade_start_m: radius as f32 * FADE_RADII[0],
            fade_end_m: radius as f32 * FADE_RADII[1],
            fade_center_world: model.center().as_vec3(),
        }
    }
}
