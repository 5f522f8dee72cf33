//! The number of volumes around a point, from a closed form: concentric balls under a lamp.
//!
//! ```text
//!             * lamp                A closed, convex body counts once between a point and the lamp: where one of the two
//!            / \                    is in it and the other is not, or both are outside and the way between them
//!          / (O) \                  passes through it. So under concentric balls the floor has rings, on which
//!        /  / | \  \                the count goes from 0 outside to the number of balls in the middle.
//!      0   1  2  1   0  floor
//! ```

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Camera, Caster, Chain, Counting, Light, LightPosition, Material, Mesh, Object, Scene, ShadowVolume, Surface,
    Windings, shapes,
};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Method, Renderer, ShadowOptions, Shot, SilhouetteSource};

const CENTER: DVec3 = DVec3::new(0.0, 0.0, 8.0);
/// The largest first, so that the eye can be in the volumes of the first few only.
const RADII: [f64; 5] = [3.0, 2.5, 2.0, 1.5, 1.0];
const LAMP: DVec3 = DVec3::new(0.05, -0.03, 20.0);
/// The faces of a ball of 1,280 triangles are less than this share of its radius inside the sphere.
const SAGITTA: f64 = 4e-3;
const SIZE_PX: [u32; 2] = [96, 72];

/// How many of the first `ball_count` balls are between `point` and `lamp`: the volumes around `point` as seen from
/// places that are in the same balls as it is. `None` where that depends on how round the balls are.
fn balls_between(ball_count: usize, lamp: DVec3, point: DVec3) -> Option<i32> {
    RADII[..ball_count].iter().map(|&radius| is_between(radius, lamp, point)).sum()
}

fn is_between(radius: f64, lamp: DVec3, point: DVec3) -> Option<i32> {
    let way = lamp - point;
    let nearest = point + way * ((CENTER - point).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    let [lamp_m, point_m, nearest_m] = [lamp, point, nearest].map(|p| p.distance(CENTER));
    let is_clear = |distance: f64| distance < radius * (1.0 - SAGITTA) || distance > radius;
    let both_are_in = lamp_m.max(point_m) < radius;
    [lamp_m, point_m, nearest_m].into_iter().all(is_clear).then_some(i32::from(nearest_m < radius && !both_are_in))
}

fn ball(radius: f64) -> Surface {
    shapes::icosphere(CENTER.as_vec3(), radius as f32, 3)
}

/// A floor, and the first `ball_count` balls as one object or as one each.
fn scene(ball_count: usize, is_one_object: bool) -> Scene {
    let floor = shapes::sheet(Vec3::new(-40.0, -40.0, 0.0), Vec3::X * 80.0, Vec3::Y * 80.0, [1, 1]);
    let mut balls: Vec<Surface> = RADII[..ball_count].iter().map(|&radius| ball(radius)).collect();
    if is_one_object {
        balls = vec![shapes::joined(balls)];
    }
    let object = |surface| Object::new("", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
    let objects = std::iter::once(floor).chain(balls).map(object).collect();
    Scene { objects, materials: vec![Material::default()], ..Scene::default() }
}

/// What the volumes of all `casters` count at `point`, from there to infinity.
fn counted(casters: &[Caster], lamp: DVec3, point: DVec3, direction: DVec3) -> Option<i32> {
    let lamp = LightPosition::point(lamp);
    let of_caster = |caster: &Caster| {
        let (seen, light) = (Windings::of_point(caster, point), Windings::of_light(caster, lamp));
        let chain = Chain::new(caster, lamp, &Counting::choose(caster, &seen, &light));
        ShadowVolume::new(caster, &chain).count_to_infinity(&caster.positions, lamp, point, direction)
    };
    casters.iter().map(of_caster).sum()
}

#[test]
fn volumes_count_the_balls_between_a_point_and_the_lamp() {
    // No direction that a ball's edges have.
    let direction = DVec3::new(0.123, 0.456, -0.789);
    let in_the_smallest = CENTER + DVec3::new(0.21, 0.13, -0.34);
    let between_two = CENTER + DVec3::new(-1.1, 1.37, 0.4);
    for ball_count in 1..=RADII.len() {
        let casters = Caster::of_scene(&scene(ball_count, ball_count % 2 == 0));
        let balls = &casters[1..];
        let mut seen = [0; RADII.len() + 1];
        for lamp in [LAMP, in_the_smallest, between_two] {
            for (i, j) in (-6..=6).flat_map(|i| (-7..=12).map(move |j| (i, j))) {
                let point = CENTER + DVec3::new(0.91 * f64::from(i) + 0.017, 0.23 * f64::from(i), -0.67 * f64::from(j));
                let Some(expected) = balls_between(ball_count, lamp, point) else { continue };
                let Some(count) = counted(balls, lamp, point, direction) else { continue };
                assert_eq!(count, expected, "{ball_count} balls, {point}, lamp {lamp}");
                seen[expected as usize] += 1;
            }
        }
        assert!(seen[..=ball_count].iter().all(|&points| points > 2), "{ball_count} balls: {seen:?}");
    }
}

/// An eye 1.5 m above the floor in exactly the volumes of the first `volumes` balls of at least so many, looking across
/// the rings.
fn camera(volumes: usize) -> Camera {
    let eye = DVec3::new([6.1, 4.4, 3.5][volumes], 0.1, 1.5);
    let camera = Camera::new(eye, DVec3::new(-0.3, 0.2, 0.0), 1.1, 0.05, SIZE_PX).unwrap();
    for corner in camera.near_rectangle() {
        assert_eq!(balls_between(RADII.len(), LAMP, corner), Some(volumes as i32));
    }
    camera
}

/// The point of the floor that each pixel sees; `None` where it sees none, or through a ball.
fn floor_points(camera: &Camera) -> Vec<Option<DVec3>> {
    let [width, height] = camera.size_px();
    let point = |x: u32, y: u32| {
        let direction = camera.ray_direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let point = camera.eye() - direction * (camera.eye().z / direction.z);
        let is_on_floor = direction.z < 0.0 && point.truncate().abs().max_element() < 39.0;
        is_on_floor.then_some(point.with_z(0.0))
    };
    (0..height).flat_map(|y| (0..width).map(move |x| point(x, y))).collect()
}

#[test]
fn the_device_counts_the_balls_over_each_pixel_with_the_eye_in_none_one_or_two_of_their_volumes() {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    let lamp = Light::new("lamp", LightPosition::point(LAMP), Vec3::ONE);
    for (ball_count, is_one_object) in (1..=RADII.len()).flat_map(|count| [(count, false), (count, true)]) {
        let scene = scene(ball_count, is_one_object);
        let casters = Caster::of_scene(&scene);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        for volumes in 0..=ball_count.min(2) {
            let camera = camera(volumes);
            let points = floor_points(&camera);
            for method in [Method::Auto, Method::ZPass, Method::ZFail, Method::EyeCount] {
                let shot =
                    Shot { shadows: ShadowOptions::from(method), ..Shot::new(&gpu_scene, &casters, &camera, &[]) };
                let counts = pollster::block_on(renderer.counts(&shot, &lamp)).unwrap();
                let mask_by = |silhouettes| {
                    let shot = Shot { shadows: ShadowOptions { silhouettes, ..shot.shadows }, ..shot };
                    pollster::block_on(renderer.mask(&shot, &lamp)).unwrap().verdicts
                };
                let masks = [SilhouetteSource::Auto, SilhouetteSource::Gpu].map(mask_by);
                // From the eye, only what is between it and the pixel is counted.
                let missed = if method == Method::ZPass { volumes as i32 } else { 0 };
                let what =
                    format!("{ball_count} balls in one object: {is_one_object}, the eye in {volumes}, {method:?}");
                let mut seen = [0; RADII.len() + 1];
                for (pixel, point) in points.iter().enumerate() {
                    let Some(expected) = point.and_then(|point| balls_between(ball_count, LAMP, point)) else {
                        continue;
                    };
                    assert_eq!(counts[pixel], expected - missed, "{what}, {point:?}");
                    for mask in &masks {
                        assert_eq!(mask[pixel] == 255, expected == missed, "{what}, {point:?}");
                    }
                    seen[expected as usize] += 1;
                }
                assert!(seen[..=ball_count].iter().all(|&pixels| pixels > 20), "{what}: {seen:?}");
            }
        }
    }
}
