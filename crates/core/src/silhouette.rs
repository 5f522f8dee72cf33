//! The outline of a caster as the light sees it: the boundary of its chain.
//!
//! Source: the edge scan is Sutherland's, after F. C. Crow 1977 and M. McGuire et al. 2003, section 6; the
//! multiplicities extend it to any mesh.

use crate::{Chain, Topology};

/// An edge of the boundary, with its orientation and how often it is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SilhouetteEdge {
    /// Vertex from which the lit side walks the edge.
    pub start: u32,
    /// Vertex to which it walks.
    pub end: u32,
    /// How many times the edge is extruded; at least 1.
    pub multiplicity: u32,
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
            let m: i32 = topology.triangles_on_edge(e).map(|(t, direction)| direction * i32::from(c[t])).sum();
            let (start, end) = if m > 0 { (edge.low, edge.high) } else { (edge.high, edge.low) };
            (m != 0).then_some(SilhouetteEdge { start, end, multiplicity: m.unsigned_abs() })
        })
        .collect()
}
