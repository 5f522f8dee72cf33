//! One smooth body under one light: the volume of its smooth silhouette, and how that is counted.
//!
//! Its points are uploaded with each light, a block of them as a caster has one; the light cap is the caster's own triangles, in the caster's block.

use umbrae_core::{
    Bounds, Case, CaseChooser, Caster, Chain, Counting, Culler, LightPosition, PixelRect, SmoothBody, SmoothVolume,
    Smoothness, Windings,
};

use super::casters::{Block, add_block};
use super::emit::{Part, add_at_infinity, add_fan, is_fan_narrow, sides};
use super::options::{Method, ShadowOptions};
use super::plan::{Draw, MOST_OVERLAPS, Plan, Source, rect_by_culling};
use super::report::{CasterReport, Fate, Why};

/// The volume of `body`, which is that of `caster`, as seen from where its `windings` are told of; `None` if eye or light are inside of it: then only its
/// triangles are sure to be right.
pub(crate) fn smooth_volume(
    caster: &Caster,
    body: &SmoothBody,
    windings: &Windings,
    light: LightPosition,
    smoothness: &Smoothness,
) -> Option<SmoothVolume> {
    let counting = Counting::choose(caster, windings, &Windings::of_light(caster, light));
    let is_outside = counting.iter().all(|&counting| counting == Counting::Facing);
    is_outside.then(|| SmoothVolume::new(body, light, smoothness))
}

/// One smooth caster that may be drawn.
pub(super) struct SmoothPlanner<'a> {
    pub(super) caster: &'a Caster,
    pub(super) body: &'a SmoothBody,
    pub(super) windings: &'a Windings,
    pub(super) block: Block,
    pub(super) culler: &'a Culler,
    pub(super) chooser: &'a CaseChooser,
    pub(super) light_rect: PixelRect,
}

/// What a smooth caster draws.
pub(super) struct SmoothOutline {
    volume: SmoothVolume,
    /// Of the caster and of what bulges out of it.
    bounds: Bounds,
    rect: PixelRect,
    case: Case,
    why: Why,
}

impl SmoothPlanner<'_> {
    /// Finds the smooth silhouette and all that takes time. `None` where only the caster's triangles are sure to be right: see
    /// [`smooth_volume`], and where its volume may overlap itself more often than the stencil counts.
    pub(super) fn outline(
        &self,
        light: LightPosition,
        smoothness: &Smoothness,
        options: &ShadowOptions,
    ) -> Result<Option<SmoothOutline>, Fate> {
        let caster = self.caster;
        if !caster.role.casts {
            return Err(Fate::NotCasting);
        }
        // Before its silhouette is known, a curve may bulge by as much as it is long.
        rect_by_culling(&self.body.loose_bounds(), self.culler, options, self.light_rect)?;
        let Some(volume) = smooth_volume(caster, self.body, self.windings, light, smoothness) else { return Ok(None) };
        if volume.most_overlaps(self.body, caster, light, MOST_OVERLAPS) > MOST_OVERLAPS {
            return Ok(None);
        }
        let bounds = volume.bounds(caster);
        let rect = rect_by_culling(&bounds, self.culler, options, self.light_rect)?;
        let (case, why) = self.case(&volume, &bounds, options);
        Ok(Some(SmoothOutline { volume, bounds, rect, case, why }))
    }

    fn case(&self, volume: &SmoothVolume, bounds: &Bounds, options: &ShadowOptions) -> (Case, Why) {
        let zfail = if !options.cull_caps || self.culler.light_cap_may_show(bounds) {
            Case::Fail
        } else {
            Case::FailWithoutLightCap
        };
        let is_clear = || {
            let of_points = Bounds::of_points(volume.points.iter().map(|p| p.as_dvec3()));
            self.chooser.case(self.caster) == Case::Pass && self.chooser.case_of_bounds(&of_points) == Case::Pass
        };
        match options.method {
            Method::ZPass => (Case::Pass, Why::Method),
            Method::ZFail => (zfail, Why::Method),
            Method::Auto | Method::EyeCount if is_clear() => (Case::Pass, Why::NearRectangleClear),
            Method::Auto | Method::EyeCount => (zfail, Why::NearRectangleMayBeShaded),
        }
    }

    /// Adds what is drawn to `plan`, and tells of it.
    pub(super) fn add_to(
        &self,
        plan: &mut Plan,
        outline: &SmoothOutline,
        light: LightPosition,
        options: &ShadowOptions,
    ) -> CasterReport {
        let SmoothOutline { volume, bounds, rect, case, why } = outline;
        let mut report = CasterReport::of_fate(Fate::Drawn { case: *case, why: *why });
        report.rect = Some(*rect);
        report.parts = 1;
        report.index_bytes = size_of::<u32>();
        let is_pass = *case == Case::Pass;
        let shows_dark_cap = !light.is_directional() && (!options.cull_caps || self.culler.dark_cap_may_show(bounds));
        let is_capped = !is_pass && shows_dark_cap;
        let is_fan = is_capped && is_fan_narrow(bounds, light);
        let chain = (*case == Case::Fail || (is_capped && !is_fan)).then(|| volume.chain(self.body));

        let block = add_block(&mut plan.smooth_vertices, bounds, &volume.points, !light.is_directional());
        let mut triangles = sides(block, &volume.sides, light);
        let faces = report.faces_mut();
        faces.silhouette_edges = volume.sides.len();
        faces.side_triangles = triangles.len();
        faces.chain_triangles = chain.as_ref().map(|chain| self.cap(chain).count());
        let closing = volume.closing().take(if is_pass { volume.faces.len() } else { usize::MAX });
        faces.closing_triangles = closing.len();
        triangles.extend(closing.map(|face| face.map(|i| block.near(i))));
        let before = triangles.len();
        if is_fan {
            add_fan(&mut triangles, block, &volume.sides);
        } else if is_capped {
            add_at_infinity(&mut triangles, block, &volume.points, volume.closing(), light);
        }
        faces.dark_cap_triangles = triangles.len() - before;

        let part = if is_pass { Part::Pass } else { Part::Fail };
        let first = plan.smooth_indices.len() as u32;
        plan.smooth_indices.extend_from_slice(triangles.as_flattened());
        let elements = first..plan.smooth_indices.len() as u32;
        let base_vertex = block.first_vertex as i32;
        let mut draws = vec![Draw { part, source: Source::Smooth, elements, base_vertex, rect: *rect }];
        let mut of_mesh = |part, triangles: &[[u32; 3]]| {
            let is_short = self.block.is_short();
            let elements = plan.indices.add(is_short, triangles);
            let source = if is_short { Source::Short } else { Source::Long };
            draws.push(Draw { part, source, elements, base_vertex: self.block.first_vertex as i32, rect: *rect });
        };
        if let Some(chain) = &chain {
            if is_capped && !is_fan {
                let mut far = Vec::new();
                add_at_infinity(&mut far, self.block, &self.caster.positions, self.cap(chain), light);
                report.faces_mut().dark_cap_triangles += far.len();
                of_mesh(part, &far);
            }
            if *case == Case::Fail {
                let near: Vec<[u32; 3]> = self.cap(chain).map(|t| t.map(|i| self.block.near(i))).collect();
                report.faces_mut().light_cap_triangles = near.len();
                of_mesh(Part::LightCap, &near);
            }
        }
        plan.batch_alone(*rect).draws = draws;
        report
    }

    /// Triangles of the light cap.
    fn cap<'a>(&'a self, chain: &'a Chain) -> impl Iterator<Item = [u32; 3]> + 'a {
        let triangles = self.caster.mesh.triangles().iter().zip(chain.coefficients());
        triangles.filter(|(_, times)| **times > 0).map(|(corners, _)| *corners)
    }
}
