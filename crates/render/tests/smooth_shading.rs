//! Balls and rings of a few triangles that are shaded as if they were round, against closed forms and rays.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Camera, Caster, Light, LightPosition, Material, Mesh, Object, Oracle, RayCaster, Role, Scene, Surface, Verdict,
    shapes,
};
use umbrae_render::{
    AdapterChoice, Gpu, GpuPoser, GpuScene, Method, Renderer, ShadowOptions, Shot, SilhouetteSource, Tier, compare,
};

const SIZE_PX: [u32; 2] = [160, 120];

/// As a cosine: nearer to a right angle to the light than that, rounding of interpolated normals decides for the sun; for a lamp whose distance
/// is some radii, also how far the triangles are from the sphere.
const NEAR_RIGHT_ANGLE: [f64; 2] = [1e-3, 0.05];

fn renderer() -> Renderer {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    Renderer::new(gpu, 1)
}

fn object(surface: Surface, role: Role) -> Object {
    Object { role, ..Object::new("", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY) }
}

fn scene_of(objects: Vec<Object>) -> Scene {
    Scene { objects, materials: vec![Material::new("", Vec3::ONE)], ..Scene::default() }
}

/// Has `caster` shaded with the normals that `normal_at` says its surface has at its corners.
fn curve(caster: &mut Caster, normal_at: impl Fn(DVec3) -> DVec3) {
    let normal = |p: Vec3| normal_at(p.as_dvec3()).as_vec3();
    caster.shading_normals = (0..caster.mesh.triangles().len()).map(|t| caster.corners(t).map(normal)).collect();
}

fn from_origin(p: DVec3) -> DVec3 {
    p.normalize_or_zero()
}

/// 80 triangles about the origin that shade nothing, flat or as a round ball.
fn ball(is_round: bool) -> (Scene, Vec<Caster>) {
    let role = Role { casts: false, ..Role::default() };
    let scene = scene_of(vec![object(shapes::icosphere(Vec3::ZERO, 1.0, 1), role)]);
    let mut casters = Caster::of_scene(&scene);
    if is_round {
        curve(&mut casters[0], from_origin);
    }
    (scene, casters)
}

fn camera() -> Camera {
    Camera::new(DVec3::new(2.5, -2.0, 1.5), DVec3::ZERO, 0.7, 0.05, SIZE_PX).unwrap()
}

fn lights(strength: f32) -> [Light; 2] {
    let lamp = LightPosition::point(DVec3::new(-0.5, -1.8, 0.7));
    let sun = LightPosition::directional(DVec3::new(-0.3, -0.9, 0.5)).unwrap();
    [("sun", sun), ("lamp", lamp)].map(|(name, position)| Light::new(name, position, Vec3::splat(strength)))
}

/// Where the ray through each pixel's centre meets the triangles; `None` where it misses.
fn seen_points(casters: &[Caster], camera: &Camera) -> Vec<Option<DVec3>> {
    let rays = RayCaster::new(casters.iter().map(|caster| (caster.positions.as_slice(), caster.mesh.triangles())));
    let [width, height] = SIZE_PX;
    let point = |x: u32, y: u32| {
        let direction = camera.ray_direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let hit = rays.first_hit(camera.eye(), direction, camera.near(), f64::INFINITY)?;
        Some(camera.eye() + direction * hit.t)
    };
    (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).map(|[x, y]| point(x, y)).collect()
}

fn cosine(normal: DVec3, to_light: DVec3) -> f64 {
    normal.dot(to_light.normalize_or_zero())
}

#[test]
fn a_coarse_ball_is_lit_up_to_the_terminator_of_a_sphere() {
    let renderer = renderer();
    for (light, near_right_angle) in lights(1.0).into_iter().zip(NEAR_RIGHT_ANGLE) {
        let wrong = [true, false].map(|is_round| {
            let (scene, casters) = ball(is_round);
            let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
            let camera = camera();
            let mask = pollster::block_on(renderer.mask(&Shot::new(&drawn, &casters, &camera, &[]), &light)).unwrap();
            let is_wrong = |(verdict, point): &(&u8, Option<DVec3>)| {
                point.is_some_and(|p| {
                    let on_sphere = from_origin(p);
                    let cosine = cosine(on_sphere, light.position.offset_from(on_sphere));
                    cosine.abs() > near_right_angle && **verdict != if cosine > 0.0 { 255 } else { 0 }
                })
            };
            let [wrong, ball] = [true, false].map(|only_wrong| {
                let pixels = mask.verdicts.iter().zip(seen_points(&casters, &camera));
                pixels.filter(|pixel| if only_wrong { is_wrong(pixel) } else { pixel.1.is_some() }).count()
            });
            assert!(ball > 4000, "{ball} pixels of the ball");
            wrong
        });
        // Where a pixel's centre is on the ball's outline, the ray and the rasteriser may see different triangles.
        assert!(wrong[0] <= 4 && wrong[1] > 100, "{}: {wrong:?} pixels are wrong, round and flat", light.name);
    }
}

/// Silhouettes of smooth bodies go where corners are lit on one side and not on the other: what is lit must not reach beyond.
#[test]
fn a_lamp_over_a_triangle_but_within_the_round_ball_lights_nothing_of_it() {
    let renderer = renderer();
    let lit = [true, false].map(|is_round| {
        let (scene, casters) = ball(is_round);
        let middle = casters[0].corners(0).iter().sum::<Vec3>().as_dvec3() / 3.0;
        let lamp = middle * (0.98 / middle.length());
        assert!(middle.length() < 0.96, "the lamp is over the triangle");
        let light = Light::new("lamp", LightPosition::point(lamp), Vec3::ONE);
        let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        let camera = Camera::new(middle * 4.0, DVec3::ZERO, 0.7, 0.05, SIZE_PX).unwrap();
        let mask = pollster::block_on(renderer.mask(&Shot::new(&drawn, &casters, &camera, &[]), &light)).unwrap();
        let judged = Oracle::new(&casters).judge(&camera, &[light], || ()).remove(0);
        assert_eq!(compare(&mask.verdicts, &judged).errors, []);
        mask.verdicts.iter().filter(|&&verdict| verdict == 255).count()
    });
    assert!(lit[0] == 0 && lit[1] > 300, "{lit:?} pixels are lit, round and flat");
}

/// What a picture's byte was before tone mapping, which takes 0.04 off colours of medium brightness.
fn radiance(byte: u8) -> f64 {
    let c = f64::from(byte) / 255.0;
    0.04 + if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn a_coarse_ball_is_as_bright_at_each_pixel_as_a_sphere_with_the_normal_there() {
    const STRENGTH: f64 = 0.35;
    /// Two steps of a byte where these are widest, relative to the light.
    const TOLERANCE: f64 = 0.02 / STRENGTH;
    let renderer = renderer();
    let [sun, _] = lights(STRENGTH as f32);
    let camera = camera();
    let worst = [true, false].map(|is_round| {
        let (scene, casters) = ball(is_round);
        let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
        let picture = |lights: &[Light]| {
            pollster::block_on(renderer.picture(&Shot::new(&drawn, &casters, &camera, lights))).unwrap().rgba
        };
        let (with, without) = (picture(std::slice::from_ref(&sun)), picture(&[]));
        let mut differences = Vec::new();
        for (pixel, point) in seen_points(&casters, &camera).into_iter().enumerate() {
            let Some(point) = point else { continue };
            let given = (radiance(with[4 * pixel]) - radiance(without[4 * pixel])) / STRENGTH;
            let expected = cosine(from_origin(point), sun.position.offset_from(point)).max(0.0);
            differences.push((given - expected).abs());
        }
        differences.sort_by(f64::total_cmp);
        // All but some on the outline, half of whose pixels a ray may see and the rasteriser not.
        differences[differences.len() * 99 / 100]
    });
    assert!(worst[0] < TOLERANCE && worst[1] > 3.0 * TOLERANCE, "{worst:?}, round and flat");
}

/// A round ball, a round ring and a flat box that cast on each other and on a floor.
fn company() -> (Scene, Vec<Caster>) {
    let role = Role::default();
    let ring = Vec3::new(2.2, 0.3, 0.9);
    let scene = scene_of(vec![
        object(shapes::icosphere(Vec3::ZERO, 1.0, 1), role),
        object(shapes::torus(ring, 0.8, 0.35, 9, 6), role),
        object(shapes::cuboid(Vec3::new(-1.5, -2.0, -0.5), Vec3::new(-0.7, -1.2, 1.5)), role),
        object(shapes::sheet(Vec3::new(-6.0, -6.0, -1.1), Vec3::X * 12.0, Vec3::Y * 12.0, [3, 3]), role),
    ]);
    let mut casters = Caster::of_scene(&scene);
    curve(&mut casters[0], from_origin);
    curve(&mut casters[1], |p| {
        let p = p - ring.as_dvec3();
        let spine = 0.8 * p.with_z(0.0).normalize_or_zero();
        (p - spine).normalize_or_zero()
    });
    (scene, casters)
}

#[test]
fn every_decided_pixel_of_round_bodies_is_right_whoever_finds_the_silhouettes() {
    let renderer = renderer();
    let (scene, casters) = company();
    let flat = Caster::of_scene(&scene);
    let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let lights = [
        LightPosition::directional(DVec3::new(-0.3, -0.9, 0.5)).unwrap(),
        LightPosition::point(DVec3::new(-2.5, 1.5, 2.5)),
        LightPosition::point(DVec3::new(2.2, 0.3, 1.0)),
    ]
    .map(|position| Light::new("light", position, Vec3::ONE));
    let (mut pixels, mut decided, mut rounded_off) = (0, 0, 0);
    // The last from within the ball, whose back is seen.
    for eye in [DVec3::new(5.0, -4.0, 3.0), DVec3::new(-3.0, -5.0, 0.5), DVec3::new(0.3, 0.2, 0.1)] {
        let camera = Camera::new(eye, DVec3::new(0.5, 0.0, 0.0), 0.8, 0.05, SIZE_PX).unwrap();
        let judged = Oracle::new(&casters).judge(&camera, &lights, || ());
        let judged_flat = Oracle::new(&flat).judge(&camera, &lights, || ());
        for ((light, judgements), judged_flat) in lights.iter().zip(&judged).zip(&judged_flat) {
            let sources = [SilhouetteSource::Auto, SilhouetteSource::Gpu, SilhouetteSource::GpuBasic];
            for (method, silhouettes) in [Method::Auto, Method::ZFail].into_iter().flat_map(|m| sources.map(|s| (m, s)))
            {
                let shadows = ShadowOptions { silhouettes, ..ShadowOptions::from(method) };
                let shot = Shot { shadows, ..Shot::new(&drawn, &casters, &camera, &[]) };
                let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
                let comparison = compare(&mask.verdicts, judgements);
                assert_eq!(comparison.errors, [], "{eye}, {light:?}, {method:?}, {silhouettes:?}");
                pixels += comparison.surface;
                decided += comparison.decided;
            }
            let darkened = |(round, flat): &(&umbrae_core::Judgement, &umbrae_core::Judgement)| {
                round.verdict == Some(Verdict::Dark) && flat.verdict == Some(Verdict::Lit)
            };
            rounded_off += judgements.iter().zip(judged_flat).filter(darkened).count();
        }
    }
    assert!(decided * 10 > pixels * 8, "{decided} of {pixels} pixels are decided");
    assert!(rounded_off > 150, "{rounded_off} pixels are darker than if they were flat");
}

#[test]
fn a_triangle_without_a_normal_at_some_corner_is_flat_to_the_bit() {
    let renderer = renderer();
    let (scene, flat) = ball(false);
    let (_, mut casters) = ball(true);
    for (t, normals) in casters[0].shading_normals.iter_mut().enumerate() {
        normals[t % 3] = if t % 2 == 0 { Vec3::ZERO } else { Vec3::NAN };
    }
    let camera = camera();
    let lights = lights(0.5);
    let picture = |casters: &[Caster]| {
        let drawn = GpuScene::new(renderer.gpu(), casters, &scene.materials, &scene.textures).unwrap();
        pollster::block_on(renderer.picture(&Shot::new(&drawn, casters, &camera, &lights))).unwrap().rgba
    };
    assert!(picture(&casters) == picture(&flat));
    assert!(picture(&ball(true).1) != picture(&flat));
}

#[test]
fn normals_may_come_and_go_with_an_update() {
    let renderer = renderer();
    let (scene, flat) = ball(false);
    let (_, round) = ball(true);
    let camera = camera();
    let lights = lights(0.5);
    let mut drawn = GpuScene::new(renderer.gpu(), &flat, &scene.materials, &scene.textures).unwrap();
    let picture = |drawn: &GpuScene| {
        pollster::block_on(renderer.picture(&Shot::new(drawn, &flat, &camera, &lights))).unwrap().rgba
    };
    let expected_flat = picture(&drawn);
    let of_round = GpuScene::new(renderer.gpu(), &round, &scene.materials, &scene.textures).unwrap();
    let expected_round = picture(&of_round);
    assert!(expected_flat != expected_round);
    for (casters, expected) in [(&round, &expected_round), (&flat, &expected_flat), (&round, &expected_round)] {
        drawn.update(renderer.gpu(), casters, &scene.materials);
        assert!(picture(&drawn) == *expected);
    }
}

#[test]
fn what_the_gpu_moves_is_flat() {
    let renderer = renderer();
    if renderer.gpu().caps.tier != Tier::Full {
        return;
    }
    let (scene, mut casters) = ball(true);
    let (_, flat) = ball(false);
    let camera = camera();
    let [sun, _] = lights(1.0);
    let mask = |drawn: &GpuScene| {
        pollster::block_on(renderer.mask(&Shot::new(drawn, &flat, &camera, &[]), &sun)).unwrap().verdicts
    };
    let gpu = renderer.gpu();
    let mut drawn = GpuScene::new(gpu, &casters, &scene.materials, &scene.textures).unwrap();
    let expected = mask(&GpuScene::new(gpu, &flat, &scene.materials, &scene.textures).unwrap());
    assert!(mask(&drawn) != expected, "it was round");
    let mut poser = GpuPoser::new(gpu, &scene.objects, &casters, &drawn).unwrap();
    pollster::block_on(poser.pose(gpu, &mut drawn, &scene.objects, &mut casters)).unwrap();
    assert!(casters[0].shading_normals.is_empty());
    assert!(mask(&drawn) == expected);
    // Round again, with the normals of where it is.
    curve(&mut casters[0], from_origin);
    drawn.update(gpu, &casters, &scene.materials);
    assert!(mask(&drawn) != expected);
}
