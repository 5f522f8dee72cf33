//! What was found in textures, read back.

use std::collections::BTreeMap;

use umbrae_core::{Caster, SilhouetteEdge};

use super::BasicFinder;
use super::pass::lights_in_texel;
use super::tables::{CasterTables, Entry, Table};
use crate::shadow::found::FoundSilhouette;
use crate::{Gpu, GpuError};

/// Of how many bits a coefficient is.
const COEFFICIENT_BITS: usize = 2;

impl BasicFinder {
    /// What was found of each of `wanted`, a caster and a light, and whether that was counted by z-fail.
    pub(in crate::shadow::found) async fn read(
        &self,
        gpu: &Gpu,
        casters: &[Caster],
        wanted: &[(usize, usize, bool)],
    ) -> Result<Vec<FoundSilhouette>, GpuError> {
        let edges = entries(gpu, &self.tables.edges).await?;
        let mut of_batches = Vec::new();
        for batch in self.batches_in_use() {
            let mut of_lanes = Vec::new();
            for lanes in &batch.lanes {
                of_lanes.push(entries(gpu, &lanes.multiplicities).await?);
            }
            of_batches.push((entries(gpu, &batch.coefficients).await?, of_lanes));
        }
        let found = |&(caster, light, is_fail): &(usize, usize, bool)| {
            let (b, l) = (light / super::MOST_LIGHTS, light % super::MOST_LIGHTS);
            let (coefficients, of_lanes) = &of_batches[b];
            let lanes = lights_in_texel(&self.tables);
            let tables = &self.tables.casters[caster];
            let coefficients = of_triangles(&casters[caster], tables, |t| {
                [0, 1, -1, 0][bits(&coefficients[t as usize], l, COEFFICIENT_BITS) as usize]
            });
            let lane_bits = self.tables.lane_bits as usize;
            let edges = of_edges(tables, &edges, |e| {
                let lane = bits(&of_lanes[l / lanes][e as usize], l % lanes, lane_bits);
                (i64::from(lane) - (1 << (lane_bits - 1))) as i32
            });
            let casting = coefficients.iter().enumerate().filter(|(_, c)| **c != 0);
            let caps = casting.map(|(t, &c)| (t, c < 0)).collect();
            FoundSilhouette { caster, light, coefficients, edges, caps, is_fail }
        };
        Ok(wanted.iter().map(found).collect())
    }
}

/// Number `i` of those that are of `size` bits each.
fn bits(entry: &Entry, i: usize, size: usize) -> u32 {
    let at = i * size;
    (entry[at / 32] >> (at % 32)) & (u32::MAX >> (32 - size))
}

/// For each triangle, in the caster's order.
fn of_triangles(caster: &Caster, tables: &CasterTables, coefficient: impl Fn(u32) -> i8) -> Vec<i8> {
    let mut coefficients = vec![0; caster.mesh.triangles().len()];
    for (part, part_tables) in tables.partition.iter().zip(&tables.parts) {
        for (&t, number) in part.triangles.iter().zip(part_tables.triangles.clone()) {
            coefficients[t as usize] = coefficient(number);
        }
    }
    coefficients
}

/// Those that are extruded; what runs along an edge between parts is added up.
fn of_edges(tables: &CasterTables, edges: &[Entry], multiplicity: impl Fn(u32) -> i32) -> Vec<SilhouetteEdge> {
    let mut sums = BTreeMap::new();
    for run in tables.parts.iter().flat_map(|part| &part.edges) {
        for e in run.edges.clone() {
            let [low, high] = [edges[e as usize][0], edges[e as usize][1]].map(|i| i - tables.positions.start);
            *sums.entry((low, high)).or_insert(0) += multiplicity(e);
        }
    }
    let edge = |((low, high), m): ((u32, u32), i32)| {
        let (start, end) = if m > 0 { (low, high) } else { (high, low) };
        (m != 0).then_some(SilhouetteEdge { start, end, multiplicity: m.unsigned_abs() })
    };
    sums.into_iter().filter_map(edge).collect()
}

async fn entries(gpu: &Gpu, table: &Table) -> Result<Vec<Entry>, GpuError> {
    Ok(bytemuck::pod_collect_to_vec(&gpu.read(&table.texture).await?))
}
