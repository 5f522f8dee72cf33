//! What a loaded model has, counted as in SOURCES.md.

use std::collections::BTreeSet;
use std::sync::Arc;

use umbrae_core::{Mesh, Object, Surface, Topology, TopologyCounts};
use umbrae_formats::{Format, Model};

/// What a file has in all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Counts {
    /// Triangles read, instances counted each, also those that were then dropped.
    pub(crate) shown: usize,
    /// Edges with one triangle, with more than two, and with two that walk it the same way. For glTF those of each mesh,
    /// once; for other formats those of all objects welded together.
    pub(crate) border: usize,
    pub(crate) non_manifold: usize,
    pub(crate) inconsistent: usize,
}

/// Counts what `model` has.
pub(crate) fn of_model(model: &Model) -> Counts {
    let shown = model.scene.objects.iter().map(|object| object.mesh.counts().triangles_read).sum();
    let edges = if model.format == Format::Gltf {
        let mut seen = BTreeSet::new();
        let is_new = |object: &&Object| seen.insert(Arc::as_ptr(&object.mesh));
        let counts_of = |object: &Object| Topology::new(&object.mesh).counts();
        model.scene.objects.iter().filter(is_new).map(counts_of).fold(TopologyCounts::default(), TopologyCounts::plus)
    } else {
        Topology::new(&welded(&model.scene.objects)).counts()
    };
    Counts {
        shown,
        border: edges.border_edges,
        non_manifold: edges.non_manifold_edges,
        inconsistent: edges.inconsistent_edges,
    }
}

fn welded(objects: &[Object]) -> Mesh {
    let mut surface = Surface::default();
    for object in objects {
        let first = surface.positions.len() as u32;
        surface.positions.extend(object.mesh.positions());
        surface.triangles.extend(object.mesh.triangles().iter().map(|t| t.map(|i| first + i)));
    }
    Mesh::new(surface).expect("the objects are meshes already")
}
