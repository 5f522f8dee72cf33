//! `umbrae sample`: writes a built-in scene.

use anyhow::ensure;

use super::glb_bytes;
use crate::cli::SampleArgs;
use crate::output::Output;
use crate::talk::{Talk, counted};

/// Writes the scene that `args` name as GLB, and says what is in it.
///
/// # Errors
///
/// When the file's name does not end in `.glb`, since no one could read it back, or the file can't be written.
pub fn run(args: &SampleArgs, talk: &Talk) -> anyhow::Result<()> {
    let path = args.output.display();
    let is_glb = args.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"));
    ensure!(is_glb, "can't write `{path}`: samples are GLB files; give a name that ends in .glb");
    let output = Output::create(&args.output)?;
    let scene = args.name.scene();
    output.finish(glb_bytes(&scene))?;
    let (triangles, objects) = (scene.triangle_count(), scene.objects.len());
    talk.note(&format!("`{path}`: {} in {}", counted(triangles, "triangle"), counted(objects, "object")));
    Ok(())
}
