//! McGuire's images 5 and 6: a grid of a thousand cubes, the light among them and the eye behind them.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Case, Caster, Light, LightPosition, Material, Mesh, Object, Oracle, Scene, shapes};
use umbrae_render::{AdapterChoice, CasterReport, Gpu, GpuScene, Method, Renderer, Shot, compare};

/// Cubes of 1 m, 2 m apart, and a floor under them.
fn scene() -> Scene {
    let mesh = |surface| Arc::new(Mesh::new(surface).expect("shapes are good meshes"));
    let cube = mesh(shapes::cuboid(Vec3::splat(-0.5), Vec3::splat(0.5)));
    let floor = mesh(shapes::sheet(Vec3::new(-40.0, -40.0, -12.0), Vec3::X * 80.0, Vec3::Y * 80.0, [1, 1]));
    let place = |i: i32| f64::from(i % 10) * 2.0 - 9.0;
    let cubes = (0..1000).map(|i| {
        let at = DVec3::new(place(i), place(i / 10), place(i / 100));
        Object::new(format!("cube {i}"), cube.clone(), DAffine3::from_translation(at))
    });
    let objects = std::iter::once(Object::new("floor", floor, DAffine3::IDENTITY)).chain(cubes).collect();
    Scene { objects, materials: vec![Material::default()], ..Scene::default() }
}

#[test]
fn of_a_thousand_cubes_few_need_all_their_caps_and_the_picture_is_that_of_z_fail() {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    let scene = scene();
    let casters = Caster::of_scene(&scene);
    let uploaded = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).expect("a small scene");
    let eye = DVec3::new(13.0, -21.0, 8.0);
    let camera = Camera::new(eye, DVec3::ZERO, 0.9, 0.1, [480, 360]).expect("a good camera");
    // Nearer to one cube than to the others, and off every plane of the grid.
    let light = Light::new("lamp", LightPosition::point(DVec3::new(0.13, 0.07, 0.21)), Vec3::ONE).rounded_to_f32();
    let draw = |method: Method| {
        let shot = Shot { shadows: method.into(), ..Shot::new(&uploaded, &casters, &camera, &[]) };
        pollster::block_on(renderer.mask(&shot, &light)).expect("a mask")
    };
    let (auto, zfail, eye_count) = (draw(Method::Auto), draw(Method::ZFail), draw(Method::EyeCount));
    assert!(auto.verdicts == zfail.verdicts && auto.verdicts == eye_count.verdicts);

    let count = |case| auto.light.casters.iter().map(CasterReport::case).filter(|&c| c == case).count();
    let [pass, without_cap, all, culled] =
        [Some(Case::Pass), Some(Case::FailWithoutLightCap), Some(Case::Fail), None].map(count);
    println!("case 1: {pass}, case 2: {without_cap}, case 3: {all}, culled: {culled}");
    assert!((1..20).contains(&all), "{all} of 1,000 cubes are in case 3");
    assert!(pass + culled > 950);

    let judged = Oracle::new(&casters).judge(&camera, &[light], || ()).remove(0);
    assert_eq!(compare(&auto.verdicts, &judged).errors, []);
}
