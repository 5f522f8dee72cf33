//! Depth and ambient light.

use super::{BOTH_SIDES, Layouts};
use crate::gpu_scene::SurfaceVertex;
use crate::targets::Output;
use crate::{Gpu, GpuScene, shaders};

/// Every opaque triangle, both sides: nearest depth, and the light that comes from everywhere.
///
/// - reads: nothing
/// - writes: colour and depth, which must be clear
/// - needs: reversed depth
#[derive(Debug)]
pub(crate) struct SurfacePass {
    pipeline: wgpu::RenderPipeline,
}

impl SurfacePass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, output: Output, samples: u32) -> Self {
        let entry_point = match output {
            Output::Picture => "fs_ambient",
            Output::Mask => "fs_dark_mask",
        };
        let pipeline = surface_pipeline(
            gpu,
            Some(output),
            samples,
            &SurfaceState {
                label: "surface",
                layout: &layouts.view_only,
                entry_point,
                blend: None,
                depth_stencil: wgpu::DepthStencilState {
                    format: gpu.caps.depth_stencil_format,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                },
            },
        );
        Self { pipeline }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene) {
        pass.set_pipeline(&self.pipeline);
        draw_surface(pass, scene);
    }
}

/// In what the two passes over the surfaces differ.
pub(super) struct SurfaceState<'a> {
    pub(super) label: &'a str,
    pub(super) layout: &'a wgpu::PipelineLayout,
    pub(super) entry_point: &'a str,
    pub(super) blend: Option<wgpu::BlendState>,
    pub(super) depth_stencil: wgpu::DepthStencilState,
}

/// Without an `output` there is no colour, only depth and stencil.
pub(super) fn surface_pipeline(
    gpu: &Gpu,
    output: Option<Output>,
    samples: u32,
    state: &SurfaceState<'_>,
) -> wgpu::RenderPipeline {
    let module = shaders::surface(&gpu.device);
    let color = output.map(|output| {
        Some(wgpu::ColorTargetState { format: output.format(), blend: state.blend, write_mask: wgpu::ColorWrites::ALL })
    });
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(state.label),
        layout: Some(state.layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs_surface"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(SurfaceVertex::LAYOUT)],
        },
        primitive: BOTH_SIDES,
        depth_stencil: Some(state.depth_stencil.clone()),
        multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(state.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: color.as_slice(),
        }),
        multiview_mask: None,
        cache: None,
    })
}

pub(super) fn draw_surface(pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene) {
    pass.set_vertex_buffer(0, scene.surface.slice(..));
    pass.draw(0..scene.surface_vertices, 0..1);
}
