//! Silhouettes found in textures, for devices that have neither compute shaders nor storage buffers (WebGL2).
//!
//! ```text
//!   positions     one texel a vertex; uploaded, or drawn where a shader moves them
//!       |
//!   coefficients  one fragment a triangle: c = -1, 0 or +1 for each of 64 lights, two bits each
//!       |
//!   multiplicities  one fragment an edge: how often each light's silhouette runs along it, as a sum over its triangles
//!       |
//!   volumes       every edge is drawn, so often as it might be a side; the vertex shader moves what is none out of the frustum
//! ```
//!
//! Source: S. Brabec and H.-P. Seidel, "Shadow volumes on programmable graphics hardware", 2003. Their step 2 tests an edge's two triangles
//! in one shader and so needs closed 2-manifolds; here each triangle is tested once, in a pass of its own, and edges add up what was
//! stored, so that the volume is closed for any mesh and any rounding. Their edges then go through the CPU, because
//! vertex shaders could not read textures; here they stay.
//!
//! | file | |
//! |---|---|
//! | `parts` | casters in parts that the stencil can count |
//! | `tables` | triangles, edges and positions as textures |
//! | `table_pass` | passes that fill such textures |
//! | `pass` | the two that find silhouettes |
//! | `volumes` | what is drawn of the results |
//! | `read` | the results for tests |

#[cfg(all(test, not(target_vendor = "apple")))]
mod glsl_tests;
mod parts;
mod pass;
mod read;
mod table_pass;
mod tables;
#[cfg(test)]
mod tests;
mod volumes;

use std::ops::Range;
use std::sync::atomic::Ordering;

use umbrae_core::{Camera, Caster, Light};

use super::DrawnWith;
use super::pipelines::DrawnFrom;
use crate::shadow::ShadowCasters;
use crate::shadow::options::ShadowOptions;
use crate::shadow::plan::{Plan, Scope, Seen};
use crate::timing::PassTimer;
use crate::{Gpu, GpuError, shaders};
use pass::{Batch, FindPass, MOST_LIGHTS};
pub(crate) use table_pass::TablePass;
use tables::Tables;
pub(crate) use tables::{Displaced, Table, position_entries, position_ranges};

/// Everything that is kept from frame to frame.
#[derive(Debug)]
pub(super) struct BasicFinder {
    pass: FindPass,
    tables: Tables,
    may_sum: bool,
    /// Of [`ShadowCasters`].
    vertices: wgpu::Buffer,
    /// The first near vertex of each caster that something else may have moved there, and its place in the table of positions.
    copies: Vec<(u32, Range<u32>)>,
    /// [`ShadowCasters::moves`] when the tables were filled.
    moves: u64,
    batches: Vec<Batch>,
    light_count: usize,
    /// Why nothing can be found in this frame.
    failure: Option<GpuError>,
}

impl BasicFinder {
    /// With `may_sum`, casters that the stencil can't count are added up in a float target.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] for more than 4 million triangles, edges or vertices on WebGL2.
    pub(super) fn new(
        gpu: &Gpu,
        casters: &[Caster],
        uploaded: &ShadowCasters,
        may_sum: bool,
    ) -> Result<Self, GpuError> {
        let tables = Tables::new(gpu, casters, (shared_positions(uploaded), are_anywhere(uploaded)), may_sum)?;
        let pass = FindPass::new(gpu);
        let vertices = uploaded.vertices.clone();
        Ok(Self {
            pass,
            tables,
            vertices,
            copies: Vec::new(),
            may_sum,
            moves: uploaded.moves(),
            batches: Vec::new(),
            light_count: 0,
            failure: None,
        })
    }

    /// Begins a frame: tells from boxes how components count for `lights`, rounded as shaders see them. What does not fit on the device is told by
    /// [`BasicFinder::upload`].
    pub(super) fn start(
        &mut self,
        gpu: &Gpu,
        casters: &[Caster],
        uploaded: &ShadowCasters,
        camera: &Camera,
        lights: &[Light],
    ) {
        self.light_count = lights.len();
        self.failure = self.make_room(gpu, casters, uploaded).err();
        for (batch, lights) in self.batches.iter_mut().zip(lights.chunks(MOST_LIGHTS)) {
            batch.plan(&self.tables, camera, lights.iter().map(|light| light.position.rounded_to_f32()));
        }
    }

    fn make_room(&mut self, gpu: &Gpu, casters: &[Caster], uploaded: &ShadowCasters) -> Result<(), GpuError> {
        if self.moves != uploaded.moves() {
            self.moves = uploaded.moves();
            let (shared, are_anywhere) = (shared_positions(uploaded), are_anywhere(uploaded));
            if !self.tables.update(gpu, casters, (shared, &are_anywhere)) {
                self.tables = Tables::new(gpu, casters, (shared, are_anywhere), self.may_sum)?;
                self.batches.clear();
            }
        }
        self.copies.clear();
        if shared_positions(uploaded).is_none() {
            for (i, (block, tables)) in uploaded.blocks.iter().zip(&self.tables.casters).enumerate() {
                if moves_in_buffer(uploaded, i) {
                    self.copies.push((block.first_vertex + block.near(0), tables.positions.clone()));
                }
            }
        }
        while self.batches.len() * MOST_LIGHTS < self.light_count {
            self.batches.push(self.pass.batch(gpu, &self.tables)?);
        }
        let mut lights = self.light_count;
        for batch in &mut self.batches {
            self.pass.make_lanes(gpu, &self.tables, batch, lights.min(MOST_LIGHTS))?;
            lights = lights.saturating_sub(MOST_LIGHTS);
        }
        Ok(())
    }

    /// Adds to `plan`, which was started for `light`, number `number` of the frame, what is drawn of its volumes.
    pub(super) fn add_draws(
        &self,
        plan: &mut Plan,
        scope: &Scope,
        (casters, uploaded): (&[Caster], &ShadowCasters),
        seen: &Seen,
        (number, light): (u32, &Light),
        options: &ShadowOptions,
    ) {
        if self.failure.is_some() {
            return;
        }
        let (batch, l) = self.place_of(number as usize);
        let is_facing = |caster| batch.is_facing(&self.tables, caster, l);
        let casters = (casters, uploaded, self.tables.casters.as_slice());
        volumes::add(plan, scope, casters, seen, (number, light.position), is_facing, (options, self.may_sum));
    }

    /// Uploads what the frame began with.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`].
    pub(super) fn upload(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        if let Some(failure) = self.failure.take() {
            return Err(failure);
        }
        self.batches_in_use().iter().for_each(|batch| batch.upload(gpu));
        Ok(())
    }

    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: &mut PassTimer) {
        for (vertex, range) in &self.copies {
            self.tables.positions.copy(encoder, &self.vertices, *vertex, range.clone());
        }
        for batch in self.batches_in_use() {
            self.pass.draw(encoder, &self.tables, batch, timer);
        }
    }

    pub(super) fn drawn_with(&self, light: usize) -> DrawnWith {
        let (batch, l) = self.place_of(light);
        DrawnWith::Tables { group: batch.of_volumes(&self.tables, l).clone() }
    }

    fn place_of(&self, light: usize) -> (&Batch, usize) {
        (&self.batches[light / MOST_LIGHTS], light % MOST_LIGHTS)
    }

    fn batches_in_use(&self) -> &[Batch] {
        &self.batches[..self.light_count.div_ceil(MOST_LIGHTS)]
    }
}

/// Positions that somebody else draws.
fn shared_positions(uploaded: &ShadowCasters) -> Option<&Table> {
    uploaded.displaced().map(|displaced| &displaced.positions)
}

/// For each caster, whether the CPU may know nothing but its box.
fn are_anywhere(uploaded: &ShadowCasters) -> Vec<bool> {
    let is_displaced = |i: usize| uploaded.displaced().is_some_and(|displaced| displaced.casters[i]);
    (0..uploaded.blocks.len()).map(|i| is_displaced(i) || moves_in_buffer(uploaded, i)).collect()
}

/// Whether caster `i` may be elsewhere in the buffer of vertices than the CPU has it: on devices that compute, which [`crate::GpuPoser`] needs.
fn moves_in_buffer(uploaded: &ShadowCasters, i: usize) -> bool {
    uploaded.vertices.usage().contains(wgpu::BufferUsages::COPY_SRC) && uploaded.has_moved[i].load(Ordering::Relaxed)
}

/// Calls `make` with what draws volumes of tables.
pub(super) fn drawn_from<T>(gpu: &Gpu, make: impl FnOnce(DrawnFrom<'_>) -> T) -> T {
    let module = shaders::found_basic_volume(&gpu.device);
    make(DrawnFrom { module: &module, layout: &pass::volume_layout(gpu) })
}
