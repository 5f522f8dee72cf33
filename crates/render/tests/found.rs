//! What is found on the GPU, read back: multiplicities follow from coefficients, boundaries close, coefficients are those of the CPU but where `f32`
//! can't tell, and z-pass is chosen nowhere where the CPU would not.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod random;
mod soup;

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use random::Random;
use soup::soup;
use umbrae_core::{
    Bounds, Camera, Case, CaseChooser, Caster, Chain, Counting, Light, LightPosition, Material, Mesh, Object, Scene,
    Surface, Windings, shapes, silhouette,
};
use umbrae_render::{
    AdapterChoice, FoundSilhouette, Gpu, GpuError, GpuScene, Method, Renderer, ShadowCasters, ShadowOptions,
    ShadowTarget, Shadows, Shot, SilhouetteSource, Tier,
};

const LIGHTS: usize = 64;
const SOURCES: [SilhouetteSource; 2] = [SilhouetteSource::Gpu, SilhouetteSource::GpuBasic];

fn gpu() -> Gpu {
    pollster::block_on(Gpu::new(&AdapterChoice::default())).expect("tests need a graphics driver: run scripts/setup.sh")
}

fn scene_of(surfaces: Vec<Surface>) -> Scene {
    let object = |surface| Object::new("", Arc::new(Mesh::new(surface).unwrap()), DAffine3::IDENTITY);
    Scene {
        objects: surfaces.into_iter().map(object).collect(),
        materials: vec![Material::default()],
        ..Scene::default()
    }
}

/// Closed, open, of many components, with edges of many triangles; one mesh twice, one of several blocks.
fn shaped() -> Scene {
    let boxes = (0..7).map(|i| shapes::cuboid(Vec3::splat(i as f32 * 0.7 - 3.0), Vec3::splat(i as f32 * 0.7 - 2.6)));
    let mut scene = scene_of(vec![
        shapes::icosphere(Vec3::new(1.0, -0.5, 0.3), 0.9, 3),
        shapes::sheet(Vec3::new(-3.0, -3.0, -1.5), Vec3::X * 6.0, Vec3::Y * 6.0, [9, 7]),
        shapes::joined(boxes),
        shapes::tube(&[Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5), Vec3::new(-2.0, 2.0, 1.5)], 0.2, 9),
        shapes::prism(&[Vec2::ZERO, Vec2::X, Vec2::new(0.3, 0.2), Vec2::Y], -1.0, 1.0),
    ]);
    let again = DAffine3::from_rotation_y(0.7) * DAffine3::from_translation(DVec3::new(-1.5, 1.0, 0.2));
    scene.objects.push(Object::new("again", scene.objects[0].mesh.clone(), again));
    scene
}

/// Anywhere, among triangles and in their planes; a quarter of them infinitely far away.
fn lights(casters: &[Caster], random: &mut Random) -> Vec<Light> {
    let light = |i: usize| {
        let caster = &casters[random.below(casters.len())];
        let corners = caster.corners(random.below(caster.mesh.triangles().len())).map(Vec3::as_dvec3);
        let position = match i % 4 {
            0 => LightPosition::directional(random.point(1.0)).unwrap(),
            1 => LightPosition::point(corners[0] * 3.0 - corners[1] - corners[2]),
            2 => LightPosition::point(random.point(2.0)),
            _ => LightPosition::point(random.point(9.0)),
        };
        Light::new("light", position, Vec3::ONE).rounded_to_f32()
    };
    (0..LIGHTS).map(light).collect()
}

fn find(
    (gpu, source): (&Gpu, SilhouetteSource),
    casters: &[Caster],
    camera: &Camera,
    lights: &[Light],
    method: Method,
) -> Vec<FoundSilhouette> {
    let target = ShadowTarget { depth_stencil_format: gpu.caps.depth_stencil_format, samples: 1, color_formats: &[] };
    let shadows = Shadows::new(gpu, &target);
    let uploaded = ShadowCasters::new(gpu, casters).unwrap();
    let mut found = shadows.finder(gpu, casters, &uploaded, source).unwrap();
    let options = ShadowOptions { silhouettes: source, ..ShadowOptions::without_culling(method) };
    let view = shadows.view(gpu, casters, camera);
    found.plan(gpu, casters, &uploaded, &view, lights, &options);
    found.upload(gpu).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    found.record(&mut encoder);
    gpu.queue.submit([encoder.finish()]);
    let silhouettes = pollster::block_on(found.read(gpu, casters)).unwrap();
    assert_eq!(silhouettes.len(), casters.len() * lights.len());
    silhouettes
}

/// How near the light is to the plane of triangle `t`, for the size of everything.
fn nearness(caster: &Caster, t: usize, light: LightPosition) -> f64 {
    let [a, b, c] = caster.corners(t).map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let reach = |p: DVec3| p.abs().max_element();
    let size = if light.is_directional() {
        1.0
    } else {
        reach(light.homogeneous().truncate()).max(reach(caster.bounds.min)).max(reach(caster.bounds.max))
    };
    normal.dot(light.offset_from(a)).abs() / size
}

/// What may be found: the edges and caps that the GPU's own coefficients have.
fn check_boundary(caster: &Caster, found: &FoundSilhouette) {
    let chain = Chain::from_coefficients(found.coefficients.clone());
    let mut expected = silhouette(&caster.topology, &chain);
    let mut edges = found.edges.clone();
    expected.sort_by_key(|edge| (edge.start, edge.end));
    edges.sort_by_key(|edge| (edge.start, edge.end));
    assert_eq!(edges, expected, "caster {}, light {}", found.caster, found.light);
    let mut leaving = vec![0_i64; caster.positions.len()];
    for edge in &edges {
        leaving[edge.start as usize] += i64::from(edge.multiplicity);
        leaving[edge.end as usize] -= i64::from(edge.multiplicity);
    }
    assert!(leaving.iter().all(|&sum| sum == 0), "the boundary of caster {} is open", found.caster);

    let casting = found.coefficients.iter().enumerate().filter(|(_, c)| **c != 0);
    let expected: Vec<(usize, bool)> = casting.map(|(t, &c)| (t, c < 0)).collect();
    let mut caps = found.caps.clone();
    caps.sort_unstable();
    assert_eq!(caps, expected, "caps of caster {}, light {}", found.caster, found.light);
}

/// How many triangles are turned otherwise than on the CPU, and how many components count as there.
fn check_coefficients(caster: &Caster, camera: &Camera, light: LightPosition, found: &FoundSilhouette) -> [usize; 2] {
    let chosen =
        Counting::choose(caster, &Windings::of_near_rectangle(caster, camera), &Windings::of_light(caster, light));
    let chain = |counting: &[Counting]| Chain::new(caster, light, counting);
    let outside = chain(&Counting::outside(caster));
    let every = chain(&vec![Counting::Every; chosen.len()]);
    let (mut others, mut as_chosen) = (0, 0);
    for (component, &counting) in chosen.iter().enumerate() {
        let of_component = caster.topology.component_of_triangle();
        let triangles: Vec<usize> =
            (0..of_component.len()).filter(|&t| of_component[t] as usize == component).collect();
        let differing = |chain: &Chain| -> Vec<usize> {
            triangles.iter().copied().filter(|&t| chain.coefficients()[t] != found.coefficients[t]).collect()
        };
        let (from_outside, from_every) = (differing(&outside), differing(&every));
        // A closed component may be counted the cheap way only where the CPU would.
        let is_cheap_right = counting == Counting::Facing;
        let is_cheap = is_cheap_right && from_outside.len() <= from_every.len();
        as_chosen += usize::from(is_cheap || counting == Counting::Every);
        let different = if is_cheap { from_outside } else { from_every };
        for &t in &different {
            let nearness = nearness(caster, t, light);
            assert!(nearness < 2e-6, "triangle {t} of caster {} is {nearness} from edge-on", found.caster);
        }
        others += different.len();
    }
    [others, as_chosen]
}

#[test]
fn what_is_found_for_64_lights_closes_and_is_what_the_cpu_finds() {
    let gpu = gpu();
    for source in SOURCES {
        println!("{}", what_is_found_closes_and_is_what_the_cpu_finds(&gpu, source));
    }
}

fn what_is_found_closes_and_is_what_the_cpu_finds(gpu: &Gpu, source: SilhouetteSource) -> String {
    let mut random = Random::new(7);
    let mut scenes = vec![shaped()];
    scenes.extend((0..6).map(|_| soup(&mut random)));
    let (mut triangles, mut others, mut as_chosen, mut components) = (0, 0, 0, 0);
    for scene in &scenes {
        let casters = Caster::of_scene(scene);
        let camera = Camera::new(random.point(3.0), random.point(1.0), 1.2, 0.05, [160, 120]).unwrap();
        let lights = lights(&casters, &mut random);
        // With z-fail, so that caps are found too.
        for found in find((gpu, source), &casters, &camera, &lights, Method::ZFail) {
            let caster = &casters[found.caster];
            assert!(found.is_fail);
            check_boundary(caster, &found);
            let [other, same] = check_coefficients(caster, &camera, lights[found.light].position, &found);
            triangles += found.coefficients.len();
            others += other;
            as_chosen += same;
            components += caster.topology.components().len();
        }
    }
    assert!(triangles > 150_000 && others < triangles / 10_000 && as_chosen > components * 9 / 10);
    format!(
        "{source:?}: {others} of {triangles} triangles are turned otherwise, {as_chosen} of {components} components count as \
         on the CPU"
    )
}

/// Rays judge one light at a time; here all of a frame are found together, and some have their bits in a second word.
#[test]
fn a_picture_under_twenty_lights_is_the_same_wherever_silhouettes_are_found() {
    let renderer = Renderer::new(gpu(), 4);
    let scene = shaped();
    let casters = Caster::of_scene(&scene);
    let drawn = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures).unwrap();
    let camera = Camera::new(DVec3::new(4.0, -6.0, 3.5), DVec3::ZERO, 0.9, 0.05, [240, 180]).unwrap();
    let mut random = Random::new(23);
    let lamp = |i: usize| {
        let position = DVec3::new(random.signed() * 4.0, random.signed() * 4.0, 1.0 + 2.0 * random.signed().abs());
        Light::new(format!("lamp {i}"), LightPosition::point(position), Vec3::splat(2.0))
    };
    let lights: Vec<Light> = (0..20).map(lamp).collect();
    let picture = |silhouettes, lights: &[Light]| {
        let shadows = ShadowOptions { silhouettes, ..ShadowOptions::default() };
        let shot = Shot { shadows, ..Shot::new(&drawn, &casters, &camera, lights) };
        pollster::block_on(renderer.picture(&shot)).unwrap().rgba
    };
    let different = |a: &[u8], b: &[u8]| a.chunks(4).zip(b.chunks(4)).filter(|(a, b)| a != b).count();
    let on_gpu = picture(SilhouetteSource::Gpu, &lights);
    // Where a triangle is edge-on to rounding, a pixel may differ.
    assert!(different(&picture(SilhouetteSource::Auto, &lights), &on_gpu) < 20);
    for i in [0, 9, 16, 19] {
        let mut fewer = lights.clone();
        fewer.remove(i);
        assert!(different(&picture(SilhouetteSource::Gpu, &fewer), &on_gpu) > 1000, "lamp {i} shows");
    }
}

#[test]
fn a_device_that_does_not_compute_says_so() {
    let mut gpu = gpu();
    gpu.caps.tier = Tier::Basic;
    let scene = shaped();
    let casters = Caster::of_scene(&scene);
    let drawn = GpuScene::new(&gpu, &casters, &scene.materials, &scene.textures).unwrap();
    let camera = Camera::new(DVec3::splat(4.0), DVec3::ZERO, 1.2, 0.05, [16, 12]).unwrap();
    let shadows = ShadowOptions { silhouettes: SilhouetteSource::Gpu, ..ShadowOptions::default() };
    let light = Light::new("light", LightPosition::point(DVec3::Z * 3.0), Vec3::ONE);
    let renderer = Renderer::new(gpu, 1);
    let mask = |shadows| {
        pollster::block_on(renderer.mask(&Shot { shadows, ..Shot::new(&drawn, &casters, &camera, &[]) }, &light))
    };
    assert!(matches!(mask(shadows), Err(GpuError::NoSilhouettes { .. })));
    assert!(mask(ShadowOptions::default()).is_ok(), "and finds them on the CPU");
}

#[test]
fn where_the_near_rectangle_may_be_shaded_nothing_is_counted_by_z_pass() {
    let gpu = gpu();
    for source in SOURCES {
        println!("{}", nothing_is_counted_by_z_pass_but_where_the_cpu_would(&gpu, source));
    }
}

fn nothing_is_counted_by_z_pass_but_where_the_cpu_would(gpu: &Gpu, source: SilhouetteSource) -> String {
    let mut random = Random::new(11);
    let (mut fails, mut more, mut all) = (0, 0, 0);
    for _ in 0..40 {
        let scene = if random.below(2) == 0 { shaped() } else { soup(&mut random) };
        let casters = Caster::of_scene(&scene);
        let near = [0.05, 0.5, 2.0][random.below(3)];
        let camera = Camera::new(random.point(3.0), random.point(1.0), 1.2, near, [160, 120]).unwrap();
        let mut lights = lights(&casters, &mut random);
        // In the near plane, where the pyramid is flat.
        let [right, up, forward] = camera.axes();
        let beside = camera.eye() + forward * near + right * 3.0 * random.signed() + up * random.signed();
        lights[0].position = LightPosition::point(beside).rounded_to_f32();
        let bounds: Bounds = Caster::bounds_of(&casters);
        for found in find((gpu, source), &casters, &camera, &lights, Method::Auto) {
            let chooser = CaseChooser::new(&camera, lights[found.light].position, &bounds);
            let is_fail = chooser.case(&casters[found.caster]) != Case::Pass;
            assert!(found.is_fail || !is_fail, "caster {}, {:?}", found.caster, lights[found.light]);
            fails += usize::from(is_fail);
            more += usize::from(found.is_fail && !is_fail);
            all += 1;
        }
    }
    // Boxes alone tell less than triangles.
    let most = if source == SilhouetteSource::Gpu { fails / 4 } else { fails };
    assert!(fails > 500 && more < most);
    format!("{source:?}: {fails} of {all} by z-fail, and {more} more on the GPU")
}
