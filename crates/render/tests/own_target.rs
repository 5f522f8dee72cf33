//! A texture of the caller's own, in a window's usual format, gets the picture that a headless one gets.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Material, Mesh, Object, Scene, shapes};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Output, Renderer, Shot, Targets};

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
    let shot = Shot { look: &look, ..Shot::new(&uploaded, &casters, &camera, &lights) };
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

    let bgra = pollster::block_on(gpu.read(&own)).expect("a small texture can be read");
    assert_eq!(bgra.len(), picture.rgba.len());
    let is_same = |(a, b): (&[u8], &[u8])| [a[2], a[1], a[0], a[3]] == *b;
    assert!(bgra.chunks_exact(4).zip(picture.rgba.chunks_exact(4)).all(is_same));
    assert!(picture.rgba.chunks_exact(4).any(|p| p != &picture.rgba[..4]), "there is something in the picture");
}
