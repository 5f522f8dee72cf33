//! How long silhouettes take for one light and for twelve, found on the GPU for all at once and on the CPU light by light.
//!
//! `cargo bench -p umbrae --bench silhouettes`, with models to be measured as arguments or none. Medians of frames after one that
//! warms up; the GPU's times are its own.

#![expect(clippy::print_stdout, reason = "the table is what one runs this for")]

use std::path::{Path, PathBuf};

use anyhow::ensure;
use glam::{DVec3, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Scene};
use umbrae_formats::{LoadOptions, load};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Renderer, ShadowOptions, Shot, SilhouetteSource};

/// Small, as nothing here is about pixels.
const SIZE_PX: [u32; 2] = [64, 64];
/// Odd, so that the median is one of them.
const FRAMES: usize = 9;
/// The ways, each with its passes.
const SOURCES: [(SilhouetteSource, &[&str]); 2] =
    [(SilhouetteSource::Gpu, &["silhouettes"]), (SilhouetteSource::GpuBasic, &["coefficients", "multiplicities"])];
const LIGHTS: [usize; 3] = [1, 4, 12];
/// All lights together may take so many times what one takes.
const BAR: f64 = 4.0;

fn main() -> anyhow::Result<()> {
    // `cargo bench` adds options, of which there are none here.
    let models: Vec<PathBuf> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).map(PathBuf::from).collect();
    let dragon = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/mesh/dragon_100k.ply");
    let models = if models.is_empty() { vec![dragon] } else { models };
    let renderer = Renderer::new(pollster::block_on(Gpu::new(&AdapterChoice::default()))?, 1);
    println!("adapter: {}", renderer.gpu().label);
    for model in models {
        measure(&renderer, &model)?;
    }
    Ok(())
}

fn measure(renderer: &Renderer, path: &Path) -> anyhow::Result<()> {
    let scene = load(path, &LoadOptions::default())?.scene;
    let casters = Caster::of_scene(&scene);
    let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures)?;
    let bounds = scene.bounds();
    let eye = bounds.center() + DVec3::new(1.1, -1.9, 0.8) * bounds.radius();
    let camera = Camera::new(eye, bounds.center(), 0.8, 0.01 * bounds.radius(), SIZE_PX)?;
    println!("{}: {} triangles", path.display(), scene.triangle_count());
    let mut of_one_ms = [None, None];
    for count in LIGHTS {
        let lights = lamps(&scene, count);
        let by = |silhouettes| Shot {
            shadows: ShadowOptions { silhouettes, ..ShadowOptions::default() },
            ..Shot::new(&drawn, &casters, &camera, &lights)
        };
        for ((source, passes), of_one_ms) in SOURCES.into_iter().zip(&mut of_one_ms) {
            let (mut on_gpu_ms, mut planned_ms) = (Vec::new(), Vec::new());
            for _ in 0..=FRAMES {
                let found = pollster::block_on(renderer.picture(&by(source)))?;
                let times = found.passes.iter().filter(|pass| passes.contains(&pass.name.as_str()));
                on_gpu_ms.push(times.map(|pass| pass.ms).sum::<f64>());
                planned_ms.push(found.lights.iter().map(|light| light.cpu_ms).sum::<f64>());
            }
            let [on_gpu_ms, planned_ms] = [on_gpu_ms, planned_ms].map(median);
            ensure!(on_gpu_ms > 0.0, "the device can't tell how long passes take");
            let times = on_gpu_ms / *of_one_ms.get_or_insert(on_gpu_ms);
            println!(
                "{count:>4} lights, {source:?}: {on_gpu_ms:.3} ms on the GPU ({times:.2} times one), {planned_ms:.3} ms to plan \
                 that"
            );
            ensure!(times < BAR, "{count} lights take {times:.2} times what one takes, and {BAR} are allowed");
        }
        let on_cpu_ms = (0..=FRAMES).map(|_| {
            let own = pollster::block_on(renderer.picture(&by(SilhouetteSource::Auto)))?;
            Ok(own.lights.iter().map(|light| light.cpu_ms).sum::<f64>())
        });
        println!("{count:>4} lights: {:.3} ms on the CPU", median(on_cpu_ms.collect::<anyhow::Result<_>>()?));
    }
    Ok(())
}

/// Around the scene, outside of it, each in a place of its own: as Fibonacci has them on a sphere.
fn lamps(scene: &Scene, count: usize) -> Vec<Light> {
    let bounds = scene.bounds();
    let lamp = |i: usize| {
        let height = 0.1 + 0.8 * (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (2.399_963 * i as f64 + 0.3).sin_cos();
        let flat = (1.0 - height * height).sqrt();
        let place = bounds.center() + DVec3::new(cos * flat, sin * flat, height) * (2.5 * bounds.radius());
        Light::new(format!("lamp {i}"), LightPosition::point(place), Vec3::ONE)
    };
    (0..count).map(lamp).collect()
}

/// Without the first.
fn median(mut values: Vec<f64>) -> f64 {
    values.remove(0);
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
