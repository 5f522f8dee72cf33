//! Smooth silhouettes that are found on the GPU: the same as on the CPU within epsilon, closed bit for bit, and drawn into the same masks but at their edges.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Bounds, Camera, Caster, Deformer, Influence, Light, LightPosition, Material, Mesh, Object, Pose, Precision, Scene,
    SmoothBody, SmoothVolume, Smoothness, Surface, corner_normals, shapes,
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

#[test]
fn silhouettes_are_those_of_the_cpu_within_epsilon() {
    let _turn = turn();
    let gpu = gpu();
    let casters = casters();
    let bodies: Vec<SmoothBody> = casters.iter().map(body_of).collect();
    for (smooth, found) in find_standing(&gpu, &casters, &bodies, &[Smooth::Accurate, curved(EPSILON_M)]) {
        let smoothness = match smooth {
            Smooth::Accurate => Smoothness::Accurate,
            _ => Smoothness::Smooth(Precision::in_world(EPSILON_M)),
        };
        let mut worst = 0.0_f64;
        for found in found {
            let light = &lights()[found.light];
            let sides = sides_of(&SmoothVolume::new(&bodies[found.caster], light.position, &smoothness));
            let off = farthest(&found.sides, &sides).max(farthest(&sides, &found.sides));
            assert!(off < EPSILON_M, "body {} under {}, {smooth:?}: {off} m off", found.caster, light.name);
            assert!(!found.is_coarse && !found.sides.is_empty());
            worst = worst.max(off);
        }
        println!("{smooth:?}: at most {worst:.1e} m off");
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

#[test]
fn random_normals_leave_volumes_closed() {
    let _turn = turn();
    let gpu = gpu();
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    };
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

/// How many pixels differ, and of those how many are not next to an edge of `theirs`.
fn differing(ours: &[u8], theirs: &[u8]) -> [usize; 2] {
    let [width, height] = SIZE_PX.map(i64::from);
    let at = |x: i64, y: i64| theirs[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize];
    let (mut all, mut inner) = (0, 0);
    for y in 0..height {
        for x in 0..width {
            let own = at(x, y);
            if ours[(y * width + x) as usize] != own {
                all += 1;
                let is_at_edge = (-1..=1).any(|j| (-1..=1).any(|i| at(x + i, y + j) != own));
                inner += usize::from(!is_at_edge);
            }
        }
    }
    [all, inner]
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
                    let [all, inner] = differing(&ours, &theirs);
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
    let mut before = Vec::new();
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
            let [all, inner] = differing(&ours, &theirs);
            assert!(inner == 0 && all < ours.len() / 100, "{all} differ, {inner} in the midst, turned by {turn_rad}");
            let discrete = ShadowOptions { smooth: Smooth::Off, ..options(SilhouetteSource::Auto) };
            let faceted = mask(&renderer, &read_back, &casters_of_cpu, camera, &light, discrete);
            assert!(differing(&ours, &faceted)[0] > all, "it is smooth");
            assert_ne!(before, ours);
            before = ours;
        }
    }
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
            let volume = SmoothVolume::new(&body, lights()[found.light].position, &smoothness);
            let sides = sides_of(&volume);
            let off = farthest(&found.sides, &sides).max(farthest(&sides, &found.sides));
            assert!(off < EPSILON_M, "{off} m off, turned by {turn_rad}, under light {}", found.light);
            let bounds: Bounds = body.loose_bounds();
            let corners = found.sides.as_flattened().iter().map(|p| p.as_dvec3());
            assert_eq!(bounds.union(Bounds::of_points(corners)), bounds);
        }
    }
}
