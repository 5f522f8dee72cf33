//! Shadows in a forward renderer of your own: one render pass, your shaders, your formats.
//!
//! `umbrae-render` adds three things to what you have: vertices of casters on the device, volumes for each light and frame, and a call
//! inside your pass after which the stencil is [`LIT`] where the light reaches. Your part is depth drawn from the same positions with the
//! same matrix, and an additive pass for each light with a stencil test.
//!
//! Run with `cargo run -p umbrae-render --example own_renderer`; it writes `own_renderer.png`.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Mesh, Object, Scene, shapes};
use umbrae_render::{AdapterChoice, Gpu, GpuError, LIT, ShadowCasters, ShadowOptions, ShadowTarget, Shadows};
use wgpu::util::DeviceExt as _;

const SIZE_PX: [u32; 2] = [640, 400];
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth24PlusStencil8;

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
    let object = |name: &str, surface| {
        let mesh = Arc::new(Mesh::new(surface).expect("shapes are good meshes"));
        Object::new(name, mesh, DAffine3::IDENTITY)
    };
    let objects = vec![
        object("floor", shapes::cuboid(Vec3::new(-6.0, -6.0, -0.2), Vec3::new(6.0, 6.0, 0.0))),
        object("ring", shapes::torus(Vec3::new(-0.4, 0.3, 1.4), 1.2, 0.35, 48, 24)),
        object("post", shapes::cuboid(Vec3::new(1.9, -0.9, 0.001), Vec3::new(2.5, -0.3, 2.9))),
    ];
    Caster::of_scene(&Scene { objects, ..Scene::default() })
}

/// A view from above.
pub(crate) fn camera() -> Camera {
    Camera::new(DVec3::new(4.0, -8.0, 6.0), DVec3::new(0.2, 0.0, 0.6), 0.75, 0.1, SIZE_PX).expect("a good camera")
}

/// A warm sun and a blue lamp.
pub(crate) fn lights() -> [Light; 2] {
    let lamp = LightPosition::point(DVec3::new(-2.5, -2.0, 3.2));
    [
        Light::new("sun", LightPosition::sun(1.0, 0.7), Vec3::new(0.55, 0.45, 0.3)),
        Light::new("lamp", lamp, Vec3::new(1.0, 2.0, 4.5)),
    ]
}

/// Draws them: four bytes a pixel, sRGB.
///
/// # Errors
///
/// When there is no device.
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
    let options = ShadowOptions::default();
    let volumes = lights
        .iter()
        .map(|light| shadows.light(&gpu, casters, &uploaded, &view, light, &options))
        .collect::<Result<Vec<_>, _>>()?;
    let frames: Vec<wgpu::BindGroup> =
        lights.iter().map(|light| frame_group(device, &ambient, camera, light)).collect();

    let color = texture(device, COLOR);
    let (color_view, depth_view) =
        (color.create_view(&Default::default()), texture(device, DEPTH).create_view(&Default::default()));
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &color_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth_view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Discard }),
        }),
        ..Default::default()
    });
    let draw = |pass: &mut wgpu::RenderPass<'_>, pipeline, frame| {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_vertex_buffer(0, surface.slice(..));
        pass.set_stencil_reference(LIT);
        pass.draw(0..vertices.len() as u32, 0..1);
    };
    draw(&mut pass, &ambient, &frames[0]);
    for (light, frame) in volumes.iter().zip(&frames) {
        shadows.draw(&mut pass, &uploaded, &view, light);
        draw(&mut pass, &lit, frame);
    }
    drop(pass);
    Ok(read(&gpu, encoder, &color))
}

fn corners(caster: &Caster) -> Vec<[Vec3; 2]> {
    let flat = |t| {
        let [a, b, c] = caster.corners(t);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        [[a, normal], [b, normal], [c, normal]]
    };
    (0..caster.mesh.triangles().len()).flat_map(flat).collect()
}

fn frame_group(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    camera: &Camera,
    light: &Light,
) -> wgpu::BindGroup {
    let mut floats = camera.clip_from_world().as_mat4().to_cols_array().to_vec();
    floats.extend(light.position.homogeneous().as_vec4().to_array());
    floats.extend(light.strength.extend(0.0).to_array());
    let uniform = buffer(device, bytemuck::cast_slice(&floats), wgpu::BufferUsages::UNIFORM);
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
    })
}

/// Depth with ambient light, and one light added where the stencil is [`LIT`]; both with reversed depth, both sides.
fn pipelines(device: &wgpu::Device) -> [wgpu::RenderPipeline; 2] {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let entry = wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let group = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &[entry] });
    let layout = wgpu::PipelineLayoutDescriptor { label: None, bind_group_layouts: &[Some(&group)], immediate_size: 0 };
    let layout = device.create_pipeline_layout(&layout);
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    let is_lit = wgpu::StencilFaceState { compare: wgpu::CompareFunction::Equal, ..wgpu::StencilFaceState::IGNORE };
    let make = |entry_point, compare, face, blend: Option<wgpu::BlendState>| {
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let vertex = wgpu::VertexBufferLayout {
            array_stride: 24,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        };
        let stencil = wgpu::StencilState { front: face, back: face, read_mask: 0xFF, write_mask: 0 };
        let write_mask = wgpu::ColorWrites::ALL;
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs"),
                compilation_options: Default::default(),
                buffers: &[Some(vertex)],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(blend.is_none()),
                depth_compare: Some(compare),
                stencil,
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState { format: COLOR, blend, write_mask })],
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

fn buffer(device: &wgpu::Device, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
}

fn texture(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::Texture {
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

/// A row of 640 pixels needs no padding.
fn read(gpu: &Gpu, mut encoder: wgpu::CommandEncoder, color: &wgpu::Texture) -> Vec<u8> {
    let to = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(SIZE_PX[0] * SIZE_PX[1] * 4),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(SIZE_PX[0] * 4), ..Default::default() };
    let copy = wgpu::TexelCopyBufferInfo { buffer: &to, layout };
    encoder.copy_texture_to_buffer(color.as_image_copy(), copy, color.size());
    gpu.queue.submit([encoder.finish()]);
    to.map_async(wgpu::MapMode::Read, .., |result| result.expect("a small buffer can be mapped"));
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    to.get_mapped_range(..).expect("the buffer is mapped").to_vec()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rgba = pollster::block_on(picture(&casters(), &camera(), &lights()))?;
    image::save_buffer("own_renderer.png", &rgba, SIZE_PX[0], SIZE_PX[1], image::ColorType::Rgba8)?;
    Ok(())
}
