//! What casts shadows, made ready to be asked for many receivers and suns.

mod beam;
mod cell;
#[cfg(test)]
mod clutter;
mod cone;
mod disc;
mod faces;
mod lanes;
mod light_space;
mod quads;
mod remainder;
mod shaft;
mod tree;
mod walk;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use umbrae_core::{Bounds, Caster, RayCaster};

use crate::{Exposure, Packets, Receivers};
use beam::Care;
use cell::Cell;
use light_space::LightSpace;
use tree::Tree;
use walk::Asked;

/// The triangles of a scene, made ready: a tree of faces for packets of receivers, and rays in `f64` for what is too near to an edge to call, and to check.
///
/// Takes about 150 bytes a triangle, and a microsecond each to prepare.
#[derive(Debug, Clone)]
pub struct Blockers {
    tree: Tree,
    rays: RayCaster,
    margin_m: f64,
    /// Holds the triangles; empty without any.
    bounds: Bounds,
}

/// What rounding moves the side of a box in light space, in parts of its distance from the receiver; see `light_space.rs`.
const BOX_ROUNDING: f64 = 4e-6;

/// A verdict is decided if it holds for every point so near; less in scenes smaller than a house.
const MARGIN_M: f64 = 1e-3;

/// The margin in parts of a small scene's radius: ten times what rounding costs.
const MARGIN_OF_RADIUS: f64 = 1e-5;

impl Blockers {
    /// Makes `casters` ready.
    pub fn new(casters: &[Caster]) -> Self {
        let bounds = Caster::bounds_of(casters);
        let margin_m = MARGIN_M.min(MARGIN_OF_RADIUS * bounds.radius());
        let quads = casters.par_iter().flat_map_iter(|caster| quads::quads_of(caster, margin_m)).collect();
        let parts = casters.iter().map(|c| (c.positions.as_slice(), c.mesh.triangles()));
        let (tree, rays) = rayon::join(|| Tree::new(quads), || RayCaster::new(parts));
        Self { tree, rays, margin_m, bounds }
    }

    /// The ray caster over the same triangles; part `i` of it is caster `i`.
    pub fn rays(&self) -> &RayCaster {
        &self.rays
    }

    /// How near to an edge of a shadow a verdict counts as undecided, in metres: a millimetre, less in scenes smaller than 100 m.
    pub fn margin_m(&self) -> f64 {
        self.margin_m
    }

    /// Whether nothing is between a receiver at `position`, open to the side of `normal` (zero: to all), and the sun towards `to_sun`; by one ray.
    pub fn sees(&self, position: DVec3, normal: Vec3, to_sun: DVec3) -> bool {
        let faces = normal == Vec3::ZERO || normal.as_dvec3().dot(to_sun) > 0.0;
        faces && !self.rays.is_hit(position, to_sun, 0.0, f64::INFINITY)
    }

    /// Decides every receiver of `range` of `packets` for each step: `suns` has the unit vector towards the sun, or `None` at night.
    ///
    /// Works on all threads of the current rayon pool, and stops early, with `None`, soon after `stop` is set. `packet_done` is called after each
    /// packet, on any thread. Takes about a microsecond for a packet and sun among houses; memory for the answer only.
    pub fn expose(
        &self,
        receivers: &Receivers,
        packets: &Packets,
        range: Range<usize>,
        suns: &[Option<DVec3>],
        stop: &AtomicBool,
        packet_done: impl Fn() + Sync,
    ) -> Option<Exposure> {
        let lights: Vec<_> = suns.iter().map(|sun| sun.map(LightSpace::new)).collect();
        let mut lit = vec![0; range.len() * suns.len()];
        let undecided: Vec<Vec<(u32, u32)>> = if suns.is_empty() {
            Vec::new()
        } else {
            let rows = lit.par_chunks_mut(suns.len()).zip(range.clone());
            rows.map(|(row, packet)| {
                if stop.load(Ordering::Relaxed) {
                    return None;
                }
                let undecided = self.expose_packet(receivers, packets.members(packet), suns, &lights, row);
                packet_done();
                Some(undecided)
            })
            .collect::<Option<_>>()?
        };
        let mut undecided = undecided.concat();
        undecided.sort_unstable();
        Some(Exposure { packets: range, step_count: suns.len(), lit, undecided })
    }

    /// Fills `row`, a word for each light, and returns receivers and steps that are undecided.
    fn expose_packet(
        &self,
        receivers: &Receivers,
        members: &[u32],
        suns: &[Option<DVec3>],
        lights: &[Option<LightSpace>],
        row: &mut [u64],
    ) -> Vec<(u32, u32)> {
        let (cell, care) = self.cell(receivers, members);
        let asked = Asked { tree: &self.tree, cell: &cell, lights, care };
        let mut near = Vec::new();
        shaft::shade_all(asked, |step, shade| {
            row[step] = cell.used & !shade.shadow;
            if shade.near != 0 {
                near.push((step, shade.near));
            }
        });
        let mut undecided = Vec::new();
        for (step, mut lanes) in near {
            let Some(to_sun) = suns[step] else { continue };
            while lanes != 0 {
                let lane = lanes.trailing_zeros();
                lanes &= lanes - 1;
                let r = members[lane as usize];
                let (position, normal) = (receivers.positions[r as usize], receivers.normals[r as usize]);
                let is_lit = self.sees(position, normal, to_sun);
                row[step] &= !(u64::from(!is_lit) << lane);
                if !self.is_decided(position, normal, to_sun, is_lit) {
                    undecided.push((r, step as u32));
                }
            }
        }
        undecided
    }

    /// Those of the receivers that are `members` of a packet, and how certain they must be.
    fn cell(&self, receivers: &Receivers, members: &[u32]) -> (Cell, Care) {
        let of = |&r: &u32| (receivers.positions[r as usize].to_array(), receivers.normals[r as usize].to_array());
        let cell = Cell::new(&members.iter().map(of).collect::<Vec<_>>());
        let care = Care { margin: self.margin_m as f32, pad: self.pad(cell.middle) };
        (cell, care)
    }

    /// What boxes are widened by for receivers about `middle`: more than the margin, and than rounding over the way to the farthest triangle.
    fn pad(&self, middle: [f32; 3]) -> f32 {
        let middle = Vec3::from_array(middle).as_dvec3();
        let farthest = (self.bounds.max - middle).abs().max((self.bounds.min - middle).abs()).length();
        // Without triangles nothing is far.
        let farthest = if self.bounds.is_empty() { 0.0 } else { farthest };
        (2.0 * self.margin_m + BOX_ROUNDING * farthest) as f32
    }

    /// Whether four points at the margin around a receiver, across the rays, have its verdict.
    fn is_decided(&self, position: DVec3, normal: Vec3, to_sun: DVec3, is_lit: bool) -> bool {
        let (across, up) = to_sun.any_orthonormal_pair();
        [across, -across, up, -up]
            .into_iter()
            .all(|to| self.sees(position + self.margin_m * to, normal, to_sun) == is_lit)
    }
}
