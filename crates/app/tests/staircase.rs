//! The staircase under its own lamp, whose low steps are in the shadows of up to 299 others: without a wrap in the
//! count, with one sample a pixel and with four.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use umbrae::sample::Sample;
use umbrae_core::{Camera, Caster, Judgement, Light, Oracle, Scene, Verdict};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Method, Renderer, ShadowOptions, Shot, compare};

const SIZE_PX: [u32; 2] = [320, 240];

struct Staircase {
    scene: Scene,
    casters: Vec<Caster>,
    camera: Camera,
    judged: Vec<Judgement>,
}

impl Staircase {
    /// As its camera sees the lowest hundred steps.
    fn new() -> Self {
        let scene = Sample::Staircase.scene();
        let casters = Caster::of_scene(&scene);
        let camera = scene.cameras[0].with_size(SIZE_PX).unwrap();
        let judged = Oracle::new(&casters).judge(&camera, &scene.lights, || ()).remove(0);
        Self { scene, casters, camera, judged }
    }

    fn lamp(&self) -> &Light {
        &self.scene.lights[0]
    }

    /// Whether this pixel and all around it are dark for certain.
    fn is_dark_around(&self, pixel: usize) -> bool {
        let [width, height] = SIZE_PX.map(|side| side as usize);
        let (x, y) = (pixel % width, pixel / width);
        let is_inside = (1..width - 1).contains(&x) && (1..height - 1).contains(&y);
        let rows = || (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| y * width + x));
        is_inside && rows().all(|i| self.judged[i].verdict == Some(Verdict::Dark))
    }

    fn renderer(&self, samples: u32) -> (Renderer, GpuScene) {
        let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
            .expect("tests need a graphics driver: run scripts/setup.sh");
        let renderer = Renderer::new(gpu, samples);
        let gpu_scene =
            GpuScene::new(renderer.gpu(), &self.casters, &self.scene.materials, &self.scene.textures).unwrap();
        (renderer, gpu_scene)
    }

    fn shot<'a>(&'a self, scene: &'a GpuScene, lights: &'a [Light], method: Method, look: &'a Look) -> Shot<'a> {
        let shadows = ShadowOptions::from(method);
        Shot { shadows, look, ..Shot::new(scene, &self.casters, &self.camera, lights) }
    }
}

#[test]
fn the_low_steps_are_dark_by_every_method() {
    let staircase = Staircase::new();
    let (renderer, gpu_scene) = staircase.renderer(1);
    for method in [Method::Auto, Method::ZFail, Method::EyeCount] {
        let shot = staircase.shot(&gpu_scene, &[], method, &Look::NONE);
        let mask = pollster::block_on(renderer.mask(&shot, staircase.lamp())).unwrap();
        assert_eq!(compare(&mask.verdicts, &staircase.judged).errors.len(), 0, "{method:?}");
        let counts = pollster::block_on(renderer.counts(&shot, staircase.lamp())).unwrap();
        assert!(counts.contains(&256), "where eight bits wrap to nothing: {:?}", counts.iter().max());
    }
}

#[test]
fn with_four_samples_the_low_steps_look_as_if_there_were_no_lamp() {
    let staircase = Staircase::new();
    let (renderer, gpu_scene) = staircase.renderer(4);
    let look = Look::for_model(&staircase.scene.bounds(), &staircase.scene.lights);
    let picture = |lights: &[Light]| {
        pollster::block_on(renderer.picture(&staircase.shot(&gpu_scene, lights, Method::Auto, &look))).unwrap().rgba
    };
    let (with_lamp, without) = (picture(&staircase.scene.lights), picture(&[]));
    let mut dark = 0;
    for (pixel, (with_lamp, without)) in with_lamp.chunks(4).zip(without.chunks(4)).enumerate() {
        if staircase.is_dark_around(pixel) {
            assert_eq!(with_lamp, without, "pixel {pixel}");
            dark += 1;
        }
    }
    assert!(dark > 5_000, "{dark} dark pixels");
}
