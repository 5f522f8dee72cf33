//! Every real model, under four lights, from three cameras, by two methods: no decided pixel is wrong.
//!
//! The built-in scenes take part as well, but for the staircase under its own lamp, where 300 volumes overlap and an 8-bit
//! stencil wraps. Prints a table. `UMBRAE_VERIFY=dragon` takes only what has "dragon" in its name.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod data;

use std::path::Path;

use glam::{DVec3, Vec3};
use umbrae::output::png;
use umbrae::sample::Sample;
use umbrae::talk::Talk;
use umbrae::verify::error_picture;
use umbrae::view::{ViewChoice, add_ground, camera, ground_under};
use umbrae_core::{Bounds, Camera, Caster, Judgement, Light, LightPosition, Oracle, Scene};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Method, Renderer, ShadowOptions, Shot, compare};

const SIZE_PX: [u32; 2] = [320, 240];
/// Of the surface pixels of the median model.
const LEAST_DECIDED: f64 = 0.95;

/// One model's line in the table.
#[derive(Default)]
struct Line {
    name: String,
    triangles: usize,
    surface: usize,
    decided: usize,
    /// Masks in which some caster was counted by z-fail because it had to be.
    needed_zfail: usize,
    masks: usize,
    /// Wrong pixels.
    wrong: usize,
    /// A sentence for each mask with wrong pixels.
    errors: Vec<String>,
}

impl Line {
    fn decided_share(&self) -> f64 {
        self.decided as f64 / self.surface.max(1) as f64
    }
}

#[test]
fn every_decided_pixel_of_every_model_is_right() {
    let Some(folder) = data::folder() else { return };
    let wanted = std::env::var("UMBRAE_VERIFY").ok().filter(|name| name != "all");
    let files = data::models(&folder);
    assert!(files.len() >= 50, "only {} models in {}", files.len(), folder.display());
    let name_in = |path: &Path| path.strip_prefix(&folder).unwrap().display().to_string();
    let mut sources: Vec<(String, Source)> = files.into_iter().map(|p| (name_in(&p), Source::File(p))).collect();
    for sample in [Sample::LatticeTower, Sample::Industry, Sample::HighRise, Sample::Town] {
        sources.push((format!("sample {sample:?}"), Source::Sample(sample)));
    }
    sources.retain(|(name, _)| wanted.as_ref().is_none_or(|wanted| name.contains(wanted)));
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("a graphics driver; scripts/setup.sh installs one");
    println!("{}, {}x{}, one sample", gpu.label, SIZE_PX[0], SIZE_PX[1]);
    let renderer = Renderer::new(gpu, 1);

    println!(
        "{:<34} {:>9} {:>9} {:>8} {:>7} {:>7} {:>6}",
        "model", "triangles", "surface", "decided", "z-fail", "masks", "errors"
    );
    let mut lines: Vec<Line> = Vec::new();
    for (name, source) in sources {
        let line = verify(&renderer, name, source.scene());
        println!(
            "{:<34} {:>9} {:>9} {:>7.2}% {:>7} {:>7} {:>6}",
            line.name,
            line.triangles,
            line.surface,
            100.0 * line.decided_share(),
            line.needed_zfail,
            line.masks,
            line.wrong
        );
        lines.push(line);
    }
    let total = |f: fn(&Line) -> usize| lines.iter().map(f).sum::<usize>();
    let errors: Vec<&String> = lines.iter().flat_map(|l| &l.errors).collect();
    let mut shares: Vec<f64> = lines.iter().map(Line::decided_share).collect();
    shares.sort_by(f64::total_cmp);
    let median = shares[shares.len() / 2];
    println!(
        "{} models, {} masks, {} surface pixels, {} decided (median model {:.2} %), {} masks needed z-fail, {} errors",
        lines.len(),
        total(|l| l.masks),
        total(|l| l.surface),
        total(|l| l.decided),
        100.0 * median,
        total(|l| l.needed_zfail),
        total(|l| l.wrong)
    );
    assert!(errors.is_empty(), "{errors:#?}");
    assert!(median >= LEAST_DECIDED, "the median model is decided at {median}");
    assert!(
        wanted.is_some() || total(|l| l.needed_zfail) > lines.len() / 2,
        "z-fail was hardly needed: the cameras are not where they should be"
    );
}

enum Source {
    File(std::path::PathBuf),
    Sample(Sample),
}

impl Source {
    fn scene(self) -> Scene {
        let quiet = Talk::new(true, umbrae::cli::ColorWhen::Never);
        match self {
            Self::File(path) => umbrae::model::load_one(&path, None, &quiet).unwrap().scene,
            Self::Sample(sample) => sample.scene(),
        }
    }
}

fn verify(renderer: &Renderer, name: String, mut scene: Scene) -> Line {
    let bounds = scene.bounds();
    let mut line = Line { name, triangles: scene.triangle_count(), ..Line::default() };
    let model_only = Oracle::new(&Caster::of_scene(&scene));
    let ground = ground_under(&bounds);
    let view = |choice: ViewChoice| camera(&choice, &scene, &bounds, Some(&ground)).unwrap();
    let outside = view(ViewChoice { size_px: SIZE_PX, ..ViewChoice::default() });
    let sun = LightPosition::sun(238_f64.to_radians(), 40_f64.to_radians());
    let in_shadow = view(in_shadow(&bounds, &model_only, sun, scene.origin));
    add_ground(&mut scene, &ground);
    let casters = Caster::of_scene(&scene);
    let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let oracle = Oracle::with_materials(&casters, &scene.materials, &scene.textures);
    let lights = four_lights(&bounds, &casters[0], sun);

    for (which, camera) in [outside, in_shadow, cutting(&outside, &bounds)].into_iter().enumerate() {
        let judged = oracle.judge(&camera, &lights, || ());
        for (light, judgements) in lights.iter().zip(&judged) {
            for method in [Method::Auto, Method::ZFail] {
                let shadows = ShadowOptions::from(method);
                let shot = Shot {
                    scene: &gpu_scene,
                    casters: &casters,
                    camera: &camera,
                    lights: &[],
                    shadows,
                    look: &Look::NONE,
                    overlay: None,
                };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let comparison = compare(&mask.verdicts, judgements);
                line.masks += 1;
                line.surface += comparison.surface;
                line.decided += comparison.decided;
                line.needed_zfail += usize::from(
                    method == Method::Auto
                        && mask.light.casters.iter().any(|c| c.case().is_some_and(|case| case.number() > 1)),
                );
                line.wrong += comparison.errors.len();
                if let Some(first) = comparison.errors.first() {
                    let (x, y) = (first % SIZE_PX[0] as usize, first / SIZE_PX[0] as usize);
                    line.errors.push(format!(
                        "{}, camera {which}, {}, {method:?}: {} wrong pixels, the first at {x},{y}",
                        line.name,
                        light.name,
                        comparison.errors.len()
                    ));
                    draw_errors(&line, &mask.verdicts, judgements, &comparison.errors);
                }
            }
        }
    }
    line
}

/// Writes a picture of the wrong pixels of the line's last mask under the target folder's `tmp/verify/`.
fn draw_errors(line: &Line, mask: &[u8], judgements: &[Judgement], errors: &[usize]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("verify");
    std::fs::create_dir_all(&folder).unwrap();
    let file = format!("{} {}.png", line.name.replace('/', " "), line.errors.len());
    let rgba = error_picture(mask, judgements, errors, SIZE_PX[0] as usize);
    let bytes = png(&rgba, SIZE_PX, image::ExtendedColorType::Rgba8).unwrap();
    std::fs::write(folder.join(file), bytes).unwrap();
}

/// The sun; a lamp outside; a lamp inside the model's box; a lamp in the plane of one of its triangles.
fn four_lights(bounds: &Bounds, caster: &Caster, sun: LightPosition) -> [Light; 4] {
    let at = |x: f64, y: f64, z: f64| bounds.center() + 0.5 * bounds.size() * DVec3::new(x, y, z);
    let [a, b, c] = caster.corners(caster.mesh.triangles().len() / 2).map(Vec3::as_dvec3);
    let light = |name: &str, position: LightPosition| Light::new(name, position.rounded_to_f32(), Vec3::ONE);
    let outwards = DVec3::new(1.3, -0.7, 1.9) * bounds.radius().max(1e-3);
    [
        light("sun", sun),
        light("lamp outside", LightPosition::point(bounds.center() + outwards)),
        light("lamp inside the box", LightPosition::point(at(0.31, -0.43, 0.57))),
        light("lamp in a triangle's plane", LightPosition::point(a + (b - a) * 3.1 - (c - a) * 1.7)),
    ]
}

/// A view whose eye the model shades: behind it as seen from the light, or as near to that as can be found.
fn in_shadow(bounds: &Bounds, model: &Oracle, light: LightPosition, origin: DVec3) -> ViewChoice {
    let to_light = light.offset_from(bounds.center()).normalize_or_zero();
    let radius = bounds.radius();
    let is_shaded = |eye: DVec3| model.casting().is_hit(eye, light.offset_from(eye), 0.0, f64::INFINITY);
    let behind = bounds.center() - to_light * radius * 1.15;
    let eye = (1..200)
        .map(|i| {
            let spread = DVec3::new((f64::from(i) * 0.7).sin(), (f64::from(i) * 1.3).sin(), (f64::from(i) * 2.1).sin());
            behind + spread * radius * 0.004 * f64::from(i)
        })
        .find(|&eye| is_shaded(eye))
        .unwrap_or(behind);
    ViewChoice {
        size_px: SIZE_PX,
        eye: Some(eye + origin),
        target: Some(bounds.center() + radius * DVec3::new(0.21, 0.17, -0.13) + origin),
        fov_deg: Some(68.0),
        ..ViewChoice::default()
    }
}

/// The outside camera with its near plane through the model.
fn cutting(outside: &Camera, bounds: &Bounds) -> Camera {
    let depth = (bounds.center() - outside.eye()).dot(outside.axes()[2]);
    let near = (depth - 0.13 * bounds.radius()).max(outside.near());
    Camera::new(outside.eye(), outside.target(), outside.fov_y_rad(), near, SIZE_PX).unwrap()
}
