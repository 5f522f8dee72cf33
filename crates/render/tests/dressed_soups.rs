//! Random soups of glass, cut-outs and things that cast not, under spots and lamps with an end, on the GPU against
//! rays.
//!
//! Here textures are filtered, wrapped and cut, and cones and ranges end, on surfaces of all sizes and slopes, from
//! near and far. (An anisotropic sampler, which looks at many places even in a single level, cut holes where none
//! were.)

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod random;

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use umbrae_core::{
    AlphaMode, Camera, Caster, Cone, Light, LightPosition, Material, Mesh, Object, Oracle, Role, Scene, Surface,
    Texture, Verdict, Wrap,
};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Method, Renderer, ShadowOptions, Shot, SilhouetteSource, compare};

use self::random::Random;

const SOUPS: u32 = 20;
const SIZE_PX: [u32; 2] = [160, 120];

impl Random {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * (0.5 * self.signed() + 0.5)
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    fn uv(&mut self, reach: f64) -> Vec2 {
        Vec2::new((self.signed() * reach) as f32, (self.signed() * reach) as f32)
    }
}

fn texture(random: &mut Random) -> Texture {
    let size_px = [(); 2].map(|()| random.one_of(&[1, 2, 3, 8, 17]));
    let texels = size_px[0] * size_px[1];
    Texture {
        name: String::new(),
        size_px,
        rgba: (0..texels).flat_map(|_| [200, 150, 100, random.one_of(&[0, 90, 128, 200, 255])]).collect(),
        wrap: [(); 2].map(|()| random.one_of(&[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp])),
        is_nearest: random.one_of(&[true, false]),
    }
}

/// An opaque material, five with holes, one of glass.
fn materials(random: &mut Random) -> Vec<Material> {
    let holed = |random: &mut Random, texture: u32| Material {
        alpha: random.one_of(&[1.0, 0.8]),
        alpha_mode: AlphaMode::Mask { cutoff: random.one_of(&[0.5, 0.3]) },
        base_color_texture: Some(texture),
        ..Material::default()
    };
    let glass = Material { alpha: 0.3, alpha_mode: AlphaMode::Blend, ..Material::default() };
    let mut materials = vec![Material::default()];
    materials.extend((0..5).map(|texture| holed(random, texture)));
    materials.push(glass);
    materials
}

fn scene(random: &mut Random) -> Scene {
    let textures = (0..5).map(|_| Arc::new(texture(random))).collect();
    let materials = materials(random);
    let object =
        |surface: Surface, name: &str| Object::new(name, Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
    let mut objects: Vec<Object> = ["all cast", "none casts", "glass casts"]
        .map(|name| {
            let positions: Vec<Vec3> = (0..36).map(|_| random.point(4.0).as_vec3()).collect();
            let triangles: Vec<[u32; 3]> = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let surface = Surface {
                positions,
                triangle_materials: (0..12).map(|_| random.one_of(&[0, 1, 2, 3, 4, 5, 6])).collect(),
                corner_uvs: (0..12).map(|_| [(); 3].map(|()| random.uv(3.0))).collect(),
                triangles,
                ..Surface::default()
            };
            object(surface, name)
        })
        .into();
    // A floor that reaches behind the eye, so that much is lost where it is interpolated.
    let floor = [Vec3::new(-50.0, -30.0, -3.0), Vec3::new(50.0, -30.0, -3.0), Vec3::new(0.0, 70.0, -3.0)];
    objects.push(object(
        Surface {
            positions: floor.to_vec(),
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![random.one_of(&[0, 1, 2])],
            corner_uvs: vec![[(); 3].map(|()| random.uv(20.0))],
            ..Surface::default()
        },
        "floor",
    ));
    let mut scene = Scene { objects, materials, textures, ..Scene::default() };
    scene.assign_roles(|object, material| {
        let role = Role::of_material(material);
        match object.name.as_str() {
            "none casts" => Role { casts: false, ..role },
            "glass casts" => Role { casts: true, ..role },
            _ => role,
        }
    });
    scene
}

fn lights(random: &mut Random) -> [Light; 5] {
    let lamp = |random: &mut Random| Light::new("lamp", LightPosition::point(random.point(5.0)), Vec3::ONE);
    let cone = |random: &mut Random| {
        let outer_rad = random.one_of(&[0.05, 0.3, 0.8, 1.3, FRAC_PI_2]);
        Some(Cone { axis: random.point(1.0).normalize_or(DVec3::X), inner_rad: 0.5 * outer_rad, outer_rad })
    };
    let range = |random: &mut Random| Some(random.between(1.0, 9.0));
    [
        lamp(random),
        Light { range_m: range(random), ..lamp(random) },
        Light { cone: cone(random), ..lamp(random) },
        Light { cone: cone(random), range_m: range(random), ..lamp(random) },
        Light::new("sun", LightPosition::directional(random.point(1.0)).unwrap(), Vec3::ONE),
    ]
}

#[test]
fn every_decided_pixel_is_right_among_glass_and_cut_outs_under_lights_that_end() {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    let mut random = Random::new(3);
    let (mut surface, mut decided, mut lit) = (0, 0, 0);
    for number in 0..SOUPS {
        let scene = scene(&mut random);
        let casters = Caster::of_scene(&scene);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        let near = random.one_of(&[0.01, 0.2, 1.5]);
        let eye = random.point(4.0).max(DVec3::splat(-2.9));
        let camera = Camera::new(eye, random.point(1.0), 1.2, near, SIZE_PX).unwrap();
        let oracle = Oracle::with_materials(&casters, &scene.materials, &scene.textures);
        let lights = lights(&mut random);
        let judged = oracle.judge(&camera, &lights, || ());
        for (light, judgements) in lights.iter().zip(&judged) {
            let methods = [Method::Auto, Method::ZFail].map(ShadowOptions::from);
            let sources = [SilhouetteSource::Auto, SilhouetteSource::Gpu, SilhouetteSource::GpuBasic];
            let by_source = |silhouettes| methods.map(|options| ShadowOptions { silhouettes, ..options });
            for shadows in sources.into_iter().flat_map(by_source) {
                let shot = Shot { shadows, ..Shot::new(&gpu_scene, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let comparison = compare(&mask.verdicts, judgements);
                surface += comparison.surface;
                decided += comparison.decided;
                lit += judgements.iter().filter(|j| j.verdict == Some(Verdict::Lit)).count();
                let [width, _] = SIZE_PX;
                let errors: Vec<_> = comparison.errors.iter().map(|&i| [i as u32 % width, i as u32 / width]).collect();
                assert!(errors.is_empty(), "soup {number}, {light:?}, {shadows:?}: wrong at {errors:?}");
            }
        }
    }
    println!("{decided} decided of {surface} surface pixels, {lit} of them lit");
    assert!(decided > surface * 9 / 10 && lit > decided / 20);
}
