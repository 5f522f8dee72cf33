//! The pipelines that write the stencil. Bit 7 is the mark, bits 0 to 6 count.

use crate::passes::{BOTH_SIDES, Layouts};
use crate::shaders;

use super::casters::VOLUME_VERTEX_LAYOUT;
use super::emit::Part;

/// Set where a light may still reach: not yet found dark, nor ever out of reach.
pub(crate) const MARK: u32 = 0x80;
const COUNT: u32 = 0x7F;
const ALL: u32 = 0xFF;

/// The attachments of the passes into which shadows are drawn.
#[derive(Debug, Clone, Copy)]
pub struct ShadowTarget<'a> {
    /// With a stencil of eight bits.
    pub depth_stencil_format: wgpu::TextureFormat,
    /// Samples a pixel.
    pub samples: u32,
    /// The pass's colour attachments, which stay as they are.
    pub color_formats: &'a [Option<wgpu::TextureFormat>],
}

/// Everything that draws into the stencil.
#[derive(Debug)]
pub(crate) struct Pipelines {
    /// Everything in the scissor gets the reference.
    pub(crate) reset: wgpu::RenderPipeline,
    /// The reach; see [`crate::LightMark`].
    pub(crate) mark_exact: wgpu::RenderPipeline,
    pub(crate) mark_select: wgpu::RenderPipeline,
    /// Marked pixels get the reference as their count.
    pub(crate) start: wgpu::RenderPipeline,
    /// Pixels with a count lose their mark.
    pub(crate) fold: wgpu::RenderPipeline,
    pass: wgpu::RenderPipeline,
    fail: wgpu::RenderPipeline,
    light_cap: wgpu::RenderPipeline,
    pass_turned: wgpu::RenderPipeline,
    fail_turned: wgpu::RenderPipeline,
}

/// How one pipeline differs from the others.
pub(crate) struct Kind<'a> {
    pub(crate) label: &'a str,
    pub(crate) entry_point: &'a str,
    pub(crate) depth_compare: wgpu::CompareFunction,
    pub(crate) stencil: wgpu::StencilState,
    pub(crate) front_face: wgpu::FrontFace,
    /// What a fragment does to the colour attachments, and how; `None` leaves them alone.
    pub(crate) fragment: Option<(&'a str, wgpu::BlendOperation)>,
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device, layouts: &Layouts, target: &ShadowTarget<'_>) -> Self {
        use wgpu::CompareFunction::{Always, Equal, Greater};
        use wgpu::StencilOperation::{Invert, Keep, Replace, Zero};
        let module = shaders::volume(device);
        let make = |kind: Kind<'_>| pipeline(device, &module, &layouts.view_and_light, target, &kind);

        let everywhere = |label, stencil| {
            let entry_point = "vs_everywhere";
            let front_face = wgpu::FrontFace::Ccw;
            make(Kind { label, entry_point, depth_compare: Always, stencil, front_face, fragment: None })
        };
        let mark = |label, front, back| {
            let behind =
                |depth_fail_op| wgpu::StencilFaceState { compare: Always, fail_op: Keep, depth_fail_op, pass_op: Keep };
            make(Kind {
                label,
                entry_point: "vs_volume",
                depth_compare: Greater,
                stencil: wgpu::StencilState {
                    front: behind(front),
                    back: behind(back),
                    read_mask: ALL,
                    write_mask: MARK,
                },
                front_face: wgpu::FrontFace::Ccw,
                fragment: None,
            })
        };
        let counts = |label, part| {
            let (depth_compare, stencil, front_face) = counting(part);
            make(Kind { label, entry_point: "vs_volume", depth_compare, stencil, front_face, fragment: None })
        };
        Self {
            reset: everywhere("shadows, reset", one_sided(Always, Replace, [ALL, ALL])),
            mark_exact: mark("light mark, exact", Invert, Invert),
            mark_select: mark("light mark, select", Zero, Replace),
            start: everywhere("shadows, start", one_sided(Equal, Replace, [MARK, COUNT])),
            fold: everywhere("shadows, fold", fold_stencil()),
            pass: counts("volumes, z-pass", Part::Pass),
            fail: counts("volumes, z-fail", Part::Fail),
            light_cap: counts("volumes, light caps", Part::LightCap),
            pass_turned: counts("volumes, z-pass, turned", Part::PassTurned),
            fail_turned: counts("volumes, z-fail, turned", Part::FailTurned),
        }
    }

    /// What counts faces of `part`.
    pub(crate) fn counting(&self, part: Part) -> &wgpu::RenderPipeline {
        match part {
            Part::Pass => &self.pass,
            Part::Fail => &self.fail,
            Part::LightCap => &self.light_cap,
            Part::PassTurned => &self.pass_turned,
            Part::FailTurned => &self.fail_turned,
        }
    }
}

/// How faces of `part` are counted in the stencil: by which comparison with depth, what they do, and which of them are in front.
pub(crate) fn counting(part: Part) -> (wgpu::CompareFunction, wgpu::StencilState, wgpu::FrontFace) {
    use wgpu::CompareFunction::{Equal, Greater, Never};
    use wgpu::StencilOperation::{DecrementWrap, IncrementWrap, Keep};
    // Entering a volume in front of the surface adds one; so does leaving it behind the surface.
    let in_front = [Keep, IncrementWrap, Keep, DecrementWrap];
    let behind = [DecrementWrap, Keep, IncrementWrap, Keep];
    let (as_is, turned) = (wgpu::FrontFace::Ccw, wgpu::FrontFace::Cw);
    let (depth_compare, [front_fail, front_pass, back_fail, back_pass], front_face) = match part {
        Part::Pass => (Greater, in_front, as_is),
        Part::Fail => (Greater, behind, as_is),
        Part::LightCap => (Never, behind, as_is),
        Part::PassTurned => (Greater, in_front, turned),
        Part::FailTurned => (Greater, behind, turned),
    };
    let face =
        |depth_fail_op, pass_op| wgpu::StencilFaceState { compare: Equal, fail_op: Keep, depth_fail_op, pass_op };
    let stencil = wgpu::StencilState {
        front: face(front_fail, front_pass),
        back: face(back_fail, back_pass),
        read_mask: MARK,
        write_mask: COUNT,
    };
    (depth_compare, stencil, front_face)
}

/// How the same faces are counted by `fs_signed` in a float target: what z-fail counts fails the comparison of [`counting`], and so passes its complement.
pub(crate) fn summing(part: Part) -> (wgpu::CompareFunction, wgpu::FrontFace, wgpu::BlendOperation) {
    use wgpu::BlendOperation::{Add, ReverseSubtract};
    use wgpu::CompareFunction::{Always, Greater, LessEqual};
    let (as_is, turned) = (wgpu::FrontFace::Ccw, wgpu::FrontFace::Cw);
    match part {
        Part::Pass => (Greater, as_is, Add),
        Part::Fail => (LessEqual, as_is, ReverseSubtract),
        Part::LightCap => (Always, as_is, ReverseSubtract),
        Part::PassTurned => (Greater, turned, Add),
        Part::FailTurned => (LessEqual, turned, ReverseSubtract),
    }
}

/// What takes the mark away, and the count with it, where there is one.
pub(crate) fn fold_stencil() -> wgpu::StencilState {
    one_sided(wgpu::CompareFunction::NotEqual, wgpu::StencilOperation::Zero, [ALL, ALL])
}

/// What takes the mark away, and the count with it.
pub(crate) fn clear_stencil() -> wgpu::StencilState {
    one_sided(wgpu::CompareFunction::Always, wgpu::StencilOperation::Zero, [ALL, ALL])
}

fn one_sided(
    compare: wgpu::CompareFunction,
    pass_op: wgpu::StencilOperation,
    [read_mask, write_mask]: [u32; 2],
) -> wgpu::StencilState {
    let keep = wgpu::StencilOperation::Keep;
    let face = wgpu::StencilFaceState { compare, fail_op: keep, depth_fail_op: keep, pass_op };
    wgpu::StencilState { front: face, back: face, read_mask, write_mask }
}

pub(crate) fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
    target: &ShadowTarget<'_>,
    kind: &Kind<'_>,
) -> wgpu::RenderPipeline {
    let blend = |operation| wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation,
    };
    let color = |format: wgpu::TextureFormat| wgpu::ColorTargetState {
        format,
        blend: kind.fragment.map(|(_, how)| wgpu::BlendState { color: blend(how), alpha: blend(how) }),
        write_mask: if kind.fragment.is_some() { wgpu::ColorWrites::ALL } else { wgpu::ColorWrites::empty() },
    };
    let targets: Vec<_> = target.color_formats.iter().map(|format| format.map(color)).collect();
    let buffers = [Some(VOLUME_VERTEX_LAYOUT)];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(kind.label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(kind.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: if kind.entry_point == "vs_volume" { &buffers } else { &[] },
        },
        primitive: wgpu::PrimitiveState { front_face: kind.front_face, ..BOTH_SIDES },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: target.depth_stencil_format,
            depth_write_enabled: Some(false),
            depth_compare: Some(kind.depth_compare),
            stencil: kind.stencil.clone(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: target.samples, ..wgpu::MultisampleState::default() },
        fragment: (!targets.is_empty()).then(|| wgpu::FragmentState {
            module,
            entry_point: Some(kind.fragment.map_or("fs_nothing", |(entry_point, _)| entry_point)),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
