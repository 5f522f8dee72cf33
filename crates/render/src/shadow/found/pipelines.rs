//! The pipelines that draw found volumes: into the stencil, and, where that can't count as far, into a float target.

use std::num::NonZeroU64;

use super::jobs::Shape;
use crate::passes::{JobSlot, JobUniform, Layouts, pipeline_layout};
use crate::shadow::emit::Part;
use crate::shadow::pipelines::{Kind, MARK, ShadowTarget, clear_stencil, counting, pipeline, summing};
use crate::{Gpu, shaders};

/// What is drawn: each shape in the ways in which it is counted.
const KINDS: [(Part, Shape); 9] = [
    (Part::Pass, Shape::Sides),
    (Part::Pass, Shape::Faced),
    (Part::PassTurned, Shape::Turned),
    (Part::Fail, Shape::Sides),
    (Part::Fail, Shape::Fan),
    (Part::Fail, Shape::Projected),
    (Part::Fail, Shape::Faced),
    (Part::FailTurned, Shape::Turned),
    (Part::LightCap, Shape::LightCap),
];

/// What vertices are made from; the entry points are the same.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawnFrom<'a> {
    pub(crate) module: &'a wgpu::ShaderModule,
    /// Of group 2.
    pub(crate) layout: &'a wgpu::BindGroupLayout,
}

/// A pipeline for each of [`KINDS`].
#[derive(Debug)]
pub(crate) struct FoundPipelines([wgpu::RenderPipeline; KINDS.len()]);

impl FoundPipelines {
    /// Counts in the stencil, as [`crate::shadow::pipelines::Pipelines`] does.
    pub(crate) fn stencil(gpu: &Gpu, layouts: &Layouts, target: &ShadowTarget<'_>, from: DrawnFrom<'_>) -> Self {
        Self::new(gpu, layouts, target, from, |part, shape| {
            let (depth_compare, stencil, front_face) = counting(part);
            Kind {
                label: "found volumes",
                entry_point: entry_point(shape),
                depth_compare,
                stencil,
                front_face,
                fragment: None,
            }
        })
    }

    /// Adds up where the mark is, in the only colour attachment.
    pub(crate) fn sums(gpu: &Gpu, layouts: &Layouts, target: &ShadowTarget<'_>, from: DrawnFrom<'_>) -> Self {
        let target = ShadowTarget { color_formats: &[Some(gpu.caps.tally_format)], ..*target };
        let face = wgpu::StencilFaceState { compare: wgpu::CompareFunction::Equal, ..wgpu::StencilFaceState::IGNORE };
        Self::new(gpu, layouts, &target, from, |part, shape| {
            let (depth_compare, front_face, operation) = summing(part);
            Kind {
                label: "found volumes, summed",
                entry_point: entry_point(shape),
                depth_compare,
                stencil: wgpu::StencilState { front: face, back: face, read_mask: MARK, write_mask: 0 },
                front_face,
                fragment: Some(("fs_signed", operation)),
            }
        })
    }

    fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        target: &ShadowTarget<'_>,
        from: DrawnFrom<'_>,
        kind: impl Fn(Part, Shape) -> Kind<'static>,
    ) -> Self {
        let groups = [Some(&layouts.view), Some(&layouts.light), Some(from.layout)];
        let layout = pipeline_layout(gpu, "view, light and found", &groups);
        Self(KINDS.map(|(part, shape)| pipeline(&gpu.device, from.module, &layout, target, &kind(part, shape))))
    }

    /// What draws `shape` as `part`.
    pub(crate) fn of(&self, part: Part, shape: Shape) -> &wgpu::RenderPipeline {
        let i = KINDS.iter().position(|&kind| kind == (part, shape)).expect("only these are planned");
        &self.0[i]
    }
}

fn entry_point(shape: Shape) -> &'static str {
    match shape {
        Shape::Sides => "vs_sides",
        Shape::Fan => "vs_fan",
        Shape::Projected => "vs_projected",
        Shape::LightCap => "vs_light_cap",
        Shape::Faced => "vs_faced",
        Shape::Turned => "vs_turned",
    }
}

/// Group 2 of `found_volume.wgsl`: a job at a dynamic offset, tables, positions, lists.
pub(crate) fn draw_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entry = |binding, ty, has_dynamic_offset, min_binding_size| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size },
        count: None,
    };
    let storage = |binding| entry(binding, wgpu::BufferBindingType::Storage { read_only: true }, false, None);
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("found volumes"),
        entries: &[entry(0, wgpu::BufferBindingType::Uniform, true, JOB_SIZE), storage(1), storage(2), storage(3)],
    })
}

const JOB_SIZE: Option<NonZeroU64> = NonZeroU64::new(size_of::<JobUniform>() as u64);

/// The offset of a job in the group of [`draw_group`].
pub(crate) fn job_offset(job: u32) -> u32 {
    job * size_of::<JobSlot>() as u32
}

/// `buffers` are jobs, tables, positions and lists.
pub(crate) fn draw_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    [jobs, tables, positions, lists]: [&wgpu::Buffer; 4],
) -> wgpu::BindGroup {
    let job = wgpu::BufferBinding { buffer: jobs, offset: 0, size: JOB_SIZE };
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("found volumes"),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(job) },
            wgpu::BindGroupEntry { binding: 1, resource: tables.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 2, resource: positions.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 3, resource: lists.as_entire_binding() },
        ],
    })
}

/// Takes the mark away where a sum is not 0.
///
/// - reads: sums of one sample or of as many as the stencil has
/// - writes: stencil
/// - needs: a pass with no colour
#[derive(Debug)]
pub(crate) struct FoldPass {
    pipeline: wgpu::RenderPipeline,
}

impl FoldPass {
    pub(crate) fn new(gpu: &Gpu, target: &ShadowTarget<'_>) -> Self {
        let module = shaders::fold_sums(&gpu.device, target.samples);
        let layout = pipeline_layout(gpu, "sums", &[Some(&sums_layout(gpu, target.samples))]);
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("fold of sums"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_everywhere"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: target.depth_stencil_format,
                depth_write_enabled: Some(false),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: clear_stencil(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState { count: target.samples, ..wgpu::MultisampleState::default() },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_fold"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, sums: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, sums, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Group 0 of the fold.
pub(crate) fn sums_layout(gpu: &Gpu, samples: u32) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("sums"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: samples > 1,
            },
            count: None,
        }],
    })
}
