//! What casts shadows, made ready to be asked for many receivers and suns.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use umbrae_core::{Caster, RayCaster};

use crate::{Exposure, Packets, Receivers};

/// The triangles of a scene, made ready.
#[derive(Debug, Clone)]
pub struct Blockers {
    rays: RayCaster,
}

impl Blockers {
    /// Makes `casters` ready.
    pub fn new(casters: &[Caster]) -> Self {
        Self { rays: RayCaster::new(casters.iter().map(|c| (c.positions.as_slice(), c.mesh.triangles()))) }
    }

    /// The ray caster over the same triangles; part `i` of it is caster `i`.
    pub fn rays(&self) -> &RayCaster {
        &self.rays
    }

    /// Whether nothing is between a receiver at `position`, open to the side of `normal` (zero: to all), and the sun towards `to_sun`; by one ray.
    pub fn sees(&self, position: DVec3, normal: glam::Vec3, to_sun: DVec3) -> bool {
        let faces = normal == glam::Vec3::ZERO || normal.as_dvec3().dot(to_sun) > 0.0;
        faces && !self.rays.is_hit(position, to_sun, 0.0, f64::INFINITY)
    }

    /// Decides every receiver of `range` of `packets` for each step: `suns` has the direction towards the sun, or `None` at night.
    ///
    /// Works on all threads of rayon's pool, and stops early, with `None`, soon after `stop` is set. `packet_done` is called
    /// after each packet, on any thread.
    pub fn expose(
        &self,
        receivers: &Receivers,
        packets: &Packets,
        range: Range<usize>,
        suns: &[Option<DVec3>],
        stop: &AtomicBool,
        packet_done: impl Fn() + Sync,
    ) -> Option<Exposure> {
        let rows: Vec<Vec<u64>> = range
            .clone()
            .into_par_iter()
            .map(|packet| {
                if stop.load(Ordering::Relaxed) {
                    return None;
                }
                let row = suns.iter().map(|&sun| {
                    let Some(to_sun) = sun else { return 0 };
                    packets
                        .members(packet)
                        .filter(|&(_, r)| self.sees(receivers.positions[r], receivers.normals[r], to_sun))
                        .fold(0, |word, (lane, _)| word | 1 << lane)
                });
                let row = row.collect();
                packet_done();
                Some(row)
            })
            .collect::<Option<_>>()?;
        Some(Exposure { packets: range, step_count: suns.len(), lit: rows.concat(), undecided: Vec::new() })
    }
}
