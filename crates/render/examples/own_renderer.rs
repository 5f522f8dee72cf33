//! Shadows in a forward renderer of your own: one render pass, your shaders, your formats.
//!
//! `umbrae-render` adds the vertices of casters, the volumes of each light, and a call inside your pass after which the stencil is [`LIT`] where
//! the light reaches. Your part: depth drawn from the same positions by the same matrix, and each light added with a stencil test.
//!
//! Run with `cargo run -p umbrae-render --example own_renderer`; it writes `own_renderer.png`.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3, Vec4};
use umbrae_core::{Camera, Caster, Light, LightPosition, Mesh, Object, Scene, shapes};
use umbrae_render::{AdapterChoice, Gpu, GpuError, LIT, ShadowCasters, ShadowOptions, ShadowTarget, Shadows};
use wgpu::util::DeviceExt as _;

pub(crate) const SIZE_PX: [u32; 2] = [640, 400];
pub(crate) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth24PlusStencil8;

/// `@invariant`, and the plain product: so that your surfaces and the volumes agree to the last bit.
const SHADER: &str = "
struct Frame { clip_from_world: mat4x4f, light: vec4f, strength: vec4f }
@group(0) @binding(0) var<uniform> frame: Frame;
struct Fragment { @builtin(position) @invariant clip: vec4f, @location(0) world: vec3f, @location(1) normal: vec3f }
@vertex fn vs(@location(0) position: vec3f, @location(1) normal: vec3f) -> Fragment {
    return Fragment(frame.clip_from_world * vec4f(position, 1.0), position, normal);
}
@fragment fn ambient() -> @location(0) vec4f { return vec4f(0.03, 0.035, 0.05, 1.0); }
@fragment fn lit(in: Fragment) -> @location(0) vec4f {
    let to_light = frame.light.xyz - in.world * frame.light.w;
    let falloff = select(1.0, 1.0 / dot(to_light, to_light), frame.light.w > 0.5);
    return vec4f(frame.strength.rgb * max(dot(in.normal, normalize(to_light)), 0.0) * falloff, 0.0);
}";

/// A floor, a ring and a post.
pub(crate) fn casters() -> Vec<Caster> {
    let object = |surface| {
        let mesh = Arc::new(Mesh::new(surface).expect("shapes are good meshes"));
        Object::new("", mesh, DAffine3::IDENTITY)
    };
    let floor = shapes::cuboid(Vec3::new(-6.0, -6.0, -0.2), Vec3::new(6.0, 6.0, 0.0));
    let ring = shapes::torus(Vec3::new(-0.4, 0.3, 1.4), 1.2, 0.35, 48, 24);
    let post = shapes::cuboid(Vec3::new(1.9, -0.9, 0.001), Vec3::new(2.5, -0.3, 2.9));
    let objects = [floor, ring, post].map(object).to_vec();
    Caster::of_scene(&Scene { objects, ..Scene::default() })
}

/// A view from above.
pub(crate) fn camera() -> Camera {
    Camera::new(DVec3::new(4.0, -8.0, 6.0), DVec3::new(0.2, 0.0, 0.6), 0.75, 0.1, SIZE_PX).expect("a good camera")
}

/// A warm sun and a blue lamp.
pub(crate) fn lights() -> [Light; 2] {
    let (sun, lamp) = (LightPosition::sun(1.0, 0.7), LightPosition::point(DVec3::new(-2.5, -2.0, 3.2)));
    [Light::new("sun", sun, Vec3::new(0.55, 0.45, 0.3)), Light::new("lamp", lamp, Vec3::new(1.0, 2.0, 4.5))]
}

/// Draws them: four bytes a pixel, sRGB.
pub(crate) async fn picture(casters: &[Caster], camera: &Camera, lights: &[Light]) -> Result<Vec<u8>, GpuError> {
    // A device of your own goes in with `Gpu::of_device`.
    let gpu = Gpu::new(&AdapterChoice::default()).await?;
    let device = &gpu.device;
    let vertices: Vec<[Vec3; 2]> = casters.iter().flat_map(corners).collect();
    let surface = buffer(device, bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX);
    let [ambient, lit] = pipelines(device);

    // Once: pipelines for your pass, and the casters' vertices.
    let target = ShadowTarget { depth_stencil_format: DEPTH, samples: 1, color_formats: &[Some(COLOR)] };
    let shadows = Shadows::new(&gpu, &target);
    let uploaded = ShadowCasters::new(&gpu, casters)?;
    // For each frame: what the camera sees, and each light's volumes.
    let view = shadows.view(&gpu, casters, camera);
    let volumes = lights
        .iter()
        .map(|light| shadows.light(&gpu, casters, &uploaded, &view, light, &ShadowOptions::default()))
        .collect::<Result<Vec<_>, _>>()?;
    let frame = |pipeline, light| frame_group(device, pipeline, camera, light);

    let color = texture(device, COLOR);
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &color.create_view(&Default::default()),
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &texture(device, DEPTH).create_view(&Default::default()),
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Discard }),
        }),
        ..Default::default()
    });
    let draw = |pass: &mut wgpu::RenderPass<'_>, pipeline, frame: &wgpu::BindGroup| {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_vertex_buffer(0, surface.slice(..));
        pass.set_stencil_reference(LIT);
        pass.draw(0..vertices.len() as u32, 0..1);
    };
    draw(&mut pass, &ambient, &frame(&ambient, &lights[0]));
    for (light, volumes) in lights.iter().zip(&volumes) {
        shadows.draw(&mut pass, &uploaded, &view, volumes);
        draw(&mut pass, &lit, &frame(&lit, light));
    }
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    gpu.read(&color).await
}

/// Position and normal of each corner.
pub(crate) fn corners(caster: &Caster) -> Vec<[Vec3; 2]> {
    let triangles = (0..caster.mesh.triangles().len()).map(|t| caster.corners(t));
    triangles.flat_map(|[a, b, c]| [a, b, c].map(|p| [p, (b - a).cross(c - a).normalize_or_zero()])).collect()
}

pub(crate) fn frame_group(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    camera: &Camera,
    light: &Light,
) -> wgpu::BindGroup {
    let [x, y, z, w] = camera.clip_from_world().as_mat4().to_cols_array_2d().map(Vec4::from_array);
    let columns = [x, y, z, w, light.position.homogeneous().as_vec4(), light.strength.extend(0.0)];
    let uniform = buffer(device, bytemuck::cast_slice(&columns), wgpu::BufferUsages::UNIFORM);
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
    })
}

/// Depth with ambient light, and one light added where the stencil is [`LIT`]; both with reversed depth, both sides.
pub(crate) fn pipelines(device: &wgpu::Device) -> [wgpu::RenderPipeline; 2] {
    let source = wgpu::ShaderSource::Wgsl(SHADER.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    let step_mode = wgpu::VertexStepMode::Vertex;
    let vertices = [Some(wgpu::VertexBufferLayout { array_stride: 24, step_mode, attributes: &attributes })];
    let is_lit = wgpu::StencilFaceState { compare: wgpu::CompareFunction::Equal, ..wgpu::StencilFaceState::IGNORE };
    let add = wgpu::BlendComponent { dst_factor: wgpu::BlendFactor::One, ..wgpu::BlendComponent::REPLACE };
    let make = |entry_point, compare, face, blend: Option<wgpu::BlendState>| {
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(entry_point),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs"),
                compilation_options: Default::default(),
                buffers: &vertices,
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(blend.is_none()),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xFF, write_mask: 0 },
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState { format: COLOR, blend, write_mask: wgpu::ColorWrites::ALL })],
            }),
            multiview_mask: None,
            cache: None,
        })
    };
    [
        make("ambient", wgpu::CompareFunction::Greater, wgpu::StencilFaceState::IGNORE, None),
        make("lit", wgpu::CompareFunction::Equal, is_lit, Some(wgpu::BlendState { color: add, alpha: add })),
    ]
}

pub(crate) fn buffer(device: &wgpu::Device, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
}

pub(crate) fn texture(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIZE_PX[0], height: SIZE_PX[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rgba = pollster::block_on(picture(&casters(), &camera(), &lights()))?;
    image::save_buffer("own_renderer.png", &rgba, SIZE_PX[0], SIZE_PX[1], image::ColorType::Rgba8)?;
    Ok(())
}
