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

use rayon::prelude::*;
use umbrae_core::{Bounds, Camera, CaseChooser, Caster, Culler, Light, PixelRect, Reach, Sphere, Windings};

use super::caster_plan::{CasterOutline, CasterPlanner};
use super::casters::{ShadowCasters, VolumeVertex};
use super::emit::{Indices, Part};
use super::found::{FoundDraw, FoundSmooth};
use super::options::{LightMark, ShadowOptions};
use super::report::{CasterReport, Fate};
use super::smooth_plan::{SmoothOutline, SmoothPlanner};
use super::spheres::{is_shut_in, rounded_to_f32};

/// Seven bits count; the eighth is the mark.
pub(super) const MOST_OVERLAPS: u32 = 127;

/// What a camera sees of casters, whatever the light.
#[derive(Debug)]
pub(crate) struct Seen {
    pub(crate) camera: Camera,
    pub(crate) bounds: Bounds,
    /// Of all casters; found when first asked for.
    windings: OnceLock<Vec<Windings>>,
    /// As the shaders see them.
    pub(crate) spheres: Vec<Sphere>,
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
    pub(crate) fn windings(&self, casters: &[Caster]) -> &[Windings] {
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
    /// Smooth bodies, each of which is added up alone.
    pub(crate) found_smooth: Vec<FoundSmooth>,
    pub(crate) indices: Indices,
    /// The faces of spheres' volumes, three vertices each.
    pub(crate) loose: Vec<VolumeVertex>,
    /// Blocks of what smooth silhouettes are made of, and triangles of these.
    pub(crate) smooth_vertices: Vec<VolumeVertex>,
    pub(crate) smooth_indices: Vec<u32>,
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
    /// Where it counts, if that is known to be less than the light's rectangle.
    pub(crate) rect: Option<PixelRect>,
    overlaps: u32,
}

/// Where triangles come from; in the order in which they are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Source {
    /// 32-bit indices.
    Long,
    /// 16-bit indices.
    Short,
    /// 32-bit indices of [`Plan::smooth_vertices`].
    Smooth,
    /// Vertices in a row, without indices.
    Loose,
}

/// A caster with its silhouette.
enum Outlined<'a> {
    Discrete(CasterPlanner<'a>, CasterOutline),
    Smooth(SmoothPlanner<'a>, SmoothOutline),
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
    /// At most linear in the number of triangles of the casters that are not culled. On all threads of the rayon pool.
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
        let windings = seen.windings(casters);
        let smoothness = options.smooth.smoothness(&seen.camera, seen.bounds);
        // What takes time is done for all casters at once; what is drawn then comes in their order.
        let outlined: Vec<_> = (0..casters.len())
            .into_par_iter()
            .map(|i| {
                let (caster, windings, block) = (&casters[i], &windings[i], uploaded.blocks[i]);
                if let (Some(smoothness), Some(body)) = (&smoothness, uploaded.body(i)) {
                    let light_rect = rect;
                    let planner = SmoothPlanner { caster, body, windings, block, culler, chooser, light_rect };
                    if let Some(outline) = planner.outline(light.position, smoothness, options)? {
                        return Ok(Outlined::Smooth(planner, outline));
                    }
                }
                let rect = casting_rect(caster, culler, options, rect)?;
                let planner = CasterPlanner { caster, windings, block, culler, chooser, rect };
                let outline = planner.outline(&uploaded.silhouettes[i], light, options);
                Ok(Outlined::Discrete(planner, outline))
            })
            .collect();
        // Counts of smooth volumes may be below 0 in places, and would take from others: they come last, each in a batch of its own.
        let (mut reports, mut smooth) = (Vec::new(), Vec::new());
        for (i, outlined) in outlined.into_iter().enumerate() {
            reports.push(match outlined {
                Err(fate) => CasterReport::of_fate(fate),
                Ok(Outlined::Discrete(planner, outline)) => {
                    planner.add_to(&mut plan, &outline, light.position, options)
                }
                Ok(Outlined::Smooth(planner, outline)) => {
                    smooth.push((i, planner, outline));
                    CasterReport::of_fate(Fate::Unseen)
                }
            });
        }
        for (i, planner, outline) in smooth {
            reports[i] = planner.add_to(&mut plan, &outline, light.position, options);
        }
        plan.casters.extend(reports);
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
            found_smooth: Vec::new(),
            indices: Indices::default(),
            loose: Vec::new(),
            smooth_vertices: Vec::new(),
            smooth_indices: Vec::new(),
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
        self.found_smooth.clear();
        self.indices.clear();
        self.loose.clear();
        self.smooth_vertices.clear();
        self.smooth_indices.clear();
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

    /// Puts what is drawn in the order in which the least state changes; what is nothing is not drawn, and has no buffers.
    pub(super) fn sort(&mut self) {
        for batch in &mut self.batches {
            batch.draws.retain(|draw| !draw.elements.is_empty());
            batch.draws.sort_by_key(|draw| (draw.part, draw.source));
            self.found[batch.found.clone()].sort_unstable_by_key(FoundDraw::order);
        }
        self.summed.sort_unstable_by_key(FoundDraw::order);
    }

    /// Whether there is a batch with room for volumes that overlap so many times.
    pub(super) fn has_room(&self, overlaps: u32) -> bool {
        self.batches.last().is_some_and(|batch| batch.overlaps + overlaps <= MOST_OVERLAPS)
    }

    /// A batch that nothing else is counted in, and that counts within `rect` alone.
    pub(super) fn batch_alone(&mut self, rect: PixelRect) -> &mut Batch {
        let end = self.found.len();
        self.batches.push(Batch { found: end..end, rect: Some(rect), overlaps: MOST_OVERLAPS, ..Batch::default() });
        self.batches.last_mut().expect("one was pushed")
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

pub(crate) fn unseen_light(caster: &Caster) -> Fate {
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
pub(crate) fn rect_by_culling(
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
pub(crate) fn volume_vertex(homogeneous: glam::DVec4) -> VolumeVertex {
    let kind = if homogeneous.w == 0.0 { 2.0 } else { 0.0 };
    homogeneous.truncate().as_vec3().extend(kind).to_array()
}
