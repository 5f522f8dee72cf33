//! Shadow volumes and silhouettes over the lit picture.

use glam::{DVec2, DVec3, DVec4};
use umbrae_core::{Caster, Chain, Counting, Light, LightPosition, SilhouetteEdge, Windings, silhouette};
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::counted;
use super::{Subject, names_of};

/// C. Wallner, "Geometry of real time shadows", 2007, figures 5 and 6: volumes yellow, silhouettes pink.
const VOLUME: Rgb = [225, 196, 20];
const SILHOUETTE: Rgb = [225, 40, 140];
/// Edges that are extruded more than once, as where three sheets meet.
const MULTIPLE: Rgb = [70, 60, 220];

/// The outlines of one light.
struct Outlines<'a> {
    light: LightPosition,
    /// Of each caster that casts, but the ground.
    casters: Vec<(&'a Caster, Vec<SilhouetteEdge>)>,
}

impl<'a> Outlines<'a> {
    /// Linear in the number of triangles.
    fn new(subject: &Subject<'a>, light: &Light) -> Self {
        let light = light.position.rounded_to_f32();
        let edges_of = |caster: &'a Caster| {
            let seen = Windings::of_near_rectangle(caster, subject.camera);
            let counting = Counting::choose(caster, &seen, &Windings::of_light(caster, light));
            silhouette(&caster.topology, &Chain::new(caster, light, &counting))
        };
        let casters = subject.models().filter(|(_, caster)| caster.role.casts);
        Self { light, casters: casters.map(|(_, caster)| (caster, edges_of(caster))).collect() }
    }

    /// The sides of the volumes, each edge's once whatever its multiplicity: two near corners, and the far ones at infinity.
    fn sides(&self) -> impl Iterator<Item = [DVec4; 4]> + '_ {
        self.casters.iter().flat_map(move |(caster, edges)| {
            edges.iter().map(move |edge| {
                let [a, b] = [edge.start, edge.end].map(|v| caster.positions[v as usize].as_dvec3());
                let far = |p: DVec3| -self.light.offset_from(p).extend(0.0);
                [a.extend(1.0), b.extend(1.0), far(b), far(a)]
            })
        })
    }
}

/// A side seen through this many others is still seen: what one covers depends on how many there are.
const FAINTEST: f32 = 0.055;
const STRONGEST: f32 = 0.20;
/// As many layers as half the picture's volumes cover together leave this much of the picture to be seen.
const LEFT_TO_SEE: f32 = 0.45;

/// The sides of all shadow volumes, translucent. Caps are left out: the light cap lies on the caster, and the dark cap is at infinity.
pub(super) fn volumes(subject: &Subject<'_>, lights: &[&Light]) -> (Overlay, Legend) {
    let mut quads = Vec::new();
    let mut bodies = 0;
    for light in lights {
        let outlines = Outlines::new(subject, light);
        bodies += outlines.casters.iter().filter(|(_, edges)| !edges.is_empty()).count();
        quads.extend(outlines.sides());
    }
    let opacity = (1.0 - LEFT_TO_SEE.powf(1.0 / layers(subject, &quads))).clamp(FAINTEST, STRONGEST);
    let color = OverlayColor::new(VOLUME, opacity);
    let vertex = |p: DVec4| OverlayVertex { position_world: p.as_vec4(), color };
    let triangles = quads.iter().flat_map(|quad| {
        let [a, b, b_far, a_far] = quad.map(vertex);
        // The far corners of a directional light are one point.
        let second = (b_far.position_world != a_far.position_world).then_some([a, a_far, b_far]);
        std::iter::once([a, b_far, b]).chain(second)
    });
    let overlay = Overlay { triangles: triangles.collect(), ..Overlay::default() };
    let legend = Legend::new(format!("Shadow volumes of {}", names_of(lights, subject.lights)))
        .entry(Swatch::Area(VOLUME), "sides, from silhouettes to infinity: the more behind each other, the stronger")
        .text(format!("{} of {}", counted(quads.len(), "side"), counted(bodies, "volume")))
        .text("What is inside a volume is in shadow");
    (overlay, legend)
}

/// How many sides lie behind each other on the rays of the picture that meet any, on average.
fn layers(subject: &Subject<'_>, quads: &[[DVec4; 4]]) -> f32 {
    let camera = subject.camera;
    let clip_from_world = camera.clip_from_world();
    // Enough for a mean that is only to choose an opacity.
    let every = quads.len().div_ceil(MOST_SIDES_LOOKED_AT).max(1);
    let looked_at: Vec<[DVec4; 4]> =
        quads.iter().step_by(every).map(|quad| quad.map(|p| clip_from_world * p)).collect();
    let [columns, rows] = RAYS;
    let mut counts = Vec::new();
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        let place = |i: usize, n: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
        let (x, y) = (place(x, columns), place(y, rows));
        let met = looked_at.iter().filter(|quad| is_met(quad, x, y)).count() * every;
        counts.extend((met > 0).then_some(met as f32));
    }
    counts.iter().sum::<f32>().max(1.0) / counts.len().max(1) as f32
}

/// Rays across and down.
const RAYS: [usize; 2] = [20, 12];
const MOST_SIDES_LOOKED_AT: usize = 20_000;

/// Whether the ray through the picture at `(x, y)`, each -1 to 1, meets a convex face with these corners in clip space, in front of the eye.
fn is_met(corners: &[DVec4; 4], x: f64, y: f64) -> bool {
    // From where the ray is the axis.
    let flat = corners.map(|c| [c.x - x * c.w, c.y - y * c.w, c.w]);
    let turn = |i: usize| {
        let ([ax, ay, _], [bx, by, _]) = (flat[i], flat[(i + 1) % 4]);
        ax * by - ay * bx
    };
    let turns = [turn(0), turn(1), turn(2), turn(3)];
    let is_around = turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0);
    is_around && turns.iter().any(|&t| t != 0.0) && flat.iter().any(|corner| corner[2] > 0.0)
}

/// Lines of 2.5 pixels may cover this share of the picture; where there are more of them, they are thinner, but no thinner than this.
const MOST_COVERED: f64 = 0.10;
const THINNEST_PX: f64 = 1.0;

/// The width of `lines`, in pixels, that leaves enough of the picture to be seen.
fn line_width_px(subject: &Subject<'_>, lines: &[[OverlayVertex; 2]], widest_px: f32) -> f32 {
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
pub(super) fn silhouettes(subject: &Subject<'_>, lights: &[&Light]) -> (Overlay, Legend) {
    let mut overlay = Overlay { hidden_opacity: 0.22, ..Overlay::default() };
    let (mut single, mut multiple, mut all) = (0, 0, 0);
    for light in lights {
        for (caster, edges) in &Outlines::new(subject, light).casters {
            all += caster.topology.edges().len();
            for edge in edges {
                let color = if edge.multiplicity == 1 { SILHOUETTE } else { MULTIPLE };
                *(if edge.multiplicity == 1 { &mut single } else { &mut multiple }) += 1;
                let color = OverlayColor::new(color, 1.0);
                overlay
                    .lines
                    .push([edge.start, edge.end].map(|v| OverlayVertex::at(caster.positions[v as usize], color)));
            }
        }
    }
    let widest_px = overlay.line_width_px;
    overlay.line_width_px = line_width_px(subject, &overlay.lines, widest_px);
    // Hidden lines of a crowd would be a haze.
    overlay.hidden_opacity *= (overlay.line_width_px / widest_px).powi(2);
    let mut legend = Legend::new(format!("Silhouettes of {}", names_of(lights, subject.lights)))
        .entry(Swatch::Line(SILHOUETTE), format!("outlines as the light sees them: {}", counted(single, "edge")));
    if multiple > 0 {
        let meaning = format!("edges that count more than once, as in open models: {}", counted(multiple, "edge"));
        legend = legend.entry(Swatch::Line(MULTIPLE), meaning);
    }
    let share = 100.0 * (single + multiple) as f64 / all.max(1) as f64;
    legend = legend.text(format!("{share:.1} % of {}; faint where hidden", counted(all, "edge")));
    (overlay, legend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_a_face_in_front_of_the_eye_that_surrounds_it() {
        let square =
            |w: f64| [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec4::new(x, y, 0.1, w));
        assert!(is_met(&square(2.0), 0.1, 0.4));
        assert!(!is_met(&square(2.0), 0.1, 0.6));
        assert!(!is_met(&square(-2.0), 0.1, 0.1), "it is behind the eye");
        let mut turned = square(2.0);
        turned.reverse();
        assert!(is_met(&turned, 0.1, 0.4));
    }
}
