//! Radiance into display colours.

use super::{BOTH_SIDES, Layouts, pipeline_layout};
use crate::{Gpu, Targets, shaders};

/// Tone maps the resolved radiance, over a sky where there is no surface.
///
/// - reads: resolved radiance
/// - writes: a view of the format given to `new`, every pixel
/// - needs: nothing else
///
/// Source: Khronos PBR Neutral tone mapper, 2024.
#[derive(Debug)]
pub(crate) struct TonePass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl TonePass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, format: wgpu::TextureFormat) -> Self {
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("radiance"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });
        let module = shaders::tone(&gpu.device);
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("tone"),
            layout: Some(&pipeline_layout(gpu, "view and radiance", &[Some(&layouts.view), Some(&layout)])),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_tone"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: BOTH_SIDES,
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_tone"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline, layout }
    }

    /// Binds the radiance of `targets`.
    pub(crate) fn bind(&self, gpu: &Gpu, targets: &Targets) -> wgpu::BindGroup {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("radiance"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&targets.resolved_view),
            }],
        })
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, radiance: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, radiance, &[]);
        pass.draw(0..3, 0..1);
    }
}
