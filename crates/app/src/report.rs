//! The JSON of `umbrae render --json`: enough for an independent ray tracer to repeat every pixel's ray and verdict.
//!
//! Positions are in the model's own coordinates, z up, in metres: the file's coordinates after `world_from_file`. What is drawn is at
//! `position - origin`, rounded to `f32`.

use glam::DVec3;
use serde::Serialize;
use umbrae_core::{Camera, Caster, Cone, Light};
use umbrae_formats::UpAxis;
use umbrae_render::{CasterReport, Comparison, LightReport, PassTime};

use crate::model::{LoadedFile, format_name};
use crate::show::ShowReport;
use crate::view::Ground;

/// The whole report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Of the program.
    pub version: &'static str,
    /// The adapter's line in `umbrae doctor`.
    pub adapter: String,
    /// In the order of the command line.
    pub models: Vec<ModelReport>,
    /// What is subtracted before rounding to `f32`.
    pub origin: [f64; 3],
    /// Absent with `--no-ground`.
    pub ground: Option<GroundReport>,
    /// The eye.
    pub camera: CameraReport,
    /// Samples a pixel of the picture.
    pub samples: u32,
    /// "auto", "zpass" or "zfail".
    pub method: &'static str,
    /// With `--show`, what the picture shows besides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub show: Option<ShowReport>,
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

/// One light and what it drew.
///
/// A directional light gives a surface that faces it `strength`. A lamp d metres away gives it `strength / d^2 * (1 - (d / range)^4)`, and
/// nothing from its range on; a spot that times `edge^2`, where `edge` goes from 1 to 0 as the cosine of the angle from the cone's middle
/// goes from that of `inner_deg` to that of `outer_deg`.
#[derive(Debug, Serialize)]
pub struct LightJson {
    name: String,
    /// "directional", "point" or "spot".
    kind: &'static str,
    /// Of a point or a spot.
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<[f64; 3]>,
    /// Of a directional light: the unit vector towards it.
    #[serde(skip_serializing_if = "Option::is_none")]
    direction_to_light: Option<[f64; 3]>,
    /// Of a spot.
    #[serde(skip_serializing_if = "Option::is_none")]
    cone: Option<ConeJson>,
    /// Of a point or a spot: metres at which it has faded to nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    range: Option<f64>,
    /// `color` times `intensity`: irradiance of a directional light, and of a lamp at 1 m.
    strength: [f32; 3],
    /// Linear; the strongest channel is 1, or all are 0.
    color: [f32; 3],
    /// Of the strongest channel: lux of a directional light, candela of a lamp.
    intensity: f32,
    /// Time on the CPU for facing, silhouettes and volumes of all casters.
    silhouettes_and_volumes_ms: f64,
    /// One entry for each object, the ground last; an object in which only some triangles cast has two, of one name.
    casters: Vec<CasterJson>,
}

impl LightJson {
    /// `light` of a scene about `origin`.
    pub fn new(light: &Light, report: &LightReport, casters: &[Caster], origin: DVec3) -> Self {
        let xyz = light.position.homogeneous().truncate();
        let is_directional = light.position.is_directional();
        let intensity = light.strength.max_element();
        Self {
            name: light.name.clone(),
            kind: match light.cone {
                _ if is_directional => "directional",
                Some(_) => "spot",
                None => "point",
            },
            position: (!is_directional).then(|| (xyz + origin).to_array()),
            direction_to_light: is_directional.then(|| xyz.to_array()),
            cone: light.cone.filter(|_| !is_directional).map(Into::into),
            range: light.range_m.filter(|_| !is_directional),
            strength: light.strength.to_array(),
            color: (light.strength / if intensity > 0.0 { intensity } else { 1.0 }).to_array(),
            intensity,
            silhouettes_and_volumes_ms: report.cpu_ms,
            casters: casters.iter().zip(&report.casters).map(|(c, r)| CasterJson::new(c, r)).collect(),
        }
    }
}

/// Where a spot shines.
#[derive(Debug, Serialize)]
pub struct ConeJson {
    /// The unit vector along its middle, away from the light.
    direction: [f64; 3],
    /// From the middle to where its edge begins.
    inner_deg: f64,
    /// From the middle to where it ends.
    outer_deg: f64,
}

impl From<Cone> for ConeJson {
    fn from(cone: Cone) -> Self {
        Self {
            direction: cone.axis.to_array(),
            inner_deg: cone.inner_rad.to_degrees(),
            outer_deg: cone.outer_rad.to_degrees(),
        }
    }
}

/// One caster under one light.
#[derive(Debug, Serialize)]
pub struct CasterJson {
    name: String,
    /// Whether it casts at all: see `--cast`, `--no-cast` and `--glass-casts`.
    casts: bool,
    /// Whether what is behind it shows through.
    is_glass: bool,
    /// McGuire's: 1 z-pass, 2 z-fail without light cap, 3 z-fail; absent if it was not drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    case: Option<u32>,
    /// Different edges between what is turned to the light and what is not.
    silhouette_edges: usize,
    /// What its shadow volume is drawn with.
    triangles: TrianglesByPart,
}

#[derive(Debug, Serialize)]
struct TrianglesByPart {
    /// Between the silhouette and its shadow.
    sides: usize,
    /// At infinity.
    dark_cap: usize,
    /// On the caster itself.
    light_cap: usize,
}

impl CasterJson {
    fn new(caster: &Caster, report: &CasterReport) -> Self {
        Self {
            name: caster.name.clone(),
            casts: caster.role.casts,
            is_glass: caster.role.is_glass,
            case: report.case().map(umbrae_core::Case::number),
            silhouette_edges: report.silhouette_edges,
            triangles: TrianglesByPart {
                sides: report.side_triangles,
                dark_cap: report.dark_cap_triangles,
                light_cap: report.light_cap_triangles,
            },
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
