//! The volume of an analytic sphere is its shadow, but for the band between circle and polygon.

use std::cell::Cell;
use std::f64::consts::PI;

use glam::{DVec3, DVec4, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use umbrae_core::{Bounds, Camera, Case, CaseChooser, LightPosition, Sphere, SphereVolume};

fn sphere(center: DVec3, radius: f64) -> Sphere {
    Sphere { name: "ball".into(), center, radius, base_color: Vec3::ONE }
}

fn all_faces(volume: &SphereVolume) -> Vec<[DVec4; 3]> {
    volume.light_cap().chain(volume.sides()).chain(volume.dark_cap()).collect()
}

#[derive(Debug, Clone)]
struct Setting {
    sphere: Sphere,
    light: LightPosition,
    sides: u32,
    points: Vec<DVec3>,
    eye: DVec3,
    direction: DVec3,
}

fn setting() -> impl Strategy<Value = Setting> {
    let xyz = |size: f64| [-size..size, -size..size, -size..size].prop_map(DVec3::from);
    let light = prop_oneof![
        2 => xyz(9.0).prop_map(LightPosition::point),
        1 => xyz(1.0).prop_filter_map("no direction", LightPosition::directional),
    ];
    let points = prop::collection::vec((xyz(1.0), 0.0..4.0_f64), 40);
    (xyz(3.0), 0.2..4.0_f64, light, 3..80_u32, points, xyz(9.0), xyz(1.0)).prop_map(
        |(center, radius, light, sides, points, eye, direction)| {
            // Around and behind the sphere, where there is something to tell apart.
            let place = |(offset, behind): (DVec3, f64)| {
                let p = center + 1.5 * radius * offset;
                p - behind * light.offset_from(p)
            };
            let points = points.into_iter().map(place).collect();
            Setting { sphere: sphere(center, radius), light, sides, points, eye, direction }
        },
    )
}

impl Setting {
    /// Whether the point is between the circle of tangency and the polygon, as seen from the light.
    fn is_in_band(&self, volume: &SphereVolume, point: DVec3) -> bool {
        let (center, radius) = volume.circle();
        let tip = self.light.homogeneous();
        let height = volume.axis().dot(point - center);
        let scale = if self.light.is_directional() {
            1.0
        } else {
            let to_circle = volume.axis().dot(center - tip.truncate());
            (to_circle + height) / to_circle
        };
        let out = (point - center - volume.axis() * height).length();
        // A little more, for points on the sphere itself and rounding.
        let widest = radius / (PI / f64::from(self.sides)).cos() * scale;
        height > -1e-9 && (radius * scale * (1.0 - 1e-9)..=widest * (1.0 + 1e-9)).contains(&out)
    }
}

fn for_each_setting(check: impl Fn(&Setting) -> Result<(), TestCaseError>) {
    let config = Config { cases: 3_000, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[8; 32]);
    TestRunner::new_with_rng(config, rng).run(&setting(), |s| check(&s)).expect("it holds in every setting");
}

#[test]
fn a_point_off_the_band_is_in_the_volume_exactly_where_the_sphere_hides_the_light() {
    let counts = Cell::new([0; 4]);
    for_each_setting(|s| {
        let Some(volume) = s.sphere.volume(s.light, s.sides) else { return Ok(()) };
        let mut n = counts.get();
        let is_eye_clear = s.eye.distance(s.sphere.center) > s.sphere.radius && !s.is_in_band(&volume, s.eye);
        for &point in &s.points {
            if point.distance(s.sphere.center) <= s.sphere.radius {
                continue;
            }
            if s.is_in_band(&volume, point) {
                n[2] += 1;
                continue;
            }
            let is_shaded = s.sphere.shades(point, s.light);
            if let Some(count) = volume.count_to_infinity(point, s.direction) {
                prop_assert_eq!(count, i32::from(is_shaded), "{}", point);
                n[usize::from(is_shaded)] += 1;
            }
            if is_eye_clear && let Some(count) = volume.count_from_eye(s.eye, point) {
                prop_assert_eq!(count, i32::from(is_shaded) - i32::from(s.sphere.shades(s.eye, s.light)));
                n[3] += 1;
            }
        }
        counts.set(n);
        Ok(())
    });
    let [lit, dark, band, from_eye] = counts.get();
    println!("{lit} points lit, {dark} dark, {band} in the band; {from_eye} counted from the eye");
    assert!(lit.min(dark).min(from_eye) > 5_000);
}

#[test]
fn the_dark_half_of_the_sphere_is_in_the_volume_and_the_lit_one_is_not() {
    for_each_setting(|s| {
        let Some(volume) = s.sphere.volume(s.light, s.sides) else { return Ok(()) };
        for point in &s.points {
            let Some(normal) = (point - s.sphere.center).try_normalize() else { continue };
            let on_sphere = s.sphere.center + normal * s.sphere.radius;
            let facing = normal.dot(s.light.offset_from(on_sphere).normalize_or_zero());
            if facing.abs() > 1e-6
                && let Some(count) = volume.count_to_infinity(on_sphere, s.direction)
            {
                prop_assert_eq!(count, i32::from(facing < 0.0), "{} facing the light by {}", on_sphere, facing);
            }
        }
        Ok(())
    });
}

#[test]
fn the_volume_is_closed_to_the_last_bit() {
    for_each_setting(|s| {
        let Some(volume) = s.sphere.volume(s.light, s.sides) else { return Ok(()) };
        let faces = all_faces(&volume);
        let bits = |p: DVec4| p.to_array().map(f64::to_bits);
        let edges = faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        // A directional light's far points are all one.
        let mut forward: Vec<_> = edges.map(|(a, b)| (bits(a), bits(b))).filter(|(a, b)| a != b).collect();
        let mut backward: Vec<_> = forward.iter().map(|&(a, b)| (b, a)).collect();
        forward.sort_unstable();
        backward.sort_unstable();
        prop_assert_eq!(forward, backward);
        let n = s.sides as usize;
        prop_assert_eq!(faces.len(), if s.light.is_directional() { 2 * n - 2 } else { 4 * n - 2 });
        Ok(())
    });
}

#[test]
fn the_cone_of_a_lamp_two_radii_away_touches_the_sphere_at_60_degrees() {
    let ball = sphere(DVec3::ZERO, 1.0);
    let volume = ball.volume(LightPosition::point(DVec3::Z * 2.0), 16).expect("the lamp is outside");
    let (center, radius) = volume.circle();
    assert!(center.distance(DVec3::Z * 0.5) < 1e-15);
    assert!((radius - 0.75_f64.sqrt()).abs() < 1e-15);
    assert_eq!(volume.axis(), DVec3::NEG_Z);
    for corner in volume.ring() {
        assert!((corner.z - 0.5).abs() < 1e-12 && corner.truncate().length() > radius);
    }
    for (a, b) in volume.ring().iter().zip(volume.ring().iter().cycle().skip(1)) {
        assert!((a.midpoint(*b).truncate().length() - radius).abs() < 1e-12, "edges touch the circle");
    }
}

#[test]
fn a_lamp_in_the_sphere_has_no_cone_and_leaves_all_outside_dark() {
    let ball = sphere(DVec3::ZERO, 1.0);
    let lamp = LightPosition::point(DVec3::X * 0.5);
    assert!(ball.volume(lamp, 16).is_none());
    assert!(ball.shades(DVec3::X * 3.0, lamp) && ball.shades(DVec3::Y * -3.0, lamp));
    assert!(!ball.shades(DVec3::Y * 0.5, lamp), "inside with it");
}

/// The farthest that the polygon's shadow on anything in view stands out over the sphere's, in pixels.
fn worst_error_px(volume: &SphereVolume, light: LightPosition, camera: &Camera) -> f64 {
    let (center, radius) = volume.circle();
    let pixel = |p: DVec3| {
        let clip = camera.clip_from_world() * p.extend(1.0);
        let [width, height] = camera.size_px().map(f64::from);
        let is_seen = clip.w >= camera.near() && clip.x.abs() < clip.w && clip.y.abs() < clip.w;
        is_seen.then(|| [0.5 * clip.x / clip.w * width, 0.5 * clip.y / clip.w * height])
    };
    let mut worst: f64 = 0.0;
    for &corner in volume.ring() {
        let on_circle = center + (corner - center).normalize_or_zero() * radius;
        for i in 0..120 {
            // Along the side, to far beyond the eye.
            let behind = 1.1_f64.powi(i) - 1.0;
            let [a, b] = [corner, on_circle].map(|p| p - light.offset_from(p) * behind);
            if let (Some(a), Some(b)) = (pixel(a), pixel(b)) {
                worst = worst.max((a[0] - b[0]).hypot(a[1] - b[1]));
            }
        }
    }
    worst
}

#[test]
fn the_sides_asked_for_keep_the_error_below_what_was_asked() {
    let (tried, needed) = (Cell::new(0), Cell::new([0_u64; 2]));
    for_each_setting(|s| {
        let Ok(camera) = Camera::new(s.eye, s.sphere.center, 0.9, 0.1, [320, 200]) else { return Ok(()) };
        let error_px = 0.5;
        let sides = s.sphere.sides_for(s.light, &camera, error_px);
        let Some(volume) = s.sphere.volume(s.light, sides) else { return Ok(()) };
        if sides < 512 {
            let worst = worst_error_px(&volume, s.light, &camera);
            prop_assert!(worst <= error_px * (1.0 + 1e-9), "{worst} pixels with {sides} sides");
            tried.set(tried.get() + 1);
        }
        let [sum, count] = needed.get();
        needed.set([sum + u64::from(sides), count + 1]);
        Ok(())
    });
    let [sum, count] = needed.get();
    println!("{} of {count} settings below 512 sides, {} sides each", tried.get(), sum / count);
    assert!(tried.get() > 2_000);
}

#[test]
fn a_sphere_between_lamp_and_eye_is_counted_by_z_fail() {
    let camera = Camera::new(DVec3::ZERO, DVec3::Y, 0.8, 0.1, [64, 48]).expect("a good camera");
    let lamp = LightPosition::point(DVec3::new(0.0, 0.1, 20.0));
    let chooser = CaseChooser::new(&camera, lamp, &Bounds { min: DVec3::splat(-20.0), max: DVec3::splat(20.0) });
    let case = |center: DVec3| {
        let volume = sphere(center, 1.0).volume(lamp, 16).expect("the lamp is outside");
        chooser.case_of_bounds(&volume.bounds())
    };
    assert_eq!(case(DVec3::new(0.0, 0.0, 10.0)), Case::FailWithoutLightCap);
    assert_eq!(case(DVec3::new(0.0, 2.0, 1.1)), Case::Pass);
    assert_eq!(case(DVec3::new(5.0, 9.0, 1.0)), Case::Pass);
}
