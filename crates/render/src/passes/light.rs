//! One light: marking what it would brighten, and adding it where nothing shades it.

use super::Layouts;
use super::surface::{SurfacePipelines, SurfaceState};
use crate::targets::Output;
use crate::{Gpu, GpuScene, LIT};

/// Adds a light to every visible surface whose stencil is [`LIT`] and whose seen side the light reaches; and sets the stencil to that, before
/// volumes are counted, on every one that it reaches at all.
///
/// - reads: depth and stencil
/// - writes: colour, by addition; the stencil, when marking
/// - needs: the depth of exactly these surfaces, drawn by the same vertex shader
#[derive(Debug)]
pub(crate) struct LightPass {
    light: SurfacePipelines,
    mark: SurfacePipelines,
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
        let depth_stencil = |face, write_mask| wgpu::DepthStencilState {
            format: gpu.caps.depth_stencil_format,
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::Equal),
            stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xFF, write_mask },
            bias: wgpu::DepthBiasState::default(),
        };
        let light = SurfacePipelines::new(
            gpu,
            Some(output),
            samples,
            &SurfaceState {
                label: "light",
                layout: &layouts.view_light_and_finish,
                entry_point,
                blend,
                depth_stencil: depth_stencil(unshaded, 0),
            },
        );
        let set = wgpu::StencilFaceState {
            compare: wgpu::CompareFunction::Always,
            pass_op: wgpu::StencilOperation::Replace,
            ..wgpu::StencilFaceState::IGNORE
        };
        let mark = SurfacePipelines::new(
            gpu,
            None,
            samples,
            &SurfaceState {
                label: "mark of receivers",
                layout: &layouts.view_light_and_finish,
                entry_point: "fs_mark",
                blend: None,
                depth_stencil: depth_stencil(set, 0xFF),
            },
        );
        Self { light, mark }
    }

    /// Sets the stencil to [`LIT`] on what the light would brighten if nothing shaded it.
    pub(crate) fn draw_mark(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene, light: &wgpu::BindGroup) {
        self.draw_with(&self.mark, pass, scene, light);
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene, light: &wgpu::BindGroup) {
        self.draw_with(&self.light, pass, scene, light);
    }

    fn draw_with(
        &self,
        pipelines: &SurfacePipelines,
        pass: &mut wgpu::RenderPass<'_>,
        scene: &GpuScene,
        light: &wgpu::BindGroup,
    ) {
        pass.set_stencil_reference(LIT);
        pass.set_bind_group(1, light, &[]);
        pipelines.draw(pass, scene);
    }
}
