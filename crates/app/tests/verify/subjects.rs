//! What is verified: models and built-in scenes, the lights over them, and the cameras that look at them.

use std::path::PathBuf;

use glam::{DVec3, Vec3};
use umbrae::cast::CastChoice;
use umbrae::lights::{lights, reaching};
use umbrae::sample::Sample;
use umbrae::talk::Talk;
use umbrae::view::{ViewChoice, add_ground, camera, ground_under};
use umbrae_core::{Bounds, Camera, Caster, Cone, Light, LightPosition, Oracle, Scene};
use umbrae_formats::LoadOptions;
use umbrae_render::Look;

use crate::data;

/// Where a scene comes from and what lights it.
pub(crate) struct Source {
    pub(crate) name: String,
    place: Place,
    lighting: Lighting,
}

enum Place {
    File(PathBuf),
    Sample(Sample),
}

/// What lights a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lighting {
    /// The sun; a lamp outside; a lamp inside the model's box; a lamp in the plane of one of its triangles; a spot
    /// inside the box.
    Five,
    /// Its own lights, as the command line has them reach.
    Own,
    /// A spot under the ceiling of a room.
    Ceiling,
}

/// A scene with its ground, ready to be drawn and judged.
pub(crate) struct Subject {
    pub(crate) scene: Scene,
    pub(crate) casters: Vec<Caster>,
    pub(crate) triangles: usize,
    pub(crate) lights: Vec<Light>,
    /// From outside; from a place that the model shades from the sun; from outside with the near plane through the
    /// model.
    pub(crate) cameras: [Camera; 3],
}

/// Everything that is verified, where the data folder is there.
pub(crate) fn sources() -> Option<Vec<Source>> {
    let folder = data::folder()?;
    let files = data::models(&folder);
    assert!(files.len() >= 50, "only {} models in {}", files.len(), folder.display());
    let mut sources: Vec<Source> = files
        .into_iter()
        .map(|path| {
            let name = path.strip_prefix(&folder).unwrap().display().to_string();
            Source { name, place: Place::File(path), lighting: Lighting::Five }
        })
        .collect();
    for sample in [Sample::LatticeTower, Sample::Industry, Sample::HighRise, Sample::Town] {
        sources.push(Source::of_sample(sample, Lighting::Five));
    }
    for sample in [Sample::Staircase, Sample::TownByNight] {
        sources.push(Source::of_sample(sample, Lighting::Own));
    }
    for (file, lighting, words) in [
        ("gltf/LightsPunctualLamp.glb", Lighting::Own, "its lights"),
        ("mesh/CornellBox-Original.obj", Lighting::Ceiling, "a spot"),
    ] {
        sources.push(Source { name: format!("{file}, {words}"), place: Place::File(folder.join(file)), lighting });
    }
    Some(sources)
}

impl Source {
    fn of_sample(sample: Sample, lighting: Lighting) -> Self {
        Self { name: format!("sample {sample:?}"), place: Place::Sample(sample), lighting }
    }

    /// The subject, seen in pictures of `size_px`.
    pub(crate) fn subject(&self, size_px: [u32; 2]) -> Subject {
        let mut scene = match &self.place {
            Place::File(path) => {
                let quiet = Talk::new(true, umbrae::cli::ColorWhen::Never);
                umbrae::model::load_one(path, &LoadOptions::default(), &quiet).unwrap().scene
            }
            Place::Sample(sample) => sample.scene(),
        };
        let bounds = scene.bounds();
        let triangles = scene.triangle_count();
        CastChoice::default().assign(&mut scene);
        let model = Caster::of_scene(&scene);
        let sun = LightPosition::sun(238_f64.to_radians(), 40_f64.to_radians());
        let ground = ground_under(&bounds);
        let view = |choice: ViewChoice| camera(&choice, &scene, &bounds, Some(&ground)).unwrap();
        let outside = view(ViewChoice { size_px, ..ViewChoice::default() });
        let in_shadow = view(in_shadow(&bounds, &Oracle::new(&model), sun, scene.origin, size_px));
        let cameras = [outside, in_shadow, cutting(&outside, &bounds)];
        add_ground(&mut scene, &ground);
        let lights = match self.lighting {
            Lighting::Five => five_lights(&bounds, &model[0], sun).to_vec(),
            Lighting::Own => {
                let own = lights(&[], &scene, &bounds);
                assert_eq!(own.len(), scene.lights.len(), "{} has lights of its own", self.name);
                let exposure = Look::for_model(&bounds, &own).exposure;
                reaching(own, exposure)
            }
            Lighting::Ceiling => vec![spot(&bounds, DVec3::new(0.07, -0.11, 0.93), 35.0, 1.7)],
        };
        Subject { casters: Caster::of_scene(&scene), scene, triangles, lights, cameras }
    }
}

fn five_lights(bounds: &Bounds, caster: &Caster, sun: LightPosition) -> [Light; 5] {
    let [a, b, c] = caster.corners(caster.mesh.triangles().len() / 2).map(Vec3::as_dvec3);
    let light = |name: &str, position: LightPosition| Light::new(name, position, Vec3::ONE);
    let outwards = DVec3::new(1.3, -0.7, 1.9) * bounds.radius().max(1e-3);
    [
        light("sun", sun),
        light("lamp outside", LightPosition::point(bounds.center() + outwards)),
        light("lamp inside the box", LightPosition::point(in_box(bounds, DVec3::new(0.31, -0.43, 0.57)))),
        light("lamp in a triangle's plane", LightPosition::point(a + (b - a) * 3.1 - (c - a) * 1.7)),
        spot(bounds, DVec3::new(-0.62, 0.54, 0.71), 40.0, 1.0),
    ]
}

/// From each corner of the box to the other one is -1 to 1.
fn in_box(bounds: &Bounds, place: DVec3) -> DVec3 {
    bounds.center() + 0.5 * bounds.size() * place
}

/// A spot at a place in the box that shines at its middle.
fn spot(bounds: &Bounds, place: DVec3, outer_deg: f64, range_radii: f64) -> Light {
    let position = in_box(bounds, place);
    let axis = (bounds.center() - position).normalize_or(DVec3::NEG_Z);
    let outer_rad = outer_deg.to_radians();
    Light {
        cone: Some(Cone { axis, inner_rad: 0.8 * outer_rad, outer_rad }),
        range_m: Some(range_radii * bounds.radius().max(1e-3)),
        ..Light::new("spot in the box", LightPosition::point(position), Vec3::ONE)
    }
}

/// A view whose eye the model shades: behind it as seen from the light, or as near to that as can be found.
fn in_shadow(bounds: &Bounds, model: &Oracle, light: LightPosition, origin: DVec3, size_px: [u32; 2]) -> ViewChoice {
    let to_light = light.offset_from(bounds.center()).normalize_or_zero();
    let radius = bounds.radius();
    let is_shaded = |eye: DVec3| model.casting().is_hit(eye, light.offset_from(eye), 0.0, f64::INFINITY);
    let behind = bounds.center() - to_light * radius * 1.15;
    let eye = (1..200)
        .map(|i| {
            let spread = DVec3::new((f64::from(i) * 0.7).sin(), (f64::from(i) * 1.3).sin(), (f64::from(i) * 2.1).sin());
            behind + spread * radius * 0.004 * f64::from(i)
        })
        .find(|&eye| is_shaded(eye))
        .unwrap_or(behind);
    ViewChoice {
        size_px,
        eye: Some(eye + origin),
        target: Some(bounds.center() + radius * DVec3::new(0.21, 0.17, -0.13) + origin),
        fov_deg: Some(68.0),
        ..ViewChoice::default()
    }
}

/// The outside camera with its near plane through the model.
fn cutting(outside: &Camera, bounds: &Bounds) -> Camera {
    let depth = (bounds.center() - outside.eye()).dot(outside.axes()[2]);
    let near = (depth - 0.13 * bounds.radius()).max(outside.near());
    Camera::new(outside.eye(), outside.target(), outside.fov_y_rad(), near, outside.size_px()).unwrap()
}
