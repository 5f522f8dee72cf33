//! Smooth silhouettes that are found on the GPU: the same as on the CPU within epsilon, closed bit for bit, and drawn into the same masks but at their edges.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Bounds, Camera, Caster, Deformer, Influence, Light, LightPosition, Material, Mesh, Object, Pose, Precision,
    RayCaster, Scene, ShadowVolume, SmoothBody, SmoothVolume, Smoothness, Surface, corner_normals, shapes,
};
use umbrae_render::{
    AdapterChoice, Fate, FoundSmoothSilhouette, Gpu, GpuPoser, GpuScene, Method, Renderer, ShadowCasters,
    ShadowOptions, ShadowTarget, Shadows, Shot, SilhouetteSource, Smooth,
};

const CREASE_RAD: f64 = 0.76;
const EPSILON_M: f64 = 1e-3;

/// One test at a time: a driver in software compiles each shader once then, for all.
static TURN: Mutex<()> = Mutex::new(());

fn turn() -> MutexGuard<'static, ()> {
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

fn gpu() -> Gpu {
    pollster::block_on(Gpu::new(&AdapterChoice::default())).expect("tests need a graphics driver: run scripts/setup.sh")
}

fn object(surface: Surface) -> Object {
    Object::new("", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY)
}

fn scene_of(objects: Vec<Object>) -> Scene {
    Scene { objects, materials: vec![Material::default()], ..Scene::default() }
}

fn bodies() -> Vec<(&'static str, Surface)> {
    vec![
        ("sphere", shapes::icosphere(Vec3::ZERO, 1.0, 2)),
        ("torus", shapes::torus(Vec3::ZERO, 1.5, 0.5, 12, 8)),
        ("cylinder", shapes::cylinder(Vec3::ZERO, 1.0, 2.0, 12)),
        ("cone", shapes::cone(Vec3::ZERO, 0.5, 1.5, 12)),
        ("tube", shapes::tube(&[Vec3::ZERO, Vec3::X, Vec3::new(1.5, 1.0, 0.5)], 0.3, 10)),
    ]
}

fn body_of(caster: &Caster) -> SmoothBody {
    SmoothBody::new(caster, &corner_normals(caster, &[], CREASE_RAD)).unwrap()
}

/// Suns, and lamps near and far, none of them in the box of a body.
fn lights() -> Vec<Light> {
    let light = |i: usize| {
        let (sin, cos) = (0.7 * i as f64 + 0.05).sin_cos();
        let way = DVec3::new(cos, sin, 0.17 * (i % 11) as f64 - 0.83);
        let position = match i % 3 {
            0 => LightPosition::directional(way).unwrap(),
            1 => LightPosition::point(30.0 * way),
            _ => LightPosition::point(4.3 * way),
        };
        Light::new(format!("light {i}"), position, Vec3::ONE).rounded_to_f32()
    };
    (0..18).map(light).collect()
}

fn far_camera() -> Camera {
    Camera::new(DVec3::new(70.0, 10.0, 5.0), DVec3::ZERO, 0.3, 0.05, [64, 48]).unwrap()
}

fn curved(epsilon_m: f64) -> Smooth {
    Smooth::Curved { epsilon_m, epsilon_px: None }
}

/// What is found of the bodies of `casters` under all lights in each of these ways, with z-fail, so that caps are found too.
fn find(
    gpu: &Gpu,
    casters: &[Caster],
    uploaded: &ShadowCasters,
    ways: &[Smooth],
) -> Vec<(Smooth, Vec<FoundSmoothSilhouette>)> {
    let target = ShadowTarget { depth_stencil_format: gpu.caps.depth_stencil_format, samples: 1, color_formats: &[] };
    let shadows = Shadows::new(gpu, &target);
    let mut found = shadows.finder(gpu, casters, uploaded, SilhouetteSource::Gpu).unwrap();
    let view = shadows.view(gpu, casters, &far_camera());
    let positions: Vec<Vec<Vec3>> = casters.iter().map(|caster| caster.positions.clone()).collect();
    let mut in_way = |&smooth: &Smooth| {
        let silhouettes = SilhouetteSource::Gpu;
        let options = ShadowOptions { silhouettes, smooth, ..ShadowOptions::without_culling(Method::ZFail) };
        found.plan(gpu, casters, uploaded, &view, &lights(), &options);
        found.upload(gpu).unwrap();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        found.record(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let silhouettes = pollster::block_on(found.read_smooth(gpu, casters, &positions)).unwrap();
        assert_eq!(silhouettes.len(), lights().len() * casters.len(), "no light is in a box");
        (smooth, silhouettes)
    };
    ways.iter().map(&mut in_way).collect()
}

/// Of bodies that stand where they were made.
fn find_standing(
    gpu: &Gpu,
    casters: &[Caster],
    bodies: &[SmoothBody],
    ways: &[Smooth],
) -> Vec<(Smooth, Vec<FoundSmoothSilhouette>)> {
    let mut uploaded = ShadowCasters::new(gpu, casters).unwrap();
    for (i, body) in bodies.iter().enumerate() {
        uploaded.give_body(i, body.clone());
    }
    find(gpu, casters, &uploaded, ways)
}

fn casters() -> Vec<Caster> {
    Caster::of_scene(&scene_of(bodies().into_iter().map(|(_, surface)| object(surface)).collect()))
}

/// How far the worst of the ends of `ours` is from the segments of `theirs`.
fn farthest(ours: &[[Vec3; 2]], theirs: &[[Vec3; 2]]) -> f64 {
    let distance = |p: DVec3, [a, b]: [Vec3; 2]| {
        let (a, b) = (a.as_dvec3(), b.as_dvec3());
        let along = b - a;
        let share = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        p.distance(a + along * share)
    };
    let nearest = |p: &Vec3| theirs.iter().map(|&side| distance(p.as_dvec3(), side)).fold(f64::INFINITY, f64::min);
    ours.as_flattened().iter().map(nearest).fold(0.0, f64::max)
}

fn sides_of(volume: &SmoothVolume) -> Vec<[Vec3; 2]> {
    volume.sides.iter().map(|side| side.map(|p| volume.points[p as usize])).collect()
}

/// The boundary of caps and faces less the sides, edge by edge, by the bits of their ends.
fn gaps(found: &FoundSmoothSilhouette) -> usize {
    type Bits = [u32; 3];
    let mut sums: BTreeMap<[Bits; 2], i32> = BTreeMap::new();
    let mut add = |from: Vec3, to: Vec3, times: i32| {
        let [from, to] = [from, to].map(|p| p.to_array().map(f32::to_bits));
        if from != to {
            let (edge, times) = if from < to { ([from, to], times) } else { ([to, from], -times) };
            *sums.entry(edge).or_default() += times;
        }
    };
    for &[a, b, c] in found.caps.iter().chain(&found.faces) {
        [(a, b), (b, c), (c, a)].into_iter().for_each(|(from, to)| add(from, to, 1));
    }
    found.sides.iter().for_each(|&[from, to]| add(from, to, -1));
    sums.values().filter(|times| **times != 0).count()
}

/// What was found, as a volume with points of its own.
fn volume_of(found: &FoundSmoothSilhouette) -> (Vec<Vec3>, ShadowVolume) {
    let mut positions: Vec<Vec3> = Vec::new();
    let mut name = |p: Vec3| {
        positions.push(p);
        positions.len() as u32 - 1
    };
    let light_cap: Vec<[u32; 3]> = found.caps.iter().chain(&found.faces).map(|face| face.map(&mut name)).collect();
    let sides = found.sides.iter().map(|side| side.map(&mut name)).collect();
    let most_triangles = light_cap.len();
    (positions, ShadowVolume { sides, light_cap, most_triangles })
}

/// Checks that `found` has the points that the CPU has of `body`, where `caster` is, within epsilon, and casts its shadow: counts behind it are 0 in the same places.
/// The CPU leaves pieces on the wrong side of the silhouette where they are if nothing is lit behind them; where it has left none, the silhouette is the same within
/// epsilon, and how far it is off is returned.
fn compared(
    found: &FoundSmoothSilhouette,
    (body, caster): (&SmoothBody, &Caster),
    smoothness: &Smoothness,
    random: &mut impl FnMut() -> f32,
) -> Option<f64> {
    let light = lights()[found.light].position;
    let volume = SmoothVolume::new(body, light, smoothness);
    let (ours, theirs) = (volume_of(found), volume.flattened(body, caster));
    let center = caster.bounds.center();
    let way = light.offset_from(center).normalize_or_zero();
    let mut dark = 0;
    for _ in 0..100 {
        let beside = DVec3::new(random().into(), random().into(), random().into()) * caster.bounds.radius();
        let behind = center + beside - way * (way.dot(beside) + 7.0);
        let count = |(positions, volume): &(Vec<Vec3>, ShadowVolume)| {
            volume.count_to_infinity(positions, light, behind, DVec3::new(0.3, 0.2, 0.1))
        };
        let (Some(ours), Some(theirs)) = (count(&ours), count(&theirs)) else { continue };
        let where_it_is = format!("body {} under light {}, at {behind}", found.caster, found.light);
        assert!((ours > 0) == (theirs > 0) && ours >= theirs, "{ours} for {theirs}: {where_it_is}");
        dark += usize::from(ours > 0);
    }
    assert!(dark > 0, "body {} casts a shadow under light {}", found.caster, found.light);
    let found_points = found.faces.as_flattened().iter().chain(found.sides.as_flattened());
    let found_points: Vec<Vec3> = found_points.copied().collect();
    let nearest = |p: &Vec3| found_points.iter().map(|q| q.distance(*p)).fold(f32::INFINITY, f32::min);
    let closing: Vec<[u32; 3]> = volume.closing().collect();
    let used = closing.as_flattened().iter().chain(volume.sides.as_flattened());
    let off = used.map(|&p| nearest(&volume.points[p as usize])).fold(0.0, f32::max);
    assert!(f64::from(off) < EPSILON_M, "body {} under light {}: a point is {off} m off", found.caster, found.light);
    let sides = sides_of(&volume);
    assert!(!found.is_coarse && !found.sides.is_empty());
    if found.sides.len() != sides.len() || found.faces.len() != volume.closing().len() {
        return None;
    }
    let off = farthest(&found.sides, &sides).max(farthest(&sides, &found.sides));
    assert!(off < EPSILON_M, "body {} under light {}, {smoothness:?}: {off} m off", found.caster, found.light);
    Some(off)
}

#[test]
fn silhouettes_are_those_of_the_cpu_within_epsilon() {
    let _turn = turn();
    let gpu = gpu();
    let casters = casters();
    let bodies: Vec<SmoothBody> = casters.iter().map(body_of).collect();
    let mut random = random();
    for (smooth, found) in find_standing(&gpu, &casters, &bodies, &[Smooth::Accurate, curved(EPSILON_M)]) {
        let (smoothness, least) = match smooth {
            Smooth::Accurate => (Smoothness::Accurate, found.len()),
            _ => (Smoothness::Smooth(Precision::in_world(EPSILON_M)), 18),
        };
        let compared = |found| {
            let of = &found as &FoundSmoothSilhouette;
            compared(of, (&bodies[of.caster], &casters[of.caster]), &smoothness, &mut random)
        };
        let off: Vec<f64> = found.into_iter().filter_map(compared).collect();
        assert!(off.len() >= least, "{smooth:?}: {} are the same, and {least} were to be", off.len());
        println!("{smooth:?}: {} the same, at most {:.1e} m off", off.len(), off.iter().copied().fold(0.0, f64::max));
    }
}

#[test]
fn volumes_are_closed_bit_for_bit() {
    let _turn = turn();
    let gpu = gpu();
    let casters = casters();
    let bodies: Vec<SmoothBody> = casters.iter().map(body_of).collect();
    let ways = [Smooth::Accurate, curved(0.01), curved(1e-4), curved(1e-9)];
    for (smooth, found) in find_standing(&gpu, &casters, &bodies, &ways) {
        // What there is no room for is coarser, and as closed.
        assert_eq!(found.iter().any(|found| found.is_coarse), smooth == curved(1e-9));
        for found in found {
            assert_eq!(gaps(&found), 0, "body {} under light {}, {smooth:?}", found.caster, found.light);
            assert!(!found.caps.is_empty() && found.is_fail);
        }
    }
}

/// Numbers from -1 to 1, the same on every run.
fn random() -> impl FnMut() -> f32 {
    let mut seed = 1_u64;
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    }
}

#[test]
fn random_normals_leave_volumes_closed() {
    let _turn = turn();
    let gpu = gpu();
    let mut random = random();
    let casters = casters();
    let mut body = |caster: &Caster| {
        let normals: Vec<[Vec3; 3]> = (0..caster.mesh.triangles().len())
            .map(|_| std::array::from_fn(|_| Vec3::new(random(), random(), random()).normalize_or_zero()))
            .collect();
        SmoothBody::new(caster, &normals).unwrap()
    };
    let bodies: Vec<SmoothBody> = casters.iter().map(&mut body).collect();
    for (smooth, found) in find_standing(&gpu, &casters, &bodies, &[curved(0.01)]) {
        for found in found {
            assert_eq!(gaps(&found), 0, "body {} under light {}, {smooth:?}", found.caster, found.light);
        }
    }
}

/// The bodies in a row above a ground that casts nothing.
fn on_ground() -> (Scene, Vec<Caster>, Vec<Option<SmoothBody>>) {
    let mut ground = object(shapes::sheet(Vec3::new(-8.0, -9.0, -2.5), Vec3::X * 20.0, Vec3::Y * 20.0, [1, 1]));
    ground.role.casts = false;
    let mut objects = vec![ground];
    for (i, (_, surface)) in bodies().into_iter().enumerate() {
        let at = DVec3::new(3.4 * (i % 3) as f64 - 3.0, 3.4 * (i / 3) as f64 - 1.0, 0.0);
        objects.push(Object { world_from_object: DAffine3::from_translation(at), ..object(surface) });
    }
    let scene = scene_of(objects);
    let casters = Caster::of_scene(&scene);
    let bodies = (0..casters.len()).map(|i| (i > 0).then(|| body_of(&casters[i]))).collect();
    (scene, casters, bodies)
}

const SIZE_PX: [u32; 2] = [240, 180];

/// Of each pixel on a body the cosine between its normal there and the light, from 0 to 1; infinite on others.
fn cosines(casters: &[Caster], camera: &Camera, light: &Light) -> Vec<f64> {
    let rays = RayCaster::new(casters.iter().map(|caster| (caster.positions.as_slice(), caster.mesh.triangles())));
    let normals: Vec<Vec<[Vec3; 3]>> = casters.iter().map(|caster| corner_normals(caster, &[], CREASE_RAD)).collect();
    let cosine = |i: u32| {
        let [x, y] = [i % SIZE_PX[0], i / SIZE_PX[0]].map(|px| f64::from(px) + 0.5);
        let direction = camera.ray_direction(x, y);
        let Some(hit) = rays.first_hit(camera.eye(), direction, 0.0, f64::INFINITY) else { return f64::INFINITY };
        let part = hit.part as usize;
        let place = camera.eye() + direction * hit.t;
        let [a, b, c] = rays.corners(&hit);
        let doubled = (b - a).cross(c - a);
        let share = |p: DVec3, q: DVec3| (p - place).cross(q - place).dot(doubled);
        let shares = [share(b, c), share(c, a), share(a, b)];
        let corners = normals[part][hit.triangle as usize];
        let normal: DVec3 = corners.iter().zip(shares).map(|(normal, share)| normal.as_dvec3() * share).sum();
        let cosine = normal.normalize_or_zero().dot(light.position.offset_from(place).normalize_or_zero());
        if casters[part].role.casts { cosine.abs() } else { f64::INFINITY }
    };
    (0..SIZE_PX[0] * SIZE_PX[1]).map(cosine).collect()
}

/// How many pixels differ, and of those how many are not next to an edge of `theirs`; `cosines` are those to the light.
///
/// A piece of a triangle that is on the wrong side of a silhouette shades what is just behind it. Of those behind which nothing is lit, only the GPU takes notice:
/// what is nearly edge on may be darker for it. Where rounding cuts it otherwise, a pixel may be brighter, but few are, and by no more than a hundredth of the light.
fn differing(ours: &[u8], theirs: &[u8], cosines: &[f64]) -> [usize; 2] {
    const MOST_DARKENED: f64 = 0.15;
    const MOST_LIT: f64 = 0.01;
    const MOST_PIXELS_LIT: usize = 2;
    let [width, height] = SIZE_PX.map(i64::from);
    let at = |x: i64, y: i64| theirs[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize];
    let (mut all, mut inner, mut lit) = (0, 0, 0);
    for y in 0..height {
        for x in 0..width {
            let (i, own) = ((y * width + x) as usize, at(x, y));
            if ours[i] != own {
                all += 1;
                let is_at_edge = (-1..=1).any(|j| (-1..=1).any(|i| at(x + i, y + j) != own));
                let most = if ours[i] == 0 { MOST_DARKENED } else { MOST_LIT };
                inner += usize::from(!is_at_edge && cosines[i] > most);
                lit += usize::from(!is_at_edge && ours[i] != 0);
            }
        }
    }
    [all, inner + if lit > MOST_PIXELS_LIT { lit } else { 0 }]
}

fn cameras() -> [Camera; 3] {
    let look = |eye, target, near| Camera::new(eye, target, 0.9, near, SIZE_PX).unwrap();
    [
        look(DVec3::new(6.0, -11.0, 6.0), DVec3::new(1.0, 0.5, -0.8), 0.05),
        // In shadow, and with a near rectangle that is partly in shadow.
        look(DVec3::new(-3.0, -1.0, -1.6), DVec3::new(3.0, 3.0, -2.0), 0.05),
        look(DVec3::new(-3.9, -2.0, -1.2), DVec3::new(1.0, 3.0, -1.5), 0.6),
    ]
}

fn lights_on_ground() -> Vec<Light> {
    let sun = |way: DVec3| LightPosition::directional(way).unwrap();
    let positions = [
        sun(DVec3::new(0.1, 0.05, 1.0)),
        sun(DVec3::new(-0.8, 0.5, 0.45)),
        LightPosition::point(DVec3::new(0.5, 0.8, 4.0)),
        LightPosition::point(DVec3::new(-6.0, 3.0, 1.6)),
    ];
    positions.map(|position| Light::new("light", position, Vec3::ONE)).to_vec()
}

fn mask(
    renderer: &Renderer,
    scene: &GpuScene,
    casters: &[Caster],
    camera: &Camera,
    light: &Light,
    shadows: ShadowOptions,
) -> Vec<u8> {
    let shot = Shot { shadows, ..Shot::new(scene, casters, camera, &[]) };
    let mask = pollster::block_on(renderer.mask(&shot, light)).unwrap();
    if shadows.silhouettes == SilhouetteSource::Gpu {
        let is_drawn = |fate| matches!(fate, Fate::DrawnAsFound | Fate::Drawn { .. });
        assert!(mask.light.casters.iter().any(|caster| is_drawn(caster.fate)));
    }
    mask.verdicts
}

#[test]
fn masks_are_those_of_the_cpu_but_at_their_edges() {
    let _turn = turn();
    let renderer = Renderer::new(gpu(), 1);
    let (scene, casters, bodies) = on_ground();
    let mut drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &[]).unwrap();
    drawn.give_bodies(bodies);
    let mut shaded = 0;
    let kinds = [Smooth::Accurate, curved(0.005), Smooth::Curved { epsilon_m: 0.1, epsilon_px: Some(0.5) }];
    for (k, smooth) in kinds.into_iter().enumerate() {
        for method in [Method::Auto, Method::ZFail] {
            for (c, camera) in cameras().iter().enumerate() {
                for (l, light) in lights_on_ground().iter().enumerate() {
                    // Each camera has each light, and each kind each of both: a mask takes seconds in software.
                    if (k + c + l) % 3 != 0 {
                        continue;
                    }
                    let options =
                        |silhouettes| ShadowOptions { silhouettes, smooth, method, ..ShadowOptions::default() };
                    let of = |source| mask(&renderer, &drawn, &casters, camera, light, options(source));
                    let (ours, theirs) = (of(SilhouetteSource::Gpu), of(SilhouetteSource::Auto));
                    let [all, inner] = differing(&ours, &theirs, &cosines(&casters, camera, light));
                    let edges = ours.len() / 50;
                    assert!(
                        inner == 0 && all < edges,
                        "{all} pixels differ, {inner} of them in the midst: camera {c}, light {l}, {method:?}, {smooth:?}"
                    );
                    shaded += theirs.iter().filter(|verdict| **verdict == 0).count();
                }
            }
        }
    }
    assert!(shaded > 30_000, "{shaded} pixels are in shadow");
}

/// A body whose vertices are moved in and out, and one whose normals are tilted: many of their triangles show the light what their normals do not.
fn rough_bodies() -> Vec<(Surface, f32)> {
    let mut rough = shapes::icosphere(Vec3::ZERO, 1.0, 3);
    let mut random = random();
    rough.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.05 * random());
    vec![(rough, 0.0), (shapes::icosphere(Vec3::ZERO, 1.0, 2), 2.0)]
}

/// Its normals tilted by so much, each as its vertex has it.
fn tilted(caster: &Caster, by: f32) -> SmoothBody {
    let mut random = random();
    let tilts: Vec<Vec3> = caster.positions.iter().map(|_| by * Vec3::new(random(), random(), random())).collect();
    let mut normals = corner_normals(caster, &[], CREASE_RAD);
    for (corners, normals) in caster.mesh.triangles().iter().zip(&mut normals) {
        for (&v, normal) in corners.iter().zip(normals) {
            *normal = (*normal + tilts[v as usize]).normalize_or_zero();
        }
    }
    SmoothBody::new(caster, &normals).unwrap()
}

#[test]
fn rough_bodies_cast_the_shadow_that_the_cpu_has_and_no_light_falls_through_them() {
    let _turn = turn();
    let renderer = Renderer::new(gpu(), 1);
    let mut dark = 0;
    for (b, (surface, tilt)) in rough_bodies().into_iter().enumerate() {
        let mut ground = object(shapes::sheet(Vec3::new(-8.0, -9.0, -2.5), Vec3::X * 20.0, Vec3::Y * 20.0, [1, 1]));
        ground.role.casts = false;
        let scene = scene_of(vec![object(surface), ground]);
        let casters = Caster::of_scene(&scene);
        let mut drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &[]).unwrap();
        drawn.give_bodies(vec![Some(tilted(&casters[0], tilt))]);
        // From beside the body, so that its shadow is not behind it.
        let eye = DVec3::new(2.0, -7.0, 1.5);
        let camera = Camera::new(eye, DVec3::new(0.5, 0.0, -2.5), 0.9, 0.05, SIZE_PX).unwrap();
        for (l, light) in lights_on_ground().iter().enumerate() {
            let options = |silhouettes| ShadowOptions { silhouettes, smooth: curved(0.005), ..Default::default() };
            let of = |source| mask(&renderer, &drawn, &casters, &camera, light, options(source));
            let (ours, theirs) = (of(SilhouetteSource::Gpu), of(SilhouetteSource::Auto));
            let rays = RayCaster::new([(casters[0].positions.as_slice(), casters[0].mesh.triangles())]);
            let mut off = 0;
            for (i, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
                let [x, y] = [i as u32 % SIZE_PX[0], i as u32 / SIZE_PX[0]].map(|px| f64::from(px) + 0.5);
                let direction = camera.ray_direction(x, y);
                if direction.z >= 0.0 || rays.is_hit(eye, direction, 0.0, f64::INFINITY) {
                    continue;
                }
                let place = eye + direction * ((-2.5 - eye.z) / direction.z);
                let way = light.position.offset_from(place).normalize_or_zero();
                // How far the ray to the light passes by the middle of the body.
                let past_m = (place - way * way.dot(place)).length();
                if past_m < 0.75 {
                    assert_eq!([*ours, *theirs], [0; 2], "body {b}, light {l}, {place}");
                    dark += 1;
                }
                off += usize::from(ours != theirs);
            }
            assert!(off < 2, "body {b}, light {l}: {off} pixels of the ground differ");
        }
    }
    assert!(dark > 3000, "{dark} pixels are in the midst of a shadow");
}

/// A tube along z whose upper half is turned by `turn_rad`; its middle turns by half of that.
fn bent_tube(turn_rad: f64, rest: &Option<(Arc<Mesh>, Arc<Deformer>)>) -> (Object, (Arc<Mesh>, Arc<Deformer>)) {
    let (mesh, deformer) = rest.clone().unwrap_or_else(|| {
        let path: Vec<Vec3> = (0..=8).map(|i| Vec3::Z * (i as f32 * 0.4 - 1.6)).collect();
        let mesh = Arc::new(Mesh::new(shapes::tube(&path, 0.5, 12)).unwrap());
        let count = mesh.positions().len() as u32;
        let weight = |p: &Vec3| (0.5 + 0.4 * p.z).clamp(0.0, 1.0);
        let influences =
            |p: &Vec3| [Influence { joint: 0, weight: 1.0 - weight(p) }, Influence { joint: 1, weight: weight(p) }];
        let deformer = Arc::new(Deformer {
            morph_offsets: Vec::new(),
            influence_ranges: (0..count).map(|v| [2 * v, 2 * v + 2]).collect(),
            influences: mesh.positions().iter().flat_map(influences).collect(),
        });
        (mesh, deformer)
    });
    let joints = vec![DAffine3::IDENTITY, DAffine3::from_rotation_x(turn_rad)];
    let pose = Some(Pose { deformer: deformer.clone(), morph_weights: Vec::new(), joints });
    (Object { pose, ..Object::new("tube", mesh.clone(), DAffine3::IDENTITY) }, (mesh, deformer))
}

#[test]
fn a_body_that_moves_on_the_gpu_casts_the_smooth_shadow_of_where_it_is() {
    let _turn = turn();
    let renderer = Renderer::new(gpu(), 1);
    let gpu = renderer.gpu();
    let (tube, rest) = bent_tube(0.0, &None);
    let rest = Some(rest);
    let mut ground = object(shapes::sheet(Vec3::new(-8.0, -9.0, -2.5), Vec3::X * 20.0, Vec3::Y * 20.0, [1, 1]));
    ground.role.casts = false;
    let scene = scene_of(vec![tube, ground]);
    let mut casters = Caster::of_scene(&scene);
    let mut shown = GpuScene::new(gpu, &casters, &scene.materials, &[]).unwrap();
    let mut read_back = GpuScene::new(gpu, &casters, &scene.materials, &[]).unwrap();
    let mut casters_of_cpu = casters.clone();
    for drawn in [&mut shown, &mut read_back] {
        drawn.give_bodies(vec![Some(body_of(&casters[0]))]);
    }
    let mut poser = GpuPoser::new(gpu, &scene.objects, &casters, &shown).unwrap();
    let mut reader = GpuPoser::new(gpu, &scene.objects, &casters, &read_back).unwrap();
    let (mut before, mut differ) = (Vec::new(), [0; 2]);
    for turn_rad in [0.5, -0.7, 0.0] {
        let objects = vec![bent_tube(turn_rad, &rest).0, scene.objects[1].clone()];
        poser.show(gpu, &mut shown, &objects, &mut casters, 0.0);
        pollster::block_on(reader.pose(gpu, &mut read_back, &objects, &mut casters_of_cpu)).unwrap();
        read_back.pose_bodies(&casters_of_cpu);
        for light in lights_on_ground() {
            let options = |silhouettes| ShadowOptions { silhouettes, smooth: curved(0.005), ..Default::default() };
            let camera = &cameras()[0];
            let ours = mask(&renderer, &shown, &casters, camera, &light, options(SilhouetteSource::Gpu));
            let theirs = mask(&renderer, &read_back, &casters_of_cpu, camera, &light, options(SilhouetteSource::Auto));
            let cosines = cosines(&casters_of_cpu, camera, &light);
            let [all, inner] = differing(&ours, &theirs, &cosines);
            assert!(inner == 0 && all < ours.len() / 100, "{all} differ, {inner} in the midst, turned by {turn_rad}");
            let discrete = ShadowOptions { smooth: Smooth::Off, ..options(SilhouetteSource::Auto) };
            let faceted = mask(&renderer, &read_back, &casters_of_cpu, camera, &light, discrete);
            differ[0] += all;
            differ[1] += differing(&ours, &faceted, &cosines)[0];
            assert_ne!(before, ours);
            before = ours;
        }
    }
    assert!(
        differ[1] > 10 * differ[0],
        "it is smooth: {differ:?} differ from the smooth one of the CPU, and from its triangles'"
    );
}

#[test]
fn points_of_a_body_that_moves_are_those_of_the_cpu_where_it_is() {
    let _turn = turn();
    let gpu = gpu();
    let (tube, rest) = bent_tube(0.0, &None);
    let rest = Some(rest);
    let scene = scene_of(vec![tube]);
    let mut casters = Caster::of_scene(&scene);
    let mut drawn = GpuScene::new(&gpu, &casters, &scene.materials, &[]).unwrap();
    let mut body = body_of(&casters[0]);
    drawn.give_bodies(vec![Some(body.clone())]);
    let mut random = random();
    let mut poser = GpuPoser::new(&gpu, &scene.objects, &casters, &drawn).unwrap();
    for turn_rad in [0.6, -0.8] {
        let objects = vec![bent_tube(turn_rad, &rest).0];
        pollster::block_on(poser.pose(&gpu, &mut drawn, &objects, &mut casters)).unwrap();
        body.pose_to(&casters[0]);
        assert_eq!(body.loose_bounds(), body.loose_bounds_at(&casters[0]));
        let mut uploaded = ShadowCasters::new(&gpu, &Caster::of_scene(&scene)).unwrap();
        uploaded.give_body(0, body_of(&Caster::of_scene(&scene)[0]));
        uploaded.update(&gpu, &casters);
        for found in find(&gpu, &casters, &uploaded, &[curved(EPSILON_M)]).remove(0).1 {
            assert_eq!(gaps(&found), 0, "under light {}", found.light);
            let smoothness = Smoothness::Smooth(Precision::in_world(EPSILON_M));
            compared(&found, (&body, &casters[0]), &smoothness, &mut random);
            let bounds: Bounds = body.loose_bounds();
            let corners = found.sides.as_flattened().iter().map(|p| p.as_dvec3());
            assert_eq!(bounds.union(Bounds::of_points(corners)), bounds);
        }
    }
}
