//! Where in the picture a convex body shows.
//!
//! A body's faces may have corners at infinity and behind the eye, so they are cut to the view in homogeneous coordinates before
//! anything is divided. What is left of them, and the corners of the view that are inside the body, span the rectangle.

use glam::{DMat4, DVec4};

use crate::Camera;
use crate::few::Few;

/// Pixels of a picture: x to the right, y down, `max` not included. Never empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PixelRect {
    /// The first column and row.
    pub min: [u32; 2],
    /// One past the last column and row.
    pub max: [u32; 2],
}

impl PixelRect {
    /// Every pixel of a picture of this size; `None` when it has none.
    pub fn whole(size_px: [u32; 2]) -> Option<Self> {
        Self { min: [0; 2], max: size_px }.if_any()
    }

    /// The pixels in both; `None` when there are none.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let each = |f: fn(u32, u32) -> u32, a: [u32; 2], b: [u32; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Self { min: each(u32::max, self.min, other.min), max: each(u32::min, self.max, other.max) }.if_any()
    }

    /// The number of pixels.
    pub fn area(&self) -> u64 {
        let [width, height] = self.size();
        u64::from(width) * u64::from(height)
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    /// Whether the pixel in this column and row is one of them.
    pub fn contains(&self, [x, y]: [u32; 2]) -> bool {
        (self.min[0]..self.max[0]).contains(&x) && (self.min[1]..self.max[1]).contains(&y)
    }

    fn if_any(self) -> Option<Self> {
        (self.min[0] < self.max[0] && self.min[1] < self.max[1]).then_some(self)
    }
}

/// A rasteriser moves corners by up to 1/256 pixel, and whoever draws differs from us by some roundings.
const MARGIN_PX: f64 = 0.25;
/// The picture is widened by so much on every side before bodies are cut to it, so that the margin counts there too.
const BORDER_PX: f64 = 2.0;
/// The part of the near distance at which bodies are cut: `f32` may see a little more.
const NEAR: f64 = 0.999;

/// A camera's picture as the five half-spaces of clip space.
#[derive(Debug, Clone)]
pub(crate) struct Screen {
    clip_from_world: DMat4,
    /// What is seen has a product of at least 0 with each.
    planes: [DVec4; 5],
    /// The view's own corners: those of the near rectangle and the four directions through them.
    corners: [DVec4; 8],
    size_px: [u32; 2],
}

impl Screen {
    pub(crate) fn new(camera: &Camera) -> Self {
        let size_px = camera.size_px();
        let [width, height] = size_px.map(|n| 1.0 + 2.0 * BORDER_PX / f64::from(n));
        let planes = [
            // Clip space has w = view depth and z = near * the point's own w.
            DVec4::new(0.0, 0.0, -NEAR, 1.0),
            DVec4::new(1.0, 0.0, 0.0, width),
            DVec4::new(-1.0, 0.0, 0.0, width),
            DVec4::new(0.0, 1.0, 0.0, height),
            DVec4::new(0.0, -1.0, 0.0, height),
        ];
        let near = camera.near_rectangle();
        let corners =
            std::array::from_fn(|i| if i < 4 { near[i].extend(1.0) } else { (near[i - 4] - camera.eye()).extend(0.0) });
        Self { clip_from_world: camera.clip_from_world(), planes, corners, size_px }
    }

    pub(crate) fn whole(&self) -> Option<PixelRect> {
        PixelRect::whole(self.size_px)
    }

    /// The pixels where the convex body shows that has these flat faces, and holds the points for which `holds` says so; `None` when it
    /// is out of view.
    pub(crate) fn rect_of<'a>(
        &self,
        faces: impl IntoIterator<Item = &'a [DVec4]>,
        holds: impl Fn(DVec4) -> bool,
    ) -> Option<PixelRect> {
        let mut extent = Extent { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        let (mut polygon, mut clipped) = (Polygon::default(), Polygon::default());
        for face in faces {
            polygon.clear();
            polygon.extend(face.iter().map(|&corner| self.clip_from_world * corner));
            for plane in &self.planes {
                clip(&polygon, plane, &mut clipped);
                std::mem::swap(&mut polygon, &mut clipped);
            }
            for &corner in polygon.iter() {
                extent.include(corner);
            }
        }
        for &corner in self.corners.iter().filter(|&&corner| holds(corner)) {
            extent.include(self.clip_from_world * corner);
        }
        self.rounded(&extent)
    }

    /// Outwards, and within the picture.
    fn rounded(&self, extent: &Extent) -> Option<PixelRect> {
        let pixels = |along: usize, from: f64, to: f64| {
            let size = f64::from(self.size_px[along]);
            let [from, to] = [from, to].map(|at| 0.5 * (at + 1.0) * size);
            // A cast saturates: what is left of the picture becomes its first pixel.
            [(from - MARGIN_PX).floor().clamp(0.0, size) as u32, (to + MARGIN_PX).ceil().clamp(0.0, size) as u32]
        };
        if extent.min[0] > extent.max[0] {
            return None;
        }
        let [left, right] = pixels(0, extent.min[0], extent.max[0]);
        // Clip space has y up.
        let [top, bottom] = pixels(1, -extent.max[1], -extent.min[1]);
        PixelRect { min: [left, top], max: [right, bottom] }.if_any()
    }
}

/// A rectangle in normalised device coordinates.
struct Extent {
    min: [f64; 2],
    max: [f64; 2],
}

impl Extent {
    /// `corner` is within the widened view, where only rounding leaves a `w` that can't be divided by.
    fn include(&mut self, corner: DVec4) {
        let is_on_screen = corner.w > 0.0;
        for (along, at) in [corner.x, corner.y].into_iter().enumerate() {
            let [low, high] = if is_on_screen { [at / corner.w; 2] } else { [-2.0, 2.0] };
            self.min[along] = self.min[along].min(low);
            self.max[along] = self.max[along].max(high);
        }
    }
}

/// Each plane of the view adds a corner at most to a quad.
type Polygon = Few<DVec4, 9>;

/// The part of a flat, convex polygon on the inner side of `plane`.
fn clip(polygon: &[DVec4], plane: &DVec4, clipped: &mut Polygon) {
    clipped.clear();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at_p, at_q) = (plane.dot(p), plane.dot(q));
        if at_p >= 0.0 {
            clipped.push(p);
        }
        if (at_p >= 0.0) != (at_q >= 0.0) {
            // Both weights positive, so that w stays at least 0.
            clipped.push((p * at_q.abs() + q * at_p.abs()) / (at_p.abs() + at_q.abs()));
        }
    }
}
