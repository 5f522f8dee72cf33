//! A light with a size on surfaces and spheres.

use super::SoftTargets;
use super::targets::texel_layout;
use crate::passes::{GpuSpheres, Layouts, SoftSurfaces, SpherePass, pipeline_layout};
use crate::{Gpu, GpuScene};

/// Adds a light to every visible surface whose seen side it reaches, as much of it as is seen from there.
///
/// - reads: depth, visibility ([`SoftTargets`]), stencil
/// - writes: colour, by addition; stencil, where it has added
/// - needs: the depth of exactly these surfaces, drawn by the same vertex shader; a stencil that is lit all over
#[derive(Debug)]
pub(crate) struct SoftLightPass {
    surfaces: SoftSurfaces,
    spheres: wgpu::RenderPipeline,
}

impl SoftLightPass {
    /// For pictures with `samples` samples a pixel.
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, samples: u32) -> Self {
        let visibility = texel_layout(gpu, samples);
        let groups = [Some(&layouts.view), Some(&layouts.light), Some(&layouts.finish), Some(&visibility)];
        let of_spheres = [Some(&layouts.view), Some(&layouts.light), None, Some(&visibility)];
        Self {
            surfaces: SoftSurfaces::new(gpu, &pipeline_layout(gpu, "soft light", &groups), samples),
            spheres: SpherePass::soft(gpu, &pipeline_layout(gpu, "soft light on spheres", &of_spheres), samples),
        }
    }

    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        (scene, spheres): (&GpuScene, &GpuSpheres),
        light: &wgpu::BindGroup,
        visibility: &SoftTargets,
    ) {
        pass.set_bind_group(3, &visibility.visibility_group, &[]);
        self.surfaces.draw(pass, scene, light);
        SpherePass::draw_soft(pass, &self.spheres, spheres, light);
    }
}
