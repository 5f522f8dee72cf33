//! Counts in a float target, for casters that may overlap themselves more often than the stencil can count.

use super::pipelines::sums_layout;
use crate::{Gpu, GpuError};

/// A texture in which volumes are added up, of the size and samples of the passes into which shadows are drawn.
///
/// 32-bit floats where the device can add to them (exact to 16 million), else 16-bit ones: there a sum is exact as long as it is at most 2048 at any
/// time, so that 2048 surfaces of meshes too large for the stencil would have to be between a light and a point, or between a
/// point and infinity while they are drawn. (With z-fail, all triangles of such meshes that are behind a point may be counted before those that
/// cancel them.)
#[derive(Debug)]
pub struct ShadowSums {
    pub(crate) view: wgpu::TextureView,
    pub(crate) group: wgpu::BindGroup,
}

impl ShadowSums {
    /// For passes of `size_px` pixels with `samples` (1 or 4) samples each.
    ///
    /// # Errors
    ///
    /// [`GpuError::PictureTooLarge`] when the device has no textures of that size.
    pub fn new(gpu: &Gpu, size_px: [u32; 2], samples: u32) -> Result<Self, GpuError> {
        let allowed = gpu.device.limits().max_texture_dimension_2d;
        if size_px.iter().any(|&side| side > allowed) {
            return Err(GpuError::PictureTooLarge { adapter: gpu.label.clone(), size_px, allowed });
        }
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("sums of volumes"),
            size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format: gpu.caps.tally_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("sums"),
            layout: &sums_layout(gpu, samples),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) }],
        });
        Ok(Self { view, group })
    }

    /// What the pass for [`crate::Shadows::draw_sums`] begins with: nothing summed.
    pub fn attachment(&self) -> wgpu::RenderPassColorAttachment<'_> {
        wgpu::RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        }
    }
}
