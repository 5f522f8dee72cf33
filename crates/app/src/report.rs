//! The JSON of `umbrae render --json`: enough for an independent ray tracer to repeat every pixel's ray and verdict.
//!
//! Positions are in the model's own coordinates, z up, in metres: the file's coordinates after `world_from_file`. What is drawn is at
//! `position - origin`, rounded to `f32`.

mod light;

use glam::DVec3;
use serde::Serialize;
use umbrae_core::{Camera, Sphere};
use umbrae_formats::UpAxis;
use umbrae_render::{Comparison, PassTime, ShadowOptions};

use crate::cli::LightMark;
use crate::model::{LoadedFile, format_name};
use crate::show::ShowReport;
use crate::view::Ground;

pub use self::light::{Cost, LightJson};

/// The whole report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Of the program.
    pub version: &'static str,
    /// The adapter's line in `umbrae doctor`.
    pub adapter: String,
    /// In the order of the command line.
    pub models: Vec<ModelReport>,
    /// With `--time`: seconds after the beginning of the models' animations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// With `--animation`: the one that is played, in models that have it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub animation: Option<String>,
    /// Where vertices were moved to that moment: "cpu" or "gpu".
    pub posing: &'static str,
    /// What is subtracted before rounding to `f32`.
    pub origin: [f64; 3],
    /// Absent with `--no-ground`.
    pub ground: Option<GroundReport>,
    /// With `--sphere`; drawn and casting like everything else.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub spheres: Vec<SphereReport>,
    /// The eye.
    pub camera: CameraReport,
    /// Samples a pixel of the picture.
    pub samples: u32,
    /// "auto", "zpass", "zfail" or "eye-count".
    pub method: &'static str,
    /// How silhouettes were found: "auto", "scan", "dual", "cones", "coherent", "gpu" or "gpu-basic".
    pub silhouette: &'static str,
    /// With `--show`, what the picture shows besides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub show: Option<ShowReport>,
    /// Changes no picture.
    pub left_out: LeftOut,
    /// In the order in which they were added.
    pub lights: Vec<LightJson>,
    /// GPU times; empty where the device can't tell.
    pub passes: Vec<PassJson>,
    /// Times on the CPU.
    pub times_ms: Times,
    /// With `--verify`, over all lights together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verify: Option<VerifyJson>,
}

/// One file.
#[derive(Debug, Serialize)]
pub struct ModelReport {
    /// As given.
    path: String,
    /// "gltf", "obj", "ply" or "stl".
    format: &'static str,
    /// The file's axis that is up: "y" or "z".
    up: &'static str,
    /// Rows of the rotation from the file's axes to x east, y north, z up.
    world_from_file: [[f64; 3]; 3],
    /// What was left out of it.
    warnings: Vec<String>,
}

impl ModelReport {
    /// What is known about `file`.
    pub fn new(file: &LoadedFile) -> Self {
        let (up, world_from_file) = match file.up {
            UpAxis::Y => ("y", [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
            UpAxis::Z => ("z", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        };
        Self {
            path: file.path.display().to_string(),
            format: format_name(file.format),
            up,
            world_from_file,
            warnings: file.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

/// A square of two triangles that is drawn and casts like everything else.
#[derive(Debug, Serialize)]
pub struct GroundReport {
    /// Its z.
    height: f64,
    /// Its middle's x and y.
    center: [f64; 2],
    /// Half of its side.
    half_extent: f64,
}

impl GroundReport {
    /// `ground` of a scene about `origin`.
    pub fn new(ground: &Ground, origin: DVec3) -> Self {
        Self {
            height: ground.height_m + origin.z,
            center: (ground.center + origin.truncate()).to_array(),
            half_extent: ground.half_extent_m,
        }
    }
}

/// A ball that is no mesh.
#[derive(Debug, Serialize)]
pub struct SphereReport {
    /// As its entries among the casters of each light have it.
    name: String,
    /// Its middle.
    center: [f64; 3],
    /// Metres.
    radius: f64,
}

impl SphereReport {
    /// `sphere` of a scene about `origin`.
    pub fn new(sphere: &Sphere, origin: DVec3) -> Self {
        Self { name: sphere.name.clone(), center: (sphere.center + origin).to_array(), radius: sphere.radius }
    }
}

/// The ray of pixel (column i, row j from the top) goes from `eye` along `forward + right * half_width * (2 (i + 0.5) / width - 1) + up * half_height * (1 - 2 (j + 0.5) / height)`
/// and sees from view depth `near`, where `half_height = tan(fov_y / 2)` and `half_width = half_height * width / height`.
#[derive(Debug, Serialize)]
pub struct CameraReport {
    /// Where it is.
    eye: [f64; 3],
    /// What it looks at.
    target: [f64; 3],
    /// Upwards in the picture; a unit vector, not always across the view.
    up: [f64; 3],
    /// Full vertical angle.
    fov_y_deg: f64,
    /// View depth from which on it sees.
    near: f64,
    /// Pixels across and down.
    size: [u32; 2],
}

impl CameraReport {
    /// `camera` of a scene about `origin`.
    pub fn new(camera: &Camera, origin: DVec3) -> Self {
        Self {
            eye: (camera.eye() + origin).to_array(),
            target: (camera.target() + origin).to_array(),
            up: camera.up().to_array(),
            fov_y_deg: camera.fov_y_rad().to_degrees(),
            near: camera.near(),
            size: camera.size_px(),
        }
    }
}

/// What is left out of counting because it can change no pixel: the rules that were on.
#[derive(Debug, Serialize)]
pub struct LeftOut {
    /// Lights whose reach is out of view.
    unseen_lights: bool,
    /// Casters outside a light's range or cone.
    unreached_casters: bool,
    /// Casters whose shadow can't be in view.
    unseen_casters: bool,
    /// Caps that are out of view.
    unseen_caps: bool,
    /// Pixels outside the rectangle around a light's reach.
    light_scissor: bool,
    /// Pixels outside the rectangle around a caster's shadow.
    caster_scissor: bool,
    /// Pixels that are not marked: "off", "exact", "select" or "receivers".
    light_mark: &'static str,
}

impl LeftOut {
    /// What `options` leave out.
    pub fn new(options: &ShadowOptions) -> Self {
        Self {
            unseen_lights: options.cull_lights,
            unreached_casters: options.cull_unreached,
            unseen_casters: options.cull_unseen,
            unseen_caps: options.cull_caps,
            light_scissor: options.light_scissor,
            caster_scissor: options.caster_scissor,
            light_mark: LightMark::name(options.light_mark),
        }
    }
}

/// One pass on the GPU.
#[derive(Debug, Serialize)]
pub struct PassJson {
    name: String,
    ms: f64,
}

impl From<&PassTime> for PassJson {
    fn from(time: &PassTime) -> Self {
        Self { name: time.name.clone(), ms: time.ms }
    }
}

/// Wall-clock times of the steps.
#[derive(Debug, Default, Clone, Copy, Serialize)]
pub struct Times {
    /// Files into a scene, welding included.
    pub load: f64,
    /// Topology and scene-space positions.
    pub topology: f64,
    /// Finding the device and compiling pipelines.
    pub device: f64,
    /// Uploading the scene.
    pub upload: f64,
    /// Drawing and reading back the picture.
    pub picture: f64,
    /// Masks and rays of `--verify`; 0 without.
    pub verify: f64,
}

/// The result of `--verify`.
#[derive(Debug, Default, Serialize)]
pub struct VerifyJson {
    /// Pixels looked at, for all lights together.
    pub pixels: usize,
    /// Those that see a surface.
    pub surface: usize,
    /// Surface pixels on which five rays agree.
    pub decided: usize,
    /// Decided pixels that were drawn wrong.
    pub errors: usize,
    /// The same for each light.
    pub lights: Vec<VerifyLightJson>,
}

/// The result for one light.
#[derive(Debug, Serialize)]
pub struct VerifyLightJson {
    name: String,
    pixels: usize,
    surface: usize,
    decided: usize,
    errors: usize,
}

impl VerifyJson {
    /// Adds one light's result.
    pub fn add(&mut self, name: &str, comparison: &Comparison) {
        let Comparison { pixels, surface, decided, ref errors } = *comparison;
        let errors = errors.len();
        self.pixels += pixels;
        self.surface += surface;
        self.decided += decided;
        self.errors += errors;
        self.lights.push(VerifyLightJson { name: name.to_owned(), pixels, surface, decided, errors });
    }
}
