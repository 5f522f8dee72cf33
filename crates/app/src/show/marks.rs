//! Signs with names at the places of lights.

use glam::DVec3;
use umbrae_core::{Camera, Light};

use super::canvas::{Area, Canvas, Rgb};
use super::text::TextStyle;

const RIM: Rgb = [30, 30, 34];
const GLOW: Rgb = [255, 214, 60];
const INK: Rgb = [250, 250, 246];

/// Where a point is in the picture, in pixels from its top left corner; `None` behind the near plane or beyond the picture.
fn project(camera: &Camera, point: DVec3) -> Option<[f32; 2]> {
    let clip = camera.clip_from_world() * point.extend(1.0);
    let is_seen = clip.w >= clip.z && clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w;
    let [width, height] = camera.size_px().map(f64::from);
    let place = [0.5 * (1.0 + clip.x / clip.w) * width, 0.5 * (1.0 - clip.y / clip.w) * height];
    is_seen.then(|| place.map(|c| c as f32))
}

/// A disc and the name, where a lamp is in view, hidden or not. A light at infinity has no place.
pub(super) fn draw_light(canvas: &mut Canvas<'_>, camera: &Camera, light: &Light) {
    if light.position.is_directional() {
        return;
    }
    let Some([x, y]) = project(camera, light.position.homogeneous().truncate()) else { return };
    let line_height = TextStyle::line_height_for(canvas.height().min(canvas.width()));
    let radius = line_height as f32 * 0.36;
    canvas.disc([x, y], radius + line_height as f32 * 0.12, RIM);
    canvas.disc([x, y], radius, GLOW);

    let style = TextStyle::new(line_height, false);
    let (width, pad) = (style.width(&light.name), line_height / 5);
    let beside = x as i32 + line_height;
    let left = if beside + width + pad <= canvas.width() { beside } else { x as i32 - line_height - width };
    let left = left.clamp(pad.min(canvas.width()), (canvas.width() - width - pad).max(pad));
    let top = (y as i32 - line_height / 2).clamp(0, (canvas.height() - line_height).max(0));
    canvas.fill(Area::new(left - pad, top, width + 2 * pad, line_height), RIM, 0.7);
    canvas.text(left, top, &light.name, style, INK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_eye_looks_at_is_in_the_middle() {
        let camera = Camera::new(DVec3::new(3.0, -8.0, 4.0), DVec3::ONE, 0.7, 0.1, [200, 100]).expect("a good camera");
        let [x, y] = project(&camera, DVec3::ONE).expect("it is seen");
        assert!((x - 100.0).abs() < 1e-3 && (y - 50.0).abs() < 1e-3);
        assert_eq!(project(&camera, DVec3::new(5.0, -17.0, 7.0)), None, "it is behind the eye");
        assert_eq!(project(&camera, DVec3::new(90.0, 1.0, 1.0)), None, "it is beyond the right side");
    }
}
