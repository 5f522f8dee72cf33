//! The two passes that find silhouettes, for up to 64 lights at once.

use bytemuck::{Pod, Zeroable};
use umbrae_core::{Camera, LightPosition};
use wgpu::util::DeviceExt as _;

use super::tables::{Entry, Table, Tables};
use crate::passes::pipeline_layout;
use crate::timing::PassTimer;
use crate::{Gpu, GpuError, shaders};

/// Two bits each in a texel of 128.
pub(super) const MOST_LIGHTS: usize = 64;

/// `FoundLights` in `found_basic.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FoundLightsUniform {
    positions_world: [[f32; 4]; MOST_LIGHTS],
    count: u32,
    triangle_count: u32,
    edge_count: u32,
    lane_bits: u32,
}

/// `FoundLanes` in `found_basic.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FoundLanesUniform {
    first_light: u32,
    unused_a: u32,
    unused_b: u32,
    unused_c: u32,
}

/// Finds silhouettes.
///
/// - reads: the tables of casters; where the lights are
/// - writes: a coefficient for each triangle and light, then a multiplicity for each edge and light
/// - needs: nothing beyond WebGL2
#[derive(Debug)]
pub(super) struct Finder {
    of_triangles: wgpu::BindGroupLayout,
    of_edges: wgpu::BindGroupLayout,
    coefficients: wgpu::RenderPipeline,
    multiplicities: wgpu::RenderPipeline,
}

/// What was found for up to [`MOST_LIGHTS`] lights.
#[derive(Debug)]
pub(super) struct Found {
    /// For each light and caster, whether all solid components have only triangles counted that face the light.
    pub(super) facing: Vec<Vec<bool>>,
    /// Two bits a light.
    pub(super) coefficients: Table,
    /// [`Found::lanes`] lights each.
    pub(super) multiplicities: Vec<Table>,
    /// How many lights a texel of multiplicities has room for.
    lanes: usize,
}

impl Found {
    /// The table with the multiplicities of light `i`, and the light's lane in it.
    pub(super) fn multiplicities_of(&self, i: usize) -> (&Table, usize) {
        (&self.multiplicities[i / self.lanes], i % self.lanes)
    }
}

impl Finder {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let of_triangles = layout(gpu, "silhouettes, triangles", &[0], &[2, 3, 4]);
        let of_edges = layout(gpu, "silhouettes, edges", &[0, 1], &[5, 6, 7]);
        let module = shaders::found_basic(&gpu.device);
        let pipeline = |label, layout, entry_point| {
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&pipeline_layout(gpu, label, &[Some(layout)])),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vs_table"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entry_point),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(Table::FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            coefficients: pipeline("coefficients", &of_triangles, "fs_coefficients"),
            multiplicities: pipeline("multiplicities", &of_edges, "fs_multiplicities"),
            of_triangles,
            of_edges,
        }
    }

    /// Records the passes for `lights`, at most [`MOST_LIGHTS`], rounded as shaders see them.
    ///
    /// Two passes for 32 lights where no edge has more than seven triangles; one more for each 32, 16, 8 or 4 lights that are left, fewer with more
    /// triangles on an edge.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] as for [`Table::new`].
    pub(super) fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        tables: &Tables,
        (camera, lights): (&Camera, &[LightPosition]),
        timer: &mut PassTimer,
    ) -> Result<Found, GpuError> {
        let lanes = 8 * size_of::<Entry>() / tables.lane_bits as usize;
        let found = Found {
            facing: classify(gpu, tables, camera, lights),
            coefficients: Table::new(gpu, "coefficients", tables.triangle_count as usize)?,
            multiplicities: (0..lights.len().div_ceil(lanes))
                .map(|_| Table::new(gpu, "multiplicities", tables.edge_count as usize))
                .collect::<Result<_, _>>()?,
            lanes,
        };
        let mut uniform = FoundLightsUniform {
            count: lights.len() as u32,
            triangle_count: tables.triangle_count,
            edge_count: tables.edge_count,
            lane_bits: tables.lane_bits,
            ..Zeroable::zeroed()
        };
        for (to, light) in uniform.positions_world.iter_mut().zip(lights) {
            *to = light.homogeneous().as_vec4().to_array();
        }
        let uniform = uniform_buffer(gpu, "lights of silhouettes", bytemuck::bytes_of(&uniform));
        let group = bind(
            gpu,
            &self.of_triangles,
            &[(0, &uniform)],
            &[(2, &tables.triangles), (3, &tables.components), (4, &tables.positions)],
        );
        fill(encoder, &found.coefficients, &self.coefficients, &group, ("coefficients", timer));
        for (first_light, to) in (0..).step_by(lanes).zip(&found.multiplicities) {
            let range = FoundLanesUniform { first_light, ..Zeroable::zeroed() };
            let range = uniform_buffer(gpu, "lights of multiplicities", bytemuck::bytes_of(&range));
            let group = bind(
                gpu,
                &self.of_edges,
                &[(0, &uniform), (1, &range)],
                &[(5, &tables.edges), (6, &tables.incidences), (7, &found.coefficients)],
            );
            fill(encoder, to, &self.multiplicities, &group, ("multiplicities", timer));
        }
        Ok(found)
    }
}

/// Uploads for each component the lights from which all of its triangles count, and returns [`Found::facing`].
fn classify(gpu: &Gpu, tables: &Tables, camera: &Camera, lights: &[LightPosition]) -> Vec<Vec<bool>> {
    let is_every = |i: usize, light: &LightPosition| tables.component_boxes[i].is_every(camera, *light);
    let entries: Vec<Entry> = (0..tables.component_boxes.len())
        .map(|i| {
            let bits =
                lights.iter().enumerate().fold(0_u64, |bits, (l, light)| bits | u64::from(is_every(i, light)) << l);
            let reach = tables.component_boxes[i].reach() as f32;
            [bits as u32, (bits >> 32) as u32, reach.to_bits(), 0]
        })
        .collect();
    tables.components.write(gpu, &entries);
    let counts_every = |entry: &Entry, l: usize| (entry[l / 32] >> (l % 32)) & 1 == 1;
    (0..lights.len())
        .map(|l| {
            let of_caster = |components: &std::ops::Range<usize>| {
                let solid = components.clone().filter(|&i| tables.component_boxes[i].is_solid);
                !solid.into_iter().any(|i| counts_every(&entries[i], l))
            };
            tables.casters.iter().map(|caster| of_caster(&caster.components)).collect()
        })
        .collect()
}

/// Runs a fragment for each entry of `to`.
fn fill(
    encoder: &mut wgpu::CommandEncoder,
    to: &Table,
    pipeline: &wgpu::RenderPipeline,
    group: &wgpu::BindGroup,
    (label, timer): (&str, &mut PassTimer),
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &to.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        })],
        timestamp_writes: timer.writes(label.to_owned()),
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.draw(0..3, 0..1);
}

fn layout(gpu: &Gpu, label: &str, uniforms: &[u32], tables: &[u32]) -> wgpu::BindGroupLayout {
    let uniform = |binding: &u32| {
        let ty = wgpu::BufferBindingType::Uniform;
        let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        wgpu::BindGroupLayoutEntry { binding: *binding, visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None }
    };
    let table = |binding: &u32| table_entry(*binding, wgpu::ShaderStages::FRAGMENT);
    let entries: Vec<_> = uniforms.iter().map(uniform).chain(tables.iter().map(table)).collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A table that shaders read.
pub(super) fn table_entry(binding: u32, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Uint,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

/// A group of buffers and tables, by binding.
pub(super) fn bind(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    uniforms: &[(u32, &wgpu::Buffer)],
    tables: &[(u32, &Table)],
) -> wgpu::BindGroup {
    let uniforms = uniforms.iter().map(|&(binding, buffer)| (binding, buffer.as_entire_binding()));
    let tables = tables.iter().map(|&(binding, table)| (binding, wgpu::BindingResource::TextureView(&table.view)));
    let entries: Vec<_> =
        uniforms.chain(tables).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("silhouettes"), layout, entries: &entries })
}

pub(super) fn uniform_buffer(gpu: &Gpu, label: &str, contents: &[u8]) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM;
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}
