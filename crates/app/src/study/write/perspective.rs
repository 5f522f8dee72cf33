//! `perspective.png`: the models and their shadows at one moment, drawn with shadow volumes where there is a graphics adapter.

use std::io::Write as _;

use anyhow::Context as _;
use image::ExtendedColorType::Rgba8;
use umbrae_core::{Caster, Object, Scene};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Renderer, Shot};

use crate::lights::{LampChoice, LampPlace, lights};
use crate::output::png;
use crate::study::folder::Folder;
use crate::study::results::{Results, State};
use crate::study::site::on_clock;
use crate::view::{ViewChoice, add_ground, camera, ground_under};

const SIZE_PX: [u32; 2] = [1600, 900];
/// Samples of a pixel: shadow edges are smooth.
const SAMPLES: u32 = 4;

/// Draws the state at the step in the middle of those with sun, and gives back what to call the picture.
///
/// # Errors
///
/// When there is no adapter, or it can't draw the models: no reason not to have the rest.
pub(super) fn write(results: &Results, state: &State, folder: &mut Folder) -> anyhow::Result<Option<String>> {
    let days: Vec<usize> = (0..results.suns.len()).filter(|&step| results.suns[step].is_some()).collect();
    let Some((&step, sun)) = days.get(days.len() / 2).and_then(|step| Some((step, results.suns[*step]?))) else {
        return Ok(None);
    };
    let models = &results.models.scene;
    let objects: Vec<Object> = state.objects.iter().map(|&i| models.objects[i].clone()).collect();
    let mut scene = Scene { objects, cameras: Vec::new(), lights: Vec::new(), ..models.clone() };
    let bounds = scene.bounds();
    let ground = (!results.models.has_terrain()).then(|| ground_under(&bounds));
    let choice = ViewChoice { size_px: SIZE_PX, ..ViewChoice::default() };
    let camera = camera(&choice, &scene, &bounds, ground.as_ref())?;
    let azimuth_deg = sun.x.atan2(sun.y).to_degrees();
    let lamp =
        LampChoice::new(LampPlace::Sun { azimuth_deg, altitude_deg: sun.z.clamp(-1.0, 1.0).asin().to_degrees() });
    let lights = lights(&[lamp], &scene, &bounds);
    let look = Look::for_model(&bounds, &lights);
    if let Some(ground) = &ground {
        add_ground(&mut scene, ground);
    }
    let casters = Caster::of_scene(&scene);

    let gpu = pollster::block_on(Gpu::new(&AdapterChoice { name: None, is_software: false }))
        .context("there is no graphics adapter")?;
    let renderer = Renderer::new(gpu, SAMPLES);
    let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures)?;
    let shot = Shot { look: &look, ..Shot::new(&gpu_scene, &casters, &camera, &lights) };
    let picture = pollster::block_on(renderer.picture(&shot))?;
    let bytes = png(&picture.rgba, SIZE_PX, Rgba8)?;
    folder.write("perspective.png", |file| Ok(file.write_all(&bytes)?))?;
    let step = &results.timetable.steps[step];
    let time = on_clock(step.middle(), step.utc_offset_s).strftime("%-d %B %Y, %H:%M (UTC%:z)");
    Ok(Some(format!("Shadows on {time}, from the south-east")))
}
