//! Soft shadows of spheres, and of coarse bodies that stand for curved ones: what the floor sees of a light past the curved body itself is the truth, by rays.

use glam::{DVec3, Vec3};
use umbrae_core::{Camera, Extent, Light, LightPosition, Oracle, Sphere, Surface, shapes};
use umbrae_render::Smooth;

use crate::stage::{Stage, light};

/// In the middle of each body, whose radius is 1 m.
const MIDDLE: Vec3 = Vec3::new(0.2, 0.1, 3.0);

/// Above the floor and below the bodies, so that nothing but the floor is seen.
const EYE_HEIGHT_M: f64 = 1.8;

/// A ball, and a sun eleven times as wide as the real one: penumbrae are many pixels wide.
fn lights() -> [Light; 2] {
    let ball = LightPosition::point(DVec3::new(0.8, -0.6, 9.0));
    [
        light("ball", ball, Extent::Sphere { radius_m: 0.8 }),
        light("sun", LightPosition::sun(3.4, 1.1), Extent::Disc { radius_rad: 0.05 }),
    ]
}

/// Looks down at the middle of the shadow, 5 m of the floor across.
fn camera(light: &Light) -> Camera {
    let middle = MIDDLE.as_dvec3();
    let toward = light.position.offset_from(middle);
    let on_floor = middle - toward * (middle.z / toward.z);
    let fov_rad = 2.0 * (0.5 * 5.0 * 0.75 / EYE_HEIGHT_M).atan();
    let eye = on_floor + DVec3::Z * EYE_HEIGHT_M;
    Camera::with_up(eye, on_floor, DVec3::Y, fov_rad, 0.5, [160, 120]).unwrap()
}

/// How much of `light` each pixel sees, by rays.
fn shares(oracle: &Oracle, camera: &Camera, light: &Light) -> Vec<f64> {
    oracle.seen_light(camera, light, 24, || ()).into_iter().map(|seen| seen.unwrap().share).collect()
}

/// Mean and worst error over the pixels that see the light in part, by rays or as drawn.
fn errors(seen: &[f32], truth: &[f64]) -> [f64; 2] {
    let in_part = |share: f64| (0.02..0.98).contains(&share);
    let pairs = seen.iter().map(|&seen| f64::from(seen)).zip(truth);
    let errors: Vec<f64> = pairs
        .filter(|&(seen, &truth)| in_part(seen) || in_part(truth) || (seen - truth).abs() > 0.5)
        .map(|(seen, truth)| (seen - truth).abs())
        .collect();
    assert!(errors.len() > 1000, "{} pixels in the penumbra", errors.len());
    [errors.iter().sum::<f64>() / errors.len() as f64, errors.iter().copied().fold(0.0, f64::max)]
}

/// Asserts that smooth silhouettes of `body` leave little, and of what its triangles leave a third at most. `truth` is the curved body itself, for rays.
///
/// Returns what there is, a line for each light. What is left is mostly that one silhouette, seen from the middle of the light, stands for all points of it.
fn assert_rounder(name: &str, body: &Surface, truth: impl Fn(&Stage) -> Oracle) -> String {
    let mut told = String::new();
    for light in lights() {
        let mut stage = Stage::new(vec![body.clone()]);
        let camera = camera(&light);
        let truth = shares(&truth(&stage), &camera, &light);
        let of_triangles = errors(&stage.seen(&camera, &light), &truth);
        stage.round_off();
        let smooth = Smooth::Curved { epsilon_m: 0.002, epsilon_px: None };
        let curved = errors(&stage.seen_past(&camera, &light, smooth), &truth);
        assert!(curved[0] < 0.008 && curved[1] < 0.03, "{name}, {}: {curved:?}", light.name);
        assert!(curved[0] < of_triangles[0] / 3.0, "{name}, {}: {curved:?} and {of_triangles:?}", light.name);
        told += &format!("{name}, {}: discrete {of_triangles:.4?}, smooth {curved:.4?}\n", light.name);
    }
    told
}

/// In the middle, and one more that covers some of the same light.
fn balls() -> [Sphere; 2] {
    let ball =
        |center: Vec3, radius| Sphere { name: "ball".into(), center: center.as_dvec3(), radius, base_color: Vec3::ONE };
    [ball(MIDDLE, 1.0), ball(MIDDLE + Vec3::new(0.9, 0.8, 0.7), 0.4)]
}

#[test]
fn penumbrae_of_spheres_are_as_rays_find_them() {
    let stage = Stage::new(vec![]);
    // Where two cover the same light their shares are multiplied, as if they covered it independently.
    for (light, (spheres, worst)) in lights().into_iter().zip([(&balls()[..1], 0.03), (&balls(), 0.15)]) {
        let camera = camera(&light);
        let truth = shares(&Oracle::new(&stage.casters).with_spheres(spheres), &camera, &light);
        let errors = errors(&stage.seen_past_spheres(&camera, &light, spheres), &truth);
        println!("{} of {}: {errors:.4?}", light.name, spheres.len());
        assert!(errors[0] < 0.008 && errors[1] < worst, "{}: {errors:?}", light.name);
    }
}

#[test]
fn the_penumbra_of_a_coarse_sphere_that_is_smooth_is_the_spheres() {
    let truth = |stage: &Stage| Oracle::new(stage.floor()).with_spheres(&balls()[..1]);
    for subdivisions in [1, 2] {
        let body = shapes::icosphere(MIDDLE, 1.0, subdivisions);
        print!("{}", assert_rounder(&format!("sphere of {}", body.triangles.len()), &body, truth));
    }
}

#[test]
fn the_penumbra_of_a_coarse_ring_that_is_smooth_is_the_rings() {
    let fine = Stage::new(vec![shapes::torus(MIDDLE, 0.7, 0.3, 240, 120)]);
    let body = shapes::torus(MIDDLE, 0.7, 0.3, 20, 10);
    print!("{}", assert_rounder("ring of 400", &body, |_| Oracle::new(&fine.casters)));
}
