//! Counts and fill as numbers, by adding to a float target what else would go into the stencil.
//!
//! The counts come from other pipelines than those that draw shadows (no stencil, no wrapping, no marks), which makes them a check on these.

use super::casters::ShadowCasters;
use super::emit::Part;
use super::pipelines::{Kind, MARK, ShadowTarget, pipeline, summing};
use super::{ShadowLight, ShadowView, Shadows, draw_batch, set_scissor};
use crate::{Gpu, shaders};

/// What is added up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TallyKind {
    /// The volumes around what is seen, where z-pass and its start are right.
    Counts,
    /// Fragments that are rasterised into the stencil, those of marks included.
    Fill,
}

/// Pipelines that add to a float target, one sample a pixel.
#[derive(Debug)]
pub(crate) struct Tally {
    pub(crate) format: wgpu::TextureFormat,
    shadows: Shadows,
    pass: wgpu::RenderPipeline,
    fail: wgpu::RenderPipeline,
    light_cap: wgpu::RenderPipeline,
    pass_turned: wgpu::RenderPipeline,
    fail_turned: wgpu::RenderPipeline,
    fill: wgpu::RenderPipeline,
    fill_of_mark: wgpu::RenderPipeline,
    fill_of_receivers: wgpu::RenderPipeline,
}

impl Tally {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        use wgpu::BlendOperation::Add;
        use wgpu::CompareFunction::{Always, Equal};
        let format = gpu.caps.tally_format;
        let target = ShadowTarget {
            depth_stencil_format: gpu.caps.depth_stencil_format,
            samples: 1,
            color_formats: &[Some(format)],
        };
        let shadows = Shadows::new(gpu, &target);
        let module = shaders::volume(&gpu.device);
        let make = |label, entry_point, depth_compare, front_face, stencil_compare, fragment| {
            let face = wgpu::StencilFaceState { compare: stencil_compare, ..wgpu::StencilFaceState::IGNORE };
            let kind = Kind {
                label,
                entry_point,
                depth_compare,
                stencil: wgpu::StencilState { front: face, back: face, read_mask: MARK, write_mask: 0 },
                front_face,
                fragment: Some(fragment),
            };
            pipeline(&gpu.device, &module, &shadows.layouts.view_and_light, &target, &kind)
        };
        let signed = |label, part| {
            let (depth_compare, front_face, operation) = summing(part);
            make(label, "vs_volume", depth_compare, front_face, Always, ("fs_signed", operation))
        };
        let one = |label, entry_point, stencil_compare| {
            make(label, entry_point, Always, wgpu::FrontFace::Ccw, stencil_compare, ("fs_one", Add))
        };
        Self {
            pass: signed("counts, z-pass", Part::Pass),
            fail: signed("counts, z-fail", Part::Fail),
            light_cap: signed("counts, light caps", Part::LightCap),
            pass_turned: signed("counts, z-pass, turned", Part::PassTurned),
            fail_turned: signed("counts, z-fail, turned", Part::FailTurned),
            fill: one("fill", "vs_volume", Equal),
            fill_of_mark: one("fill of the mark", "vs_volume", Always),
            fill_of_receivers: one("fill of the receivers", "vs_everywhere", Equal),
            format,
            shadows,
        }
    }

    /// Adds up what [`Shadows::draw_counts`] would do. For fill, the mark must be set as for drawing.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        kind: TallyKind,
        casters: &ShadowCasters,
        view: &ShadowView,
        light: &ShadowLight,
    ) {
        let Some(rect) = light.plan.rect else { return };
        self.shadows.bind(pass, view, light);
        set_scissor(pass, rect);
        pass.set_stencil_reference(MARK);
        if kind == TallyKind::Fill {
            self.add_fill_of_mark(pass, light);
        }
        for (i, batch) in light.plan.batches.iter().enumerate() {
            if kind == TallyKind::Counts {
                draw_batch(pass, batch, casters, light, |part| self.counting(part));
                continue;
            }
            draw_batch(pass, batch, casters, light, |_| &self.fill);
            // What is found dark is drawn no more, so the stencil must be kept as well.
            self.shadows.start(pass, batch, rect);
            draw_batch(pass, batch, casters, light, |part| self.shadows.pipelines.counting(part));
            if i + 1 < light.plan.batches.len() {
                self.shadows.fold(pass, batch.rect.unwrap_or(rect));
            }
        }
    }

    fn add_fill_of_mark(&self, pass: &mut wgpu::RenderPass<'_>, light: &ShadowLight) {
        if let Some(mark) = light.mark.as_ref().filter(|_| light.has_mark()) {
            pass.set_pipeline(&self.fill_of_mark);
            pass.set_vertex_buffer(0, mark.slice(..));
            pass.draw(0..light.plan.mark.len() as u32, 0..1);
        } else if light.marks_receivers() {
            pass.set_pipeline(&self.fill_of_receivers);
            pass.draw(0..3, 0..1);
        }
    }

    fn counting(&self, part: Part) -> &wgpu::RenderPipeline {
        match part {
            Part::Pass => &self.pass,
            Part::Fail => &self.fail,
            Part::LightCap => &self.light_cap,
            Part::PassTurned => &self.pass_turned,
            Part::FailTurned => &self.fail_turned,
        }
    }
}

impl ShadowLight {
    /// What counts start from where z-pass is started at the near rectangle.
    pub(crate) fn start(&self) -> u32 {
        self.plan.batches.iter().map(|batch| batch.start).sum()
    }
}
