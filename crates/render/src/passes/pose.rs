//! Moving vertices, on devices that compute.

use std::num::NonZeroU64;

use bytemuck::{Pod, Zeroable};

use crate::{Gpu, shaders};

/// `Posed` in `pose.wgsl`: one object.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PosedUniform {
    pub(crate) vertex_count: u32,
    pub(crate) triangle_count: u32,
    pub(crate) near: u32,
    pub(crate) far: u32,
    pub(crate) positions: u32,
    pub(crate) offsets: u32,
    pub(crate) ranges: u32,
    pub(crate) influences: u32,
    pub(crate) triangles: u32,
    pub(crate) places: u32,
    pub(crate) weights: u32,
    pub(crate) joints: u32,
    pub(crate) origin_world: [f32; 3],
    pub(crate) morph_count: u32,
    pub(crate) has_skin: u32,
    pub(crate) time_s: f32,
    pub(crate) max_offset: f32,
    pub(crate) unused: u32,
}

/// Moves objects.
///
/// - reads: positions, offsets and influences at rest; weights and matrices of now
/// - writes: near and far vertices of volumes; positions and normals of surfaces
/// - needs: compute shaders, with four storage buffers
#[derive(Debug)]
pub(crate) struct PosePass {
    layout: wgpu::BindGroupLayout,
    vertices: wgpu::ComputePipeline,
    triangles: wgpu::ComputePipeline,
}

/// What [`PosePass`] reads and writes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseBuffers<'a> {
    /// A [`PosedUniform`] for each object, each at a multiple of [`PosePass::uniform_stride`].
    pub(crate) posed: &'a wgpu::Buffer,
    pub(crate) at_rest: &'a wgpu::Buffer,
    pub(crate) now: &'a wgpu::Buffer,
    pub(crate) volume: &'a wgpu::Buffer,
    pub(crate) surface: &'a wgpu::Buffer,
}

impl PosePass {
    /// `moved` is the source of what moves vertices besides.
    pub(crate) fn new(gpu: &Gpu, moved: &str) -> Self {
        let layout = layout(gpu);
        let pipeline_layout = super::pipeline_layout(gpu, "pose", &[Some(&layout)]);
        let module = shaders::pose(&gpu.device, moved);
        let pipeline = |entry_point| super::compute_pipeline(gpu, &pipeline_layout, &module, entry_point);
        let (vertices, triangles) = (pipeline("pose_vertices"), pipeline("pose_triangles"));
        Self { layout, vertices, triangles }
    }

    /// How far apart the uniforms of objects are.
    pub(crate) fn uniform_stride(gpu: &Gpu) -> usize {
        let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment as usize;
        size_of::<PosedUniform>().next_multiple_of(alignment)
    }

    pub(crate) fn group(&self, gpu: &Gpu, buffers: PoseBuffers<'_>) -> wgpu::BindGroup {
        let posed = wgpu::BufferBinding { buffer: buffers.posed, offset: 0, size: POSED_SIZE };
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("pose"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(posed) },
                whole(1, buffers.at_rest),
                whole(2, buffers.now),
                whole(3, buffers.volume),
                whole(4, buffers.surface),
            ],
        })
    }

    /// Moves the objects that are numbered, each with its vertex and triangle count.
    pub(crate) fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        group: &wgpu::BindGroup,
        objects: &[(usize, [u32; 2])],
    ) {
        let stride = Self::uniform_stride(gpu);
        let most_groups = gpu.device.limits().max_compute_workgroups_per_dimension;
        let mut pass =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("pose"), timestamp_writes: None });
        for (which, pipeline) in [&self.vertices, &self.triangles].into_iter().enumerate() {
            pass.set_pipeline(pipeline);
            for &(object, counts) in objects {
                pass.set_bind_group(0, group, &[(object * stride) as u32]);
                let [across, down] = super::groups(most_groups, counts[which].div_ceil(GROUP_SIZE));
                pass.dispatch_workgroups(across, down, 1);
            }
        }
    }
}

fn whole(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }
}

const POSED_SIZE: Option<NonZeroU64> = NonZeroU64::new(size_of::<PosedUniform>() as u64);

/// `@workgroup_size` in `pose.wgsl`.
const GROUP_SIZE: u32 = 64;

fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entry = |binding, ty, has_dynamic_offset, min_binding_size| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size },
        count: None,
    };
    let storage = |binding, read_only| entry(binding, wgpu::BufferBindingType::Storage { read_only }, false, None);
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("pose"),
        entries: &[
            entry(0, wgpu::BufferBindingType::Uniform, true, POSED_SIZE),
            storage(1, true),
            storage(2, true),
            storage(3, false),
            storage(4, false),
        ],
    })
}
