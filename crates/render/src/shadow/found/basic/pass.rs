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

/// `FoundLights` in `find_basic.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FoundLightsUniform {
    pub(super) positions_world: [[f32; 4]; MOST_LIGHTS],
    pub(super) count: u32,
    pub(super) triangle_count: u32,
    pub(super) edge_count: u32,
    pub(super) lane_bits: u32,
}

/// `FoundLanes` in `find_basic.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FoundLanesUniform {
    pub(super) first_light: u32,
    pub(super) unused_a: u32,
    pub(super) unused_b: u32,
    pub(super) unused_c: u32,
}

/// `FoundIn` in `found_basic_volume.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FoundInUniform {
    pub(super) number: u32,
    pub(super) lane: u32,
    pub(super) lane_bits: u32,
    pub(super) unused: u32,
}

/// Finds silhouettes.
///
/// - reads: the tables of casters; where the lights are
/// - writes: a coefficient for each triangle and light, then a multiplicity for each edge and light
/// - needs: nothing beyond WebGL2
#[derive(Debug)]
pub(super) struct FindPass {
    of_triangles: wgpu::BindGroupLayout,
    of_edges: wgpu::BindGroupLayout,
    of_volumes: wgpu::BindGroupLayout,
    coefficients: wgpu::RenderPipeline,
    multiplicities: wgpu::RenderPipeline,
}

/// Up to [`MOST_LIGHTS`] lights for which silhouettes are found together, and what was found.
#[derive(Debug)]
pub(super) struct Batch {
    lights: wgpu::Buffer,
    /// For each component, bits of the lights from which every triangle counts, and the largest coordinate of the caster's box.
    components: Table,
    of_triangles: wgpu::BindGroup,
    /// Two bits a light.
    pub(super) coefficients: Table,
    /// As many as the lights need.
    pub(super) lanes: Vec<Lanes>,
    staged: Staged,
}

/// Lights whose multiplicities are in one table.
#[derive(Debug)]
pub(super) struct Lanes {
    pub(super) multiplicities: Table,
    of_edges: wgpu::BindGroup,
    /// For drawing, one for each light.
    of_volumes: Vec<wgpu::BindGroup>,
}

/// What a frame uploads.
#[derive(Debug)]
struct Staged {
    lights: FoundLightsUniform,
    components: Vec<Entry>,
}

/// How many lights have their multiplicities in one texel.
pub(super) fn lights_in_texel(tables: &Tables) -> usize {
    8 * size_of::<Entry>() / tables.lane_bits as usize
}

impl Batch {
    /// Tells from boxes how components count for `lights`, at most [`MOST_LIGHTS`], rounded as shaders see them.
    pub(super) fn plan(&mut self, tables: &Tables, camera: &Camera, lights: impl Iterator<Item = LightPosition>) {
        let Staged { lights: uniform, components } = &mut self.staged;
        components.clear();
        components
            .extend(tables.component_boxes.iter().map(|component| [0, 0, (component.reach() as f32).to_bits(), 0]));
        uniform.count = 0;
        for light in lights {
            let l = uniform.count as usize;
            uniform.positions_world[l] = light.homogeneous().as_vec4().to_array();
            uniform.count += 1;
            for (entry, component) in components.iter_mut().zip(&tables.component_boxes) {
                entry[l / 32] |= u32::from(component.is_every(camera, light)) << (l % 32);
            }
        }
    }

    /// Whether every solid component of `caster` has only triangles counted that face light `l`.
    pub(super) fn is_facing(&self, tables: &Tables, caster: usize, l: usize) -> bool {
        let mut solid = tables.casters[caster].components.clone().filter(|&i| tables.component_boxes[i].is_solid);
        !solid.any(|i| (self.staged.components[i][l / 32] >> (l % 32)) & 1 == 1)
    }

    /// For drawing the volumes of light `l`.
    pub(super) fn of_volumes(&self, tables: &Tables, l: usize) -> &wgpu::BindGroup {
        let lanes = lights_in_texel(tables);
        &self.lanes[l / lanes].of_volumes[l % lanes]
    }

    /// Uploads what was planned.
    pub(super) fn upload(&self, gpu: &Gpu) {
        gpu.queue.write_buffer(&self.lights, 0, bytemuck::bytes_of(&self.staged.lights));
        self.components.write(gpu, &self.staged.components);
    }
}

impl FindPass {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let of_triangles = layout(gpu, "silhouettes, triangles", fragment, &[0], &[2, 3, 4]);
        let of_edges = layout(gpu, "silhouettes, edges", fragment, &[0, 1], &[5, 6, 7]);
        let module = shaders::find_basic(&gpu.device);
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
            of_volumes: volume_layout(gpu),
        }
    }

    /// Room for [`MOST_LIGHTS`] lights: 16 bytes for each triangle and component.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] as for [`Table::new`].
    pub(super) fn batch(&self, gpu: &Gpu, tables: &Tables) -> Result<Batch, GpuError> {
        let uniform = FoundLightsUniform {
            triangle_count: tables.triangle_count,
            edge_count: tables.edge_count,
            lane_bits: tables.lane_bits,
            ..Zeroable::zeroed()
        };
        let lights = uniform_buffer(gpu, "lights of silhouettes", bytemuck::bytes_of(&uniform));
        let components = Table::new(gpu, "caster components", tables.component_boxes.len())?;
        let of_triangles = bind(
            gpu,
            &self.of_triangles,
            &[(0, &lights)],
            &[(2, &tables.triangles), (3, &components), (4, &tables.positions)],
        );
        Ok(Batch {
            lights,
            components,
            of_triangles,
            coefficients: Table::new(gpu, "coefficients", tables.triangle_count as usize)?,
            lanes: Vec::new(),
            staged: Staged { lights: uniform, components: Vec::new() },
        })
    }

    /// Makes room in `batch` for the multiplicities of so many lights: 16 bytes for each edge, for 32 lights where no edge has
    /// more than seven triangles.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] as for [`Table::new`].
    pub(super) fn make_lanes(
        &self,
        gpu: &Gpu,
        tables: &Tables,
        batch: &mut Batch,
        light_count: usize,
    ) -> Result<(), GpuError> {
        let in_texel = lights_in_texel(tables);
        while batch.lanes.len() * in_texel < light_count {
            let first_light = (batch.lanes.len() * in_texel) as u32;
            let range = FoundLanesUniform { first_light, ..Zeroable::zeroed() };
            let range = uniform_buffer(gpu, "lights of multiplicities", bytemuck::bytes_of(&range));
            let multiplicities = Table::new(gpu, "multiplicities", tables.edge_count as usize)?;
            let of_edges = bind(
                gpu,
                &self.of_edges,
                &[(0, &batch.lights), (1, &range)],
                &[(5, &tables.edges), (6, &tables.incidences), (7, &batch.coefficients)],
            );
            let of_volumes = |lane: u32| {
                let number = first_light + lane;
                let found_in = FoundInUniform { number, lane, lane_bits: tables.lane_bits, unused: 0 };
                let found_in = uniform_buffer(gpu, "where a light's silhouette is", bytemuck::bytes_of(&found_in));
                bind(
                    gpu,
                    &self.of_volumes,
                    &[(0, &found_in)],
                    &[
                        (1, &tables.positions),
                        (2, &tables.triangles),
                        (3, &tables.edges),
                        (4, &batch.coefficients),
                        (5, &multiplicities),
                    ],
                )
            };
            let of_volumes = (0..in_texel as u32).map(of_volumes).collect();
            batch.lanes.push(Lanes { multiplicities, of_edges, of_volumes });
        }
        Ok(())
    }

    /// Records the passes for `batch`: two for 32 lights where no edge has more than seven triangles, else one more for each 16, 8 or 4 lights.
    pub(super) fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        tables: &Tables,
        batch: &Batch,
        timer: &mut PassTimer,
    ) {
        let (coefficients, group) = (&batch.coefficients, &batch.of_triangles);
        fill(encoder, coefficients, &self.coefficients, group, ("coefficients", timer));
        let used = (batch.staged.lights.count as usize).div_ceil(lights_in_texel(tables));
        for lanes in &batch.lanes[..used] {
            let (multiplicities, group) = (&lanes.multiplicities, &lanes.of_edges);
            fill(encoder, multiplicities, &self.multiplicities, group, ("multiplicities", timer));
        }
    }
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

/// Group 2 of `found_basic_volume.wgsl`.
pub(super) fn volume_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    layout(gpu, "volumes found in textures", wgpu::ShaderStages::VERTEX, &[0], &[1, 2, 3, 4, 5])
}

/// A group of uniforms and tables, by binding.
fn layout(
    gpu: &Gpu,
    label: &str,
    visibility: wgpu::ShaderStages,
    uniforms: &[u32],
    tables: &[u32],
) -> wgpu::BindGroupLayout {
    let entry = |ty| move |&binding: &u32| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let table = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Uint,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let entries: Vec<_> = uniforms.iter().map(entry(uniform)).chain(tables.iter().map(entry(table))).collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

fn bind(
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

fn uniform_buffer(gpu: &Gpu, label: &str, contents: &[u8]) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}
