//! The outline of a caster as the light sees it: the boundary of its chain.
//!
//! ```text
//!   faces      one plane for each flat face        plain      two products for each edge
//!   edges      those between different faces       scan       facing bits, then every edge
//!   packets    64 edges and the planes they need   dual       a tree over planes as points of dual space
//!   simd       what runs on many at once           cones      a tree over triangles with cones of normals
//!   finder     one door to all                     coherent   what has changed since the last light
//!   keeper     which of them a caster deserves    normals    the tree over vertex normals
//! ```
//!
//! All finders read one set of planes and evaluate one expression for each, so they find the same edges, bit for bit.
//!
//! Source: the edge scan is Sutherland's, after F. C. Crow 1977 and M. McGuire et al. 2003, section 6; the
//! multiplicities extend it to any mesh. For the others see their files.

mod coherent;
mod cones;
mod dual;
mod edges;
mod faces;
mod facing;
mod finder;
mod hierarchy;
mod keeper;
mod normals;
mod packets;
mod plain;
mod scan;
mod simd;
#[cfg(test)]
mod tests;

use crate::{Chain, Topology};

pub(crate) use faces::EDGE_ON;
pub use finder::{Finder, FinderKind, Found};
pub use keeper::{Outline, Silhouettes};
pub use normals::NormalFinder;

/// An edge of the boundary, with its orientation and how often it is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct SilhouetteEdge {
    /// Vertex from which the lit side walks the edge.
    pub start: u32,
    /// Vertex to which it walks.
    pub end: u32,
    /// How many times the edge is extruded; at least 1.
    pub multiplicity: u32,
}

impl SilhouetteEdge {
    /// The edge from `start` to `end` that is walked `m` times more often than back; `None` where that is 0.
    fn of([start, end]: [u32; 2], m: i32) -> Option<Self> {
        let (start, end) = if m > 0 { (start, end) } else { (end, start) };
        (m != 0).then_some(Self { start, end, multiplicity: m.unsigned_abs() })
    }
}

/// Adds the edge `ends` as often as it is walked more often from its start to its end than back, `m` times.
fn add_side(found: &mut Vec<[u32; 2]>, [start, end]: [u32; 2], m: i32) {
    let side = if m > 0 { [start, end] } else { [end, start] };
    (0..m.abs()).for_each(|_| found.push(side));
}

/// The boundary of `chain`, in the order of the edges of `topology`.
///
/// On a closed, consistently wound mesh every multiplicity is 1, and as many edges arrive at each vertex as leave it.
/// Linear in the number of edges.
pub fn silhouette(topology: &Topology, chain: &Chain) -> Vec<SilhouetteEdge> {
    let c = chain.coefficients();
    topology
        .edges()
        .iter()
        .enumerate()
        .filter_map(|(e, edge)| {
            let m = topology.triangles_on_edge(e).map(|(t, direction)| direction * i32::from(c[t])).sum();
            SilhouetteEdge::of([edge.low, edge.high], m)
        })
        .collect()
}
