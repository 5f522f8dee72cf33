//! Shadow determination alone: for casters, a camera and lights, the stencil of any render pass.
//!
//! [`Shadows`] needs a device, the pass's depth-stencil format and sample count, and depth that is already there; it leaves the stencil at
//! [`LIT`] exactly where the light reaches. [`crate::Renderer`] is one user of it; `examples/own_renderer.rs` another.
//!
//! ```text
//!   options    what may be left out                 plan         fates, batches
//!   casters    vertices, uploaded once              caster_plan  one caster's silhouette, volume and case
//!   spheres    volumes of spheres, as vertices      smooth_plan  the same of a smooth body
//!                                                   emit         faces as indices
//!   pipelines  stencil states                       report       what was drawn and why
//!   tally      counts and fill as numbers           found        silhouettes found on the GPU
//! ```
//!
//! Source: M. McGuire et al., "Fast, practical and robust shadows", 2003.

pub(crate) mod caster_plan;
pub(crate) mod casters;
pub(crate) mod emit;
pub(crate) mod found;
mod options;
mod pipelines;
pub(crate) mod plan;
mod report;
pub(crate) mod smooth_plan;
pub(crate) mod spheres;
mod tally;

use umbrae_core::{Camera, Caster, Light, PixelRect, Sphere};
use web_time::Instant;

pub use casters::ShadowCasters;
#[cfg(test)]
pub(crate) use found::RESULT_BYTES;
#[cfg(test)]
pub(crate) use found::SMOOTH_RESULT_BYTES;
pub use found::{FoundShadows, FoundSilhouette, FoundSmoothSilhouette, ShadowSums};
pub use options::{LightMark, Method, ShadowOptions, SilhouetteSource, Smooth};
pub use pipelines::ShadowTarget;
pub use report::{CasterReport, FaceCounts, Fate, LightReport, Why};
pub(crate) use tally::{Tally, TallyKind};

use crate::passes::{Layouts, uniform_buffer_and_group, uniform_group};
use crate::uniforms::{LightUniform, View};
use crate::{Gpu, GpuError, Look};
use found::{DrawnWith, FoundDrawing, SmoothDrawnWith};
use pipelines::{MARK, Pipelines};
use plan::{Batch, Draw, Plan, Seen, Source};

/// The stencil value where a light reaches: draw the light with compare `Equal` and this reference.
pub const LIT: u32 = MARK;

/// Draws shadow volumes into the stencil of passes of one kind.
#[derive(Debug)]
pub struct Shadows {
    layouts: Layouts,
    pipelines: Pipelines,
    target: OwnedTarget,
    found: FoundDrawing,
}

/// A [`ShadowTarget`] that is kept.
#[derive(Debug)]
struct OwnedTarget {
    depth_stencil_format: wgpu::TextureFormat,
    samples: u32,
    color_formats: Vec<Option<wgpu::TextureFormat>>,
}

/// What a camera sees of some casters: for all lights of a frame.
#[derive(Debug)]
pub struct ShadowView {
    pub(crate) seen: Seen,
    uniform: wgpu::Buffer,
    pub(crate) group: wgpu::BindGroup,
}

impl ShadowView {
    /// Looks at the same casters, which may have moved, from `camera`, in the memory that there is. Draws that are not submitted yet look from there too.
    pub fn look_from(&mut self, gpu: &Gpu, casters: &[Caster], camera: &Camera) {
        self.seen.look_from(camera, casters);
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&View::new(camera, &Look::NONE)));
    }
}

/// The volumes of one light, on the device.
#[derive(Debug)]
pub struct ShadowLight {
    plan: Plan,
    group: wgpu::BindGroup,
    mark: Option<wgpu::Buffer>,
    short: Option<wgpu::Buffer>,
    long: Option<wgpu::Buffer>,
    loose: Option<wgpu::Buffer>,
    /// Vertices and indices of smooth silhouettes.
    smooth: [Option<wgpu::Buffer>; 2],
    /// Of silhouettes found on the GPU.
    drawn_with: Option<DrawnWith>,
    /// Of smooth silhouettes found on the GPU.
    drawn_smooth: Option<SmoothDrawnWith>,
    /// What is drawn and why.
    pub report: LightReport,
}

impl ShadowLight {
    /// The pixels that the light may change, for a scissor; `None` when there are none, and nothing need be drawn for it.
    pub fn rect(&self) -> Option<PixelRect> {
        self.plan.rect
    }

    /// What the stencil must be cleared to before the light is marked, unless receivers are marked one by one.
    pub(crate) fn clear_value(&self) -> u32 {
        let is_marked_later = self.has_mark() || self.plan.mark_kind == LightMark::Receivers;
        if is_marked_later { 0 } else { LIT }
    }

    /// Whether the light's reach is marked as a body.
    fn has_mark(&self) -> bool {
        !self.plan.mark.is_empty()
    }

    /// Whether the surfaces that the light would brighten are to be marked before counting.
    pub(crate) fn marks_receivers(&self) -> bool {
        self.plan.mark_kind == LightMark::Receivers
    }

    /// The uniform of `light.wgsl`.
    pub(crate) fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }
}

impl Shadows {
    /// Compiles the pipelines for passes with the attachments of `target`.
    pub fn new(gpu: &Gpu, target: &ShadowTarget<'_>) -> Self {
        let layouts = Layouts::new(gpu);
        let pipelines = Pipelines::new(&gpu.device, &layouts, target);
        let target = OwnedTarget {
            depth_stencil_format: target.depth_stencil_format,
            samples: target.samples,
            color_formats: target.color_formats.to_vec(),
        };
        Self { layouts, pipelines, target, found: FoundDrawing::default() }
    }

    fn target(&self) -> ShadowTarget<'_> {
        let OwnedTarget { depth_stencil_format, samples, color_formats } = &self.target;
        ShadowTarget { depth_stencil_format: *depth_stencil_format, samples: *samples, color_formats }
    }

    /// Samples of each pixel of the passes.
    pub(crate) fn samples(&self) -> u32 {
        self.target.samples
    }

    /// Makes ready for `camera`, of the size of the pass.
    ///
    /// Depth must have been drawn with [`Camera::clip_from_world`] rounded to `f32`, from the casters' own positions, as
    /// `clip_from_world * vec4(position, 1)` with an `@invariant` position.
    pub fn view(&self, gpu: &Gpu, casters: &[Caster], camera: &Camera) -> ShadowView {
        self.view_with_spheres(gpu, casters, &[], camera)
    }

    /// As [`Shadows::view`], with `spheres` that cast besides; what is drawn of them, rounded to `f32`, must be in the depth too.
    pub fn view_with_spheres(&self, gpu: &Gpu, casters: &[Caster], spheres: &[Sphere], camera: &Camera) -> ShadowView {
        let view = View::new(camera, &Look::NONE);
        let (uniform, group) = uniform_buffer_and_group(gpu, "view", &self.layouts.view, bytemuck::bytes_of(&view));
        ShadowView { seen: Seen::new(camera, casters, spheres), uniform, group }
    }

    /// The volumes of `casters`, uploaded as `uploaded`, under `light`. Silhouettes are found on the CPU, whatever `options` say;
    /// [`Shadows::finder`] is for the GPU.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the indices are more than a buffer of the device can hold.
    pub fn light(
        &self,
        gpu: &Gpu,
        casters: &[Caster],
        uploaded: &ShadowCasters,
        view: &ShadowView,
        light: &Light,
        options: &ShadowOptions,
    ) -> Result<ShadowLight, GpuError> {
        let start = Instant::now();
        // The shaders see the light in f32, so everything else must reason about that light too.
        let light = light.rounded_to_f32();
        let mut plan = Plan::new(casters, uploaded, &view.seen, &light, options);
        let cpu_ms = start.elapsed().as_secs_f64() * 1e3;
        let report = LightReport {
            casters: std::mem::take(&mut plan.casters),
            spheres: std::mem::take(&mut plan.spheres),
            cpu_ms,
            rect: plan.rect,
            batches: plan.batches.len(),
            index_bytes: plan.indices.bytes() + size_of_val(plan.smooth_indices.as_slice()),
        };
        let upload = |label, bytes, usage| gpu.upload(label, bytes, usage);
        let uniform = LightUniform::new(&light);
        Ok(ShadowLight {
            group: uniform_group(gpu, "light", &self.layouts.light, bytemuck::bytes_of(&uniform)),
            mark: upload("light mark", bytemuck::cast_slice(&plan.mark), wgpu::BufferUsages::VERTEX)?,
            short: upload("short indices", bytemuck::cast_slice(&plan.indices.short), wgpu::BufferUsages::INDEX)?,
            long: upload("long indices", bytemuck::cast_slice(&plan.indices.long), wgpu::BufferUsages::INDEX)?,
            loose: upload("sphere volumes", bytemuck::cast_slice(&plan.loose), wgpu::BufferUsages::VERTEX)?,
            smooth: [
                upload("smooth vertices", bytemuck::cast_slice(&plan.smooth_vertices), wgpu::BufferUsages::VERTEX)?,
                upload("smooth indices", bytemuck::cast_slice(&plan.smooth_indices), wgpu::BufferUsages::INDEX)?,
            ],
            drawn_with: None,
            drawn_smooth: None,
            plan,
            report,
        })
    }

    /// Leaves the stencil at [`LIT`] where `light` reaches, within [`ShadowLight::rect`]; what it holds before does not matter.
    ///
    /// Binds groups 0 and 1, vertex buffer 0 and the scissor; the scissor stays at the light's rectangle. With [`LightMark::Receivers`]
    /// everything is marked: call [`Shadows::reset`], mark receivers, then [`Shadows::draw_counts`] to do better.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        casters: &ShadowCasters,
        view: &ShadowView,
        light: &ShadowLight,
    ) {
        self.reset(pass, view, light, if light.has_mark() { 0 } else { LIT });
        self.draw_reach(pass, view, light);
        self.draw_counts(pass, casters, view, light);
    }

    /// Sets the stencil to `value` within the light's rectangle: [`LIT`] where every pixel is to be counted, 0 where the caller marks
    /// receivers, with the stencil operation `Replace` and the reference [`LIT`]. A pass that begins with a clear stencil can do without.
    pub fn reset(&self, pass: &mut wgpu::RenderPass<'_>, view: &ShadowView, light: &ShadowLight, value: u32) {
        let Some(rect) = light.plan.rect else { return };
        self.bind(pass, view, light);
        set_scissor(pass, rect);
        pass.set_pipeline(&self.pipelines.reset);
        pass.set_stencil_reference(value);
        pass.draw(0..3, 0..1);
    }

    /// Marks the light's reach where the stencil is 0, if the options ask for it and it ends anywhere.
    pub(crate) fn draw_reach(&self, pass: &mut wgpu::RenderPass<'_>, view: &ShadowView, light: &ShadowLight) {
        let (Some(rect), Some(mark)) = (light.plan.rect, light.mark.as_ref().filter(|_| light.has_mark())) else {
            return;
        };
        self.bind(pass, view, light);
        set_scissor(pass, rect);
        pass.set_stencil_reference(MARK);
        pass.set_pipeline(match light.plan.mark_kind {
            LightMark::Select => &self.pipelines.mark_select,
            _ => &self.pipelines.mark_exact,
        });
        pass.set_vertex_buffer(0, mark.slice(..));
        pass.draw(0..light.plan.mark.len() as u32, 0..1);
    }

    /// Counts volumes where the mark is set, and takes the mark away where a count is not 0.
    pub fn draw_counts(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        casters: &ShadowCasters,
        view: &ShadowView,
        light: &ShadowLight,
    ) {
        let Some(rect) = light.plan.rect else { return };
        self.bind(pass, view, light);
        for (i, batch) in light.plan.batches.iter().enumerate() {
            self.start(pass, batch, rect);
            draw_batch(pass, batch, casters, light, |part| self.pipelines.counting(part));
            self.draw_found(pass, light, &light.plan.found[batch.found.clone()]);
            if i + 1 < light.plan.batches.len() {
                self.fold(pass, batch.rect.unwrap_or(rect));
            }
        }
        set_scissor(pass, rect);
    }

    fn bind(&self, pass: &mut wgpu::RenderPass<'_>, view: &ShadowView, light: &ShadowLight) {
        pass.set_bind_group(0, &view.group, &[]);
        pass.set_bind_group(1, &light.group, &[]);
    }

    fn start(&self, pass: &mut wgpu::RenderPass<'_>, batch: &Batch, rect: PixelRect) {
        if batch.start > 0 {
            set_scissor(pass, rect);
            pass.set_pipeline(&self.pipelines.start);
            pass.set_stencil_reference(MARK | batch.start);
            pass.draw(0..3, 0..1);
        }
        pass.set_stencil_reference(MARK);
    }

    fn fold(&self, pass: &mut wgpu::RenderPass<'_>, rect: PixelRect) {
        set_scissor(pass, rect);
        pass.set_pipeline(&self.pipelines.fold);
        pass.set_stencil_reference(MARK);
        pass.draw(0..3, 0..1);
    }
}

/// Records the draws of one batch, each with the pipeline for its part; changes state only where it differs.
fn draw_batch<'a, 'l>(
    pass: &mut wgpu::RenderPass<'_>,
    batch: &Batch,
    casters: &ShadowCasters,
    light: &'l ShadowLight,
    pipeline: impl Fn(emit::Part) -> &'a wgpu::RenderPipeline,
) {
    let mut last: Option<&Draw> = None;
    for draw in &batch.draws {
        if last.is_none_or(|last| last.part != draw.part) {
            pass.set_pipeline(pipeline(draw.part));
        }
        if last.is_none_or(|last| last.source != draw.source) {
            let of_source =
                |buffer: &'l Option<wgpu::Buffer>| buffer.as_ref().expect("what is drawn was uploaded").slice(..);
            pass.set_vertex_buffer(
                0,
                match draw.source {
                    Source::Loose => of_source(&light.loose),
                    Source::Smooth => of_source(&light.smooth[0]),
                    Source::Short | Source::Long => casters.vertices.slice(..),
                },
            );
            match draw.source {
                Source::Smooth => pass.set_index_buffer(of_source(&light.smooth[1]), wgpu::IndexFormat::Uint32),
                Source::Short => pass.set_index_buffer(of_source(&light.short), wgpu::IndexFormat::Uint16),
                Source::Long => pass.set_index_buffer(of_source(&light.long), wgpu::IndexFormat::Uint32),
                Source::Loose => {}
            }
        }
        if last.is_none_or(|last| last.rect != draw.rect) {
            set_scissor(pass, draw.rect);
        }
        if draw.source == Source::Loose {
            pass.draw(draw.elements.clone(), 0..1);
        } else {
            pass.draw_indexed(draw.elements.clone(), draw.base_vertex, 0..1);
        }
        last = Some(draw);
    }
}

pub(crate) fn set_scissor(pass: &mut wgpu::RenderPass<'_>, rect: PixelRect) {
    let [x, y] = rect.min;
    let [width, height] = rect.size();
    pass.set_scissor_rect(x, y, width, height);
}
