//! The pipelines that add up the volumes of smooth bodies that were found on the GPU.

use crate::passes::{Layouts, SMOOTH_JOB_SIZE, pipeline_layout};
use crate::shadow::emit::Part;
use crate::shadow::found::pipelines::FoldPass;
use crate::shadow::pipelines::{Kind, MARK, ShadowTarget, pipeline, summing};
use crate::{Gpu, shaders};

/// What of a smooth volume is drawn, in the order of the arguments in `find_smooth.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SmoothShape {
    SidesInPass,
    /// Folds and fins.
    FacesInPass,
    SidesInFail,
    FacesInFail,
    /// The dark cap as a fan over the sides.
    Fan,
    /// The dark cap as the light cap at infinity, and what closes it.
    DarkCaps,
    DarkFaces,
    LightCap,
}

impl SmoothShape {
    pub(crate) const ALL: [Self; 8] = [
        Self::SidesInPass,
        Self::FacesInPass,
        Self::SidesInFail,
        Self::FacesInFail,
        Self::Fan,
        Self::DarkCaps,
        Self::DarkFaces,
        Self::LightCap,
    ];

    fn how(self) -> (Part, &'static str) {
        match self {
            Self::SidesInPass => (Part::Pass, "vs_smooth_sides"),
            Self::FacesInPass => (Part::Pass, "vs_smooth_faces"),
            Self::SidesInFail => (Part::Fail, "vs_smooth_sides"),
            Self::FacesInFail => (Part::Fail, "vs_smooth_faces"),
            Self::Fan => (Part::Fail, "vs_smooth_fan"),
            Self::DarkCaps => (Part::Fail, "vs_smooth_dark_caps"),
            Self::DarkFaces => (Part::Fail, "vs_smooth_dark_faces"),
            Self::LightCap => (Part::LightCap, "vs_smooth_light_cap"),
        }
    }
}

/// A pipeline for each shape, which adds up where the mark is, in the only colour attachment; and what takes the mark away then.
#[derive(Debug)]
pub(crate) struct SmoothDrawing {
    pipelines: [wgpu::RenderPipeline; SmoothShape::ALL.len()],
    pub(crate) fold: FoldPass,
}

impl SmoothDrawing {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, target: &ShadowTarget<'_>) -> Self {
        let module = shaders::found_smooth_volume(&gpu.device);
        let groups = [Some(&layouts.view), Some(&layouts.light), Some(&draw_layout(gpu))];
        let layout = pipeline_layout(gpu, "view, light and found smooth", &groups);
        let summed = ShadowTarget { color_formats: &[Some(gpu.caps.tally_format)], ..*target };
        let face = wgpu::StencilFaceState { compare: wgpu::CompareFunction::Equal, ..wgpu::StencilFaceState::IGNORE };
        let pipelines = SmoothShape::ALL.map(|shape| {
            let (part, entry_point) = shape.how();
            let (depth_compare, front_face, operation) = summing(part);
            let kind = Kind {
                label: "found smooth volumes, summed",
                entry_point,
                depth_compare,
                stencil: wgpu::StencilState { front: face, back: face, read_mask: MARK, write_mask: 0 },
                front_face,
                fragment: Some(("fs_signed", operation)),
            };
            pipeline(&gpu.device, &module, &layout, &summed, &kind)
        });
        Self { pipelines, fold: FoldPass::new(gpu, target) }
    }

    /// What draws `shape`.
    pub(crate) fn of(&self, shape: SmoothShape) -> &wgpu::RenderPipeline {
        &self.pipelines[shape as usize]
    }
}

/// Group 2 of `found_smooth_volume.wgsl`: a job at a dynamic offset, tables, positions, points, lists.
pub(super) fn draw_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entry = |binding, ty, has_dynamic_offset, min_binding_size| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size },
        count: None,
    };
    let storage = |binding| entry(binding, wgpu::BufferBindingType::Storage { read_only: true }, false, None);
    let job = entry(0, wgpu::BufferBindingType::Uniform, true, SMOOTH_JOB_SIZE);
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("found smooth volumes"),
        entries: &[job, storage(1), storage(2), storage(3), storage(4)],
    })
}

/// `buffers` are jobs, tables, positions, points and lists.
pub(super) fn draw_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    [jobs, others @ ..]: [&wgpu::Buffer; 5],
) -> wgpu::BindGroup {
    let job = wgpu::BufferBinding { buffer: jobs, offset: 0, size: SMOOTH_JOB_SIZE };
    let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(job) }];

    for (binding, buffer) in (1..).zip(others) {
        entries.push(wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
    }
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("found smooth volumes"),
        layout,
        entries: &entries,
    })
}
