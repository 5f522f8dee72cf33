//! Models that move, posed on the GPU and on the CPU: both in the same places, and no decided pixel of either wrong.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

#[expect(dead_code, reason = "this test takes a few models, not all")]
mod data;

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Bounds, Camera, Caster, Light, LightPosition, Mesh, Object, Oracle, Scene, Surface};
use umbrae_formats::{LoadOptions, load};
use umbrae_render::{
    AdapterChoice, Gpu, GpuPoser, GpuScene, Poser, Posing, Renderer, ShadowOptions, Shot, SilhouetteSource, compare,
};

const MODELS: [&str; 6] =
    ["CesiumMan", "Fox", "RecursiveSkeletons", "MorphStressTest", "BoxAnimated", "InterpolationTest"];
const TIMES_S: [f64; 5] = [0.0, 0.3, 0.9, 1.6, 2.9];
const SIZE_PX: [u32; 2] = [160, 120];

/// A sum of a few dozen products, each rounded, of numbers as large as what goes into a vertex.
const ROUNDINGS: f64 = 4.0 / (1 << 24) as f64;

/// The largest number that goes into where a vertex is.
fn size_of_terms(object: &Object) -> f64 {
    let rest = object.mesh.positions().iter().map(|p| p.as_dvec3().length()).fold(0.0, f64::max);
    let pose = object.pose.as_ref();
    let moved = pose.map_or(0.0, |pose| {
        let of_target = |(offsets, weight): (&Vec<Vec3>, &f32)| {
            f64::from(weight.abs()) * offsets.iter().map(|o| o.as_dvec3().length()).fold(0.0, f64::max)
        };
        pose.deformer.morph_offsets.iter().zip(&pose.morph_weights).map(of_target).sum()
    });
    let joints = pose.map_or(&[][..], |pose| &pose.joints);
    let at_rest = [DAffine3::IDENTITY];
    let joints = if joints.is_empty() { &at_rest } else { joints };
    let reach = |joint: &DAffine3| {
        let to = object.world_from_object * *joint;
        let stretch = to.matrix3.col(0).length() + to.matrix3.col(1).length() + to.matrix3.col(2).length();
        stretch * (rest + moved) + to.translation.length()
    };
    joints.iter().map(reach).fold(object.world_from_object.translation.length(), f64::max)
}

fn renderer() -> Renderer {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("a graphics driver; scripts/setup.sh installs one");
    Renderer::new(gpu, 1)
}

fn floor_under(scene: &Scene) -> Object {
    let bounds = scene.bounds();
    let (low, reach) = (bounds.min.z - 0.01 * bounds.radius(), 6.0 * bounds.radius());
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.map(|[x, y]| (bounds.center() + DVec3::new(x, y, 0.0) * reach).with_z(low).as_vec3());
    let surface =
        Surface { positions: positions.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Surface::default() };
    Object::new("floor", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY)
}

/// A camera at the model, whose last object is the floor, a sun and a lamp.
fn seen(scene: &Scene) -> (Camera, [Light; 2]) {
    let shown = scene.objects[..scene.objects.len() - 1].iter();
    let shown = shown.fold(Bounds::EMPTY, |all, object| all.union(object.bounds()));
    let (middle, radius) = (shown.center(), shown.radius());
    let eye = middle + DVec3::new(1.7, -2.3, 1.1) * radius;
    let camera = Camera::new(eye, middle, 0.7, 0.01 * scene.bounds().radius(), SIZE_PX).unwrap();
    let lights = [
        LightPosition::directional(DVec3::new(-0.53, -0.31, 0.67)).unwrap(),
        LightPosition::point(middle + DVec3::new(-0.9, -0.71, 1.6) * radius),
    ];
    (camera, lights.map(|position| Light::new("light", position, Vec3::ONE)))
}

#[test]
fn what_is_posed_and_not_read_back_shades_itself_and_others_exactly() {
    let Some(folder) = data::folder() else { return };
    let renderer = renderer();
    let gpu = renderer.gpu();
    let shadows = ShadowOptions { silhouettes: SilhouetteSource::Gpu, ..ShadowOptions::default() };
    for name in MODELS {
        let mut model = load(&folder.join(format!("gltf/{name}.glb")), &LoadOptions::default()).unwrap();
        let playing = model.animations.choose(None).unwrap();
        model.scene.objects.push(floor_under(&model.scene));
        let mut casters = Caster::of_scene(&model.scene);
        let mut drawn = GpuScene::new(gpu, &casters, &model.scene.materials, &model.scene.textures).unwrap();
        let mut poser = GpuPoser::new(gpu, &model.scene.objects, &casters, &drawn).unwrap();
        let (mut surface, mut decided) = (0, 0);
        for time_s in TIMES_S {
            model.animations.pose(&mut model.scene, &playing, time_s).unwrap();
            let (camera, lights) = seen(&model.scene);
            poser.show(gpu, &mut drawn, &model.scene.objects, &mut casters, 0.0);
            let positions = pollster::block_on(poser.positions(gpu, &drawn)).unwrap();
            let there = |(caster, positions): (&Caster, Vec<Vec3>)| {
                let bounds = Bounds::of_points(positions.iter().map(|p| p.as_dvec3()));
                assert_eq!(caster.bounds.union(bounds), caster.bounds, "{name} at {time_s} s is in its boxes");
                Caster { positions, bounds, ..caster.clone() }
            };
            let truth: Vec<Caster> = casters.iter().zip(positions).map(there).collect();
            let oracle = Oracle::with_materials(&truth, &model.scene.materials, &model.scene.textures);
            for (light, judgements) in lights.iter().zip(&oracle.judge(&camera, &lights, || ())) {
                let shot = Shot { shadows, ..Shot::new(&drawn, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let comparison = compare(&mask.verdicts, judgements);
                surface += comparison.surface;
                decided += comparison.decided;
                assert!(comparison.errors.is_empty(), "{name} at {time_s} s: {:?}", comparison.errors);
            }
        }
        println!("{name}: {decided} decided of {surface}");
        assert!(decided * 10 > surface * 8);
    }
}

#[test]
fn what_is_posed_on_the_gpu_is_where_the_cpu_puts_it_and_no_decided_pixel_is_wrong() {
    let Some(folder) = data::folder() else { return };
    let renderer = renderer();
    let gpu = renderer.gpu();
    let mut wrong = Vec::new();
    for name in MODELS {
        let mut model = load(&folder.join(format!("gltf/{name}.glb")), &LoadOptions::default()).unwrap();
        let playing = model.animations.choose(None).unwrap();
        model.scene.objects.push(floor_under(&model.scene));
        let at_rest = Caster::of_scene(&model.scene);
        let upload =
            |casters: &[Caster]| GpuScene::new(gpu, casters, &model.scene.materials, &model.scene.textures).unwrap();
        let mut posed = [Posing::Gpu, Posing::Cpu].map(|posing| {
            let scene = upload(&at_rest);
            let poser =
                Poser::new(gpu, posing, &model.scene.objects, &at_rest, &scene, &model.scene.materials).unwrap();
            (posing, poser, scene, at_rest.clone())
        });
        let (mut surface, mut decided, mut largest) = (0, 0, 0.0_f64);
        for time_s in TIMES_S {
            model.animations.pose(&mut model.scene, &playing, time_s).unwrap();
            let (camera, lights) = seen(&model.scene);
            for (posing, poser, scene, casters) in &mut posed {
                pollster::block_on(poser.pose(gpu, scene, &model.scene.objects, casters)).unwrap();
                let judged = Oracle::with_materials(casters, &model.scene.materials, &model.scene.textures).judge(
                    &camera,
                    &lights,
                    || (),
                );
                for (light, judgements) in lights.iter().zip(&judged) {
                    let shot = Shot::new(scene, casters, &camera, &[]);
                    let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                    let comparison = compare(&mask.verdicts, judgements);
                    surface += comparison.surface;
                    decided += comparison.decided;
                    if !comparison.errors.is_empty() {
                        wrong.push(format!("{name} at {time_s} s on {posing:?}: {:?}", comparison.errors));
                    }
                }
            }
            let [(.., ours), (.., theirs)] = &posed;
            for ((object, ours), theirs) in model.scene.objects.iter().zip(ours).zip(theirs) {
                let allowed = size_of_terms(object) * ROUNDINGS;
                for (a, b) in ours.positions.iter().zip(&theirs.positions) {
                    let apart = a.as_dvec3().distance(b.as_dvec3());
                    largest = largest.max(apart / allowed);
                    assert!(apart <= allowed, "{name} at {time_s} s: {a} on the GPU, {b} on the CPU");
                    let is_negative_zero = |x: &f32| *x == 0.0 && x.is_sign_negative();
                    assert!(!a.to_array().iter().any(is_negative_zero), "{name} at {time_s} s: {a}");
                }
            }
        }
        println!("{name}: {decided} decided of {surface}, positions {largest:.3} of what is allowed");
        assert!(decided * 10 > surface * 8);
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
