//! Overlays land where the camera's own projection puts them, mix by their opacity, and stay behind what is nearer.

use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3, DVec4, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Material, Mesh, Object, Scene, shapes};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Overlay, OverlayColor, OverlayVertex, Renderer, Shot};

const SIZE_PX: [u32; 2] = [96, 64];
const PINK: [u8; 3] = [220, 60, 160];
const GREEN: [u8; 3] = [40, 180, 80];

/// A box of 2 m on its corner of the origin, under a sun.
struct Stage {
    renderer: Renderer,
    gpu_scene: GpuScene,
    casters: Vec<Caster>,
    camera: Camera,
    lights: Vec<Light>,
    look: Look,
}

impl Stage {
    fn new(samples: u32) -> Self {
        let mesh = Mesh::new(shapes::cuboid(Vec3::ZERO, Vec3::splat(2.0))).expect("shapes are good meshes");
        let scene = Scene {
            objects: vec![Object::new("box", Arc::new(mesh), DAffine3::IDENTITY)],
            materials: vec![Material::default()],
            ..Scene::default()
        };
        let casters = Caster::of_scene(&scene);
        let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()));
        let renderer = Renderer::new(gpu.expect("tests need a graphics driver: run scripts/setup.sh"), samples);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &[]).expect("a small scene");
        let camera = Camera::new(DVec3::new(6.0, -7.0, 4.0), DVec3::ONE, 0.7, 0.5, SIZE_PX).expect("a good camera");
        let lights = vec![Light::new("sun", LightPosition::sun(2.0, 0.8), Vec3::ONE)];
        let look = Look::for_model(&scene.bounds(), &lights);
        Self { renderer, gpu_scene, casters, camera, lights, look }
    }

    /// The picture's pixels with `overlay`.
    fn draw(&self, overlay: Option<&Overlay>) -> Vec<[u8; 3]> {
        let Self { gpu_scene, casters, camera, lights, look, .. } = self;
        let shot = Shot { look, overlay, ..Shot::new(gpu_scene, casters, camera, lights) };
        let picture = pollster::block_on(self.renderer.picture(&shot)).expect("a small picture");
        picture.rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect()
    }

    /// For each pixel how far its centre is, in pixels, from what is seen of the line between two homogeneous points; infinite beyond 4.
    fn distances_px(&self, [a, b]: [DVec4; 2]) -> Vec<f64> {
        let [width, height] = SIZE_PX.map(i64::from);
        let clip_from_world = self.camera.clip_from_world();
        let mut distances = vec![f64::INFINITY; (width * height) as usize];
        for i in -100_000..=100_000 {
            // Closer together in the middle, where the longest line passes the eye.
            let t = 0.5 + 0.5 * (f64::from(i) * 1e-5).powi(3);
            let clip = clip_from_world * a.lerp(b, t);
            if clip.w < 1e-9 || clip.w < clip.z {
                continue;
            }
            let p = pixel_of(clip);
            let (x, y) = (p.x.floor() as i64, p.y.floor() as i64);
            for (x, y) in (y - 4..=y + 4).flat_map(|y| (x - 4..=x + 4).map(move |x| (x, y))) {
                if (0..width).contains(&x) && (0..height).contains(&y) {
                    let nearest = &mut distances[(y * width + x) as usize];
                    *nearest = nearest.min(p.distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)));
                }
            }
        }
        distances
    }
}

/// In pixels from the top left corner.
fn pixel_of(clip: DVec4) -> DVec2 {
    let [width, height] = SIZE_PX.map(f64::from);
    DVec2::new((0.5 + 0.5 * clip.x / clip.w) * width, (0.5 - 0.5 * clip.y / clip.w) * height)
}

fn vertex(homogeneous: DVec4, color: OverlayColor) -> OverlayVertex {
    OverlayVertex { position_world: homogeneous.as_vec4(), color }
}

fn line(ends: [DVec4; 2], color: OverlayColor) -> Overlay {
    Overlay { lines: vec![ends.map(|end| vertex(end, color))], line_width_px: 3.0, ..Overlay::default() }
}

fn is_near(a: [u8; 3], b: [u8; 3], levels: u8) -> bool {
    a.iter().zip(b).all(|(&a, b)| a.abs_diff(b) <= levels)
}

#[test]
fn a_line_colours_the_pixels_on_its_projection_and_none_elsewhere() {
    let stage = Stage::new(1);
    let before = stage.draw(None);
    let pink = OverlayColor::new(PINK, 1.0);
    let behind_the_eye = stage.camera.eye() - stage.camera.axes()[2] * 3.0 + DVec3::X;
    let lines = [
        ("in view", [DVec4::new(2.5, -1.0, 0.0, 1.0), DVec4::new(0.0, -1.0, 3.0, 1.0)]),
        ("upright", [DVec4::new(2.5, -2.0, -1.0, 1.0), DVec4::new(2.5, -2.0, 3.0, 1.0)]),
        ("from behind the eye", [behind_the_eye.extend(1.0), DVec4::new(2.5, -2.0, 1.0, 1.0)]),
        ("to infinity", [DVec4::new(2.5, -2.0, 1.0, 1.0), DVec4::new(-0.2, 1.0, 0.5, 0.0)]),
        ("along the horizon", [DVec4::new(-1.0, 1.0, -0.2, 0.0), DVec4::new(-0.3, 1.0, -0.2, 0.0)]),
        ("far beyond both sides", [DVec4::new(-9e4, -5e4, 1.0, 1.0), DVec4::new(9e4, 5e4, 1.0, 1.0)]),
    ];
    for (name, ends) in lines {
        let after = stage.draw(Some(&Overlay { hidden_opacity: 1.0, ..line(ends, pink) }));
        let distances = stage.distances_px(ends);
        let mut covered = 0;
        for (pixel, &distance) in distances.iter().enumerate() {
            if distance < 0.9 {
                covered += 1;
                assert!(is_near(after[pixel], PINK, 1), "{name}: pixel {pixel} at {distance} is {:?}", after[pixel]);
            } else if distance > 2.1 {
                assert_eq!(after[pixel], before[pixel], "{name}: pixel {pixel} at {distance}");
            }
        }
        assert!(covered > 25, "{name}: {covered} pixels");
    }
}

#[test]
fn a_line_behind_the_eye_or_of_no_length_is_nowhere_or_a_dot() {
    let stage = Stage::new(1);
    let before = stage.draw(None);
    let pink = OverlayColor::new(PINK, 1.0);
    let behind = stage.camera.eye() - stage.camera.axes()[2] * 3.0;
    let ends = [behind.extend(1.0), (behind + DVec3::X).extend(1.0)];
    assert_eq!(stage.draw(Some(&line(ends, pink))), before);

    let dot = [DVec4::new(2.5, -2.0, 1.0, 1.0); 2];
    let changed = stage.draw(Some(&line(dot, pink))).iter().zip(&before).filter(|(a, b)| a != b).count();
    // A disc of 3 px across has 7 of area; its fringe reaches a few pixels more.
    assert!((5..=21).contains(&changed), "{changed} pixels");
}

#[test]
fn an_opaque_overlay_shows_the_bytes_that_were_asked_for() {
    let stage = Stage::new(4);
    let depth = stage.camera.near() * 2.0;
    let corners = [(-96.0, -64.0), (288.0, -64.0), (-96.0, 192.0)]
        .map(|(x, y)| stage.camera.eye() + stage.camera.ray_direction(x, y) * depth);
    for srgb in [PINK, GREEN, [0, 0, 0], [225, 225, 225], [10, 200, 30], [250, 1, 128], [60, 60, 60], [45, 52, 225]] {
        let color = OverlayColor::new(srgb, 1.0);
        let all = Overlay { triangles: vec![corners.map(|p| vertex(p.extend(1.0), color))], ..Overlay::default() };
        let shown = stage.draw(Some(&all))[0];
        let wanted = srgb.map(|c| c.min(225));
        assert!(is_near(shown, wanted, 1), "{srgb:?} is shown as {shown:?}");
    }
}

#[test]
fn a_translucent_triangle_mixes_by_its_opacity() {
    let stage = Stage::new(1);
    let corners = [DVec3::new(5.0, -5.0, -1.0), DVec3::new(1.0, -3.0, 4.0), DVec3::new(3.0, -2.0, -1.0)];
    let draw = |opacity| {
        let color = OverlayColor::new(GREEN, opacity);
        let triangle = corners.map(|p| vertex(p.extend(1.0), color));
        stage.draw(Some(&Overlay { triangles: vec![triangle], ..Overlay::default() }))
    };
    let (none, some, all) = (draw(0.0), draw(0.25), draw(1.0));
    let linear = |byte: u8| {
        let c = f64::from(byte) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    let mut mixed = 0;
    for pixel in 0..none.len() {
        // The tone mapper is linear, up to an offset that all these colours get, where nothing is very dark or bright.
        let is_plain = none[pixel].iter().all(|c| (70..215).contains(c));
        if none[pixel] == all[pixel] || !is_plain {
            continue;
        }
        for channel in 0..3 {
            let [none, some, all] = [&none, &some, &all].map(|picture| linear(picture[pixel][channel]));
            let wanted = 0.75 * none + 0.25 * all;
            assert!((some - wanted).abs() < 0.012, "pixel {pixel}: {none}, {all} mixed to {some}, not {wanted}");
        }
        mixed += 1;
    }
    assert!(mixed > 100, "{mixed} pixels");
}

#[test]
fn what_a_surface_hides_is_absent_or_faint() {
    let stage = Stage::new(1);
    let before = stage.draw(None);
    let color = OverlayColor::new(PINK, 1.0);
    // Into the box: its end is hidden, its start is not.
    let ends = [DVec4::new(4.0, 1.0, 1.0, 1.0), DVec4::new(1.0, 1.0, 1.0, 1.0)];
    let absent = stage.draw(Some(&line(ends, color)));
    let faint = stage.draw(Some(&Overlay { hidden_opacity: 0.4, ..line(ends, color) }));
    let at = |homogeneous: DVec4| {
        let p = pixel_of(stage.camera.clip_from_world() * homogeneous);
        p.y as usize * SIZE_PX[0] as usize + p.x as usize
    };
    let (seen, hidden) = (at(ends[0].lerp(ends[1], 0.2)), at(ends[0].lerp(ends[1], 0.95)));
    assert!(is_near(absent[seen], PINK, 1) && is_near(faint[seen], PINK, 1));
    assert_eq!(absent[hidden], before[hidden]);
    let between = |c: usize| {
        let (low, high) = (before[hidden][c].min(PINK[c]), before[hidden][c].max(PINK[c]));
        low < faint[hidden][c] && faint[hidden][c] < high
    };
    assert!((0..3).any(between), "{:?} from {:?}", faint[hidden], before[hidden]);

    // A triangle behind the box, too.
    let behind = [DVec3::new(-0.5, 2.5, 0.2), DVec3::new(-0.2, 2.2, 0.2), DVec3::new(0.0, 2.5, 0.5)];
    let triangle = behind.map(|p| vertex(p.extend(1.0), color));
    assert_eq!(stage.draw(Some(&Overlay { triangles: vec![triangle], ..Overlay::default() })), before);
}

#[test]
fn a_triangle_with_a_surfaces_corners_covers_that_surface() {
    for samples in [1, 4] {
        let stage = Stage::new(samples);
        let caster = &stage.casters[0];
        let color = OverlayColor::new(GREEN, 1.0);
        let triangles: Vec<_> = (0..caster.mesh.triangles().len())
            .map(|t| caster.corners(t).map(|corner| OverlayVertex::at(corner, color)))
            .collect();
        let before = stage.draw(None);
        let after = stage.draw(Some(&Overlay { triangles, ..Overlay::default() }));
        let [x, y] = SIZE_PX.map(|side| side as usize / 2);
        let row = |picture: &[[u8; 3]]| picture[y * SIZE_PX[0] as usize..][..SIZE_PX[0] as usize].to_vec();
        let changed = row(&before).iter().zip(row(&after)).filter(|(b, a)| *b != a).count();
        let green = row(&after).iter().filter(|a| is_near(**a, GREEN, 1)).count();
        assert!(green > 20 && changed - green <= 2, "{green} of {changed} pixels are green, {samples} samples");
        assert!(is_near(row(&after)[x], GREEN, 1));
    }
}

#[test]
fn a_line_on_an_edge_wins_over_the_surfaces_that_meet_there() {
    let stage = Stage::new(1);
    // Of the edges of the box, the upright one nearest the eye.
    let ends = [DVec4::new(2.0, 0.0, 0.1, 1.0), DVec4::new(2.0, 0.0, 1.9, 1.0)];
    let after = stage.draw(Some(&line(ends, OverlayColor::new(PINK, 1.0))));
    for (pixel, distance) in stage.distances_px(ends).into_iter().enumerate() {
        if distance < 0.9 {
            assert!(is_near(after[pixel], PINK, 1), "pixel {pixel} at {distance} is {:?}", after[pixel]);
        }
    }
}
