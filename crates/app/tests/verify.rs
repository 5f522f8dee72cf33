//! Every real model and built-in scene, under five lights or its own, from three cameras, by three methods, and by two with silhouettes from the GPU: no decided
//! pixel is wrong, and leaving something out that can't change a pixel changes none, decided or not.
//!
//! Prints a table. `UMBRAE_VERIFY=dragon` takes only what has "dragon" in its name. Of the rules of culling, one is
//! switched off for each light and camera, another each time; `UMBRAE_VERIFY_RULES=every` switches off each of them
//! each time. So it is with the ways to find silhouettes: one for each light and camera, or with
//! `UMBRAE_VERIFY_SILHOUETTES=every` all of them.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod data;
#[path = "verify/subjects.rs"]
mod subjects;

use std::path::Path;

use umbrae::output::png;
use umbrae::verify::error_picture;
use umbrae_core::{Camera, FinderKind, Judgement, Light, Oracle};
use umbrae_render::{
    AdapterChoice, Gpu, GpuScene, Mask, Method, Renderer, ShadowOptions, Shot, SilhouetteSource, compare,
};

use self::subjects::{Source, Subject, sources};

const SIZE_PX: [u32; 2] = [240, 180];
/// Of the surface pixels of the median model.
const LEAST_DECIDED: f64 = 0.95;

/// Ways to find silhouettes, besides the one that is chosen if nobody says: on the GPU for both ways of counting, and each of the CPU's.
fn all_finders() -> Vec<(String, ShadowOptions)> {
    let on_gpu = [SilhouetteSource::Gpu, SilhouetteSource::GpuBasic];
    let by = |silhouettes, method: Method| ShadowOptions { silhouettes, ..method.into() };
    let of_gpu = on_gpu.into_iter().flat_map(|source| [by(source, Method::Auto), by(source, Method::ZFail)]);
    let of_cpu = FinderKind::ALL.map(|kind| by(SilhouetteSource::Cpu(kind), Method::Auto));
    let named = |options: ShadowOptions| (format!("{:?}, {:?}", options.silhouettes, options.method), options);
    of_gpu.chain(of_cpu).map(named).collect()
}

/// One subject's line in the table.
#[derive(Default)]
struct Line {
    name: String,
    triangles: usize,
    surface: usize,
    decided: usize,
    /// Masks in which some caster was counted by z-fail because it had to be.
    needed_zfail: usize,
    /// Masks that were compared with rays.
    masks: usize,
    /// Masks with a rule off that were compared with those with all rules on.
    rules: usize,
    /// Wrong pixels, and pixels that a rule changed.
    wrong: usize,
    /// A sentence for each mask with such pixels.
    errors: Vec<String>,
}

impl Line {
    fn decided_share(&self) -> f64 {
        self.decided as f64 / self.surface.max(1) as f64
    }

    /// Under the table's head.
    fn row(&self) -> String {
        format!(
            "{:<38} {:>9} {:>9} {:>7.2}% {:>7} {:>7} {:>7} {:>7}",
            self.name,
            self.triangles,
            self.surface,
            100.0 * self.decided_share(),
            self.needed_zfail,
            self.masks,
            self.rules,
            self.wrong
        )
    }
}

#[test]
fn every_decided_pixel_of_every_model_is_right() {
    let Some(mut sources) = sources() else { return };
    let wanted = std::env::var("UMBRAE_VERIFY").ok().filter(|name| name != "all");
    sources.retain(|source| wanted.as_ref().is_none_or(|wanted| source.name.contains(wanted)));
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("a graphics driver; scripts/setup.sh installs one");
    println!("{}, {}x{}, one sample", gpu.label, SIZE_PX[0], SIZE_PX[1]);
    let renderer = Renderer::new(gpu, 1);

    println!(
        "{:<38} {:>9} {:>9} {:>8} {:>7} {:>7} {:>7} {:>7}",
        "model", "triangles", "surface", "decided", "z-fail", "masks", "rules", "errors"
    );
    let mut lines = Vec::new();
    for source in &sources {
        let line = verify(&renderer, source);
        println!("{}", line.row());
        lines.push(line);
    }
    let total = |f: fn(&Line) -> usize| lines.iter().map(f).sum::<usize>();
    let errors: Vec<&String> = lines.iter().flat_map(|l| &l.errors).collect();
    let mut shares: Vec<f64> = lines.iter().map(Line::decided_share).collect();
    shares.sort_by(f64::total_cmp);
    let median = shares[shares.len() / 2];
    println!(
        "{} models, {} masks, {} surface pixels, {} decided (median model {:.2} %), {} masks needed z-fail, {} masks with a rule off, {} errors",
        lines.len(),
        total(|l| l.masks),
        total(|l| l.surface),
        total(|l| l.decided),
        100.0 * median,
        total(|l| l.needed_zfail),
        total(|l| l.rules),
        total(|l| l.wrong)
    );
    assert!(errors.is_empty(), "{errors:#?}");
    assert!(median >= LEAST_DECIDED, "the median model is decided at {median}");
    assert!(
        wanted.is_some() || total(|l| l.needed_zfail) > lines.len() / 2,
        "z-fail was hardly needed: the cameras are not where they should be"
    );
}

fn verify(renderer: &Renderer, source: &Source) -> Line {
    let subject = source.subject(SIZE_PX);
    let Subject { scene, casters, .. } = &subject;
    let mut line = Line { name: source.name.clone(), triangles: subject.triangles, ..Line::default() };
    let gpu_scene = GpuScene::new(renderer.gpu(), casters, &scene.materials, &scene.textures).unwrap();
    let oracle = Oracle::with_materials(casters, &scene.materials, &scene.textures);
    let rules: Vec<_> = ShadowOptions::default().each_rule_off().map(|(name, rule)| (name.to_owned(), rule)).collect();
    let mut rules_off = InTurn::new(&rules, "UMBRAE_VERIFY_RULES");
    let all = all_finders();
    let mut finders = InTurn::new(&all, "UMBRAE_VERIFY_SILHOUETTES");
    for (which, camera) in subject.cameras.iter().enumerate() {
        let judged = oracle.judge(camera, &subject.lights, || ());
        for (light, judgements) in subject.lights.iter().zip(&judged) {
            let draw = |shadows| mask(renderer, &gpu_scene, &subject, camera, light, shadows);
            let place = format!("{}, camera {which}, {}", source.name, light.name);
            let auto = draw(ShadowOptions::from(Method::Auto));
            line.needed_zfail +=
                usize::from(auto.light.casters.iter().any(|c| c.case().is_some_and(|case| case.number() > 1)));
            line.compare(&auto, judgements, &format!("{place}, auto"));
            for (name, method) in [("z-fail", Method::ZFail), ("eye count", Method::EyeCount)] {
                line.compare(&draw(ShadowOptions::from(method)), judgements, &format!("{place}, {name}"));
            }
            for (name, shadows) in finders.next() {
                line.compare(&draw(shadows), judgements, &format!("{place}, silhouettes by {name}"));
            }
            for (rule, shadows) in rules_off.next() {
                line.compare_rule(&auto, &draw(shadows), judgements, &format!("{place}, {rule}"));
            }
        }
    }
    line
}

fn mask(
    renderer: &Renderer,
    gpu_scene: &GpuScene,
    subject: &Subject,
    camera: &Camera,
    light: &Light,
    shadows: ShadowOptions,
) -> Mask {
    let shot = Shot { shadows, ..Shot::new(gpu_scene, &subject.casters, camera, &[]) };
    pollster::block_on(renderer.mask(&shot, light)).unwrap()
}

/// Goes through options, one for each mask.
struct InTurn<'a> {
    all: &'a [(String, ShadowOptions)],
    is_every: bool,
    next: usize,
}

impl<'a> InTurn<'a> {
    /// Through `all`; every one each time if the environment's `variable` is `every`.
    fn new(all: &'a [(String, ShadowOptions)], variable: &str) -> Self {
        Self { all, is_every: std::env::var(variable).is_ok_and(|which| which == "every"), next: 0 }
    }

    /// What to draw for the next light and camera.
    fn next(&mut self) -> impl Iterator<Item = (&'a str, ShadowOptions)> {
        let start = self.next % self.all.len();
        self.next += 1;
        let chosen = if self.is_every { self.all } else { &self.all[start..=start] };
        chosen.iter().map(|(name, options)| (name.as_str(), *options))
    }
}

impl Line {
    fn compare(&mut self, mask: &Mask, judgements: &[Judgement], what: &str) {
        let comparison = compare(&mask.verdicts, judgements);
        self.masks += 1;
        self.surface += comparison.surface;
        self.decided += comparison.decided;
        self.add_errors(&mask.verdicts, judgements, &comparison.errors, &format!("{what}: wrong pixels"));
    }

    fn compare_rule(&mut self, all_on: &Mask, one_off: &Mask, judgements: &[Judgement], what: &str) {
        let pixels = all_on.verdicts.iter().zip(&one_off.verdicts).enumerate();
        let changed: Vec<usize> = pixels.filter(|(_, (on, off))| on != off).map(|(pixel, _)| pixel).collect();
        self.rules += 1;
        self.add_errors(&one_off.verdicts, judgements, &changed, &format!("{what}: pixels changed"));
    }

    /// Keeps a sentence, and writes a picture under the target folder's `tmp/verify/`, if there are any errors.
    fn add_errors(&mut self, mask: &[u8], judgements: &[Judgement], errors: &[usize], what: &str) {
        let Some(first) = errors.first() else { return };
        let (x, y) = (first % SIZE_PX[0] as usize, first / SIZE_PX[0] as usize);
        self.wrong += errors.len();
        self.errors.push(format!("{what}: {}, the first at {x},{y}", errors.len()));
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("verify");
        std::fs::create_dir_all(&folder).unwrap();
        let file = format!("{} {}.png", self.name.replace('/', " "), self.errors.len());
        let rgba = error_picture(mask, judgements, errors, SIZE_PX[0] as usize);
        std::fs::write(folder.join(file), png(&rgba, SIZE_PX, image::ExtendedColorType::Rgba8).unwrap()).unwrap();
    }
}
