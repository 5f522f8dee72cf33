//! What is drawn of a smooth volume against the same volume counted in double precision, on the ground behind it: in every case, under suns and lamps, with the
//! eye in the shadow too.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Camera, Caster, Light, LightPosition, Material, Mesh, Object, Scene, ShadowVolume, SmoothBody, SmoothVolume,
    Surface, corner_normals, shapes,
};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Method, Renderer, ShadowOptions, Shot, Smooth};

const CREASE_RAD: f64 = 0.8;
const SIZE_PX: [u32; 2] = [96, 72];
const SMOOTH: Smooth = Smooth::Curved { epsilon_m: 0.02, epsilon_px: None };

fn scene_of(body: Surface) -> Scene {
    let object =
        |name, surface| Object::new(name, Arc::new(Mesh::new(surface).expect("a good mesh")), DAffine3::IDENTITY);
    let ground = shapes::sheet(Vec3::new(-40.0, -40.0, -1.5), Vec3::X * 80.0, Vec3::Y * 80.0, [1, 1]);
    let objects = vec![object("body", body), object("ground", ground)];
    Scene { objects, materials: vec![Material::default()], ..Scene::default() }
}

fn bodies() -> Vec<(&'static str, Surface)> {
    vec![
        ("sphere", shapes::icosphere(Vec3::ZERO, 1.0, 1)),
        ("torus", shapes::torus(Vec3::ZERO, 1.0, 0.4, 12, 10)),
        ("cylinder", shapes::cylinder(Vec3::new(0.0, 0.0, -1.0), 0.8, 1.8, 10)),
        ("tube", shapes::tube(&[Vec3::NEG_X, Vec3::ZERO, Vec3::new(0.8, 0.9, 0.5)], 0.35, 9)),
    ]
}

fn lights() -> [LightPosition; 4] {
    [
        LightPosition::sun(2.0, 0.7),
        LightPosition::sun(4.4, 0.3),
        LightPosition::point(DVec3::new(2.5, 1.0, 3.0)),
        LightPosition::point(DVec3::new(-0.9, -1.1, 1.4)),
    ]
}

/// Whether a point of the ground is dark, if that is so at its pixel's centre and a quarter of a pixel around it on every path that can be counted.
fn verdict(camera: &Camera, pixel: [u32; 2], count: impl Fn(DVec3) -> Option<i32>) -> Option<bool> {
    let at = |offset: [f64; 2]| {
        let [x, y] = [0, 1].map(|i| f64::from(pixel[i]) + 0.5 + offset[i]);
        let direction = camera.ray_direction(x, y);
        let eye = camera.eye();
        let t = (-1.5 - eye.z) / direction.z;
        let point = eye + direction * t;
        // Just above it: the ground itself does not cast.
        (t > 0.0 && point.abs().max_element() < 39.0).then(|| count(point + DVec3::Z * 1e-5)).flatten()
    };
    let first = at([0.0, 0.0])? != 0;
    let around = [[0.25, 0.25], [-0.25, 0.25], [0.25, -0.25], [-0.25, -0.25]];
    around.into_iter().all(|offset| at(offset).is_some_and(|count| (count != 0) == first)).then_some(first)
}

fn counted(volume: &ShadowVolume, positions: &[Vec3], light: LightPosition, point: DVec3) -> Option<i32> {
    let ways = [DVec3::new(0.31, 0.17, 0.93), DVec3::new(-0.62, 0.71, 0.33)];
    ways.into_iter().find_map(|way| volume.count_to_infinity(positions, light, point, way))
}

#[test]
fn every_decided_pixel_of_the_ground_is_as_the_volume_has_it() {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    let (mut decided, mut dark) = (0, 0);
    for (name, surface) in bodies() {
        let scene = scene_of(surface);
        let mut casters = Caster::of_scene(&scene);
        casters[1].role.casts = false;
        let normals = corner_normals(&casters[0], &[], CREASE_RAD);
        let body = SmoothBody::new(&casters[0], &normals).expect("it is round");
        casters[0].shading_normals = normals;
        let mut gpu_scene =
            GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).expect("it fits");
        gpu_scene.give_bodies(vec![Some(body.clone())]);
        // From above, from beside, and out of the shadow of the first sun.
        let eyes = [DVec3::new(1.0, -6.0, 5.0), DVec3::new(5.0, 3.0, -0.9), DVec3::new(-1.0, 0.45, -0.9)];
        for (eye, light) in eyes.into_iter().flat_map(|eye| lights().map(|light| (eye, light))) {
            let camera = Camera::new(eye, DVec3::new(-0.4, 0.2, -1.5), 0.9, 0.02, SIZE_PX).expect("a good camera");
            let light = Light::new("light", light, Vec3::ONE).rounded_to_f32();
            let smoothness = SMOOTH.smoothness(&camera, Caster::bounds_of(&casters)).expect("it is smooth");
            let volume = SmoothVolume::new(&body, light.position, &smoothness);
            let (positions, flat) = volume.flattened(&body, &casters[0]);
            let methods = [Method::Auto, Method::ZFail, Method::EyeCount].map(ShadowOptions::from);
            let all = methods.into_iter().chain([ShadowOptions::without_culling(Method::Auto)]);
            let masks: Vec<Vec<u8>> = all
                .map(|options| {
                    let shadows = ShadowOptions { smooth: SMOOTH, ..options };
                    let shot = Shot { shadows, ..Shot::new(&gpu_scene, &casters, &camera, &[]) };
                    pollster::block_on(renderer.mask(&shot, &light)).expect("it can be drawn").verdicts
                })
                .collect();
            assert!(
                masks.iter().all(|mask| *mask == masks[0]),
                "{name}, eye {eye}, {light:?}: ways of counting differ"
            );
            let rays = umbrae_core::RayCaster::new([(casters[0].positions.as_slice(), casters[0].mesh.triangles())]);
            for (i, &shown) in masks[0].iter().enumerate() {
                let pixel = [i as u32 % SIZE_PX[0], i as u32 / SIZE_PX[0]];
                let direction = camera.ray_direction(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5);
                if rays.is_hit(eye, direction, 0.0, f64::INFINITY) {
                    continue;
                }
                let expected = verdict(&camera, pixel, |p| counted(&flat, &positions, light.position, p));
                if let Some(is_dark) = expected {
                    decided += 1;
                    dark += usize::from(is_dark);
                    let is_right = shown == if is_dark { 0 } else { 255 };
                    assert!(is_right, "{name}, eye {eye}, {light:?}, pixel {pixel:?}: {shown}, dark {is_dark}");
                }
            }
        }
    }
    assert!(decided > 100_000 && dark > 10_000, "{decided} decided, {dark} of them dark");
}
