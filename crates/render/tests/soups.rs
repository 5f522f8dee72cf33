//! Random soups on the GPU against rays: shared vertices, random windings, fans, the eye among the triangles.

mod random;
mod soup;

use glam::Vec3;
use random::Random;
use soup::soup;
use umbrae_core::{Camera, Caster, Light, LightPosition, Oracle};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Method, Renderer, ShadowOptions, Shot, SilhouetteSource, compare};

const SOURCES: [SilhouetteSource; 3] = [SilhouetteSource::Auto, SilhouetteSource::Gpu, SilhouetteSource::GpuBasic];

/// The default, z-fail and counting from the eye, and the default with one rule off at a time; with silhouettes from the CPU and, in both ways, from the GPU.
fn all_options() -> impl Iterator<Item = (&'static str, ShadowOptions)> {
    let methods = [("auto", Method::Auto), ("z-fail", Method::ZFail), ("eye count", Method::EyeCount)];
    let methods = methods.map(|(name, method)| (name, ShadowOptions::from(method)));
    let of_cpu = methods.into_iter().chain(ShadowOptions::default().each_rule_off());
    let found = |source| move |(name, options)| (name, ShadowOptions { silhouettes: source, ..options });
    SOURCES.into_iter().flat_map(move |source| of_cpu.clone().map(found(source)))
}

#[test]
fn every_decided_pixel_of_a_soup_is_right_with_the_eye_among_the_triangles() {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    let mut random = Random::new(1);
    let (mut surface, mut decided, mut with_zpass) = (0, 0, 0);
    for number in 0..40 {
        let scene = soup(&mut random);
        let casters = Caster::of_scene(&scene);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        let camera = Camera::new(random.point(3.0), random.point(1.0), 1.2, 0.05, [160, 120]).unwrap();
        let oracle = Oracle::new(&casters);
        let corners = casters[0].corners(0).map(Vec3::as_dvec3);
        let in_plane = corners[0] * 3.0 - corners[1] - corners[2];
        let lights = [
            LightPosition::point(random.point(6.0)),
            LightPosition::point(random.point(2.0)),
            LightPosition::point(in_plane),
            LightPosition::directional(random.point(1.0)).unwrap(),
        ]
        .map(|position| Light::new("light", position, Vec3::ONE));
        let judged = oracle.judge(&camera, &lights, || ());
        for (light, judgements) in lights.iter().zip(&judged) {
            let mut firsts: [Option<Vec<u8>>; 3] = [None, None, None];
            for (rule, shadows) in all_options() {
                let shot = Shot { shadows, ..Shot::new(&gpu_scene, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let which = SOURCES.iter().position(|source| *source == shadows.silhouettes);
                let first = &mut firsts[which.expect("it is one of them")];
                let first = first.get_or_insert_with(|| mask.verdicts.clone());
                assert!(
                    *first == mask.verdicts,
                    "soup {number}, {light:?}, {rule} differs from the default, {:?}",
                    shadows.silhouettes
                );
                let comparison = compare(&mask.verdicts, judgements);
                surface += comparison.surface;
                decided += comparison.decided;
                with_zpass += usize::from(mask.light.casters.iter().any(|c| c.case().is_some_and(|c| c.number() == 1)));
                assert_eq!(comparison.errors, [], "soup {number}, {light:?}, {rule}, {:?}", shadows.silhouettes);
            }
        }
    }
    println!("{decided} decided of {surface} surface pixels, {with_zpass} masks with z-pass casters");
    assert!(decided > 2_000_000 && with_zpass > 20);
}
