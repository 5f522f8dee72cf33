//! The two passes that find how much of a light is seen.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use umbrae_core::{Caster, Extent, Light, PixelRect};
use web_time::Instant;
use wgpu::util::DeviceExt as _;

use super::SoftTargets;
use super::plan::{Segment, SoftDraw, SoftPlan};
use super::targets::{format, texel_entry, texel_layout};
use crate::passes::{BOTH_SIDES, Layouts, pipeline_layout, uniform_group};
use crate::shadow::casters::VOLUME_VERTEX_LAYOUT;
use crate::shadow::set_scissor;
use crate::timing::PassTimer;
use crate::uniforms::LightUniform;
use crate::{Gpu, GpuError, LightReport, ShadowCasters, ShadowOptions, ShadowView, Targets, shaders};

/// Corners of a side and of a wedge's hull in `soft_coverage.wgsl`.
const SIDE_CORNERS: u32 = 6;
const WEDGE_CORNERS: u32 = 24;

/// `Extent` in `light_face.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ExtentUniform {
    half_right: [f32; 3],
    kind: u32,
    half_up: [f32; 3],
    radius: f32,
}

impl ExtentUniform {
    /// Names and offsets, for the test that holds the twins together.
    #[cfg(test)]
    pub(crate) fn members() -> [(&'static str, usize); 4] {
        use std::mem::offset_of;
        [
            ("half_right", offset_of!(Self, half_right)),
            ("kind", offset_of!(Self, kind)),
            ("half_up", offset_of!(Self, half_up)),
            ("radius", offset_of!(Self, radius)),
        ]
    }

    fn new(extent: Extent) -> Self {
        let of = |kind, half_right: DVec3, half_up: DVec3, radius: f64| Self {
            half_right: half_right.as_vec3().to_array(),
            kind,
            half_up: half_up.as_vec3().to_array(),
            radius: radius as f32,
        };
        match extent {
            Extent::Point => of(1, DVec3::ZERO, DVec3::ZERO, 0.0),
            Extent::Disc { radius_rad } => of(0, DVec3::ZERO, DVec3::ZERO, radius_rad.tan()),
            Extent::Sphere { radius_m } => of(1, DVec3::ZERO, DVec3::ZERO, radius_m),
            Extent::Rectangle { half_right, half_up } => of(2, half_right, half_up, extent.radius_m()),
        }
    }
}

/// Finds, for each sample, the visible share of a light's quarters.
///
/// - reads: depth
/// - writes: coverage and visibility ([`SoftTargets`])
/// - needs: a light with a size, silhouettes from the CPU
#[derive(Debug)]
pub(crate) struct SoftPass {
    layouts: Layouts,
    area_layout: wgpu::BindGroupLayout,
    reset: wgpu::RenderPipeline,
    side: wgpu::RenderPipeline,
    wedge: wgpu::RenderPipeline,
    cap: wgpu::RenderPipeline,
    compared_cap: wgpu::RenderPipeline,
    composite: wgpu::RenderPipeline,
}

/// One light with a size, on the device.
#[derive(Debug)]
pub(crate) struct SoftLight {
    plan: SoftPlan,
    group: wgpu::BindGroup,
    extent: wgpu::Buffer,
    segments: Option<wgpu::Buffer>,
    caps: Option<wgpu::Buffer>,
    pub(crate) report: LightReport,
}

impl SoftLight {
    /// The pixels that the light may change; `None` when there are none, and nothing need be drawn for it.
    pub(crate) fn rect(&self) -> Option<PixelRect> {
        self.plan.rect
    }

    /// The uniform of `light.wgsl`.
    pub(crate) fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// How many passes [`SoftPass::record`] makes.
    pub(crate) fn pass_count(&self) -> u32 {
        1 + 2 * self.plan.groups.len() as u32
    }
}

impl SoftPass {
    /// Compiles the pipelines for `samples` samples a pixel.
    pub(crate) fn new(gpu: &Gpu, samples: u32) -> Self {
        let layouts = Layouts::new(gpu);
        let uniform = wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: std::num::NonZeroU64::new(size_of::<ExtentUniform>() as u64),
            },
            count: None,
        };
        let area_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("light's extent and depth"),
            entries: &[uniform, texel_entry(1, samples)],
        });
        let covering =
            pipeline_layout(gpu, "coverage", &[Some(&layouts.view), Some(&layouts.light), Some(&area_layout)]);
        let over_coverage = pipeline_layout(gpu, "composite", &[Some(&texel_layout(gpu, samples))]);
        let coverage = shaders::soft_coverage(&gpu.device, samples);
        let composite = shaders::soft_composite(&gpu.device, samples);
        let add = blend(wgpu::BlendFactor::One, wgpu::BlendFactor::One);
        let multiply = blend(wgpu::BlendFactor::Dst, wgpu::BlendFactor::Zero);
        let none = wgpu::PipelineLayoutDescriptor { label: Some("reset"), ..Default::default() };
        let none = gpu.device.create_pipeline_layout(&none);
        let make = |kind: &Kind<'_>| kind.pipeline(gpu, samples);
        let adding = |vertex, fragment, buffer, cull_mode| {
            let (module, layout) = (&coverage, &covering);
            make(&Kind { module, layout, vertex, fragment, buffer: Some(buffer), cull_mode, blend: Some(add) })
        };
        let everywhere = |layout, fragment, blend| {
            let (module, vertex) = (&composite, "vs_everywhere");
            make(&Kind { module, layout, vertex, fragment, buffer: None, cull_mode: None, blend })
        };
        Self {
            reset: everywhere(&none, "fs_nothing", None),
            side: adding("vs_side", "fs_coverage", Segment::LAYOUT, None),
            // Hulls have their fronts inside.
            wedge: adding("vs_wedge", "fs_coverage", Segment::LAYOUT, Some(wgpu::Face::Back)),
            cap: adding("vs_cap", "fs_cap", VOLUME_VERTEX_LAYOUT, None),
            compared_cap: adding("vs_compared_cap", "fs_cap", VOLUME_VERTEX_LAYOUT, None),
            composite: everywhere(&over_coverage, "fs_composite", Some(multiply)),
            layouts,
            area_layout,
        }
    }

    /// Plans and uploads what `casters`, uploaded as `uploaded`, draw of `light`.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the segments or caps are more than a buffer of the device can hold.
    pub(crate) fn light(
        &self,
        gpu: &Gpu,
        casters: &[Caster],
        uploaded: &ShadowCasters,
        view: &ShadowView,
        light: &Light,
        options: &ShadowOptions,
    ) -> Result<SoftLight, GpuError> {
        let start = Instant::now();
        let light = light.rounded_to_f32();
        let mut plan = SoftPlan::new(casters, uploaded, &view.seen, &light, options);
        let cpu_ms = start.elapsed().as_secs_f64() * 1e3;
        let report = LightReport {
            casters: std::mem::take(&mut plan.casters),
            spheres: std::mem::take(&mut plan.spheres),
            cpu_ms,
            rect: plan.rect,
            batches: plan.groups.len(),
            index_bytes: 0,
        };
        let vertices = wgpu::BufferUsages::VERTEX;
        let extent = ExtentUniform::new(light.extent);
        Ok(SoftLight {
            group: uniform_group(gpu, "light", &self.layouts.light, bytemuck::bytes_of(&LightUniform::new(&light))),
            extent: gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("light's extent"),
                contents: bytemuck::bytes_of(&extent),
                usage: wgpu::BufferUsages::UNIFORM,
            }),
            segments: gpu.upload("silhouette segments", bytemuck::cast_slice(&plan.segments), vertices)?,
            caps: gpu.upload("caps", bytemuck::cast_slice(&plan.caps), vertices)?,
            plan,
            report,
        })
    }

    /// Records the passes that leave in `to` what is seen of `light` from what the depth of `targets` holds: all of it outside of its rectangle.
    pub(crate) fn record(
        &self,
        gpu: &Gpu,
        (targets, to): (&Targets, &SoftTargets),
        view: &ShadowView,
        (name, light): (&str, &SoftLight),
        encoder: &mut wgpu::CommandEncoder,
        timer: &mut PassTimer,
    ) {
        let area = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("light's extent and depth"),
            layout: &self.area_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: light.extent.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&targets.depth_to_read()),
                },
            ],
        });
        drop(begin(encoder, "visibility", name, &to.visibility, wgpu::LoadOp::Clear(wgpu::Color::WHITE), timer));
        for group in &light.plan.groups {
            let draws = &light.plan.draws[group.clone()];
            let mut pass = begin(encoder, "coverage", name, &to.coverage, wgpu::LoadOp::Load, timer);
            pass.set_bind_group(0, &view.group, &[]);
            pass.set_bind_group(1, &light.group, &[]);
            pass.set_bind_group(2, &area, &[]);
            for draw in draws {
                self.add(&mut pass, draw, light);
            }
            drop(pass);
            let mut pass = begin(encoder, "composite", name, &to.visibility, wgpu::LoadOp::Load, timer);
            pass.set_pipeline(&self.composite);
            pass.set_bind_group(0, &to.coverage_group, &[]);
            for draw in draws {
                set_scissor(&mut pass, draw.rect);
                pass.draw(0..3, 0..1);
            }
        }
    }

    /// Whole numbers first: sums of 16 bits round anything beside large ones.
    fn add(&self, pass: &mut wgpu::RenderPass<'_>, draw: &SoftDraw, light: &SoftLight) {
        set_scissor(pass, draw.rect);
        pass.set_pipeline(&self.reset);
        pass.draw(0..3, 0..1);
        if let Some(caps) = &light.caps {
            pass.set_vertex_buffer(0, caps.slice(..));
            for (pipeline, vertices) in [(&self.cap, &draw.caps), (&self.compared_cap, &draw.compared_caps)] {
                if !vertices.is_empty() {
                    pass.set_pipeline(pipeline);
                    pass.draw(vertices.clone(), 0..1);
                }
            }
        }
        if let Some(segments) = light.segments.as_ref().filter(|_| !draw.segments.is_empty()) {
            pass.set_vertex_buffer(0, segments.slice(..));
            pass.set_pipeline(&self.side);
            pass.draw(0..SIDE_CORNERS, draw.segments.clone());
            pass.set_pipeline(&self.wedge);
            pass.draw(0..WEDGE_CORNERS, draw.segments.clone());
        }
    }
}

fn blend(src_factor: wgpu::BlendFactor, dst_factor: wgpu::BlendFactor) -> wgpu::BlendState {
    let component = wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    wgpu::BlendState { color: component, alpha: component }
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    what: &str,
    name: &str,
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
    timer: &mut PassTimer,
) -> wgpu::RenderPass<'e> {
    let label = format!("{what}: {name}");
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(&label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        timestamp_writes: timer.writes(label.clone()),
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// In what the pipelines of these passes differ.
struct Kind<'a> {
    module: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
    vertex: &'a str,
    fragment: &'a str,
    buffer: Option<wgpu::VertexBufferLayout<'static>>,
    cull_mode: Option<wgpu::Face>,
    blend: Option<wgpu::BlendState>,
}

impl Kind<'_> {
    fn pipeline(&self, gpu: &Gpu, samples: u32) -> wgpu::RenderPipeline {
        let buffers = [self.buffer.clone()];
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.vertex),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(self.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: if self.buffer.is_some() { &buffers } else { &[] },
            },
            primitive: wgpu::PrimitiveState { cull_mode: self.cull_mode, ..BOTH_SIDES },
            depth_stencil: None,
            multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(self.fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: format(gpu, samples),
                    blend: self.blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
