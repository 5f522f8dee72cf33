//! `umbrae render`: models into a picture, its mask, its report and its proof.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};
use glam::{DVec3, Vec3};
use image::ExtendedColorType::{L8, Rgba8};
use umbrae_core::{Bounds, Camera, Caster, Extent, Finder, FinderKind, Light, Oracle, Scene, Sphere};
use umbrae_formats::LoadOptions;
use umbrae_render::{
    AdapterChoice, Comparison, Gpu, GpuPoser, GpuScene, Look, Mask, Picture, Renderer, ShadowOptions, Shot,
    SilhouetteSource, compare,
};
use web_time::Instant;

use crate::area::{Area, as_points};
use crate::cache::Cache;
use crate::cli::{Method, Posing, RenderArgs, Silhouette};
use crate::extent::with_extents;
use crate::light_warnings::{warn_of_cuts, warn_of_darkness, warn_of_no_extent};
use crate::lights::{lights, reaching};
use crate::model::load_all;
use crate::output::{Output, Staged, png, write_to_stdout};
use crate::report::{
    CameraReport, Cost, GroundReport, LeftOut, LightJson, ModelReport, Report, SphereReport, Times, VerifyJson,
};
use crate::show::{self, Numbers, Show, ShowReport, Subject};
use crate::smooth::{smooth_bodies, tessellate};
use crate::talk::{Talk, counted};
use crate::verify::error_picture;
use crate::view::{ViewChoice, add_ground, camera, ensure_drawable, ground_under};

/// Of balls, which have no material: linear, a light and quiet grey.
const SPHERE_COLOR: Vec3 = Vec3::splat(0.7);

/// Everything a picture is made of, ready to draw.
struct Stage {
    renderer: Renderer,
    gpu_scene: GpuScene,
    casters: Vec<Caster>,
    spheres: Vec<Sphere>,
    camera: Camera,
    lights: Vec<Light>,
    shadows: ShadowOptions,
    look: Look,
}

/// Draws, writes what was asked for, and returns whether the verification (if any) found no error.
///
/// # Errors
///
/// Whatever is wrong with the input, the output's place or the device; then nothing is written.
pub fn run(args: &RenderArgs, talk: &Talk) -> anyhow::Result<bool> {
    let lamps = args.light.lamps()?;
    let extent_of_all = args.light.extent_of_all()?;
    let is_moved_later = args.posing == Some(Posing::Gpu) && args.shadows.crease_rad().is_some();
    ensure!(!is_moved_later, "--posing gpu moves what --smooth has prepared; leave one of them out");
    let outputs = Outputs::create(args)?;
    let mut times = Times::default();

    let start = Instant::now();
    let (mut scene, files) = load_all(&args.models, &load_options(args), args.moment.moment().as_ref(), talk)?;
    times.load = ms_since(start);
    let spheres = spheres(args, scene.origin);
    let model = spheres.iter().fold(scene.bounds(), |bounds, sphere| bounds.union(sphere.bounds()));
    let choice = ViewChoice { spheres: spheres.clone(), ..view_choice(args) };
    let ground = (!args.no_ground).then(|| ground_under(&model));
    ensure_drawable(&scene, &model, ground.as_ref()).with_context(|| format!("can't draw {}", names(&args.models)))?;
    let camera = camera(&choice, &scene, &model, ground.as_ref())?;
    let lights = with_extents(lights(&lamps, &scene, &model), &lamps, extent_of_all, args.sun_disc, &model)?;
    let look = Look::for_model(&model, &lights);
    warn_of_darkness(&lights, talk);
    let lights = with_sizes(reaching(lights, look.exposure), &model, args, talk);
    let soft = lights.iter().filter(|light| light.extent != Extent::Point).count();
    warn_of_no_extent(&lights, (args, extent_of_all), talk);
    if let Some(ground) = &ground {
        add_ground(&mut scene, ground);
    }
    for warning in args.shadows.cast_choice().assign(&mut scene) {
        talk.warning(&warning);
    }

    if let Some(crease_rad) = args.shadows.crease_rad() {
        scene.split_smooth_parts(crease_rad);
        if let Some(pieces) = args.shadows.tessellate {
            tessellate(&mut scene.objects, crease_rad, pieces)?;
        }
    }
    let start = Instant::now();
    let mut casters = Caster::of_scene(&scene);
    times.topology = ms_since(start);
    let start = Instant::now();
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice { name: args.adapter.clone(), is_software: args.software }))?;
    let renderer = Renderer::new(gpu, args.samples);
    times.device = ms_since(start);
    let start = Instant::now();
    let bodies = args.shadows.crease_rad().map(|crease_rad| {
        let ground = ground.as_ref().map(|_| scene.objects.len() - 1);
        let bodies = smooth_bodies(&scene.objects, &mut casters, ground, crease_rad);
        bodies.tell(talk);
        bodies.bodies
    });
    let mut gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures)?;
    let moves = files.iter().any(|file| file.is_played) && bodies.is_none();
    gpu_scene.give_bodies(bodies.unwrap_or_default());
    let posing = args.posing.unwrap_or_else(|| best_posing(renderer.gpu(), moves));
    if posing == Posing::Gpu {
        let mut poser = GpuPoser::new(renderer.gpu(), &scene.objects, &casters, &gpu_scene)?;
        pollster::block_on(poser.pose(renderer.gpu(), &mut gpu_scene, &scene.objects, &mut casters))?;
    }
    times.upload = ms_since(start);
    if let Some(folder) = &args.cache {
        gpu_scene.give_finders(finders(&Cache::new(folder)?, &casters, args.shadows.options().silhouettes, talk));
    }
    let shadows = ShadowOptions { soft: soft > 0, ..args.shadows.options() };
    warn_of_cuts(&lights, (&scene.objects, &casters), &spheres, talk);
    let stage = Stage { renderer, gpu_scene, casters, spheres, camera, lights, shadows, look };

    let start = Instant::now();
    let mut picture = stage.picture()?;
    times.picture = ms_since(start);
    let has_ground = ground.is_some();
    let show =
        args.show.map(|mode| stage.show(mode, args.show_light.as_deref(), has_ground, &mut picture)).transpose()?;
    let size = camera.size_px();
    let mask = outputs.mask.is_some().then(|| stage.mask(&stage.lights[0])).transpose()?;
    let costs = args.shadows.counts_fragments.then(|| stage.costs()).transpose()?;
    let start = Instant::now();
    let (verified, wrong) = args.verify.then(|| verify(&stage, &scene, talk)).transpose()?.unzip();
    let wrong = wrong.flatten().filter(|_| outputs.errors.is_some());
    times.verify = if args.verify { ms_since(start) } else { 0.0 };

    let origin = scene.origin;
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        adapter: stage.renderer.gpu().label.clone(),
        models: files.iter().map(ModelReport::new).collect(),
        origin: origin.to_array(),
        ground: ground.as_ref().map(|g| GroundReport::new(g, origin)),
        spheres: stage.spheres.iter().map(|sphere| SphereReport::new(sphere, origin)).collect(),
        camera: CameraReport::new(&camera, origin),
        time: args.moment.time,
        animation: args.moment.animation.clone(),
        posing: posing.name(),
        samples: args.samples,
        method: Method::name(stage.shadows.method),
        silhouette: Silhouette::name(stage.shadows.silhouettes),
        left_out: LeftOut::new(&stage.shadows),
        show,
        lights: (stage.lights.iter().zip(&picture.lights))
            .enumerate()
            .map(|(i, (light, report))| {
                let costs = costs.as_ref().map(|costs| costs[i]);
                LightJson::new(light, report, costs, (&stage.casters, &stage.spheres), origin)
            })
            .collect(),
        passes: picture.passes.iter().map(Into::into).collect(),
        times_ms: times,
        verify: verified,
    };
    outputs.finish(&picture, mask.as_ref(), wrong.as_deref(), &report, size)?;

    if wrong.is_some() {
        talk.warning(&format!("wrong pixels are ringed in red in `{}`", errors_path(&args.picture_path()).display()));
    }
    talk.note(&summary(&stage, args));
    Ok(report.verify.is_none_or(|v| v.errors == 0))
}

impl Stage {
    fn picture(&self) -> anyhow::Result<Picture> {
        Ok(pollster::block_on(self.renderer.picture(&self.shot()))?)
    }

    fn mask(&self, light: &Light) -> anyhow::Result<Mask> {
        Ok(pollster::block_on(self.renderer.mask(&self.shot(), light))?)
    }

    /// Makes `picture` one that shows `mode`. The ground, if there is one, was added last.
    fn show(
        &self,
        mode: show::Mode,
        light: Option<&str>,
        has_ground: bool,
        picture: &mut Picture,
    ) -> anyhow::Result<ShowReport> {
        let subject = Subject {
            casters: &self.casters,
            scene: &self.gpu_scene,
            smooth: self.shadows.smooth,
            ground: self.casters.len().checked_sub(1).filter(|_| has_ground),
            camera: &self.camera,
            lights: &self.lights,
            reports: &picture.lights,
        };
        let show = Show::new(mode, subject, light)?;
        if let Some(overlay) = show.overlay() {
            let shot = Shot { overlay: Some(overlay), ..self.shot() };
            picture.rgba = pollster::block_on(self.renderer.picture(&shot))?.rgba;
        }
        let numbers = match mode {
            show::Mode::Counts => Numbers::Counts(self.counts(&show.lights())?),
            show::Mode::Fill => Numbers::Fill(self.fill(&show.lights())?),
            _ => Numbers::None,
        };
        Ok(show.finish(&mut picture.rgba, &numbers))
    }

    /// For each light what it costs, and what it would with nothing left out.
    fn costs(&self) -> anyhow::Result<Vec<[Cost; 2]>> {
        let everything = ShadowOptions::without_culling(self.shadows.method);
        let cost = |light: &Light, shadows: ShadowOptions| -> anyhow::Result<Cost> {
            let shot = Shot { shadows, ..self.shot() };
            let (fill, report) = pollster::block_on(self.renderer.fill(&shot, light))?;
            Ok(Cost::new(&report, Some(fill.iter().map(|&fragments| u64::from(fragments)).sum())))
        };
        self.lights.iter().map(|light| Ok([cost(light, self.shadows)?, cost(light, everything)?])).collect()
    }

    /// The stencil counts of the first of `lights`.
    fn counts(&self, lights: &[&Light]) -> anyhow::Result<Vec<i32>> {
        let Some(light) = lights.first() else { return Ok(self.for_each_pixel(0)) };
        Ok(pollster::block_on(self.renderer.counts(&self.shot(), light))?)
    }

    /// The fragments of all `lights` together.
    fn fill(&self, lights: &[&Light]) -> anyhow::Result<Vec<u32>> {
        let mut total = self.for_each_pixel(0);
        for light in lights {
            let (fill, _) = pollster::block_on(self.renderer.fill(&self.shot(), light))?;
            total.iter_mut().zip(fill).for_each(|(total, fragments)| *total += fragments);
        }
        Ok(total)
    }

    fn for_each_pixel<T: Clone>(&self, value: T) -> Vec<T> {
        let [width, height] = self.camera.size_px().map(|side| side as usize);
        vec![value; width * height]
    }

    fn shot(&self) -> Shot<'_> {
        Shot {
            scene: &self.gpu_scene,
            casters: &self.casters,
            spheres: &self.spheres,
            camera: &self.camera,
            lights: &self.lights,
            shadows: self.shadows,
            look: &self.look,
            overlay: None,
        }
    }
}

/// The files to write, made sure of before any work.
struct Outputs {
    picture: Output,
    mask: Option<Output>,
    /// Written only if `--verify` finds something.
    errors: Option<Output>,
    json: Json,
}

enum Json {
    None,
    StandardOutput,
    File(Output),
}

impl Outputs {
    fn create(args: &RenderArgs) -> anyhow::Result<Self> {
        let picture = Output::create_png(&args.picture_path())?;
        // Beside a device or a pipe is no place for a file.
        let shows_errors = args.verify && !picture.is_stream();
        let outputs = Self {
            picture,
            mask: args.mask.as_deref().map(Output::create_png).transpose()?,
            errors: shows_errors.then(|| Output::create(&errors_path(&args.picture_path()))).transpose()?,
            json: match args.json.as_deref() {
                None => Json::None,
                Some(path) if path == Path::new("-") => Json::StandardOutput,
                Some(path) => Json::File(Output::create(path)?),
            },
        };
        outputs.ensure_apart(&args.models)?;
        Ok(outputs)
    }

    /// No two outputs in one file, and no model overwritten.
    fn ensure_apart(&self, models: &[PathBuf]) -> anyhow::Result<()> {
        let json = if let Json::File(json) = &self.json { Some(json) } else { None };
        let all: Vec<(&str, &Output)> = [
            ("--output", Some(&self.picture)),
            ("--mask", self.mask.as_ref()),
            ("--json", json),
            ("the picture of --verify", self.errors.as_ref()),
        ]
        .into_iter()
        .filter_map(|(name, output)| Some((name, output?)))
        .collect();
        for (i, (name, output)) in all.iter().enumerate() {
            let path = output.path().display();
            if let Some((other, _)) = all[..i].iter().find(|(_, other)| output.is_same_file_as(other)) {
                bail!("{other} and {name} would both be written to `{path}`; give each a file of its own");
            }
            let is_model = models.iter().any(|model| output.is_file_at(model));
            ensure!(!is_model, "{name} would overwrite the model `{path}`; give another name");
        }
        Ok(())
    }

    /// Writes everything, or nothing.
    fn finish(
        self,
        picture: &Picture,
        mask: Option<&Mask>,
        wrong: Option<&[u8]>,
        report: &Report,
        size_px: [u32; 2],
    ) -> anyhow::Result<()> {
        let json = format!("{}\n", serde_json::to_string_pretty(report)?).into_bytes();
        let mut staged = Vec::new();
        let mut to_stdout = None;
        match self.json {
            Json::None => {}
            Json::StandardOutput => to_stdout = Some(json),
            Json::File(output) => staged.push(output.stage(json)?),
        }
        if let (Some(output), Some(mask)) = (self.mask, mask) {
            staged.push(output.stage(png(&mask.verdicts, size_px, L8)?)?);
        }
        if let (Some(output), Some(wrong)) = (self.errors, wrong) {
            staged.push(output.stage(png(wrong, size_px, Rgba8)?)?);
        }
        staged.push(self.picture.stage(png(&picture.rgba, size_px, Rgba8)?)?);
        if let Some(json) = to_stdout {
            write_to_stdout(&json)?;
        }
        staged.into_iter().try_for_each(Staged::publish)
    }
}

/// Draws each light's mask and compares it with rays; says the result, and returns it with a picture of the first light with errors.
fn verify(stage: &Stage, scene: &Scene, talk: &Talk) -> anyhow::Result<(VerifyJson, Option<Vec<u8>>)> {
    let oracle = Oracle::with_materials(&stage.casters, &scene.materials, &scene.textures).with_spheres(&stage.spheres);
    let [width, height] = stage.camera.size_px();
    let bar = talk.progress("casting rays", height.into());
    let judged = oracle.judge(&stage.camera, &stage.lights, || bar.inc(1));
    bar.finish_and_clear();

    let mut total = VerifyJson::default();
    let mut wrong = None;
    if stage.shadows.soft {
        talk.note("verify: rays to the middle of each light; how soft a shadow is, they don't tell");
    }
    for (light, judgements) in stage.lights.iter().zip(&judged) {
        let mask = stage.mask(light)?;
        let comparison = compare(&mask.verdicts, judgements);
        total.add(&light.name, &comparison);
        let Comparison { surface, decided, ref errors, .. } = comparison;
        talk.note(&format!(
            "verify {}: {} in {decided} decided of {surface} surface pixels",
            light.name,
            counted(errors.len(), "error")
        ));
        if !errors.is_empty() && wrong.is_none() {
            wrong = Some(error_picture(&mask.verdicts, judgements, errors, width as usize));
        }
    }
    Ok((total, wrong))
}

/// What finds the silhouettes of those of `casters` that cast, from `cache`; nothing where silhouettes are found elsewhere. What is there already
/// makes a tree worth it, so that is what is kept unless one says otherwise.
fn finders(cache: &Cache, casters: &[Caster], source: SilhouetteSource, talk: &Talk) -> Vec<Option<Finder>> {
    let kind = match source {
        SilhouetteSource::Auto => FinderKind::Dual,
        SilhouetteSource::Cpu(kind) => kind,
        SilhouetteSource::Gpu | SilhouetteSource::GpuBasic => return Vec::new(),
    };
    let finder = |caster: &Caster| caster.role.casts.then(|| cache.finder(caster, kind, talk));
    casters.iter().map(finder).collect()
}

/// Where `--verify` shows errors: `out-errors.png` for `out.png`.
fn errors_path(output: &Path) -> PathBuf {
    let mut name = output.file_stem().unwrap_or_default().to_owned();
    name.push("-errors.png");
    output.with_file_name(name)
}

fn view_choice(args: &RenderArgs) -> ViewChoice {
    ViewChoice {
        size_px: args.size,
        eye: args.eye,
        target: args.target,
        fov_deg: args.fov,
        camera_name: args.camera.clone(),
        spheres: Vec::new(),
    }
}

/// The balls of `--sphere` in a scene about `origin`.
fn spheres(args: &RenderArgs, origin: DVec3) -> Vec<Sphere> {
    let named = |(number, &(center, radius)): (usize, &(DVec3, f64))| Sphere {
        name: format!("sphere {}", number + 1),
        center: center - origin,
        radius,
        base_color: SPHERE_COLOR,
    };
    args.spheres.iter().enumerate().map(named).collect()
}

/// The lights as they are drawn: each lamp as many if it is to have a size.
fn with_sizes(lights: Vec<Light>, model: &Bounds, args: &RenderArgs, talk: &Talk) -> Vec<Light> {
    let Some(samples) = args.area_samples else { return lights };
    if lights.iter().all(|light| light.position.is_directional()) {
        talk.warning("--area-samples changes nothing: no light is a lamp");
    }
    as_points(lights, Area { samples, radius_m: args.area_radius }, model)
}

/// With normals, where something is to be smooth.
fn load_options(args: &RenderArgs) -> LoadOptions {
    LoadOptions { normals: args.shadows.crease_rad().is_some(), ..args.load.options() }
}

/// The GPU, where something moves and it can.
fn best_posing(gpu: &Gpu, moves: bool) -> Posing {
    if moves && umbrae_render::Posing::of(gpu) == umbrae_render::Posing::Gpu { Posing::Gpu } else { Posing::Cpu }
}

/// Each in quotation marks.
fn names(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| format!("`{}`", path.display())).collect::<Vec<_>>().join(", ")
}

fn summary(stage: &Stage, args: &RenderArgs) -> String {
    let triangles: usize = stage.casters.iter().map(|c| c.mesh.triangles().len()).sum();
    let soft = stage.lights.iter().filter(|light| light.extent != Extent::Point).count();
    let soft = if soft > 0 { format!(" ({soft} soft)") } else { String::new() };
    format!(
        "`{}`: {} in {}, {}{soft} on {}",
        args.picture_path().display(),
        counted(triangles, "triangle"),
        counted(stage.casters.len(), "object"),
        counted(stage.lights.len(), "light"),
        stage.renderer.gpu().label
    )
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
