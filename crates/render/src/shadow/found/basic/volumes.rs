//! What is drawn of silhouettes in textures: whatever might be there, by z-pass or z-fail as boxes tell.

use umbrae_core::{Case, Caster, LightPosition};

use super::tables::{CasterTables, PartTables};
use crate::shadow::casters::ShadowCasters;
use crate::shadow::found::jobs::{Amount, Job, Shape, add_draws, job, report};
use crate::shadow::options::ShadowOptions;
use crate::shadow::plan::{Plan, Scope, Seen, casting_rect};
use crate::shadow::report::CasterReport;

/// Adds to `plan`, which was started for `light`, what is drawn of `casters`. `is_facing` tells of a caster whether only triangles of its solid
/// components count that face the light.
pub(super) fn add(
    plan: &mut Plan,
    scope: &Scope,
    (casters, uploaded, tables): (&[Caster], &ShadowCasters, &[CasterTables]),
    seen: &Seen,
    (number, light): (u32, LightPosition),
    is_facing: impl Fn(usize) -> bool,
    (options, may_sum): (&ShadowOptions, bool),
) {
    for (i, (caster, tables)) in casters.iter().zip(tables).enumerate() {
        let rect = match casting_rect(caster, &scope.culler, options, scope.rect) {
            Ok(rect) => rect,
            Err(fate) => {
                plan.casters.push(CasterReport::of_fate(fate));
                continue;
            }
        };
        let undecided = job((caster, caster.bounds), uploaded.blocks[i], scope, &seen.camera, light, options);
        // No triangle is looked at, and z-fail is always right.
        let zfail = if undecided.shows_light_cap { Case::Fail } else { Case::FailWithoutLightCap };
        let case = undecided.case.unwrap_or(zfail);
        let job = Job { caster: i as u32, light: number, case: Some(case), ..undecided };
        let is_facing = is_facing(i);
        for part in &tables.parts {
            let amounts = |shape, _| amounts(part, shape, light.is_directional(), is_facing);
            add_draws(plan, (&job, number), (part.most_overlaps, may_sum), rect, amounts);
        }
        let report = report(&job, options, rect);
        plan.casters.push(CasterReport { parts: tables.parts.len(), ..report });
    }
}

/// The vertices of all faces of `shape` that `part` might have, and how many copies of each.
fn amounts(
    part: &PartTables,
    shape: Shape,
    is_directional: bool,
    is_facing: bool,
) -> impl Iterator<Item = Amount> + '_ {
    let vertices_each = match shape {
        Shape::Sides if !is_directional => 6,
        Shape::Projected => 9,
        Shape::Sides | Shape::Fan | Shape::LightCap | Shape::Faced | Shape::Turned => 3,
    };
    let is_of_edges = matches!(shape, Shape::Sides | Shape::Fan);
    let of_edges = part.edges.iter().map(move |run| (&run.edges, run.most_copies(is_facing)));
    let of_triangles = (&part.triangles, 1);
    let ranges = of_edges.filter(move |_| is_of_edges).chain((!is_of_edges).then_some(of_triangles));
    ranges.map(move |(range, copies)| Amount::AtMost {
        first_vertex: range.start * vertices_each,
        end_vertex: range.end * vertices_each,
        copies,
    })
}
