//! Spheres displaced by noise that moves, with exact shadows, on themselves too: of where vertices are, the CPU knows nothing but boxes.
//!
//! Source: S. Brabec and H.-P. Seidel, "Shadow volumes on programmable graphics hardware", 2003, figure 5.
//!
//! `cargo run --release -p umbrae-render --example displaced_spheres` writes `displaced_spheres_0.png` and so on: a second in ten pictures.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{
    Bounds, Camera, CameraError, Caster, Light, LightPosition, Material, Mesh, Object, Scene, Surface, shapes,
};
use umbrae_render::{
    AdapterChoice, Displacement, Gpu, GpuPoser, GpuScene, Look, Renderer, ShadowOptions, Shot, SilhouetteSource,
};

const PICTURES: u32 = 10;

/// Gradient noise over a lattice that drifts upwards, twice.
pub(crate) const NOISE: &str = "
    fn moved_hash(cell: vec3i) -> vec3f {
        var h = vec3u(cell) * vec3u(1597334673u, 3812015801u, 2798796415u);
        var n = h.x ^ h.y ^ h.z;
        n = (n ^ (n >> 15u)) * 2246822519u;
        n = (n ^ (n >> 13u)) * 3266489917u;
        return vec3f(vec3u(n, n >> 8u, n >> 16u) & vec3u(0xFFu)) / 127.5 - 1.0;
    }

    fn moved_noise(p: vec3f) -> f32 {
        let cell = floor(p);
        let f = p - cell;
        let s = f * f * (3.0 - 2.0 * f);
        var sum = 0.0;
        for (var i = 0u; i < 8u; i++) {
            let corner = vec3u(i & 1u, (i >> 1u) & 1u, i >> 2u);
            let weight = select(1.0 - s, s, corner == vec3u(1u));
            let gradient = moved_hash(vec3i(cell) + vec3i(corner));
            sum += weight.x * weight.y * weight.z * dot(gradient, f - vec3f(corner));
        }
        return sum;
    }

    fn moved(position_world: vec3f, vertex: u32, time_s: f32) -> vec3f {
        let middle = vec3f(round(position_world.x / 3.0) * 3.0, 0.0, 1.5);
        let p = position_world * 1.7 - vec3f(0.0, 0.0, time_s);
        let height = 0.45 * moved_noise(p) + 0.15 * moved_noise(3.1 * p + 7.0);
        return position_world + normalize(position_world - middle) * height;
    }
";

/// No vertex is moved farther, in metres.
pub(crate) const MAX_OFFSET_M: f64 = 0.6;

/// Three spheres in a row, and a floor under them.
pub(crate) fn scene() -> Scene {
    let colors = [Vec3::new(0.8, 0.5, 0.2), Vec3::new(0.3, 0.6, 0.7), Vec3::new(0.7, 0.25, 0.3), Vec3::splat(0.6)];
    let sphere = |i: u8| shapes::icosphere(Vec3::new(3.0 * f32::from(i) - 3.0, 0.0, 1.5), 1.0, 4);
    let floor = shapes::sheet(Vec3::new(-12.0, -12.0, -0.5), Vec3::X * 24.0, Vec3::Y * 24.0, [1, 1]);
    let object = |(material, mut surface): (u32, Surface)| {
        surface.triangle_materials = vec![material; surface.triangles.len()];
        let mesh = Mesh::new(surface).expect("a shape is a good mesh");
        Object::new("", Arc::new(mesh), DAffine3::IDENTITY)
    };
    let objects = (0..).zip((0..3).map(sphere).chain([floor])).map(object).collect();
    let materials = colors.map(|base_color| Material { base_color, ..Material::default() }).to_vec();
    Scene { objects, materials, ..Scene::default() }
}

/// The objects of [`scene`] that move.
pub(crate) const MOVED: [usize; 3] = [0, 1, 2];

/// Looks down on all of it.
///
/// # Errors
///
/// For a size without pixels.
pub(crate) fn camera(size_px: [u32; 2]) -> Result<Camera, CameraError> {
    Camera::new(DVec3::new(1.5, -8.0, 4.2), DVec3::new(0.0, 0.0, 1.0), 0.7, 0.1, size_px)
}

/// A lamp among the spheres, one beside them, and the sun.
pub(crate) fn lights() -> [Light; 3] {
    let lamp = |x, y, z| LightPosition::point(DVec3::new(x, y, z));
    [
        Light::new("between", lamp(-1.4, -0.9, 2.3), Vec3::new(9.0, 6.0, 4.0)),
        Light::new("beside", lamp(5.5, -3.0, 3.5), Vec3::new(10.0, 14.0, 20.0)),
        Light::new("sun", LightPosition::sun(4.2, 0.6), Vec3::splat(0.7)),
    ]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let size_px = [960, 540];
    let (scene, camera, lights) = (scene(), camera(size_px)?, lights());
    let renderer = Renderer::new(pollster::block_on(Gpu::new(&AdapterChoice::default()))?, 4);
    let gpu = renderer.gpu();
    let mut casters = Caster::of_scene(&scene);
    let mut drawn = GpuScene::new(gpu, &casters, &scene.materials, &scene.textures)?;
    let noise = Displacement { wgsl: NOISE, max_offset_m: MAX_OFFSET_M, objects: &MOVED };
    let mut poser = pollster::block_on(GpuPoser::displacing(gpu, &scene.objects, &casters, &drawn, &noise))?;
    let look = Look::for_model(&Bounds::EMPTY, &lights);
    let shadows = ShadowOptions { silhouettes: SilhouetteSource::Gpu, ..ShadowOptions::default() };
    for i in 0..PICTURES {
        poser.show(gpu, &mut drawn, &scene.objects, &mut casters, i as f32 / PICTURES as f32);
        let shot = Shot { shadows, look: &look, ..Shot::new(&drawn, &casters, &camera, &lights) };
        let picture = pollster::block_on(renderer.picture(&shot))?;
        let [width, height] = size_px;
        let path = format!("displaced_spheres_{i}.png");
        image::save_buffer(path, &picture.rgba, width, height, image::ColorType::Rgba8)?;
    }
    Ok(())
}
