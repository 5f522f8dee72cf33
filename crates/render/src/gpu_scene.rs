//! The geometry of a scene on the GPU.

use std::ops::Range;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use rustc_hash::FxHashMap;
use umbrae_core::{Caster, Finder, Material, Role, SmoothBody, Texture};
use wgpu::util::DeviceExt as _;

use crate::gpu_finishes::{Finish, FinishKind, Finishes};
use crate::prepared::KeptFinder;
use crate::{Gpu, GpuError, ShadowCasters};

/// `Vertex` in `surface.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SurfaceVertex {
    position_world: [f32; 3],
    normal_world: [f32; 3],
    /// And [`FLAT`] or [`SMOOTH`].
    color_srgb: [u8; 4],
    uv: [f32; 2],
}

impl SurfaceVertex {
    pub(crate) const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32x2],
    };
}

/// The fourth byte of a vertex's colour where its triangle is shaded with its own normal.
const FLAT: u8 = 255;
/// The same where it is shaded with the normals of its corners, in [`GpuScene::shading_normals`].
const SMOOTH: u8 = 0;

/// A vertex's normal in [`GpuScene::shading_normals`].
pub(crate) const SHADING_NORMAL_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vec3>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![4 => Float32x3],
};

/// A scene on the device: its surfaces, all casters in one buffer by finish, and its volumes.
#[derive(Debug)]
pub struct GpuScene {
    pub(crate) surface: wgpu::Buffer,
    /// One for each vertex of `surface`; `None` where all is flat.
    shading_normals: Option<wgpu::Buffer>,
    /// Vertices that are drawn with one finish, and its number; without glass, kind by kind.
    pub(crate) draws: Vec<(Range<u32>, u32)>,
    pub(crate) finishes: Vec<Finish>,
    pub(crate) glass: Vec<GlassTriangle>,
    pub(crate) shadow_casters: ShadowCasters,
    pub(crate) order: SurfaceOrder,
    pub(crate) finder: KeptFinder,
}

/// A triangle that is drawn last, in its place from back to front.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GlassTriangle {
    pub(crate) center: Vec3,
    /// Of three in [`GpuScene::surface`].
    pub(crate) first_vertex: u32,
    /// Its number in [`GpuScene::finishes`].
    pub(crate) finish: u32,
}

impl GpuScene {
    /// Uploads `casters`, which name `materials`, which name `textures`. About 108 bytes a triangle and 32 a vertex, and 5.3 a texel; 36 more a
    /// triangle if any caster has [normals to be shaded with](Caster::shading_normals).
    ///
    /// A caster's role says whether it is glass, and whether its materials' cut-outs are (see [`umbrae_core::Scene::assign_roles`]): it is drawn as
    /// it casts. A texture with more texels a side than the device has is drawn as a smaller copy.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when a buffer would be larger than the device allows, [`GpuError::OutOfMemory`].
    pub fn new(
        gpu: &Gpu,
        casters: &[Caster],
        materials: &[Material],
        textures: &[Arc<Texture>],
    ) -> Result<Self, GpuError> {
        let triangles: usize = casters.iter().map(|c| c.mesh.triangles().len()).sum();
        gpu.ensure_buffer_fits(triangles * 3 * size_of::<SurfaceVertex>())?;
        let shadow_casters = ShadowCasters::new(gpu, casters)?;

        let mut finishes = Finishes::new(gpu, textures);
        let by_role = finishes_by_role(casters, materials, &mut finishes);
        let finishes = finishes.finish();
        let order = SurfaceOrder { by_role, finish_count: finishes.len() };
        let (surface, triangle_ranges) = surface_vertices(casters, materials, &order);
        let mut draws: Vec<(Range<u32>, u32)> = Vec::new();
        let mut glass = Vec::new();
        for (triangles, finish) in triangle_ranges.into_iter().zip(0..) {
            if finishes[finish as usize].kind == FinishKind::Glass {
                glass.extend(triangles.map(|t| glass_triangle(&surface, t, finish)));
            } else if !triangles.is_empty() {
                draws.push((triangles.start * 3..triangles.end * 3, finish));
            }
        }
        draws.sort_by_key(|(_, finish)| finishes[*finish as usize].kind);
        // Textures are copied over it by texels of 16 bytes.
        let mut words: Vec<u32> = bytemuck::cast_slice(&surface).to_vec();
        words.resize(words.len().next_multiple_of(4), 0);
        let surface = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("surface vertices"),
            contents: bytemuck::cast_slice(&words),
            usage: gpu.caps.moving_vertices(),
        });
        let shading_normals = shading_normals(casters, &order).map(|normals| upload_shading_normals(gpu, &normals));
        gpu.unless_out_of_memory(Ok(Self {
            surface,
            shading_normals,
            draws,
            finishes,
            glass,
            shadow_casters,
            order,
            finder: KeptFinder::default(),
        }))
    }

    /// Has the silhouettes of caster `i` found by `finders[i]`, made for it as it is (read from a cache, say), where there is one.
    ///
    /// # Panics
    ///
    /// If there are more finders than casters.
    pub fn give_finders(&mut self, finders: Vec<Option<Finder>>) {
        for (i, finder) in finders.into_iter().enumerate() {
            if let Some(finder) = finder {
                self.shadow_casters.give_finder(i, finder);
            }
        }
    }

    /// Has caster `i` cast the shadow of `bodies[i]`, made of it as it is, where there is one and [`crate::ShadowOptions::smooth`] asks for that.
    ///
    /// # Panics
    ///
    /// If there are more bodies than casters.
    pub fn give_bodies(&mut self, bodies: Vec<Option<SmoothBody>>) {
        for (i, body) in bodies.into_iter().enumerate() {
            if let Some(body) = body {
                self.shadow_casters.give_body(i, body);
            }
        }
    }

    /// The smooth body that caster `i` was given and stands for where it is now.
    pub fn body(&self, i: usize) -> Option<&SmoothBody> {
        self.shadow_casters.body(i)
    }

    /// Moves the bodies of those of `casters` that have moved to where they are: [`ShadowCasters::pose_bodies`].
    pub fn pose_bodies(&mut self, casters: &[Caster]) {
        self.shadow_casters.pose_bodies(casters);
    }

    /// What is in [`GpuScene::surface`] for `casters` and `materials`, of which this was made.
    pub(crate) fn surface_words(&self, casters: &[Caster], materials: &[Material]) -> Vec<u32> {
        bytemuck::cast_slice(&surface_vertices(casters, materials, &self.order).0).to_vec()
    }

    /// Has `pass` read the vertices of surfaces.
    pub(crate) fn set_vertices(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.surface.slice(..));
        // Where all is flat nobody looks at what is read there, and any buffer will do that is long enough.
        pass.set_vertex_buffer(1, self.shading_normals.as_ref().unwrap_or(&self.surface).slice(..));
    }

    /// Uploads again where `casters` are, and the normals that they are shaded with; they must be those that this was made of, moved, and `materials` the same. As much as
    /// [`GpuScene::new`] uploads, but for textures.
    pub fn update(&mut self, gpu: &Gpu, casters: &[Caster], materials: &[Material]) {
        let (surface, _) = surface_vertices(casters, materials, &self.order);
        for glass in &mut self.glass {
            *glass = glass_triangle(&surface, glass.first_vertex / 3, glass.finish);
        }
        gpu.queue.write_buffer(&self.surface, 0, bytemuck::cast_slice(&surface));
        if let Some(normals) = shading_normals(casters, &self.order) {
            match &self.shading_normals {
                Some(buffer) => gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&normals)),
                None => self.shading_normals = Some(upload_shading_normals(gpu, &normals)),
            }
        }
        self.shadow_casters.update(gpu, casters);
    }
}

/// For each role, the finish of each material.
fn finishes_by_role(
    casters: &[Caster],
    materials: &[Material],
    finishes: &mut Finishes<'_>,
) -> FxHashMap<Role, Vec<u32>> {
    let mut by_role = FxHashMap::default();
    for caster in casters {
        let of_materials = |_: &Role| materials.iter().map(|material| finishes.number(material, caster.role)).collect();
        by_role.entry(caster.role).or_insert_with_key(of_materials);
    }
    by_role
}

/// Where the triangles of casters are among [`GpuScene::surface`]'s: those of each finish together, else in the order of casters.
#[derive(Debug)]
pub(crate) struct SurfaceOrder {
    /// For each role, the finish of each material.
    by_role: FxHashMap<Role, Vec<u32>>,
    finish_count: usize,
}

impl SurfaceOrder {
    /// A triangle whose material does not exist is plain, white glass or not.
    fn finish_of(&self, caster: &Caster, material: u32) -> usize {
        let finishes = self.by_role.get(&caster.role);
        finishes.and_then(|finishes| finishes.get(material as usize)).copied().unwrap_or(0) as usize
    }

    /// Calls `visit` for each triangle, in order, with its caster, its number in that, and its place. Returns the places of each finish.
    pub(crate) fn for_each_triangle(
        &self,
        casters: &[Caster],
        mut visit: impl FnMut(usize, usize, u32),
    ) -> Vec<Range<u32>> {
        let mut counts = vec![0; self.finish_count];
        for caster in casters {
            for &material in caster.mesh.triangle_materials() {
                counts[self.finish_of(caster, material)] += 1;
            }
        }
        let mut end = 0;
        let starts = counts.iter().map(|count| {
            let start = end;
            end += count;
            start
        });
        let mut ranges: Vec<Range<u32>> = starts.map(|start| start..start).collect();
        for (c, caster) in casters.iter().enumerate() {
            for (t, &material) in caster.mesh.triangle_materials().iter().enumerate() {
                let range = &mut ranges[self.finish_of(caster, material)];
                visit(c, t, range.end);
                range.end += 1;
            }
        }
        ranges
    }
}

/// The vertices of all triangles, and for each finish which triangles are its.
fn surface_vertices(
    casters: &[Caster],
    materials: &[Material],
    order: &SurfaceOrder,
) -> (Vec<SurfaceVertex>, Vec<Range<u32>>) {
    let plain: Vec<[u8; 3]> = materials.iter().map(|m| srgb_from_linear(m.base_color)).collect();
    let triangles: usize = casters.iter().map(|caster| caster.mesh.triangles().len()).sum();
    let mut vertices = vec![SurfaceVertex::zeroed(); triangles * 3];
    let ranges = order.for_each_triangle(casters, |c, t, place| {
        let corners = corner_vertices(&casters[c], t, materials, &plain);
        vertices[place as usize * 3..][..3].copy_from_slice(&corners);
    });
    (vertices, ranges)
}

/// For each vertex of [`surface_vertices`] the normal with which it is shaded, anything where its triangle is flat; `None` if all are.
fn shading_normals(casters: &[Caster], order: &SurfaceOrder) -> Option<Vec<[Vec3; 3]>> {
    if casters.iter().all(|caster| caster.shading_normals.is_empty()) {
        return None;
    }
    let triangles = casters.iter().map(|caster| caster.mesh.triangles().len()).sum();
    let mut normals = vec![[Vec3::ZERO; 3]; triangles];
    order.for_each_triangle(casters, |c, t, place| {
        normals[place as usize] = casters[c].shading_normals_of(t).unwrap_or_default();
    });
    Some(normals)
}

fn upload_shading_normals(gpu: &Gpu, normals: &[[Vec3; 3]]) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("shading normals"),
        contents: bytemuck::cast_slice(normals),
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
    })
}

/// `plain` has each material's colour as a vertex without one of its own has it.
fn corner_vertices(caster: &Caster, t: usize, materials: &[Material], plain: &[[u8; 3]]) -> [SurfaceVertex; 3] {
    let mesh = &caster.mesh;
    let material = mesh.triangle_materials()[t] as usize;
    let corners = caster.corners(t);
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let normal_world = (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array();
    let colors = match mesh.corner_colors().get(t) {
        None => [plain.get(material).copied().unwrap_or([255; 3]); 3],
        Some(colors) => {
            let base = materials.get(material).map_or(Vec3::ONE, |m| m.base_color);
            colors.map(|color| srgb_from_linear(base * color))
        }
    };
    let uvs = mesh.corner_uvs().get(t).copied().unwrap_or([Vec2::ZERO; 3]);
    let flatness = if caster.shading_normals_of(t).is_some() { SMOOTH } else { FLAT };
    std::array::from_fn(|i| SurfaceVertex {
        position_world: corners[i].to_array(),
        normal_world,
        color_srgb: [colors[i][0], colors[i][1], colors[i][2], flatness],
        uv: uvs[i].to_array(),
    })
}

fn glass_triangle(vertices: &[SurfaceVertex], triangle: u32, finish: u32) -> GlassTriangle {
    let first_vertex = triangle * 3;
    let corner = |i: u32| Vec3::from(vertices[(first_vertex + i) as usize].position_world);
    GlassTriangle { center: middle([0, 1, 2].map(corner)), first_vertex, finish }
}

/// Of a triangle.
pub(crate) fn middle(corners: [Vec3; 3]) -> Vec3 {
    corners.iter().map(|corner| corner / 3.0).sum()
}

fn srgb_from_linear(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(srgb_byte)
}

/// The sRGB encoding of a linear value; what is outside of 0 to 1 becomes the nearest of these.
pub(crate) fn srgb_byte(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}
