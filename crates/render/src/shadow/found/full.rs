//! Silhouettes by compute shaders.
//!
//! ```text
//! plan       jobs, from boxes             CPU, in memory that is kept
//! upload     lights, jobs, rows           a few words for each caster and light that matter
//! record     find_triangles               each triangle, for all lights: coefficients, light caps, who may shade the near rectangle
//!            find_edges                   each edge, for all lights: sides
//!            find_arguments               each job: z-pass or z-fail, and how much is drawn
//! ```
//!
//! Sources: S. Brabec and H.-P. Seidel, "Shadow volumes on programmable graphics hardware", 2003, have silhouettes on the GPU first; multiplicities and
//! compaction into indirect draws follow the compute silhouettes of J. Peciva, T. Milet and others (Brno). Triangles are tested once for
//! all edges and lights here, as the chain needs it.

use std::sync::atomic::Ordering;

use bytemuck::Zeroable as _;
use umbrae_core::{Bounds, Camera, Case, LightPosition};
use wgpu::util::DeviceExt as _;

use super::DrawnWith;
use super::jobs::{Count, DarkCap, Job};
use super::pipelines::{draw_group, draw_layout};
use super::smooth::SmoothFinder;
use super::tables::Tables;
use crate::growing::GrowingBuffer;
use crate::passes::{FindPass, FindingUniform, FoundLightData, JobSlot, JobUniform, MOST_PLANES, groups, job_flags};
use crate::shadow::ShadowCasters;
use crate::shadow::plan::Scope;
use crate::timing::PassTimer;
use crate::{Gpu, GpuError, Tier};

const NONE: u32 = u32::MAX;
/// Of `Result` in `find.wgsl`.
pub(crate) const RESULT_BYTES: u64 = 16 + 16 * Count::ALL as u64;
/// `@workgroup_size` of `find_arguments`.
const JOBS_IN_GROUP: u32 = 64;
/// How many lights have their bits in a word.
const LIGHTS_IN_WORD: u32 = 16;
/// Planes are moved out once more, by this much of what was slack, for being read in `f32`.
const ROUNDED_PLANES: f64 = 1.0;

/// Everything that is kept from frame to frame.
#[derive(Debug)]
pub(super) struct FullFinder {
    tables: Tables,
    table_words: wgpu::Buffer,
    positions: wgpu::Buffer,
    pass: FindPass,
    layout: wgpu::BindGroupLayout,
    finding: GrowingBuffer,
    lights: GrowingBuffer,
    jobs: GrowingBuffer,
    rows: GrowingBuffer,
    pub(super) coefficients: GrowingBuffer,
    pub(super) lists: GrowingBuffer,
    pub(super) results: GrowingBuffer,
    /// For finding; `None` as long as nothing was.
    group: Option<wgpu::BindGroup>,
    /// For drawing.
    drawn: Option<wgpu::BindGroup>,
    pub(super) staged: Staged,
    /// If any caster stands for a smooth body.
    pub(super) smooth: Option<SmoothFinder>,
    /// Across, or down.
    most_groups: u32,
}

/// What one frame uploads.
#[derive(Debug)]
pub(super) struct Staged {
    pub(super) finding: FindingUniform,
    lights: Vec<FoundLightData>,
    pub(super) jobs: Vec<JobSlot>,
    rows: Vec<u32>,
    list_len: u64,
}

impl FullFinder {
    /// # Errors
    ///
    /// [`GpuError::NoSilhouettes`] without compute shaders, [`GpuError::TooLarge`].
    pub(super) fn new(gpu: &Gpu, casters: &[umbrae_core::Caster], uploaded: &ShadowCasters) -> Result<Self, GpuError> {
        if gpu.caps.tier != Tier::Full {
            return Err(GpuError::NoSilhouettes { adapter: gpu.label.clone() });
        }
        let mut tables = Tables::new(casters);
        gpu.ensure_buffer_fits(size_of_val(tables.words.as_slice()))?;
        gpu.ensure_binding_fits(size_of_val(tables.words.as_slice()) as u64)?;
        gpu.ensure_binding_fits(uploaded.vertices.size())?;
        if tables.words.is_empty() {
            tables.words.push(0);
        }
        let table_words = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("tables of casters"),
            contents: bytemuck::cast_slice(&tables.words),
            usage: wgpu::BufferUsages::STORAGE,
        });
        tables.words = Vec::new();
        let storage = wgpu::BufferUsages::STORAGE;
        let growing = |label, usage| GrowingBuffer::new(gpu, label, usage);
        let finding = growing("finding", wgpu::BufferUsages::UNIFORM);
        Ok(Self {
            tables,
            table_words,
            positions: uploaded.vertices.clone(),
            pass: FindPass::new(gpu),
            layout: draw_layout(gpu),
            finding,
            lights: growing("lights to find for", storage),
            jobs: growing("jobs", storage | wgpu::BufferUsages::UNIFORM),
            rows: growing("jobs of casters", storage),
            coefficients: growing("coefficients", storage | wgpu::BufferUsages::COPY_SRC),
            lists: growing("sides and caps", storage | wgpu::BufferUsages::COPY_SRC),
            results: growing("results", storage | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_SRC),
            most_groups: gpu.device.limits().max_compute_workgroups_per_dimension,
            group: None,
            drawn: None,
            smooth: SmoothFinder::new(gpu, uploaded)?,
            staged: Staged {
                finding: FindingUniform::zeroed(),
                lights: Vec::new(),
                jobs: Vec::new(),
                rows: Vec::new(),
                list_len: 0,
            },
        })
    }

    /// Starts a frame with so many lights.
    pub(super) fn start(&mut self, camera: &Camera, light_count: u32) {
        let staged = &mut self.staged;
        let near = camera.near_rectangle();
        let bounds = Bounds::of_points(near);
        staged.finding = FindingUniform {
            light_count,
            words: light_count.div_ceil(LIGHTS_IN_WORD),
            job_count: 0,
            triangle_blocks: self.tables.triangle_blocks.start,
            triangle_block_count: self.tables.triangle_blocks.count,
            edge_blocks: self.tables.edge_blocks.start,
            edge_block_count: self.tables.edge_blocks.count,
            unused: 0,
            near_min: bounds.min.as_vec3().extend(0.0).to_array(),
            near_max: bounds.max.as_vec3().extend(0.0).to_array(),
            near_corners: near.map(|corner| corner.as_vec3().extend(1.0).to_array()),
        };
        staged.lights.clear();
        staged.jobs.clear();
        staged.rows.clear();
        staged.rows.resize(self.tables.of_casters.len() * light_count as usize, NONE);
        staged.list_len = 0;
    }

    /// Adds the next light; `scope` is `None` where it draws nothing.
    pub(super) fn add_light(&mut self, position: LightPosition, scope: Option<&Scope>) {
        let mut data = FoundLightData::zeroed();
        data.position_world = position.homogeneous().as_vec4().to_array();
        if let Some(scope) = scope {
            // With fewer planes the hull is larger, and more is tested as near than need be.
            for plane in scope.chooser.near_pyramid().planes().iter().take(MOST_PLANES) {
                let slack = ROUNDED_PLANES * scope.chooser.slack_m();
                let to = &mut data.planes[data.plane_count as usize];
                *to = (*plane + glam::DVec3::ZERO.extend(slack)).as_vec4().to_array();
                data.plane_count += 1;
            }
        }
        self.staged.lights.push(data);
    }

    /// Adds `jobs`, those of all lights.
    pub(super) fn add_jobs(&mut self, jobs: &[Job], uploaded: &ShadowCasters) {
        let staged = &mut self.staged;
        for (number, job) in (0_u32..).zip(jobs) {
            let table = self.tables.of_casters[job.caster as usize];
            let is_directional = staged.lights[job.light as usize].position_world[3] == 0.0;
            let has_moved = uploaded.has_moved[job.caster as usize].load(Ordering::Relaxed);
            let flags = [
                (job.is_see_through, job_flags::SEE_THROUGH),
                (job.needs_caps(), job_flags::NEEDS_CAPS),
                (job.case.is_none(), job_flags::UNDECIDED),
                (matches!(job.case, Some(Case::Fail | Case::FailWithoutLightCap)), job_flags::FAILS),
                (is_directional, job_flags::DIRECTIONAL),
                (job.dark_cap == DarkCap::Fan, job_flags::FAN),
                (has_moved, job_flags::MOVED),
            ];
            // Each edge of a triangle may be there once.
            let sides = staged.list_len;
            let caps = sides + 3 * u64::from(table.triangle_count);
            staged.list_len = caps + if job.needs_caps() { u64::from(table.triangle_count) } else { 0 };
            let block = job.block;
            staged.jobs.push(JobSlot {
                job: JobUniform {
                    near: block.first_vertex + block.near(0),
                    far: block.first_vertex + block.far(0),
                    axes: block.first_vertex,
                    edges: table.edges,
                    triangles: table.triangles,
                    // What does not fit into 32 bits is refused with the list.
                    sides: sides as u32,
                    caps: caps as u32,
                    flags: flags.iter().filter(|(is_set, _)| *is_set).fold(0, |bits, (_, bit)| bits | bit),
                    // Outwards, by much more than the rounding.
                    box_min: job.bounds.min.as_vec3().to_array(),
                    edge_on: job.edge_on,
                    box_max: job.bounds.max.as_vec3().to_array(),
                    slack: job.slack_m,
                },
                unused: [[0; 4]; 12],
            });
            staged.rows[(job.caster * staged.finding.light_count + job.light) as usize] = number;
        }
        staged.finding.job_count = staged.jobs.len() as u32;
    }

    /// Uploads what was added.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the lists are larger than shaders can be given.
    pub(super) fn upload(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        let staged = &self.staged;
        let mut is_other = self.finding.fill(gpu, bytemuck::bytes_of(&staged.finding))?;
        is_other |= self.lights.fill(gpu, bytemuck::cast_slice(&staged.lights))?;
        if let Some(smooth) = &mut self.smooth {
            smooth.upload(gpu, self.finding.buffer(), self.lights.buffer(), is_other)?;
        }
        if staged.jobs.is_empty() {
            // What it was made with may be gone by the next frame.
            self.group = self.group.take().filter(|_| !is_other);
            return Ok(());
        }
        let coefficients = 4 * u64::from(self.tables.triangle_count) * u64::from(staged.finding.words);
        is_other |= self.group.is_none();
        is_other |= self.lists.grow_to(gpu, 4 * staged.list_len)?;
        is_other |= self.coefficients.grow_to(gpu, coefficients)?;
        is_other |= self.results.grow_to(gpu, RESULT_BYTES * staged.jobs.len() as u64)?;
        is_other |= self.jobs.fill(gpu, bytemuck::cast_slice(&staged.jobs))?;
        is_other |= self.rows.fill(gpu, bytemuck::cast_slice(&staged.rows))?;
        if is_other {
            let buffers = [
                self.finding.buffer(),
                &self.table_words,
                &self.positions,
                self.lights.buffer(),
                self.jobs.buffer(),
                self.rows.buffer(),
                self.coefficients.buffer(),
                self.lists.buffer(),
                self.results.buffer(),
            ];
            self.group = Some(self.pass.group(gpu, buffers));
            let tables = [self.jobs.buffer(), &self.table_words, &self.positions, self.lists.buffer()];
            self.drawn = Some(draw_group(gpu, &self.layout, tables));
        }
        Ok(())
    }

    /// Records the finding, as a pass of its own that is timed.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: &mut PassTimer) {
        if let Some(smooth) = &self.smooth {
            smooth.record(encoder, timer);
        }
        let finding = &self.staged.finding;
        let Some(group) = self.group.as_ref().filter(|_| finding.job_count > 0) else { return };
        encoder.clear_buffer(self.results.buffer(), 0, Some(RESULT_BYTES * u64::from(finding.job_count)));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("silhouettes"),
            timestamp_writes: timer.compute_writes("silhouettes"),
        });
        let blocks =
            [finding.triangle_block_count, finding.edge_block_count, finding.job_count.div_ceil(JOBS_IN_GROUP)];
        self.pass.draw(&mut pass, group, blocks.map(|blocks| groups(self.most_groups, blocks)));
    }

    /// What volumes are drawn with: a group with the offset of a job, and the buffer of arguments.
    pub(super) fn drawn_with(&self) -> Option<DrawnWith> {
        self.drawn
            .as_ref()
            .map(|group| DrawnWith::Lists { group: group.clone(), arguments: self.results.buffer().clone() })
    }
}
