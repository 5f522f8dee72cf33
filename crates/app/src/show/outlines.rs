//! The outlines of casters as lights see them, and as lines over the lit picture.

use glam::{DVec2, DVec4};
use umbrae_core::{Caster, Chain, Counting, SilhouetteEdge, Windings, silhouette};
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::Subject;
use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::counted;

/// C. Wallner, "Geometry of real time shadows", 2007, figure 6: silhouettes are pink.
const SILHOUETTE: Rgb = [225, 40, 140];
/// Edges that are extruded more than once, as where three sheets meet.
const MULTIPLE: Rgb = [70, 60, 220];

/// The outlines of one light.
pub(super) struct Outlines<'a> {
    /// Of each caster whose volume was drawn, but the ground's.
    pub(super) casters: Vec<(&'a Caster, Vec<SilhouetteEdge>)>,
}

impl<'a> Outlines<'a> {
    /// Those of the light with this index. Linear in the number of triangles.
    pub(super) fn new(subject: &Subject<'a>, light: usize) -> Self {
        let drawn = &subject.reports[light].casters;
        let light = subject.lights[light].position.rounded_to_f32();
        let edges_of = |caster: &'a Caster| {
            let seen = Windings::of_near_rectangle(caster, subject.camera);
            let counting = Counting::choose(caster, &seen, &Windings::of_light(caster, light));
            silhouette(&caster.topology, &Chain::new(caster, light, &counting))
        };
        let casters = subject.models().filter(|&(i, _)| drawn[i].case().is_some());
        Self { casters: casters.map(|(_, caster)| (caster, edges_of(caster))).collect() }
    }
}

/// Lines of 2.5 pixels may cover this share of the picture; where there are more of them, they are thinner, but no thinner than this.
const MOST_COVERED: f64 = 0.10;
const THINNEST_PX: f64 = 1.0;

/// The width of `lines`, in pixels, that leaves enough of the picture to be seen.
pub(super) fn line_width_px(subject: &Subject<'_>, lines: &[[OverlayVertex; 2]], widest_px: f32) -> f32 {
    let clip_from_world = subject.camera.clip_from_world();
    let [width, height] = subject.camera.size_px().map(f64::from);
    let length_px = |ends: &[OverlayVertex; 2]| {
        let [a, b] = ends.map(|end| clip_from_world * end.position_world.as_dvec4());
        let is_in_view = |p: &DVec4| p.w > p.z.max(0.0) && p.x.abs().max(p.y.abs()) <= p.w;
        // Lines partly out of view are few.
        let is_seen = is_in_view(&a) && is_in_view(&b);
        let offset = (a / a.w - b / b.w).truncate().truncate() * 0.5 * DVec2::new(width, height);
        if is_seen { offset.length() } else { 0.0 }
    };
    let total_px: f64 = lines.iter().map(length_px).sum();
    (MOST_COVERED * width * height / total_px.max(1.0)).clamp(THINNEST_PX, widest_px.into()) as f32
}

/// The silhouette edges of all casters.
pub(super) fn silhouettes(subject: &Subject<'_>, lights: &[usize]) -> (Overlay, Legend) {
    let mut overlay = Overlay { hidden_opacity: 0.22, ..Overlay::default() };
    let (mut single, mut multiple, mut all, mut objects) = (0, 0, 0, 0);
    for &light in lights {
        for (caster, edges) in &Outlines::new(subject, light).casters {
            objects += 1;
            all += caster.topology.edges().len();
            for edge in edges {
                let color = if edge.multiplicity == 1 { SILHOUETTE } else { MULTIPLE };
                *(if edge.multiplicity == 1 { &mut single } else { &mut multiple }) += 1;
                let color = OverlayColor::new(color, 1.0);
                let at = |v: u32| OverlayVertex::at(caster.positions[v as usize], color);
                overlay.lines.push([edge.start, edge.end].map(at));
            }
        }
    }
    let widest_px = overlay.line_width_px;
    overlay.line_width_px = line_width_px(subject, &overlay.lines, widest_px);
    // Hidden lines of a crowd would be a haze.
    overlay.hidden_opacity *= (overlay.line_width_px / widest_px).powi(2);
    let mut legend = Legend::new(format!("Silhouettes of {}", subject.names_of(lights)))
        .entry(Swatch::Line(SILHOUETTE), format!("outlines as the light sees them: {}", counted(single, "edge")));
    if multiple > 0 {
        let meaning = format!("edges that count more than once, as in open models: {}", counted(multiple, "edge"));
        legend = legend.entry(Swatch::Line(MULTIPLE), meaning);
    }
    let share = 100.0 * (single + multiple) as f64 / all.max(1) as f64;
    let of_objects = format!("{} of {}", counted(all, "edge"), counted(objects, "object"));
    legend = legend.text(format!("{share:.1} % of {of_objects}")).text("Faint where hidden");
    (overlay, legend)
}
