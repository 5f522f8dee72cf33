//! A texture of the caller's own, in a window's usual format, gets the picture that a headless one gets.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Material, Mesh, Object, Scene, shapes};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Output, Renderer, ShadowOptions, Shot, Targets};

const SIZE_PX: [u32; 2] = [64, 48];

#[test]
fn a_view_of_the_caller_gets_the_picture_that_a_headless_one_gets() {
    let gpu = || {
        let choice = AdapterChoice::default();
        pollster::block_on(Gpu::new(&choice)).expect("tests need a graphics driver: run scripts/setup.sh")
    };
    let scene = {
        let body = |name: &str, surface| {
            let mesh = Mesh::new(surface).expect("shapes are good meshes");
            Object::new(name, Arc::new(mesh), DAffine3::IDENTITY)
        };
        let floor = shapes::cuboid(Vec3::new(-4.0, -4.0, -0.2), Vec3::new(4.0, 4.0, 0.0));
        let post = shapes::cuboid(Vec3::new(-0.5, -0.5, 0.1), Vec3::new(0.5, 0.5, 2.0));
        Scene {
            objects: vec![body("floor", floor), body("post", post)],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    };
    let casters = Caster::of_scene(&scene);
    let camera = Camera::new(DVec3::new(3.0, -9.0, 5.0), DVec3::ZERO, 0.8, 0.1, SIZE_PX).expect("a good camera");
    let lights = [Light::new("sun", LightPosition::sun(4.0, 0.6), Vec3::ONE)];
    let look = Look::for_model(&scene.bounds(), &lights);

    let headless = Renderer::new(gpu(), 4);
    let uploaded = GpuScene::new(headless.gpu(), &casters, &scene.materials, &scene.textures).expect("a small scene");
    let shot = Shot {
        scene: &uploaded,
        casters: &casters,
        camera: &camera,
        lights: &lights,
        shadows: ShadowOptions::default(),
        look: &look,
        overlay: None,
        spheres: &[],
    };
    let picture = pollster::block_on(headless.picture(&shot)).expect("a small picture");

    let format = wgpu::TextureFormat::Bgra8UnormSrgb;
    let windowed = Renderer::for_format(gpu(), 4, format);
    let gpu = windowed.gpu();
    let own = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("window"),
        size: wgpu::Extent3d { width: SIZE_PX[0], height: SIZE_PX[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let uploaded = GpuScene::new(gpu, &casters, &scene.materials, &scene.textures).expect("a small scene");
    let targets = Targets::new(gpu, Output::Picture, SIZE_PX, 4).expect("a small picture");
    let shot = Shot { scene: &uploaded, ..shot };
    let to = own.create_view(&wgpu::TextureViewDescriptor::default());
    windowed.draw(&shot, &targets, &to).expect("a small scene");

    let bgra = read(gpu, &own);
    assert_eq!(bgra.len(), picture.rgba.len());
    let is_same = |(a, b): (&[u8], &[u8])| [a[2], a[1], a[0], a[3]] == *b;
    assert!(bgra.chunks_exact(4).zip(picture.rgba.chunks_exact(4)).all(is_same));
    assert!(picture.rgba.chunks_exact(4).any(|p| p != &picture.rgba[..4]), "there is something in the picture");
}

/// Rows of 64 pixels need no padding.
fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<u8> {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read"),
        size: u64::from(SIZE_PX[0] * SIZE_PX[1] * 4),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIZE_PX[0] * 4), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |result| result.expect("a small buffer can be mapped"));
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    buffer.get_mapped_range(..).expect("the buffer is mapped").to_vec()
}
