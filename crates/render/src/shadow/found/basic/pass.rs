//! The two passes that find silhouettes, for up to 64 lights at once.

use bytemuck::{Pod, Zeroable};
use umbrae_core::{Camera, LightPosition};
use wgpu::util::DeviceExt as _;

use super::table_pass::{TablePass, bind, layout};
use super::tables::{Entry, Table, Tables};
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
    coefficients: TablePass,
    multiplicities: TablePass,
    of_volumes: wgpu::BindGroupLayout,
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
        let module = shaders::find_basic(&gpu.device);
        Self {
            coefficients: TablePass::new(gpu, &module, "fs_coefficients", &[0], &[2, 3, 4]),
            multiplicities: TablePass::new(gpu, &module, "fs_multiplicities", &[0, 1], &[5, 6, 7]),
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
        let of_triangles = self.coefficients.group(
            gpu,
            &[(0, &lights)],
            &[(2, &tables.triangles.view), (3, &components.view), (4, &tables.positions.view)],
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
            let of_edges = self.multiplicities.group(
                gpu,
                &[(0, &batch.lights), (1, &range)],
                &[(5, &tables.edges.view), (6, &tables.incidences.view), (7, &batch.coefficients.view)],
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
                        (1, &tables.positions.view),
                        (2, &tables.triangles.view),
                        (3, &tables.edges.view),
                        (4, &batch.coefficients.view),
                        (5, &multiplicities.view),
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
        let to = &batch.coefficients.view;
        self.coefficients.draw(encoder, to, &batch.of_triangles, ("coefficients", timer));
        let used = (batch.staged.lights.count as usize).div_ceil(lights_in_texel(tables));
        for lanes in &batch.lanes[..used] {
            let to = &lanes.multiplicities.view;
            self.multiplicities.draw(encoder, to, &lanes.of_edges, ("multiplicities", timer));
        }
    }
}

/// Group 2 of `found_basic_volume.wgsl`.
pub(super) fn volume_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    layout(gpu, "volumes found in textures", wgpu::ShaderStages::VERTEX, &[0], &[1, 2, 3, 4, 5])
}

fn uniform_buffer(gpu: &Gpu, label: &str, contents: &[u8]) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}
