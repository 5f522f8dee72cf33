//! Counts beyond what eight bits hold: stacks of hundreds of sheets between a lamp and a floor.
//!
//! ```text
//!            * lamp
//!           ---            Each sheet just fills the same cone of directions, so that every point in the shadow is in
//!          -----           the volume of every sheet above it: 256 of them are 0 in a stencil of 8 bits.
//!         -------
//!    ____|shadow|____
//! ```

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Camera, Caster, Light, LightPosition, Material, Mesh, Object, Oracle, Scene, Surface, Verdict, shapes,
};
use umbrae_render::{
    AdapterChoice, Gpu, GpuScene, Look, Method, Renderer, ShadowOptions, Shot, SilhouetteSource, compare,
};

const LAMP: DVec3 = DVec3::new(0.0, 0.0, 10.0);
/// Of the shadow on the floor: half its side.
const HALF_M: f64 = 1.5;
/// Where the stack begins; the sheets are 1 cm apart.
const LOWEST_M: f64 = 2.0;
const GAP_M: f64 = 0.01;
const SIZE_PX: [u32; 2] = [96, 72];

/// What a stack is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stack {
    /// Open sheets, all in one mesh.
    SheetsOfOneMesh,
    /// Open sheets, an object each.
    Sheets,
    /// Closed plates half as thick as their distance, all in one mesh.
    PlatesOfOneMesh,
}

const STACKS: [Stack; 3] = [Stack::SheetsOfOneMesh, Stack::Sheets, Stack::PlatesOfOneMesh];

/// A floor, and over it `count` sheets.
fn scene(stack: Stack, count: u32) -> Scene {
    let floor = shapes::sheet(Vec3::new(-30.0, -30.0, 0.0), Vec3::X * 60.0, Vec3::Y * 60.0, [1, 1]);
    let sheet = |i: u32| {
        let height = LOWEST_M + GAP_M * f64::from(i);
        let half = (HALF_M * (LAMP.z - height) / LAMP.z) as f32;
        let (z, corner) = (height as f32, Vec3::new(-half, -half, height as f32));
        if stack == Stack::PlatesOfOneMesh {
            shapes::cuboid(corner, Vec3::new(half, half, z + 0.5 * GAP_M as f32))
        } else {
            shapes::sheet(corner, Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half, [1, 1])
        }
    };
    let mut surfaces: Vec<Surface> = (0..count).map(sheet).collect();
    if stack != Stack::Sheets {
        surfaces = vec![shapes::joined(surfaces)];
    }
    let object = |surface| Object::new("", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
    let objects = std::iter::once(floor).chain(surfaces).map(object).collect();
    Scene { objects, materials: vec![Material::default()], ..Scene::default() }
}

fn lamp() -> Light {
    Light::new("lamp", LightPosition::point(LAMP), Vec3::splat(120.0))
}

/// From beside the stack and from within its shadow, both lower than the lowest sheet: no sheet hides any floor from
/// them. And from above.
fn cameras() -> [Camera; 3] {
    let camera = |eye, target| Camera::new(eye, target, 1.0, 0.05, SIZE_PX).unwrap();
    [
        camera(DVec3::new(3.1, -4.3, 1.7), DVec3::new(0.1, 0.2, 0.0)),
        camera(DVec3::new(0.21, 0.13, 1.1), DVec3::new(1.2, -0.9, 0.0)),
        camera(DVec3::new(4.2, -5.1, 9.0), DVec3::new(0.0, 0.0, 2.5)),
    ]
}

/// For each pixel, if it sees the floor well inside or well outside of the shadow, whether it is inside.
fn is_in_shadow(camera: &Camera) -> Vec<Option<bool>> {
    let [width, height] = camera.size_px();
    // Plates are a little higher than wide enough, and a pixel has a size.
    let distance = |x: f64, y: f64| {
        let direction = camera.ray_direction(x, y);
        let point = camera.eye() - direction * (camera.eye().z / direction.z);
        let is_on_floor = direction.z < 0.0 && point.truncate().abs().max_element() < 29.0;
        is_on_floor.then(|| point.truncate().abs().max_element() - HALF_M)
    };
    let at = |x: u32, y: u32| {
        let (x, y) = (f64::from(x), f64::from(y));
        let corners = [(x, y), (x + 1.0, y), (x, y + 1.0), (x + 1.0, y + 1.0)].map(|(x, y)| distance(x, y));
        if corners.iter().all(|d| d.is_some_and(|d| d < -0.02)) {
            Some(true)
        } else if corners.iter().all(|d| d.is_some_and(|d| d > 0.02)) {
            Some(false)
        } else {
            None
        }
    };
    (0..height).flat_map(|y| (0..width).map(move |x| at(x, y))).collect()
}

fn renderer(samples: u32) -> Renderer {
    Renderer::new(gpu(), samples)
}

fn gpu() -> Gpu {
    pollster::block_on(Gpu::new(&AdapterChoice::default())).expect("tests need a graphics driver: run scripts/setup.sh")
}

/// Each method, and z-pass or z-fail wherever silhouettes are found.
fn options() -> impl Iterator<Item = ShadowOptions> {
    let of_cpu = [Method::Auto, Method::ZFail, Method::EyeCount].map(ShadowOptions::from);
    let found = [SilhouetteSource::Gpu, SilhouetteSource::GpuBasic];
    let found = found.map(|silhouettes| of_cpu.map(|options| ShadowOptions { silhouettes, ..options }));
    let found = found.into_iter().flatten().filter(|options| options.method != Method::EyeCount);
    of_cpu.into_iter().chain(found)
}

#[test]
fn hundreds_of_sheets_between_a_lamp_and_a_floor_leave_no_light() {
    let renderer = renderer(1);
    for (stack, count) in STACKS.into_iter().flat_map(|stack| [256, 300].map(|count| (stack, count))) {
        let scene = scene(stack, count);
        let casters = Caster::of_scene(&scene);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        let oracle = Oracle::new(&casters);
        for (i, camera) in cameras().iter().enumerate() {
            let judged = oracle.judge(camera, &[lamp()], || ()).remove(0);
            for shadows in options() {
                let shot = Shot { shadows, ..Shot::new(&gpu_scene, &casters, camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, &lamp())).unwrap().verdicts;
                let what =
                    format!("{count} sheets, {stack:?}, camera {i}, {:?} {:?}", shadows.method, shadows.silhouettes);
                let wrong = compare(&mask, &judged).errors.len();
                assert_eq!(wrong, 0, "{what}: pixels other than by rays");
                // From above, sheets hide some of the floor.
                let expected = if i < 2 { is_in_shadow(camera) } else { Vec::new() };
                for (pixel, (&drawn, expected)) in mask.iter().zip(expected).enumerate() {
                    if let Some(is_dark) = expected {
                        assert_eq!(drawn, if is_dark { 0 } else { 255 }, "{what}, pixel {pixel}");
                    }
                }
            }
            let dark = judged.iter().filter(|j| j.verdict == Some(Verdict::Dark)).count();
            assert!(dark > 300, "camera {i} sees {dark} dark pixels");
        }
    }
}

#[test]
fn with_four_samples_the_floor_under_hundreds_of_sheets_looks_as_if_there_were_no_lamp() {
    let mut gpu_of_less = gpu();
    // What any device has to add up in.
    gpu_of_less.caps.tally_format = wgpu::TextureFormat::R16Float;
    for renderer in [renderer(4), Renderer::new(gpu_of_less, 4)] {
        check_pictures(&renderer);
    }
}

fn check_pictures(renderer: &Renderer) {
    for (stack, count) in STACKS.into_iter().flat_map(|stack| [256, 300].map(|count| (stack, count))) {
        let scene = scene(stack, count);
        let casters = Caster::of_scene(&scene);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        let look = Look::for_model(&scene.bounds(), &[lamp()]);
        let sources = [SilhouetteSource::Auto, SilhouetteSource::Gpu, SilhouetteSource::GpuBasic];
        let by_source = |camera| sources.map(|source| (camera, source));
        for (camera, silhouettes) in cameras()[..2].iter().flat_map(by_source) {
            let picture = |lights: &[Light]| {
                let shadows = ShadowOptions { silhouettes, ..ShadowOptions::default() };
                let shot = Shot { look: &look, shadows, ..Shot::new(&gpu_scene, &casters, camera, lights) };
                pollster::block_on(renderer.picture(&shot)).unwrap().rgba
            };
            let (with_lamp, without) = (picture(&[lamp()]), picture(&[]));
            let (mut dark, mut lit) = (0, 0);
            let pixels = with_lamp.chunks(4).zip(without.chunks(4)).zip(is_in_shadow(camera));
            for (pixel, ((with_lamp, without), expected)) in pixels.enumerate() {
                match expected {
                    Some(true) => {
                        assert_eq!(with_lamp, without, "{count} sheets, {stack:?}, {silhouettes:?}, pixel {pixel}");
                        dark += 1;
                    }
                    Some(false) => {
                        assert!(
                            with_lamp[0] > without[0],
                            "{count} sheets, {stack:?}, {silhouettes:?}, pixel {pixel} is lit"
                        );
                        lit += 1;
                    }
                    None => {}
                }
            }
            assert!(dark > 300 && lit > 300, "{dark} dark pixels, {lit} lit ones");
        }
    }
}
