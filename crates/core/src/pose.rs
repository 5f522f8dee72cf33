//! Vertices that a skeleton or morph targets move.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};

/// How strongly a vertex hangs on a joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Influence {
    /// Index into [`Pose::joints`].
    pub joint: u32,
    /// The weights of a vertex add up to 1.
    pub weight: f32,
}

/// What is known of a mesh's vertices beyond their place at rest; shared by all poses of the mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deformer {
    /// For each morph target, an offset for each of the mesh's positions.
    pub morph_offsets: Vec<Vec<Vec3>>,
    /// For each of the mesh's positions, what it hangs on: a slice of [`Deformer::influences`]. Empty without a skin.
    pub influence_ranges: Vec<[u32; 2]>,
    /// See [`Deformer::influence_ranges`].
    pub influences: Vec<Influence>,
}

/// A mesh at one moment: `world_from_object * sum of weight * joint * (rest + sum of morph weight * offset)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Shared by all poses of a mesh.
    pub deformer: Arc<Deformer>,
    /// One for each morph target.
    pub morph_weights: Vec<f32>,
    /// For each joint where it takes vertices from rest, in object space; empty without a skin.
    pub joints: Vec<DAffine3>,
}

impl Pose {
    /// Where vertex `v`, at `rest`, is in this pose; object space.
    ///
    /// # Panics
    ///
    /// If the deformer is not of the mesh that has that vertex, or a vertex hangs on a joint that is not there.
    pub fn position(&self, v: usize, rest: Vec3) -> DVec3 {
        let mut position = rest.as_dvec3();
        for (&weight, offsets) in self.morph_weights.iter().zip(&self.deformer.morph_offsets) {
            // Most targets of a face are at 0, and each is memory elsewhere.
            if weight != 0.0 {
                position += f64::from(weight) * offsets[v].as_dvec3();
            }
        }
        let Some(&[start, end]) = self.deformer.influence_ranges.get(v) else { return position };
        self.deformer.influences[start as usize..end as usize]
            .iter()
            .map(|on| f64::from(on.weight) * self.joints[on.joint as usize].transform_point3(position))
            .sum()
    }

    /// The same pose of a mesh that has only `vertices` of this one's, in that order.
    pub(crate) fn of_vertices(&self, vertices: &[u32]) -> Self {
        let mut deformer = Deformer::default();
        for offsets in &self.deformer.morph_offsets {
            deformer.morph_offsets.push(vertices.iter().map(|&v| offsets[v as usize]).collect());
        }
        if !self.deformer.influence_ranges.is_empty() {
            for &v in vertices {
                let [start, end] = self.deformer.influence_ranges[v as usize];
                let first = deformer.influences.len() as u32;
                deformer.influences.extend_from_slice(&self.deformer.influences[start as usize..end as usize]);
                deformer.influence_ranges.push([first, first + end - start]);
            }
        }
        Self { deformer: Arc::new(deformer), morph_weights: self.morph_weights.clone(), joints: self.joints.clone() }
    }
}
