//! What one light draws: each caster's fate, case and faces, in batches that the stencil can count.
//!
//! ```text
//! batch 1     counts of some casters, which overlap at most 127 times
//! fold        where the count is not 0, the mark goes: dark, and no later volume need look
//! batch 2     …
//! ```
//!
//! Sources: M. McGuire et al. 2003, section 6 and figure 4, for cases and culling; the lecture notes, section 3, for counting from
//! the eye. The batches are ours: the papers let an 8-bit stencil wrap. Any part of a chain casts a volume that is closed and counts no less
//! than 0, so that a point is lit exactly where every part counts 0, however a caster is split.

use std::sync::OnceLock;

use umbrae_core::{
    Bounds, Camera, Case, CaseChooser, Caster, Chain, Counting, Culler, Light, LightPosition, PixelRect, Reach,
    ShadowVolume, Sphere, Windings, most_overlaps, split_chain,
};

use super::casters::{Block, ShadowCasters, VolumeVertex};
use super::emit::{Indices, Part, emit};
use super::found::FoundDraw;
use super::options::{LightMark, Method, ShadowOptions};
use super::report::{CasterReport, Fate, Why};
use super::spheres::{is_shut_in, rounded_to_f32};

/// Seven bits count; the eighth is the mark.
pub(super) const MOST_OVERLAPS: u32 = 127;

/// What a camera sees of casters, whatever the light.
#[derive(Debug)]
pub(crate) struct Seen {
    pub(crate) camera: Camera,
    bounds: Bounds,
    /// Of all casters; found when first asked for.
    windings: OnceLock<Vec<Windings>>,
    /// As the shaders see them.
    pub(super) spheres: Vec<Sphere>,
}

impl Seen {
    pub(crate) fn new(camera: &Camera, casters: &[Caster], spheres: &[Sphere]) -> Self {
        let spheres = spheres.iter().map(rounded_to_f32).collect();
        let mut seen = Self { camera: *camera, bounds: Bounds::EMPTY, spheres, windings: OnceLock::new() };
        seen.look_from(camera, casters);
        seen
    }

    /// The same spheres and casters, which may have moved, from `camera`.
    pub(super) fn look_from(&mut self, camera: &Camera, casters: &[Caster]) {
        self.camera = *camera;
        let of_casters = Caster::bounds_of(casters);
        self.bounds = self.spheres.iter().fold(of_casters, |bounds, sphere| bounds.union(sphere.bounds()));
        self.windings = OnceLock::new();
    }

    /// Of `casters`, which must be those that this was made for.
    fn windings(&self, casters: &[Caster]) -> &[Windings] {
        let of = |caster| Windings::of_near_rectangle(caster, &self.camera);
        self.windings.get_or_init(|| casters.iter().map(of).collect())
    }
}

/// What one light draws into the stencil.
#[derive(Debug)]
pub(crate) struct Plan {
    /// Where it may change a pixel; `None` draws nothing.
    pub(crate) rect: Option<PixelRect>,
    /// The faces of the reach, three vertices each, for [`LightMark::Exact`] and [`LightMark::Select`]; without any, everything in
    /// the rectangle is marked.
    pub(crate) mark: Vec<VolumeVertex>,
    pub(crate) mark_kind: LightMark,
    pub(crate) batches: Vec<Batch>,
    /// What batches draw besides, of silhouettes found on the GPU.
    pub(crate) found: Vec<FoundDraw>,
    /// Draws of casters that may overlap themselves more often than the stencil counts: added up in a float target.
    pub(crate) summed: Vec<FoundDraw>,
    pub(crate) indices: Indices,
    /// The faces of spheres' volumes, three vertices each.
    pub(crate) loose: Vec<VolumeVertex>,
    pub(crate) casters: Vec<CasterReport>,
    pub(crate) spheres: Vec<CasterReport>,
}

/// What tells, for one light, what matters.
pub(super) struct Scope {
    pub(super) culler: Culler,
    pub(super) chooser: CaseChooser,
    /// Where the light may change a pixel.
    pub(super) rect: PixelRect,
}

/// Volumes that overlap at most [`MOST_OVERLAPS`] times.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    /// How many of the volumes that are counted by z-pass hold the near rectangle.
    pub(crate) start: u32,
    /// Ordered by part, so that pipelines change seldom.
    pub(crate) draws: Vec<Draw>,
    /// Of [`Plan::found`].
    pub(crate) found: std::ops::Range<usize>,
    overlaps: u32,
}

/// Where triangles come from; in the order in which they are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Source {
    /// 32-bit indices.
    Long,
    /// 16-bit indices.
    Short,
    /// Vertices in a row, without indices.
    Loose,
}

/// Triangles of one caster that are counted in one way.
#[derive(Debug, Clone)]
pub(crate) struct Draw {
    pub(crate) part: Part,
    pub(crate) source: Source,
    /// Indices, or loose vertices.
    pub(crate) elements: std::ops::Range<u32>,
    /// Of indices.
    pub(crate) base_vertex: i32,
    pub(crate) rect: PixelRect,
}

impl Plan {
    /// The plan for `light`, whose position is rounded as shaders see it.
    ///
    /// Linear in the number of triangles of the casters that are not culled.
    pub(crate) fn new(
        casters: &[Caster],
        uploaded: &ShadowCasters,
        seen: &Seen,
        light: &Light,
        options: &ShadowOptions,
    ) -> Self {
        let mut plan = Self::empty(options);
        let Some(scope) = plan.start(casters, seen, light, options) else { return plan };
        let (culler, chooser, rect) = (&scope.culler, &scope.chooser, scope.rect);
        for ((caster, windings), &block) in casters.iter().zip(seen.windings(casters)).zip(&uploaded.blocks) {
            let report = match casting_rect(caster, culler, options, rect) {
                Err(fate) => CasterReport::of_fate(fate),
                Ok(rect) => {
                    let planner = CasterPlanner { caster, windings, block, culler, chooser, rect };
                    planner.add_to(&mut plan, light.position, options)
                }
            };
            plan.casters.push(report);
        }
        plan.add_spheres(seen, light.position, (culler, chooser), options, rect);
        plan.sort();
        plan
    }

    /// Nothing.
    pub(super) fn empty(options: &ShadowOptions) -> Self {
        Self {
            rect: None,
            mark: Vec::new(),
            mark_kind: options.light_mark,
            batches: Vec::new(),
            found: Vec::new(),
            summed: Vec::new(),
            indices: Indices::default(),
            loose: Vec::new(),
            casters: Vec::new(),
            spheres: Vec::new(),
        }
    }

    /// Starts over for `light`, in the memory that there is. `None` where it draws nothing, which is told of all casters then.
    pub(super) fn start(
        &mut self,
        casters: &[Caster],
        seen: &Seen,
        light: &Light,
        options: &ShadowOptions,
    ) -> Option<Scope> {
        let culler = Culler::new(&seen.camera, light, &seen.bounds);
        let whole = PixelRect::whole(seen.camera.size_px());
        let light_rect = if options.light_scissor { culler.light_rect() } else { whole };
        let is_seen = !options.cull_lights || culler.light_may_show();
        let is_shut_in = is_shut_in(light.position, &seen.spheres, &seen.camera);
        self.rect = light_rect.filter(|_| is_seen && !is_shut_in);
        self.mark_kind = options.light_mark;
        self.mark.clear();
        self.batches.clear();
        self.found.clear();
        self.summed.clear();
        self.indices.clear();
        self.loose.clear();
        self.casters.clear();
        self.spheres.clear();
        let Some(rect) = self.rect else {
            self.casters.extend(casters.iter().map(|caster| CasterReport::of_fate(unseen_light(caster))));
            self.spheres.extend(seen.spheres.iter().map(|_| CasterReport::of_fate(Fate::LightUnseen)));
            return None;
        };
        if matches!(options.light_mark, LightMark::Exact | LightMark::Select)
            && let Some(reach) = Reach::of(light)
        {
            self.mark.extend(reach.faces().iter().flatten().map(|v| volume_vertex(*v)));
        }
        let chooser = CaseChooser::new(&seen.camera, light.position, &seen.bounds);
        Some(Scope { culler, chooser, rect })
    }

    /// Puts what is drawn in the order in which the least state changes.
    pub(super) fn sort(&mut self) {
        for batch in &mut self.batches {
            batch.draws.sort_by_key(|draw| (draw.part, draw.source));
            self.found[batch.found.clone()].sort_unstable_by_key(FoundDraw::order);
        }
        self.summed.sort_unstable_by_key(FoundDraw::order);
    }

    /// Whether there is a batch with room for volumes that overlap so many times.
    pub(super) fn has_room(&self, overlaps: u32) -> bool {
        self.batches.last().is_some_and(|batch| batch.overlaps + overlaps <= MOST_OVERLAPS)
    }

    /// A batch with room for volumes that overlap so many times, which is made if need be.
    pub(super) fn batch_for(&mut self, overlaps: u32) -> &mut Batch {
        if !self.has_room(overlaps) {
            let end = self.found.len();
            self.batches.push(Batch { found: end..end, ..Batch::default() });
        }
        let batch = self.batches.last_mut().expect("one was pushed if there was none");
        batch.overlaps += overlaps;
        batch
    }
}

fn unseen_light(caster: &Caster) -> Fate {
    if caster.role.casts { Fate::LightUnseen } else { Fate::NotCasting }
}

pub(super) fn casting_rect(
    caster: &Caster,
    culler: &Culler,
    options: &ShadowOptions,
    light_rect: PixelRect,
) -> Result<PixelRect, Fate> {
    if !caster.role.casts {
        return Err(Fate::NotCasting);
    }
    rect_by_culling(&caster.bounds, culler, options, light_rect)
}

/// The pixels into which the volume of what casts within `bounds` must be drawn, or why it need not be.
pub(super) fn rect_by_culling(
    bounds: &Bounds,
    culler: &Culler,
    options: &ShadowOptions,
    light_rect: PixelRect,
) -> Result<PixelRect, Fate> {
    if options.cull_unreached && !culler.is_reached(bounds) {
        return Err(Fate::Unreached);
    }
    if options.cull_unseen && !culler.may_shade_view(bounds) {
        return Err(Fate::Unseen);
    }
    if !options.caster_scissor {
        return Ok(light_rect);
    }
    culler.shadow_rect(bounds).and_then(|rect| rect.intersection(&light_rect)).ok_or(Fate::Unseen)
}

/// As [`super::casters::VolumeVertex`] has it.
pub(super) fn volume_vertex(homogeneous: glam::DVec4) -> VolumeVertex {
    let kind = if homogeneous.w == 0.0 { 2.0 } else { 0.0 };
    homogeneous.truncate().as_vec3().extend(kind).to_array()
}

/// One caster that is to be drawn.
struct CasterPlanner<'a> {
    caster: &'a Caster,
    windings: &'a Windings,
    block: Block,
    culler: &'a Culler,
    chooser: &'a CaseChooser,
    rect: PixelRect,
}

impl CasterPlanner<'_> {
    fn add_to(&self, plan: &mut Plan, light: LightPosition, options: &ShadowOptions) -> CasterReport {
        let caster = self.caster;
        let chain = Chain::new(caster, light, &self.counting(light));
        let volume = ShadowVolume::new(caster, &chain);
        let mut report = CasterReport::of_fate(Fate::Unseen);
        report.rect = Some(self.rect);
        report.faces_mut().silhouette_edges = volume.silhouette_edges;
        report.faces_mut().chain_triangles = volume.light_cap.len();
        report.index_bytes = if self.block.is_short() { size_of::<u16>() } else { size_of::<u32>() };
        let asked = self.case(options);
        let overlaps = most_overlaps(caster, &volume, light);
        if overlaps <= MOST_OVERLAPS {
            self.add_part(plan, &mut report, (&chain, &volume, overlaps), asked, light, options);
        } else {
            for chain in split_chain(caster, &chain, light, MOST_OVERLAPS) {
                let volume = ShadowVolume::new(caster, &chain);
                let overlaps = most_overlaps(caster, &volume, light);
                self.add_part(plan, &mut report, (&chain, &volume, overlaps), asked, light, options);
            }
        }
        report
    }

    /// How each component counts. What can be seen through is no wall between the eye and a point, so windings say nothing of it.
    fn counting(&self, light: LightPosition) -> Vec<Counting> {
        if self.caster.role.is_see_through() {
            return vec![Counting::Every; self.caster.topology.components().len()];
        }
        Counting::choose(self.caster, self.windings, &Windings::of_light(self.caster, light))
    }

    /// The case, and why; that of [`Method::EyeCount`] may yet change for each part.
    fn case(&self, options: &ShadowOptions) -> (Case, Why) {
        match options.method {
            Method::ZPass => (Case::Pass, Why::Method),
            Method::ZFail => (self.zfail_case(options), Why::Method),
            Method::Auto | Method::EyeCount => match self.chooser.case(self.caster) {
                Case::Pass => (Case::Pass, Why::NearRectangleClear),
                Case::Fail | Case::FailWithoutLightCap => (self.zfail_case(options), Why::NearRectangleMayBeShaded),
            },
        }
    }

    fn zfail_case(&self, options: &ShadowOptions) -> Case {
        let needs_light_cap = !options.cull_caps || self.culler.light_cap_may_show(&self.caster.bounds);
        if needs_light_cap { Case::Fail } else { Case::FailWithoutLightCap }
    }

    fn add_part(
        &self,
        plan: &mut Plan,
        report: &mut CasterReport,
        (chain, volume, overlaps): (&Chain, &ShadowVolume, u32),
        (mut case, mut why): (Case, Why),
        light: LightPosition,
        options: &ShadowOptions,
    ) {
        let mut start = 0;
        if options.method == Method::EyeCount && case != Case::Pass {
            match self.chooser.eye_count(self.caster, chain, volume) {
                None => why = Why::SideCrossesNearRectangle,
                Some(count) => {
                    start = count;
                    (case, why) = (Case::Pass, Why::EyeCounted(count));
                }
            }
        }
        let shows_dark_cap = !options.cull_caps || self.culler.dark_cap_may_show(&self.caster.bounds);
        let emitted =
            emit(&mut plan.indices, self.caster, self.block, chain, volume, (case, shows_dark_cap), light, report);
        let batch = plan.batch_for(overlaps);
        batch.start += start;
        for (part, is_short, elements) in emitted {
            let source = if is_short { Source::Short } else { Source::Long };
            let base_vertex = self.block.first_vertex as i32;
            batch.draws.push(Draw { part, source, elements, base_vertex, rect: self.rect });
        }
        report.parts += 1;
        report.fate = merge(report.fate, case, why);
    }
}

/// The fate of a caster that had `before` and now a part in `case`: the dearest case of its parts, and all that was counted at the eye.
fn merge(before: Fate, case: Case, why: Why) -> Fate {
    let Fate::Drawn { case: case_before, why: why_before } = before else { return Fate::Drawn { case, why } };
    let why = match (why_before, why) {
        (Why::EyeCounted(a), Why::EyeCounted(b)) => Why::EyeCounted(a + b),
        (Why::SideCrossesNearRectangle, _) => why_before,
        _ => why,
    };
    Fate::Drawn { case: case.max(case_before), why }
}
