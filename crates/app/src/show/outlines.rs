//! The outlines of casters as lights see them, and as lines over the lit picture.

use glam::{DVec2, DVec4, Vec3};
use umbrae_core::{
    Caster, Chain, Counting, SilhouetteEdge, SmoothBody, SmoothVolume, Smoothness, Windings, silhouette,
};
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::Subject;
use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::counted;

/// C. Wallner, "Geometry of real time shadows", 2007, figure 6: silhouettes are pink.
const SILHOUETTE: Rgb = [225, 40, 140];
/// Edges that are extruded more than once, as where three sheets meet.
const MULTIPLE: Rgb = [70, 60, 220];

/// The outline of one caster.
pub(super) struct Outline<'a> {
    pub(super) caster: &'a Caster,
    /// If it is smooth.
    pub(super) body: Option<&'a SmoothBody>,
    pub(super) lines: Vec<Line>,
}

/// A straight piece of an outline, scene space.
pub(super) struct Line {
    pub(super) ends: [Vec3; 2],
    /// How often it is extruded.
    pub(super) multiplicity: u32,
}

impl<'a> Outline<'a> {
    /// What casts: of each caster whose volume was drawn for the light with this index, but the ground's. Linear in the number of triangles.
    pub(super) fn all(subject: &Subject<'a>, light: usize) -> Vec<Self> {
        let smoothness = smoothness(subject);
        let position = subject.lights[light].position.rounded_to_f32();
        let mut outlines = Self::all_of_triangles(subject, light);
        for outline in &mut outlines {
            if let (Some(body), Some(smoothness)) = (outline.body, &smoothness) {
                outline.lines = lines_of(&SmoothVolume::new(body, position, smoothness));
            }
        }
        outlines
    }

    /// The same, but of their triangles where they are smooth.
    pub(super) fn all_of_triangles(subject: &Subject<'a>, light: usize) -> Vec<Self> {
        let drawn = &subject.reports[light].casters;
        let light = subject.lights[light].position.rounded_to_f32();
        let outline = |(i, caster): (usize, &'a Caster)| {
            let seen = Windings::of_near_rectangle(caster, subject.camera);
            let counting = Counting::choose(caster, &seen, &Windings::of_light(caster, light));
            let edges = silhouette(&caster.topology, &Chain::new(caster, light, &counting));
            let line = |edge: &SilhouetteEdge| {
                let ends = [edge.start, edge.end].map(|v| caster.positions[v as usize]);
                Line { ends, multiplicity: edge.multiplicity }
            };
            Self { caster, body: subject.scene.body(i), lines: edges.iter().map(line).collect() }
        };
        subject.models().filter(|&(i, _)| drawn[i].case().is_some()).map(outline).collect()
    }
}

/// What the silhouettes of smooth bodies follow in the picture.
pub(super) fn smoothness(subject: &Subject<'_>) -> Option<Smoothness> {
    subject.smooth.smoothness(subject.camera, Caster::bounds_of(subject.casters))
}

/// The silhouette of `volume`.
pub(super) fn lines_of(volume: &SmoothVolume) -> Vec<Line> {
    let line = |side: &[u32; 2]| Line { ends: side.map(|p| volume.points[p as usize]), multiplicity: 1 };
    volume.sides.iter().map(line).collect()
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
    let (mut single, mut multiple, mut smooth, mut all, mut objects) = (0, 0, 0, 0, 0);
    for &light in lights {
        for outline in Outline::all(subject, light) {
            let is_smooth = outline.body.is_some();
            if !is_smooth {
                objects += 1;
                all += outline.caster.topology.edges().len();
            }
            for line in outline.lines {
                let is_single = line.multiplicity == 1;
                *(if is_smooth {
                    &mut smooth
                } else if is_single {
                    &mut single
                } else {
                    &mut multiple
                }) += 1;
                let color = OverlayColor::new(if is_single { SILHOUETTE } else { MULTIPLE }, 1.0);
                overlay.lines.push(line.ends.map(|end| OverlayVertex::at(end, color)));
            }
        }
    }
    let widest_px = overlay.line_width_px;
    overlay.line_width_px = line_width_px(subject, &overlay.lines, widest_px);
    // Hidden lines of a crowd would be a haze.
    overlay.hidden_opacity *= (overlay.line_width_px / widest_px).powi(2);
    let pieces = match (single, smooth) {
        (edges, 0) => counted(edges, "edge"),
        (0, pieces) => format!("{} of curves", counted(pieces, "piece")),
        (edges, pieces) => format!("{}, and {} of curves", counted(edges, "edge"), counted(pieces, "piece")),
    };
    let mut legend = Legend::new(format!("Silhouettes of {}", subject.names_of(lights)))
        .entry(Swatch::Line(SILHOUETTE), format!("outlines as the light sees them: {pieces}"));
    if multiple > 0 {
        let meaning = format!("edges that count more than once, as in open models: {}", counted(multiple, "edge"));
        legend = legend.entry(Swatch::Line(MULTIPLE), meaning);
    }
    if objects > 0 || smooth == 0 {
        let share = 100.0 * (single + multiple) as f64 / all.max(1) as f64;
        let of_objects = format!("{} of {}", counted(all, "edge"), counted(objects, "object"));
        legend = legend.text(format!("{share:.1} % of {of_objects}"));
    }
    (overlay, legend.text("Faint where hidden"))
}
