//! The textures that a frame draws into.

use std::sync::OnceLock;

use crate::soft::SoftTargets;
use crate::{Gpu, GpuError, ShadowSums};

/// Radiance of pictures: 16-bit floats, so that many lights add up without bands.
pub(crate) const RADIANCE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Verdicts of masks.
pub(crate) const MASK_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
/// Headless pictures; a window may bring another.
pub(crate) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// What a frame's passes accumulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Radiance, for tone mapping.
    Picture,
    /// 255 lit, 0 dark, 128 no surface, for the ray caster to judge.
    Mask,
}

impl Output {
    pub(crate) fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Picture => RADIANCE_FORMAT,
            Self::Mask => MASK_FORMAT,
        }
    }

    /// What a pixel without a surface holds.
    pub(crate) fn clear_color(self) -> wgpu::Color {
        match self {
            Self::Picture => wgpu::Color::TRANSPARENT,
            Self::Mask => wgpu::Color { r: 128.0 / 255.0, g: 0.0, b: 0.0, a: 0.0 },
        }
    }
}

/// Colour, depth and stencil of one size and sample count.
#[derive(Debug)]
pub struct Targets {
    /// Accumulates light; multisampled when `samples` is.
    pub(crate) color: wgpu::TextureView,
    /// One sample a pixel; the same texture as `color` without multisampling.
    pub(crate) resolved: wgpu::Texture,
    pub(crate) resolved_view: wgpu::TextureView,
    pub(crate) depth_stencil: wgpu::TextureView,
    depth_stencil_texture: wgpu::Texture,
    pub(crate) samples: u32,
    pub(crate) output: Output,
    size_px: [u32; 2],
    /// Made when first needed.
    sums: OnceLock<ShadowSums>,
    soft: OnceLock<SoftTargets>,
}

impl Targets {
    /// Textures for `output` of `size_px` pixels with `samples` (1 or 4) samples each.
    ///
    /// # Errors
    ///
    /// [`GpuError::PictureTooLarge`] when the device has no textures of that size.
    pub fn new(gpu: &Gpu, output: Output, size_px: [u32; 2], samples: u32) -> Result<Self, GpuError> {
        let allowed = gpu.device.limits().max_texture_dimension_2d;
        if size_px.iter().any(|&side| side > allowed) {
            return Err(GpuError::PictureTooLarge { adapter: gpu.label.clone(), size_px, allowed });
        }
        let texture = |label, format, sample_count, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let readable = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        let resolved = texture("resolved color", output.format(), 1, readable);
        let resolved_view = view(&resolved);
        let none = wgpu::TextureUsages::empty();
        let color = if samples > 1 {
            view(&texture("multisampled color", output.format(), samples, none))
        } else {
            resolved_view.clone()
        };
        let read = wgpu::TextureUsages::TEXTURE_BINDING;
        let depth_stencil_texture = texture("depth stencil", gpu.caps.depth_stencil_format, samples, read);
        Ok(Self {
            color,
            resolved,
            resolved_view,
            depth_stencil: view(&depth_stencil_texture),
            depth_stencil_texture,
            samples,
            output,
            size_px,
            sums: OnceLock::new(),
            soft: OnceLock::new(),
        })
    }

    /// Makes what volumes are added up in that the stencil can't count, unless that was done.
    ///
    /// # Errors
    ///
    /// [`GpuError::PictureTooLarge`].
    pub(crate) fn make_sums(&self, gpu: &Gpu) -> Result<(), GpuError> {
        if self.sums.get().is_none() {
            let sums = ShadowSums::new(gpu, self.size_px, self.samples)?;
            // Whoever was faster made the same.
            let _ = self.sums.set(sums);
        }
        Ok(())
    }

    /// Makes what soft shadows are drawn into, unless that was done.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoSoftSamples`].
    pub(crate) fn make_soft(&self, gpu: &Gpu) -> Result<(), GpuError> {
        if self.soft.get().is_none() {
            let soft = SoftTargets::new(gpu, self.size_px, self.samples)?;
            // Whoever was faster made the same.
            let _ = self.soft.set(soft);
        }
        Ok(())
    }

    /// What [`Targets::make_soft`] made.
    pub(crate) fn soft(&self) -> Option<&SoftTargets> {
        self.soft.get()
    }

    /// The depth alone, for shaders to read.
    pub(crate) fn depth_to_read(&self) -> wgpu::TextureView {
        self.depth_stencil_texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("depth"),
            aspect: wgpu::TextureAspect::DepthOnly,
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    /// What [`Targets::make_sums`] made.
    pub(crate) fn sums(&self) -> Option<&ShadowSums> {
        self.sums.get()
    }
}
