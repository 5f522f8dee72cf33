//! What is told from boxes on the CPU before silhouettes are found on the GPU: which casters matter to a light, how each may be counted, and what
//! must be drawn of it. Nothing here looks at a triangle.
//!
//! A caster is counted in the stencil where it provably can't overlap itself more often than 127 times and there are few such, else by
//! addition in a float target. `core/src/overlap.rs` has better bounds, which take a look at the silhouette.

use glam::DVec3;
use umbrae_core::{Bounds, Camera, Case, Caster, LightPosition, PixelRect};

use super::smooth::SmoothFinder;
use crate::shadow::casters::{Block, ShadowCasters};
use crate::shadow::emit::{FAN_RADII, Part};
use crate::shadow::options::{Method, ShadowOptions};
use crate::shadow::plan::{MOST_OVERLAPS, Plan, Scope, Seen, casting_rect};
use crate::shadow::report::{CasterReport, Fate, Why};

/// One caster under one light, whose silhouette is to be found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Job {
    pub(crate) caster: u32,
    pub(crate) light: u32,
    pub(crate) block: Block,
    /// z-pass or z-fail where that is known; `None` where triangles must be tested.
    pub(crate) case: Option<Case>,
    pub(crate) dark_cap: DarkCap,
    pub(crate) shows_light_cap: bool,
    /// Caps are compared with depth, and every triangle counts; see [`crate::shadow::emit`].
    pub(crate) is_see_through: bool,
    /// Nearer to a triangle's plane than this (of a directional light: with a lower cosine) the light is in it.
    pub(crate) edge_on: f32,
    /// Boxes are widened by this, in metres.
    pub(crate) slack_m: f32,
    /// The caster's box.
    pub(crate) bounds: Bounds,
}

/// What closes a volume at infinity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DarkCap {
    /// Nothing: it is not needed, or out of view.
    None,
    /// A triangle for each side, about the direction through the middle of the caster's box.
    Fan,
    /// The chain itself.
    Projected,
}

impl Job {
    pub(crate) fn may_pass(&self) -> bool {
        matches!(self.case, None | Some(Case::Pass))
    }

    pub(crate) fn may_fail(&self) -> bool {
        self.case != Some(Case::Pass)
    }

    /// Whether the triangles of the chain are drawn.
    pub(crate) fn needs_caps(&self) -> bool {
        let is_projected = self.dark_cap == DarkCap::Projected;
        self.is_see_through || (self.may_fail() && (self.shows_light_cap || is_projected))
    }
}

/// What of a found volume is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Shape {
    Sides,
    /// The dark cap as a fan.
    Fan,
    /// The dark cap as the chain at infinity.
    Projected,
    /// The light cap, turned to the light.
    LightCap,
    /// The light cap as its mesh has it: triangles that are wound as the volume needs them.
    Faced,
    /// The light cap as its mesh has it: the others.
    Turned,
}

/// Triangles of one job that are counted in one way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FoundDraw {
    pub(crate) part: Part,
    pub(crate) shape: Shape,
    /// Number of the [`Job`] among those of all lights, or of the light.
    pub(crate) job: u32,
    pub(crate) amount: Amount,
    pub(crate) rect: PixelRect,
}

impl FoundDraw {
    /// Draws are in this order, so that pipelines change seldom.
    pub(crate) fn order(&self) -> (Part, Shape, u32) {
        (self.part, self.shape, self.job)
    }
}

/// How many vertices are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Amount {
    /// As many as the GPU says.
    Found(Count),
    /// All that there might be, in so many copies.
    AtMost { first_vertex: u32, end_vertex: u32, copies: u32 },
}

/// How many vertices are drawn: which of a job's counts, which only the GPU knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Count {
    /// Those of sides, where the caster is counted by z-pass.
    SidesInPass,
    /// Those of sides, where it is counted by z-fail; and so on.
    SidesInFail,
    DarkCapInFail,
    LightCapInPass,
    LightCapInFail,
}

impl Count {
    /// How many there are.
    pub(crate) const ALL: u32 = 5;
}

/// `core/src/chain.rs` has the same, for `f64`.
const EDGE_ON: f64 = 4e-7;
/// What `core/src/winding.rs` widens by, and as much again for reasoning in `f32` about the widened.
const SLACK: f64 = 8e-6;

/// With more batches than this, a float target for the rest costs less than a look at every pixel between each two.
const MOST_BATCHES: usize = 3;

/// Adds to `jobs` those of `light`, but for casters that `smooth` finds, which is number `number` and for which `plan` was started, and to `plan` what is drawn of them.
#[expect(clippy::too_many_arguments, reason = "one caller; a struct would only repeat the names")]
pub(super) fn add(
    jobs: &mut Vec<Job>,
    plan: &mut Plan,
    scope: &Scope,
    (casters, uploaded): (&[Caster], &ShadowCasters),
    seen: &Seen,
    (number, light): (u32, LightPosition),
    options: &ShadowOptions,
    mut smooth: Option<&mut SmoothFinder>,
) {
    for (i, (caster, &block)) in casters.iter().zip(&uploaded.blocks).enumerate() {
        if let Some(smooth) = &mut smooth
            && let Some(report) = smooth.add(plan, (i, caster, block), uploaded, scope, seen, (number, light), options)
        {
            plan.casters.push(report);
            continue;
        }
        let rect = match casting_rect(caster, &scope.culler, options, scope.rect) {
            Ok(rect) => rect,
            Err(fate) => {
                plan.casters.push(CasterReport::of_fate(fate));
                continue;
            }
        };
        let job = job((caster, caster.bounds), block, scope, &seen.camera, light, options);
        let job = Job { caster: i as u32, light: number, ..job };
        let most_overlaps = most_overlaps(caster, &job, &seen.camera, light);
        let amounts = |_, count| std::iter::once(Amount::Found(count));
        add_draws(plan, (&job, jobs.len() as u32), (most_overlaps, true), rect, amounts);
        plan.casters.push(report(&job, options, rect));
        jobs.push(job);
    }
}

pub(super) fn report(job: &Job, options: &ShadowOptions, rect: PixelRect) -> CasterReport {
    let fate = match (job.case, options.method) {
        (None, _) => Fate::DrawnAsFound,
        (Some(case), Method::ZPass | Method::ZFail) => Fate::Drawn { case, why: Why::Method },
        (Some(case @ Case::Pass), _) => Fate::Drawn { case, why: Why::NearRectangleClear },
        (Some(case), _) => Fate::Drawn { case, why: Why::NearRectangleMayBeShaded },
    };
    CasterReport { rect: Some(rect), ..CasterReport::of_found(fate) }
}

/// What is told of one caster, whose volume starts in `bounds`, and light from boxes; neither of them is numbered.
pub(super) fn job(
    (caster, bounds): (&Caster, Bounds),
    block: Block,
    scope: &Scope,
    camera: &Camera,
    light: LightPosition,
    options: &ShadowOptions,
) -> Job {
    let shows_light_cap = !options.cull_caps || scope.culler.light_cap_may_show(&bounds);
    let shows_dark_cap = !options.cull_caps || scope.culler.dark_cap_may_show(&bounds);
    let zfail = if shows_light_cap { Case::Fail } else { Case::FailWithoutLightCap };
    let case = match options.method {
        Method::ZPass => Some(Case::Pass),
        Method::ZFail => Some(zfail),
        Method::Auto | Method::EyeCount => (scope.chooser.case_of_bounds(&bounds) == Case::Pass).then_some(Case::Pass),
    };
    let dark_cap = if light.is_directional() || !shows_dark_cap || case == Some(Case::Pass) {
        DarkCap::None
    } else if light.offset_from(bounds.center()).length() >= FAN_RADII * bounds.radius() {
        DarkCap::Fan
    } else {
        DarkCap::Projected
    };
    let reach = |p: DVec3| p.abs().max_element();
    let of_caster = reach(bounds.min).max(reach(bounds.max));
    let of_light = if light.is_directional() { 0.0 } else { reach(light.homogeneous().truncate()) };
    let edge_on = if light.is_directional() { EDGE_ON } else { EDGE_ON * of_caster.max(of_light) };
    Job {
        caster: 0,
        light: 0,
        block,
        case,
        dark_cap,
        shows_light_cap,
        is_see_through: caster.role.is_see_through(),
        edge_on: edge_on as f32,
        slack_m: (SLACK * of_caster.max(of_light).max(reach(camera.eye()))) as f32,
        bounds,
    }
}

/// A number that the count of the job's volume reaches nowhere above.
///
/// A path meets each triangle at most once, and every second one that it meets of a closed surface faces away.
fn most_overlaps(caster: &Caster, job: &Job, camera: &Camera, light: LightPosition) -> u32 {
    let triangles = caster.mesh.triangles().len() as u32;
    let is_closed = caster.topology.components().iter().all(|component| component.is_closed);
    let counts_facing = is_closed && !job.is_see_through && is_apart_from_ends(caster, job, camera, light);
    if counts_facing { triangles / 2 } else { triangles }
}

/// Whether neither the light nor the near rectangle comes near the caster's box, so that neither is inside of it.
pub(super) fn is_apart_from_ends(caster: &Caster, job: &Job, camera: &Camera, light: LightPosition) -> bool {
    // Twice, so that what is clear here is clear to the device too, which rounds.
    let slack = 2.0 * DVec3::splat(job.slack_m.into());
    let widened = Bounds { min: caster.bounds.min - slack, max: caster.bounds.max + slack };
    let is_at_light = !light.is_directional() && widened.meets(&Bounds::of_points([light.homogeneous().truncate()]));
    let is_at_eye = widened.meets(&Bounds::of_points(camera.near_rectangle()));
    !is_at_light && !is_at_eye
}

/// Adds to `plan` what is drawn of `job`, as number `number`, where its volume, or this part of it, overlaps itself at most so many times; `amounts`
/// are those of a shape. Without `may_sum`, the stencil must count all.
pub(super) fn add_draws<I: Iterator<Item = Amount>>(
    plan: &mut Plan,
    (job, number): (&Job, u32),
    (most_overlaps, may_sum): (u32, bool),
    rect: PixelRect,
    amounts: impl Fn(Shape, Count) -> I,
) {
    let has_batch = !may_sum || plan.batches.len() < MOST_BATCHES || plan.has_room(most_overlaps);
    let fits_stencil = most_overlaps <= MOST_OVERLAPS && has_batch;
    if fits_stencil {
        plan.batch_for(most_overlaps);
    }
    let draws = if fits_stencil { &mut plan.found } else { &mut plan.summed };
    let mut add = |part, shape, count| {
        let of_amount = |amount| FoundDraw { part, shape, job: number, amount, rect };
        draws.extend(amounts(shape, count).map(of_amount));
    };
    if job.may_pass() {
        add(Part::Pass, Shape::Sides, Count::SidesInPass);
    }
    if job.may_fail() {
        add(Part::Fail, Shape::Sides, Count::SidesInFail);
        match job.dark_cap {
            DarkCap::None => {}
            DarkCap::Fan => add(Part::Fail, Shape::Fan, Count::DarkCapInFail),
            DarkCap::Projected => add(Part::Fail, Shape::Projected, Count::DarkCapInFail),
        }
    }
    if job.is_see_through {
        if job.may_pass() {
            add(Part::Pass, Shape::Faced, Count::LightCapInPass);
            add(Part::PassTurned, Shape::Turned, Count::LightCapInPass);
        }
        if job.may_fail() {
            add(Part::Fail, Shape::Faced, Count::LightCapInFail);
            add(Part::FailTurned, Shape::Turned, Count::LightCapInFail);
        }
    } else if job.may_fail() && job.shows_light_cap {
        add(Part::LightCap, Shape::LightCap, Count::LightCapInFail);
    }
    if fits_stencil {
        let end = plan.found.len();
        plan.batches.last_mut().expect("one was made room in").found.end = end;
    }
}
