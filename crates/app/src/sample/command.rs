//! `umbrae sample`: writes a built-in scene.

use anyhow::{Context as _, ensure};
use clap::ValueEnum as _;

use super::glb_bytes;
use crate::cli::SampleArgs;
use crate::output::Output;
use crate::talk::{Talk, counted};

/// Writes the scene that `args` name as GLB, and says what is in it.
///
/// # Errors
///
/// When the file's name does not end in `.glb`, since no one could read it back, the scene has no night, or the file can't be written.
pub fn run(args: &SampleArgs, talk: &Talk) -> anyhow::Result<()> {
    let path = args.output.display();
    let is_glb = args.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"));
    ensure!(is_glb, "can't write `{path}`: samples are GLB files; give a name that ends in .glb");
    let sample = if args.night {
        let name = args.name.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
        let no_night = || format!("the sample {name} has no street lamps; only `umbrae sample town --night` has");
        args.name.by_night().with_context(no_night)?
    } else {
        args.name
    };
    let output = Output::create(&args.output)?;
    let scene = sample.scene();
    output.finish(glb_bytes(&scene))?;
    let lights =
        if scene.lights.is_empty() { String::new() } else { format!(", {}", counted(scene.lights.len(), "light")) };
    let (triangles, objects) = (counted(scene.triangle_count(), "triangle"), counted(scene.objects.len(), "object"));
    talk.note(&format!("`{path}`: {triangles} in {objects}{lights}"));
    Ok(())
}
