//! Which triangles cast, and how often: the chain whose extrusion is the shadow volume.
//!
//! ```text
//!    closed:  \ light |                other:  \ light |
//!              \ +1   |                         \ +1   |
//!               \_____|  0 on the                \_____|  -1: turned round, it faces
//!                  0     dark side                        the light and casts as well
//! ```
//!
//! Any coefficients give a closed volume, because the boundary of a chain has no boundary. What they must do
//! besides is count: a point is lit exactly where the count is 0.
//!
//! Sources: F. C. Crow 1977 for closed bodies; the second class follows the multiplicities of J. Peciva et al. 2013 and B. Kim
//! et al. 2008, written as a chain.

use crate::{Caster, LightPosition};

/// How the triangles of one component count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counting {
    /// Only those that face the light: each body between a point and the light counts once.
    ///
    /// Right for a closed, consistently wound component, at every point where its winding number is not negative
    /// (outside, above all).
    Facing,
    /// Every triangle, turned to face the light: each surface between a point and the light counts once.
    ///
    /// Right for anything, anywhere.
    Every,
}

impl Counting {
    /// For each component of `caster`, the cheapest counting that is right outside it.
    pub fn outside(caster: &Caster) -> Vec<Self> {
        let of = |is_closed| if is_closed { Self::Facing } else { Self::Every };
        caster.topology.components().iter().map(|c| of(c.is_closed)).collect()
    }
}

/// For each triangle of a caster the coefficient -1, 0 or +1 with which it casts from one light.
///
/// This is the only place where a triangle is tested against a light; the silhouette and the caps read it, so that
/// they agree whatever the rounding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chain {
    coefficients: Vec<i8>,
}

impl Chain {
    /// The chain of `caster` for `light`, each component counted as `counting` says (one entry each).
    ///
    /// A triangle seen exactly edge-on counts as facing away. Linear in the number of triangles.
    ///
    /// # Panics
    ///
    /// If `counting` has fewer entries than the caster has components.
    pub fn new(caster: &Caster, light: LightPosition, counting: &[Counting]) -> Self {
        let facing_away = |component: u32| match counting[component as usize] {
            Counting::Facing => 0,
            Counting::Every => -1,
        };
        let components = caster.topology.component_of_triangle();
        let coefficients = components
            .iter()
            .enumerate()
            .map(|(t, &component)| if faces(caster, t, light) { 1 } else { facing_away(component) })
            .collect();
        Self { coefficients }
    }

    /// A chain with the given coefficients, one for each triangle; any give a closed volume.
    pub fn from_coefficients(coefficients: Vec<i8>) -> Self {
        Self { coefficients }
    }

    /// One coefficient for each triangle.
    pub fn coefficients(&self) -> &[i8] {
        &self.coefficients
    }
}

/// Whether triangle `t` turns its counter-clockwise side to the light.
fn faces(caster: &Caster, t: usize, light: LightPosition) -> bool {
    let [a, b, c] = caster.corners(t).map(|p| p.as_dvec3());
    (b - a).cross(c - a).dot(light.from_point(a)) > 0.0
}
