//! `umbrae bench smooth`: what smooth silhouettes cost in a frame, as O. Mattausch et al. 2012 have it in their table 1.

use std::path::Path;

use anyhow::ensure;
use serde::Serialize;
use umbrae_core::{Camera, Caster, Light, LightPosition};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Output, Renderer, ShadowOptions, Shot, Smooth, Targets};
use web_time::Instant;

use crate::cli::SmoothArgs;
use crate::model::load_all;
use crate::output::write_to_stdout;
use crate::smooth::smooth_bodies;
use crate::talk::Talk;
use crate::view::{ViewChoice, add_ground, camera, ground_under};

/// Three kinds of silhouettes.
const KINDS: [&str; 3] = ["discrete", "accurate", "smooth"];

/// How far the sun goes on between frames, degrees: a few minutes.
const STEP_DEG: f64 = 0.7;

/// What one model took.
#[derive(Debug, Serialize)]
struct ModelTimes {
    model: String,
    adapter: String,
    triangles: usize,
    size_px: [u32; 2],
    epsilon_m: f64,
    /// Of normals, creases and the search tree, once for all frames.
    prepare_ms: f64,
    kinds: Vec<KindTimes>,
}

/// What one kind of silhouettes took, medians over the frames.
#[derive(Debug, Serialize)]
struct KindTimes {
    name: &'static str,
    /// A frame under a sun that has moved.
    frame_ms: f64,
    /// A frame with the silhouettes of another.
    kept_ms: f64,
    /// Of a frame, what was on the CPU until volumes were ready to be uploaded.
    cpu_ms: f64,
    /// Pieces of the silhouette, a mean.
    pieces: usize,
    /// Medians of a frame relative to the discrete one right before it.
    frame_ratio: f64,
    kept_ratio: f64,
}

/// Measures each model, and prints a table or JSON.
///
/// # Errors
///
/// When a model can't be read or has nothing smooth; then nothing is printed.
pub(super) fn run(args: &SmoothArgs, talk: &Talk) -> anyhow::Result<()> {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))?;
    let renderer = Renderer::new(gpu, 1);
    let measured: Vec<ModelTimes> =
        args.models.iter().map(|path| measure(path, &renderer, args, talk)).collect::<anyhow::Result<_>>()?;
    let text = match (args.json, measured.as_slice()) {
        (true, [one]) => format!("{}\n", serde_json::to_string_pretty(one)?),
        (true, several) => format!("{}\n", serde_json::to_string_pretty(several)?),
        (false, several) => several.iter().map(table).collect::<Vec<_>>().join("\n"),
    };
    write_to_stdout(text.as_bytes())
}

fn measure(path: &Path, renderer: &Renderer, args: &SmoothArgs, talk: &Talk) -> anyhow::Result<ModelTimes> {
    let options = umbrae_formats::LoadOptions { normals: true, ..args.load.options() };
    let (mut scene, _) = load_all(&[path.to_owned()], &options, args.moment.moment().as_ref(), talk)?;
    ensure!(scene.triangle_count() > 0, "`{}` has no triangle, and so no silhouette", path.display());
    let model = scene.bounds();
    let ground = ground_under(&model);
    let choice = ViewChoice { size_px: args.size, ..ViewChoice::default() };
    let camera: Camera = camera(&choice, &scene, &model, Some(&ground))?;
    let triangles = scene.triangle_count();
    add_ground(&mut scene, &ground);
    let crease_rad = args.crease.to_radians();
    scene.split_smooth_parts(crease_rad);
    let mut casters = Caster::of_scene(&scene);
    let start = Instant::now();
    let ground = Some(casters.len() - 1);
    let bodies = smooth_bodies(&scene.objects, &mut casters, ground, crease_rad).bodies;
    let prepare_ms = ms_since(start);
    ensure!(bodies.iter().any(Option::is_some), "`{}` has no smooth object", path.display());
    let mut gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures)?;
    gpu_scene.give_bodies(bodies);
    let stage = Stage { renderer, gpu_scene, casters, camera, epsilon_m: args.epsilon };

    let targets = Targets::new(renderer.gpu(), Output::Picture, args.size, 1)?;
    let to = picture_view(renderer.gpu(), args.size);
    let mut times = [(); 3].map(|()| Times::default());
    for frame in 0..=args.frames {
        for (kind, times) in times.iter_mut().enumerate() {
            stage.frame(kind, frame, (&targets, &to), times)?;
        }
    }
    let first = times[0].clone();
    Ok(ModelTimes {
        model: path.display().to_string(),
        adapter: renderer.gpu().label.clone(),
        triangles,
        size_px: args.size,
        epsilon_m: args.epsilon,
        prepare_ms,
        kinds: KINDS.iter().zip(times).map(|(name, times)| times.of_kind(name, &first)).collect(),
    })
}

struct Stage<'a> {
    renderer: &'a Renderer,
    gpu_scene: GpuScene,
    casters: Vec<Caster>,
    camera: Camera,
    epsilon_m: f64,
}

/// Of each frame but the first, which compiles and warms up.
#[derive(Debug, Default, Clone)]
struct Times {
    frame_ms: Vec<f64>,
    kept_ms: Vec<f64>,
    cpu_ms: Vec<f64>,
    pieces: Vec<f64>,
}

impl Stage<'_> {
    /// One frame under a new sun, and one more with what was found for it.
    fn frame(
        &self,
        kind: usize,
        frame: u32,
        (targets, to): (&Targets, &wgpu::TextureView),
        times: &mut Times,
    ) -> anyhow::Result<()> {
        let azimuth_rad = (140.0 + STEP_DEG * f64::from(frame)).to_radians();
        let sun = Light::new("sun", LightPosition::sun(azimuth_rad, 35_f64.to_radians()), glam::Vec3::ONE);
        let smooth = match kind {
            0 => Smooth::Off,
            1 => Smooth::Accurate,
            _ => Smooth::Curved { epsilon_m: self.epsilon_m, epsilon_px: None },
        };
        let shadows = ShadowOptions { smooth, ..ShadowOptions::default() };
        let lights = [sun];
        let shot = Shot { shadows, ..Shot::new(&self.gpu_scene, &self.casters, &self.camera, &lights) };
        self.wait()?;
        let start = Instant::now();
        let prepared = self.renderer.prepare(&shot)?;
        self.renderer.draw_prepared(&shot, &prepared, targets, to)?;
        self.wait()?;
        let frame_ms = ms_since(start);
        let start = Instant::now();
        self.renderer.draw_prepared(&shot, &prepared, targets, to)?;
        self.wait()?;
        let kept_ms = ms_since(start);
        if frame > 0 {
            let reports = prepared.reports();
            times.frame_ms.push(frame_ms);
            times.kept_ms.push(kept_ms);
            times.cpu_ms.push(reports.iter().map(|report| report.cpu_ms).sum());
            let faces = reports.iter().flat_map(|report| &report.casters).filter_map(|caster| caster.faces);
            times.pieces.push(faces.map(|faces| faces.silhouette_edges as f64).sum());
        }
        Ok(())
    }

    fn wait(&self) -> anyhow::Result<()> {
        self.renderer.gpu().device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(())
    }
}

impl Times {
    fn of_kind(self, name: &'static str, discrete: &Self) -> KindTimes {
        let ratio = |own: &[f64], other: &[f64]| median(own.iter().zip(other).map(|(a, b)| a / b).collect());
        KindTimes {
            name,
            frame_ratio: ratio(&self.frame_ms, &discrete.frame_ms),
            kept_ratio: ratio(&self.kept_ms, &discrete.kept_ms),
            pieces: (self.pieces.iter().sum::<f64>() / self.pieces.len() as f64) as usize,
            frame_ms: median(self.frame_ms),
            kept_ms: median(self.kept_ms),
            cpu_ms: median(self.cpu_ms),
        }
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn table(times: &ModelTimes) -> String {
    let [width, height] = times.size_px;
    let head = format!(
        "{}: {} triangles, {width}x{height}, {}\nprepared once in {:.1} ms; silhouettes within {} m of their curves\n",
        times.model, times.triangles, times.adapter, times.prepare_ms, times.epsilon_m
    );
    let row = |kind: &KindTimes| {
        format!(
            "  {:9} {:9.2} {:7.3} {:9.2} {:7.3} {:9.2} {:8}\n",
            kind.name, kind.frame_ms, kind.frame_ratio, kind.kept_ms, kind.kept_ratio, kind.cpu_ms, kind.pieces
        )
    };
    let columns = "            frame ms   ratio   kept ms   ratio    cpu ms   pieces\n";
    head + columns + &times.kinds.iter().map(row).collect::<String>()
}

fn picture_view(gpu: &Gpu, [width, height]: [u32; 2]) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
