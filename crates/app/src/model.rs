//! Files into one scene.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};
use umbrae_core::Scene;
use umbrae_formats::{Crs, Format, LoadOptions, Model, UpAxis, Warning, load};

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
    /// What its coordinates are in, where that is known.
    pub crs: Option<Crs>,
    /// What they were in, if that was something else.
    pub source_crs: Option<Crs>,
    /// What was left out.
    pub warnings: Vec<Warning>,
    /// Whether it is shown at a moment of an animation.
    pub is_played: bool,
}

/// A moment of the models' animations.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// From their beginning.
    pub time_s: f64,
    /// The one to play; what suits each model for `None`.
    pub animation: Option<String>,
}

/// Loads `paths` into one scene about the first one's origin, and in the coordinate reference system of the first that has one, as they are at `moment` (at rest for `None`), and says every warning.
///
/// # Errors
///
/// The first file that can't be loaded, played or joined, with the reason; or that none has the animation of that name.
pub fn load_all(
    paths: &[PathBuf],
    options: &LoadOptions,
    moment: Option<&Moment>,
    talk: &Talk,
) -> anyhow::Result<(Scene, Vec<LoadedFile>)> {
    let mut scene = Scene::default();
    let mut files = Vec::new();
    let (mut is_animated, mut names) = (false, Vec::new());
    let mut options = options.clone();
    for path in paths {
        let mut model = load(path, &options)?;
        options.into = options.into.or(model.crs.clone());
        let mut is_played = false;
        if let Some(moment) = moment {
            let cant = || format!("can't play `{}`", path.display());
            is_played = play(&mut model, moment).with_context(cant)?;
            is_animated |= is_played;
            names.extend(model.animations.iter().map(|animation| format!("`{}`", animation.name)));
        }
        scene.add(model.scene).with_context(|| format!("can't join `{}` with the models before it", path.display()))?;
        let Model { format, up, crs, source_crs, warnings, .. } = model;
        files.push(LoadedFile { path: path.clone(), format, up, crs, source_crs, warnings, is_played });
    }
    match moment {
        Some(Moment { animation: Some(name), .. }) if !is_animated => {
            ensure!(!names.is_empty(), "there is no animation `{name}`: no model has any; leave --animation out");
            bail!("there is no animation `{name}`; there are {}", names.join(", "));
        }
        Some(_) if !is_animated => talk.warning("--time changes nothing: no model has an animation"),
        _ => {}
    }
    // After all that can go wrong: an error is one sentence.
    for file in &files {
        say(&file.path, &file.warnings, talk);
    }
    Ok((scene, files))
}

/// Shows `model` at `moment`, and returns whether it has something to play. A model without an animation of that name stays at rest, for
/// another of the picture may have it.
fn play(model: &mut Model, moment: &Moment) -> anyhow::Result<bool> {
    let animation = moment.animation.as_deref();
    let is_played = model.animations.iter().any(|other| animation.is_none_or(|name| name == other.name));
    if is_played {
        model.play(animation, moment.time_s)?;
    }
    Ok(is_played)
}

/// Loads one file and says every warning.
///
/// # Errors
///
/// When the file can't be loaded, with the reason.
pub fn load_one(path: &Path, options: &LoadOptions, talk: &Talk) -> anyhow::Result<Model> {
    let model = load(path, options)?;
    say(path, &model.warnings, talk);
    Ok(model)
}

fn say(path: &Path, warnings: &[Warning], talk: &Talk) {
    for warning in warnings {
        talk.warning(&format!("`{}`: {warning}", path.display()));
    }
}

/// The name of a format in reports.
pub fn format_name(format: Format) -> &'static str {
    match format {
        Format::CityJson => "cityjson",
        Format::GeoJson => "geojson",
        Format::GeoTiff => "geotiff",
        Format::Gltf => "gltf",
        Format::Obj => "obj",
        Format::Ply => "ply",
        Format::Stl => "stl",
    }
}
