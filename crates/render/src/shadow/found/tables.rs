//! What is known of casters before there is a light, as words for shaders: triangles, edges, who meets where, and in which blocks they are gone
//! through.
//!
//! ```text
//! casters      where the things below are, for each caster
//! components   of each caster: a box, and whether it is closed
//! triangles    three vertices each                             once for all instances of a mesh
//! component    of each triangle                                once
//! edges        two vertices each, the lower first              once
//! firsts       of each edge its first incidence, and the end   once
//! incidences   a triangle and its direction on the edge        once
//! blocks       a caster and a first triangle, or edge: a workgroup each
//! ```

use std::sync::Arc;

use rustc_hash::FxHashMap;
use umbrae_core::{Bounds, Caster, Topology};

/// `@workgroup_size` in `find.wgsl`: what a block holds at most.
pub(crate) const BLOCK: u32 = 64;
/// Words of `CasterTable` in `find.wgsl`.
const CASTER_WORDS: usize = 8;

/// Words, and where things are among them.
#[derive(Debug)]
pub(crate) struct Tables {
    pub(crate) words: Vec<u32>,
    /// Of each caster, for volumes to find the vertices of edges and triangles.
    pub(crate) of_casters: Vec<CasterTables>,
    pub(crate) triangle_blocks: Blocks,
    pub(crate) edge_blocks: Blocks,
    /// Of all casters.
    pub(crate) triangle_count: u32,
}

/// Blocks of triangles or edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Blocks {
    /// The first word.
    pub(crate) start: u32,
    pub(crate) count: u32,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct CasterTables {
    pub(crate) triangles: u32,
    pub(crate) triangle_count: u32,
    pub(crate) edges: u32,
}

/// What instances of a mesh share.
#[derive(Debug, Clone, Copy)]
struct MeshTables {
    triangles: u32,
    component_of_triangle: u32,
    edges: u32,
    firsts: u32,
}

impl Tables {
    /// Linear in the triangles of `casters`: about 60 bytes for each of a closed mesh, 32 for each component of each caster.
    pub(crate) fn new(casters: &[Caster]) -> Self {
        let mut words = vec![0; CASTER_WORDS * casters.len()];
        let mut of_meshes: FxHashMap<*const Topology, MeshTables> = FxHashMap::default();
        let mut of_casters = Vec::with_capacity(casters.len());
        let mut triangle_count = 0;
        for (i, caster) in casters.iter().enumerate() {
            let components = words.len() as u32;
            add_components(&mut words, caster);
            let mesh = *of_meshes.entry(Arc::as_ptr(&caster.topology)).or_insert_with(|| add_mesh(&mut words, caster));
            let count = caster.mesh.triangles().len() as u32;
            words[CASTER_WORDS * i..][..CASTER_WORDS].copy_from_slice(&[
                mesh.triangles,
                count,
                mesh.component_of_triangle,
                components,
                mesh.edges,
                caster.topology.edges().len() as u32,
                mesh.firsts,
                triangle_count,
            ]);
            triangle_count += count;
            of_casters.push(CasterTables { triangles: mesh.triangles, triangle_count: count, edges: mesh.edges });
        }
        let triangle_blocks = add_blocks(&mut words, casters.iter().map(|caster| caster.mesh.triangles().len()));
        let edge_blocks = add_blocks(&mut words, casters.iter().map(|caster| caster.topology.edges().len()));
        Self { words, of_casters, triangle_blocks, edge_blocks, triangle_count }
    }
}

/// A box as its lower corner, 1 for a closed component, its upper corner, and 0.
fn add_components(words: &mut Vec<u32>, caster: &Caster) {
    let topology = &caster.topology;
    let mut boxes = vec![Bounds::EMPTY; topology.components().len()];
    for (t, &component) in topology.component_of_triangle().iter().enumerate() {
        let bounds = &mut boxes[component as usize];
        *bounds = caster.corners(t).iter().fold(*bounds, |bounds, corner| bounds.including(corner.as_dvec3()));
    }
    for (component, bounds) in topology.components().iter().zip(boxes) {
        // Of `f32` positions, so that nothing is rounded.
        words.extend(bounds.min.as_vec3().to_array().map(f32::to_bits));
        words.push(component.is_closed.into());
        words.extend(bounds.max.as_vec3().to_array().map(f32::to_bits));
        words.push(0);
    }
}

fn add_mesh(words: &mut Vec<u32>, caster: &Caster) -> MeshTables {
    let topology = &caster.topology;
    let triangles = words.len() as u32;
    words.extend(caster.mesh.triangles().as_flattened());
    let component_of_triangle = words.len() as u32;
    words.extend(topology.component_of_triangle());
    let edges = words.len() as u32;
    words.extend(topology.edges().iter().flat_map(|edge| [edge.low, edge.high]));
    let firsts = words.len() as u32;
    let incidences = firsts + topology.edges().len() as u32 + 1;
    let mut next = incidences;
    for e in 0..topology.edges().len() {
        words.push(next);
        next += topology.triangles_on_edge(e).len() as u32;
    }
    words.push(next);
    for e in 0..topology.edges().len() {
        words.extend(topology.triangles_on_edge(e).map(|(t, direction)| (t as u32) << 1 | u32::from(direction < 0)));
    }
    MeshTables { triangles, component_of_triangle, edges, firsts }
}

fn add_blocks(words: &mut Vec<u32>, counts: impl Iterator<Item = usize>) -> Blocks {
    let start = words.len() as u32;
    for (caster, count) in (0_u32..).zip(counts) {
        words.extend((0..count as u32).step_by(BLOCK as usize).flat_map(|first| [caster, first]));
    }
    Blocks { start, count: (words.len() as u32 - start) / 2 }
}
