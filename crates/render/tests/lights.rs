//! What lights reach, against closed forms.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Caster, Cone, Light, LightPosition, Material, Mesh, Object, Scene, Surface};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Method, Renderer};

const SIZE_PX: [u32; 2] = [120, 120];

/// A level floor of 10 m by 10 m, seen from straight above; a pixel is 1 / 12 m.
struct Floor {
    renderer: Renderer,
    casters: Vec<Caster>,
    uploaded: GpuScene,
    camera: Camera,
}

impl Floor {
    fn new() -> Self {
        let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
            .expect("tests need a graphics driver: run scripts/setup.sh");
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0) * 5.0;
        let surface = Surface {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Surface::default()
        };
        let mesh = Mesh::new(surface).expect("a square");
        let scene = Scene {
            objects: vec![Object::new("floor", Arc::new(mesh), DAffine3::IDENTITY)],
            materials: vec![Material::new("grey", Vec3::splat(0.5))],
            ..Scene::default()
        };
        let casters = Caster::of_scene(&scene);
        let uploaded = GpuScene::new(&gpu, &casters, &scene.materials).expect("a small scene");
        let fov_rad = 2.0 * 0.5_f64.atan();
        let eye = DVec3::Z * 10.0;
        let camera = Camera::with_up(eye, DVec3::ZERO, DVec3::Y, fov_rad, 1.0, SIZE_PX).expect("a good camera");
        Self { renderer: Renderer::new(gpu, 1), casters, uploaded, camera }
    }

    fn mask(&self, light: &Light) -> Vec<u8> {
        let drawn = self.renderer.mask(&self.uploaded, &self.casters, &self.camera, light, Method::Auto);
        pollster::block_on(drawn).expect("a mask").verdicts
    }

    /// The red of each pixel.
    fn picture(&self, light: &Light) -> Vec<u8> {
        let look = Look { exposure: 1.0, fade_start_m: f32::MAX, fade_end_m: f32::MAX, fade_center_world: Vec3::ZERO };
        let lights = [light.clone()];
        let drawn = self.renderer.picture(&self.uploaded, &self.casters, &self.camera, &lights, Method::Auto, &look);
        pollster::block_on(drawn).expect("a picture").rgba.chunks_exact(4).map(|pixel| pixel[0]).collect()
    }
}

/// Where on the floor the centre of a pixel is.
fn place(pixel: usize) -> DVec3 {
    let (x, y) = (pixel % SIZE_PX[0] as usize, pixel / SIZE_PX[0] as usize);
    DVec3::new((x as f64 + 0.5) / 12.0 - 5.0, 5.0 - (y as f64 + 0.5) / 12.0, 0.0)
}

fn lamp(height_m: f64) -> Light {
    Light::new("lamp", LightPosition::point(DVec3::Z * height_m), Vec3::splat(4.0))
}

/// `is_lit` says what is right, and how far from being otherwise it is, in any unit of which 1e-5 is little.
fn assert_lit_where(mask: &[u8], is_lit: impl Fn(DVec3) -> f64) -> usize {
    for (pixel, &verdict) in mask.iter().enumerate() {
        let clearance = is_lit(place(pixel));
        let expected = if clearance > 0.0 { 255 } else { 0 };
        assert!(verdict == expected || clearance.abs() < 1e-5, "{verdict} at {}: {clearance}", place(pixel));
    }
    mask.iter().filter(|&&verdict| verdict == 255).count()
}

#[test]
fn a_lamp_lights_a_disc_as_wide_as_its_range() {
    let floor = Floor::new();
    let range_m = 4.0;
    let light = Light { range_m: Some(range_m), ..lamp(3.0) };
    let lit = assert_lit_where(&floor.mask(&light), |p| range_m - p.distance(DVec3::Z * 3.0));
    assert!((lit as f64 / 144.0 - std::f64::consts::PI * 7.0).abs() < 0.3, "{lit} pixels");
    let light = Light { range_m: Some(2.9), ..lamp(3.0) };
    assert!(floor.mask(&light).iter().all(|&verdict| verdict == 0), "the floor is out of reach");
}

#[test]
fn a_spot_light_lights_what_is_in_its_outer_angle() {
    let floor = Floor::new();
    let tilted = DVec3::new(0.6, 0.0, -0.8);
    for (axis, outer_rad) in
        [(DVec3::NEG_Z, 0.5), (tilted, 0.7), (tilted, 0.02), (DVec3::X, std::f64::consts::FRAC_PI_2)]
    {
        let cone = Cone { axis, inner_rad: 0.0, outer_rad };
        let light = Light { cone: Some(cone), ..lamp(3.0) };
        let angle = |p: DVec3| (p - DVec3::Z * 3.0).angle_between(axis);
        let lit = assert_lit_where(&floor.mask(&light), |p| outer_rad - angle(p));
        assert!(lit > 0, "{cone:?}");
    }
    let away = Cone { axis: DVec3::Z, inner_rad: 0.0, outer_rad: std::f64::consts::FRAC_PI_2 };
    let light = Light { cone: Some(away), ..lamp(3.0) };
    assert!(floor.mask(&light).iter().all(|&verdict| verdict == 0), "it shines up, and the floor is below");
}

#[test]
fn a_sun_has_neither_range_nor_cone() {
    let floor = Floor::new();
    let towards = LightPosition::directional(DVec3::new(1.0, 0.0, 1.0)).expect("a direction");
    let cone = Cone { axis: DVec3::Z, inner_rad: 0.0, outer_rad: 0.1 };
    let sun = Light { cone: Some(cone), range_m: Some(0.001), ..Light::new("sun", towards, Vec3::ONE) };
    assert!(floor.mask(&sun).iter().all(|&verdict| verdict == 255));
}

/// Straight under the lamp, a light with a range or a cone gives what one without gives at a known share of the strength.
#[test]
fn range_and_cone_take_away_what_gltf_says() {
    let floor = Floor::new();
    let middle = (SIZE_PX[0] * SIZE_PX[1] / 2 + SIZE_PX[0] / 2) as usize;
    let from_lamp = place(middle) - DVec3::Z * 2.0;
    let share_of = |light: &Light, share: f64| {
        let weaker = Light { strength: light.strength * share as f32, cone: None, range_m: None, ..light.clone() };
        let [given, expected] = [light, &weaker].map(|light| floor.picture(light)[middle]);
        assert!(given.abs_diff(expected) <= 1, "{given} for {expected}, a share of {share}: {light:?}");
    };
    let range_m = 2.5;
    share_of(&Light { range_m: Some(range_m), ..lamp(2.0) }, 1.0 - (from_lamp.length() / range_m).powi(4));
    for axis in [DVec3::new(0.6, 0.0, -0.8), DVec3::new(0.2, 0.1, -1.0).try_normalize().expect("a direction")] {
        let cone = Cone { axis, inner_rad: 0.4, outer_rad: 0.8 };
        let [cos, inner, outer] = [from_lamp.angle_between(axis), 0.4, 0.8].map(f64::cos);
        let ramp = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0);
        share_of(&Light { cone: Some(cone), ..lamp(2.0) }, ramp * ramp);
    }
}
