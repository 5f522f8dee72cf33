//! Files into one scene.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use umbrae_core::Scene;
use umbrae_formats::{Format, LoadOptions, UpAxis, Warning, load};

use crate::cli::Up;
use crate::talk::Talk;

/// What is known about a file after its scene went into the whole.
#[derive(Debug, Clone)]
pub struct LoadedFile {
    /// As given.
    pub path: PathBuf,
    /// How it was read.
    pub format: Format,
    /// Its axis that is up.
    pub up: UpAxis,
    /// What was left out.
    pub warnings: Vec<Warning>,
}

/// Loads `paths` into one scene about the first one's origin, and says every warning.
///
/// # Errors
///
/// The first file that can't be loaded or joined, with the reason.
pub fn load_all(paths: &[PathBuf], up: Option<Up>, talk: &Talk) -> anyhow::Result<(Scene, Vec<LoadedFile>)> {
    let mut scene = Scene::default();
    let mut files = Vec::new();
    for path in paths {
        let model = load_one(path, up, talk)?;
        scene.add(model.scene).with_context(|| format!("can't join `{}` with the models before it", path.display()))?;
        files.push(LoadedFile { path: path.clone(), format: model.format, up: model.up, warnings: model.warnings });
    }
    Ok((scene, files))
}

/// Loads one file and says every warning.
///
/// # Errors
///
/// When the file can't be loaded, with the reason.
pub fn load_one(path: &Path, up: Option<Up>, talk: &Talk) -> anyhow::Result<umbrae_formats::Model> {
    let options = LoadOptions { up: up.map(Into::into) };
    let model = load(path, &options)?;
    for warning in &model.warnings {
        talk.warning(&format!("`{}`: {warning}", path.display()));
    }
    Ok(model)
}

/// The name of a format in reports.
pub fn format_name(format: Format) -> &'static str {
    match format {
        Format::Gltf => "gltf",
        Format::Obj => "obj",
        Format::Ply => "ply",
        Format::Stl => "stl",
    }
}
