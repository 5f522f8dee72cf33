//! Spheres over a floor, from a closed form: where rays from pixels meet them, and whether a sphere is between that and the light.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Material, Mesh, Object, Oracle, Scene, Sphere, shapes};
use umbrae_render::{
    AdapterChoice, Gpu, GpuScene, LightMark, Look, Method, Renderer, ShadowOptions, Shot, SilhouetteSource, compare,
};

const SIZE_PX: [u32; 2] = [192, 144];
/// Half of the floor's side.
const FLOOR_M: f64 = 40.0;
/// As a cosine: nearer to a right angle than that, a few roundings of `f32` decide.
const EDGE_ON: f64 = 2e-3;

fn sphere(center: DVec3, radius: f64, base_color: Vec3) -> Sphere {
    Sphere { name: "ball".to_owned(), center, radius, base_color }
}

/// A large one over the floor, a small one in its shadow or not, and one that the floor cuts.
fn spheres() -> [Sphere; 3] {
    [
        sphere(DVec3::new(0.0, 0.0, 3.0), 2.0, Vec3::new(0.8, 0.4, 0.2)),
        sphere(DVec3::new(2.25, 1.5, 4.5), 0.5, Vec3::new(0.2, 0.5, 0.8)),
        sphere(DVec3::new(2.5, -2.6, 0.25), 0.75, Vec3::new(0.3, 0.7, 0.3)),
    ]
}

fn sun() -> Light {
    Light::new("sun", LightPosition::directional(DVec3::new(0.6, 0.35, 0.7)).unwrap().rounded_to_f32(), Vec3::ONE)
}

fn lamp() -> Light {
    Light::new("lamp", LightPosition::point(DVec3::new(2.5, 3.5, 8.0)), Vec3::splat(60.0))
}

fn floor() -> Scene {
    let side = 2.0 * FLOOR_M as f32;
    let sheet = shapes::sheet(Vec3::new(-side / 2.0, -side / 2.0, 0.0), Vec3::X * side, Vec3::Y * side, [1, 1]);
    let object = Object::new("floor", Arc::new(Mesh::new(sheet).unwrap()), DAffine3::IDENTITY);
    Scene { objects: vec![object], materials: vec![Material::default()], ..Scene::default() }
}

/// From outside; from where the large ball shades the eye; so close that it is just beyond the near
/// plane, where its lit half ends; from inside.
fn eyes(light: &Light) -> [(&'static str, Camera); 4] {
    let camera = |eye: DVec3, target: DVec3| Camera::new(eye, target, 1.0, 0.05, SIZE_PX).unwrap();
    let middle = DVec3::new(0.0, 0.0, 3.0);
    let to_light = light.position.offset_from(middle);
    let away = -to_light.normalize_or_zero();
    // Where the light touches the large ball.
    let cos = if light.position.is_directional() { 0.0 } else { 2.0 / to_light.length() };
    let touch = away.any_orthonormal_vector() * (1.0 - cos * cos).sqrt() - away * cos;
    [
        ("outside", camera(DVec3::new(9.0, -7.0, 5.0), DVec3::new(-0.5, 0.0, 1.2))),
        ("in the shadow", camera(middle + away * 2.9 + DVec3::new(0.1, -0.2, 0.05), DVec3::new(-6.0, -3.0, 0.0))),
        ("close", camera(middle + touch * 2.07, middle)),
        ("inside", camera(DVec3::new(0.4, -0.3, 3.2), DVec3::new(-6.0, -3.0, 0.0))),
    ]
}

/// The first surface along a ray: where, and the unit normal on its seen side; and the number of the sphere, or of all for the floor.
fn first_surface(camera: &Camera, balls: &[Sphere], [x, y]: [f64; 2]) -> Option<(usize, DVec3, DVec3)> {
    let (eye, direction) = (camera.eye(), camera.ray_direction(x, y));
    let mut first: Option<(f64, usize, DVec3)> = None;
    let mut meet = |t: f64, which: usize, normal: DVec3| {
        if t >= camera.near() && first.is_none_or(|(nearest, ..)| t < nearest) {
            first = Some((t, which, normal));
        }
    };
    let t = -eye.z / direction.z;
    if (eye + direction * t).truncate().abs().max_element() < FLOOR_M {
        meet(t, balls.len(), DVec3::Z);
    }
    for (i, ball) in balls.iter().enumerate() {
        let (a, b) = (direction.length_squared(), (eye - ball.center).dot(direction));
        let square = b * b - a * ((eye - ball.center).length_squared() - ball.radius * ball.radius);
        for sign in [-1.0, 1.0] {
            let t = (-b + sign * square.sqrt()) / a;
            meet(t, i, (eye + direction * t - ball.center) / ball.radius);
        }
    }
    let (t, which, normal) = first?;
    Some((which, eye + direction * t, if normal.dot(direction) < 0.0 { normal } else { -normal }))
}

/// The byte of the mask along one ray; `None` where it is a matter of rounding.
fn verdict(camera: &Camera, balls: &[Sphere], light: &Light, pixel: [f64; 2]) -> Option<u8> {
    let Some((which, point, normal)) = first_surface(camera, balls, pixel) else { return Some(128) };
    let cosine = normal.dot(light.position.offset_from(point).normalize_or_zero());
    if cosine.abs() < EDGE_ON {
        return None;
    }
    // A sphere shades the inside of its own wall; its outside is shaded by itself only where that faces away.
    let shades = |(i, ball): (usize, &Sphere)| {
        let is_outside_of_own = i == which && normal.dot(point - ball.center) > 0.0;
        !is_outside_of_own && ball.shades(point + normal * 1e-9, light.position)
    };
    Some(if cosine > 0.0 && !balls.iter().enumerate().any(shades) { 255 } else { 0 })
}

/// What rays say of each pixel, where those a quarter of a pixel around agree.
fn judged(camera: &Camera, balls: &[Sphere], light: &Light) -> Vec<Option<u8>> {
    let [width, height] = SIZE_PX;
    let pixel = |x: u32, y: u32| {
        let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let center = verdict(camera, balls, light, [x, y])?;
        let which = |pixel| first_surface(camera, balls, pixel).map(|(which, ..)| which);
        let around = [[-0.25, 0.0], [0.25, 0.0], [0.0, -0.25], [0.0, 0.25]].map(|[dx, dy]| [x + dx, y + dy]);
        let agrees = |at| verdict(camera, balls, light, at) == Some(center) && which(at) == which([x, y]);
        around.into_iter().all(agrees).then_some(center)
    };
    (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).map(|[x, y]| pixel(x, y)).collect()
}

fn renderer(samples: u32) -> Renderer {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    Renderer::new(gpu, samples)
}

#[test]
fn every_decided_pixel_is_right_from_outside_in_the_shadow_close_and_inside() {
    let renderer = renderer(1);
    let scene = floor();
    let casters = Caster::of_scene(&scene);
    let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let balls = spheres();
    for light in [sun(), lamp()] {
        for (place, camera) in eyes(&light) {
            let judged = judged(&camera, &balls, &light);
            let decided = judged.iter().flatten().count();
            assert!(decided > judged.len() * 4 / 5, "{place}: {decided} decided");
            let oracle = Oracle::new(&casters).with_spheres(&balls);
            let judgements = oracle.judge(&camera, std::slice::from_ref(&light), || ()).remove(0);
            let methods = [("auto", Method::Auto), ("z-fail", Method::ZFail), ("eye count", Method::EyeCount)];
            let options = methods.map(|(name, method)| (name, ShadowOptions::from(method)));
            let of_cpu = options.into_iter().chain(ShadowOptions::default().each_rule_off());
            let of_gpu = |(name, options)| (name, ShadowOptions { silhouettes: SilhouetteSource::Gpu, ..options });
            let mut cases = Vec::new();
            for (rule, shadows) in of_cpu.clone().chain(of_cpu.map(of_gpu)) {
                let shot = Shot { shadows, spheres: &balls, ..Shot::new(&gpu_scene, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, &light)).unwrap();
                let wrong: Vec<usize> = (judged.iter().zip(&mask.verdicts).enumerate())
                    .filter(|(_, (judged, drawn))| judged.is_some_and(|judged| judged != **drawn))
                    .map(|(pixel, _)| pixel)
                    .collect();
                assert!(
                    wrong.is_empty(),
                    "{} from {place}, {rule}: {} wrong of {decided}, {:?}",
                    light.name,
                    wrong.len(),
                    wrong.iter().take(9).map(|pixel| [pixel % 192, pixel / 192]).collect::<Vec<_>>()
                );
                let comparison = compare(&mask.verdicts, &judgements);
                assert!(comparison.errors.is_empty(), "{} from {place}, {rule}", light.name);
                assert!(comparison.decided > comparison.surface * 4 / 5, "{place}: {comparison:?}");
                cases.push(mask.light.spheres[0].case().map(umbrae_core::Case::number));
            }
            let lit = judged.iter().flatten().filter(|&&verdict| verdict == 255).count();
            println!("{} from {place}: {decided} decided of {}, {lit} lit, cases {cases:?}", light.name, judged.len());
        }
    }
}

#[test]
fn a_picture_has_no_speckles_on_a_ball_because_every_pass_finds_the_same_depth() {
    let (width, scene, balls) = (SIZE_PX[0] as usize, floor(), spheres());
    let casters = Caster::of_scene(&scene);
    for samples in [1, 4] {
        let renderer = renderer(samples);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        for light in [sun(), lamp()] {
            let (_, camera) = eyes(&light)[0];
            for light_mark in [LightMark::Off, LightMark::Exact, LightMark::Receivers] {
                let shadows = ShadowOptions { light_mark, ..ShadowOptions::default() };
                let lights = [light.clone()];
                let shot = Shot { shadows, spheres: &balls, ..Shot::new(&gpu_scene, &casters, &camera, &lights) };
                let picture = pollster::block_on(renderer.picture(&shot)).unwrap();
                let judged = judged(&camera, &balls, &light);
                let at = |pixel: usize| i32::from(picture.rgba[4 * pixel]);
                let mut inner = 0;
                for pixel in width + 1..judged.len() - width - 1 {
                    let around = [pixel - 1, pixel + 1, pixel - width, pixel + width];
                    let surface = |pixel: usize| {
                        let [x, y] = [(pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5];
                        first_surface(&camera, &balls, [x, y]).map(|(which, ..)| which)
                    };
                    let is_inner = judged[pixel] == Some(255)
                        && around.iter().all(|&next| judged[next] == Some(255) && surface(next) == surface(pixel))
                        && surface(pixel).is_some_and(|which| which < balls.len());
                    if is_inner {
                        inner += 1;
                        let [low, high] = [around.map(at).into_iter().min(), around.map(at).into_iter().max()];
                        let [low, high] = [low.unwrap() - 4, high.unwrap() + 4];
                        assert!((low..=high).contains(&at(pixel)), "{} {samples} {light_mark:?} {pixel}", light.name);
                    }
                }
                assert!(inner > 300, "{inner} pixels looked at");
            }
        }
    }
}

#[test]
fn a_lamp_in_a_ball_lights_nothing_outside_and_the_whole_of_its_inside() {
    let renderer = renderer(1);
    let scene = floor();
    let casters = Caster::of_scene(&scene);
    let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let balls = spheres();
    let light = Light::new("in the ball", LightPosition::point(DVec3::new(0.5, 0.5, 3.0)), Vec3::splat(60.0));
    let [(_, outside), .., (_, inside)] = eyes(&lamp());
    let mask = |camera: &Camera| {
        let shot = Shot { spheres: &balls, look: &Look::NONE, ..Shot::new(&gpu_scene, &casters, camera, &[]) };
        pollster::block_on(renderer.mask(&shot, &light)).unwrap().verdicts
    };
    assert!(mask(&outside).iter().all(|&verdict| verdict != 255));
    assert!(mask(&inside).iter().all(|&verdict| verdict == 255));
}
