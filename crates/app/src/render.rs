//! `umbrae render`: models into a picture, its mask, its report and its proof.

use std::path::{Path, PathBuf};

use image::ExtendedColorType::{L8, Rgba8};
use umbrae_core::{Camera, Caster, Judgement, Light, LightPosition, Oracle};
use umbrae_render::{AdapterChoice, Comparison, Gpu, GpuScene, Look, Mask, Picture, Renderer, compare};
use web_time::Instant;

use crate::cli::{Method, RenderArgs};
use crate::model::load_all;
use crate::output::{Output, png};
use crate::report::{CameraReport, GroundReport, LightJson, ModelReport, Report, Times, VerifyJson};
use crate::talk::Talk;
use crate::verify::error_picture;
use crate::view::{ViewChoice, add_ground, camera, ground_under, lights};

/// Everything a picture is made of, ready to draw.
struct Stage {
    renderer: Renderer,
    gpu_scene: GpuScene,
    casters: Vec<Caster>,
    camera: Camera,
    lights: Vec<Light>,
    method: umbrae_render::Method,
    look: Look,
}

/// Draws, writes what was asked for, and returns whether the verification (if any) found no error.
///
/// # Errors
///
/// Whatever is wrong with the input, the output's place or the device; then nothing is written.
pub fn run(args: &RenderArgs, talk: &Talk) -> anyhow::Result<bool> {
    let outputs = Outputs::create(args)?;
    let mut times = Times::default();

    let start = Instant::now();
    let (mut scene, files) = load_all(&args.models, args.up, talk)?;
    times.load = ms_since(start);
    let model = scene.bounds();
    let choice = view_choice(args);
    let ground = (!args.no_ground).then(|| ground_under(&model));
    let camera = camera(&choice, &scene, &model, ground.as_ref())?;
    let lights = lights(&choice, &scene, &model);
    if let Some(ground) = &ground {
        add_ground(&mut scene, ground);
    }
    warn_of_darkness(&lights, talk);

    let start = Instant::now();
    let casters = Caster::of_scene(&scene);
    times.topology = ms_since(start);
    let start = Instant::now();
    let samples: u32 = args.samples.parse().expect("the command line allows 1 and 4");
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice { name: args.adapter.clone(), is_software: args.software }))?;
    let renderer = Renderer::new(gpu, samples);
    times.device = ms_since(start);
    let start = Instant::now();
    let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials)?;
    times.upload = ms_since(start);
    let look = Look::for_model(&model, &lights);
    let stage = Stage { renderer, gpu_scene, casters, camera, lights, method: args.method.into(), look };

    let start = Instant::now();
    let picture = stage.picture()?;
    times.picture = ms_since(start);
    let size = camera.size_px();
    let mask = outputs.mask.is_some().then(|| stage.mask(&stage.lights[0])).transpose()?;
    let start = Instant::now();
    let verified = args.verify.then(|| verify(&stage, &args.output, talk)).transpose()?;
    times.verify = if args.verify { ms_since(start) } else { 0.0 };

    let origin = scene.origin;
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        adapter: stage.renderer.gpu().label.clone(),
        models: files.iter().map(ModelReport::new).collect(),
        origin: origin.to_array(),
        ground: ground.as_ref().map(|g| GroundReport::new(g, origin)),
        camera: CameraReport::new(&camera, origin),
        samples,
        method: method_name(args.method),
        lights: (stage.lights.iter().zip(&picture.lights))
            .map(|(light, report)| LightJson::new(light, report, &stage.casters, origin))
            .collect(),
        passes: picture.passes.iter().map(Into::into).collect(),
        times_ms: times,
        verify: verified,
    };
    outputs.finish(&picture, mask.as_ref(), &report, size)?;

    talk.note(&summary(&stage, args));
    Ok(report.verify.is_none_or(|v| v.errors == 0))
}

impl Stage {
    fn picture(&self) -> anyhow::Result<Picture> {
        let drawn =
            self.renderer.picture(&self.gpu_scene, &self.casters, &self.camera, &self.lights, self.method, &self.look);
        Ok(pollster::block_on(drawn)?)
    }

    fn mask(&self, light: &Light) -> anyhow::Result<Mask> {
        let drawn = self.renderer.mask(&self.gpu_scene, &self.casters, &self.camera, light, self.method);
        Ok(pollster::block_on(drawn)?)
    }
}

/// The files to write, made sure of before any work.
struct Outputs {
    picture: Output,
    mask: Option<Output>,
    json: Json,
}

enum Json {
    None,
    StandardOutput,
    File(Output),
}

impl Outputs {
    fn create(args: &RenderArgs) -> anyhow::Result<Self> {
        Ok(Self {
            picture: Output::create(&args.output)?,
            mask: args.mask.as_deref().map(Output::create).transpose()?,
            json: match args.json.as_deref() {
                None => Json::None,
                Some(path) if path == Path::new("-") => Json::StandardOutput,
                Some(path) => Json::File(Output::create(path)?),
            },
        })
    }

    fn finish(self, picture: &Picture, mask: Option<&Mask>, report: &Report, size_px: [u32; 2]) -> anyhow::Result<()> {
        self.picture.finish(&png(&picture.rgba, size_px, Rgba8)?)?;
        if let (Some(output), Some(mask)) = (self.mask, mask) {
            output.finish(&png(&mask.verdicts, size_px, L8)?)?;
        }
        let json = format!("{}\n", serde_json::to_string_pretty(report)?);
        match self.json {
            Json::None => Ok(()),
            Json::StandardOutput => Ok(std::io::Write::write_all(&mut std::io::stdout(), json.as_bytes())?),
            Json::File(output) => output.finish(json.as_bytes()),
        }
    }
}

/// Draws each light's mask and compares it with rays; says the result, and writes a picture of the first light with errors.
fn verify(stage: &Stage, output: &Path, talk: &Talk) -> anyhow::Result<VerifyJson> {
    let oracle = Oracle::new(&stage.casters);
    let [width, height] = stage.camera.size_px();
    let bar = talk.progress("casting rays", height.into());
    let positions: Vec<LightPosition> = stage.lights.iter().map(|l| l.position).collect();
    let judged = oracle.judge(&stage.camera, &positions, || bar.inc(1));
    bar.finish_and_clear();

    let mut total = VerifyJson::default();
    let mut first_wrong: Option<(Mask, &[Judgement], Comparison)> = None;
    for (light, judgements) in stage.lights.iter().zip(&judged) {
        let mask = stage.mask(light)?;
        let comparison = compare(&mask.verdicts, judgements);
        total.add(&light.name, &comparison);
        let Comparison { surface, decided, ref errors, .. } = comparison;
        talk.note(&format!(
            "verify {}: {} errors in {decided} decided of {surface} surface pixels",
            light.name,
            errors.len()
        ));
        if !errors.is_empty() && first_wrong.is_none() {
            first_wrong = Some((mask, judgements, comparison));
        }
    }
    if let Some((mask, judgements, comparison)) = first_wrong {
        let path = beside(output, "-errors.png");
        let rgba = error_picture(&mask.verdicts, judgements, &comparison.errors, width as usize);
        Output::create(&path)?.finish(&png(&rgba, [width, height], Rgba8)?)?;
        talk.warning(&format!("wrong pixels are ringed in red in `{}`", path.display()));
    }
    Ok(total)
}

/// `out.png` and `-errors.png` into `out-errors.png`.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

fn view_choice(args: &RenderArgs) -> ViewChoice {
    ViewChoice {
        size_px: args.size,
        eye: args.eye,
        target: args.target,
        fov_deg: args.fov,
        camera_name: args.camera.clone(),
        sun_deg: args.sun,
        points: args.point.clone(),
    }
}

fn warn_of_darkness(lights: &[Light], talk: &Talk) {
    for light in lights {
        let l = light.position.homogeneous();
        if light.position.is_directional() && l.z <= 0.0 {
            talk.warning(&format!("the {} is below the horizon: level ground is dark", light.name));
        }
    }
}

fn summary(stage: &Stage, args: &RenderArgs) -> String {
    let triangles: usize = stage.casters.iter().map(|c| c.mesh.triangles().len()).sum();
    format!(
        "`{}`: {triangles} triangles in {} objects, {} on {}",
        args.output.display(),
        stage.casters.len(),
        if stage.lights.len() == 1 { "1 light".to_owned() } else { format!("{} lights", stage.lights.len()) },
        stage.renderer.gpu().label
    )
}

fn method_name(method: Method) -> &'static str {
    match method {
        Method::Auto => "auto",
        Method::Zpass => "zpass",
        Method::Zfail => "zfail",
    }
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
