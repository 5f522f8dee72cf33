//! Where one light reaches, in space and in the picture, and the rectangles to which its volumes are confined.

use glam::DVec4;
use umbrae_core::{Light, PixelRect, Reach};
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::canvas::{Area, Canvas, Rgb};
use super::legend::{Legend, Swatch};
use super::numbers::counted;
use super::outlines::line_width_px;
use super::{Subject, quoted};

const REACH: Rgb = [225, 120, 10];
const LIGHT_RECT: Rgb = [225, 50, 60];
const CASTER_RECT: Rgb = [40, 120, 215];
/// With more rectangles than this, each is fainter.
const OPAQUE_RECTS: f32 = 12.0;
/// Surfaces within reach get this much…
const TINT: f32 = 0.34;
/// …of this colour.
const REACHED: Rgb = [250, 170, 60];

/// The edges of the body around a light's reach; nothing where it has no end.
pub(super) fn reach(subject: &Subject<'_>, light: usize) -> Overlay {
    let lines = outline(&subject.lights[light]);
    let line_width_px = line_width_px(subject, &lines, 2.5);
    Overlay { lines, line_width_px, hidden_opacity: 0.3, ..Overlay::default() }
}

fn outline(light: &Light) -> Vec<[OverlayVertex; 2]> {
    let color = OverlayColor::new(REACH, 1.0);
    let edges = Reach::of(light).map(|reach| edges_of(reach.faces())).unwrap_or_default();
    let vertex = |p: DVec4| OverlayVertex { position_world: p.as_vec4(), color };
    edges.into_iter().map(|edge| edge.map(vertex)).collect()
}

/// Each edge of a closed surface once; those inside a flat face, and those at infinity, are left out.
fn edges_of(faces: &[[DVec4; 3]]) -> Vec<[DVec4; 2]> {
    let mut edges = Vec::new();
    for face in faces {
        for i in 0..3 {
            let (a, b) = (face[i], face[(i + 1) % 3]);
            // The other face walks the edge the other way.
            let is_first = a.to_array().partial_cmp(&b.to_array()).is_some_and(std::cmp::Ordering::is_lt);
            let is_at_infinity = a.w == 0.0 && b.w == 0.0;
            if !is_first || is_at_infinity {
                continue;
            }
            let across = |other: &[DVec4; 3]| {
                (0..3).find(|&j| other[j] == b && other[(j + 1) % 3] == a).map(|j| other[(j + 2) % 3])
            };
            let opposite = faces.iter().find_map(across);
            let is_flat = opposite.is_some_and(|corner| is_in_plane(corner, *face));
            if !is_flat {
                edges.push([a, b]);
            }
        }
    }
    edges
}

/// Relative to the sizes of what is multiplied.
const FLAT: f64 = 1e-9;

fn is_in_plane(p: DVec4, face: [DVec4; 3]) -> bool {
    let origin = face.into_iter().find(|corner| corner.w != 0.0).unwrap_or(DVec4::W);
    let relative = |corner: DVec4| (corner - origin * corner.w).truncate();
    let [a, b, c] = face.map(relative);
    let normal = (b - a).cross(c - a);
    normal.dot(relative(p)).abs() <= FLAT * normal.length() * relative(p).length()
}

/// Draws the rectangles over a picture, and tints the surfaces that the light can reach.
pub(super) fn draw(canvas: &mut Canvas<'_>, subject: &Subject<'_>, light: usize) -> Legend {
    let (light, report) = (&subject.lights[light], &subject.reports[light]);
    let mut legend = Legend::new(format!("Bounds of {}", quoted(&light.name)));
    if let Some(reach) = Reach::of(light) {
        let share = tint_within(canvas, subject, &reach);
        legend = legend
            .entry(Swatch::Line(REACH), "around its reach; faint where hidden")
            .entry(Swatch::Area(REACHED), format!("surfaces in it: {share:.1} % of the picture"));
    } else {
        legend = legend.text("It reaches everywhere: no range, no cone");
    }

    // Larger rectangles first, so that small ones stay visible.
    let thickness = (canvas.height() / 360).max(1);
    let mut rects: Vec<PixelRect> = report.casters.iter().filter_map(|caster| caster.rect).collect();
    let of_whole = 100.0 / (f64::from(canvas.width()) * f64::from(canvas.height())).max(1.0);
    let percent = |rect: &PixelRect| rect.area() as f64 * of_whole;
    let volumes = rects.len();
    let mean = rects.iter().map(percent).sum::<f64>() / volumes.max(1) as f64;
    rects.sort_by_key(|rect| std::cmp::Reverse(rect.area()));
    rects.dedup();
    // Many would hide the picture.
    let opacity = (OPAQUE_RECTS / rects.len().max(1) as f32).clamp(0.12, 0.9);
    for rect in &rects {
        canvas.frame(area_of(rect), thickness, CASTER_RECT, opacity);
    }
    if let Some(rect) = &report.rect {
        canvas.frame(area_of(rect), 2 * thickness, LIGHT_RECT, 1.0);
    }
    let of_light = report
        .rect
        .as_ref()
        .map_or("nothing: it is out of view".to_owned(), |rect| format!("{:.1} % of the picture", percent(rect)));
    legend.entry(Swatch::Frame(LIGHT_RECT), format!("its scissor: {of_light}")).entry(
        Swatch::Frame(CASTER_RECT),
        format!("scissors of {}, {mean:.1} % on average", counted(volumes, "volume")),
    )
}

fn area_of(rect: &PixelRect) -> Area {
    let [x, y] = rect.min.map(|c| c as i32);
    let [width, height] = rect.size().map(|c| c as i32);
    Area::new(x, y, width, height)
}

/// Tints each pixel in which a surface within `reach` is seen, by a ray through its centre; returns how many per cent of the picture that are.
fn tint_within(canvas: &mut Canvas<'_>, subject: &Subject<'_>, reach: &Reach) -> f64 {
    let rays = subject.rays();
    let camera = subject.camera;
    let mut reached = 0_u64;
    for y in 0..canvas.height() {
        for x in 0..canvas.width() {
            let direction = camera.ray_direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let Some(hit) = rays.first_hit(camera.eye(), direction, camera.near(), f64::INFINITY) else { continue };
            let point = camera.eye() + direction * hit.t;
            if reach.region().contains(point.extend(1.0)) {
                reached += 1;
                canvas.mix(x, y, REACHED, TINT);
            }
        }
    }
    100.0 * reached as f64 / (f64::from(canvas.width()) * f64::from(canvas.height()))
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};
    use umbrae_core::{Cone, LightPosition};

    use super::*;

    fn lamp() -> Light {
        Light { range_m: Some(2.0), ..Light::new("lamp", LightPosition::point(DVec3::new(1.0, 2.0, 3.0)), Vec3::ONE) }
    }

    #[test]
    fn the_reach_of_a_lamp_has_the_ninety_edges_of_its_sixty_triangles() {
        assert_eq!(outline(&lamp()).len(), 90);
    }

    #[test]
    fn an_endless_cone_has_as_many_edges_as_sides() {
        let cone = Cone { axis: DVec3::NEG_Z, inner_rad: 0.2, outer_rad: 0.4 };
        let light = Light { cone: Some(cone), range_m: None, ..lamp() };
        let lines = outline(&light);
        assert_eq!(lines.len(), 12);
        assert!(
            lines.iter().all(|[a, b]| a.position_world.w + b.position_world.w == 1.0),
            "from the light to infinity"
        );
    }

    #[test]
    fn the_edges_within_the_flat_faces_of_a_cone_with_a_range_are_left_out() {
        let cone = Cone { axis: DVec3::NEG_Z, inner_rad: 0.1, outer_rad: 0.2 };
        let light = Light { cone: Some(cone), ..lamp() };
        // Twelve sides and twelve edges of a flat cap: its fan lies in one plane.
        assert_eq!(outline(&light).len(), 24);
    }

    #[test]
    fn a_light_without_end_has_no_outline() {
        assert!(outline(&Light { range_m: None, ..lamp() }).is_empty());
    }
}
