//! Ten scenes with lights of all shapes: what stands alone and what overlaps, what is thin and what is thick beside its light.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae::cast::CastChoice;
use umbrae::sample::Sample;
use umbrae::view::{ViewChoice, add_ground, camera, ground_under};
use umbrae_core::{
    Camera, Extent, Light, LightPosition, Material, Mesh, Object, SUN_DIAMETER_RAD, Scene, Surface, shapes,
};
use umbrae_formats::{LoadOptions, load};

/// A scene, from where it is looked at, and its light.
pub(crate) struct SoftScene {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) camera: Camera,
    pub(crate) light: Light,
}

/// All ten, in pictures of `size_px`; models are from the folder `data`.
pub(crate) fn scenes(data: &Path, size_px: [u32; 2]) -> Vec<SoftScene> {
    let own = |name, bodies: Vec<Surface>, eye: [f64; 3], target: [f64; 3], light: Light| {
        let object = |surface| Object::new("body", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
        let objects = bodies.into_iter().map(object).collect();
        let scene = Scene { objects, materials: vec![Material::default()], ..Scene::default() };
        let view = ViewChoice { size_px, eye: Some(eye.into()), target: Some(target.into()), ..ViewChoice::default() };
        seen(name, scene, &view, |_| light)
    };
    let framed = |name, scene: Scene, light: fn(&Scene) -> Light| {
        seen(name, scene, &ViewChoice { size_px, ..ViewChoice::default() }, light)
    };
    let bunny = load(&data.join("mesh/bunny_closed.obj"), &LoadOptions::default()).unwrap().scene;
    let fence = (0..9).map(|i| cuboid([-2.0 + 0.5 * i as f32, 0.0, 0.0], [0.1, 0.1, 1.6])).collect();
    let boxes = vec![
        cuboid([-1.5, -0.6, 0.0], [0.9, 0.8, 1.2]),
        cuboid([0.2, 0.3, 0.0], [0.7, 0.7, 0.6]),
        cuboid([1.2, -0.9, 0.0], [0.4, 0.5, 1.8]),
    ];
    let plate = shapes::sheet(Vec3::new(-0.6, -0.5, 1.0), Vec3::X * 1.3, Vec3::Y * 1.1, [1, 1]);
    vec![
        own(
            "post in the sun",
            vec![cuboid([-1.0, -1.0, 0.0], [2.0, 2.0, 40.0])],
            [30.0, 5.0, 40.0],
            [8.0, 25.0, 0.0],
            sun(),
        ),
        own(
            "sphere under a ball",
            vec![shapes::icosphere(Vec3::new(0.0, 0.0, 1.5), 0.8, 3)],
            [5.0, -5.0, 5.0],
            [0.3, 0.3, 0.3],
            ball([-0.6, -1.2, 5.0], 0.3),
        ),
        own("fence beside a panel", fence, [3.0, 6.0, 4.0], [0.0, 1.0, 0.0], panel([0.3, -4.0, 4.0], [0.6, 0.4])),
        own("table under a ball", vec![table()], [3.5, -3.5, 2.2], [0.0, 0.0, 0.2], ball([0.4, 0.3, 2.6], 0.15)),
        own("boxes under a panel", boxes, [4.0, -5.0, 5.0], [0.0, 0.0, 0.0], panel([0.3, 0.4, 4.5], [0.5, 0.3])),
        own(
            "plate over a sphere",
            vec![plate, shapes::icosphere(Vec3::new(0.2, 0.3, 0.5), 0.4, 2)],
            [3.5, -4.5, 2.5],
            [0.0, 0.2, 0.2],
            ball([0.8, -0.9, 4.0], 0.3),
        ),
        framed("bunny under a ball", bunny, |scene| {
            let (middle, radius) = (scene.bounds().center(), scene.bounds().radius());
            ball((middle + DVec3::new(1.4, -1.1, 2.6) * radius).to_array(), 0.15 * radius)
        }),
        framed("town in the sun", Sample::Town.scene(), |_| sun()),
        framed("high-rise in the sun", Sample::HighRise.scene(), |_| sun()),
        framed("lattice tower in the sun", Sample::LatticeTower.scene(), |_| sun()),
    ]
}

fn seen(name: &'static str, mut scene: Scene, view: &ViewChoice, light: impl FnOnce(&Scene) -> Light) -> SoftScene {
    let bounds = scene.bounds();
    let light = light(&scene).rounded_to_f32();
    let ground = ground_under(&bounds);
    let camera = camera(view, &scene, &bounds, Some(&ground)).unwrap();
    CastChoice::default().assign(&mut scene);
    add_ground(&mut scene, &ground);
    SoftScene { name, scene, camera, light }
}

fn light(position: LightPosition, extent: Extent) -> Light {
    Light { extent, ..Light::new("light", position, Vec3::ONE) }
}

fn sun() -> Light {
    let position = LightPosition::sun(238_f64.to_radians(), 40_f64.to_radians());
    light(position, Extent::Disc { radius_rad: 0.5 * SUN_DIAMETER_RAD })
}

fn ball(at: [f64; 3], radius_m: f64) -> Light {
    light(LightPosition::point(DVec3::from(at)), Extent::Sphere { radius_m })
}

/// Faces the ground.
fn panel(at: [f64; 3], [half_x, half_y]: [f64; 2]) -> Light {
    let extent = Extent::Rectangle { half_right: DVec3::Y * half_y, half_up: DVec3::X * half_x };
    light(LightPosition::point(DVec3::from(at)), extent)
}

fn cuboid(min: [f32; 3], size: [f32; 3]) -> Surface {
    shapes::cuboid(Vec3::from(min), Vec3::from(min) + Vec3::from(size))
}

/// A top and four legs, in one body.
fn table() -> Surface {
    let leg = |[x, y]: [f32; 2]| cuboid([x - 0.03, y - 0.03, 0.0], [0.06, 0.06, 0.75]);
    let legs = [[-0.6, -0.4], [0.6, -0.4], [0.6, 0.4], [-0.6, 0.4]].map(leg);
    shapes::joined(legs.into_iter().chain([cuboid([-0.7, -0.5, 0.75], [1.4, 1.0, 0.05])]))
}
