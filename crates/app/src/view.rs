//! The camera and the ground of a picture: what the user said, and good answers to what was left unsaid.

use std::sync::Arc;

use anyhow::{bail, ensure};
use glam::{DAffine3, DVec2, DVec3, Vec3};
use umbrae_core::{Bounds, Camera, LightPosition, Material, Mesh, Object, Scene, Sphere, Surface};

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
    /// What is to be in a picture that frames the model, besides it; scene space.
    pub spheres: Vec<Sphere>,
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

/// Where the eye of a default view is: clockwise from north, and above the horizon, seen from the model.
const DEFAULT_EYE_DEG: [f64; 2] = [152.0, 24.0];
pub(crate) const DEFAULT_FOV_DEG: f64 = 35.0;
/// Room around the model in a default view.
const MARGIN: f64 = 1.18;
/// The near plane is this far towards the nearest thing that can be seen, so that a wide margin is left…
const NEAR_SHARE: f64 = 0.5;
/// …but no nearer than this, in radii of the model: enough to stand in a room of it. Depth is interpolated in `f32` along faces
/// that reach to the near plane, so what is at distance d is good to about d / near roundings.
const LEAST_NEAR_RADII: f64 = 1e-3;
/// The ground is this much lower than the model, in its radii: clear of rounding, too little to see under.
const GROUND_GAP_RADII: f64 = 2e-4;
/// The ground ends at this many radii, beyond where it has faded.
const GROUND_EXTENT_RADII: f64 = 12.0;

/// Lengths below this, squared, are lost in `f32`.
const LEAST_SIZE_M: f64 = 1e-18;
/// Coordinates from here on are no mesh's: products of four of them overflow `f32`.
const MAX_COORDINATE: f64 = 1e18;

/// Makes sure that there is something to draw, and that `f32` can hold it.
///
/// # Errors
///
/// When the model, which fills `model` of `scene`, is too small, or is nothing but triangles without area, or when `ground` reaches too far.
pub fn ensure_drawable(scene: &Scene, model: &Bounds, ground: Option<&Ground>) -> anyhow::Result<()> {
    let size_m = model.size().length();
    ensure!(size_m >= LEAST_SIZE_M, "the model is {size_m:e} m across, too small to draw; scale it up");
    if let Some(ground) = ground {
        let reach = ground.center.abs().max_element() + ground.half_extent_m;
        ensure!(
            reach.max(ground.height_m.abs()) < MAX_COORDINATE,
            "the model is {size_m:e} m across, too large for a ground plane under it; scale it down, or use --no-ground"
        );
    }
    let mut triangles = scene.objects.iter().flat_map(|object| {
        let positions: Vec<DVec3> = object.positions().map(|p| p.as_vec3().as_dvec3()).collect();
        object.mesh.triangles().iter().map(move |triangle| triangle.map(|i| positions[i as usize]))
    });
    let has_area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a) != DVec3::ZERO;
    ensure!(triangles.any(has_area), "every triangle of the model is a line or a point, so there is nothing to draw");
    Ok(())
}

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

/// Adds the ground to `scene`, as an object like any other. It must be that of a model for which [`ensure_drawable`] holds.
pub fn add_ground(scene: &mut Scene, ground: &Ground) {
    let corner = |x: f64, y: f64| {
        let offset = DVec2::new(x, y) * ground.half_extent_m;
        (ground.center + offset).extend(ground.height_m).as_vec3()
    };
    let surface = Surface {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![scene.materials.len() as u32; 2],
        ..Surface::default()
    };
    scene.materials.push(Material::new("ground", Vec3::new(0.60, 0.585, 0.56)));
    let mesh = Mesh::new(surface).expect("a drawable model has a finite ground");
    scene.objects.push(Object::new("ground", Arc::new(mesh), DAffine3::IDENTITY));
}

/// The camera: the model's if named, else what the user said, else one that frames the model. `ground` is the one that will be drawn.
///
/// # Errors
///
/// When the model has no camera of that name, or what was said can't be a camera.
pub fn camera(choice: &ViewChoice, scene: &Scene, model: &Bounds, ground: Option<&Ground>) -> anyhow::Result<Camera> {
    if let Some(name) = &choice.camera_name {
        return Ok(named_camera(scene, name)?.with_size(choice.size_px)?);
    }
    let fov_rad = choice.fov_deg.unwrap_or(DEFAULT_FOV_DEG).to_radians();
    let least_near = LEAST_NEAR_RADII * radius_of(model);
    let make = |eye: DVec3, target: DVec3, near: f64| Camera::new(eye, target, fov_rad, near, choice.size_px);
    let target = choice.target.map(|target| target - scene.origin);
    let (eye, target) = if let Some(eye) = choice.eye {
        (eye - scene.origin, target.unwrap_or(model.center()))
    } else {
        let [azimuth, altitude] = DEFAULT_EYE_DEG.map(f64::to_radians);
        let from_eye = -LightPosition::sun(azimuth, altitude).homogeneous().truncate();
        let direction_only = make(DVec3::ZERO, from_eye, least_near)?;
        let eye = framing_eye(&direction_only, scene, &choice.spheres);
        // What the user wants in the middle goes there, from as far away as frames the model.
        let middle = target.unwrap_or(eye + from_eye * (model.center() - eye).dot(from_eye));
        (middle - from_eye * (middle - eye).dot(from_eye), middle)
    };
    if eye.distance(target) == 0.0 {
        let [x, y, z] = (eye + scene.origin).to_array();
        let at = format!("at {x:?},{y:?},{z:?}");
        if choice.target.is_some() {
            bail!("the eye and its target are both {at}; move one of them");
        }
        bail!("the eye is {at}, in the model's middle, which it looks at by default; give a --target");
    }
    let camera = make(eye, target, least_near)?;
    let near = (NEAR_SHARE * nearest_depth(&camera, model, ground)).max(least_near);
    Ok(make(eye, target, near)?)
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

/// The nearest eye from which a camera that looks as `camera` does sees every vertex of `scene` and all of `spheres`, as large as they can be and
/// in the middle.
fn framing_eye(camera: &Camera, scene: &Scene, spheres: &[Sphere]) -> DVec3 {
    let [right, up, forward] = camera.axes();
    let half = camera.half_extent() / MARGIN;
    // A point (x, y, z) along these axes is in the picture of an eye (u, v, w) where |x - u| <= half.x (z - w), that is, where
    // u - half.x w is at least x - half.x z, and -u - half.x w at least -x - half.x z; and so for y.
    let mut least = [f64::NEG_INFINITY; 4];
    // And for a ball, whose tangents are these planes.
    let steepness = [half.x, half.x, half.y, half.y].map(|half| half.hypot(1.0));
    let mut add = |p: DVec3, radius: f64| {
        let (x, y, z) = (p.dot(right), p.dot(up), p.dot(forward));
        let bounds = [x - half.x * z, -x - half.x * z, y - half.y * z, -y - half.y * z];
        for ((least, bound), steepness) in least.iter_mut().zip(bounds).zip(steepness) {
            *least = least.max(bound + radius * steepness);
        }
    };
    scene.objects.iter().flat_map(Object::positions).for_each(|p| add(p, 0.0));
    spheres.iter().for_each(|sphere| add(sphere.center, sphere.radius));
    let [right_most, left_most, upper_most, lower_most] = least;
    let depth = (-(right_most + left_most) / (2.0 * half.x)).min(-(upper_most + lower_most) / (2.0 * half.y));
    // A flat or single point needs no distance; keep some.
    let depth = depth - 1e-3 * radius_of(&scene.bounds());
    right * (0.5 * (right_most - left_most)) + up * (0.5 * (upper_most - lower_most)) + forward * depth
}

/// The radius of a model, or 1 m for a single point.
fn radius_of(model: &Bounds) -> f64 {
    let radius = model.radius();
    if radius > 0.0 { radius } else { 1.0 }
}
