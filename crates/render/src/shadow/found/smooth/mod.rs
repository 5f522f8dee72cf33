//! Smooth silhouettes by compute shaders, for bodies whose casters may be moved on the GPU.
//!
//! ```text
//! plan       jobs, from boxes        CPU
//! record     find_normals            each wedge of what has moved
//!            find_inner_places       the same: where pieces of its surface begin
//!            find_heights            each wedge: how far the light is above its tangent plane
//!            find_crossings          each edge between wedges: a point of the silhouette
//!            find_faces              each triangle: light cap, fold, fin and side, and what is on the wrong side of it
//!            find_creases            each crease: the side along it, the cone that closes it, and the same
//!            find_smooth_arguments   z-pass or z-fail, and how much is drawn
//! ```
//!
//! The same shadow as that of [`umbrae_core::SmoothVolume`], within rounding. The CPU leaves pieces that are on the wrong side of the silhouette where they are
//! if what is far behind them is dark anyway, as it has fewer sides to draw then. Here all of them go over, which counts more than 0 in the same places, but for what
//! is just behind such a piece: the body's own surface, where it is nearly edge on to the light and a little more of it is dark.
//! Everything is taken from one table of heights and one of crossings, so that it is closed.
//! There is room for a silhouette through every triangle and along every crease, uncut, with all of its pieces on the wrong side, and for [`inner_room`]
//! points besides that cut them; what would need more is left uncut: coarser there, and as closed.
//!
//! A smooth volume counts less than 0 in places, which must not take from others' counts, and how often it overlaps itself is not known here. So each is added up
//! alone in the float target ([`super::ShadowSums`]), and what is not 0 there is dark before the next begins.
//!
//! Source: O. Mattausch et al. 2012, section 4, who subdivide their loops in a geometry shader.

mod pipelines;
mod read;
mod tables;

use std::sync::atomic::Ordering;

use umbrae_core::{
    Bounds, Case, Caster, Counting, LightPosition, OnScreen, PixelRect, Precision, SmoothTables, Smoothness, Windings,
};
use wgpu::util::DeviceExt as _;

pub(crate) use pipelines::{SmoothDrawing, SmoothShape};
pub use read::FoundSmoothSilhouette;

use super::jobs::{self, DarkCap, Job};
use crate::growing::GrowingBuffer;
use crate::passes::{FindSmoothPass, SmoothAmounts, SmoothJobSlot, SmoothJobUniform, smooth_flags, smooth_job_offset};
use crate::shadow::ShadowCasters;
use crate::shadow::casters::Block;
use crate::shadow::options::ShadowOptions;
use crate::shadow::plan::{Plan, Scope, Seen, rect_by_culling};
use crate::shadow::report::CasterReport;
use crate::timing::PassTimer;
use crate::{Gpu, GpuError};
use pipelines::{draw_group, draw_layout};
use tables::{BodyTables, Tables};

/// Of `SmoothResult` in `find_smooth.wgsl`.
pub(crate) const SMOOTH_RESULT_BYTES: u64 = 32 + 16 * SmoothShape::ALL.len() as u64;

/// Points of each crossing.
const CROSSING_POINTS: u64 = 3;
/// Of a crossed triangle, with one side: fin, its end, and two of the fold; and its three pieces, if all are on the wrong side.
const FACES_OF_TRIANGLE: u64 = 4 + 3;
/// Of a crossed triangle whose curve has n = 1 sides, 3 n + 3. There is a side where one of two neighbouring pieces goes over and the other does not, and on the curve where
/// both do or neither does: n on the curve, 2 (n - 1) within the fans of lit pieces and of dark ones, 4 at their ends, and 2 more of the last piece. One of these 3 n + 4 is
/// always missing. If the last piece does not go over, its own two; if it does and its neighbour in the fan does too, the one between them; and if that does not, the
/// curve's last, or the end of the other fan.
const SIDES_OF_TRIANGLE: u64 = 6;
/// Of a crease: where both sides are crossed, two for each one's way from the upper end to the silhouette and back, a piece for each that may be on the wrong side, and
/// one for the only run that has none of its ends at the lower end.
const FACES_OF_CREASE: u64 = 2 * 2 + 2 + 1;
/// Of a crease: three for each of these pieces, five for that run if it is on the wrong side of what is lit and of what is dark, and one for a run that starts at the
/// lower end.
const SIDES_OF_CREASE: u64 = 2 * 3 + 5 + 1;
/// Of each point that cuts a curve in two. In a triangle: a fin, a lit piece and a dark one, and 3 sides. Of a crease: all of a run's.
const FACES_OF_CUT: u64 = 3;
const SIDES_OF_CUT: u64 = 5;

/// So many points may cut the silhouette of a body of so many triangles: thousands for a small one, which has few and long pieces, and not many more for a large one,
/// few of whose triangles are crossed.
fn inner_room(triangles: u32) -> u32 {
    4096 + triangles / 4
}

/// Everything that is kept from frame to frame.
#[derive(Debug)]
pub(super) struct SmoothFinder {
    of_casters: Vec<Option<BodyTables>>,
    /// What bodies were given when this was made.
    given: u64,
    table_words: wgpu::Buffer,
    normals: wgpu::Buffer,
    positions: wgpu::Buffer,
    pass: FindSmoothPass,
    layout: wgpu::BindGroupLayout,
    slots: GrowingBuffer,
    heights: GrowingBuffer,
    points: GrowingBuffer,
    lists: GrowingBuffer,
    results: GrowingBuffer,
    /// For finding; `None` as long as nothing was.
    group: Option<wgpu::BindGroup>,
    /// For drawing.
    drawn: Option<wgpu::BindGroup>,
    staged: Staged,
}

/// What one frame finds.
#[derive(Debug, Default)]
struct Staged {
    smoothness: Option<Smoothness>,
    /// Of casters that stand for bodies: what holds their curves.
    loose: Vec<Option<Bounds>>,
    jobs: Vec<Job>,
    slots: Vec<SmoothJobSlot>,
    amounts: Vec<SmoothAmounts>,
    /// Whether a job of the caster computes its normals.
    has_normals: Vec<bool>,
    lengths: Lengths,
}

/// How much is used of each buffer.
#[derive(Debug, Clone, Copy, Default)]
struct Lengths {
    heights: u64,
    points: u64,
    list: u64,
}

/// One smooth body under one light, as it is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FoundSmooth {
    /// Among the jobs of all lights.
    number: u32,
    pub(crate) rect: PixelRect,
    may_pass: bool,
    may_fail: bool,
    dark_cap: DarkCap,
    shows_light_cap: bool,
}

/// What smooth volumes are drawn with: a group with the offset of a job, and the buffer of arguments.
#[derive(Debug, Clone)]
pub(crate) struct SmoothDrawnWith {
    group: wgpu::BindGroup,
    arguments: wgpu::Buffer,
}

impl FoundSmooth {
    /// Records its draws.
    pub(super) fn draw(self, pass: &mut wgpu::RenderPass<'_>, drawing: &SmoothDrawing, with: &SmoothDrawnWith) {
        crate::shadow::set_scissor(pass, self.rect);
        pass.set_bind_group(2, &with.group, &[smooth_job_offset(self.number)]);
        for shape in SmoothShape::ALL.into_iter().filter(|shape| self.needs(*shape)) {
            let offset = SMOOTH_RESULT_BYTES * u64::from(self.number) + 32 + 16 * shape as u64;
            pass.set_pipeline(drawing.of(shape));
            pass.draw_indirect(&with.arguments, offset);
        }
    }

    fn needs(self, shape: SmoothShape) -> bool {
        match shape {
            SmoothShape::SidesInPass | SmoothShape::FacesInPass => self.may_pass,
            SmoothShape::SidesInFail | SmoothShape::FacesInFail => self.may_fail,
            SmoothShape::Fan => self.may_fail && self.dark_cap == DarkCap::Fan,
            SmoothShape::DarkCaps | SmoothShape::DarkFaces => self.may_fail && self.dark_cap == DarkCap::Projected,
            SmoothShape::LightCap => self.may_fail && self.shows_light_cap,
        }
    }
}

impl SmoothFinder {
    /// `None` where no caster stands for a body that can be found here.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`].
    pub(super) fn new(gpu: &Gpu, uploaded: &ShadowCasters) -> Result<Option<Self>, GpuError> {
        let tables = Tables::new(&uploaded.bodies);
        if tables.of_casters.iter().all(Option::is_none) {
            return Ok(None);
        }
        let upload = |label, contents: &[u8]| {
            gpu.ensure_buffer_fits(contents.len())?;
            gpu.ensure_binding_fits(contents.len() as u64)?;
            let usage = wgpu::BufferUsages::STORAGE;
            let descriptor = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
            Ok(gpu.device.create_buffer_init(&descriptor))
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let read = storage | wgpu::BufferUsages::COPY_SRC;
        let growing = |label, usage| GrowingBuffer::new(gpu, label, usage);
        Ok(Some(Self {
            given: uploaded.bodies_given(),
            table_words: upload("tables of smooth bodies", bytemuck::cast_slice(&tables.words))?,
            normals: upload("normals of smooth bodies", bytemuck::cast_slice(&tables.normals))?,
            of_casters: tables.of_casters,
            positions: uploaded.vertices.clone(),
            pass: FindSmoothPass::new(gpu),
            layout: draw_layout(gpu),
            slots: growing("smooth jobs", wgpu::BufferUsages::UNIFORM),
            heights: growing("heights above tangent planes", storage),
            points: growing("points of smooth silhouettes", read),
            lists: growing("smooth sides, faces and caps", read),
            results: growing("smooth results", read | wgpu::BufferUsages::INDIRECT),
            group: None,
            drawn: None,
            staged: Staged::default(),
        }))
    }

    /// Starts a frame. Linear in the edges of what has moved, whose longest one is looked for.
    pub(super) fn start(&mut self, casters: &[Caster], uploaded: &ShadowCasters, seen: &Seen, options: &ShadowOptions) {
        let staged = &mut self.staged;
        staged.jobs.clear();
        staged.slots.clear();
        staged.amounts.clear();
        staged.lengths = Lengths::default();
        staged.has_normals.clear();
        staged.has_normals.resize(casters.len(), false);
        // Bodies that were given since are others than those in the tables.
        let is_current = self.given == uploaded.bodies_given();
        staged.smoothness = options.smooth.smoothness(&seen.camera, seen.bounds).filter(|_| is_current);
        staged.loose.clear();
        if staged.smoothness.is_some() {
            staged.loose.extend(casters.iter().enumerate().map(|(i, caster)| {
                let body = uploaded.bodies[i].as_ref().filter(|_| self.of_casters[i].is_some())?;
                let has_left = uploaded.has_left_body[i].load(Ordering::Relaxed);
                Some(if has_left { body.loose_bounds_at(caster) } else { body.loose_bounds() })
            }));
        }
    }

    /// Adds caster `i` under light `number` to what is found, and to `plan`. `None` where it casts the shadow of its triangles: if it stands for no
    /// body, or if the light or the near rectangle is inside of it, where its count may be another than 0 in the light. (Of what has moved: in its box.)
    ///
    /// Takes longer, linear in the number of triangles, where the light or the near rectangle is in the box of what stands.
    #[expect(clippy::too_many_arguments, reason = "one caller; a struct would only repeat the names")]
    pub(super) fn add(
        &mut self,
        plan: &mut Plan,
        (i, caster, block): (usize, &Caster, Block),
        uploaded: &ShadowCasters,
        scope: &Scope,
        seen: &Seen,
        (number, light): (u32, LightPosition),
        options: &ShadowOptions,
    ) -> Option<CasterReport> {
        let staged = &mut self.staged;
        let smoothness = staged.smoothness.as_ref()?;
        let (loose, body) = (staged.loose[i]?, self.of_casters[i]?);
        if !caster.role.casts {
            return None;
        }
        let rect = match rect_by_culling(&loose, &scope.culler, options, scope.rect) {
            Ok(rect) => rect,
            Err(fate) => return Some(CasterReport::of_fate(fate)),
        };
        let job = jobs::job((caster, loose), block, scope, &seen.camera, light, options);
        let has_left = uploaded.has_left_body[i].load(Ordering::Relaxed);
        // Of what has moved only the box is sure, as where its triangles are the GPU knows alone.
        let is_outside = if has_left {
            jobs::is_apart_from_ends(caster, &job, &seen.camera, light)
        } else {
            let windings = [Windings::of_near_rectangle(caster, &seen.camera), Windings::of_light(caster, light)];
            let counting = Counting::choose(caster, &windings[0], &windings[1]);
            counting.iter().all(|&counting| counting == Counting::Facing)
        };
        if !is_outside {
            return None;
        }
        let job = Job { caster: i as u32, light: number, ..job };
        let own = staged.slots.len() as u32;
        let moved_wedges = if has_left && !staged.has_normals[i] {
            staged.has_normals[i] = true;
            body.wedge_count
        } else {
            0
        };
        staged.amounts.push(SmoothAmounts {
            moved_wedges,
            wedges: body.wedge_count,
            edges: body.edge_count,
            triangles: body.triangle_count,
            creases: body.crease_count,
        });
        let uniform = uniform(&job, own, &body, (light, caster.bounds.radius()), smoothness, &mut staged.lengths);
        staged.slots.push(SmoothJobSlot { job: uniform, unused: [[0; 4]; 5] });
        staged.jobs.push(job);
        plan.found_smooth.push(FoundSmooth {
            number: own,
            rect,
            may_pass: job.may_pass(),
            may_fail: job.may_fail(),
            dark_cap: job.dark_cap,
            shows_light_cap: job.shows_light_cap,
        });
        Some(jobs::report(&job, options, rect))
    }

    /// Uploads what was added.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the lists are larger than shaders can be given.
    pub(super) fn upload(
        &mut self,
        gpu: &Gpu,
        finding: &wgpu::Buffer,
        lights: &wgpu::Buffer,
        is_other: bool,
    ) -> Result<(), GpuError> {
        let staged = &self.staged;
        if staged.slots.is_empty() {
            // What it was made with may be gone by the next frame.
            self.group = self.group.take().filter(|_| !is_other);
            return Ok(());
        }
        let Lengths { heights, points, list } = staged.lengths;
        let mut is_other = is_other || self.group.is_none();
        is_other |= self.heights.grow_to(gpu, 4 * heights)?;
        is_other |= self.points.grow_to(gpu, 16 * points)?;
        is_other |= self.lists.grow_to(gpu, 4 * list)?;
        is_other |= self.results.grow_to(gpu, SMOOTH_RESULT_BYTES * staged.slots.len() as u64)?;
        is_other |= self.slots.fill(gpu, bytemuck::cast_slice(&staged.slots))?;
        if is_other {
            let (slots, points, lists) = (self.slots.buffer(), self.points.buffer(), self.lists.buffer());
            let buffers = [
                finding,
                slots,
                &self.table_words,
                &self.positions,
                lights,
                &self.normals,
                self.heights.buffer(),
                points,
                lists,
                self.results.buffer(),
            ];
            self.group = Some(self.pass.group(gpu, buffers));
            let drawn = [slots, &self.table_words, &self.positions, points, lists];
            self.drawn = Some(draw_group(gpu, &self.layout, drawn));
        }
        Ok(())
    }

    /// Records the finding, as a pass of its own that is timed.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: &mut PassTimer) {
        let staged = &self.staged;
        let Some(group) = self.group.as_ref().filter(|_| !staged.slots.is_empty()) else { return };
        let used = SMOOTH_RESULT_BYTES * staged.slots.len() as u64;
        encoder.clear_buffer(self.results.buffer(), 0, Some(used));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("smooth silhouettes"),
            timestamp_writes: timer.compute_writes("smooth silhouettes"),
        });
        self.pass.draw(&mut pass, group, &staged.amounts);
    }

    pub(super) fn drawn_with(&self) -> Option<SmoothDrawnWith> {
        let with = |group: &wgpu::BindGroup| SmoothDrawnWith {
            group: group.clone(),
            arguments: self.results.buffer().clone(),
        };
        self.drawn.as_ref().map(with)
    }
}

/// What shaders are told of `job`, which is number `number`; takes room in the lists.
fn uniform(
    job: &Job,
    number: u32,
    body: &BodyTables,
    (light, radius_m): (LightPosition, f64),
    smoothness: &Smoothness,
    lengths: &mut Lengths,
) -> SmoothJobUniform {
    let flags = [
        (matches!(smoothness, Smoothness::Smooth(_)), smooth_flags::CURVED),
        (job.needs_caps(), smooth_flags::NEEDS_CAPS),
        (job.case.is_none(), smooth_flags::UNDECIDED),
        (matches!(job.case, Some(Case::Fail | Case::FailWithoutLightCap)), smooth_flags::FAILS),
        (light.is_directional(), smooth_flags::DIRECTIONAL),
    ];
    let inner_room = inner_room(body.triangle_count);
    let (triangles, creases, inner) = (body.triangle_count.into(), u64::from(body.crease_count), inner_room.into());
    let sides = SIDES_OF_TRIANGLE * triangles + SIDES_OF_CREASE * creases + SIDES_OF_CUT * inner;
    let faces = FACES_OF_TRIANGLE * triangles + FACES_OF_CREASE * creases + FACES_OF_CUT * inner;
    // What does not fit into 32 bits is refused with the lists.
    let take = |from: &mut u64, count: u64| {
        let first = *from;
        *from += count;
        first as u32
    };
    let (epsilon_m, on_screen) = match smoothness {
        Smoothness::Accurate => (1.0, None),
        Smoothness::Smooth(Precision { epsilon_m, on_screen }) => (*epsilon_m, on_screen.as_ref()),
    };
    let nothing = OnScreen { epsilon_px: 0.0, eye: glam::DVec3::ZERO, pixel_at_1: 0.0, receivers: job.bounds };
    let OnScreen { epsilon_px, eye, pixel_at_1, receivers } = on_screen.unwrap_or(&nothing);
    SmoothJobUniform {
        position_world: light.homogeneous().as_vec4().to_array(),
        eye_world: eye.as_vec3().to_array(),
        pixel_at_1: *pixel_at_1 as f32,
        receivers_min: receivers.min.as_vec3().to_array(),
        epsilon_m: epsilon_m as f32,
        receivers_max: receivers.max.as_vec3().to_array(),
        epsilon_px: *epsilon_px as f32,
        near: job.block.first_vertex + job.block.near(0),
        axes: job.block.first_vertex,
        flags: flags.iter().filter(|(is_set, _)| *is_set).fold(0, |bits, (_, bit)| bits | bit),
        number,
        light: job.light,
        slack: job.slack_m,
        most_inset_m: (SmoothTables::MOST_INSET * radius_m) as f32,
        inner_room,
        vertices: body.vertices,
        corner_starts: body.corner_starts,
        wedge_count: body.wedge_count,
        triangles: body.triangles,
        triangle_edges: body.triangle_edges,
        triangle_count: body.triangle_count,
        edges: body.edges,
        edge_triangles: body.edge_triangles,
        bends: body.bends,
        edge_count: body.edge_count,
        creases: body.creases,
        crease_count: body.crease_count,
        normals: body.normals,
        heights: take(&mut lengths.heights, body.wedge_count.into()),
        crossings: take(&mut lengths.points, CROSSING_POINTS * u64::from(body.edge_count)),
        inner: take(&mut lengths.points, inner),
        sides: take(&mut lengths.list, 2 * sides),
        faces: take(&mut lengths.list, 3 * faces),
        caps: take(&mut lengths.list, if job.needs_caps() { triangles } else { 0 }),
        inner_places: take(&mut lengths.points, body.wedge_count.into()),
    }
}
