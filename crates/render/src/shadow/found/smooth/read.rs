//! What was found of smooth bodies, read back: for tests, and for whoever wants to see it. Drawing needs none of it.

use glam::Vec3;
use umbrae_core::Caster;

use super::{SMOOTH_RESULT_BYTES, SmoothFinder};
use crate::shadow::found::read::words;
use crate::{Gpu, GpuError};

/// The volume of one smooth body under one light, in places and not in numbers of points: what is one point has the same bits.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundSmoothSilhouette {
    /// Number of the caster.
    pub caster: usize,
    /// Number of the light in the frame.
    pub light: usize,
    /// The silhouette, each piece as the lit side walks it; in no order. Scene space, as all here.
    pub sides: Vec<[Vec3; 2]>,
    /// Folds and fins.
    pub faces: Vec<[Vec3; 3]>,
    /// The triangles of the light cap; empty where none may be needed.
    pub caps: Vec<[Vec3; 3]>,
    /// Whether it is counted by z-fail.
    pub is_fail: bool,
    /// Whether some of it is uncut because there was no room.
    pub is_coarse: bool,
}

const VERTEX: u32 = 1 << 31;

impl SmoothFinder {
    /// Waits for the GPU; `positions` are where the vertices of `casters` are.
    pub(in crate::shadow::found) async fn read(
        &self,
        gpu: &Gpu,
        casters: &[Caster],
        positions: &[Vec<Vec3>],
    ) -> Result<Vec<FoundSmoothSilhouette>, GpuError> {
        let results = words(gpu, self.results.buffer()).await?;
        let lists = words(gpu, self.lists.buffer()).await?;
        let points = words(gpu, self.points.buffer()).await?;
        let found = |(i, slot): (usize, &crate::passes::SmoothJobSlot)| {
            let (job, caster) = (&slot.job, self.staged.jobs[i].caster as usize);
            let result = &results[i * (SMOOTH_RESULT_BYTES / 4) as usize..];
            let place = |name: u32| {
                if name & VERTEX != 0 {
                    return positions[caster][(name & !VERTEX) as usize];
                }
                let at = 4 * name as usize;
                Vec3::from_array([0, 1, 2].map(|axis| f32::from_bits(points[at + axis])))
            };
            let sides = lists[job.sides as usize..].as_chunks().0;
            let faces = lists[job.faces as usize..].as_chunks().0;
            let caps = &lists[job.caps as usize..];
            let corners = |t: u32| casters[caster].mesh.triangles()[t as usize].map(|v| positions[caster][v as usize]);
            FoundSmoothSilhouette {
                caster,
                light: job.light as usize,
                sides: sides[..result[0] as usize].iter().map(|side: &[u32; 2]| side.map(place)).collect(),
                faces: faces[..result[1] as usize].iter().map(|face: &[u32; 3]| face.map(place)).collect(),
                caps: caps[..result[2] as usize].iter().map(|&t| corners(t)).collect(),
                is_fail: result[16] != 0,
                is_coarse: result[3] > job.inner_room,
            }
        };
        Ok(self.staged.slots.iter().enumerate().map(found).collect())
    }
}
