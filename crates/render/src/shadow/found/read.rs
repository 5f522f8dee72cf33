//! What was found, read back: for tests, and for whoever wants to see silhouettes. Drawing needs none of it.

use glam::Vec3;
use umbrae_core::{Case, Caster, SilhouetteEdge};

use super::full::{FullFinder, RESULT_BYTES};
use super::{Finder, FoundShadows, FoundSmoothSilhouette};
use crate::{CasterReport, Gpu, GpuError, ShadowLight, readback};

/// What was found of one caster under one light.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundSilhouette {
    /// Number of the caster.
    pub caster: usize,
    /// Number of the light in the frame.
    pub light: usize,
    /// For each triangle how often it casts, as [`umbrae_core::Chain`] has it.
    pub coefficients: Vec<i8>,
    /// The edges that are extruded, in no order, each once with its multiplicity.
    pub edges: Vec<SilhouetteEdge>,
    /// The triangles of the caps, in no order, with whether they are turned round; empty where no cap may be needed.
    pub caps: Vec<(usize, bool)>,
    /// Whether it is counted by z-fail.
    pub is_fail: bool,
}

impl FoundShadows {
    /// What was found for the frame that was planned and submitted last, for each light and each caster that matters to it. Waits for the GPU;
    /// `casters` are those that this was made for.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub async fn read(&self, gpu: &Gpu, casters: &[Caster]) -> Result<Vec<FoundSilhouette>, GpuError> {
        match &self.finder {
            Finder::Full(finder) => finder.read(gpu, casters, &self.jobs).await,
            Finder::Basic(finder) => finder.read(gpu, casters, &self.planned()).await,
        }
    }

    /// What was found of smooth bodies. `positions` are where the vertices of `casters` are, caster by caster: [`crate::GpuPoser::positions`]. Waits for the GPU.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub async fn read_smooth(
        &self,
        gpu: &Gpu,
        casters: &[Caster],
        positions: &[Vec<Vec3>],
    ) -> Result<Vec<FoundSmoothSilhouette>, GpuError> {
        match self.smooth() {
            Some(smooth) => smooth.read(gpu, casters, positions).await,
            None => Ok(Vec::new()),
        }
    }

    /// Caster, light, and whether it is counted by z-fail, where the CPU knows.
    fn planned(&self) -> Vec<(usize, usize, bool)> {
        let of_light = |(light, shadows): (usize, &ShadowLight)| {
            let is_fail = |report: &CasterReport| report.case().map(|case| case != Case::Pass);
            let casters = shadows.report.casters.iter().enumerate();
            casters.filter_map(|(caster, report)| Some((caster, light, is_fail(report)?))).collect::<Vec<_>>()
        };
        self.lights().enumerate().flat_map(of_light).collect()
    }
}

impl FullFinder {
    async fn read(&self, gpu: &Gpu, casters: &[Caster], jobs: &[super::Job]) -> Result<Vec<FoundSilhouette>, GpuError> {
        let results = words(gpu, self.results.buffer()).await?;
        let lists = words(gpu, self.lists.buffer()).await?;
        let coefficients = words(gpu, self.coefficients.buffer()).await?;
        let words_each = self.staged.finding.words as usize;
        let first_triangles: Vec<usize> = casters
            .iter()
            .scan(0, |next, caster| {
                let first = *next;
                *next += caster.mesh.triangles().len();
                Some(first)
            })
            .collect();
        let found = |(i, job): (usize, &super::Job)| {
            let caster = &casters[job.caster as usize];
            let uniform = &self.staged.jobs[i].job;
            let result = &results[i * (RESULT_BYTES / 4) as usize..];
            let [side_count, cap_count] = [result[0], result[1]].map(|count| count as usize);
            let (word, shift) = (job.light as usize / 16, 2 * (job.light % 16));
            let coefficient = |t: usize| {
                let word = coefficients[(first_triangles[job.caster as usize] + t) * words_each + word];
                [0, 1, -1, 0][(word >> shift & 3) as usize]
            };
            FoundSilhouette {
                caster: job.caster as usize,
                light: job.light as usize,
                coefficients: (0..caster.mesh.triangles().len()).map(coefficient).collect(),
                edges: edges(caster, &lists[uniform.sides as usize..][..side_count]),
                caps: lists[uniform.caps as usize..][..cap_count]
                    .iter()
                    .map(|entry| ((entry >> 1) as usize, entry & 1 != 0))
                    .collect(),
                is_fail: result[4..8] == [0, 1, 0, 0],
            }
        };
        Ok(jobs.iter().enumerate().map(found).collect())
    }
}

fn edges(caster: &Caster, entries: &[u32]) -> Vec<SilhouetteEdge> {
    let mut entries = entries.to_vec();
    entries.sort_unstable();
    let edge = |same: &[u32]| {
        let edge = caster.topology.edges()[(same[0] >> 1) as usize];
        let (start, end) = if same[0] & 1 == 0 { (edge.low, edge.high) } else { (edge.high, edge.low) };
        SilhouetteEdge { start, end, multiplicity: same.len() as u32 }
    };
    entries.chunk_by(|a, b| a == b).map(edge).collect()
}

pub(super) async fn words(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u32>, GpuError> {
    let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("what was found, for reading"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read") });
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    let bytes = gpu.unless_out_of_memory(readback::buffer(gpu, &copy).await)?;
    Ok(bytes.as_chunks().0.iter().map(|&four| u32::from_le_bytes(four)).collect())
}
