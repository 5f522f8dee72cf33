//! What rays say of spheres: their roots in double precision, nothing of cones or polygons.
//!
//! A sphere's shadow is drawn wider than it is by at most a sixteenth of a pixel, which is nearer to its border than the rays that a pixel's
//! verdict must agree with. Polygons have an end to their sides, though: a ball of more than some thousand pixels may have more of a rim.

use glam::DVec3;

use super::{Eye, INTERPOLATION, Oracle, Sight, Verdict, faces, reaches};
use crate::{Hit, Light, Sphere};

/// A visible point of a sphere, from outside or inside.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeenSphere {
    pub(super) sphere: u32,
    point: DVec3,
    /// Unit length, on the visible side.
    normal: DVec3,
    is_outside: bool,
}

impl Oracle {
    /// The same with `spheres`, which are seen and cast; rounded to `f32`, as they are drawn.
    #[must_use]
    pub fn with_spheres(mut self, spheres: &[Sphere]) -> Self {
        let rounded = |sphere: &Sphere| Sphere {
            center: sphere.center.as_vec3().as_dvec3(),
            radius: f64::from(sphere.radius as f32),
            ..sphere.clone()
        };
        self.spheres = spheres.iter().map(rounded).collect();
        self
    }

    /// `sight`, or a sphere that hides it.
    pub(super) fn or_nearer_sphere(&self, eye: &Eye, direction: DVec3, sight: Sight) -> Sight {
        let mut nearest = match sight {
            Sight::Surface(seen) => seen.hit.t,
            Sight::Nothing | Sight::Sphere(_) => f64::INFINITY,
            // Behind a sphere or not, nobody knows.
            Sight::Unsure => return sight,
        };
        let mut sight = sight;
        for (number, sphere) in (0..).zip(&self.spheres) {
            let Some(roots) = roots(sphere, eye.position, direction) else { continue };
            let Some(t) = roots.into_iter().find(|&t| t >= eye.near).filter(|&t| t < nearest) else { continue };
            nearest = t;
            let point = eye.position + direction * t;
            let outwards = (point - sphere.center) / sphere.radius;
            let is_outside = t == roots[0];
            let normal = if is_outside { outwards } else { -outwards };
            sight = Sight::Sphere(SeenSphere { sphere: number, point, normal, is_outside });
        }
        sight
    }

    /// As [`Oracle::verdict`].
    pub(super) fn verdict_on_sphere(
        &self,
        seen: &SeenSphere,
        light: &Light,
        in_the_way: &mut Option<Hit>,
    ) -> Option<Verdict> {
        let to_light = light.position.offset_from(seen.point);
        let is_reached = reaches(light, to_light, seen.point.abs().max_element() * INTERPOLATION);
        if is_reached == Some(false) {
            return Some(Verdict::Dark);
        }
        if !faces(seen.normal, to_light)? {
            return Some(Verdict::Dark);
        }
        // Its outside is convex: what faces the light there is not shaded by itself. Its inside is, if the light is outside.
        let lifted = seen.point + seen.normal * self.lift;
        let shades = |(number, sphere): (u32, &Sphere)| {
            let is_own_outside = number == seen.sphere && seen.is_outside;
            !is_own_outside && sphere.shades(lifted, light.position)
        };
        let is_shaded = (0..).zip(&self.spheres).any(shades)
            || self.is_shaded_by_triangles(seen.point, light.position, in_the_way)?;
        if is_shaded { Some(Verdict::Dark) } else { is_reached.map(|_| Verdict::Lit) }
    }
}

/// Where the line meets the sphere, the nearer first, as multiples of `direction`; `None` where it misses.
fn roots(sphere: &Sphere, start: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let to_center = sphere.center - start;
    let a = direction.length_squared();
    let middle = to_center.dot(direction) / a;
    let across = (to_center - direction * middle).length_squared();
    let half = ((sphere.radius * sphere.radius - across) / a).sqrt();
    (!half.is_nan()).then_some([middle - half, middle + half])
}
