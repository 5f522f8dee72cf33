//! In steady state the CPU's part of a frame, with silhouettes found on the GPU, takes no memory.
//!
//! What is measured is [`FoundShadows::plan`], which is everything that is ours between a moved camera, moved lights and moved casters and the bytes
//! to upload: what is culled, jobs, draws, reports. Uploading and recording, which are calls of wgpu and little else, are done as well, but not
//! measured: wgpu takes memory for both. Lights with a range or a cone are left out, as their reach is made anew when they move.
//!
//! [`FoundShadows::plan`]: umbrae_render::FoundShadows::plan

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Mesh, Object, Scene, shapes};
use umbrae_render::{
    AdapterChoice, Gpu, Method, ShadowCasters, ShadowOptions, ShadowTarget, Shadows, SilhouetteSource,
};

/// Counts what a thread takes while it asks for that.
struct Counting;

thread_local! {
    static TAKEN: Cell<Option<usize>> = const { Cell::new(None) };
}

fn count() {
    // A thread that ends has no cell any more.
    let _ = TAKEN.try_with(|taken| taken.set(taken.get().map(|count| count + 1)));
}

#[expect(unsafe_code, reason = "there is no other way to see what is allocated")]
// SAFETY: every call goes on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(at, layout, new_size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often memory is taken in `work`.
fn taken(work: impl FnOnce()) -> usize {
    TAKEN.set(Some(0));
    work();
    TAKEN.take().expect("nobody else takes it")
}

fn casters() -> Vec<Caster> {
    let object =
        |surface| Object::new("", Arc::new(Mesh::new(surface).expect("shapes are good meshes")), DAffine3::IDENTITY);
    let boxes = (0..40_i16).map(|i| {
        let corner = Vec3::new(f32::from(i % 8), f32::from(i / 8), 0.1);
        shapes::cuboid(corner, corner + Vec3::new(0.5, 0.6, 1.0 + 0.1 * f32::from(i % 5)))
    });
    let floor = shapes::sheet(Vec3::splat(-9.0).with_z(0.0), Vec3::X * 30.0, Vec3::Y * 30.0, [3, 3]);
    let ball = shapes::icosphere(Vec3::new(3.0, 2.0, 2.5), 0.8, 3);
    Caster::of_scene(&Scene { objects: boxes.chain([floor, ball]).map(object).collect(), ..Scene::default() })
}

fn lights(time: f64) -> Vec<Light> {
    let lamp = |i: i32| {
        let (sin, cos) = (f64::from(i) + time).sin_cos();
        let position = match i {
            0 => LightPosition::sun(1.0 + time, 0.7),
            _ => LightPosition::point(DVec3::new(4.0 + 5.0 * cos, 2.0 + 3.0 * sin, 1.0 + 0.2 * f64::from(i))),
        };
        Light::new("a lamp with a name", position, Vec3::ONE)
    };
    (0..12).map(lamp).collect()
}

#[test]
fn from_the_third_frame_on_planning_takes_no_memory() {
    assert_eq!(taken(|| drop(std::hint::black_box(vec![1_u8; 3]))), 1, "what is taken is seen");
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
        .expect("tests need a graphics driver: run scripts/setup.sh");
    let target = ShadowTarget { depth_stencil_format: gpu.caps.depth_stencil_format, samples: 1, color_formats: &[] };
    let shadows = Shadows::new(&gpu, &target);
    let casters = casters();
    let uploaded = ShadowCasters::new(&gpu, &casters).expect("it fits");
    for source in [SilhouetteSource::Gpu, SilhouetteSource::GpuBasic] {
        assert_planning_is_steady(&gpu, &shadows, &casters, &uploaded, source);
    }
}

fn assert_planning_is_steady(
    gpu: &Gpu,
    shadows: &Shadows,
    casters: &[Caster],
    uploaded: &ShadowCasters,
    source: SilhouetteSource,
) {
    let mut found = shadows.finder(gpu, casters, uploaded, source).expect("a device that computes");
    let camera = |time: f64| {
        let eye = DVec3::new(4.0 + time.cos(), -3.0 + time, 1.5 + time.sin());
        Camera::new(eye, DVec3::new(4.0, 2.0, 0.5), 1.0, 0.05, [320, 200]).expect("a good camera")
    };
    let mut view = shadows.view(gpu, casters, &camera(0.0));
    let (mut jobs, mut fates) = (0, rustc_hash::FxHashSet::default());
    for frame in 0..30 {
        let time = 0.1 * f64::from(frame);
        let lights = lights(time);
        view.look_from(gpu, casters, &camera(time));
        // As many as there are of each kind in the first frames may not be the most.
        let method = [Method::ZFail, Method::Auto, Method::ZPass][frame as usize % 3];
        let options = if frame < 3 { ShadowOptions::without_culling(Method::ZFail) } else { method.into() };
        let options = ShadowOptions { silhouettes: source, ..options };
        let planned = taken(|| found.plan(gpu, casters, uploaded, &view, &lights, &options));
        if frame >= 3 {
            assert_eq!(planned, 0, "{source:?}: frame {frame} takes memory {planned} times");
        }
        found.upload(gpu).expect("it fits");
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        found.record(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        for report in found.lights().flat_map(|light| &light.report.casters) {
            jobs += usize::from(report.rect.is_some());
            fates.insert(std::mem::discriminant(&report.fate));
        }
    }
    // In textures, the CPU decides each case.
    let kinds = if source == SilhouetteSource::Gpu { 3 } else { 2 };
    assert!(jobs > 3000 && fates.len() >= kinds, "{jobs} jobs with {} fates are nothing to plan", fates.len());
}
