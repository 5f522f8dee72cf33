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

/// One side covers as much as leaves this much to see through as many as lie behind each other in a crowded part of the picture…
const LEFT_TO_SEE: f32 = 0.35;
/// …which is more crowded than this share of all parts that have any…
const CROWDED: f64 = 0.85;
/// …but between these.
const FAINTEST: f32 = 0.004;
const STRONGEST: f32 = 0.2;

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

/// Rays across and down.
const RAYS: [usize; 2] = [24, 14];
/// Enough for a number that is only to choose an opacity.
const MOST_SIDES_LOOKED_AT: usize = 20_000;

/// How many sides lie in front of what is seen, in a crowded part of the picture.
fn layers(subject: &Subject<'_>, quads: &[[DVec4; 4]]) -> f32 {
    let camera = subject.camera;
    let clip_from_world = camera.clip_from_world();
    let in_view = |p: DVec4| DVec4 { z: p.w, ..clip_from_world * p };
    let every = quads.len().div_ceil(MOST_SIDES_LOOKED_AT).max(1);
    let sides: Vec<Side> = quads.iter().step_by(every).map(|quad| Side::new(quad.map(in_view))).collect();
    let surfaces = subject.rays();
    let [width, height] = camera.size_px().map(f64::from);
    let [columns, rows] = RAYS;
    let mut counts = Vec::new();
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let (x, y) = ((i as f64 + 0.5) / columns as f64, (j as f64 + 0.5) / rows as f64);
        let direction = camera.ray_direction(x * width, y * height);
        let hit = surfaces.first_hit(camera.eye(), direction, camera.near(), f64::INFINITY);
        let depth = hit.map_or(f64::INFINITY, |hit| hit.t);
        let is_in_front = |side: &&Side| side.depth_at(2.0 * x - 1.0, 1.0 - 2.0 * y).is_some_and(|d| d < depth);
        let met = sides.iter().filter(is_in_front).count() * every;
        counts.extend((met > 0).then_some(met));
    }
    counts.sort_unstable();
    counts.get((CROWDED * counts.len() as f64) as usize).map_or(1.0, |&count| count as f32)
}

/// A flat face with four corners, some of which may be at infinity: x and y of clip space, the homogeneous coordinate, and view depth.
struct Side {
    corners: [DVec4; 4],
    /// Its points p have `plane . p = 0`.
    plane: DVec4,
}

impl Side {
    fn new(corners: [DVec4; 4]) -> Self {
        let [a, b, _, d] = corners;
        let minor = |dropped: usize| {
            let [a, b, d] = [a, b, d].map(|p| DVec3::from_array([0, 1, 2].map(|i| p[i + usize::from(i >= dropped)])));
            a.dot(b.cross(d))
        };
        Self { corners, plane: DVec4::new(minor(0), -minor(1), minor(2), -minor(3)) }
    }

    /// The view depth at which the ray through the picture at `(x, y)`, each -1 to 1, meets the face; `None` where it misses.
    fn depth_at(&self, x: f64, y: f64) -> Option<f64> {
        // From where the ray is the axis.
        let flat = self.corners.map(|c| [c.x - x * c.w, c.y - y * c.w]);
        let turns: [f64; 4] = std::array::from_fn(|i| {
            let ([ax, ay], [bx, by]) = (flat[i], flat[(i + 1) % 4]);
            ax * by - ay * bx
        });
        let is_around = turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0);
        // The point of the ray at depth d is (x d, y d, 1, d).
        let depth = -self.plane.z / (self.plane.x * x + self.plane.y * y + self.plane.w);
        (is_around && depth > 0.0).then_some(depth)
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
pub(super) fn silhouettes(subject: &Subject<'_>, lights: &[&Light]) -> (Overlay, Legend) {
    let mut overlay = Overlay { hidden_opacity: 0.22, ..Overlay::default() };
    let (mut single, mut multiple) = (0, 0);
    for light in lights {
        for (caster, edges) in &Outlines::new(subject, light).casters {
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
    let edges: usize = subject.models().map(|(_, caster)| caster.topology.edges().len()).sum();
    let share = 100.0 * (single + multiple) as f64 / (edges * lights.len()).max(1) as f64;
    let of_edges = format!("{share:.1} % of {}", counted(edges, "edge"));
    let each = if lights.len() > 1 { " for each light" } else { "" };
    legend = legend.text(format!("{of_edges}{each}; faint where hidden"));
    (overlay, legend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_a_face_in_front_of_the_eye_that_surrounds_it() {
        let square = |depth: f64| {
            Side::new([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec4::new(x, y, 1.0, depth)))
        };
        assert_eq!(square(2.0).depth_at(0.1, 0.4), Some(2.0));
        assert_eq!(square(2.0).depth_at(0.1, 0.6), None);
        assert_eq!(square(-2.0).depth_at(0.1, 0.1), None, "it is behind the eye");
    }

    #[test]
    fn a_ray_meets_a_side_that_ends_at_infinity() {
        // From an edge at depth 3, below the eye's level, away into the picture.
        let side = Side::new([
            DVec4::new(-1.0, -1.0, 1.0, 3.0),
            DVec4::new(1.0, -1.0, 1.0, 3.0),
            DVec4::new(0.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, 0.0, 0.0, 1.0),
        ]);
        let depth = side.depth_at(0.0, -0.1).expect("it is met");
        assert!((depth - 10.0).abs() < 1e-12, "one below the eye at a tenth of the depth: {depth}");
        assert_eq!(side.depth_at(0.0, -0.4), None, "before the edge");
        assert_eq!(side.depth_at(0.0, 0.1), None, "above the horizon");
    }
}
