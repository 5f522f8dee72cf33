//! The passes. Each owns its pipelines: `new` compiles, `draw` records.

mod light;
mod surface;
mod tone;

pub(crate) use light::LightPass;
pub(crate) use surface::SurfacePass;
pub(crate) use tone::TonePass;

use crate::{Gpu, uniforms};

/// The two groups that most passes share: 0 the view, 1 the light.
#[derive(Debug)]
pub(crate) struct Layouts {
    pub(crate) view: wgpu::BindGroupLayout,
    pub(crate) light: wgpu::BindGroupLayout,
    pub(crate) view_only: wgpu::PipelineLayout,
    pub(crate) view_and_light: wgpu::PipelineLayout,
}

impl Layouts {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let view = uniform_layout(gpu, "view", size_of::<uniforms::View>());
        let light = uniform_layout(gpu, "light", size_of::<uniforms::LightUniform>());
        let view_only = pipeline_layout(gpu, "view only", &[&view]);
        let view_and_light = pipeline_layout(gpu, "view and light", &[&view, &light]);
        Self { view, light, view_only, view_and_light }
    }
}

fn uniform_layout(gpu: &Gpu, label: &str, size: usize) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: std::num::NonZeroU64::new(size as u64),
            },
            count: None,
        }],
    })
}

pub(crate) fn pipeline_layout(gpu: &Gpu, label: &str, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().copied().map(Some).collect();
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

/// A uniform buffer with `bytes` in it, bound alone in a group.
pub(crate) fn uniform_group(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, bytes: &[u8]) -> wgpu::BindGroup {
    use wgpu::util::DeviceExt as _;
    let buffer = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents: bytes,
        usage: wgpu::BufferUsages::UNIFORM,
    });
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    })
}

/// Two-sided triangles, as everything here is drawn.
pub(crate) const BOTH_SIDES: wgpu::PrimitiveState = wgpu::PrimitiveState {
    topology: wgpu::PrimitiveTopology::TriangleList,
    strip_index_format: None,
    front_face: wgpu::FrontFace::Ccw,
    cull_mode: None,
    unclipped_depth: false,
    polygon_mode: wgpu::PolygonMode::Fill,
    conservative: false,
};
