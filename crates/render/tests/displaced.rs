//! Vertices that only the GPU knows: what is displaced casts and shadows itself as rays say, at any time.

#[expect(dead_code, reason = "the example's main is not run")]
#[path = "../examples/displaced_spheres.rs"]
mod displaced_spheres;

use displaced_spheres::{MAX_OFFSET_M, MOVED, NOISE, camera, lights, scene};
use glam::Vec3;
use umbrae_core::{Bounds, Caster, Oracle, Verdict};
use umbrae_render::{
    AdapterChoice, Displacement, Gpu, GpuError, GpuPoser, GpuScene, Method, Renderer, ShadowOptions, Shot,
    SilhouetteSource, compare,
};

const SIZE_PX: [u32; 2] = [240, 136];
const TIMES: u32 = 10;

fn renderer() -> Renderer {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    Renderer::new(gpu, 1)
}

/// Casters that are where the GPU has them.
fn moved(casters: &[Caster], positions: Vec<Vec<Vec3>>) -> Vec<Caster> {
    let at = |(caster, positions): (&Caster, Vec<Vec3>)| Caster {
        bounds: Bounds::of_points(positions.iter().map(|p| p.as_dvec3())),
        positions,
        ..caster.clone()
    };
    casters.iter().zip(positions).map(at).collect()
}

#[test]
fn spheres_displaced_on_the_gpu_shade_themselves_and_others_exactly_at_ten_times() {
    let renderer = renderer();
    let gpu = renderer.gpu();
    let (scene, camera, lights) = (scene(), camera(SIZE_PX).unwrap(), lights());
    let at_rest = Caster::of_scene(&scene);
    let mut casters = at_rest.clone();
    let mut drawn = GpuScene::new(gpu, &casters, &scene.materials, &scene.textures).unwrap();
    let noise = Displacement { wgsl: NOISE, max_offset_m: MAX_OFFSET_M, objects: &MOVED };
    let poser = GpuPoser::displacing(gpu, &scene.objects, &casters, &drawn, &noise);
    let mut poser = pollster::block_on(poser).unwrap();
    let mut before: Option<Vec<Caster>> = None;
    let (mut decided, mut dark, mut on_spheres) = (0, 0, 0);
    for i in 0..TIMES {
        let time_s = i as f32 * 0.37;
        poser.show(gpu, &mut drawn, &scene.objects, &mut casters, time_s);
        let truth = moved(&at_rest, pollster::block_on(poser.positions(gpu, &drawn)).unwrap());
        for (caster, truth) in casters.iter().zip(&truth) {
            assert_eq!(caster.bounds.union(truth.bounds), caster.bounds, "boxes hold what was moved");
        }
        let farthest = at_rest[0].positions.iter().zip(&truth[0].positions).map(|(a, b)| a.distance(*b));
        assert!(farthest.fold(0.0, f32::max) > 0.1, "spheres have bumps");
        assert_eq!(at_rest[3].positions, truth[3].positions, "the floor is flat");
        if let Some(before) = before.replace(truth.clone()) {
            assert_ne!(before[0].positions, truth[0].positions, "and bumps move");
        }
        let judged = Oracle::with_materials(&truth, &scene.materials, &scene.textures).judge(&camera, &lights, || ());
        for (light, judgements) in lights.iter().zip(&judged) {
            for (method, silhouettes) in [
                (Method::Auto, SilhouetteSource::Gpu),
                (Method::ZFail, SilhouetteSource::Gpu),
                (Method::Auto, SilhouetteSource::GpuBasic),
            ] {
                let shadows = ShadowOptions { silhouettes, ..ShadowOptions::from(method) };
                let shot = Shot { shadows, ..Shot::new(&drawn, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let comparison = compare(&mask.verdicts, judgements);
                assert_eq!(comparison.errors, [], "at {time_s} s under {}, {method:?}", light.name);
                decided += comparison.decided;
            }
            dark += judgements.iter().filter(|j| j.verdict == Some(Verdict::Dark)).count();
            on_spheres += judgements.iter().filter(|j| j.has_surface).count();
        }
    }
    println!("{decided} pixels decided, {dark} of {on_spheres} dark");
    assert!(decided > 500_000 && dark > 100_000);
}

#[test]
fn what_a_function_would_take_too_far_stays_in_its_box() {
    let renderer = renderer();
    let gpu = renderer.gpu();
    let scene = scene();
    let mut casters = Caster::of_scene(&scene);
    let mut drawn = GpuScene::new(gpu, &casters, &scene.materials, &scene.textures).unwrap();
    let wgsl = "fn moved(position_world: vec3f, vertex: u32, time_s: f32) -> vec3f {
        return position_world * (1.0 + time_s) + f32(vertex);
    }";
    let far = Displacement { wgsl, max_offset_m: 0.25, objects: &[1] };
    let mut poser = pollster::block_on(GpuPoser::displacing(gpu, &scene.objects, &casters, &drawn, &far)).unwrap();
    poser.show(gpu, &mut drawn, &scene.objects, &mut casters, 5.0);
    let truth = moved(&casters, pollster::block_on(poser.positions(gpu, &drawn)).unwrap());
    let moved = truth[1].positions.iter().zip(&casters[1].positions).map(|(a, b)| a.distance(*b));
    assert!(moved.fold(0.0, f32::max) > 0.249);
    assert_eq!(casters[1].bounds.union(truth[1].bounds), casters[1].bounds);
}

#[test]
fn a_function_that_is_no_good_is_an_error_that_says_why() {
    let renderer = renderer();
    let scene = scene();
    let casters = Caster::of_scene(&scene);
    let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let bad = Displacement { wgsl: "fn moved() -> vec3f { return wind; }", max_offset_m: 1.0, objects: &[0] };
    let made = pollster::block_on(GpuPoser::displacing(renderer.gpu(), &scene.objects, &casters, &drawn, &bad));
    let Err(GpuError::Shader { reason }) = made else { panic!("it is no good") };
    assert!(reason.contains("wind"), "{reason}");
}
