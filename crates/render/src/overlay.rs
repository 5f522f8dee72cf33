//! What may be drawn over a lit picture: translucent triangles and lines, placed in the scene.
//!
//! This is the data; [`crate::Renderer`] draws it last, into the radiance, before tone mapping. Nothing of it casts, receives, or hides anything.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// Translucent triangles and lines over a lit picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// Drawn first, from both sides, where no surface is nearer; on a surface (the same corners) counts as not behind it.
    pub triangles: Vec<[OverlayVertex; 3]>,
    /// Drawn next, with round ends; where they lie on a surface they win over it.
    pub lines: Vec<[OverlayVertex; 2]>,
    /// Width of all lines, in pixels.
    pub line_width_px: f32,
    /// How much of its opacity a line keeps where a surface hides it, 0 to 1.
    pub hidden_opacity: f32,
}

impl Default for Overlay {
    /// Nothing; lines would be 2.5 pixels wide and seen only where nothing hides them.
    fn default() -> Self {
        Self { triangles: Vec::new(), lines: Vec::new(), line_width_px: 2.5, hidden_opacity: 0.0 }
    }
}

/// A point with a colour. `Vertex` in `overlay.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct OverlayVertex {
    /// Scene space, homogeneous: `w = 1` a point, `w = 0` the point at infinity in that direction.
    pub position_world: Vec4,
    /// How it is mixed with what is behind.
    pub color: OverlayColor,
}

impl OverlayVertex {
    /// A vertex at a point of the scene.
    pub fn at(position_world: Vec3, color: OverlayColor) -> Self {
        Self { position_world: position_world.extend(1.0), color }
    }

    /// A vertex infinitely far away in a direction, which must not be zero.
    pub fn towards(direction_world: Vec3, color: OverlayColor) -> Self {
        Self { position_world: direction_world.extend(0.0), color }
    }
}

/// Radiance times opacity, and opacity.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct OverlayColor(Vec4);

/// The tone mapper leaves radiance up to this as it is, less an offset.
const UNCOMPRESSED: f32 = 0.76;

impl OverlayColor {
    /// The colour that, where it is opaque, a picture shows as these sRGB bytes; `opacity` is 0 to 1.
    ///
    /// Exact where no byte is above 225; brighter colours are shown up to 15 levels darker, as the tone mapper shows all highlights.
    pub fn new(display_srgb: [u8; 3], opacity: f32) -> Self {
        let display = Vec3::from(display_srgb.map(linear_from_srgb)).min(Vec3::splat(UNCOMPRESSED));
        // The inverse of `neutral` in tone.wgsl below its compression, which takes away 0.04, or from a least channel x below 0.08, x - 6.25 x^2.
        let least = display.min_element();
        let offset = if least < 0.04 { (least / 6.25).sqrt() - least } else { 0.04 };
        Self(((display + offset) * opacity).extend(opacity))
    }

    /// How much it covers, 0 to 1.
    pub fn opacity(self) -> f32 {
        self.0.w
    }
}

fn linear_from_srgb(byte: u8) -> f32 {
    let c = f32::from(byte) / 255.0;
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
