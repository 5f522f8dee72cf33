//! Where coverage and visibility go.

use crate::{Gpu, GpuError};

/// Four numbers a sample: one for each quarter of the light.
#[derive(Debug)]
pub(crate) struct SoftTargets {
    /// Of the caster, or the group of casters, that is drawn now.
    pub(crate) coverage: wgpu::TextureView,
    /// [`SoftTargets::coverage`], for the composite pass.
    pub(crate) coverage_group: wgpu::BindGroup,
    /// Readable where there is one sample a pixel.
    pub(crate) visibility_texture: wgpu::Texture,
    pub(crate) visibility: wgpu::TextureView,
    /// [`SoftTargets::visibility`], for the light pass.
    pub(crate) visibility_group: wgpu::BindGroup,
}

/// With four channels. Multisampled 32-bit floats are beyond WebGPU; sums of 16 bits are whole numbers first, and exact up to 2048,
/// then shares on top of what is left of these.
pub(crate) fn format(gpu: &Gpu, samples: u32) -> wgpu::TextureFormat {
    let is_wide = samples == 1 && gpu.caps.tally_format == wgpu::TextureFormat::R32Float;
    if is_wide { wgpu::TextureFormat::Rgba32Float } else { wgpu::TextureFormat::Rgba16Float }
}

/// One texture, read texel by texel.
pub(crate) fn texel_layout(gpu: &Gpu, samples: u32) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("texels"),
        entries: &[texel_entry(0, samples)],
    })
}

pub(super) fn texel_entry(binding: u32, samples: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: samples > 1,
        },
        count: None,
    }
}

impl SoftTargets {
    /// For passes of `size_px` pixels with `samples` (1 or 4) samples each.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoSoftSamples`] where several samples a pixel can't be shaded one by one.
    pub(crate) fn new(gpu: &Gpu, size_px: [u32; 2], samples: u32) -> Result<Self, GpuError> {
        if samples > 1 && !gpu.caps.shades_samples {
            return Err(GpuError::NoSoftSamples { adapter: gpu.label.clone() });
        }
        let texture = |label| {
            let readable = if samples == 1 { wgpu::TextureUsages::COPY_SRC } else { wgpu::TextureUsages::empty() };
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format: format(gpu, samples),
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING | readable,
                view_formats: &[],
            })
        };
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let layout = texel_layout(gpu, samples);
        let group = |label, view: &wgpu::TextureView| {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout: &layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) }],
            })
        };
        let coverage = view(&texture("coverage"));
        let coverage_group = group("coverage", &coverage);
        let visibility_texture = texture("visibility");
        let visibility = view(&visibility_texture);
        let visibility_group = group("visibility", &visibility);
        Ok(Self { coverage, coverage_group, visibility_texture, visibility, visibility_group })
    }
}
