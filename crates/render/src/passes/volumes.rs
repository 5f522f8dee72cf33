//! Shadow volumes into the stencil.

use wgpu::util::DeviceExt as _;

use super::{BOTH_SIDES, Layouts};
use crate::gpu_scene::VOLUME_VERTEX_LAYOUT;
use crate::{Gpu, GpuError, GpuScene, LightVolumes, shaders};

/// Leaves in each stencil texel the number of volumes that hold the point just in front of the visible surface, modulo 256.
///
/// - reads: depth
/// - writes: stencil, which must be 0; never colour, never depth
/// - needs: closed volumes, reversed depth, an infinite projection
///
/// z-pass counts what passes `Greater`, z-fail what fails it, so the two are exact complements. Light caps lie on surfaces
/// that are in the depth buffer and can't be in front of what is visible: `Never` says so without comparing rounded depths.
///
/// Source: M. McGuire et al. 2003, section 6; the `Never` cap is OGRE's.
#[derive(Debug)]
pub(crate) struct VolumePass {
    zpass: wgpu::RenderPipeline,
    zfail: wgpu::RenderPipeline,
    light_caps: wgpu::RenderPipeline,
}

/// The index buffers of one light's volumes.
#[derive(Debug)]
pub(crate) struct GpuVolumes {
    zpass: Option<(wgpu::Buffer, u32)>,
    zfail: Option<(wgpu::Buffer, u32)>,
    light_caps: Option<(wgpu::Buffer, u32)>,
}

impl GpuVolumes {
    /// Uploads `volumes`.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when a list would be larger than the device allows: a volume is drawn whole or not at all.
    pub(crate) fn new(gpu: &Gpu, volumes: &LightVolumes) -> Result<Self, GpuError> {
        let upload = |label, indices: &[u32]| {
            let needed_bytes = size_of_val(indices) as u64;
            let allowed_bytes = gpu.device.limits().max_buffer_size;
            if needed_bytes > allowed_bytes {
                return Err(GpuError::TooLarge { adapter: gpu.label.clone(), needed_bytes, allowed_bytes });
            }
            let buffer = || {
                gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                    label: Some(label),
                    contents: bytemuck::cast_slice(indices),
                    usage: wgpu::BufferUsages::INDEX,
                })
            };
            Ok((!indices.is_empty()).then(|| (buffer(), indices.len() as u32)))
        };
        Ok(Self {
            zpass: upload("z-pass volumes", &volumes.zpass)?,
            zfail: upload("z-fail volumes", &volumes.zfail)?,
            light_caps: upload("light caps", &volumes.light_caps)?,
        })
    }
}

impl VolumePass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, samples: u32) -> Self {
        use wgpu::StencilOperation::{DecrementWrap, IncrementWrap, Keep};
        let module = shaders::volume(&gpu.device);
        let pipeline = |label, depth_compare, [front_fail, front_pass, back_fail, back_pass]: [_; 4]| {
            let face = |depth_fail_op, pass_op| wgpu::StencilFaceState {
                compare: wgpu::CompareFunction::Always,
                fail_op: Keep,
                depth_fail_op,
                pass_op,
            };
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layouts.view_and_light),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vs_volume"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[Some(VOLUME_VERTEX_LAYOUT)],
                },
                primitive: BOTH_SIDES,
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: gpu.caps.depth_stencil_format,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(depth_compare),
                    stencil: wgpu::StencilState {
                        front: face(front_fail, front_pass),
                        back: face(back_fail, back_pass),
                        read_mask: 0xFF,
                        write_mask: 0xFF,
                    },
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
                fragment: None,
                multiview_mask: None,
                cache: None,
            })
        };
        // Entering a volume in front of the surface adds one; so does leaving it behind the surface.
        let count_in_front = [Keep, IncrementWrap, Keep, DecrementWrap];
        let count_behind = [DecrementWrap, Keep, IncrementWrap, Keep];
        Self {
            zpass: pipeline("volumes, z-pass", wgpu::CompareFunction::Greater, count_in_front),
            zfail: pipeline("volumes, z-fail", wgpu::CompareFunction::Greater, count_behind),
            light_caps: pipeline("volumes, light caps", wgpu::CompareFunction::Never, count_behind),
        }
    }

    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        scene: &GpuScene,
        light: &wgpu::BindGroup,
        volumes: &GpuVolumes,
    ) {
        pass.set_bind_group(1, light, &[]);
        pass.set_vertex_buffer(0, scene.volume_vertices.slice(..));
        for (pipeline, indices) in
            [(&self.zpass, &volumes.zpass), (&self.zfail, &volumes.zfail), (&self.light_caps, &volumes.light_caps)]
        {
            if let Some((buffer, count)) = indices {
                pass.set_pipeline(pipeline);
                pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..*count, 0, 0..1);
            }
        }
    }
}
