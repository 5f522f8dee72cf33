//! Where a light reaches, as a convex body around it.
//!
//! ```text
//!          ______
//!         /      \            range alone: 60 triangles around the sphere
//!        |    *   |
//!         \______/
//!                    ____
//!              __---'    |    cone and range: a pyramid around the cone, closed by planes
//!        light *         |    that touch the sphere
//!              ``---.____|
//!
//!        light *------------- - -    cone alone: a pyramid that ends at infinity
//! ```
//!
//! The body is drawn to mark what the light can light, and tells which casters can take that light away: since it is convex and
//! holds the light, all that is between the light and a point of it is in it too.
//!
//! Sources: M. McGuire et al. 2003, section 4 (a light's radius, cone and bounds), where the body is a box; ours is rounder.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, DVec4, Vec3};

use crate::{Bounds, ConvexRegion, Light, shapes};

/// The body is larger than the reach by this much of the range, and its cone opens wider by this many radians, so that `f32` drawing
/// stays outside of what is lit.
const MARGIN: f64 = 1e-4;
/// And by this much of the coordinates' size, of which `f32` keeps 2^-24.
const SLACK: f64 = 4e-6;
/// Sides of the pyramid around a cone.
const SIDES: usize = 12;
/// The planes that touch the sphere at the end of a cone turn by at most twice this from one to the next.
const HALF_TURN: f64 = 20.0 * PI / 180.0;

/// Where a light reaches: a convex, closed body that holds the light and every point that it can light, and little else.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use umbrae_core::{Light, LightPosition, Reach};
///
/// let mut lamp = Light::new("lamp", LightPosition::point(DVec3::Z), Vec3::ONE);
/// assert!(Reach::of(&lamp).is_none(), "it shines everywhere");
///
/// lamp.range_m = Some(5.0);
/// let reach = Reach::of(&lamp).expect("it has a range");
/// assert!(reach.region().contains(DVec3::new(0.0, 4.9, 1.0).extend(1.0)));
/// ```
#[derive(Debug, Clone)]
pub struct Reach {
    region: ConvexRegion,
    faces: Vec<[DVec4; 3]>,
    corners: Vec<DVec4>,
    /// Centre and radius, where there is a range.
    sphere: Option<(DVec3, f64)>,
}

impl Reach {
    /// The reach of `light`; `None` where it reaches everywhere: it is directional, or has neither cone nor range.
    ///
    /// A cone without an axis, or wider than a half-space, is none, and neither is a range that is not finite.
    pub fn of(light: &Light) -> Option<Self> {
        Self::widened(light, 0.0)
    }

    /// [`Reach::of`], larger by `slack` metres still.
    pub(crate) fn widened(light: &Light, slack: f64) -> Option<Self> {
        if light.position.is_directional() {
            return None;
        }
        let center = light.position.homogeneous().truncate();
        let range = light.range_m.filter(|range| range.is_finite()).map(|range| range.max(0.0));
        let slack = slack + SLACK * (center.abs().max_element() + range.unwrap_or(0.0));
        let radius = range.map(|range| range * (1.0 + MARGIN) + slack);
        let axis_and_angle = light.cone.and_then(|cone| {
            let is_convex = (0.0..=FRAC_PI_2 + 1e-9).contains(&cone.outer_rad);
            cone.axis.try_normalize().filter(|_| is_convex).map(|axis| (axis, cone.outer_rad))
        });
        let mut reach = match (axis_and_angle, radius) {
            (Some((axis, outer_rad)), _) => {
                let angle = (outer_rad + MARGIN).min(FRAC_PI_2);
                pyramid(center, axis, angle, slack / angle.sin(), radius)
            }
            (None, Some(radius)) => ball(center, radius),
            (None, None) => return None,
        };
        reach.sphere = radius.map(|radius| (center, radius));
        Some(reach)
    }

    /// Holds every point that the light can light, and the light.
    pub fn region(&self) -> &ConvexRegion {
        &self.region
    }

    /// The surface of the body as homogeneous triangles: `w = 1` points, `w = 0` directions, which are points at infinity.
    ///
    /// Counter-clockwise seen from outside. Corners where triangles meet are the same to the last bit, so that the surface
    /// is closed when drawn.
    pub fn faces(&self) -> &[[DVec4; 3]] {
        &self.faces
    }

    /// The corners of the body, each once; some of them at infinity where there is no range.
    pub fn corners(&self) -> &[DVec4] {
        &self.corners
    }

    /// `false` only where the light reaches no point of `bounds`. Exact for a range alone.
    pub fn may_meet_box(&self, bounds: &Bounds) -> bool {
        let is_in_range = self.sphere.is_none_or(|(center, radius)| {
            center.clamp(bounds.min, bounds.max).distance_squared(center) <= radius * radius
        });
        is_in_range && self.region.may_meet_box(bounds)
    }

    /// The convex body with these corners and outward faces, around `inside`.
    fn of_faces(corners: Vec<DVec4>, faces: &[[usize; 3]]) -> Self {
        let faces: Vec<[DVec4; 3]> = faces.iter().map(|face| face.map(|i| corners[i])).collect();
        let mut region = ConvexRegion::default();
        for &[a, b, c] in &faces {
            // A face at infinity bounds nothing.
            if let Some(point) = [a, b, c].into_iter().find(|corner| corner.w > 0.0) {
                let edge = |to: DVec4| to.truncate() - to.w * point.truncate();
                // The two corners after `point`, in order; one that is `point` itself gives a zero edge.
                let [p, q] = if point == a {
                    [b, c]
                } else if point == b {
                    [c, a]
                } else {
                    [a, b]
                };
                let inwards = -edge(p).cross(edge(q)).normalize_or_zero();
                // The triangles of one flat face share a plane.
                let is_new = |plane: &DVec4| plane.truncate().distance_squared(inwards) > 1e-18;
                if region.planes().iter().all(is_new) {
                    region.add(point.truncate(), inwards, 0.0);
                }
            }
        }
        Self { region, faces, corners, sphere: None }
    }
}

/// A pentakis dodecahedron around the sphere: 60 triangles that all touch it, 7 % more volume.
fn ball(center: DVec3, radius: f64) -> Reach {
    let icosahedron = shapes::icosphere(Vec3::ZERO, 1.0, 0);
    let unit = |v: DVec3| v.normalize_or_zero();
    let tips: Vec<DVec3> = icosahedron.positions.iter().map(|p| unit(p.as_dvec3())).collect();
    let middle = |t: [u32; 3]| unit(t.map(|i| tips[i as usize]).into_iter().sum());
    let middles: Vec<DVec3> = icosahedron.triangles.iter().map(|&t| middle(t)).collect();
    // The triangle at a tip touches the sphere a third of the way to the next tip.
    let [a, b, _] = icosahedron.triangles[0].map(|i| tips[i as usize]);
    let touch = unit(2.0 * a + b);
    let (to_tip, to_middle) = (radius / touch.dot(a), radius / touch.dot(middles[0]));

    let mut corners: Vec<DVec4> = tips.iter().map(|&tip| (center + to_tip * tip).extend(1.0)).collect();
    corners.extend(middles.iter().map(|&middle| (center + to_middle * middle).extend(1.0)));
    let mut faces = Vec::with_capacity(60);
    let edges_of = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)];
    for (left, &triangle) in icosahedron.triangles.iter().enumerate() {
        for (from, to) in edges_of(triangle) {
            let is_across = |&t: &[u32; 3]| edges_of(t).contains(&(to, from));
            if let Some(right) = icosahedron.triangles.iter().position(is_across) {
                faces.push([from as usize, tips.len() + right, tips.len() + left]);
            }
        }
    }
    Reach::of_faces(corners, &faces)
}

/// A pyramid around the cone of half-angle `angle` about `axis`, its tip `back` behind `light`; closed by planes that touch the sphere of
/// `radius` about `light`, or else by a cap at infinity.
fn pyramid(light: DVec3, axis: DVec3, angle: f64, back: f64, radius: Option<f64>) -> Reach {
    let right = axis.any_orthonormal_vector();
    let up = axis.cross(right);
    // Rings of the body's profile, each with its height along the axis and its distance from it; w as in `DVec4`.
    let rings: Vec<[f64; 3]> = match radius {
        None => vec![[angle.cos(), angle.sin(), 0.0]],
        Some(radius) => profile(angle, back, radius),
    };
    let mut corners = vec![(light - back * axis).extend(1.0)];
    for &[height, apothem, w] in &rings {
        for i in 0..SIDES {
            let (sin, cos) = (TAU * i as f64 / SIDES as f64).sin_cos();
            let out = apothem / (PI / SIDES as f64).cos();
            let offset = height * axis + out * (cos * right + sin * up);
            corners.push((light * w + offset).extend(w));
        }
    }
    let at = |ring: usize, i: usize| 1 + ring * SIDES + i % SIDES;
    let mut faces = Vec::new();
    for i in 0..SIDES {
        faces.push([0, at(0, i + 1), at(0, i)]);
        for ring in 1..rings.len() {
            faces.push([at(ring - 1, i), at(ring - 1, i + 1), at(ring, i + 1)]);
            faces.push([at(ring - 1, i), at(ring, i + 1), at(ring, i)]);
        }
    }
    // Closed by a fan about the axis: without its middle, a cap of a half-space at infinity would be flat.
    let last = rings.len() - 1;
    let w = radius.map_or(0.0, |_| 1.0);
    corners.push((light * w + radius.unwrap_or(1.0) * axis).extend(w));
    faces.extend((0..SIDES).map(|i| [corners.len() - 1, at(last, i), at(last, i + 1)]));
    Reach::of_faces(corners, &faces)
}

/// The corners of the outline around a sector of a disc, as height, distance from the axis, and 1, from the cone's side to the plane across the axis.
fn profile(angle: f64, back: f64, radius: f64) -> Vec<[f64; 3]> {
    let planes = ((angle / HALF_TURN + 1.0) / 2.0).ceil().max(1.0) as usize;
    let step = angle * 2.0 / (2 * planes - 1) as f64;
    // The outermost plane touches at `touch`, where z cos(touch) + r sin(touch) = radius; the cone's side is
    // r cos(angle) - z sin(angle) = back sin(angle).
    let touch = step * (planes - 1) as f64;
    let out = back * angle.sin();
    let between = (angle - touch).cos();
    let first = [
        (radius * angle.cos() - out * touch.sin()) / between,
        (radius * angle.sin() + out * touch.cos()) / between,
        1.0,
    ];
    let mut rings = vec![first];
    // Two planes meet half-way between the points where they touch.
    for plane in (0..planes - 1).rev() {
        let (sin, cos) = (step * (plane as f64 + 0.5)).sin_cos();
        let distance = radius / (0.5 * step).cos();
        rings.push([distance * cos, distance * sin, 1.0]);
    }
    rings
}

#[cfg(test)]
mod tests;
