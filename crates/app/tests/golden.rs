//! Pictures that someone looked at and found right, against pictures as they are drawn now.
//!
//! A case is a folder in `tests/golden`: `case.toml` says what is drawn and why, `expected.png` how it looks. Drawn in software,
//! so that every machine draws alike. A picture that differs, is missing or can't be drawn is a failure; so is a run without cases.
//!
//! `BLESS=name cargo test -p umbrae --test golden` (or `BLESS=all`) takes the picture as it is now for the right one, and still
//! fails: it is right when someone has looked at it, and never in CI.

#[path = "golden/case.rs"]
mod case;
#[path = "golden/comparison.rs"]
mod comparison;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail, ensure};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};
use libtest_mimic::{Arguments, Trial};

use case::Case;
use comparison::Comparison;

/// A golden picture is small, so that the history of the project stays small.
const MAX_PICTURE_BYTES: usize = 8 * 1024;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let folders = case_folders();
    let names: Vec<String> = folders.iter().map(|folder| name_of(folder)).collect();
    let bless = Bless::from_environment();

    let mut trials = comparison::trials();
    trials.push(trial("bless_is_refused_in_ci_and_asked_for_by_name", check_bless));
    trials.push(trial("there_are_cases_and_those_to_bless_are_among_them", {
        let (names, bless) = (names.clone(), bless.clone());
        move || check_names(&names, &bless)
    }));
    trials.extend(folders.into_iter().zip(names).map(|(folder, name)| {
        let bless = bless.clone();
        trial(&name.clone(), move || check(&folder, &name, &bless))
    }));
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trial(name: &str, check: impl FnOnce() -> anyhow::Result<()> + Send + 'static) -> Trial {
    Trial::test(name, move || check().map_err(|error| format!("{error:#}").into()))
}

/// The folders of all cases, in order.
fn case_folders() -> Vec<PathBuf> {
    let all = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let entries = fs::read_dir(all).into_iter().flatten().flatten();
    let mut folders: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    folders
}

fn name_of(folder: &Path) -> String {
    folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Whose pictures to take as they are now.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Bless {
    name: Option<String>,
    is_ci: bool,
}

impl Bless {
    fn from_environment() -> Self {
        let value = |variable| std::env::var(variable).ok().filter(|value| !value.is_empty());
        Self { name: value("BLESS"), is_ci: value("CI").is_some() }
    }

    /// Whether to write the picture of `case`.
    fn covers(&self, case: &str) -> anyhow::Result<bool> {
        let is_covered = self.name.as_deref().is_some_and(|name| name == "all" || name == case);
        ensure!(!(is_covered && self.is_ci), "CI does not bless pictures; bless where someone looks at them");
        Ok(is_covered)
    }
}

fn check_bless() -> anyhow::Result<()> {
    let of = |name: &str, is_ci| Bless { name: Some(name.to_owned()), is_ci };
    ensure!(of("a", false).covers("a")? && of("all", false).covers("a")?, "what was named is not blessed");
    ensure!(!of("a", false).covers("b")? && !Bless::default().covers("b")?, "something was blessed that was not named");
    ensure!(of("all", true).covers("a").is_err(), "CI blessed a picture");
    Ok(())
}

fn check_names(names: &[String], bless: &Bless) -> anyhow::Result<()> {
    ensure!(!names.is_empty(), "there is no case in tests/golden, so nothing was checked");
    if let Some(name) = bless.name.as_ref().filter(|name| *name != "all" && !names.contains(name)) {
        bail!("there is no case `{name}` to bless; there are: {}", names.join(", "));
    }
    Ok(())
}

/// Draws the case in `folder` and compares, or blesses.
fn check(folder: &Path, name: &str, bless: &Bless) -> anyhow::Result<()> {
    let text = fs::read_to_string(folder.join("case.toml")).context("the case has no case.toml that can be read")?;
    let case: Case = toml::from_str(&text).context("case.toml is not a case")?;
    let actual = case.draw()?;
    let expected_path = folder.join("expected.png");
    if bless.covers(name)? {
        let bytes = png(&actual)?;
        ensure!(
            bytes.len() <= MAX_PICTURE_BYTES,
            "the picture takes {} bytes of {MAX_PICTURE_BYTES}: make it smaller or simpler",
            bytes.len()
        );
        fs::write(&expected_path, bytes)?;
        bail!("blessed: look at {}, and run again without BLESS", shown(&expected_path));
    }

    let output = target_folder().join("golden").join(name);
    // What an earlier failure left would mislead.
    if output.is_dir() {
        fs::remove_dir_all(&output)?;
    }
    let command = format!("if this is right: BLESS={name} cargo test -p umbrae --test golden");
    let write = |file: &str, picture: &RgbImage| -> anyhow::Result<PathBuf> {
        fs::create_dir_all(&output)?;
        fs::write(output.join(file), png(picture)?)?;
        Ok(output.join(file))
    };
    if !expected_path.is_file() {
        let drawn = write("actual.png", &actual)?;
        bail!("{name}: the picture expected.png is missing\n  see {}\n  {command}", shown(&drawn));
    }
    let bytes = fs::read(&expected_path)?;
    ensure!(bytes.len() <= MAX_PICTURE_BYTES, "{} is {} bytes large", shown(&expected_path), bytes.len());
    let expected = image::load_from_memory(&bytes).context("expected.png is not a picture")?.to_rgb8();
    let comparison = Comparison::new(&expected, &actual, case.tolerance.channel);
    if comparison.is_within(case.tolerance.outliers) {
        return Ok(());
    }
    write("actual.png", &actual)?;
    let diff = write("diff.png", &comparison::side_by_side(&expected, &actual))?;
    bail!(
        "{name}: {}\n  why it matters: {}\n  see {}\n  {command}",
        comparison.text(case.tolerance.outliers),
        case.why,
        shown(&diff)
    )
}

/// As small as the encoder makes it.
fn png(picture: &RgbImage) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    encoder.write_image(picture, picture.width(), picture.height(), ExtendedColorType::Rgb8)?;
    Ok(bytes)
}

fn target_folder() -> &'static Path {
    let temporary = Path::new(env!("CARGO_TARGET_TMPDIR"));
    temporary.parent().unwrap_or(temporary)
}

/// `path` as seen from the project's folder.
fn shown(path: &Path) -> String {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap_or(Path::new(""));
    path.strip_prefix(project).unwrap_or(path).display().to_string()
}
