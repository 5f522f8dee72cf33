//! Vertices moved by a function of the user's own, on devices that have no compute shaders.
//!
//! Each vertex is a fragment: where it is now is drawn into the texture from which silhouettes are found and volumes made
//! ([`crate::SilhouetteSource::GpuBasic`]), and from there into another one that has surfaces word for word, which is copied over the buffer
//! that they are drawn from. All have the same bits.
//!
//! Source: S. Brabec and H.-P. Seidel, "Shadow volumes on programmable graphics hardware", 2003, sections 4.1 and 5: they have the position texture, and
//! wish for a copy from the frame buffer to vertices.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use umbrae_core::{Caster, Scene};
use wgpu::util::DeviceExt as _;

use crate::displacement::widened;
use crate::shadow::found::basic::{Displaced, Table, TablePass, position_entries, position_ranges};
use crate::timing::PassTimer;
use crate::{Displacement, Gpu, GpuError, GpuScene, shaders};

/// `Displacing` in `displace.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DisplacingUniform {
    pub(crate) time_s: f32,
    pub(crate) max_offset: f32,
    pub(crate) triangle_count: u32,
    pub(crate) unused: u32,
}

/// Texels in a row of surfaces: as many as fit into 2048, where a row has as many bytes as copies to buffers want, a multiple of 256, and ends with a
/// vertex. `displace.wgsl` has it too.
const SURFACE_WIDTH: u32 = 2016;
const TEXEL_BYTES: u32 = 16;

/// Moves the vertices of a scene in which nothing else moves.
///
/// - reads: positions at rest
/// - writes: positions and surfaces
/// - needs: nothing beyond WebGL2
#[derive(Debug)]
pub struct TextureDisplacer {
    uniform_data: DisplacingUniform,
    uniform: wgpu::Buffer,
    positions: TablePass,
    surfaces: TablePass,
    of_positions: wgpu::BindGroup,
    of_surfaces: wgpu::BindGroup,
    surface_words: wgpu::Texture,
    surface_words_view: wgpu::TextureView,
}

impl TextureDisplacer {
    /// For the objects of `scene`, of which `casters` and `drawn` were made; each of them can be displaced once. Boxes of casters that are
    /// displaced are widened; their positions stay at rest.
    ///
    /// Takes 16 bytes for each vertex, twice, and 124 for each triangle; at most 4 million vertices and 600,000 triangles where textures have 2048
    /// texels a side.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`], and [`GpuError::Shader`] when the function is no good.
    pub async fn new(
        gpu: &Gpu,
        scene: &Scene,
        casters: &mut [Caster],
        drawn: &GpuScene,
        displacement: &Displacement<'_>,
    ) -> Result<Self, GpuError> {
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let displacer = Self::with(gpu, scene, casters, drawn, displacement);
        if let Some(error) = scope.pop().await {
            return Err(GpuError::Shader { reason: error.to_string() });
        }
        let displacer = displacer?;
        for &i in displacement.objects {
            casters[i].bounds = widened(casters[i].bounds, &scene.objects[i], displacement.max_offset_m);
        }
        Ok(displacer)
    }

    fn with(
        gpu: &Gpu,
        scene: &Scene,
        casters: &[Caster],
        drawn: &GpuScene,
        displacement: &Displacement<'_>,
    ) -> Result<Self, GpuError> {
        let is_displaced = |i: usize| displacement.objects.contains(&i);
        let rest = Table::of(gpu, "positions at rest", &position_entries(casters, is_displaced))?;
        let shown = Table::new(gpu, "positions shown", rest.len())?;
        let displaced = Displaced { positions: shown, casters: (0..casters.len()).map(is_displaced).collect() };
        let shown = &drawn.shadow_casters.displace(|| displaced).positions;

        let ranges = position_ranges(casters);
        let mut triangles = Vec::new();
        drawn.order.for_each_triangle(casters, |c, t, place| {
            let [a, b, c_] = casters[c].mesh.triangles()[t].map(|i| ranges[c].start + i);
            triangles.resize(triangles.len().max(place as usize + 1), [0; 4]);
            triangles[place as usize] = [a, b, c_, u32::from(is_displaced(c))];
        });
        let uniform_data = DisplacingUniform {
            time_s: 0.0,
            max_offset: displacement.max_offset_m as f32,
            triangle_count: triangles.len() as u32,
            unused: 0,
        };
        let triangles = Table::of(gpu, "triangles of surfaces", &triangles)?;
        let words = drawn.surface_words(casters, &scene.materials);
        let surfaces_at_rest = words_texture(gpu, "surfaces at rest", &words)?;
        let surface_words = words_texture(gpu, "surfaces shown", &words)?;

        let uniform = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("displacing"),
            contents: bytemuck::bytes_of(&uniform_data),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        let module = shaders::displace(&gpu.device, displacement.wgsl);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let positions = TablePass::new(gpu, &module, "fs_positions", &[0], &[1]);
        let of_positions = positions.group(gpu, &[(0, &uniform)], &[(1, &rest.view)]);
        let surfaces = TablePass::new(gpu, &module, "fs_surfaces", &[0], &[2, 3, 4]);
        let read = [(2, &shown.view), (3, &triangles.view), (4, &view(&surfaces_at_rest))];
        let of_surfaces = surfaces.group(gpu, &[(0, &uniform)], &read);
        let surface_words_view = view(&surface_words);
        Ok(Self {
            uniform_data,
            uniform,
            positions,
            surfaces,
            of_positions,
            of_surfaces,
            surface_words,
            surface_words_view,
        })
    }

    /// Submits the moving of `drawn`, for which this was made, to where the function has it at `time_s`.
    ///
    /// # Panics
    ///
    /// If this was made for another scene.
    pub fn show(&mut self, gpu: &Gpu, drawn: &GpuScene, time_s: f32) {
        self.uniform_data.time_s = time_s;
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.uniform_data));
        let shown = drawn.shadow_casters.displaced().expect("the scene was displaced");
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("displacing") });
        let mut timer = PassTimer::off();
        self.positions.draw(&mut encoder, &shown.positions.view, &self.of_positions, ("positions", &mut timer));
        self.surfaces.draw(&mut encoder, &self.surface_words_view, &self.of_surfaces, ("surfaces", &mut timer));
        self.copy_surfaces(&mut encoder, drawn);
        gpu.queue.submit([encoder.finish()]);
    }

    /// Whole rows, then what is in the last one.
    fn copy_surfaces(&self, encoder: &mut wgpu::CommandEncoder, drawn: &GpuScene) {
        let texels = (drawn.surface.size() / u64::from(TEXEL_BYTES)) as u32;
        let (rows, rest) = (texels / SURFACE_WIDTH, texels % SURFACE_WIDTH);
        for (y, width, height) in [(0, SURFACE_WIDTH, rows), (rows, rest, 1)] {
            if width == 0 || height == 0 {
                continue;
            }
            let from = wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y, z: 0 },
                ..self.surface_words.as_image_copy()
            };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: u64::from(y * SURFACE_WIDTH) * u64::from(TEXEL_BYTES),
                bytes_per_row: Some(SURFACE_WIDTH * TEXEL_BYTES),
                rows_per_image: None,
            };
            let to = wgpu::TexelCopyBufferInfo { buffer: &drawn.surface, layout };
            encoder.copy_texture_to_buffer(from, to, wgpu::Extent3d { width, height, depth_or_array_layers: 1 });
        }
    }

    /// Where the vertices of `casters` are now, object by object: for whoever must know, as a test must. Waits for the GPU.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// As [`TextureDisplacer::show`].
    pub async fn positions(&self, gpu: &Gpu, casters: &[Caster], drawn: &GpuScene) -> Result<Vec<Vec<Vec3>>, GpuError> {
        let shown = drawn.shadow_casters.displaced().expect("the scene was displaced");
        let bytes = gpu.read(&shown.positions.texture).await?;
        let entries: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let position = |&[x, y, z, _]: &[f32; 4]| Vec3::new(x, y, z);
        let ranges = position_ranges(casters).into_iter();
        Ok(ranges.map(|r| entries[r.start as usize..r.end as usize].iter().map(position).collect()).collect())
    }
}

/// A texture in which `words` are, row by row.
fn words_texture(gpu: &Gpu, label: &str, words: &[u32]) -> Result<wgpu::Texture, GpuError> {
    let row_words = (SURFACE_WIDTH * TEXEL_BYTES / 4) as usize;
    let rows = words.len().div_ceil(row_words).max(1);
    let allowed = gpu.device.limits().max_texture_dimension_2d;
    let row_bytes = u64::from(SURFACE_WIDTH * TEXEL_BYTES);
    if rows as u64 > u64::from(allowed) {
        let (needed_bytes, allowed_bytes) = (rows as u64 * row_bytes, u64::from(allowed) * row_bytes);
        return Err(GpuError::TooLarge { adapter: gpu.label.clone(), needed_bytes, allowed_bytes });
    }
    let mut padded = words.to_vec();
    padded.resize(rows * row_words, 0);
    let descriptor = wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: SURFACE_WIDTH, height: rows as u32, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: Table::FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    Ok(gpu.device.create_texture_with_data(&gpu.queue, &descriptor, order, bytemuck::cast_slice(&padded)))
}
