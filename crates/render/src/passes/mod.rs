//! The passes. Each owns its pipelines: `new` compiles, `draw` records.

mod find;
mod find_smooth;
mod glass;
mod light;
mod overlay;
mod pose;
mod sphere;
mod surface;
mod tone;

pub(crate) use find::{FindPass, FindingUniform, FoundLightData, JobSlot, JobUniform, MOST_PLANES, job_flags};
pub(crate) use find_smooth::{
    FindSmoothPass, SMOOTH_JOB_SIZE, SmoothAmounts, SmoothJobSlot, SmoothJobUniform, smooth_flags, smooth_job_offset,
};
pub(crate) use glass::{GlassFrame, GlassPass};
pub(crate) use light::{LightPass, SoftSurfaces};
pub(crate) use overlay::{GpuOverlay, OverlayPass};
pub(crate) use pose::{PoseBuffers, PosePass, PosedUniform};
pub(crate) use sphere::{GpuSpheres, SpherePass};
pub(crate) use surface::SurfacePass;
pub(crate) use tone::TonePass;

use crate::{Gpu, gpu_finishes, uniforms};

/// The groups that passes share: 0 the view, 1 the light, 2 the finish of surfaces.
#[derive(Debug)]
pub(crate) struct Layouts {
    pub(crate) view: wgpu::BindGroupLayout,
    pub(crate) light: wgpu::BindGroupLayout,
    pub(crate) finish: wgpu::BindGroupLayout,
    pub(crate) view_and_light: wgpu::PipelineLayout,
    /// Surfaces without a light.
    pub(crate) view_and_finish: wgpu::PipelineLayout,
    /// Surfaces with one.
    pub(crate) view_light_and_finish: wgpu::PipelineLayout,
}

impl Layouts {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let view = uniform_layout(gpu, "view", size_of::<uniforms::View>());
        let light = uniform_layout(gpu, "light", size_of::<uniforms::LightUniform>());
        let finish = gpu_finishes::layout(gpu);
        let view_and_light = pipeline_layout(gpu, "view and light", &[Some(&view), Some(&light)]);
        let view_and_finish = pipeline_layout(gpu, "view and finish", &[Some(&view), None, Some(&finish)]);
        let view_light_and_finish =
            pipeline_layout(gpu, "view, light and finish", &[Some(&view), Some(&light), Some(&finish)]);
        Self { view, light, finish, view_and_light, view_and_finish, view_light_and_finish }
    }
}

pub(crate) fn uniform_layout(gpu: &Gpu, label: &str, size: usize) -> wgpu::BindGroupLayout {
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

pub(crate) fn pipeline_layout(
    gpu: &Gpu,
    label: &str,
    groups: &[Option<&wgpu::BindGroupLayout>],
) -> wgpu::PipelineLayout {
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: groups,
        immediate_size: 0,
    })
}

/// A pipeline of the compute shader `entry_point` of `module`, which is its label too.
pub(crate) fn compute_pipeline(
    gpu: &Gpu,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    entry_point: &str,
) -> wgpu::ComputePipeline {
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(layout),
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

/// How many workgroups there must be in two dimensions for `groups` of them, where there may be `most` in one.
pub(crate) fn groups(most: u32, groups: u32) -> [u32; 2] {
    let across = groups.min(most).max(1);
    [across, groups.div_ceil(across)]
}

/// A uniform buffer with `bytes` in it, bound alone in a group.
pub(crate) fn uniform_group(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, bytes: &[u8]) -> wgpu::BindGroup {
    uniform_buffer_and_group(gpu, label, layout, bytes).1
}

/// As [`uniform_group`], with the buffer, to be written again.
pub(crate) fn uniform_buffer_and_group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    bytes: &[u8],
) -> (wgpu::Buffer, wgpu::BindGroup) {
    use wgpu::util::DeviceExt as _;
    let buffer = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents: bytes,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
    });
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    });
    (buffer, group)
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
