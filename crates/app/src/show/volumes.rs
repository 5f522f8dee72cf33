//! The sides of shadow volumes, translucent over the lit picture.
//!
//! Caps are left out: the light cap lies on the caster, and the dark cap is at infinity. Of a light with a reach only what is within it
//! is shown, because elsewhere no volume changes a pixel; without that, twenty street lamps would veil a town.

use glam::{DVec3, DVec4, Vec3};
use umbrae_core::{ConvexRegion, Light, Reach};
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::Subject;
use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::counted;
use super::outlines::{Line, Outline};

/// C. Wallner, "Geometry of real time shadows", 2007, figures 5 and 6: volumes are yellow.
const VOLUME: Rgb = [225, 196, 20];

/// One side covers as much as leaves this much to see through as many as lie behind each other in a crowded part of the picture…
const LEFT_TO_SEE: f32 = 0.35;
/// …which is more crowded than this share of all parts that have any…
const CROWDED: f64 = 0.85;
/// …but between these.
const FAINTEST: f32 = 0.004;
const STRONGEST: f32 = 0.2;

/// The sides of the volumes that were drawn for the lights with these indices.
pub(super) fn volumes(subject: &Subject<'_>, lights: &[usize]) -> (Overlay, Legend) {
    let mut sides = Vec::new();
    let mut bodies = 0;
    for &light in lights {
        let outlines = Outline::all(subject, light);
        let light = &subject.lights[light];
        let reach = Reach::of(light);
        for outline in &outlines {
            bodies += usize::from(!outline.lines.is_empty());
            // Each line once, whatever its multiplicity.
            let side = |line: &Line| Side::new(line.ends.map(Vec3::as_dvec3), light, reach.as_ref().map(Reach::region));
            sides.extend(outline.lines.iter().filter_map(side));
        }
    }
    let opacity = (1.0 - LEFT_TO_SEE.powf(1.0 / layers(subject, &sides))).clamp(FAINTEST, STRONGEST);
    let color = OverlayColor::new(VOLUME, opacity);
    let vertex = |p: DVec4| OverlayVertex { position_world: p.as_vec4(), color };
    let triangles = sides.iter().flat_map(Side::triangles).map(|triangle| triangle.map(vertex));
    let overlay = Overlay { triangles: triangles.collect(), ..Overlay::default() };
    let has_reach = lights.iter().any(|&light| Reach::of(&subject.lights[light]).is_some());
    let end = if has_reach { "the end of the light's reach" } else { "infinity" };
    let meaning = format!("sides, to {end}: the more behind each other, the stronger");
    let legend = Legend::new(format!("Shadow volumes of {}", subject.names_of(lights)))
        .entry(Swatch::Area(VOLUME), meaning)
        .text(format!("{} of {}", counted(sides.len(), "side"), counted(bodies, "volume")))
        .text("What is inside a volume is in shadow");
    (overlay, legend)
}

/// Rays across and down.
const RAYS: [usize; 2] = [24, 14];
/// Enough for a number that is only to choose an opacity.
const MOST_SIDES_LOOKED_AT: usize = 20_000;

/// How many sides lie in front of what is seen, in a crowded part of the picture.
fn layers(subject: &Subject<'_>, sides: &[Side]) -> f32 {
    let camera = subject.camera;
    let clip_from_world = camera.clip_from_world();
    let in_view = |p: DVec4| DVec4 { z: p.w, ..clip_from_world * p };
    let every = sides.len().div_ceil(MOST_SIDES_LOOKED_AT).max(1);
    let triangles = sides.iter().step_by(every).flat_map(Side::triangles);
    let triangles: Vec<SeenTriangle> = triangles.map(|triangle| SeenTriangle::new(triangle.map(in_view))).collect();
    let surfaces = subject.rays();
    let [width, height] = camera.size_px().map(f64::from);
    let [columns, rows] = RAYS;
    let mut counts = Vec::new();
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let (x, y) = ((i as f64 + 0.5) / columns as f64, (j as f64 + 0.5) / rows as f64);
        let direction = camera.ray_direction(x * width, y * height);
        let hit = surfaces.first_hit(camera.eye(), direction, camera.near(), f64::INFINITY);
        let depth = hit.map_or(f64::INFINITY, |hit| hit.t);
        let is_in_front = |t: &&SeenTriangle| t.depth_at(2.0 * x - 1.0, 1.0 - 2.0 * y).is_some_and(|d| d < depth);
        let met = triangles.iter().filter(is_in_front).count() * every;
        counts.extend((met > 0).then_some(met));
    }
    counts.sort_unstable();
    counts.get((CROWDED * counts.len() as f64) as usize).map_or(1.0, |&count| count as f32)
}

/// A flat, convex face of a volume; some of its corners may be at infinity.
#[derive(Debug)]
struct Side {
    /// Scene space, homogeneous.
    corners: Vec<DVec4>,
}

impl Side {
    /// The side over an edge, as far as it is in `region`; `None` if no part of it is.
    fn new([a, b]: [DVec3; 2], light: &Light, region: Option<&ConvexRegion>) -> Option<Self> {
        let far = |p: DVec3| -light.position.offset_from(p).extend(0.0);
        let mut corners = vec![a.extend(1.0), b.extend(1.0), far(b)];
        // The far corners of a directional light are one point.
        corners.extend((!light.position.is_directional()).then(|| far(a)));
        for plane in region.map_or(&[] as &[DVec4], ConvexRegion::planes) {
            corners = cut(&corners, *plane);
        }
        (corners.len() >= 3).then_some(Self { corners })
    }

    fn triangles(&self) -> impl Iterator<Item = [DVec4; 3]> + '_ {
        self.corners[1..].windows(2).map(|pair| [self.corners[0], pair[0], pair[1]])
    }
}

/// The part of a convex polygon with `plane . p >= 0`.
fn cut(corners: &[DVec4], plane: DVec4) -> Vec<DVec4> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (at_p, at_q) = (plane.dot(p), plane.dot(q));
        kept.extend((at_p >= 0.0).then_some(p));
        if (at_p >= 0.0) != (at_q >= 0.0) {
            kept.push(p.lerp(q, at_p / (at_p - at_q)));
        }
    }
    kept
}

/// A triangle as the eye sees it.
struct SeenTriangle {
    /// x and y of clip space, the homogeneous coordinate, and view depth.
    corners: [DVec4; 3],
    /// Its points p have `plane . p = 0`.
    plane: DVec4,
}

impl SeenTriangle {
    fn new(corners: [DVec4; 3]) -> Self {
        let minor = |dropped: usize| {
            let rows = corners.map(|p| DVec3::from_array([0, 1, 2].map(|i| p[i + usize::from(i >= dropped)])));
            rows[0].dot(rows[1].cross(rows[2]))
        };
        Self { corners, plane: DVec4::new(minor(0), -minor(1), minor(2), -minor(3)) }
    }

    /// The view depth at which the ray through the picture at `(x, y)`, each -1 to 1, meets the triangle; `None` where it misses.
    fn depth_at(&self, x: f64, y: f64) -> Option<f64> {
        // From where the ray is the axis.
        let [a, b, c] = self.corners.map(|corner| [corner.x - x * corner.w, corner.y - y * corner.w]);
        let turn = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        let turns = [turn(a, b), turn(b, c), turn(c, a)];
        let is_around = turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0);
        // The point of the ray at depth d is (x d, y d, 1, d).
        let depth = -self.plane.z / (self.plane.x * x + self.plane.y * y + self.plane.w);
        (is_around && depth > 0.0).then_some(depth)
    }
}

#[cfg(test)]
mod tests {
    use umbrae_core::LightPosition;

    use super::*;

    #[test]
    fn a_ray_meets_a_triangle_in_front_of_the_eye_that_surrounds_it() {
        let at = |depth: f64| {
            SeenTriangle::new([(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(x, y)| DVec4::new(x, y, 1.0, depth)))
        };
        assert_eq!(at(2.0).depth_at(0.0, 0.4), Some(2.0));
        assert_eq!(at(2.0).depth_at(0.0, 0.6), None);
        assert_eq!(at(-2.0).depth_at(0.0, 0.1), None, "it is behind the eye");
    }

    #[test]
    fn a_ray_meets_a_side_that_ends_at_infinity() {
        // From an edge at depth 3, below the eye's level, away into the picture.
        let (a, b) = (DVec4::new(-1.0, -1.0, 1.0, 3.0), DVec4::new(1.0, -1.0, 1.0, 3.0));
        let side = SeenTriangle::new([a, b, DVec4::W]);
        let depth = side.depth_at(0.0, -0.1).expect("it is met");
        assert!((depth - 10.0).abs() < 1e-12, "one below the eye at a tenth of the depth: {depth}");
        assert_eq!(side.depth_at(0.0, -0.4), None, "before the edge");
        assert_eq!(side.depth_at(0.0, 0.1), None, "above the horizon");
    }

    #[test]
    fn a_side_ends_where_the_light_does() {
        let lamp = Light { range_m: Some(5.0), ..Light::new("lamp", LightPosition::point(DVec3::ZERO), Vec3::ONE) };
        let reach = Reach::of(&lamp).expect("it has a range");
        let ends = [DVec3::new(1.0, 0.0, -2.0), DVec3::new(1.0, 0.5, -2.0)];
        let side = Side::new(ends, &lamp, Some(reach.region())).expect("it begins within the reach");
        let farthest = side.corners.iter().map(|p| p.truncate().length() / p.w).fold(0.0, f64::max);
        assert!((5.0..5.6).contains(&farthest), "the body around the reach ends close beyond 5: {farthest}");
        let beyond = [DVec3::new(9.0, 0.0, -2.0), DVec3::new(9.0, 0.5, -2.0)];
        assert!(Side::new(beyond, &lamp, Some(reach.region())).is_none());
        let endless = Side::new(ends, &lamp, None).expect("it is there");
        assert_eq!(endless.triangles().count(), 2);
        assert_eq!(endless.corners.iter().filter(|p| p.w == 0.0).count(), 2);
    }
}
