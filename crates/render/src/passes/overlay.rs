//! Translucent triangles and lines over the lit picture.

use wgpu::util::DeviceExt as _;

use super::{BOTH_SIDES, Layouts, pipeline_layout, uniform_group, uniform_layout};
use crate::targets::RADIANCE_FORMAT;
use crate::uniforms::OverlayUniform;
use crate::{Gpu, GpuError, Overlay, OverlayVertex, shaders};

/// An [`Overlay`] over the radiance of a picture.
///
/// - reads: depth
/// - writes: colour, by mixing; never depth, never stencil
/// - needs: the final depth of all opaque surfaces
///
/// Lines are rectangles of six vertices, one instance each: WebGL2 has no wide lines.
#[derive(Debug)]
pub(crate) struct OverlayPass {
    layout: wgpu::BindGroupLayout,
    triangles: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    hidden_lines: wgpu::RenderPipeline,
}

/// An overlay, uploaded.
#[derive(Debug)]
pub(crate) struct GpuOverlay {
    uniform: wgpu::BindGroup,
    triangles: Option<(wgpu::Buffer, u32)>,
    lines: Option<(wgpu::Buffer, u32)>,
    shows_hidden: bool,
}

const TRIANGLE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<OverlayVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4],
};

const LINE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 2 * size_of::<OverlayVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Float32x4],
};

impl OverlayPass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, samples: u32) -> Self {
        let layout = uniform_layout(gpu, "overlay", size_of::<OverlayUniform>());
        let pipeline_layout = pipeline_layout(gpu, "view and overlay", &[Some(&layouts.view), Some(&layout)]);
        let module = shaders::overlay(&gpu.device);
        let pipeline = |label, [vertex, fragment]: [&str; 2], buffer, depth_compare| {
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[Some(buffer)],
                },
                primitive: BOTH_SIDES,
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: gpu.caps.depth_stencil_format,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(depth_compare),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: RADIANCE_FORMAT,
                        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        // Exact complements, so that no sample of a line is drawn twice.
        let (visible, hidden) = (wgpu::CompareFunction::GreaterEqual, wgpu::CompareFunction::Less);
        Self {
            triangles: pipeline("overlay triangles", ["vs_triangle", "fs_triangle"], TRIANGLE_LAYOUT, visible),
            lines: pipeline("overlay lines", ["vs_line", "fs_line"], LINE_LAYOUT, visible),
            hidden_lines: pipeline("hidden overlay lines", ["vs_line", "fs_hidden_line"], LINE_LAYOUT, hidden),
            layout,
        }
    }

    /// Uploads `overlay` for a camera whose pixels are `pixel_at_1` wide at view depth 1.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when a list would be larger than the device allows.
    pub(crate) fn upload(
        &self,
        gpu: &Gpu,
        overlay: &Overlay,
        size_px: [u32; 2],
        pixel_at_1: f64,
    ) -> Result<GpuOverlay, GpuError> {
        let buffer = |label, bytes: &[u8], count: usize| {
            let (needed_bytes, allowed_bytes) = (bytes.len() as u64, gpu.device.limits().max_buffer_size);
            if needed_bytes > allowed_bytes {
                return Err(GpuError::TooLarge { adapter: gpu.label.clone(), needed_bytes, allowed_bytes });
            }
            let make = || {
                gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                    label: Some(label),
                    contents: bytes,
                    usage: wgpu::BufferUsages::VERTEX,
                })
            };
            Ok((count > 0).then(|| (make(), count as u32)))
        };
        let uniform = OverlayUniform::new(overlay, size_px, pixel_at_1);
        Ok(GpuOverlay {
            uniform: uniform_group(gpu, "overlay", &self.layout, bytemuck::bytes_of(&uniform)),
            triangles: buffer(
                "overlay triangles",
                bytemuck::cast_slice(overlay.triangles.as_flattened()),
                overlay.triangles.len() * 3,
            )?,
            lines: buffer("overlay lines", bytemuck::cast_slice(overlay.lines.as_flattened()), overlay.lines.len())?,
            shows_hidden: overlay.hidden_opacity > 0.0,
        })
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, overlay: &GpuOverlay) {
        pass.set_bind_group(1, &overlay.uniform, &[]);
        if let Some((buffer, vertices)) = &overlay.triangles {
            pass.set_pipeline(&self.triangles);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..*vertices, 0..1);
        }
        if let Some((buffer, lines)) = &overlay.lines {
            pass.set_vertex_buffer(0, buffer.slice(..));
            if overlay.shows_hidden {
                pass.set_pipeline(&self.hidden_lines);
                pass.draw(0..6, 0..*lines);
            }
            pass.set_pipeline(&self.lines);
            pass.draw(0..6, 0..*lines);
        }
    }
}
