//! `umbrae render --show`: pictures of how shadows are determined, each with a legend.
//!
//! What has a place in the scene is an [`Overlay`] that the renderer draws over the lit picture; numbers per pixel, rectangles, names and
//! legends are drawn on the finished picture.

mod bounds;
pub(crate) mod canvas;
mod cases;
mod contours;
mod edges;
mod heat;
mod layout;
mod legend;
mod marks;
pub(crate) mod numbers;
mod outlines;
pub(crate) mod text;
mod volumes;

use anyhow::{bail, ensure};
use clap::ValueEnum;
use serde::Serialize;
use umbrae_core::{Camera, Caster, Light, RayCaster};
use umbrae_render::{GpuScene, LightReport, Overlay, Smooth};

use canvas::Canvas;
use legend::Legend;

/// What a picture shows of how its shadows are determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// The sides of the shadow volumes, in translucent yellow
    Volumes,
    /// The outlines of objects as the lights see them, in pink
    Silhouettes,
    /// Each object in the colour of its case: how its volume is counted, or why it is not drawn
    Cases,
    /// How many shadow volumes hold what each pixel shows
    Counts,
    /// Edges at which the model is not a closed, consistently wound surface
    Topology,
    /// Where the light reaches, and the rectangles to which it and its volumes are confined
    Bounds,
    /// How many fragments of shadow volumes were rasterised in each pixel
    Fill,
    /// With --smooth: the outlines of triangles, of normals on the mesh, and of the smooth surface, in three colours
    Contours,
}

/// What there is to show; all borrowed.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// Everything that is drawn.
    pub casters: &'a [Caster],
    /// The casters, uploaded, and which of them are smooth.
    pub scene: &'a GpuScene,
    /// How smooth.
    pub smooth: Smooth,
    /// The index of the ground plane, which is no part of the model.
    pub ground: Option<usize>,
    /// The eye.
    pub camera: &'a Camera,
    /// All lights of the picture.
    pub lights: &'a [Light],
    /// For each light, what was drawn for it in the picture without anything shown.
    pub reports: &'a [LightReport],
}

impl<'a> Subject<'a> {
    /// The casters but the ground, with their indices.
    fn models(&self) -> impl Iterator<Item = (usize, &'a Caster)> + use<'a> {
        let ground = self.ground;
        self.casters.iter().enumerate().filter(move |(i, _)| Some(*i) != ground)
    }

    /// The names of these lights, for a title; or how many, where those would be too many to read.
    fn names_of(&self, lights: &[usize]) -> String {
        let (shown, all) = (lights.len(), self.lights.len());
        if shown > MOST_LIGHTS {
            return format!("{shown} lights");
        }
        let names: Vec<String> = lights.iter().map(|&light| quoted(&self.lights[light].name)).collect();
        let of_all = if shown < all { format!(" ({shown} of {all} lights)") } else { String::new() };
        format!("{}{of_all}", names.join(", "))
    }

    /// To find what is seen.
    fn rays(&self) -> RayCaster {
        RayCaster::new(self.casters.iter().map(|caster| (caster.positions.as_slice(), caster.mesh.triangles())))
    }
}

/// Something to show, ready to be drawn with the picture and on it.
#[derive(Debug)]
pub struct Show<'a> {
    mode: Mode,
    subject: Subject<'a>,
    /// Indices of the lights about which it is.
    lights: Vec<usize>,
    overlay: Option<Overlay>,
    /// Finished when the picture is, for what is counted in it.
    legend: Legend,
}

/// Numbers for each pixel, row by row from the top, that only the renderer knows.
#[derive(Debug, Clone)]
pub enum Numbers {
    /// For every mode but these.
    None,
    /// Stencil counts, for [`Mode::Counts`].
    Counts(Vec<i32>),
    /// Fragments, for [`Mode::Fill`].
    Fill(Vec<u32>),
}

/// More lights than this can't be told apart, so only the first are shown.
const MOST_LIGHTS: usize = 4;

impl<'a> Show<'a> {
    /// Finds what `mode` shows of `subject`: about the light called `light_name`, or else about the first ones (of volumes and silhouettes), all (of fill)
    /// or the first one.
    ///
    /// # Errors
    ///
    /// When no light has that name.
    pub fn new(mode: Mode, subject: Subject<'a>, light_name: Option<&str>) -> anyhow::Result<Self> {
        let is_smooth = subject.smooth != Smooth::Off;
        ensure!(is_smooth || mode != Mode::Contours, "--show contours shows what --smooth makes; add --smooth");
        let lights = shown_lights(mode, subject.lights, light_name)?;
        let (overlay, legend) = match (mode, lights.first()) {
            (Mode::Volumes, _) => some_first(volumes::volumes(&subject, &lights)),
            (Mode::Silhouettes, _) => some_first(outlines::silhouettes(&subject, &lights)),
            (Mode::Contours, _) => some_first(contours::contours(&subject, &lights)),
            (Mode::Topology, _) => some_first(edges::topology(&subject)),
            (Mode::Cases, Some(&light)) => some_first(cases::cases(&subject, light)),
            (Mode::Bounds, Some(&light)) => (Some(bounds::reach(&subject, light)), Legend::default()),
            _ => (None, Legend::default()),
        };
        Ok(Self { mode, subject, lights, overlay, legend })
    }

    /// What the renderer has to draw over the lit picture.
    pub fn overlay(&self) -> Option<&Overlay> {
        self.overlay.as_ref()
    }

    /// The lights about which it is: of [`Mode::Counts`] one; of [`Mode::Fill`] those whose fragments are to be added up.
    pub fn lights(&self) -> Vec<&'a Light> {
        self.lights.iter().map(|&light| &self.subject.lights[light]).collect()
    }

    /// Draws the rest on the finished picture: four sRGB bytes a pixel, row by row from the top. `numbers` are those of
    /// [`Show::lights`].
    pub fn finish(mut self, rgba: &mut [u8], numbers: &Numbers) -> ShowReport {
        let mut canvas = Canvas::new(rgba, self.subject.camera.size_px());
        let lights = self.subject.lights;
        if let Some(&light) = self.lights.first() {
            let name = self.subject.names_of(&self.lights);
            match (numbers, self.mode) {
                (Numbers::Counts(counts), _) => self.legend = heat::draw_counts(&mut canvas, counts, &name),
                (Numbers::Fill(fill), _) => self.legend = heat::draw_fill(&mut canvas, fill, &name),
                (Numbers::None, Mode::Bounds) => self.legend = bounds::draw(&mut canvas, &self.subject, light),
                (Numbers::None, _) => {}
            }
        }
        if matches!(self.mode, Mode::Volumes | Mode::Silhouettes | Mode::Contours | Mode::Cases | Mode::Bounds) {
            for &light in &self.lights {
                marks::draw_light(&mut canvas, self.subject.camera, &lights[light]);
            }
        }
        self.legend.draw(&mut canvas);
        ShowReport {
            mode: self.mode.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default(),
            lights: self.lights.iter().map(|&light| lights[light].name.clone()).collect(),
            legend: self.legend.sentences(),
        }
    }
}

/// What was shown, in the JSON report.
#[derive(Debug, Serialize)]
pub struct ShowReport {
    /// As on the command line.
    mode: String,
    /// Those about which the picture is.
    lights: Vec<String>,
    /// What the picture's legend says, line by line.
    legend: Vec<String>,
}

fn some_first<A, B>((a, b): (A, B)) -> (Option<A>, B) {
    (Some(a), b)
}

/// Indices of the lights that are shown.
fn shown_lights(mode: Mode, lights: &[Light], name: Option<&str>) -> anyhow::Result<Vec<usize>> {
    let Some(name) = name else {
        let most = match mode {
            Mode::Volumes | Mode::Silhouettes => MOST_LIGHTS,
            Mode::Cases | Mode::Counts | Mode::Bounds | Mode::Contours => 1,
            Mode::Fill => lights.len(),
            Mode::Topology => 0,
        };
        return Ok((0..lights.len().min(most)).collect());
    };
    if let Some(found) = lights.iter().position(|light| light.name == name) {
        return Ok(vec![found]);
    }
    let names: Vec<String> = lights.iter().map(|light| quoted(&light.name)).collect();
    bail!("there is no light {} to show; there is {}", quoted(name), names.join(", "));
}

fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}
