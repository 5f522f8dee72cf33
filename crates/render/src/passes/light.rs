//! One light, added where nothing shades it.

use super::Layouts;
use super::surface::{SurfaceState, draw_surface, surface_pipeline};
use crate::targets::Output;
use crate::{Gpu, GpuScene};

/// Adds a light to every visible surface whose stencil is 0 and whose seen side the light reaches.
///
/// - reads: depth and stencil
/// - writes: colour, by addition
/// - needs: the depth of exactly these surfaces, drawn by the same vertex shader
#[derive(Debug)]
pub(crate) struct LightPass {
    pipeline: wgpu::RenderPipeline,
}

impl LightPass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, output: Output, samples: u32) -> Self {
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let (entry_point, blend) = match output {
            Output::Picture => ("fs_light", Some(wgpu::BlendState { color: add, alpha: add })),
            Output::Mask => ("fs_lit_mask", None),
        };
        let unshaded =
            wgpu::StencilFaceState { compare: wgpu::CompareFunction::Equal, ..wgpu::StencilFaceState::IGNORE };
        let pipeline = surface_pipeline(
            gpu,
            Some(output),
            samples,
            &SurfaceState {
                label: "light",
                layout: &layouts.view_and_light,
                entry_point,
                blend,
                depth_stencil: wgpu::DepthStencilState {
                    format: gpu.caps.depth_stencil_format,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(wgpu::CompareFunction::Equal),
                    stencil: wgpu::StencilState { front: unshaded, back: unshaded, read_mask: 0xFF, write_mask: 0 },
                    bias: wgpu::DepthBiasState::default(),
                },
            },
        );
        Self { pipeline }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene, light: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_stencil_reference(0);
        pass.set_bind_group(1, light, &[]);
        draw_surface(pass, scene);
    }
}
