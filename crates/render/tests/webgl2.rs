//! Silhouettes in textures on a device that has what WebGL2 has and no more: no compute, no storage buffers, textures of 2048 texels a side.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

#[expect(dead_code, reason = "the example's main is not run")]
#[path = "../examples/displaced_spheres.rs"]
mod displaced_spheres;
mod held_to_webgl2;
mod random;
mod soup;

use std::sync::Arc;

use displaced_spheres::{MAX_OFFSET_M, MOVED, NOISE};
use glam::{DAffine3, DVec3, Vec3};
use held_to_webgl2::held_to_webgl2;
use random::Random;
use soup::soup;
use umbrae_core::{
    Bounds, Camera, Caster, Light, LightPosition, Material, Mesh, Object, Oracle, Role, Scene, Surface, Verdict, shapes,
};
use umbrae_render::{
    Displacement, Gpu, GpuError, GpuScene, Method, Renderer, ShadowCasters, ShadowOptions, ShadowTarget, Shadows, Shot,
    SilhouetteSource, TextureDisplacer, Tier, compare,
};

fn options(method: Method) -> ShadowOptions {
    ShadowOptions { silhouettes: SilhouetteSource::GpuBasic, ..ShadowOptions::from(method) }
}

/// How many pixels of masks of soups are decided, none of them wrong.
fn decided_of_soups(gpu: Gpu) -> usize {
    let renderer = Renderer::new(gpu, 1);
    let mut random = Random::new(21);
    let mut decided = 0;
    for number in 0..12 {
        let scene = soup(&mut random);
        let casters = Caster::of_scene(&scene);
        let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        let camera = Camera::new(random.point(3.0), random.point(1.0), 1.2, 0.05, [160, 120]).unwrap();
        let corners = casters[0].corners(0).map(Vec3::as_dvec3);
        let lights = [
            LightPosition::point(random.point(6.0)),
            LightPosition::point(random.point(2.0)),
            LightPosition::point(corners[0] * 3.0 - corners[1] - corners[2]),
            LightPosition::directional(random.point(1.0)).unwrap(),
        ]
        .map(|position| Light::new("light", position, Vec3::ONE));
        let judged = Oracle::new(&casters).judge(&camera, &lights, || ());
        for (light, judgements) in lights.iter().zip(&judged) {
            for method in [Method::Auto, Method::ZFail] {
                let shot = Shot { shadows: options(method), ..Shot::new(&drawn, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let comparison = compare(&mask.verdicts, judgements);
                assert_eq!(comparison.errors, [], "soup {number}, {light:?}, {method:?}");
                decided += comparison.decided;
            }
        }
    }
    decided
}

#[test]
fn every_decided_pixel_of_a_soup_is_right_with_no_more_than_webgl2_has() {
    let gpu = held_to_webgl2(wgpu::Backends::PRIMARY).expect("tests need a graphics driver: run scripts/setup.sh");
    assert_eq!(gpu.caps.tier, Tier::Basic);
    let decided = decided_of_soups(gpu);
    assert!(decided > 1_500_000, "{decided} pixels decided");
}

#[test]
fn every_decided_pixel_of_a_soup_is_right_on_opengl_where_there_is_any() {
    let Some(gpu) = held_to_webgl2(wgpu::Backends::GL) else { return };
    println!("{}", gpu.label);
    let decided = decided_of_soups(gpu);
    assert!(decided > 1_500_000, "{decided} pixels decided");
}

fn caster_of(surface: Surface) -> Vec<Caster> {
    let object = Object::new("", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
    Caster::of_scene(&Scene { objects: vec![object], materials: vec![Material::default()], ..Scene::default() })
}

#[test]
fn a_mesh_with_more_than_four_million_edges_is_refused() {
    let gpu = held_to_webgl2(wgpu::Backends::PRIMARY).expect("tests need a graphics driver: run scripts/setup.sh");
    let target = ShadowTarget { depth_stencil_format: gpu.caps.depth_stencil_format, samples: 1, color_formats: &[] };
    let shadows = Shadows::new(&gpu, &target);
    let finder = |cells| {
        let casters = caster_of(shapes::sheet(Vec3::ZERO, Vec3::X, Vec3::Y, cells));
        let uploaded = ShadowCasters::new(&gpu, &casters).unwrap();
        shadows.finder(&gpu, &casters, &uploaded, SilhouetteSource::GpuBasic).map(|_| ())
    };
    assert!(finder([100, 100]).is_ok());
    // Three edges a cell, and 2048 x 2048 texels.
    let error = finder([1200, 1200]).unwrap_err();
    let (needed, allowed) = (2111 * 2048 * 16, 2048 * 2048 * 16);
    let GpuError::TooLarge { needed_bytes, allowed_bytes, .. } = error else { panic!("{error}") };
    assert_eq!((needed_bytes, allowed_bytes), (needed, allowed));
}

#[test]
fn what_has_moved_casts_from_where_it_is() {
    let gpu = held_to_webgl2(wgpu::Backends::PRIMARY).expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    let object = |surface| Object::new("", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
    let floor = shapes::sheet(Vec3::new(-5.0, -5.0, 0.0), Vec3::X * 10.0, Vec3::Y * 10.0, [3, 3]);
    let objects = vec![object(floor), object(shapes::icosphere(Vec3::new(0.0, 0.0, 1.5), 1.0, 3))];
    let mut scene = Scene { objects, materials: vec![Material::default()], ..Scene::default() };
    let mut casters = Caster::of_scene(&scene);
    let mut drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let camera = Camera::new(DVec3::new(4.0, -5.0, 4.0), DVec3::ZERO, 1.0, 0.05, [160, 120]).unwrap();
    let light = Light::new("lamp", LightPosition::point(DVec3::new(0.5, 0.3, 5.0)), Vec3::ONE);
    for x in [0.0, 1.5, -2.0] {
        scene.objects[1].world_from_object = DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
        casters[1].pose_to(&scene.objects[1]);
        drawn.update(renderer.gpu(), &casters, &scene.materials);
        let judged = Oracle::new(&casters).judge(&camera, std::slice::from_ref(&light), || ()).remove(0);
        let shot = Shot { shadows: options(Method::Auto), ..Shot::new(&drawn, &casters, &camera, &[]) };
        let mask = pollster::block_on(renderer.mask(&shot, &light)).unwrap();
        let comparison = compare(&mask.verdicts, &judged);
        assert_eq!(comparison.errors, [], "at {x} m");
        assert!(comparison.decided > 5_000, "{} pixels decided", comparison.decided);
    }
}

/// A ball of 80 triangles, flat or shaded as if it were round, that casts nothing, and the sun's mask of it.
fn mask_of_ball(renderer: &Renderer, is_round: bool) -> Vec<u8> {
    let role = Role { casts: false, ..Role::default() };
    let mut casters = caster_of(shapes::icosphere(Vec3::ZERO, 1.0, 1));
    casters[0].role = role;
    if is_round {
        let normals = (0..80).map(|t| casters[0].corners(t).map(Vec3::normalize_or_zero)).collect();
        casters[0].shading_normals = normals;
    }
    let drawn = GpuScene::new(renderer.gpu(), &casters, &[Material::default()], &[]).unwrap();
    let camera = Camera::new(DVec3::new(2.5, -2.0, 1.5), DVec3::ZERO, 0.7, 0.05, [160, 120]).unwrap();
    let sun = Light::new("sun", LightPosition::directional(DVec3::new(-0.3, -0.9, 0.5)).unwrap(), Vec3::ONE);
    let shot = Shot { shadows: options(Method::Auto), ..Shot::new(&drawn, &casters, &camera, &[]) };
    let verdicts = pollster::block_on(renderer.mask(&shot, &sun)).unwrap().verdicts;
    let judged = Oracle::new(&casters).judge(&camera, &[sun], || ()).remove(0);
    let comparison = compare(&verdicts, &judged);
    assert_eq!(comparison.errors, []);
    assert!(comparison.decided > 4_000, "{} pixels decided", comparison.decided);
    verdicts
}

#[test]
fn a_coarse_ball_can_be_shaded_as_a_round_one() {
    let limited = held_to_webgl2(wgpu::Backends::PRIMARY).expect("tests need a graphics driver: run scripts/setup.sh");
    for gpu in [Some(limited), held_to_webgl2(wgpu::Backends::GL)].into_iter().flatten() {
        let renderer = Renderer::new(gpu, 1);
        let [round, flat] = [true, false].map(|is_round| mask_of_ball(&renderer, is_round));
        let different = round.iter().zip(&flat).filter(|(a, b)| a != b).count();
        assert!(different > 100, "{different} pixels differ");
    }
}

#[test]
fn what_a_function_moves_is_flat_and_the_rest_stays_round() {
    let renderer = Renderer::new(held_to_webgl2(wgpu::Backends::PRIMARY).expect("tests need a graphics driver"), 1);
    let role = Role { casts: false, ..Role::default() };
    let ball = |x: f32| {
        let mesh = Mesh::new(shapes::icosphere(Vec3::X * x, 0.9, 1)).unwrap();
        Object { role, ..Object::new("", Arc::new(mesh), DAffine3::IDENTITY) }
    };
    let scene =
        Scene { objects: vec![ball(-1.0), ball(1.0)], materials: vec![Material::default()], ..Scene::default() };
    let mut casters = Caster::of_scene(&scene);
    for (caster, x) in casters.iter_mut().zip([-1.0, 1.0]) {
        let normal = |p: Vec3| (p - Vec3::X * x).normalize_or_zero();
        caster.shading_normals = (0..80).map(|t| caster.corners(t).map(normal)).collect();
    }
    let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let still = "fn moved(p: vec3f, vertex: u32, time_s: f32) -> vec3f { return p; }";
    let displacement = Displacement { wgsl: still, max_offset_m: 0.1, objects: &[0] };
    let made = TextureDisplacer::new(renderer.gpu(), &scene, &mut casters, &drawn, &displacement);
    pollster::block_on(made).unwrap().show(renderer.gpu(), &drawn, 1.0);
    casters[0].shading_normals.clear();
    let camera = Camera::new(DVec3::new(1.5, -4.0, 2.0), DVec3::ZERO, 0.7, 0.05, [160, 120]).unwrap();
    let sun = Light::new("sun", LightPosition::directional(DVec3::new(-0.8, -0.5, 0.3)).unwrap(), Vec3::ONE);
    let shot = Shot { shadows: options(Method::Auto), ..Shot::new(&drawn, &casters, &camera, &[]) };
    let verdicts = pollster::block_on(renderer.mask(&shot, &sun)).unwrap().verdicts;
    let comparison = compare(&verdicts, &Oracle::new(&casters).judge(&camera, &[sun], || ()).remove(0));
    assert_eq!(comparison.errors, []);
    assert!(comparison.decided > 3_000, "{} pixels decided", comparison.decided);
}

/// Spheres that the user's function displaces, at several times: how many pixels are decided, none of them wrong.
fn decided_of_displaced_spheres(gpu: Gpu, times: u32) -> usize {
    let renderer = Renderer::new(gpu, 1);
    let gpu = renderer.gpu();
    let (scene, camera) = (displaced_spheres::scene(), displaced_spheres::camera([240, 136]).unwrap());
    let lights = displaced_spheres::lights();
    let at_rest = Caster::of_scene(&scene);
    let mut casters = at_rest.clone();
    let drawn = GpuScene::new(gpu, &casters, &scene.materials, &scene.textures).unwrap();
    let noise = Displacement { wgsl: NOISE, max_offset_m: MAX_OFFSET_M, objects: &MOVED };
    let displacer = TextureDisplacer::new(gpu, &scene, &mut casters, &drawn, &noise);
    let mut displacer = pollster::block_on(displacer).unwrap();
    let mut before: Option<Vec<Vec<Vec3>>> = None;
    let (mut decided, mut dark) = (0, 0);
    for i in 0..times {
        let time_s = i as f32 * 0.37;
        displacer.show(gpu, &drawn, time_s);
        let positions = pollster::block_on(displacer.positions(gpu, &casters, &drawn)).unwrap();
        assert_eq!(at_rest[3].positions, positions[3], "the floor is flat");
        let farthest = at_rest[0].positions.iter().zip(&positions[0]).map(|(a, b)| a.distance(*b));
        assert!(farthest.fold(0.0, f32::max) > 0.1, "spheres have bumps");
        if let Some(before) = before.replace(positions.clone()) {
            assert_ne!(before[0], positions[0], "and bumps move");
        }
        let at = |(caster, positions): (&Caster, Vec<Vec3>)| Caster {
            bounds: Bounds::of_points(positions.iter().map(|p| p.as_dvec3())),
            positions,
            ..caster.clone()
        };
        let truth: Vec<Caster> = at_rest.iter().zip(positions).map(at).collect();
        for (caster, truth) in casters.iter().zip(&truth) {
            assert_eq!(caster.bounds.union(truth.bounds), caster.bounds, "boxes hold what was moved");
        }
        let judged = Oracle::with_materials(&truth, &scene.materials, &scene.textures).judge(&camera, &lights, || ());
        for (light, judgements) in lights.iter().zip(&judged) {
            for method in [Method::Auto, Method::ZFail] {
                let shot = Shot { shadows: options(method), ..Shot::new(&drawn, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let comparison = compare(&mask.verdicts, judgements);
                assert_eq!(comparison.errors, [], "at {time_s} s under {}, {method:?}", light.name);
                decided += comparison.decided;
            }
            dark += judgements.iter().filter(|j| j.verdict == Some(Verdict::Dark)).count();
        }
    }
    assert!(dark > decided / 20, "{dark} of {decided} pixels are dark");
    decided
}

#[test]
fn spheres_displaced_in_textures_shade_themselves_and_others_exactly_at_five_times() {
    let gpu = held_to_webgl2(wgpu::Backends::PRIMARY).expect("tests need a graphics driver: run scripts/setup.sh");
    let decided = decided_of_displaced_spheres(gpu, 5);
    assert!(decided > 250_000, "{decided} pixels decided");
}

#[test]
fn spheres_displaced_in_textures_are_right_on_opengl_where_there_is_any() {
    let Some(gpu) = held_to_webgl2(wgpu::Backends::GL) else { return };
    let decided = decided_of_displaced_spheres(gpu, 2);
    assert!(decided > 100_000, "{decided} pixels decided");
}

#[test]
fn a_function_that_is_no_good_is_an_error_that_says_why() {
    let gpu = held_to_webgl2(wgpu::Backends::PRIMARY).expect("tests need a graphics driver: run scripts/setup.sh");
    let scene = displaced_spheres::scene();
    let mut casters = Caster::of_scene(&scene);
    let drawn = GpuScene::new(&gpu, &casters, &scene.materials, &scene.textures).unwrap();
    let bad = Displacement { wgsl: "fn moved() -> vec3f { return wind; }", max_offset_m: 1.0, objects: &[0] };
    let made = pollster::block_on(TextureDisplacer::new(&gpu, &scene, &mut casters, &drawn, &bad));
    let Err(GpuError::Shader { reason }) = made else { panic!("it is no good") };
    assert!(reason.contains("wind"), "{reason}");
}
