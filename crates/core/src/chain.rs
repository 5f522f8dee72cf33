//! Which triangles cast, and how often: the chain whose extrusion is the shadow volume.
//!
//! ```text
//!    closed:  \ light |                other:  \ light |
//!              \ +1   |                         \ +1   |
//!               \_____|  0 on the                \_____|  -1: turned round, it faces
//!                  0     dark side                  -1     the light and casts as well
//! ```
//!
//! Any coefficients give a closed volume, because the boundary of a chain has no boundary. What they must do
//! besides is count: a point is lit exactly where the count is 0.
//!
//! Sources: F. C. Crow 1977 for closed bodies; the second class follows the multiplicities of J. Peciva et al. 2013 and B. Kim
//! et al. 2008, written as a chain.

use crate::silhouette::EDGE_ON;
use crate::{Caster, LightPosition};

/// How the triangles of one component count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counting {
    /// Only those that face the light, +1.
    ///
    /// Right for a closed, consistently wound component where the seen point and the light are outside, and wherever else
    /// [`Counting::choose`] says.
    Facing,
    /// Only those that face away, -1: turned round, they face the light.
    ///
    /// Right for a closed, consistently wound component that holds the light but not the seen point.
    FacingAway,
    /// All, +1 or -1, so each surface between a point and the light counts once; but 0 for those that are edge-on, whose volume
    /// is a sheet, or, where the light lies in the triangle itself, a half-space whose cap at infinity can't be drawn.
    ///
    /// Right for anything, anywhere.
    Every,
}

impl Counting {
    /// For each component of `caster`, the cheapest counting that is right where eye and light are outside of it.
    pub fn outside(caster: &Caster) -> Vec<Self> {
        let of = |is_closed| if is_closed { Self::Facing } else { Self::Every };
        caster.topology.components().iter().map(|c| of(c.is_closed)).collect()
    }

    /// The coefficient of a triangle.
    fn coefficient(self, turn: Turn) -> i8 {
        match (self, turn.is_facing, turn.is_edge_on) {
            (Self::Every, _, true) | (Self::Facing, false, _) | (Self::FacingAway, true, _) => 0,
            (Self::Every | Self::Facing, true, _) => 1,
            (Self::Every | Self::FacingAway, false, _) => -1,
        }
    }
}

/// How a triangle is turned to a light.
#[derive(Debug, Clone, Copy)]
struct Turn {
    /// Its counter-clockwise side is turned to the light; not when exactly edge-on.
    is_facing: bool,
    /// The light is in its plane, as far as `f32` can tell.
    is_edge_on: bool,
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
    /// Linear in the number of triangles.
    ///
    /// # Panics
    ///
    /// If `counting` has fewer entries than the caster has components.
    pub fn new(caster: &Caster, light: LightPosition, counting: &[Counting]) -> Self {
        let reach = |p: glam::DVec3| p.abs().max_element();
        let edge_on = if light.is_directional() {
            EDGE_ON
        } else {
            let corners = reach(caster.bounds.min).max(reach(caster.bounds.max));
            EDGE_ON * corners.max(reach(light.homogeneous().truncate()))
        };
        let components = caster.topology.component_of_triangle();
        let coefficients = components
            .iter()
            .enumerate()
            .map(|(t, &component)| counting[component as usize].coefficient(turn(caster, t, light, edge_on)))
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

/// How triangle `t` is turned to `light`; `edge_on` is the distance (of a directional light: the cosine) that counts as none.
fn turn(caster: &Caster, t: usize, light: LightPosition, edge_on: f64) -> Turn {
    let [a, b, c] = caster.corners(t).map(glam::Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    let height = normal.dot(light.offset_from(a));
    Turn { is_facing: height > 0.0, is_edge_on: height * height <= edge_on * edge_on * normal.length_squared() }
}
