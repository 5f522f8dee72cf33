//! Soft shadows of ten scenes against rays to many points of their lights.
//!
//! Prints a table. `UMBRAE_SOFT=full` takes larger pictures and 4,096 rays a pixel, and holds the bars of the project; without, fewer, and bars with
//! room for what fewer rays leave to chance. `UMBRAE_SOFT_SCENE=fence` takes only what has "fence" in its name.

#![expect(clippy::unwrap_used, reason = "a test may panic")]
#![expect(clippy::print_stdout, reason = "the table is what one runs this for")]

mod data;
#[path = "soft/scenes.rs"]
mod scenes;

use umbrae_core::{Caster, Oracle, SeenLight};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Renderer, Shot};
use web_time::Instant;

use self::scenes::{SoftScene, scenes};

/// How closely one looks, and what is asked for.
struct Bars {
    size_px: [u32; 2],
    /// Rays along each side of the light.
    side: u32,
    /// Of what is seen of the light, over the pixels that are turned to it.
    mean: f64,
    /// In ninety-nine of a hundred pixels.
    most: f64,
}

fn bars() -> Bars {
    if std::env::var_os("UMBRAE_SOFT").is_some_and(|how| how == "full") {
        Bars { size_px: [128, 96], side: 64, mean: 0.01, most: 0.08 }
    } else {
        Bars { size_px: [64, 48], side: 10, mean: 0.012, most: 0.1 }
    }
}

/// Of the shares of a light that pixels see, and of the light that they get.
struct Errors {
    /// Pixels whose surface's plane does not cut through the light.
    pixels: usize,
    /// Of those, how many see it in part.
    partly: usize,
    mean: f64,
    most: f64,
    worst: f64,
    /// In all pixels that are turned to the light, of what falls on them as a share of what would fall on them if they faced it.
    mean_of_light: f64,
    most_of_light: f64,
}

impl Errors {
    fn new(seen: &[f32], truth: &[Option<SeenLight>]) -> Self {
        let pairs = || seen.iter().zip(truth).filter_map(|(&seen, truth)| Some((f64::from(seen), (*truth)?)));
        let sorted = |errors: Vec<f64>| {
            let mut errors = errors;
            errors.sort_by(f64::total_cmp);
            errors
        };
        let whole = || pairs().filter(|(_, truth)| truth.is_above_plane);
        let of_share = sorted(whole().map(|(seen, truth)| (seen - truth.share).abs()).collect());
        let light = |(seen, truth): (f64, SeenLight)| (seen * truth.center_cosine - truth.mean_cosine).abs();
        let of_light = sorted(pairs().map(light).collect());
        let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        let most = |errors: &[f64]| errors.get(errors.len() * 99 / 100).copied().unwrap_or(0.0);
        Self {
            pixels: of_share.len(),
            partly: whole().filter(|(_, truth)| (0.02..0.98).contains(&truth.share)).count(),
            mean: mean(&of_share),
            most: most(&of_share),
            worst: of_share.last().copied().unwrap_or(0.0),
            mean_of_light: mean(&of_light),
            most_of_light: most(&of_light),
        }
    }
}

#[test]
fn soft_shadows_of_ten_scenes_are_as_rays_to_many_points_of_the_light_find_them() {
    let bars = bars();
    let Some(data) = data::folder() else { return };
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let renderer = Renderer::new(gpu, 1);
    println!("adapter: {}; {} rays a pixel, {:?} pixels", renderer.gpu().label, bars.side * bars.side, bars.size_px);
    println!(
        "| scene | triangles | pixels | in part | mean | 99 of 100 | worst | light: mean | 99 of 100 | GPU ms | rays s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let wanted = std::env::var("UMBRAE_SOFT_SCENE").unwrap_or_default();
    let mut missed = Vec::new();
    for soft in scenes(&data, bars.size_px).into_iter().filter(|scene| scene.name.contains(&wanted)) {
        let (errors, line) = measured(&renderer, &soft, bars.side);
        println!("{line}");
        assert!(errors.partly > 0, "{}: no pixel sees the light in part", soft.name);
        if errors.mean >= bars.mean || errors.most >= bars.most {
            missed.push(format!("{}: mean {:.4}, 99 of 100 below {:.4}", soft.name, errors.mean, errors.most));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

fn measured(renderer: &Renderer, soft: &SoftScene, side: u32) -> (Errors, String) {
    let SoftScene { name, scene, camera, light } = soft;
    let casters = Caster::of_scene(scene);
    let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let shot = Shot::new(&drawn, &casters, camera, &[]);
    let visibility = pollster::block_on(renderer.visibility(&shot, light)).unwrap();
    let gpu_ms: f64 = visibility.passes.iter().map(|pass| pass.ms).sum();
    let start = Instant::now();
    let oracle = Oracle::with_materials(&casters, &scene.materials, &scene.textures);
    let truth = oracle.seen_light(camera, light, side, || ());
    let rays_s = start.elapsed().as_secs_f64();
    let errors = Errors::new(&visibility.seen, &truth);
    let triangles = scene.triangle_count();
    let Errors { pixels, partly, mean, most, worst, mean_of_light, most_of_light } = errors;
    let line = format!(
        "| {name} | {triangles} | {pixels} | {partly} | {mean:.4} | {most:.4} | {worst:.3} | {mean_of_light:.4} | \
         {most_of_light:.4} | {gpu_ms:.1} | {rays_s:.1} |"
    );
    (errors, line)
}
