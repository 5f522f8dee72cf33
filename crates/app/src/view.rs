//! The camera, the lights and the ground of a picture: what the user said, and good answers to what was left unsaid.

use std::sync::Arc;

use anyhow::{Context as _, bail};
use glam::{DAffine3, DVec2, DVec3, Vec3};
use umbrae_core::{Bounds, Camera, Light, LightPosition, Material, Mesh, Object, Scene, Surface};

/// What the user said about the view; positions in the model's coordinates.
#[derive(Debug, Clone, Default)]
pub struct ViewChoice {
    /// Pixels across and down.
    pub size_px: [u32; 2],
    /// Where the eye is.
    pub eye: Option<DVec3>,
    /// What it looks at.
    pub target: Option<DVec3>,
    /// Full vertical angle.
    pub fov_deg: Option<f64>,
    /// A camera of the model.
    pub camera_name: Option<String>,
    /// Azimuth and altitude.
    pub sun_deg: Option<[f64; 2]>,
    /// Lamps.
    pub points: Vec<DVec3>,
}

/// The ground plane: two triangles just under the model, far larger than it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Scene space.
    pub height_m: f64,
    /// Scene space.
    pub center: DVec2,
    /// Half the side of the square.
    pub half_extent_m: f64,
}

/// The afternoon sun of a picture without lights: from the south-west, so that the shadows of a model that faces south fall back and to the right.
const DEFAULT_SUN_DEG: [f64; 2] = [238.0, 40.0];
/// Irradiance of the sun against that of anything else; only ratios are seen.
const SUN_STRENGTH: Vec3 = Vec3::new(3.2, 3.05, 2.8);
/// A lamp gives this irradiance at the model's middle, or where its bounding sphere would be if it is nearer.
const LAMP_STRENGTH: Vec3 = Vec3::new(3.1, 2.95, 2.7);
/// Where the eye of a default view is: clockwise from north, and above the horizon, seen from the model.
const DEFAULT_EYE_DEG: [f64; 2] = [152.0, 24.0];
const DEFAULT_FOV_DEG: f64 = 35.0;
/// Room around the model in a default view.
const MARGIN: f64 = 1.07;
/// The near plane is this far towards the nearest thing that can be seen, so that a wide margin is left…
const NEAR_SHARE: f64 = 0.5;
/// …but no nearer than this, in radii of the model: enough to stand in a room of it. Depth is interpolated in `f32` along faces
/// that reach to the near plane, so what is at distance d is good to about d / near roundings.
const LEAST_NEAR_RADII: f64 = 1e-3;
/// The ground is this much lower than the model, in its radii: clear of rounding, too little to see under.
const GROUND_GAP_RADII: f64 = 2e-4;
/// The ground ends at this many radii, beyond where it has faded.
const GROUND_EXTENT_RADII: f64 = 12.0;

/// The ground under a model.
pub fn ground_under(model: &Bounds) -> Ground {
    let radius = radius_of(model);
    let center = model.center();
    // Rounded to what the mesh will hold, so that the report is exact.
    let height_m = f64::from((model.min.z - GROUND_GAP_RADII * radius) as f32);
    Ground {
        height_m,
        center: DVec2::new(f64::from(center.x as f32), f64::from(center.y as f32)),
        half_extent_m: f64::from((GROUND_EXTENT_RADII * radius) as f32),
    }
}

/// Adds the ground to `scene` as an object like any other.
pub fn add_ground(scene: &mut Scene, ground: &Ground) {
    let corner = |x: f64, y: f64| {
        let offset = DVec2::new(x, y) * ground.half_extent_m;
        (ground.center + offset).extend(ground.height_m).as_vec3()
    };
    let surface = Surface {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![scene.materials.len() as u32; 2],
        vertex_colors: Vec::new(),
    };
    scene.materials.push(Material { name: "ground".to_owned(), base_color: Vec3::new(0.60, 0.585, 0.56) });
    scene.objects.push(Object {
        name: "ground".to_owned(),
        mesh: Arc::new(Mesh::new(surface).expect("a finite model has a finite ground")),
        world_from_object: DAffine3::IDENTITY,
    });
}

/// The lights: the user's, else the model's, else an afternoon sun.
pub fn lights(choice: &ViewChoice, scene: &Scene, model: &Bounds) -> Vec<Light> {
    let mut lights = Vec::new();
    if let Some(sun) = choice.sun_deg {
        lights.push(sun_light(sun));
    }
    for (i, point) in choice.points.iter().enumerate() {
        let position = *point - scene.origin;
        let distance = position.distance(model.center()).max(radius_of(model));
        lights.push(Light {
            name: format!("point {}", i + 1),
            position: LightPosition::point(position),
            strength: LAMP_STRENGTH * (distance * distance) as f32,
        });
    }
    if lights.is_empty() {
        lights.clone_from(&scene.lights);
    }
    if lights.is_empty() {
        lights.push(sun_light(DEFAULT_SUN_DEG));
    }
    for light in &mut lights {
        // What draws and what verifies must mean the same light.
        light.position = light.position.rounded_to_f32();
    }
    lights
}

fn sun_light([azimuth_deg, altitude_deg]: [f64; 2]) -> Light {
    Light {
        name: "sun".to_owned(),
        position: LightPosition::sun(azimuth_deg.to_radians(), altitude_deg.to_radians()),
        strength: SUN_STRENGTH,
    }
}

/// The camera: the model's if named, else what the user said, else one that frames the model. `ground` is the one that will be drawn.
///
/// # Errors
///
/// When the model has no camera of that name, or what was said can't be a camera.
pub fn camera(
    choice: &ViewChoice,
    scene: &Scene,
    model: &Bounds,
    ground: Option<&Ground>,
) -> anyhow::Result<Camera> {
    if let Some(name) = &choice.camera_name {
        return Ok(named_camera(scene, name)?.with_size(choice.size_px)?);
    }
    let fov_rad = choice.fov_deg.unwrap_or(DEFAULT_FOV_DEG).to_radians();
    let least_near = LEAST_NEAR_RADII * radius_of(model);
    let target = choice.target.map_or(model.center(), |target| target - scene.origin);
    let make = |eye: DVec3, near: f64| Camera::new(eye, target, fov_rad, near, choice.size_px);
    let eye = if let Some(eye) = choice.eye {
        eye - scene.origin
    } else {
        let [azimuth, altitude] = DEFAULT_EYE_DEG.map(f64::to_radians);
        let towards_eye = LightPosition::sun(azimuth, altitude).homogeneous().truncate();
        // The direction decides what fits; only then is the distance known.
        let camera = make(target + towards_eye * radius_of(model), least_near)?;
        target + towards_eye * framing_distance(&camera, model)
    };
    let camera = make(eye, least_near).context("--eye and --target make no view")?;
    let near = (NEAR_SHARE * nearest_depth(&camera, model, ground)).max(least_near);
    Ok(make(eye, near)?)
}

/// A view depth below which `camera` sees nothing of the model's box and of the ground; may be 0 or less.
fn nearest_depth(camera: &Camera, model: &Bounds, ground: Option<&Ground>) -> f64 {
    let forward = camera.axes()[2];
    let of_model = model.corners().into_iter().map(|corner| (corner - camera.eye()).dot(forward));
    let [width, height] = camera.size_px().map(f64::from);
    let of_ground = ground.into_iter().flat_map(|ground| {
        let height_above = camera.eye().z - ground.height_m;
        let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
        // A ray of view depth 1 that goes down by s is on the ground at depth height / s.
        corners.map(|(x, y)| -height_above / camera.ray_direction(x, y).z).into_iter().filter(|&depth| depth > 0.0)
    });
    of_model.chain(of_ground).fold(f64::INFINITY, f64::min)
}

fn named_camera<'a>(scene: &'a Scene, name: &str) -> anyhow::Result<&'a umbrae_core::NamedCamera> {
    if let Some(camera) = scene.cameras.iter().find(|c| c.name == name) {
        return Ok(camera);
    }
    let names: Vec<_> = scene.cameras.iter().map(|c| format!("`{}`", c.name)).collect();
    if names.is_empty() {
        bail!("there is no camera `{name}`: the model has none; use --eye and --target");
    }
    bail!("there is no camera `{name}`; the model has {}", names.join(", "));
}

/// How far from its target a camera of this direction must be for all of `model` to be in the picture.
fn framing_distance(camera: &Camera, model: &Bounds) -> f64 {
    let [right, up, forward] = camera.axes();
    let half = camera.half_extent();
    model
        .corners()
        .into_iter()
        .map(|corner| {
            let offset = corner - camera.target();
            let sideways = (offset.dot(right).abs() / half.x).max(offset.dot(up).abs() / half.y);
            sideways * MARGIN - offset.dot(forward)
        })
        .fold(2.0 * camera.near(), f64::max)
}

/// The radius of a model, or 1 m for a single point.
fn radius_of(model: &Bounds) -> f64 {
    let radius = model.radius();
    if radius > 0.0 { radius } else { 1.0 }
}
