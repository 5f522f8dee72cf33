//! One light: marking what it would brighten, and adding it where nothing shades it.

use super::Layouts;
use super::surface::{SurfacePipelines, SurfaceState};
use crate::targets::Output;
use crate::{Gpu, GpuScene, LIT, shaders};

/// Adds a light to every visible surface whose stencil is [`LIT`] and whose seen side the light reaches; and sets the stencil to that, before
/// volumes are counted, on every one that it reaches at all.
///
/// - reads: depth and stencil
/// - writes: colour, by addition; the stencil
/// - needs: the depth of exactly these surfaces, drawn by the same vertex shader
#[derive(Debug)]
pub(crate) struct LightPass {
    light: SurfacePipelines,
    mark: SurfacePipelines,
}

impl LightPass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, output: Output, samples: u32) -> Self {
        let (entry_point, blend) = match output {
            Output::Picture => ("fs_light", Some(ADD)),
            Output::Mask => ("fs_lit_mask", None),
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
                depth_stencil: where_unshaded(gpu),
            },
        );
        let mark = SurfacePipelines::new(
            gpu,
            None,
            samples,
            &SurfaceState {
                label: "mark of receivers",
                layout: &layouts.view_light_and_finish,
                entry_point: "fs_mark",
                blend: None,
                depth_stencil: setting_the_mark(gpu),
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

/// Adds a light with a size, as much of it as group 3 says, to every visible surface whose stencil is [`LIT`] and whose seen side it reaches.
#[derive(Debug)]
pub(crate) struct SoftSurfaces(SurfacePipelines);

impl SoftSurfaces {
    /// For pictures; `layout` has the visibility in group 3.
    pub(crate) fn new(gpu: &Gpu, layout: &wgpu::PipelineLayout, samples: u32) -> Self {
        let state = SurfaceState {
            label: "soft light",
            layout,
            entry_point: "fs_soft_light",
            blend: Some(ADD),
            depth_stencil: where_unshaded(gpu),
        };
        let module = shaders::soft_light(&gpu.device, samples);
        Self(SurfacePipelines::with_module(gpu, &module, Some(Output::Picture), samples, &state))
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene, light: &wgpu::BindGroup) {
        pass.set_stencil_reference(LIT);
        pass.set_bind_group(1, light, &[]);
        self.0.draw(pass, scene);
    }
}

/// What is drawn is added.
pub(super) const ADD: wgpu::BlendState = {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState { color: add, alpha: add }
};

/// On what is seen and has the reference in the stencil: once, so that of faces in one place only one is lit.
pub(super) fn where_unshaded(gpu: &Gpu) -> wgpu::DepthStencilState {
    on_what_is_seen(gpu, wgpu::CompareFunction::Equal, wgpu::StencilOperation::Zero, 0xFF)
}

/// On what is seen; the stencil gets the reference.
pub(super) fn setting_the_mark(gpu: &Gpu) -> wgpu::DepthStencilState {
    on_what_is_seen(gpu, wgpu::CompareFunction::Always, wgpu::StencilOperation::Replace, 0xFF)
}

fn on_what_is_seen(
    gpu: &Gpu,
    compare: wgpu::CompareFunction,
    pass_op: wgpu::StencilOperation,
    write_mask: u32,
) -> wgpu::DepthStencilState {
    let face = wgpu::StencilFaceState { compare, pass_op, ..wgpu::StencilFaceState::IGNORE };
    wgpu::DepthStencilState {
        format: gpu.caps.depth_stencil_format,
        depth_write_enabled: Some(false),
        depth_compare: Some(wgpu::CompareFunction::Equal),
        stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xFF, write_mask },
        bias: wgpu::DepthBiasState::default(),
    }
}
