//! The sun's disc.

use std::f64::consts::PI;

use glam::DVec3;
use umbrae_core::{Extent, Light};

use crate::stage::{Stage, above, camera, cuboid, sun};

#[test]
fn a_box_and_a_post_in_the_sun_are_as_rays_find_them() {
    let stage = Stage::new(vec![cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 5.0]), cuboid([2.0, 0.0, 0.0], [2.1, 0.1, 8.0])]);
    let camera = camera([9.0, -8.0, 9.0], [1.0, 4.0, 0.0], 0.7, [160, 120]);
    stage.assert_like_rays(&camera, &sun(0.6), (0.002, 0.2));
}

/// The share of the sun that a straight, upright edge at `edge` leaves to `point`, if what is on one side of it is dark.
fn beside_edge(point: DVec3, edge: DVec3, light: &Light) -> f64 {
    let Extent::Disc { radius_rad } = light.extent else { unreachable!("it is the sun") };
    let toward = light.position.homogeneous().truncate();
    let plane = DVec3::Z.cross(edge - point).normalize_or_zero();
    let sine = plane.dot(toward);
    let t = (sine / (1.0 - sine * sine).sqrt() / radius_rad.tan()).clamp(-1.0, 1.0);
    (t.acos() - t * (1.0 - t * t).sqrt()) / PI
}

/// From an upright edge, the sun is half a plane; the nearer to it, the narrower is the way over the ground on which it comes out.
#[test]
fn the_penumbra_of_a_100_m_post_is_as_wide_as_the_closed_form_says() {
    let stage = Stage::new(vec![cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 100.0])]);
    let light = sun(0.75);
    let toward = light.position.homogeneous().truncate();
    let along = DVec3::new(-toward.x, -toward.y, 0.0).normalize_or_zero();
    let across = DVec3::new(-along.y, along.x, 0.0);
    let edge = DVec3::new(1.0, -1.0, 0.0);
    for distance_m in [8.0, 20.0, 45.0, 80.0] {
        let middle = edge + along * distance_m;
        let camera = above([middle.x, middle.y], 4.0, [640, 480]);
        let seen = stage.seen(&camera, &light);
        // Of the upright edge alone: where it leaves between a tenth and nine tenths, the place t across it, from the share by halving.
        let (mut pairs, mut worst) = (Vec::new(), 0.0_f64);
        for (i, &seen) in seen.iter().enumerate() {
            let [x, y] = [(i % 640) as f64 + 0.5, (i / 640) as f64 + 0.5];
            let direction = camera.ray_direction(x, y);
            let point = camera.eye() - direction * (camera.eye().z / direction.z);
            let from_edge = point - edge;
            if (from_edge.dot(along) - distance_m).abs() > 0.5 || from_edge.dot(across).abs() > 0.8 {
                continue;
            }
            let expected = 1.0 - beside_edge(point, edge, &light);
            worst = worst.max((f64::from(seen) - expected).abs());
            if (0.1..0.9).contains(&seen) {
                pairs.push((from_edge.dot(across) / from_edge.dot(along), place_of_share(f64::from(seen))));
            }
        }
        assert!(worst < 0.01, "{worst} from the closed form at {distance_m} m");
        // In the plane across, the width of the penumbra for each metre of distance is that in which t goes from -1 to 1.
        let count = pairs.len() as f64;
        let (mean_u, mean_t) = pairs.iter().fold((0.0, 0.0), |(u, t), pair| (u + pair.0 / count, t + pair.1 / count));
        let (over, under) = pairs.iter().fold((0.0, 0.0), |(over, under), (u, t)| {
            (over + (u - mean_u) * (u - mean_u), under + (u - mean_u) * (t - mean_t))
        });
        let width = 2.0 / (under / over).abs();
        let radius_rad = 0.5 * umbrae_core::SUN_DIAMETER_RAD;
        let expected = 2.0 * (radius_rad.sin() / 0.75_f64.cos()).asin().tan();
        println!("{distance_m} m: {:.5} m and {:.5} m, {count} pixels", width * distance_m, expected * distance_m);
        assert!(pairs.len() > 1000 && (width / expected - 1.0).abs() < 0.01, "{width} and {expected} at {distance_m}");
    }
}

/// The `t` of which a half-plane leaves this share of a disc.
fn place_of_share(share: f64) -> f64 {
    let (mut low, mut high) = (-1.0_f64, 1.0_f64);
    for _ in 0..50 {
        let t = 0.5 * (low + high);
        if (t.acos() - t * (1.0 - t * t).sqrt()) / PI > share { low = t } else { high = t }
    }
    0.5 * (low + high)
}
