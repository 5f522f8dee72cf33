//! Finding silhouettes, on devices that compute.

use bytemuck::{Pod, Zeroable};

use crate::{Gpu, shaders};

/// `Finding` in `find.wgsl`: one frame.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FindingUniform {
    pub(crate) light_count: u32,
    pub(crate) words: u32,
    pub(crate) job_count: u32,
    pub(crate) triangle_blocks: u32,
    pub(crate) triangle_block_count: u32,
    pub(crate) edge_blocks: u32,
    pub(crate) edge_block_count: u32,
    pub(crate) unused: u32,
    pub(crate) near_min: [f32; 4],
    pub(crate) near_max: [f32; 4],
    pub(crate) near_corners: [[f32; 4]; 4],
}

/// Planes of `FoundLight` in `find.wgsl`.
pub(crate) const MOST_PLANES: usize = 16;

/// `FoundLight` in `find.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FoundLightData {
    pub(crate) position_world: [f32; 4],
    pub(crate) plane_count: u32,
    pub(crate) unused_a: u32,
    pub(crate) unused_b: u32,
    pub(crate) unused_c: u32,
    pub(crate) planes: [[f32; 4]; MOST_PLANES],
}

/// `Job` in `job.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct JobUniform {
    pub(crate) near: u32,
    pub(crate) far: u32,
    pub(crate) axes: u32,
    pub(crate) edges: u32,
    pub(crate) triangles: u32,
    pub(crate) sides: u32,
    pub(crate) caps: u32,
    pub(crate) flags: u32,
    pub(crate) box_min: [f32; 3],
    pub(crate) edge_on: f32,
    pub(crate) box_max: [f32; 3],
    pub(crate) slack: f32,
}

/// Bits of [`JobUniform::flags`].
pub(crate) mod job_flags {
    pub(crate) const SEE_THROUGH: u32 = 1;
    pub(crate) const NEEDS_CAPS: u32 = 2;
    pub(crate) const UNDECIDED: u32 = 4;
    pub(crate) const FAILS: u32 = 8;
    pub(crate) const DIRECTIONAL: u32 = 16;
    pub(crate) const FAN: u32 = 32;
    pub(crate) const MOVED: u32 = 64;
}

/// `JobSlot` in `find.wgsl`, at an offset at which any device binds uniform buffers.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct JobSlot {
    pub(crate) job: JobUniform,
    pub(crate) unused: [[u32; 4]; 12],
}

/// Finds the silhouettes of all lights of a frame.
///
/// - reads: positions, tables of casters, lights, jobs
/// - writes: coefficients, lists of sides and caps, arguments of draws
/// - needs: compute shaders, with eight storage buffers; results that are 0
#[derive(Debug)]
pub(crate) struct FindPass {
    layout: wgpu::BindGroupLayout,
    triangles: wgpu::ComputePipeline,
    edges: wgpu::ComputePipeline,
    arguments: wgpu::ComputePipeline,
}

/// What [`FindPass`] reads and writes, in the order of its bindings.
pub(crate) type FindBuffers<'a> = [&'a wgpu::Buffer; 9];

impl FindPass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let storage = |binding, read_only| entry(binding, wgpu::BufferBindingType::Storage { read_only });
        let mut entries = [entry(0, wgpu::BufferBindingType::Uniform); 9];
        for (binding, at) in entries.iter_mut().enumerate().skip(1) {
            *at = storage(binding as u32, binding < 6);
        }
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("find silhouettes"),
            entries: &entries,
        });
        let pipeline_layout = super::pipeline_layout(gpu, "find silhouettes", &[Some(&layout)]);
        let module = shaders::find(&gpu.device);
        let pipeline = |entry_point| super::compute_pipeline(gpu, &pipeline_layout, &module, entry_point);
        let [triangles, edges, arguments] = ["find_triangles", "find_edges", "find_arguments"].map(pipeline);
        Self { layout, triangles, edges, arguments }
    }

    pub(crate) fn group(&self, gpu: &Gpu, buffers: FindBuffers<'_>) -> wgpu::BindGroup {
        let entry = |binding: usize| wgpu::BindGroupEntry {
            binding: binding as u32,
            resource: buffers[binding].as_entire_binding(),
        };
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("find silhouettes"),
            layout: &self.layout,
            entries: &std::array::from_fn::<_, 9, _>(entry),
        })
    }

    /// Goes through all blocks, once for all lights; the groups of each step are in two dimensions, as one can't have enough.
    pub(crate) fn draw(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, groups: [[u32; 2]; 3]) {
        pass.set_bind_group(0, group, &[]);
        for (pipeline, [across, down]) in [&self.triangles, &self.edges, &self.arguments].into_iter().zip(groups) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(across, down, 1);
        }
    }
}
