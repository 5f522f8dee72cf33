//! One caster under one light: its silhouette, its volume, and how that is counted.

use std::sync::{Mutex, PoisonError};

use umbrae_core::{
    Case, CaseChooser, Caster, Chain, Counting, Culler, Light, LightPosition, PixelRect, ShadowVolume, Silhouettes,
    Windings, most_overlaps, needs_light_cap, split_chain,
};

use super::casters::Block;
use super::emit::emit;
use super::options::{Method, ShadowOptions, SilhouetteSource};
use super::plan::{Draw, MOST_OVERLAPS, Plan, Source};
use super::report::{CasterReport, Fate, Why};

/// One caster that is to be drawn.
pub(crate) struct CasterPlanner<'a> {
    pub(crate) caster: &'a Caster,
    pub(crate) windings: &'a Windings,
    pub(crate) block: Block,
    pub(crate) culler: &'a Culler,
    pub(crate) chooser: &'a CaseChooser,
    pub(crate) rect: PixelRect,
}

/// What a caster draws: one volume, or more where one could overlap itself more often than can be counted.
pub(super) struct CasterOutline {
    parts: Vec<PartOutline>,
    case: Case,
    why: Why,
    silhouette_edges: usize,
    /// Unknown where only the sides are drawn.
    chain_triangles: Option<usize>,
}

struct PartOutline {
    volume: ShadowVolume,
    /// Where more is drawn than sides.
    chain: Option<Chain>,
    overlaps: u32,
}

impl CasterPlanner<'_> {
    /// Finds the silhouette and all that takes time; `silhouettes` are those of the caster.
    pub(super) fn outline(
        &self,
        silhouettes: &Mutex<Silhouettes>,
        light: &Light,
        options: &ShadowOptions,
    ) -> CasterOutline {
        let caster = self.caster;
        let counting = self.counting(light.position);
        let (case, why) = self.case(options);
        let kind = match options.silhouettes {
            SilhouetteSource::Cpu(kind) => Some(kind),
            _ => None,
        };
        // Whoever panicked with it left nothing half done that the next search does not begin anew.
        let mut silhouettes = silhouettes.lock().unwrap_or_else(PoisonError::into_inner);
        let outline = silhouettes.find(caster, (&light.name, light.position), &counting, kind);
        let draws_sides_only = case == Case::Pass && !caster.role.is_see_through();
        let (chain, volume) = if draws_sides_only && !needs_light_cap(caster, light.position) {
            (None, ShadowVolume::of_sides(caster, outline.sides))
        } else {
            let chain = outline.chain(light.position, &counting);
            let volume = ShadowVolume::of_boundary(caster, &chain, outline.sides);
            (Some(chain), volume)
        };
        let overlaps = most_overlaps(caster, &volume, light.position);
        let silhouette_edges = volume.sides.len();
        let chain_triangles = chain.is_some().then_some(volume.light_cap.len());
        let parts = if overlaps <= MOST_OVERLAPS {
            vec![PartOutline { volume, chain, overlaps }]
        } else {
            let whole = chain.unwrap_or_else(|| outline.chain(light.position, &counting));
            let part = |chain| {
                let volume = ShadowVolume::new(caster, &chain);
                let overlaps = most_overlaps(caster, &volume, light.position);
                PartOutline { volume, chain: Some(chain), overlaps }
            };
            split_chain(caster, &whole, light.position, MOST_OVERLAPS).into_iter().map(part).collect()
        };
        CasterOutline { parts, case, why, silhouette_edges, chain_triangles }
    }

    /// One volume over the whole silhouette, however often it overlaps itself; with its chain where caps are drawn. By z-fail where it can be seen
    /// through, as caps are to be compared with depth then.
    pub(crate) fn whole(
        &self,
        silhouettes: &Mutex<Silhouettes>,
        light: &Light,
        options: &ShadowOptions,
    ) -> (ShadowVolume, Case, Why) {
        let caster = self.caster;
        let counting = self.counting(light.position);
        let (mut case, mut why) = self.case(options);
        if caster.role.is_see_through() && case == Case::Pass {
            (case, why) = (Case::Fail, Why::Method);
        }
        let kind = match options.silhouettes {
            SilhouetteSource::Cpu(kind) => Some(kind),
            _ => None,
        };
        let mut silhouettes = silhouettes.lock().unwrap_or_else(PoisonError::into_inner);
        let outline = silhouettes.find(caster, (&light.name, light.position), &counting, kind);
        let volume = if case == Case::Pass {
            ShadowVolume::of_sides(caster, outline.sides)
        } else {
            ShadowVolume::of_boundary(caster, &outline.chain(light.position, &counting), outline.sides)
        };
        (volume, case, why)
    }

    /// Adds what is drawn to `plan`, and tells of it.
    pub(super) fn add_to(
        &self,
        plan: &mut Plan,
        outline: &CasterOutline,
        light: LightPosition,
        options: &ShadowOptions,
    ) -> CasterReport {
        let mut report = CasterReport::of_fate(Fate::Unseen);
        report.rect = Some(self.rect);
        report.faces_mut().silhouette_edges = outline.silhouette_edges;
        report.faces_mut().chain_triangles = outline.chain_triangles;
        report.index_bytes = if self.block.is_short() { size_of::<u16>() } else { size_of::<u32>() };
        for part in &outline.parts {
            self.add_part(plan, &mut report, part, (outline.case, outline.why), light, options);
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
        part: &PartOutline,
        (mut case, mut why): (Case, Why),
        light: LightPosition,
        options: &ShadowOptions,
    ) {
        let mut start = 0;
        if options.method == Method::EyeCount && case != Case::Pass {
            let chain = part.chain.as_ref().expect("z-fail draws more than sides");
            match self.chooser.eye_count(self.caster, chain, &part.volume) {
                None => why = Why::SideCrossesNearRectangle,
                Some(count) => {
                    start = count;
                    (case, why) = (Case::Pass, Why::EyeCounted(count));
                }
            }
        }
        let shows_dark_cap = !options.cull_caps || self.culler.dark_cap_may_show(&self.caster.bounds);
        let emitted = emit(
            &mut plan.indices,
            self.caster,
            self.block,
            part.chain.as_ref(),
            &part.volume,
            (case, shows_dark_cap),
            light,
            report,
        );
        let batch = plan.batch_for(part.overlaps);
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
