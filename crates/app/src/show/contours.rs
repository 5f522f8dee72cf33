//! The three silhouettes of smooth bodies: of their triangles, of their normals on the mesh, and of the surface that they stand for.
//!
//! O. Mattausch et al. 2012, figures 2 and 4.

use umbrae_core::{Caster, LightPosition, SmoothBody, SmoothVolume, Smoothness};
use umbrae_render::{GpuScene, Overlay, OverlayColor, OverlayVertex, Smooth};

use super::Subject;
use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::counted;
use super::outlines::{Outlines, line_width_px};

/// Apart for every eye, and from what is lit and what is not.
const DISCRETE: Rgb = [230, 120, 20];
const ACCURATE: Rgb = [30, 110, 230];
const SMOOTH: Rgb = [205, 20, 120];

/// The lines of every smooth caster that is drawn under `lights`.
pub(super) fn contours(subject: &Subject<'_>, scene: &GpuScene, smooth: Smooth, lights: &[usize]) -> (Overlay, Legend) {
    let mut overlay = Overlay { hidden_opacity: 0.15, ..Overlay::default() };
    let (mut discrete, mut accurate, mut smoothed) = (0, 0, 0);
    for &light in lights {
        let position = subject.lights[light].position.rounded_to_f32();
        for (caster, edges) in Outlines::new(subject, light).casters {
            let Some(body) = index_of(subject, caster).and_then(|i| scene.body(i)) else { continue };
            discrete += edges.len();
            let color = OverlayColor::new(DISCRETE, 1.0);
            let at = |v: u32| OverlayVertex::at(caster.positions[v as usize], color);
            overlay.lines.extend(edges.iter().map(|edge| [edge.start, edge.end].map(at)));
            accurate += add(&mut overlay, body, position, &Smoothness::Accurate, ACCURATE);
            let receivers = Caster::bounds_of(subject.casters);
            if let Some(smoothness) = smooth.smoothness(subject.camera, receivers) {
                smoothed += add(&mut overlay, body, position, &smoothness, SMOOTH);
            }
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

fn index_of(subject: &Subject<'_>, caster: &Caster) -> Option<usize> {
    subject.casters.iter().position(|other| std::ptr::eq(other, caster))
}

/// Returns how many lines.
fn add(overlay: &mut Overlay, body: &SmoothBody, light: LightPosition, smoothness: &Smoothness, color: Rgb) -> usize {
    let volume = SmoothVolume::new(body, light, smoothness);
    let color = OverlayColor::new(color, 1.0);
    let at = |p: u32| OverlayVertex::at(volume.points[p as usize], color);
    overlay.lines.extend(volume.sides.iter().map(|side| side.map(at)));
    volume.sides.len()
}
