//! Bodies over a floor, and how much of a light is seen in a picture of them.

use std::f64::consts::FRAC_PI_3;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Camera, Caster, Extent, Light, LightPosition, Material, Mesh, Object, Oracle, Scene, SmoothBody, Sphere, Surface,
    corner_normals, shapes,
};
use umbrae_render::{AdapterChoice, Gpu, GpuError, GpuScene, Renderer, ShadowOptions, Shot, Smooth};

/// Half of the floor's side.
const FLOOR_M: f32 = 200.0;

/// A scene, uploaded.
pub(crate) struct Stage {
    pub(crate) renderer: Renderer,
    pub(crate) casters: Vec<Caster>,
    scene: GpuScene,
}

impl Stage {
    /// Each of `bodies` is a caster of its own, and so is the floor at height 0, the last.
    pub(crate) fn new(bodies: Vec<Surface>) -> Self {
        let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()));
        Self::on(gpu.expect("tests need a graphics driver: run scripts/setup.sh"), bodies, 1)
    }

    /// As [`Stage::new`], on this device, with pictures of so many samples.
    pub(crate) fn on(gpu: Gpu, bodies: Vec<Surface>, samples: u32) -> Self {
        let side = 2.0 * FLOOR_M;
        let floor = shapes::sheet(Vec3::new(-FLOOR_M, -FLOOR_M, 0.0), Vec3::X * side, Vec3::Y * side, [1, 1]);
        let object = |surface| Object::new("body", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
        let objects = bodies.into_iter().chain([floor]).map(object).collect();
        let scene = Scene { objects, materials: vec![Material::default()], ..Scene::default() };
        let casters = Caster::of_scene(&scene);
        let renderer = Renderer::new(gpu, samples);
        let scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        Self { renderer, casters, scene }
    }

    /// Makes smooth bodies of all but the floor.
    pub(crate) fn round_off(&mut self) {
        let (_, bodies) = self.casters.split_last().unwrap();
        let body = |caster: &Caster| Some(SmoothBody::new(caster, &corner_normals(caster, &[], FRAC_PI_3)).unwrap());
        self.scene.give_bodies(bodies.iter().map(body).collect());
    }

    /// The last of the casters.
    pub(crate) fn floor(&self) -> &[Caster] {
        &self.casters[self.casters.len() - 1..]
    }

    /// Row by row from the top.
    pub(crate) fn seen(&self, camera: &Camera, light: &Light) -> Vec<f32> {
        self.seen_past(camera, light, Smooth::Off)
    }

    /// As [`Stage::seen`], past such silhouettes.
    pub(crate) fn seen_past(&self, camera: &Camera, light: &Light, smooth: Smooth) -> Vec<f32> {
        let shadows = ShadowOptions { smooth, ..ShadowOptions::default() };
        self.seen_in(&Shot { shadows, ..self.shot(camera) }, light)
    }

    /// As [`Stage::seen`], past `spheres` too.
    pub(crate) fn seen_past_spheres(&self, camera: &Camera, light: &Light, spheres: &[Sphere]) -> Vec<f32> {
        self.seen_in(&Shot { spheres, ..self.shot(camera) }, light)
    }

    fn shot<'a>(&'a self, camera: &'a Camera) -> Shot<'a> {
        Shot::new(&self.scene, &self.casters, camera, &[])
    }

    fn seen_in(&self, shot: &Shot<'_>, light: &Light) -> Vec<f32> {
        pollster::block_on(self.renderer.visibility(shot, light)).unwrap().seen
    }

    /// The red of the picture under `light`.
    pub(crate) fn picture(&self, camera: &Camera, light: &Light) -> Result<Vec<u8>, GpuError> {
        let lights = std::slice::from_ref(light);
        let shadows = ShadowOptions { soft: true, ..ShadowOptions::default() };
        let shot = Shot { shadows, lights, ..self.shot(camera) };
        let picture = pollster::block_on(self.renderer.picture(&shot))?;
        Ok(picture.rgba.chunks_exact(4).map(|pixel| pixel[0]).collect())
    }

    /// What rays to `side * side` points of the light say; `None` where the surface's own plane cuts through it.
    pub(crate) fn truth(&self, camera: &Camera, light: &Light, side: u32) -> Vec<Option<f64>> {
        let seen = Oracle::new(&self.casters).seen_light(camera, light, side, || ());
        seen.into_iter().map(|seen| Some(seen.filter(|seen| seen.is_above_plane)?.share)).collect()
    }

    /// Asserts that the mean and the worst error are below these.
    pub(crate) fn assert_like_rays(&self, camera: &Camera, light: &Light, (mean, worst): (f64, f64)) {
        let (seen, truth) = (self.seen(camera, light), self.truth(camera, light, 24));
        let width = camera.size_px()[0] as usize;
        let mut errors: Vec<(f64, usize)> = (seen.iter().zip(&truth).enumerate())
            .filter_map(|(i, (&seen, truth))| Some(((f64::from(seen) - truth.as_ref()?).abs(), i)))
            .collect();
        let partly = truth.iter().flatten().filter(|share| (0.05..0.95).contains(*share)).count();
        assert!(partly > 50, "{partly} pixels in the penumbra");
        let found = errors.iter().map(|(error, _)| error).sum::<f64>() / errors.len() as f64;
        errors.sort_by(|a, b| b.0.total_cmp(&a.0));
        let tell = |&(error, i): &(f64, usize)| {
            format!("{error:.3} at {:?}: {} and {:?}", [i % width, i / width], seen[i], truth[i])
        };
        let worst_of: Vec<String> = errors.iter().take(5).map(tell).collect();
        assert!(found < mean && errors[0].0 < worst, "mean {found}, {worst_of:?}");
    }
}

/// `name`d so that silhouettes are kept apart.
pub(crate) fn light(name: &str, position: LightPosition, extent: Extent) -> Light {
    Light { extent, ..Light::new(name, position, Vec3::ONE) }
}

/// The sun 0.533 degrees wide, nearly in the south at this altitude. (In the very south it would be in the plane of walls, and so have two silhouettes.)
pub(crate) fn sun(altitude_rad: f64) -> Light {
    let radius_rad = 0.5 * umbrae_core::SUN_DIAMETER_RAD;
    light("sun", LightPosition::sun(3.4, altitude_rad), Extent::Disc { radius_rad })
}

pub(crate) fn camera(eye: [f64; 3], target: [f64; 3], fov_rad: f64, size_px: [u32; 2]) -> Camera {
    Camera::new(DVec3::from(eye), DVec3::from(target), fov_rad, 2.0, size_px).unwrap()
}

/// From straight above: `across_m` metres of the floor's x about `middle`, north up.
pub(crate) fn above(middle: [f64; 2], across_m: f64, size_px: [u32; 2]) -> Camera {
    let height_m = 130.0;
    let [width, height] = size_px.map(f64::from);
    let fov_rad = 2.0 * (0.5 * across_m * height / width / height_m).atan();
    let at = |z: f64| DVec3::new(middle[0], middle[1], z);
    Camera::with_up(at(height_m), at(0.0), DVec3::Y, fov_rad, 1.0, size_px).unwrap()
}

pub(crate) fn cuboid(min: [f32; 3], max: [f32; 3]) -> Surface {
    shapes::cuboid(Vec3::from(min), Vec3::from(max))
}
