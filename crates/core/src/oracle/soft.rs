//! How much of a light with a size is seen, by rays to many points of it: the truth that soft shadows are compared with.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{Eye, Oracle, Sight, faces};
use crate::{Camera, Extent, Hit, Light, LightPosition};

/// What rays from one point say of a light with a size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenLight {
    /// The share of its points from which nothing is between, 0 to 1. A surface hides what is behind its plane if it is that of a closed body.
    pub share: f64,
    /// The mean of the cosines to its points on the seen side of the surface, where points that are not seen or behind the plane count 0.
    pub mean_cosine: f64,
    /// The cosine to its centre; above 0.
    pub center_cosine: f64,
    /// Whether all of it is on the seen side of the surface's plane.
    pub is_above_plane: bool,
}

impl Oracle {
    /// For each pixel, row by row from the top, what `side * side` rays find of `light` from the surface at its centre, each to a random point of
    /// another part of the light; `None` where there is no surface, or a sphere's, or one that is not turned to the light's centre.
    ///
    /// The points are the same in each pixel and on each run. A share is good to about `side^-1.5`, because only rays along the border of what is
    /// seen are a matter of chance. Cones and ranges don't count. `row_done` is called after each row. All cores work.
    pub fn seen_light(
        &self,
        camera: &Camera,
        light: &Light,
        side: u32,
        row_done: impl Fn() + Sync,
    ) -> Vec<Option<SeenLight>> {
        let light = light.rounded_to_f32();
        let eye = Eye::new(camera);
        let [width, height] = camera.size_px();
        let unit = stratified(side.max(1), light.extent);
        let row = |y: u32| {
            let mut in_the_way = None;
            let seen_from = |x: u32| {
                let sight = self.sight(&eye, [f64::from(x) + 0.5, f64::from(y) + 0.5], None);
                let Sight::Surface(seen) = sight else { return None };
                if faces(seen.normal, light.position.offset_from(seen.point)) != Some(true) {
                    return None;
                }
                Some(self.light_seen_from((seen.point, seen.normal), &light, &unit, &mut in_the_way))
            };
            let row: Vec<Option<SeenLight>> = (0..width).map(seen_from).collect();
            row_done();
            row
        };
        (0..height).into_par_iter().flat_map_iter(row).collect()
    }

    /// `unit` points are those of a light that goes from -1 to 1.
    fn light_seen_from(
        &self,
        (point, normal): (DVec3, DVec3),
        light: &Light,
        unit: &[DVec2],
        in_the_way: &mut Option<Hit>,
    ) -> SeenLight {
        let center = light.position.homogeneous().truncate();
        let (u, v) = light.position.offset_from(point).normalize_or_zero().any_orthonormal_pair();
        let place = |at: &DVec2| match light.extent {
            Extent::Point => light.position,
            Extent::Sphere { radius_m } => LightPosition::point(center + (u * at.x + v * at.y) * radius_m),
            Extent::Rectangle { half_right, half_up } => {
                LightPosition::point(center + half_right * at.x + half_up * at.y)
            }
            Extent::Disc { radius_rad } => {
                let toward = center + (u * at.x + v * at.y) * radius_rad.tan();
                LightPosition::directional(toward).unwrap_or(light.position)
            }
        };
        let (mut seen, mut cosines, mut is_above_plane) = (0_u32, 0.0, true);
        for place in unit.iter().map(place) {
            let cosine = normal.dot(place.offset_from(point).normalize_or_zero());
            is_above_plane &= cosine > 0.0;
            let is_shaded = self.spheres.iter().any(|sphere| sphere.shades(point, place))
                || self.is_shaded_by_triangles(point, place, in_the_way) == Some(true);
            if !is_shaded {
                seen += 1;
                cosines += cosine.max(0.0);
            }
        }
        let count = unit.len() as f64;
        SeenLight {
            share: f64::from(seen) / count,
            mean_cosine: cosines / count,
            center_cosine: normal.dot(light.position.offset_from(point).normalize_or_zero()),
            is_above_plane,
        }
    }
}

/// A random point in each cell of a grid over the square from -1 to 1; for what is round, moved into the disc so that areas keep their ratios.
///
/// Source: P. Shirley and K. Chiu, "A low distortion map between disk and square", 1997.
fn stratified(side: u32, extent: Extent) -> Vec<DVec2> {
    let mut seed = 4096_u64;
    let mut chance = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1_u32 << 31)
    };
    let cells = (0..side * side).map(|i| DVec2::new(f64::from(i % side), f64::from(i / side)));
    let jittered = cells.map(|cell| (cell + DVec2::new(chance(), chance())) * (2.0 / f64::from(side)) - 1.0);
    let is_square = matches!(extent, Extent::Rectangle { .. });
    jittered.map(|at| if is_square { at } else { into_disc(at) }).collect()
}

fn into_disc(at: DVec2) -> DVec2 {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    if at == DVec2::ZERO {
        return at;
    }
    if at.x.abs() > at.y.abs() {
        DVec2::from_angle(FRAC_PI_4 * at.y / at.x) * at.x
    } else {
        DVec2::from_angle(FRAC_PI_2 - FRAC_PI_4 * at.x / at.y) * at.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_disc_fill_it_evenly() {
        let points = stratified(64, Extent::Sphere { radius_m: 1.0 });
        let share = |is_in: &dyn Fn(&&DVec2) -> bool| points.iter().filter(is_in).count() as f64 / 4096.0;
        assert_eq!(share(&|p| p.length() <= 1.0), 1.0);
        for radius in [0.3, 0.6, 0.9] {
            assert!((share(&|p| p.length() < radius) - radius * radius).abs() < 0.01, "{radius}");
        }
        for (x, y) in [(1.0, 0.0), (0.0, 1.0), (0.6, -0.8)] {
            assert!((share(&|p| p.x * x + p.y * y > 0.0) - 0.5).abs() < 0.01, "{x} {y}");
        }
    }
}
