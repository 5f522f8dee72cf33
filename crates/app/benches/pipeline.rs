//! How long each step takes from a file to a picture, and how much memory it needs.
//!
//! Prints the tables of `BENCHMARKS.md`. Each model is measured in a process of its own, so that its peak of memory is its own; a
//! model that is not there is skipped aloud. Times are medians, on the wall clock but for the passes, which the device times itself.

#![expect(clippy::print_stdout, reason = "the tables are what one runs this for")]

use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use anyhow::{Context as _, ensure};
use umbrae::lights::{LampChoice, LampPlace, lights, reaching};
use umbrae::sample::{Sample, glb_bytes};
use umbrae::view::{ViewChoice, add_ground, camera, ground_under};
use umbrae_core::{
    Camera, Caster, Chain, Counting, Light, Mesh, Object, Scene, ShadowVolume, Surface, Topology, Windings, silhouette,
};
use umbrae_formats::{LoadOptions, load};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Method, PassTime, Renderer, ShadowOptions, Shot};
use web_time::Instant;

const SIZE_PX: [u32; 2] = [1280, 720];
/// The afternoon sun of the program's default view.
const SUN_DEG: [f64; 2] = [238.0, 40.0];
/// Where the lamp is, from the model's middle, in its radii: outside, and above.
const LAMP_RADII: glam::DVec3 = glam::DVec3::new(1.3, -0.7, 1.9);
/// Of steps on the CPU; odd, so that the median is one of them.
const RUNS: usize = 21;
/// Of pictures; software needs about a second for some.
const PICTURES: usize = 5;
/// Of whole processes.
const PROCESSES: usize = 20;
/// Below these the program has to stay.
const INSPECT_BAR_MS: f64 = 50.0;
const DRAGON_BAR_MS: f64 = 150.0;

fn main() -> anyhow::Result<()> {
    // `cargo bench` adds `--bench`, and may add a filter: there is nothing to choose here, so both are ignored.
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(i) = arguments.iter().position(|argument| argument == "--measure") {
        return measure(Path::new(arguments.get(i + 1).context("--measure needs a file")?));
    }
    let folder = tempfile::tempdir()?;
    let high_rise = folder.path().join("high-rise.glb");
    fs::write(&high_rise, glb_bytes(&Sample::HighRise.scene()))?;
    for path in [&high_rise, &data("mesh/dragon_100k.ply")] {
        if is_there(path) {
            let status = Command::new(std::env::current_exe()?).arg("--measure").arg(path).status()?;
            ensure!(status.success(), "measuring {} failed", path.display());
        }
    }
    measure_bars()
}

/// A model of the data that lies beside the project.
fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name)
}

fn is_there(path: &Path) -> bool {
    let is_there = path.is_file();
    if !is_there {
        println!("\nskipped: there is no {}", name_of(path));
    }
    is_there
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The median time of `work`, in milliseconds; what it returns is dropped off the clock.
fn median_ms<T>(runs: usize, mut work: impl FnMut() -> T) -> f64 {
    median((0..runs).map(|_| once_ms(&mut work).0))
}

fn once_ms<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = black_box(work());
    (start.elapsed().as_secs_f64() * 1e3, result)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The most memory that this process has held so far; `None` where the system does not tell.
fn peak_mib() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()? / 1024.0)
}

/// Peaks of memory as the steps are first done.
#[derive(Default)]
struct Peaks(Vec<(&'static str, Option<f64>)>);

impl Peaks {
    fn after(&mut self, step: &'static str) {
        self.0.push((step, peak_mib()));
    }

    fn print(&self) {
        println!("\n| after | peak memory, MiB |\n|---|---:|");
        for (step, peak) in &self.0 {
            println!("| {step} | {} |", peak.map_or("unknown".to_owned(), |mib| format!("{mib:.0}")));
        }
    }
}

/// Prints the tables of one model.
fn measure(path: &Path) -> anyhow::Result<()> {
    let mut peaks = Peaks::default();
    peaks.after("the start of the process");
    let scene = load(path, &LoadOptions::default())?.scene;
    peaks.after("loading");
    let stage = Stage::new(scene)?;
    peaks.after("topology and casters");
    {
        let drawing = Drawing::new(&stage, 4)?;
        drawing.passes(&stage, Method::Auto, 1)?;
        peaks.after("a picture with 4 samples");
    }

    println!("\n### {}", name_of(path));
    let Stage { scene, casters, .. } = &stage;
    let edges: usize = casters.iter().map(|c| c.topology.edges().len()).sum();
    let megabytes = fs::metadata(path)?.len() as f64 / 1e6;
    println!(
        "\n{} triangles and {edges} edges in {} objects, the ground included; a file of {megabytes:.1} MB.",
        scene.triangle_count(),
        scene.objects.len()
    );
    println!("\n| step | ms |\n|---|---:|");
    println!("| load, from file to scene | {:.1} |", median_ms(RUNS, || load(path, &LoadOptions::default())));
    println!("| of which weld | {:.1} |", weld_ms(scene));
    println!("| topology | {:.1} |", median_ms(RUNS, || topologies(&scene.objects)));
    println!("| casters: positions in the scene | {:.1} |", casters_ms(&scene.objects));
    for light in &stage.lights {
        stage.print_volumes_of(light);
    }
    stage.print_passes()?;
    peaks.print();
    Ok(())
}

/// Welding what is welded already takes the same steps, on the same triangles.
fn weld_ms(scene: &Scene) -> f64 {
    median((0..RUNS).map(|_| {
        let surfaces: Vec<Surface> = meshes(&scene.objects)
            .map(|mesh| Surface {
                positions: mesh.positions().to_vec(),
                triangles: mesh.triangles().to_vec(),
                triangle_materials: mesh.triangle_materials().to_vec(),
                ..Surface::default()
            })
            .collect();
        once_ms(|| surfaces.into_iter().map(Mesh::new).collect::<Vec<_>>()).0
    }))
}

/// The meshes of `objects`; those in which every object has one of its own, as here.
fn meshes(objects: &[Object]) -> impl Iterator<Item = &Arc<Mesh>> {
    objects.iter().map(|object| &object.mesh)
}

fn topologies(objects: &[Object]) -> Vec<Arc<Topology>> {
    meshes(objects).map(|mesh| Arc::new(Topology::new(mesh))).collect()
}

fn casters_ms(objects: &[Object]) -> f64 {
    let topologies = topologies(objects);
    median_ms(RUNS, || {
        objects
            .iter()
            .zip(&topologies)
            .map(|(object, topology)| Caster::new(object, topology.clone()))
            .collect::<Vec<_>>()
    })
}

/// A model on its ground under a sun and a lamp, seen as `umbrae render` shows it by default.
struct Stage {
    scene: Scene,
    casters: Vec<Caster>,
    /// How often each caster winds around the eye.
    seen: Vec<Windings>,
    camera: Camera,
    lights: Vec<Light>,
    look: Look,
}

impl Stage {
    fn new(mut scene: Scene) -> anyhow::Result<Self> {
        let model = scene.bounds();
        let lamp = scene.origin + model.center() + LAMP_RADII * model.radius();
        let choice = ViewChoice { size_px: SIZE_PX, ..ViewChoice::default() };
        let [azimuth_deg, altitude_deg] = SUN_DEG;
        let lamps = [LampPlace::Sun { azimuth_deg, altitude_deg }, LampPlace::Point(lamp)].map(LampChoice::new);
        let ground = ground_under(&model);
        let camera = camera(&choice, &scene, &model, Some(&ground))?;
        let lights = lights(&lamps, &scene, &model);
        add_ground(&mut scene, &ground);
        let casters = Caster::of_scene(&scene);
        let seen = casters.iter().map(|caster| Windings::of_near_rectangle(caster, &camera)).collect();
        let look = Look::for_model(&model, &lights);
        let lights = reaching(lights, look.exposure);
        Ok(Self { scene, casters, seen, camera, lights, look })
    }

    /// Facing and chain, silhouette, volume.
    fn print_volumes_of(&self, light: &Light) {
        let chains = || -> Vec<Chain> {
            let of = |(caster, seen): (&Caster, &Windings)| {
                let counting = Counting::choose(caster, seen, &Windings::of_light(caster, light.position));
                Chain::new(caster, light.position, &counting)
            };
            self.casters.iter().zip(&self.seen).map(of).collect()
        };
        let found = chains();
        let casters = || self.casters.iter().zip(&found);
        let silhouettes = || casters().map(|(caster, chain)| silhouette(&caster.topology, chain)).collect::<Vec<_>>();
        let volumes = || casters().map(|(caster, chain)| ShadowVolume::new(caster, chain)).collect::<Vec<_>>();
        let edges: usize = silhouettes().iter().map(Vec::len).sum();
        let Light { name, .. } = light;
        println!("| {name}: which triangles cast | {:.2} |", median_ms(RUNS, chains));
        println!("| {name}: silhouette ({edges} edges) | {:.2} |", median_ms(RUNS, silhouettes));
        println!("| {name}: volume, silhouette included | {:.2} |", median_ms(RUNS, volumes));
    }

    /// What the GPU takes, with 4 samples a pixel and with 1, for each method.
    fn print_passes(&self) -> anyhow::Result<()> {
        let mut columns = Vec::new();
        let mut label = String::new();
        for samples in [4, 1] {
            let drawing = Drawing::new(self, samples)?;
            label.clone_from(&drawing.renderer.gpu().label);
            for (method, name) in [(Method::Auto, "auto"), (Method::ZFail, "zfail")] {
                let passes = drawing.passes(self, method, PICTURES)?;
                let samples = if samples == 1 { "1 sample".to_owned() } else { format!("{samples} samples") };
                columns.push((format!("{samples}, {name}"), drawing.upload_ms, passes));
            }
        }
        println!("\n{}x{} pixels on {label}, ms:\n", SIZE_PX[0], SIZE_PX[1]);
        let row = |first: &str, cell: &dyn Fn(&(String, f64, Passes)) -> String| {
            println!("| {first} | {} |", columns.iter().map(cell).collect::<Vec<_>>().join(" | "));
        };
        row("pass", &|(name, ..)| name.clone());
        println!("|---|{}", "---:|".repeat(columns.len()));
        for i in 0..columns[0].2.gpu.len() {
            row(&columns[0].2.gpu[i].name, &|(_, _, passes)| format!("{:.1}", passes.gpu[i].ms));
        }
        row("all passes", &|(_, _, passes)| format!("{:.1}", passes.gpu.iter().map(|pass| pass.ms).sum::<f64>()));
        row("volumes on the CPU, both lights", &|(_, _, passes)| format!("{:.1}", passes.cpu_ms));
        row("picture in all, read back", &|(_, _, passes)| format!("{:.1}", passes.all_ms));
        row("upload of the scene", &|(_, upload_ms, _)| format!("{upload_ms:.1}"));
        let cases = &columns[0].2.cases;
        println!("\nz-fail was needed (auto) for {} of {} casters and lights.", cases[1], cases[0] + cases[1]);
        Ok(())
    }
}

/// A device with the scene on it.
struct Drawing {
    renderer: Renderer,
    scene: GpuScene,
    upload_ms: f64,
}

/// Medians over some pictures.
struct Passes {
    gpu: Vec<PassTime>,
    cpu_ms: f64,
    all_ms: f64,
    /// Casters by z-pass and by z-fail, over all lights.
    cases: [usize; 2],
}

impl Drawing {
    fn new(stage: &Stage, samples: u32) -> anyhow::Result<Self> {
        let renderer = Renderer::new(pollster::block_on(Gpu::new(&AdapterChoice::default()))?, samples);
        let (upload_ms, scene) =
            once_ms(|| GpuScene::new(renderer.gpu(), &stage.casters, &stage.scene.materials, &stage.scene.textures));
        Ok(Self { renderer, scene: scene?, upload_ms })
    }

    fn passes(&self, stage: &Stage, method: Method, pictures: usize) -> anyhow::Result<Passes> {
        let Stage { casters, camera, lights, look, .. } = stage;
        let shadows = ShadowOptions::from(method);
        let shot = Shot { scene: &self.scene, casters, camera, lights, shadows, look, overlay: None, spheres: &[] };
        let draw = || pollster::block_on(self.renderer.picture(&shot));
        // The first one compiles shaders.
        let mut runs = vec![once_ms(draw)];
        if pictures > 1 {
            runs = (0..pictures).map(|_| once_ms(draw)).collect();
        }
        let all_ms = median(runs.iter().map(|run| run.0));
        let pictures = runs.into_iter().map(|run| run.1).collect::<Result<Vec<_>, _>>()?;
        let gpu = pictures[0].passes.iter().enumerate().map(|(i, pass)| PassTime {
            name: pass.name.clone(),
            ms: median(pictures.iter().map(|picture| picture.passes[i].ms)),
        });
        let reports = || pictures[0].lights.iter().flat_map(|light| &light.casters);
        let zpass = reports().filter(|report| report.case() == Some(umbrae_core::Case::Pass)).count();
        Ok(Passes {
            gpu: gpu.collect(),
            cpu_ms: median(pictures.iter().map(|picture| picture.lights.iter().map(|light| light.cpu_ms).sum())),
            all_ms,
            cases: [zpass, reports().count() - zpass],
        })
    }
}

/// Prints what has a bar to stay under.
fn measure_bars() -> anyhow::Result<()> {
    println!("\n### What has to be fast\n");
    println!("| task | ms | bar |\n|---|---:|---:|");
    let small = data("gltf/Box.glb");
    if is_there(&small) {
        println!(
            "| `umbrae inspect` of 12 triangles, the whole process | {:.1} | {INSPECT_BAR_MS} |",
            inspect_ms(&small)?
        );
    }
    let dragon = data("mesh/dragon_100k.ply");
    if is_there(&dragon) {
        let ms =
            median_ms(RUNS, || load(&dragon, &LoadOptions::default()).map(|model| topologies(&model.scene.objects)));
        println!("| load dragon_100k.ply and find its topology | {ms:.1} | {DRAGON_BAR_MS} |");
        println!("| `umbrae inspect` of dragon_100k.ply, the whole process | {:.1} | |", inspect_ms(&dragon)?);
    }
    Ok(())
}

/// The time from starting the program to its end.
fn inspect_ms(path: &Path) -> anyhow::Result<f64> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbrae"));
    command.arg("inspect").arg(path).stdout(Stdio::null());
    let mut times = Vec::new();
    for _ in 0..PROCESSES {
        let (ms, status) = once_ms(|| command.status());
        ensure!(status?.success(), "umbrae inspect {} failed", path.display());
        times.push(ms);
    }
    Ok(median(times.into_iter()))
}
