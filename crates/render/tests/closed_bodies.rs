//! Closed bodies that overlap, one of them turned inside out, with lamps and eyes in them, on them and in the planes of their walls, against rays.
//!
//! Where the light or the near rectangle is in a body's box, counting what faces the light would be wrong.

mod random;

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use random::Random;
use umbrae_core::{
    Camera, Caster, Light, LightPosition, Material, Mesh, Object, Oracle, Scene, Surface, Verdict, shapes,
};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Method, Renderer, ShadowOptions, Shot, SilhouetteSource, compare};

const SCENES: usize = 16;
const SIZE_PX: [u32; 2] = [160, 120];

/// Boxes, balls of more triangles than the stencil counts, and a ring, each an object; and a few of them again in one mesh.
fn scene(random: &mut Random) -> Scene {
    let ball = |random: &mut Random| {
        let subdivisions = 1 + random.below(3) as u32;
        shapes::icosphere(random.point(2.5).as_vec3(), 0.4 + random.below(8) as f32 * 0.15, subdivisions)
    };
    let cuboid = |random: &mut Random| {
        let low = random.point(3.0).as_vec3();
        shapes::cuboid(low, low + (random.point(1.2).as_vec3().abs() + 0.3))
    };
    let mut surfaces: Vec<Surface> = (0..3).map(|_| cuboid(random)).collect();
    surfaces.extend((0..2).map(|_| ball(random)));
    surfaces.push(shapes::torus(random.point(2.0).as_vec3(), 1.1, 0.3, 24, 12));
    let many = shapes::joined([cuboid(random), ball(random), cuboid(random)]);
    surfaces.push(many);
    let mut inside_out = ball(random);
    inside_out.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    surfaces.push(inside_out);
    // Around everything, so that all that is seen is in a body.
    surfaces.push(shapes::cuboid(Vec3::splat(-6.0), Vec3::splat(6.0)));
    let object =
        |surface| Object::new("", Arc::new(Mesh::new(surface).expect("shapes are good meshes")), DAffine3::IDENTITY);
    let objects = surfaces.into_iter().map(object).collect();
    Scene { objects, materials: vec![Material::default()], ..Scene::default() }
}

fn lights(casters: &[Caster], random: &mut Random) -> [Light; 5] {
    let corners = casters[0].corners(random.below(12)).map(Vec3::as_dvec3);
    [
        LightPosition::point(casters[random.below(6)].bounds.center()),
        LightPosition::point(casters[3].bounds.center()),
        // In a wall's plane, beside the wall.
        LightPosition::point(corners[0] * 2.5 - corners[1] * 0.75 - corners[2] * 0.75),
        LightPosition::point(random.point(5.0)),
        LightPosition::directional(random.point(1.0)).unwrap_or(LightPosition::point(DVec3::ZERO)),
    ]
    .map(|position| Light::new("light", position, Vec3::ONE))
}

#[test]
fn lamps_and_eyes_in_closed_bodies_see_what_rays_see() {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    let mut random = Random::new(5);
    let (mut decided, mut surface, mut lit) = (0, 0, 0);
    for number in 0..SCENES {
        let scene = scene(&mut random);
        let casters = Caster::of_scene(&scene);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).expect("it fits");
        // Every other eye is in a body of some kind.
        let eye = if number % 2 == 0 { casters[number / 2 % 8].bounds.center() } else { random.point(4.0) };
        let camera = Camera::new(eye, eye + random.point(1.0), 1.2, 0.05, SIZE_PX).expect("a good camera");
        let lights = lights(&casters, &mut random);
        let judged = Oracle::new(&casters).judge(&camera, &lights, || ());
        for (light, judgements) in lights.iter().zip(&judged) {
            for silhouettes in [SilhouetteSource::Auto, SilhouetteSource::Gpu, SilhouetteSource::GpuBasic] {
                for method in [Method::Auto, Method::ZFail] {
                    let shadows = ShadowOptions { silhouettes, ..method.into() };
                    let shot = Shot { shadows, ..Shot::new(&gpu_scene, &casters, &camera, &[]) };
                    let mask = pollster::block_on(renderer.mask(&shot, light)).expect("a mask");
                    let comparison = compare(&mask.verdicts, judgements);
                    let what = format!("scene {number}, {:?}, {method:?}, {silhouettes:?}", light.position);
                    assert_eq!(comparison.errors, [], "{what}");
                    decided += comparison.decided;
                    surface += comparison.surface;
                }
            }
            lit += judgements.iter().filter(|judgement| judgement.verdict == Some(Verdict::Lit)).count();
        }
    }
    println!("{decided} decided of {surface} surface pixels, {lit} lit");
    assert!(decided > 5_000_000 && lit > 100_000);
}
