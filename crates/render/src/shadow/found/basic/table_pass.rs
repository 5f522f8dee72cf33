//! Passes with a fragment for each texel of a table.

use super::tables::Table;
use crate::Gpu;
use crate::passes::pipeline_layout;
use crate::timing::PassTimer;

/// Fills a table.
///
/// - reads: uniforms and tables
/// - writes: a table, whole
/// - needs: nothing beyond WebGL2
#[derive(Debug)]
pub(crate) struct TablePass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

impl TablePass {
    /// With `entry_point` of `module`, which also has `vs_table`, and what that reads, by binding.
    pub(crate) fn new(
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        entry_point: &str,
        uniforms: &[u32],
        tables: &[u32],
    ) -> Self {
        let layout = layout(gpu, entry_point, wgpu::ShaderStages::FRAGMENT, uniforms, tables);
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&pipeline_layout(gpu, entry_point, &[Some(&layout)])),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vs_table"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(Table::FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { layout, pipeline }
    }

    /// What it reads, by binding.
    pub(crate) fn group(
        &self,
        gpu: &Gpu,
        uniforms: &[(u32, &wgpu::Buffer)],
        tables: &[(u32, &wgpu::TextureView)],
    ) -> wgpu::BindGroup {
        bind(gpu, &self.layout, uniforms, tables)
    }

    pub(crate) fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        to: &wgpu::TextureView,
        group: &wgpu::BindGroup,
        (label, timer): (&str, &mut PassTimer),
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: to,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            timestamp_writes: timer.writes(label.to_owned()),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// A group of uniforms and tables, by binding.
pub(super) fn layout(
    gpu: &Gpu,
    label: &str,
    visibility: wgpu::ShaderStages,
    uniforms: &[u32],
    tables: &[u32],
) -> wgpu::BindGroupLayout {
    let entry = |ty| move |&binding: &u32| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let table = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Uint,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let entries: Vec<_> = uniforms.iter().map(entry(uniform)).chain(tables.iter().map(entry(table))).collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Fills a group of [`layout`].
pub(super) fn bind(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    uniforms: &[(u32, &wgpu::Buffer)],
    tables: &[(u32, &wgpu::TextureView)],
) -> wgpu::BindGroup {
    let uniforms = uniforms.iter().map(|&(binding, buffer)| (binding, buffer.as_entire_binding()));
    let tables = tables.iter().map(|&(binding, view)| (binding, wgpu::BindingResource::TextureView(view)));
    let entries: Vec<_> =
        uniforms.chain(tables).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("tables"), layout, entries: &entries })
}
