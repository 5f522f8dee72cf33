//! Depth and ambient light.

use super::{BOTH_SIDES, Layouts};
use crate::gpu_finishes::FinishKind;
use crate::gpu_scene::{SHADING_NORMAL_LAYOUT, SurfaceVertex};
use crate::targets::Output;
use crate::{Gpu, GpuScene, shaders};

/// Every opaque triangle, both sides, but for what is cut out: nearest depth, and the light that comes from everywhere.
///
/// - reads: nothing
/// - writes: colour and depth, which must be clear
/// - needs: reversed depth
#[derive(Debug)]
pub(crate) struct SurfacePass {
    pipelines: SurfacePipelines,
}

impl SurfacePass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, output: Output, samples: u32) -> Self {
        let entry_point = match output {
            Output::Picture => "fs_ambient",
            Output::Mask => "fs_dark_mask",
        };
        let pipelines = SurfacePipelines::new(
            gpu,
            Some(output),
            samples,
            &SurfaceState {
                label: "surface",
                layout: &layouts.view_and_finish,
                entry_point,
                blend: None,
                depth_stencil: nearest(gpu),
            },
        );
        Self { pipelines }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene) {
        self.pipelines.draw(pass, scene);
    }
}

/// What is nearest stays.
pub(super) fn nearest(gpu: &Gpu) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: gpu.caps.depth_stencil_format,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// In what the passes over the surfaces differ.
pub(super) struct SurfaceState<'a> {
    pub(super) label: &'a str,
    pub(super) layout: &'a wgpu::PipelineLayout,
    pub(super) entry_point: &'a str,
    pub(super) blend: Option<wgpu::BlendState>,
    pub(super) depth_stencil: wgpu::DepthStencilState,
}

/// One way of drawing surfaces: a pipeline for each finish that is not glass.
#[derive(Debug)]
pub(super) struct SurfacePipelines {
    plain: wgpu::RenderPipeline,
    /// `None` where colour is not asked for.
    textured: Option<wgpu::RenderPipeline>,
    cut_out: wgpu::RenderPipeline,
}

impl SurfacePipelines {
    /// Without an `output` there is no colour, only depth and stencil.
    pub(super) fn new(gpu: &Gpu, output: Option<Output>, samples: u32, state: &SurfaceState<'_>) -> Self {
        Self::with_module(gpu, &shaders::surface(&gpu.device), output, samples, state)
    }

    /// As [`SurfacePipelines::new`], with entry points of `module`.
    pub(super) fn with_module(
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        output: Option<Output>,
        samples: u32,
        state: &SurfaceState<'_>,
    ) -> Self {
        let pipeline = |kind| surface_pipeline(gpu, module, output, samples, state, kind);
        let has_look = output == Some(Output::Picture);
        Self {
            plain: pipeline(FinishKind::Plain),
            textured: has_look.then(|| pipeline(FinishKind::Textured)),
            cut_out: pipeline(FinishKind::CutOut),
        }
    }

    /// Draws everything but glass.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene) {
        scene.set_vertices(pass);
        for (vertices, finish) in &scene.draws {
            let finish = &scene.finishes[*finish as usize];
            let pipeline = match finish.kind {
                FinishKind::Plain => &self.plain,
                FinishKind::Textured => self.textured.as_ref().unwrap_or(&self.plain),
                FinishKind::CutOut => &self.cut_out,
                FinishKind::Glass => continue,
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(2, &finish.group, &[]);
            pass.draw(vertices.clone(), 0..1);
        }
    }
}

pub(super) fn surface_pipeline(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    output: Option<Output>,
    samples: u32,
    state: &SurfaceState<'_>,
    kind: FinishKind,
) -> wgpu::RenderPipeline {
    let color = output.map(|output| {
        Some(wgpu::ColorTargetState { format: output.format(), blend: state.blend, write_mask: wgpu::ColorWrites::ALL })
    });
    let is = |condition: bool| f64::from(u8::from(condition));
    let constants = [("has_texture", is(kind != FinishKind::Plain)), ("has_cut_outs", is(kind >= FinishKind::CutOut))];
    let compilation_options =
        wgpu::PipelineCompilationOptions { constants: &constants, ..wgpu::PipelineCompilationOptions::default() };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(state.label),
        layout: Some(state.layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vs_surface"),
            compilation_options: compilation_options.clone(),
            buffers: &[Some(SurfaceVertex::LAYOUT), Some(SHADING_NORMAL_LAYOUT)],
        },
        primitive: BOTH_SIDES,
        depth_stencil: Some(state.depth_stencil.clone()),
        multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(state.entry_point),
            compilation_options,
            targets: color.as_slice(),
        }),
        multiview_mask: None,
        cache: None,
    })
}
