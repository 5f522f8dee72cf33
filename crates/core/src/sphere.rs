//! A sphere that casts without a mesh: the cone of light that touches it, over a polygon around the circle where it touches.
//!
//! ```text
//!                 ____
//!             . '      ' .
//!   light   /      |      \ ------------ - -    side: from the polygon's edge to infinity
//!     * - -|- - - -|- axis |
//!           \      |      / ------------ - -
//!             ' .__|__. '
//!                  circle of tangency; the polygon around it is the light cap
//! ```
//!
//! The lit part of the sphere is on the light's side of the polygon, outside of the volume; the dark part is inside. What lies between the
//! polygon and the circle counts as dark though it is lit: the polygon needs so many sides that this can't be seen.
//!
//! Source: the lecture notes "Shadow volumes", section 2.1.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, DVec4, Vec3};

use crate::counting::{exits, exits_at_infinity};
use crate::{Bounds, Camera, LightPosition};

/// The fewest sides of a polygon, and the most: with those it is wider than the circle by a fifty-thousandth.
const SIDES: [f64; 2] = [8.0, 512.0];

/// A sphere, as it is and not as triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Sphere {
    /// What reports and pictures call it.
    pub name: String,
    /// Scene space, metres.
    pub center: DVec3,
    /// Metres; above 0.
    pub radius: f64,
    /// Linear reflectance, each channel 0 to 1.
    pub base_color: Vec3,
}

impl Sphere {
    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.center - self.radius, max: self.center + self.radius }
    }

    /// Whether the sphere is between `point` and the light: the closed form of its shadow.
    ///
    /// A point on the sphere is shaded where it faces away from the light. For a light inside, all that is outside is.
    pub fn shades(&self, point: DVec3, light: LightPosition) -> bool {
        let to_light = light.offset_from(point);
        let to_center = self.center - point;
        let nearest = (to_center.dot(to_light) / to_light.length_squared()).max(0.0);
        let end = if light.is_directional() { f64::INFINITY } else { 1.0 };
        let is_inside = |offset: DVec3| offset.length() < self.radius;
        let both_inside = !light.is_directional() && is_inside(to_center) && is_inside(to_light - to_center);
        !both_inside && is_inside(to_center - to_light * nearest.min(end))
    }

    /// The shadow volume over a polygon of `sides` sides (at least 3).
    ///
    /// `None` when the light is in the sphere or on it. No cone touches the sphere then: everything outside is dark, and the light can
    /// be left out of the picture.
    pub fn volume(&self, light: LightPosition, sides: u32) -> Option<SphereVolume> {
        let (axis, circle_center, circle_radius) = self.circle(light)?;
        let sides = sides.max(3);
        let right = axis.any_orthonormal_vector();
        let up = axis.cross(right);
        let out = circle_radius / (PI / f64::from(sides)).cos();
        let ring = (0..sides).map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(sides)).sin_cos();
            circle_center + out * (cos * right + sin * up)
        });
        Some(SphereVolume { light, axis, circle_center, circle_radius, ring: ring.collect(), sphere: self.bounds() })
    }

    /// The number of sides with which the polygon's shadow is at most `error_px` pixels larger than the sphere's, wherever `camera` sees it;
    /// between 8 and 512.
    ///
    /// The shadow's edge is looked at where it comes closest to the eye, if that is beyond the near distance.
    pub fn sides_for(&self, light: LightPosition, camera: &Camera, error_px: f64) -> u32 {
        let Some((axis, circle_center, circle_radius)) = self.circle(light) else { return SIDES[0] as u32 };
        // The straight line of the cone that is closest to the eye.
        let from_circle = camera.eye() - circle_center;
        let out = (from_circle - axis * axis.dot(from_circle)).try_normalize();
        let touch = circle_center + circle_radius * out.unwrap_or_else(|| axis.any_orthonormal_vector());
        let away = (-light.offset_from(touch)).normalize_or_zero();
        let nearest = touch + away * away.dot(camera.eye() - touch).max(0.0);
        let distance = camera.eye().distance(nearest).max(camera.near());
        // Pixels for a metre across the view at that distance, most in the corners of the picture.
        let half = camera.half_extent();
        let [_, height] = camera.size_px().map(f64::from);
        let scale = height / (2.0 * half.y) * (1.0 + half.length_squared());
        let to_light = light.offset_from(touch).length();
        let pixels = scale
            * if light.is_directional() {
                1.0 / distance
            } else {
                // What the polygon has too much of grows with the distance from the light, which is at most the eye's from it and the point's
                // from the eye.
                (1.0 + camera.eye().distance(light.homogeneous().truncate()) / distance) / to_light
            };
        // 1 / cos(pi / sides) - 1 is what there is too much, relative to the radius.
        let sides = PI / (1.0 / (1.0 + error_px.max(0.0) / (circle_radius * pixels))).acos();
        sides.ceil().clamp(SIDES[0], SIDES[1]) as u32
    }

    /// The direction away from the light, and centre and radius of the circle where the cone of light touches the sphere.
    fn circle(&self, light: LightPosition) -> Option<(DVec3, DVec3, f64)> {
        let to_light = light.offset_from(self.center);
        let distance = to_light.length();
        if light.is_directional() {
            return Some((-to_light, self.center, self.radius));
        }
        if distance <= self.radius {
            return None;
        }
        let axis = -to_light / distance;
        let cos = self.radius / distance;
        Some((axis, self.center - axis * (self.radius * cos), self.radius * (1.0 - cos * cos).sqrt()))
    }
}

/// The shadow volume of a sphere: convex, and so never counted more than once.
///
/// Faces are homogeneous triangles, counter-clockwise seen from outside: `w = 1` points, `w = 0` directions, which are points at infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct SphereVolume {
    light: LightPosition,
    /// Unit vector, away from the light.
    axis: DVec3,
    circle_center: DVec3,
    circle_radius: f64,
    /// Counter-clockwise seen from the far end of the axis.
    ring: Vec<DVec3>,
    sphere: Bounds,
}

impl SphereVolume {
    /// The unit vector from the light through the sphere's centre.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Centre and radius of the circle where the light's cone touches the sphere.
    pub fn circle(&self) -> (DVec3, f64) {
        (self.circle_center, self.circle_radius)
    }

    /// The corners of the polygon around the circle.
    pub fn ring(&self) -> &[DVec3] {
        &self.ring
    }

    /// Holds the sphere and the polygon, whose corners are a little outside: what casts, for culling and for its case.
    pub fn bounds(&self) -> Bounds {
        self.sphere.union(Bounds::of_points(self.ring.iter().copied()))
    }

    /// The polygon, in two triangles fewer than it has sides.
    pub fn light_cap(&self) -> impl Iterator<Item = [DVec4; 3]> + '_ {
        let corner = |i: usize| self.ring[i].extend(1.0);
        (1..self.ring.len() - 1).map(move |i| [corner(0), corner(i + 1), corner(i)])
    }

    /// From the polygon's edges to infinity: two triangles each for a point light, one for a directional one.
    pub fn sides(&self) -> impl Iterator<Item = [DVec4; 3]> + '_ {
        self.edges().flat_map(|[a, b]| {
            let [a_far, b_far] = [self.far(a), self.far(b)];
            let [a, b] = [a.extend(1.0), b.extend(1.0)];
            let second = (!self.light.is_directional()).then_some([a, b_far, a_far]);
            std::iter::once([a, b, b_far]).chain(second)
        })
    }

    /// A fan at infinity about the axis, with as many triangles as the polygon has sides; empty for a directional light.
    pub fn dark_cap(&self) -> impl Iterator<Item = [DVec4; 3]> + '_ {
        let axis = self.axis.extend(0.0);
        let edges = (!self.light.is_directional()).then(|| self.edges());
        edges.into_iter().flatten().map(move |[a, b]| [axis, self.far(a), self.far(b)])
    }

    /// 1 where the volume holds `point`, else 0, counted along the ray from it in `direction`: what z-fail leaves in the stencil.
    ///
    /// `None` when the ray meets an edge or the point is on a face.
    pub fn count_to_infinity(&self, point: DVec3, direction: DVec3) -> Option<i32> {
        let count = exits(self.light_cap().chain(self.sides()), point.extend(1.0), direction.extend(0.0))?;
        Some(count + exits_at_infinity(self.dark_cap(), direction)?)
    }

    /// The count at `point` less that at `eye`: what z-pass leaves in the stencil. `None` as for [`SphereVolume::count_to_infinity`].
    pub fn count_from_eye(&self, eye: DVec3, point: DVec3) -> Option<i32> {
        exits(self.light_cap().chain(self.sides()), point.extend(1.0), eye.extend(1.0))
    }

    fn edges(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        (0..self.ring.len()).map(|i| [self.ring[i], self.ring[(i + 1) % self.ring.len()]])
    }

    fn far(&self, corner: DVec3) -> DVec4 {
        -self.light.offset_from(corner).extend(0.0)
    }
}
