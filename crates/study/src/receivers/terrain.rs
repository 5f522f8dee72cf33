//! The surface of the earth, where the model has it.

use glam::{DVec2, DVec3};
use umbrae_core::{Caster, RayCaster, SurfaceKind};

use super::{LIFT_M, rays_against};

/// The triangles that are terrain.
#[derive(Debug, Clone)]
pub struct Terrain {
    rays: RayCaster,
    top: f64,
}

impl Terrain {
    /// Takes the triangles of `casters` whose kind is [`SurfaceKind::Terrain`]; `kinds` has one list for each caster, with a kind for each triangle.
    pub fn new(casters: &[Caster], kinds: &[Vec<SurfaceKind>]) -> Self {
        Self {
            rays: rays_against(casters, kinds, |kind| kind == SurfaceKind::Terrain),
            top: Caster::bounds_of(casters).max.z,
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.rays.triangle_count() == 0
    }

    /// The point [`LIFT_M`] above the highest terrain at `plan`; `None` where there is none.
    pub fn above(&self, plan: DVec2) -> Option<DVec3> {
        if self.is_empty() {
            return None;
        }
        let from = plan.extend(self.top + 1.0);
        let hit = self.rays.first_hit(from, DVec3::NEG_Z, 0.0, f64::INFINITY)?;
        Some(plan.extend(from.z - hit.t + LIFT_M))
    }
}
