//! What is built, as lines on a plan.

use glam::DVec2;
use umbrae_core::{Caster, SurfaceKind};
use umbrae_study::{Outline, Projection};

use crate::study::results::Results;
use crate::study::scene::When;

/// What an object looks like from straight above.
#[derive(Debug)]
pub(super) struct Footprint {
    /// When it is there.
    pub(super) when: When,
    pub(super) outline: Outline,
}

/// Objects of more triangles are drawn by nobody's eye; finding their outline would take longer than the study.
const MOST_TRIANGLES: usize = 3_000_000;

/// The footprints of all objects that cast, in order; none of a model that is too large for it.
pub(super) fn footprints(results: &Results) -> Vec<Footprint> {
    let models = &results.models;
    if models.scene.triangle_count() > MOST_TRIANGLES {
        return Vec::new();
    }
    let is_built = |&i: &usize| {
        let is_terrain = models.kinds[i].iter().filter(|&&kind| kind == SurfaceKind::Terrain).count();
        models.casters[i].role.casts && 2 * is_terrain <= models.kinds[i].len()
    };
    let built: Vec<usize> = (0..models.casters.len()).filter(is_built).collect();
    let casters: Vec<Caster> = built.iter().map(|&i| models.casters[i].clone()).collect();
    // From below everything, so that nothing of it is cut off.
    let projection = Projection::new(&casters, models.bounds().min.z - 1.0);
    (0..casters.len()).map(|i| Footprint { when: models.when[built[i]], outline: projection.plan(i) }).collect()
}

impl Footprint {
    /// Every edge, as two points in scene space.
    pub(super) fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.outline.rings().flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]))
    }
}
