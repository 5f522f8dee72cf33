//! Shadows whose silhouettes are found on the GPU, for all lights of a frame at once.
//!
//! ```text
//!   jobs       which casters matter to which light, from boxes          CPU
//!   tables     what is known of meshes before there is a light          uploaded once
//!   full       facing, silhouettes, cases, draws                        compute
//!   smooth     smooth silhouettes of bodies                             compute
//!   basic      the same in textures                                     render passes
//!   pipelines  volumes from lists or textures
//!   read       what was found, for tests
//!   alone      how long finding takes
//!   sums       counts where the stencil can't count as far
//! ```
//!
//! What is drawn of a light is a [`ShadowLight`], as it is where silhouettes come from the CPU, and is drawn by the same calls.

mod alone;
pub(crate) mod basic;
mod full;
mod jobs;
pub(crate) mod pipelines;
mod read;
mod smooth;
mod sums;
mod tables;

use std::sync::OnceLock;

use bytemuck::Zeroable as _;
use umbrae_core::{Caster, Light};
use web_time::Instant;

pub(crate) use jobs::FoundDraw;
pub use read::FoundSilhouette;
pub use smooth::FoundSmoothSilhouette;
#[cfg(test)]
pub(crate) use smooth::SMOOTH_RESULT_BYTES;
pub(crate) use smooth::{FoundSmooth, SmoothDrawnWith};
pub use sums::ShadowSums;

use super::options::{ShadowOptions, SilhouetteSource};
use super::plan::Plan;
use super::report::LightReport;
use super::{ShadowCasters, ShadowLight, ShadowView, Shadows};
use crate::growing::GrowingBuffer;
use crate::passes::uniform_buffer_and_group;
use crate::timing::PassTimer;
use crate::uniforms::LightUniform;
use crate::{Gpu, GpuError, shaders};
use basic::BasicFinder;
use full::FullFinder;
pub(crate) use full::RESULT_BYTES;
use jobs::Amount;
use jobs::Job;
use pipelines::{DrawnFrom, FoldPass, FoundPipelines, job_offset};
use smooth::{SmoothDrawing, SmoothFinder};

/// The shadows of all lights of a frame, of silhouettes found on the GPU; kept from frame to frame with its memory.
///
/// In each frame: [`FoundShadows::plan`], [`FoundShadows::upload`], [`FoundShadows::record`] into what is submitted before or with the passes that draw;
/// then [`FoundShadows::lights`] are drawn by [`Shadows::draw`]. What was recorded must be submitted before the next frame is uploaded.
#[derive(Debug)]
pub struct FoundShadows {
    finder: Finder,
    jobs: Vec<Job>,
    /// Of those, as many as the frame has are in use.
    lights: Vec<FoundLight>,
    light_count: usize,
    light_layout: wgpu::BindGroupLayout,
}

/// Who finds.
#[derive(Debug)]
enum Finder {
    Full(Box<FullFinder>),
    Basic(Box<BasicFinder>),
}

/// A light with the buffers that are filled again in each frame.
#[derive(Debug)]
struct FoundLight {
    shadows: ShadowLight,
    uniform_data: LightUniform,
    uniform: wgpu::Buffer,
    mark: GrowingBuffer,
    loose: GrowingBuffer,
}

/// What draws the volumes of [`FoundShadows`]; compiled when first needed.
#[derive(Debug, Default)]
pub(crate) struct FoundDrawing {
    of_lists: OnceLock<VolumeDrawing>,
    of_tables: OnceLock<VolumeDrawing>,
    of_smooth: OnceLock<SmoothDrawing>,
}

#[derive(Debug)]
struct VolumeDrawing {
    stencil: FoundPipelines,
    /// Where there may be any.
    sums: Option<(FoundPipelines, FoldPass)>,
}

/// What is added up in one go.
#[derive(Debug, Clone, Copy)]
enum Sum {
    /// Casters that count their triangles, together.
    Triangles,
    Smooth(FoundSmooth),
}

/// What one light's volumes are drawn with.
#[derive(Debug, Clone)]
pub(crate) enum DrawnWith {
    /// As many as the GPU says.
    Lists { group: wgpu::BindGroup, arguments: wgpu::Buffer },
    /// All that there might be.
    Tables { group: wgpu::BindGroup },
}

impl Shadows {
    /// What finds silhouettes as `source` says, other than on the CPU, for `casters`, which are uploaded as `uploaded`.
    ///
    /// About 60 bytes for each triangle of a closed mesh, once for all of its instances; in use, for each frame, 12 to 16 bytes for each
    /// triangle of each light that its caster matters to.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoSilhouettes`] when the device can't do that, [`GpuError::TooLarge`].
    ///
    /// # Panics
    ///
    /// If `source` is the CPU.
    pub fn finder(
        &self,
        gpu: &Gpu,
        casters: &[Caster],
        uploaded: &ShadowCasters,
        source: SilhouetteSource,
    ) -> Result<FoundShadows, GpuError> {
        let finder = match source {
            SilhouetteSource::Auto | SilhouetteSource::Cpu(_) => panic!("what is found on the CPU is Shadows::light"),
            SilhouetteSource::Gpu => Finder::Full(Box::new(FullFinder::new(gpu, casters, uploaded)?)),
            SilhouetteSource::GpuBasic => {
                Finder::Basic(Box::new(BasicFinder::new(gpu, casters, uploaded, self.may_sum_basic())?))
            }
        };
        let found = FoundShadows {
            finder,
            jobs: Vec::new(),
            lights: Vec::new(),
            light_count: 0,
            light_layout: self.layouts.light.clone(),
        };
        self.compile_found(gpu, source, &found);
        Ok(found)
    }

    /// Compiles what draws volumes that `found` finds as `source` says, unless that was done.
    pub(crate) fn compile_found(&self, gpu: &Gpu, source: SilhouetteSource, found: &FoundShadows) {
        let target = self.target();
        if found.smooth().is_some() {
            self.found.of_smooth.get_or_init(|| SmoothDrawing::new(gpu, &self.layouts, &target));
        }
        let compile = |may_sum: bool, from: DrawnFrom<'_>| {
            let sums = || (FoundPipelines::sums(gpu, &self.layouts, &target, from), FoldPass::new(gpu, &target));
            let stencil = FoundPipelines::stencil(gpu, &self.layouts, &target, from);
            VolumeDrawing { stencil, sums: may_sum.then(sums) }
        };
        match source {
            SilhouetteSource::Auto | SilhouetteSource::Cpu(_) => {}
            SilhouetteSource::Gpu => {
                let module = || shaders::found_volume(&gpu.device);
                let of_lists = || compile(true, DrawnFrom { module: &module(), layout: &pipelines::draw_layout(gpu) });
                self.found.of_lists.get_or_init(of_lists);
            }
            SilhouetteSource::GpuBasic => {
                let of_tables = || basic::drawn_from(gpu, |from| compile(self.may_sum_basic(), from));
                self.found.of_tables.get_or_init(of_tables);
            }
        }
    }

    /// WebGL2 can't read textures of several samples.
    fn may_sum_basic(&self) -> bool {
        self.target.samples == 1
    }

    fn drawing_of(&self, with: &DrawnWith) -> &VolumeDrawing {
        let drawing = match with {
            DrawnWith::Lists { .. } => self.found.of_lists.get(),
            DrawnWith::Tables { .. } => self.found.of_tables.get(),
        };
        drawing.expect("what was found was found for these shadows")
    }

    /// Draws those of `draws` into the stencil.
    pub(super) fn draw_found(&self, pass: &mut wgpu::RenderPass<'_>, light: &ShadowLight, draws: &[FoundDraw]) {
        if let Some(with) = light.drawn_with.as_ref().filter(|_| !draws.is_empty()) {
            let pipelines = &self.drawing_of(with).stencil;
            draw(pass, with, draws, |draw| pipelines.of(draw.part, draw.shape));
        }
    }

    /// Adds up what the stencil can't count, after [`Shadows::draw`] or [`Shadows::draw_counts`]: sum `i` of [`ShadowLight::sum_count`], each in a pass of its own
    /// whose colour is [`ShadowSums::attachment`] alone, with the same depth and stencil. [`Shadows::draw_fold`] comes behind each.
    pub fn draw_sums(&self, pass: &mut wgpu::RenderPass<'_>, view: &ShadowView, light: &ShadowLight, i: usize) {
        self.bind(pass, view, light);
        pass.set_stencil_reference(super::MARK);
        let found = match light.sum(i) {
            Some(Sum::Triangles) => None,
            Some(Sum::Smooth(found)) => Some(found),
            None => return,
        };
        if let Some(found) = found {
            if let (Some(drawing), Some(with)) = (self.found.of_smooth.get(), &light.drawn_smooth) {
                found.draw(pass, drawing, with);
            }
            return;
        }
        let Some(with) = &light.drawn_with else { return };
        let Some((pipelines, _)) = &self.drawing_of(with).sums else { return };
        draw(pass, with, &light.plan.summed, |draw| pipelines.of(draw.part, draw.shape));
    }

    /// Takes the light away where `sums`, into which sum `i` was drawn, are not 0: in a pass without colour, with the same depth and stencil.
    pub fn draw_fold(&self, pass: &mut wgpu::RenderPass<'_>, light: &ShadowLight, i: usize, sums: &ShadowSums) {
        let Some(rect) = light.plan.rect else { return };
        let (rect, fold) = match light.sum(i) {
            Some(Sum::Triangles) => {
                let drawing = light.drawn_with.as_ref().map(|with| self.drawing_of(with));
                let Some((_, fold)) = drawing.and_then(|drawing| drawing.sums.as_ref()) else { return };
                (rect, fold)
            }
            Some(Sum::Smooth(found)) => {
                let Some(drawing) = self.found.of_smooth.get() else { return };
                (found.rect, &drawing.fold)
            }
            None => return,
        };
        super::set_scissor(pass, rect);
        pass.set_stencil_reference(super::MARK);
        fold.draw(pass, &sums.group);
    }
}

/// Records `draws`, each with its pipeline; changes state only where it differs.
fn draw<'a>(
    pass: &mut wgpu::RenderPass<'_>,
    with: &DrawnWith,
    draws: &[FoundDraw],
    pipeline: impl Fn(&FoundDraw) -> &'a wgpu::RenderPipeline,
) {
    let mut last: Option<&FoundDraw> = None;
    for draw in draws {
        if last.is_none_or(|last| (last.part, last.shape) != (draw.part, draw.shape)) {
            pass.set_pipeline(pipeline(draw));
        }
        if last.is_none_or(|last| last.job != draw.job) {
            match with {
                DrawnWith::Lists { group, .. } => pass.set_bind_group(2, group, &[job_offset(draw.job)]),
                DrawnWith::Tables { group } => pass.set_bind_group(2, group, &[]),
            }
        }
        if last.is_none_or(|last| last.rect != draw.rect) {
            super::set_scissor(pass, draw.rect);
        }
        match (draw.amount, with) {
            (Amount::Found(count), DrawnWith::Lists { arguments, .. }) => {
                let offset = 16 + 16 * count as u64;
                pass.draw_indirect(arguments, RESULT_BYTES * u64::from(draw.job) + offset);
            }
            (Amount::AtMost { first_vertex, end_vertex, copies }, _) => {
                pass.draw(first_vertex..end_vertex, 0..copies);
            }
            (Amount::Found(_), DrawnWith::Tables { .. }) => unreachable!("tables hold no arguments"),
        }
        last = Some(draw);
    }
}

impl FoundShadows {
    /// Decides from boxes what must be found and drawn for `lights` as `view` sees it: everything that the CPU does in a frame, a few hundred
    /// nanoseconds for each caster and light.
    ///
    /// `casters` and `uploaded` must be those that this was made for; casters may have moved, and their boxes must hold them.
    pub fn plan(
        &mut self,
        gpu: &Gpu,
        casters: &[Caster],
        uploaded: &ShadowCasters,
        view: &ShadowView,
        lights: &[Light],
        options: &ShadowOptions,
    ) {
        self.light_count = lights.len();
        while self.lights.len() < lights.len() {
            let light = FoundLight::new(gpu, &self.light_layout, options);
            self.lights.push(light);
        }
        match &mut self.finder {
            Finder::Full(finder) => {
                finder.start(&view.seen.camera, lights.len() as u32);
                if let Some(smooth) = &mut finder.smooth {
                    smooth.start(casters, uploaded, &view.seen, options);
                }
            }
            Finder::Basic(finder) => finder.start(gpu, casters, uploaded, &view.seen.camera, lights),
        }
        self.jobs.clear();
        for (number, (found, light)) in (0..).zip(self.lights.iter_mut().zip(lights)) {
            let start = Instant::now();
            let light = rounded_to_f32(light);
            let position = light.position;
            found.uniform_data = LightUniform::new(&light);
            let plan = &mut found.shadows.plan;
            let scope = plan.start(casters, &view.seen, &light, options);
            if let Finder::Full(finder) = &mut self.finder {
                finder.add_light(position, scope.as_ref());
            }
            if let Some(scope) = &scope {
                let (seen, casters) = (&view.seen, (casters, uploaded));
                match &mut self.finder {
                    Finder::Full(finder) => {
                        let smooth = finder.smooth.as_mut();
                        jobs::add(&mut self.jobs, plan, scope, casters, seen, (number, position), options, smooth);
                    }
                    Finder::Basic(finder) => finder.add_draws(plan, scope, casters, seen, (number, &light), options),
                }
                plan.add_spheres(seen, position, (&scope.culler, &scope.chooser), options, scope.rect);
                plan.sort();
            }
            found.shadows.tell(start.elapsed().as_secs_f64() * 1e3);
        }
        if let Finder::Full(finder) = &mut self.finder {
            finder.add_jobs(&self.jobs, uploaded);
        }
    }

    /// Uploads what [`FoundShadows::plan`] planned: 256 bytes for each caster and light that matters, 4 for each that does not.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the lists could be longer than shaders of the device can be given, or do not fit into its textures.
    pub fn upload(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        match &mut self.finder {
            Finder::Full(finder) => finder.upload(gpu)?,
            Finder::Basic(finder) => finder.upload(gpu)?,
        }
        for (number, found) in self.lights[..self.light_count].iter_mut().enumerate() {
            found.upload(gpu)?;
            found.shadows.drawn_with = match &self.finder {
                Finder::Full(finder) => finder.drawn_with(),
                Finder::Basic(finder) => Some(finder.drawn_with(number)),
            };
            found.shadows.drawn_smooth = match &self.finder {
                Finder::Full(finder) => finder.smooth.as_ref().and_then(SmoothFinder::drawn_with),
                Finder::Basic(_) => None,
            };
        }
        Ok(())
    }

    /// Records the finding.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.record_timed(encoder, &mut PassTimer::off());
    }

    pub(crate) fn record_timed(&self, encoder: &mut wgpu::CommandEncoder, timer: &mut PassTimer) {
        match &self.finder {
            Finder::Full(finder) => finder.record(encoder, timer),
            Finder::Basic(finder) => finder.record(encoder, timer),
        }
    }

    fn smooth(&self) -> Option<&SmoothFinder> {
        if let Finder::Full(finder) = &self.finder { finder.smooth.as_ref() } else { None }
    }

    /// The lights of the frame that was planned last, in order.
    pub fn lights(&self) -> impl ExactSizeIterator<Item = &ShadowLight> {
        self.lights[..self.light_count].iter().map(|found| &found.shadows)
    }
}

impl FoundLight {
    fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, options: &ShadowOptions) -> Self {
        let uniform_data = LightUniform::zeroed();
        let (uniform, group) = uniform_buffer_and_group(gpu, "light", layout, bytemuck::bytes_of(&uniform_data));
        Self {
            shadows: ShadowLight {
                plan: Plan::empty(options),
                group,
                mark: None,
                short: None,
                long: None,
                loose: None,
                smooth: [None, None],
                drawn_with: None,
                drawn_smooth: None,
                report: LightReport {
                    casters: Vec::new(),
                    spheres: Vec::new(),
                    cpu_ms: 0.0,
                    rect: None,
                    batches: 0,
                    index_bytes: 0,
                },
            },
            uniform_data,
            uniform,
            mark: GrowingBuffer::new(gpu, "light mark", wgpu::BufferUsages::VERTEX),
            loose: GrowingBuffer::new(gpu, "sphere volumes", wgpu::BufferUsages::VERTEX),
        }
    }

    fn upload(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.uniform_data));
        let shadows = &mut self.shadows;
        for (vertices, buffer, drawn) in [
            (&shadows.plan.mark, &mut self.mark, &mut shadows.mark),
            (&shadows.plan.loose, &mut self.loose, &mut shadows.loose),
        ] {
            buffer.fill(gpu, bytemuck::cast_slice(vertices))?;
            *drawn = Some(buffer.buffer().clone());
        }
        Ok(())
    }
}

/// As shaders see it, without its name, so that nothing is allocated.
fn rounded_to_f32(light: &Light) -> Light {
    let &Light { position, strength, cone, range_m, extent, .. } = light;
    Light { name: String::new(), position, strength, cone, range_m, extent }.rounded_to_f32()
}

impl ShadowLight {
    /// Says what was planned; the plan keeps the memory of what was said before.
    fn tell(&mut self, cpu_ms: f64) {
        std::mem::swap(&mut self.report.casters, &mut self.plan.casters);
        std::mem::swap(&mut self.report.spheres, &mut self.plan.spheres);
        self.report.cpu_ms = cpu_ms;
        self.report.rect = self.plan.rect;
        self.report.batches = self.plan.batches.len();
    }

    /// How many sums must be drawn ([`Shadows::draw_sums`]): one of all casters that may overlap themselves more often than the stencil can count, if
    /// there are any, and one of each smooth body whose silhouette was found on the GPU.
    pub fn sum_count(&self) -> usize {
        usize::from(!self.plan.summed.is_empty()) + self.plan.found_smooth.len()
    }

    /// Whether there are any sums.
    pub fn needs_sums(&self) -> bool {
        self.sum_count() > 0
    }

    fn sum(&self, i: usize) -> Option<Sum> {
        let first_smooth = usize::from(!self.plan.summed.is_empty());
        match i.checked_sub(first_smooth) {
            None => Some(Sum::Triangles),
            Some(i) => self.plan.found_smooth.get(i).copied().map(Sum::Smooth),
        }
    }
}
