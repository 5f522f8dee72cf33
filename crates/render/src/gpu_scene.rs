//! The geometry of a scene on the GPU.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use umbrae_core::{Caster, Material};
use wgpu::util::DeviceExt as _;

use crate::{Gpu, GpuError, ShadowCasters};

/// `Vertex` in `surface.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SurfaceVertex {
    position_world: [f32; 3],
    normal_world: [f32; 3],
    color_srgb: [u8; 4],
}

impl SurfaceVertex {
    pub(crate) const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4],
    };
}

/// A scene on the device: its surfaces, all casters in one buffer, and its volumes.
#[derive(Debug)]
pub struct GpuScene {
    pub(crate) surface: wgpu::Buffer,
    pub(crate) surface_vertices: u32,
    pub(crate) shadow_casters: ShadowCasters,
}

impl GpuScene {
    /// Uploads `casters`, which name `materials`. About 84 bytes a triangle and 32 a vertex.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when a buffer would be larger than the device allows, [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu, casters: &[Caster], materials: &[Material]) -> Result<Self, GpuError> {
        let triangles: usize = casters.iter().map(|c| c.mesh.triangles().len()).sum();
        gpu.ensure_buffer_fits(triangles * 3 * size_of::<SurfaceVertex>())?;
        let shadow_casters = ShadowCasters::new(gpu, casters)?;

        let mut surface = Vec::with_capacity(triangles * 3);
        let plain: Vec<[u8; 4]> = materials.iter().map(|m| srgb_from_linear(m.base_color)).collect();
        for caster in casters {
            push_surface(caster, materials, &plain, &mut surface);
        }
        let buffer = |label, contents| {
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage: wgpu::BufferUsages::VERTEX,
            })
        };
        gpu.unless_out_of_memory(Ok(Self {
            surface_vertices: surface.len() as u32,
            surface: buffer("surface vertices", bytemuck::cast_slice(&surface)),
            shadow_casters,
        }))
    }
}

/// `plain` has each material's colour as a vertex without one of its own has it.
fn push_surface(caster: &Caster, materials: &[Material], plain: &[[u8; 4]], vertices: &mut Vec<SurfaceVertex>) {
    let mesh = &caster.mesh;
    for (t, &material) in mesh.triangle_materials().iter().enumerate() {
        let material = material as usize;
        let corners = caster.corners(t);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let normal_world = (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array();
        let colors = match mesh.corner_colors().get(t) {
            None => [plain.get(material).copied().unwrap_or([255; 4]); 3],
            Some(colors) => {
                let base = materials.get(material).map_or(Vec3::ONE, |m| m.base_color);
                colors.map(|color| srgb_from_linear(base * color))
            }
        };
        for (position, color_srgb) in corners.into_iter().zip(colors) {
            vertices.push(SurfaceVertex { position_world: position.to_array(), normal_world, color_srgb });
        }
    }
}

fn srgb_from_linear(linear: Vec3) -> [u8; 4] {
    let encode = |c: f32| {
        let c = c.clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    };
    [encode(linear.x), encode(linear.y), encode(linear.z), 255]
}
