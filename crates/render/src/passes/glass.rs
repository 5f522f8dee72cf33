//! What is seen through, after everything else.

use glam::DVec3;
use wgpu::util::DeviceExt as _;

use super::surface::{SurfaceState, surface_pipeline};
use super::{Layouts, pipeline_layout, uniform_group, uniform_layout};
use crate::gpu_finishes::FinishKind;
use crate::targets::Output;
use crate::uniforms::{LightUniform, LightsUniform};
use crate::{Gpu, GpuError, GpuScene, gpu_finishes, shaders};

/// Blends the triangles of glass over the picture, from back to front, lit by ambient light and by every light, shadows left out.
///
/// - reads: depth
/// - writes: colour; never depth, never stencil
/// - needs: all that is opaque drawn, with all its lights
///
/// Triangles are ordered by how far their middles are from the eye. Where two cross, or a long one lies beside a short one, that may be the wrong
/// way round.
#[derive(Debug)]
pub(crate) struct GlassPass {
    pipeline: wgpu::RenderPipeline,
    lights: wgpu::BindGroupLayout,
}

/// The glass of a scene as one eye sees it under some lights.
#[derive(Debug)]
pub(crate) struct GlassFrame {
    /// Of vertices in [`GpuScene::surface`], farthest triangle first.
    indices: wgpu::Buffer,
    /// Neighbours in `indices` that have one finish.
    runs: Vec<Run>,
    /// As many lights as one uniform holds, each.
    lights: Vec<wgpu::BindGroup>,
}

#[derive(Debug)]
struct Run {
    indices: std::ops::Range<u32>,
    finish: u32,
}

impl GlassPass {
    /// For pictures: masks have no glass.
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, samples: u32) -> Self {
        let lights = uniform_layout(gpu, "lights on glass", size_of::<LightsUniform>());
        let finish = gpu_finishes::layout(gpu);
        let layout =
            pipeline_layout(gpu, "view, lights and finish", &[Some(&layouts.view), Some(&lights), Some(&finish)]);
        let state = SurfaceState {
            label: "glass",
            layout: &layout,
            entry_point: "fs_glass",
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            depth_stencil: wgpu::DepthStencilState {
                format: gpu.caps.depth_stencil_format,
                depth_write_enabled: Some(false),
                // A film on a surface is seen.
                depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            },
        };
        let module = shaders::glass(&gpu.device);
        let pipeline = surface_pipeline(gpu, &module, Some(Output::Picture), samples, &state, FinishKind::Glass);
        Self { pipeline, lights }
    }

    /// Sorts the glass of `scene` for `eye` and uploads the order; `None` if there is no glass.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when there are more triangles than the device can list.
    pub(crate) fn prepare(
        &self,
        gpu: &Gpu,
        scene: &GpuScene,
        eye: DVec3,
        lights: &[LightUniform],
    ) -> Result<Option<GlassFrame>, GpuError> {
        if scene.glass.is_empty() {
            return Ok(None);
        }
        let mut triangles: Vec<(f64, u32, u32)> = scene
            .glass
            .iter()
            .map(|glass| (glass.center.as_dvec3().distance_squared(eye), glass.first_vertex, glass.finish))
            .collect();
        // Farthest first; among equals as in the file, on every run.
        triangles.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let indices: Vec<u32> = triangles.iter().flat_map(|&(_, first, _)| first..first + 3).collect();
        gpu.ensure_buffer_fits(size_of_val(indices.as_slice()))?;

        let some_lights = LightsUniform::of_all(lights);
        // What further lights add to one triangle must come before the next one covers it.
        let longest = if some_lights.len() > 1 { 1 } else { usize::MAX };
        let mut runs: Vec<Run> = Vec::new();
        for (i, &(_, _, finish)) in (0..).zip(&triangles) {
            match runs.last_mut() {
                Some(run) if run.finish == finish && run.indices.len() < longest => run.indices.end += 3,
                _ => runs.push(Run { indices: i * 3..(i + 1) * 3, finish }),
            }
        }
        Ok(Some(GlassFrame {
            indices: gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("glass, back to front"),
                contents: bytemuck::cast_slice(&indices),
                usage: wgpu::BufferUsages::INDEX,
            }),
            runs,
            lights: some_lights
                .iter()
                .map(|lights| uniform_group(gpu, "lights on glass", &self.lights, bytemuck::bytes_of(lights)))
                .collect(),
        }))
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene, glass: &GlassFrame) {
        pass.set_pipeline(&self.pipeline);
        scene.set_vertices(pass);
        pass.set_index_buffer(glass.indices.slice(..), wgpu::IndexFormat::Uint32);
        for run in &glass.runs {
            pass.set_bind_group(2, &scene.finishes[run.finish as usize].group, &[]);
            for lights in &glass.lights {
                pass.set_bind_group(1, lights, &[]);
                pass.draw_indexed(run.indices.clone(), 0, 0..1);
            }
        }
    }
}
