//! Pixel by pixel against the same sum in double precision: no pixel may be off, least of all where an edge passes the light's centre, where the hard
//! count and the edge's sign must agree.

use glam::{DVec3, Vec3};
use umbrae_core::{
    Camera, Caster, Chain, Counting, Extent, Light, LightFace, LightPosition, RayCaster, ShadowVolume, shapes,
};

use crate::stage::{Stage, camera, cuboid, light, sun};

/// The share that is seen of `light` from what each pixel shows, caster by caster as independent quarters would have it if no two overlap; `None` where
/// two do, or where a surface is edge-on to the light.
fn exact(stage: &Stage, camera: &Camera, light: &Light) -> Vec<Option<f64>> {
    let light = light.rounded_to_f32();
    let rays = RayCaster::new(stage.casters.iter().map(|c| (c.positions.as_slice(), c.mesh.triangles())));
    let sides: Vec<Vec<[DVec3; 2]>> = stage.casters.iter().map(|caster| silhouette(caster, &light)).collect();
    let of_one = |caster: &Caster| RayCaster::new([(caster.positions.as_slice(), caster.mesh.triangles())]);
    let casting: Vec<RayCaster> = stage.casters.iter().map(of_one).collect();
    let [width, height] = camera.size_px();
    let pixel = |x: u32, y: u32| {
        let direction = camera.ray_direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let hit = rays.first_hit(camera.eye(), direction, camera.near(), f64::INFINITY)?;
        let point = camera.eye() + direction * hit.t;
        let normal = rays.normal(&hit).normalize_or_zero();
        let normal = if normal.dot(direction) < 0.0 { normal } else { -normal };
        let to_light = light.position.offset_from(point);
        let face = LightFace::new(&light, point)?;
        if normal.dot(to_light.normalize_or_zero()) < 0.02 {
            return None;
        }
        let mut covered: Vec<f64> = Vec::new();
        let end = if light.position.is_directional() { f64::INFINITY } else { 1.0 };
        for (own, sides) in casting.iter().zip(&sides) {
            let hard = f64::from(u8::from(own.is_hit(point, to_light, 1e-5, end)));
            let shares: f64 = sides.iter().map(|&[a, b]| face.edge_share(a, b)).sum();
            // The ray may be wrong about a share that is just not 0 or 1 at the centre, but by no more than one.
            let nearest = [-1.0, 0.0, 1.0].map(|more| hard + shares + more);
            let share = nearest.into_iter().find(|share| (-1e-9..=1.0 + 1e-9).contains(share))?;
            let share = if (0.0..=1.0).contains(&(hard + shares)) { hard + shares } else { share };
            covered.push(share.clamp(0.0, 1.0));
        }
        let partly = covered.iter().filter(|&&share| share > 1e-6).count();
        (partly < 2).then(|| 1.0 - covered.iter().sum::<f64>())
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect()
}

fn silhouette(caster: &Caster, light: &Light) -> Vec<[DVec3; 2]> {
    let chain = Chain::new(caster, light.position, &Counting::outside(caster));
    let position = |i: u32| caster.positions[i as usize].as_dvec3();
    ShadowVolume::new(caster, &chain).sides.iter().map(|side| side.map(position)).collect()
}

/// Returns how many pixels are in the penumbra.
fn assert_without_seams(stage: &Stage, camera: &Camera, light: &Light, bar: f64) -> usize {
    let (seen, exact) = (stage.seen(camera, light), exact(stage, camera, light));
    let width = camera.size_px()[0] as usize;
    let compared: Vec<(usize, f64, f64)> =
        (seen.iter().zip(&exact).enumerate()).filter_map(|(i, (&s, e))| Some((i, f64::from(s), (*e)?))).collect();
    let partly = compared.iter().filter(|(_, _, exact)| (0.02..0.98).contains(exact)).count();
    let mut wrong: Vec<&(usize, f64, f64)> = compared.iter().filter(|(_, s, e)| (s - e).abs() > bar).collect();
    wrong.sort_by(|a, b| (b.1 - b.2).abs().total_cmp(&(a.1 - a.2).abs()));
    let worst = compared.iter().map(|(_, s, e)| (s - e).abs()).fold(0.0, f64::max);
    println!("{}: {partly} partly of {}, worst {worst:.5}", light.name, compared.len());
    let told: Vec<_> = wrong.iter().take(6).map(|(i, s, e)| ([i % width, i / width], s, e)).collect();
    assert!(wrong.is_empty(), "{}: {} wrong of {partly}, {told:?}", light.name, wrong.len());
    partly
}

#[test]
fn no_pixel_is_off_along_the_shadow_of_a_round_body() {
    let stage = Stage::new(vec![shapes::icosphere(Vec3::new(0.0, 0.0, 1.5), 0.8, 3)]);
    let mut partly = 0;
    for eye in [[5.0, -6.0, 6.0], [-7.0, -1.0, 4.0], [1.0, 9.0, 3.0], [0.5, -0.3, 12.0]] {
        let camera = camera(eye, [0.3, 0.5, 0.0], 0.5, [240, 180]);
        let at = LightPosition::point(DVec3::new(-0.8, -1.1, 5.0));
        for radius_m in [0.02, 0.3] {
            partly += assert_without_seams(&stage, &camera, &light("ball", at, Extent::Sphere { radius_m }), 0.01);
        }
        let (half_right, half_up) = (DVec3::Y * 0.3, DVec3::X * 0.2);
        partly +=
            assert_without_seams(&stage, &camera, &light("panel", at, Extent::Rectangle { half_right, half_up }), 0.01);
    }
    assert!(partly > 2000, "{partly} pixels in the penumbra");
}

#[test]
fn no_pixel_is_off_along_the_shadow_of_a_tower_in_the_sun() {
    let stage = Stage::new(vec![cuboid([-4.0, -3.0, 0.0], [4.0, 3.0, 40.0])]);
    let mut partly = 0;
    for (eye, fov) in [([60.0, -30.0, 40.0], 0.6), ([20.0, 70.0, 6.0], 0.5), ([-5.0, 20.0, 120.0], 0.6)] {
        let camera = camera(eye, [3.0, 30.0, 0.0], fov, [320, 240]);
        partly += assert_without_seams(&stage, &camera, &sun(0.6), 0.02);
    }
    assert!(partly > 1000, "{partly} pixels in the penumbra");
}

/// The eye is in the umbra, in the penumbra and close to the caster, where counting is by z-fail.
#[test]
fn no_pixel_is_off_for_an_eye_in_the_shadow() {
    let stage = Stage::new(vec![cuboid([-1.0, -1.0, 1.0], [1.0, 1.0, 1.3])]);
    let at = LightPosition::point(DVec3::new(0.2, 0.3, 4.0));
    let light = light("ball", at, Extent::Sphere { radius_m: 0.3 });
    let mut partly = 0;
    for eye in [[0.3, -0.2, 0.9], [1.4, 0.1, 0.6], [1.7, 1.6, 0.1], [0.9, 0.9, 1.8]] {
        let camera = Camera::new(DVec3::from(eye), DVec3::new(2.5, 0.3, 0.0), 1.2, 0.05, [160, 120]).unwrap();
        partly += assert_without_seams(&stage, &camera, &light, 0.01);
    }
    assert!(partly > 1000, "{partly} pixels in the penumbra");
}
