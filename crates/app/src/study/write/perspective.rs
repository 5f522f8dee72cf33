//! `perspective.png` and `perspective_profile.png`: the models and their shadows at one moment, and over the whole period, drawn with shadow volumes
//! where there is a graphics adapter.
//!
//! The profile is the picture under the suns of all steps at once: the more of them reach a place, the brighter it is. (J. Wallner, "Geometry of real-time
//! shadows", 2007, figures 5 to 7.)

use std::io::Write as _;

use anyhow::Context as _;
use glam::DVec3;
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

/// More suns than so many take long to draw without a graphics card, about a second each for a town; then they are those of steps in even distances.
const MOST_SUNS: usize = 8;
/// Each sun lights level ground alike, however low it is, but not one lower than this sine of its altitude: walls would be white.
const LOW_SUN: f64 = 0.25;

/// A picture that was written.
#[derive(Debug)]
pub(super) struct Perspective {
    /// The name of its file.
    pub(super) file: &'static str,
    /// What it shows.
    pub(super) caption: String,
}

/// Draws the state at the step in the middle of those with sun, and under the suns of all.
///
/// # Errors
///
/// When there is no adapter, or it can't draw the models: no reason not to have the rest.
pub(super) fn write(results: &Results, state: &State, folder: &mut Folder) -> anyhow::Result<Vec<Perspective>> {
    let days: Vec<usize> = (0..results.suns.len()).filter(|&step| results.suns[step].is_some()).collect();
    let Some(&middle) = days.get(days.len() / 2) else { return Ok(Vec::new()) };
    let models = &results.models.scene;
    let objects: Vec<Object> = state.objects.iter().map(|&i| models.objects[i].clone()).collect();
    let mut scene = Scene { objects, cameras: Vec::new(), lights: Vec::new(), ..models.clone() };
    let bounds = scene.bounds();
    let ground = (!results.models.has_terrain()).then(|| ground_under(&bounds));
    let choice = ViewChoice { size_px: SIZE_PX, ..ViewChoice::default() };
    let camera = camera(&choice, &scene, &bounds, ground.as_ref())?;
    if let Some(ground) = &ground {
        add_ground(&mut scene, ground);
    }
    let casters = Caster::of_scene(&scene);
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice { name: None, is_software: false }))
        .context("there is no graphics adapter")?;
    let renderer = Renderer::new(gpu, SAMPLES);
    let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures)?;

    let mut draw = |file: &'static str, steps: &[usize]| -> anyhow::Result<()> {
        let suns: Vec<DVec3> = steps.iter().filter_map(|&step| results.suns[step]).collect();
        let lights = lights(&suns.iter().map(|&sun| lamp(sun, suns.len())).collect::<Vec<_>>(), &scene, &bounds);
        let look = Look::for_model(&bounds, &lights);
        let shot = Shot { look: &look, ..Shot::new(&gpu_scene, &casters, &camera, &lights) };
        let picture = pollster::block_on(renderer.picture(&shot))?;
        let bytes = png(&picture.rgba, SIZE_PX, Rgba8)?;
        folder.write(file, |file| Ok(file.write_all(&bytes)?))
    };
    let step = &results.timetable.steps[middle];
    let time = on_clock(step.middle(), step.utc_offset_s).strftime("%-d %B %Y, %H:%M (UTC%:z)");
    draw("perspective.png", &[middle])?;
    let mut pictures =
        vec![Perspective { file: "perspective.png", caption: format!("Shadows on {time}, from the south-east") }];
    let shown = evenly(&days, MOST_SUNS);
    if shown.len() > 1 {
        draw("perspective_profile.png", &shown)?;
        let which = if shown.len() == days.len() { String::new() } else { format!("{} of the ", shown.len()) };
        pictures.push(Perspective {
            file: "perspective_profile.png",
            caption: format!(
                "Shadow profile: under the suns of {which}{} steps at once; the darker the ground, the longer it is in shadow",
                days.len()
            ),
        });
    }
    Ok(pictures)
}

/// One of `count` suns that together light level ground as one does at the zenith.
fn lamp(to_sun: DVec3, count: usize) -> LampChoice {
    let azimuth_deg = to_sun.x.atan2(to_sun.y).to_degrees();
    let altitude_deg = to_sun.z.clamp(-1.0, 1.0).asin().to_degrees();
    let lamp = LampChoice::new(LampPlace::Sun { azimuth_deg, altitude_deg });
    if count == 1 {
        return lamp;
    }
    LampChoice { intensity: Some((1.0 / (count as f64 * to_sun.z.max(LOW_SUN))) as f32), ..lamp }
}

/// At most `most` of `steps`, in even distances.
fn evenly(steps: &[usize], most: usize) -> Vec<usize> {
    let count = steps.len().min(most);
    (0..count).map(|i| steps[(2 * i + 1) * steps.len() / (2 * count)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suns_are_all_or_evenly_spread() {
        let steps: Vec<usize> = (10..20).collect();
        assert_eq!(evenly(&steps, 10), steps);
        assert_eq!(evenly(&steps, 2), [12, 17]);
        assert_eq!(evenly(&[], 5), [0; 0]);
    }
}
