//! One frame, in the order in which it happens. Read this file first.
//!
//! ```text
//! silhouettes            of all lights, if they are found on the GPU
//! surface                every opaque triangle and sphere: depth, ambient light
//! for each light that reaches the view:
//!   volumes              the mark, then the shadow volumes into the stencil
//!   sums, fold           volumes that the stencil can't count, if any: added up, then taken out of the mark; once more for each smooth body found on the GPU
//!   light                this light, added where the stencil says that it reaches
//!  or, of a light with a size:
//!   coverage, composite  what casters cover of it, group by group, and what is left (see `soft/`)
//!   light                this light, as much of it as is seen
//! glass                  what is seen through, over all that (pictures only)
//! overlay                what is shown over the picture, if anything is
//! tone                   radiance into display colours (pictures only)
//! ```

use std::sync::OnceLock;

use umbrae_core::PixelRect;

use crate::passes::{
    GlassFrame, GlassPass, GpuOverlay, GpuSpheres, LightPass, OverlayPass, SpherePass, SurfacePass, TonePass,
};
use crate::shadow::{ShadowLight, ShadowView, Shadows, Tally, TallyKind, set_scissor};
use crate::soft::{SoftLight, SoftLightPass, SoftPass};
use crate::timing::PassTimer;
use crate::{FoundShadows, Gpu, GpuScene, LIT, Targets};

/// The passes over surfaces and volumes, for one kind of target.
#[derive(Debug)]
pub(crate) struct Passes {
    pub(crate) surface: SurfacePass,
    pub(crate) shadows: Shadows,
    pub(crate) light: LightPass,
    pub(crate) spheres: SpherePass,
    pub(crate) soft: OnceLock<SoftPass>,
    pub(crate) soft_light: OnceLock<SoftLightPass>,
}

/// What the passes draw and where; all borrowed, nothing owned.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) targets: &'a Targets,
    pub(crate) scene: &'a GpuScene,
    pub(crate) spheres: &'a GpuSpheres,
    pub(crate) view: &'a wgpu::BindGroup,
    pub(crate) shadow_view: &'a ShadowView,
    /// What finds silhouettes, if that is the GPU.
    pub(crate) found: Option<&'a FoundShadows>,
    pub(crate) lights: &'a [FrameLight<'a>],
    /// If there is any, and it is wanted.
    pub(crate) glass: Option<(&'a GlassPass, &'a GlassFrame)>,
    /// With the pass that draws it.
    pub(crate) overlay: Option<(&'a OverlayPass, &'a GpuOverlay)>,
}

/// One light of a frame.
#[derive(Debug)]
pub(crate) struct FrameLight<'a> {
    pub(crate) name: &'a str,
    pub(crate) shadows: Shadowing<'a>,
}

/// How the shadows of a light are determined.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shadowing<'a> {
    /// By counting volumes.
    Hard(&'a ShadowLight),
    /// By what casters cover of it.
    Soft(&'a SoftLight),
}

impl<'a> Shadowing<'a> {
    /// The pixels that the light may change; `None` when there are none.
    fn rect(self) -> Option<PixelRect> {
        match self {
            Self::Hard(light) => light.rect(),
            Self::Soft(light) => light.rect(),
        }
    }

    pub(crate) fn hard(self) -> Option<&'a ShadowLight> {
        if let Self::Hard(light) = self { Some(light) } else { None }
    }

    pub(crate) fn soft(self) -> Option<&'a SoftLight> {
        if let Self::Soft(light) = self { Some(light) } else { None }
    }
}

/// How many passes [`record`] and [`record_tone`] make together, at most.
pub(crate) fn pass_count(lights: &[FrameLight<'_>]) -> u32 {
    let of = |light: &FrameLight<'_>| match light.shadows {
        Shadowing::Hard(light) => 2 + 2 * light.sum_count() as u32,
        Shadowing::Soft(soft) => 1 + soft.pass_count(),
    };
    6 + lights.iter().map(of).sum::<u32>()
}

/// Records everything but the tone mapping.
pub(crate) fn record(
    gpu: &Gpu,
    passes: &Passes,
    frame: Frame<'_>,
    encoder: &mut wgpu::CommandEncoder,
    timer: &mut PassTimer,
) {
    if let Some(found) = frame.found {
        found.record_timed(encoder, timer);
    }
    let lights: Vec<&FrameLight<'_>> = frame.lights.iter().filter(|light| light.shadows.rect().is_some()).collect();
    // Multisampled colour is resolved once, after the last pass that adds to it.
    record_surface(passes, frame, lights.is_empty() && frame.glass.is_none(), encoder, timer);
    for (i, light) in lights.iter().enumerate() {
        let is_last = i + 1 == lights.len() && frame.glass.is_none();
        let shadows = match light.shadows {
            Shadowing::Hard(shadows) => shadows,
            Shadowing::Soft(soft) => {
                record_visibility(gpu, passes, frame, (light.name, soft), encoder, timer);
                record_soft_light(passes, frame, (light.name, soft), is_last, encoder, timer);
                continue;
            }
        };
        let clear_stencil = wgpu::LoadOp::Clear(shadows.clear_value());
        let name = format!("volumes: {}", light.name);
        let mut pass = begin(encoder, frame, &name, None, (wgpu::LoadOp::Load, clear_stencil), timer);
        record_mark(passes, frame, shadows, &mut pass);
        passes.shadows.draw_counts(&mut pass, &frame.scene.shadow_casters, frame.shadow_view, shadows);
        drop(pass);
        record_sums(passes, frame, (light.name, shadows), encoder, timer);

        let color = color_attachment(frame.targets, wgpu::LoadOp::Load, is_last);
        let name = format!("light: {}", light.name);
        let keep = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
        let mut pass = begin(encoder, frame, &name, Some(color), keep, timer);
        shadows.rect().into_iter().for_each(|rect| set_scissor(&mut pass, rect));
        passes.light.draw(&mut pass, frame.scene, shadows.group());
        passes.spheres.draw_light(&mut pass, frame.spheres, shadows.group());
    }
    if let Some((glass_pass, glass)) = frame.glass {
        let color = color_attachment(frame.targets, wgpu::LoadOp::Load, true);
        let keep = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
        let mut pass = begin(encoder, frame, "glass", Some(color), keep, timer);
        glass_pass.draw(&mut pass, frame.scene, glass);
    }

    if let Some((overlay_pass, overlay)) = frame.overlay {
        // Resolved once more, with what it adds.
        let color = color_attachment(frame.targets, wgpu::LoadOp::Load, true);
        let keep = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
        let mut pass = begin(encoder, frame, "overlay", Some(color), keep, timer);
        overlay_pass.draw(&mut pass, overlay);
    }
}

/// Records what adds up counts or fill of the first light into `to`; nothing if that light draws nothing.
pub(crate) fn record_tally(
    passes: &Passes,
    (tally, kind): (&Tally, TallyKind),
    frame: Frame<'_>,
    to: &wgpu::TextureView,
    encoder: &mut wgpu::CommandEncoder,
) {
    let timer = &mut PassTimer::off();
    record_surface(passes, frame, true, encoder, timer);
    let Some(light) = frame.lights.first().and_then(|light| light.shadows.hard()) else { return };
    let clear_stencil = wgpu::LoadOp::Clear(light.clear_value());
    let mut pass = begin(encoder, frame, "mark", None, (wgpu::LoadOp::Load, clear_stencil), timer);
    record_mark(passes, frame, light, &mut pass);
    drop(pass);
    let color = wgpu::RenderPassColorAttachment {
        view: to,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
    };
    let keep = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
    let mut pass = begin(encoder, frame, "tally", Some(color), keep, timer);
    tally.draw(&mut pass, kind, &frame.scene.shadow_casters, frame.shadow_view, light);
}

fn record_surface(
    passes: &Passes,
    frame: Frame<'_>,
    is_last: bool,
    encoder: &mut wgpu::CommandEncoder,
    timer: &mut PassTimer,
) {
    let clear_color = wgpu::LoadOp::Clear(frame.targets.output.clear_color());
    let clear_depth = (wgpu::LoadOp::Clear(0.0), wgpu::LoadOp::Clear(0));
    let color = color_attachment(frame.targets, clear_color, is_last);
    let mut pass = begin(encoder, frame, "surface", Some(color), clear_depth, timer);
    passes.surface.draw(&mut pass, frame.scene);
    passes.spheres.draw_surface(&mut pass, frame.spheres);
}

fn record_mark(passes: &Passes, frame: Frame<'_>, light: &ShadowLight, pass: &mut wgpu::RenderPass<'_>) {
    if light.marks_receivers() {
        light.rect().into_iter().for_each(|rect| set_scissor(pass, rect));
        passes.light.draw_mark(pass, frame.scene, light.group());
        passes.spheres.draw_mark(pass, frame.spheres, light.group());
    } else {
        passes.shadows.draw_reach(pass, frame.shadow_view, light);
    }
}

/// Records what takes the mark away where volumes that the stencil can't count hold what is seen.
fn record_sums(
    passes: &Passes,
    frame: Frame<'_>,
    (name, light): (&str, &ShadowLight),
    encoder: &mut wgpu::CommandEncoder,
    timer: &mut PassTimer,
) {
    let Some(sums) = frame.targets.sums().filter(|_| light.needs_sums()) else { return };
    let keep = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
    for i in 0..light.sum_count() {
        let label = format!("sums: {name}");
        let mut pass = begin(encoder, frame, &label, Some(sums.attachment()), keep, timer);
        passes.shadows.draw_sums(&mut pass, frame.shadow_view, light, i);
        drop(pass);
        let mut pass = begin(encoder, frame, &format!("fold: {name}"), None, keep, timer);
        passes.shadows.draw_fold(&mut pass, light, i, sums);
    }
}

/// Records what finds how much of a light is seen from the depth that is there.
pub(crate) fn record_visibility(
    gpu: &Gpu,
    passes: &Passes,
    frame: Frame<'_>,
    light: (&str, &SoftLight),
    encoder: &mut wgpu::CommandEncoder,
    timer: &mut PassTimer,
) {
    let (Some(soft), Some(to)) = (passes.soft.get(), frame.targets.soft()) else { return };
    soft.record(gpu, (frame.targets, to), frame.shadow_view, light, encoder, timer);
}

/// Records the surfaces, and how much of the first light is seen there.
pub(crate) fn record_visibility_alone(
    gpu: &Gpu,
    passes: &Passes,
    frame: Frame<'_>,
    encoder: &mut wgpu::CommandEncoder,
    timer: &mut PassTimer,
) {
    record_surface(passes, frame, true, encoder, timer);
    if let Some((light, soft)) = frame.lights.first().and_then(|light| Some((light, light.shadows.soft()?))) {
        record_visibility(gpu, passes, frame, (light.name, soft), encoder, timer);
    }
}

fn record_soft_light(
    passes: &Passes,
    frame: Frame<'_>,
    (name, light): (&str, &SoftLight),
    is_last: bool,
    encoder: &mut wgpu::CommandEncoder,
    timer: &mut PassTimer,
) {
    let (Some(soft), Some(visibility)) = (passes.soft_light.get(), frame.targets.soft()) else { return };
    let color = color_attachment(frame.targets, wgpu::LoadOp::Load, is_last);
    // How much of it is seen, the visibility says.
    let seen = (wgpu::LoadOp::Load, wgpu::LoadOp::Clear(LIT));
    let mut pass = begin(encoder, frame, &format!("light: {name}"), Some(color), seen, timer);
    light.rect().into_iter().for_each(|rect| set_scissor(&mut pass, rect));
    soft.draw(&mut pass, (frame.scene, frame.spheres), light.group(), visibility);
}

/// Records the tone mapping into `to`, a headless texture or a window's.
pub(crate) fn record_tone(
    tone: &TonePass,
    radiance: &wgpu::BindGroup,
    view: &wgpu::BindGroup,
    to: &wgpu::TextureView,
    encoder: &mut wgpu::CommandEncoder,
    timer: &mut PassTimer,
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("tone"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: to,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        timestamp_writes: timer.writes("tone".to_owned()),
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_bind_group(0, view, &[]);
    tone.draw(&mut pass, radiance);
}

fn color_attachment<'a>(
    targets: &'a Targets,
    load: wgpu::LoadOp<wgpu::Color>,
    is_last: bool,
) -> wgpu::RenderPassColorAttachment<'a> {
    wgpu::RenderPassColorAttachment {
        view: &targets.color,
        depth_slice: None,
        resolve_target: (is_last && targets.samples > 1).then_some(&targets.resolved_view),
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    }
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    frame: Frame<'_>,
    label: &str,
    color: Option<wgpu::RenderPassColorAttachment<'_>>,
    (depth, stencil): (wgpu::LoadOp<f32>, wgpu::LoadOp<u32>),
    timer: &mut PassTimer,
) -> wgpu::RenderPass<'e> {
    let colors = [color];
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: if colors[0].is_some() { &colors } else { &[] },
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &frame.targets.depth_stencil,
            depth_ops: Some(wgpu::Operations { load: depth, store: wgpu::StoreOp::Store }),
            stencil_ops: Some(wgpu::Operations { load: stencil, store: wgpu::StoreOp::Store }),
        }),
        timestamp_writes: timer.writes(label.to_owned()),
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_bind_group(0, frame.view, &[]);
    pass
}
