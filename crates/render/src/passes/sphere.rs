//! Spheres as they are: rectangles in the picture whose rays meet them.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, DVec4};
use umbrae_core::{Camera, Sphere};
use wgpu::util::DeviceExt as _;

use super::light::{ADD, setting_the_mark, where_unshaded};
use super::surface::nearest;
use super::{BOTH_SIDES, Layouts, uniform_group};
use crate::targets::Output;
use crate::uniforms::LightUniform;
use crate::{Gpu, GpuError, LIT, shaders};

/// Draws spheres in the passes over surfaces, light and marks, each after the triangles.
///
/// - reads: as the pass that it is part of
/// - writes: as that, and depth from the rays
/// - needs: depth of spheres that came from the same shader, which is why there is one for all
#[derive(Debug)]
pub(crate) struct SpherePass {
    surface: wgpu::RenderPipeline,
    light: wgpu::RenderPipeline,
    mark: wgpu::RenderPipeline,
    /// Bound where there is no light; read and not used.
    no_light: wgpu::BindGroup,
    /// What the shader is to do for surfaces and for a light.
    tasks: [u32; 2],
}

/// `Sphere` in `sphere.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Impostor {
    rect: [f32; 4],
    center_radius: [f32; 4],
    color_power: [f32; 4],
    task: u32,
}

impl Impostor {
    const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Uint32],
    };
}

/// The spheres in view, for one camera: once for surfaces and once for lights.
#[derive(Debug)]
pub(crate) struct GpuSpheres {
    impostors: Option<wgpu::Buffer>,
    count: u32,
}

impl SpherePass {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, output: Output, samples: u32) -> Self {
        let module = shaders::sphere(&gpu.device, gpu.caps.shades_samples);
        let made_of = MadeOf { module: &module, layout: &layouts.view_and_light, fragment: "fs_sphere", samples };
        let pipeline = |label, color: Option<Option<wgpu::BlendState>>, depth_stencil| {
            made_of.pipeline(gpu, label, color.map(|blend| (output, blend)), depth_stencil)
        };
        let (tasks, blend) = match output {
            Output::Picture => ([0, 1], Some(ADD)),
            Output::Mask => ([2, 3], None),
        };
        Self {
            surface: pipeline("spheres", Some(None), nearest(gpu)),
            light: pipeline("light on spheres", Some(blend), where_unshaded(gpu)),
            mark: pipeline("mark of spheres", None, setting_the_mark(gpu)),
            no_light: uniform_group(gpu, "no light", &layouts.light, bytemuck::bytes_of(&LightUniform::zeroed())),
            tasks,
        }
    }

    /// What adds a light with a size to pictures; `layout` has the visibility in group 3.
    pub(crate) fn soft(gpu: &Gpu, layout: &wgpu::PipelineLayout, samples: u32) -> wgpu::RenderPipeline {
        let module = shaders::soft_sphere(&gpu.device, samples);
        let made_of = MadeOf { module: &module, layout, fragment: "fs_soft_sphere", samples };
        let nearest =
            wgpu::DepthStencilState { depth_compare: Some(wgpu::CompareFunction::GreaterEqual), ..where_unshaded(gpu) };
        made_of.pipeline(gpu, "soft light on spheres", Some((Output::Picture, Some(ADD))), nearest)
    }

    /// Draws with what [`SpherePass::soft`] made.
    pub(crate) fn draw_soft(
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: &wgpu::RenderPipeline,
        spheres: &GpuSpheres,
        light: &wgpu::BindGroup,
    ) {
        draw(pass, pipeline, spheres, light, 1);
    }

    /// Makes ready what of `spheres` may be in view of `camera`.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when there are more than a buffer of the device can hold.
    pub(crate) fn upload(&self, gpu: &Gpu, spheres: &[Sphere], camera: &Camera) -> Result<GpuSpheres, GpuError> {
        let seen: Vec<Impostor> = spheres.iter().filter_map(|sphere| impostor(sphere, camera)).collect();
        let with_task = |task: u32| seen.iter().map(move |impostor| Impostor { task, ..*impostor });
        let impostors: Vec<Impostor> = self.tasks.into_iter().flat_map(with_task).collect();
        gpu.ensure_buffer_fits(size_of_val(impostors.as_slice()))?;
        let buffer = || {
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("spheres"),
                contents: bytemuck::cast_slice(&impostors),
                usage: wgpu::BufferUsages::VERTEX,
            })
        };
        Ok(GpuSpheres { impostors: (!impostors.is_empty()).then(buffer), count: seen.len() as u32 })
    }

    pub(crate) fn draw_surface(&self, pass: &mut wgpu::RenderPass<'_>, spheres: &GpuSpheres) {
        draw(pass, &self.surface, spheres, &self.no_light, 0);
    }

    /// Adds the light where the stencil is [`LIT`].
    pub(crate) fn draw_light(&self, pass: &mut wgpu::RenderPass<'_>, spheres: &GpuSpheres, light: &wgpu::BindGroup) {
        draw(pass, &self.light, spheres, light, 1);
    }

    /// Sets the stencil to [`LIT`] on what the light would brighten if nothing shaded it.
    pub(crate) fn draw_mark(&self, pass: &mut wgpu::RenderPass<'_>, spheres: &GpuSpheres, light: &wgpu::BindGroup) {
        draw(pass, &self.mark, spheres, light, 1);
    }
}

/// In what pipelines over spheres differ.
struct MadeOf<'a> {
    module: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
    fragment: &'a str,
    samples: u32,
}

impl MadeOf<'_> {
    fn pipeline(
        &self,
        gpu: &Gpu,
        label: &str,
        color: Option<(Output, Option<wgpu::BlendState>)>,
        depth_stencil: wgpu::DepthStencilState,
    ) -> wgpu::RenderPipeline {
        let color = color.map(|(output, blend)| {
            Some(wgpu::ColorTargetState { format: output.format(), blend, write_mask: wgpu::ColorWrites::ALL })
        });
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some("vs_sphere"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(Impostor::LAYOUT)],
            },
            primitive: BOTH_SIDES,
            depth_stencil: Some(depth_stencil),
            multisample: wgpu::MultisampleState { count: self.samples, ..wgpu::MultisampleState::default() },
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(self.fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: color.as_slice(),
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn draw(
    pass: &mut wgpu::RenderPass<'_>,
    pipeline: &wgpu::RenderPipeline,
    spheres: &GpuSpheres,
    light: &wgpu::BindGroup,
    task: u32,
) {
    let Some(impostors) = &spheres.impostors else { return };
    pass.set_pipeline(pipeline);
    pass.set_bind_group(1, light, &[]);
    pass.set_vertex_buffer(0, impostors.slice(..));
    pass.set_stencil_reference(LIT);
    pass.draw(0..6, task * spheres.count..(task + 1) * spheres.count);
}

/// `None` for a sphere that is out of view. Its place is rounded as for its volume; from the eye it is exact to `f32`.
fn impostor(sphere: &Sphere, camera: &Camera) -> Option<Impostor> {
    let center = sphere.center.as_vec3().as_dvec3() - camera.eye();
    let radius = f64::from(sphere.radius as f32);
    let [left, right, bottom, top] = rect(center, radius, camera)?;
    let power = center.length_squared() - radius * radius;
    Some(Impostor {
        rect: DVec4::new(left, bottom, right, top).as_vec4().to_array(),
        center_radius: center.extend(radius).as_vec4().to_array(),
        color_power: sphere.base_color.extend(power as f32).to_array(),
        task: 0,
    })
}

/// Left, right, bottom and top of the sphere in the picture, each -1 to 1, with a pixel to spare.
fn rect(center_from_eye: DVec3, radius: f64, camera: &Camera) -> Option<[f64; 4]> {
    let [right, up, forward] = camera.axes();
    let half = camera.half_extent();
    let [width, height] = camera.size_px().map(f64::from);
    let depth = center_from_eye.dot(forward);
    let interval = |axis: DVec3, half: f64, size_px: f64| {
        let [low, high] = slopes(DVec2::new(center_from_eye.dot(axis), depth), radius)?;
        let spare = 2.0 / size_px;
        let [low, high] = [(low / half - spare).max(-1.0), (high / half + spare).min(1.0)];
        (low < high).then_some([low, high])
    };
    let [left, right] = interval(right, half.x, width)?;
    let [bottom, top] = interval(up, half.y, height)?;
    Some([left, right, bottom, top])
}

/// Between which slopes x / y, for y above 0, rays from the origin meet the circle; `None` if none does.
fn slopes(center: DVec2, radius: f64) -> Option<[f64; 2]> {
    let distance = center.length();
    if distance <= radius {
        return Some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let (middle, spread) = (center.x.atan2(center.y), (radius / distance).asin());
    let right_angle = std::f64::consts::FRAC_PI_2;
    let (low, high) = (middle - spread, middle + spread);
    // Each may reach beyond half a turn, and is then behind.
    if low >= right_angle || high <= -right_angle {
        return None;
    }
    let low = if low <= -right_angle { f64::NEG_INFINITY } else { low.tan() };
    let high = if high >= right_angle { f64::INFINITY } else { high.tan() };
    Some([low, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_straight_ahead_spans_its_tangents_and_one_behind_nothing() {
        let tangent = (0.5_f64).asin().tan();
        let [low, high] = slopes(DVec2::new(0.0, 2.0), 1.0).expect("it is ahead");
        assert!((low + tangent).abs() < 1e-12 && (high - tangent).abs() < 1e-12);
        assert_eq!(slopes(DVec2::new(0.3, -2.0), 1.0), None);
    }

    #[test]
    fn a_ball_beside_the_eye_has_no_end_on_its_side() {
        let [low, high] = slopes(DVec2::new(2.0, 0.1), 1.0).expect("part of it is ahead");
        assert!(low.is_finite() && low > 0.0 && high == f64::INFINITY);
        assert_eq!(slopes(DVec2::new(0.2, 0.1), 1.0), Some([f64::NEG_INFINITY, f64::INFINITY]));
    }
}
