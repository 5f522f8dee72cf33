//! The three silhouettes of smooth bodies: of their triangles, of their normals on the mesh, and of the surface that they stand for.
//!
//! O. Mattausch et al. 2012, figures 2 and 4.

use umbrae_core::{SmoothVolume, Smoothness};
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::Subject;
use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::counted;
use super::outlines::{Line, Outline, line_width_px, lines_of, smoothness};

/// Apart for every eye, and from what is lit and what is not.
const DISCRETE: Rgb = [230, 120, 20];
const ACCURATE: Rgb = [30, 110, 230];
const SMOOTH: Rgb = [205, 20, 120];

/// The lines of every smooth caster that is drawn under `lights`.
pub(super) fn contours(subject: &Subject<'_>, lights: &[usize]) -> (Overlay, Legend) {
    let smoothness = smoothness(subject);
    let mut overlay = Overlay { hidden_opacity: 0.15, ..Overlay::default() };
    let (mut discrete, mut accurate, mut smoothed) = (0, 0, 0);
    for &light in lights {
        let position = subject.lights[light].position.rounded_to_f32();
        for outline in Outline::all_of_triangles(subject, light) {
            let Some(body) = outline.body else { continue };
            discrete += add(&mut overlay, &outline.lines, DISCRETE);
            let lines = |smoothness: &Smoothness| lines_of(&SmoothVolume::new(body, position, smoothness));
            accurate += add(&mut overlay, &lines(&Smoothness::Accurate), ACCURATE);
            smoothed += smoothness.as_ref().map_or(0, |smoothness| add(&mut overlay, &lines(smoothness), SMOOTH));
        }
    }
    let widest_px = overlay.line_width_px;
    overlay.line_width_px = line_width_px(subject, &overlay.lines, widest_px);
    let entry = |count: usize, of: &str| format!("{of}: {}", counted(count, "piece"));
    let legend = Legend::new(format!("Silhouettes of {}", subject.names_of(lights)))
        .entry(Swatch::Line(DISCRETE), entry(discrete, "of the triangles"))
        .entry(Swatch::Line(ACCURATE), entry(accurate, "where normals turn away, on the mesh"))
        .entry(Swatch::Line(SMOOTH), entry(smoothed, "on the smooth surface: what casts"))
        .text("Faint where hidden");
    (overlay, legend)
}

/// Returns how many lines.
fn add(overlay: &mut Overlay, lines: &[Line], color: Rgb) -> usize {
    let color = OverlayColor::new(color, 1.0);
    overlay.lines.extend(lines.iter().map(|line| line.ends.map(|end| OverlayVertex::at(end, color))));
    lines.len()
}
