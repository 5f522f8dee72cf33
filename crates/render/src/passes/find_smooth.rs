//! Finding smooth silhouettes, on devices that compute.

use std::num::NonZeroU64;

use bytemuck::{Pod, Zeroable};

use super::groups;
use crate::{Gpu, shaders};

/// `SmoothJob` in `smooth_job.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SmoothJobUniform {
    pub(crate) position_world: [f32; 4],
    pub(crate) eye_world: [f32; 3],
    pub(crate) pixel_at_1: f32,
    pub(crate) receivers_min: [f32; 3],
    pub(crate) epsilon_m: f32,
    pub(crate) receivers_max: [f32; 3],
    pub(crate) epsilon_px: f32,
    pub(crate) near: u32,
    pub(crate) axes: u32,
    pub(crate) flags: u32,
    pub(crate) number: u32,
    pub(crate) light: u32,
    pub(crate) slack: f32,
    pub(crate) most_inset_m: f32,
    pub(crate) inner_room: u32,
    pub(crate) vertices: u32,
    pub(crate) corner_starts: u32,
    pub(crate) wedge_count: u32,
    pub(crate) triangles: u32,
    pub(crate) triangle_edges: u32,
    pub(crate) triangle_count: u32,
    pub(crate) edges: u32,
    pub(crate) edge_triangles: u32,
    pub(crate) bends: u32,
    pub(crate) edge_count: u32,
    pub(crate) creases: u32,
    pub(crate) crease_count: u32,
    pub(crate) normals: u32,
    pub(crate) heights: u32,
    pub(crate) crossings: u32,
    pub(crate) inner: u32,
    pub(crate) sides: u32,
    pub(crate) faces: u32,
    pub(crate) caps: u32,
    pub(crate) inner_places: u32,
}

/// Bits of [`SmoothJobUniform::flags`].
pub(crate) mod smooth_flags {
    pub(crate) const CURVED: u32 = 1;
    pub(crate) const NEEDS_CAPS: u32 = 2;
    pub(crate) const UNDECIDED: u32 = 4;
    pub(crate) const FAILS: u32 = 8;
    pub(crate) const DIRECTIONAL: u32 = 16;
}

/// A job at an offset at which any device binds uniform buffers.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SmoothJobSlot {
    pub(crate) job: SmoothJobUniform,
    pub(crate) unused: [[u32; 4]; 5],
}

/// The size of a job for whoever binds it.
pub(crate) const SMOOTH_JOB_SIZE: Option<NonZeroU64> = NonZeroU64::new(size_of::<SmoothJobUniform>() as u64);

/// The offset of a job among slots.
pub(crate) fn smooth_job_offset(number: u32) -> u32 {
    number * size_of::<SmoothJobSlot>() as u32
}

/// `@workgroup_size` in `find_smooth.wgsl`.
const GROUP_SIZE: u32 = 64;

/// The steps of finding, in order.
const STEPS: [&str; 7] = [
    "find_normals",
    "find_inner_places",
    "find_heights",
    "find_crossings",
    "find_faces",
    "find_creases",
    "find_smooth_arguments",
];

/// Finds the smooth silhouettes of all lights of a frame.
///
/// - reads: positions, tables of bodies, lights, jobs
/// - writes: normals and inner places of what has moved, heights, points, lists of sides, faces and caps, arguments of draws
/// - needs: compute shaders, with eight storage buffers; results that are 0
#[derive(Debug)]
pub(crate) struct FindSmoothPass {
    layout: wgpu::BindGroupLayout,
    steps: [wgpu::ComputePipeline; STEPS.len()],
    /// Across, or down.
    most_groups: u32,
}

/// What [`FindSmoothPass`] reads and writes, in the order of its bindings.
pub(crate) type FindSmoothBuffers<'a> = [&'a wgpu::Buffer; 10];

/// How much one job goes through.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SmoothAmounts {
    /// 0 where normals and inner places are as they were uploaded, or somebody else's job computes them.
    pub(crate) moved_wedges: u32,
    pub(crate) wedges: u32,
    pub(crate) edges: u32,
    pub(crate) triangles: u32,
    pub(crate) creases: u32,
}

impl FindSmoothPass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let entry = |binding, ty, has_dynamic_offset, min_binding_size| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size },
            count: None,
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let mut entries = vec![entry(0, uniform, false, None), entry(1, uniform, true, SMOOTH_JOB_SIZE)];
        let storage = |binding| wgpu::BufferBindingType::Storage { read_only: binding < 5 };
        entries.extend((2..10).map(|binding| entry(binding, storage(binding), false, None)));
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("find smooth silhouettes"),
            entries: &entries,
        });
        let pipeline_layout = super::pipeline_layout(gpu, "find smooth silhouettes", &[Some(&layout)]);
        let module = shaders::find_smooth(&gpu.device);
        let steps = STEPS.map(|entry_point| super::compute_pipeline(gpu, &pipeline_layout, &module, entry_point));
        Self { layout, steps, most_groups: gpu.device.limits().max_compute_workgroups_per_dimension }
    }

    pub(crate) fn group(&self, gpu: &Gpu, buffers: FindSmoothBuffers<'_>) -> wgpu::BindGroup {
        let entry = |binding: usize| {
            let resource = if binding == 1 {
                wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: buffers[binding],
                    offset: 0,
                    size: SMOOTH_JOB_SIZE,
                })
            } else {
                buffers[binding].as_entire_binding()
            };
            wgpu::BindGroupEntry { binding: binding as u32, resource }
        };
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("find smooth silhouettes"),
            layout: &self.layout,
            entries: &std::array::from_fn::<_, 10, _>(entry),
        })
    }

    /// Goes through `jobs` in each step, one after the other.
    pub(crate) fn draw(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, jobs: &[SmoothAmounts]) {
        for (step, pipeline) in self.steps.iter().enumerate() {
            pass.set_pipeline(pipeline);
            for (number, job) in (0..).zip(jobs) {
                let SmoothAmounts { moved_wedges, wedges, edges, triangles, creases } = *job;
                let threads = [moved_wedges, moved_wedges, wedges, edges, triangles, creases, 1][step];
                if threads > 0 {
                    let [across, down] = groups(self.most_groups, threads.div_ceil(GROUP_SIZE));
                    pass.set_bind_group(0, group, &[smooth_job_offset(number)]);
                    pass.dispatch_workgroups(across, down, 1);
                }
            }
        }
    }
}
