//! Lamps with a size, as many lamps without: the reference for soft shadows.
//!
//! ```text
//!        . * .             N points, each with an Nth of the strength: the shadow of one edge becomes N
//!      *   *   *           steps, which are a soft border when N is large
//!     .  *   *  .
//!       * . *
//! ```
//!
//! The points are the same on every run. They are spread more evenly than chance would, and on no lattice whose
//! steps would be seen: on a spiral by the golden angle (H. Vogel, "A better way to construct the sunflower head", 1979), jittered within each step
//! (R. L. Cook, "Stochastic sampling in computer graphics", 1986).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use umbrae_core::{Bounds, Light};

use crate::random::Random;

/// What makes a lamp an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Points for each lamp, at least 1.
    pub samples: u32,
    /// Of the ball or disc; a share of the model's or of the lamp's reach for `None`.
    pub radius_m: Option<f64>,
}

/// The radius of a lamp whose size nobody gave, as a share of the model's radius or of the lamp's range, whichever is less: in a picture
/// of a house, a lamp as large as a window.
const RADIUS_SHARE: f64 = 0.02;
/// `pi (3 - sqrt 5)`: turned by it again and again, no two points come to lie in one direction.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
const SEED: u64 = 2003;

/// Each point light of `lights` as `area.samples` of them, named "lamp #1" and so on, with the same strength together and its range; each spot likewise.
/// Directional lights stay as they are.
///
/// A point becomes a ball that looks like an evenly bright disc from every side; a spot becomes a disc across its axis. Every point costs
/// as much as a lamp of its own: its volumes, its passes and its rays.
///
/// Ranges should be given before, for the lamp as a whole: the points, each below what is seen, would be seen together.
pub fn as_points(lights: Vec<Light>, area: Area, model: &Bounds) -> Vec<Light> {
    let mut random = Random::new(SEED);
    let mut all = Vec::new();
    for light in lights {
        if light.position.is_directional() {
            all.push(light);
            continue;
        }
        let reach_m = light.range_m.unwrap_or(f64::INFINITY).min(model.radius());
        let radius_m = area.radius_m.unwrap_or(RADIUS_SHARE * reach_m);
        for (i, offset) in (1..).zip(offsets(light.cone.map(|cone| cone.axis), area.samples, &mut random)) {
            let point = Light {
                name: format!("{} #{i}", light.name),
                position: light.position.moved_by(offset * radius_m),
                strength: light.strength / area.samples as f32,
                ..light.clone()
            };
            all.push(point.rounded_to_f32());
        }
    }
    all
}

/// Points of a disc of radius 1 across `axis`, or of the ball of radius 1 for `None`.
fn offsets(axis: Option<DVec3>, samples: u32, random: &mut Random) -> Vec<DVec3> {
    let mut chance = || f64::from(random.between(0.0, 1.0));
    let (turn, shift) = (TAU * chance(), chance());
    let count = f64::from(samples);
    (0..samples)
        .map(|i| {
            let (share, angle) = ((f64::from(i) + chance()) / count, turn + GOLDEN_ANGLE * f64::from(i));
            let (sin, cos) = angle.sin_cos();
            if let Some(axis) = axis {
                let (u, v) = axis.any_orthonormal_pair();
                return (u * cos + v * sin) * share.sqrt();
            }
            // Equal shares of a sphere are equally high (Archimedes).
            let z = 1.0 - 2.0 * share;
            let around = (1.0 - z * z).max(0.0).sqrt();
            DVec3::new(around * cos, around * sin, z) * ball_radius((bits_reversed(i) + shift).fract())
        })
        .collect()
}

/// The radius within which `share` of a ball's light is, if the ball of radius 1 is to look evenly bright from afar.
///
/// A disc that is evenly bright needs a density of `1 / sqrt(1 - r^2)` in the ball (N. H. Abel's integral equation). With `r = sin t`,
/// the share within is `(2 t - sin 2 t) / pi`, which is turned around by halving.
fn ball_radius(share: f64) -> f64 {
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if 2.0 * middle - (2.0 * middle).sin() < share * PI { low = middle } else { high = middle }
    }
    high.sin()
}

/// The binary digits of `i` behind the point, in reverse: 0, 1/2, 1/4, 3/4, 1/8, … (J. G. van der Corput, 1935).
fn bits_reversed(i: u32) -> f64 {
    f64::from(i.reverse_bits()) / (f64::from(u32::MAX) + 1.0)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use umbrae_core::{Cone, LightPosition};

    use super::*;

    const MODEL: Bounds = Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };

    fn lamp(cone: Option<Cone>) -> Light {
        let strength = Vec3::new(64.0, 32.0, 8.0);
        Light {
            cone,
            range_m: Some(9.0),
            ..Light::new("lamp", LightPosition::point(DVec3::new(1.0, 2.0, 3.0)), strength)
        }
    }

    fn spread(light: Light, samples: u32, radius_m: f64) -> Vec<Light> {
        as_points(vec![light], Area { samples, radius_m: Some(radius_m) }, &MODEL)
    }

    fn place(light: &Light) -> DVec3 {
        light.position.homogeneous().truncate()
    }

    #[test]
    fn the_points_are_as_strong_together_as_the_lamp_and_reach_as_far() {
        let points = spread(lamp(None), 7, 0.5);
        assert_eq!(points.len(), 7);
        let total: Vec3 = points.iter().map(|point| point.strength).sum();
        assert!(total.distance(lamp(None).strength) < 1e-4, "{total}");
        assert!(points.iter().all(|point| point.range_m == Some(9.0)));
        assert_eq!((points[0].name.as_str(), points[6].name.as_str()), ("lamp #1", "lamp #7"));
    }

    #[test]
    fn the_points_of_a_lamp_fill_its_ball_and_are_the_same_every_time() {
        let points = spread(lamp(None), 256, 0.5);
        assert_eq!(points, spread(lamp(None), 256, 0.5));
        let offsets: Vec<DVec3> = points.iter().map(|point| place(point) - place(&lamp(None))).collect();
        assert!(offsets.iter().all(|offset| offset.length() <= 0.5 + 1e-6));
        let mean = offsets.iter().sum::<DVec3>() / 256.0;
        assert!(mean.length() < 0.02, "{mean}");
        for axis in DVec3::AXES {
            assert!(offsets.iter().any(|o| o.dot(axis) > 0.4) && offsets.iter().any(|o| o.dot(axis) < -0.4), "{axis}");
        }
    }

    /// Of an evenly bright disc of radius 1, r^2 is within r of the middle.
    #[test]
    fn a_ball_looks_like_an_evenly_bright_disc_from_every_side() {
        let offsets = offsets(None, 4096, &mut Random::new(1));
        for to_eye in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, 0.8)] {
            for radius in [0.3, 0.5, 0.8, 0.95] {
                let within =
                    offsets.iter().filter(|offset| offset.reject_from_normalized(to_eye).length() < radius).count();
                let share = within as f64 / 4096.0;
                assert!((share - radius * radius).abs() < 0.02, "{share} within {radius}, seen from {to_eye}");
            }
        }
    }

    #[test]
    fn a_spot_becomes_a_disc_across_its_axis() {
        let axis = DVec3::new(0.0, 0.6, -0.8);
        let points = spread(lamp(Some(Cone { axis, inner_rad: 0.1, outer_rad: 0.5 })), 100, 0.25);
        for point in &points {
            let offset = place(point) - place(&lamp(None));
            assert!(offset.dot(axis).abs() < 1e-6 && offset.length() <= 0.25 + 1e-6, "{offset}");
            assert!(point.cone.is_some_and(|cone| cone.axis.distance(axis) < 1e-6));
        }
        let within = points.iter().filter(|point| place(point).distance(place(&lamp(None))) < 0.125).count();
        assert_eq!(within, 25, "a quarter of the disc has a quarter of the points");
    }

    #[test]
    fn the_sun_stays_one_light_and_a_lamp_without_a_size_suits_its_reach() {
        let sun = Light::new("sun", LightPosition::sun(1.0, 1.0), Vec3::ONE);
        let near = Light { range_m: Some(0.5), ..lamp(None) };
        let points = as_points(vec![sun.clone(), near], Area { samples: 64, radius_m: None }, &MODEL);
        assert_eq!((points.len(), &points[0]), (65, &sun));
        let furthest = points[1..].iter().map(|point| place(point).distance(place(&lamp(None)))).fold(0.0, f64::max);
        assert!((0.005..=0.01 + 1e-6).contains(&furthest), "{furthest}");
    }
}
