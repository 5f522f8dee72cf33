//! What moves the vertices of a mesh: morph targets, and the joints that they hang on.

use std::hash::Hash;

use glam::{DVec3, Vec3};
use rustc_hash::FxHashMap;
use umbrae_core::{Deformer, Influence, Mesh};

use super::accessor::Accessors;
use super::document::Primitive;
use super::mesh::check_count;
use crate::warnings::{Warnings, Words};

/// What moves each vertex of a mesh, as read: not welded.
#[derive(Debug, Default)]
pub(super) struct Deformation {
    vertex_count: usize,
    /// For each morph target an offset for each vertex.
    offsets: Vec<Vec<Vec3>>,
    /// For each vertex, if they hang on joints.
    influence_ranges: Vec<[u32; 2]>,
    influences: Vec<Influence>,
    /// The highest joint that a vertex hangs on, and its primitive and its number in that.
    pub(super) highest_joint: Option<HighestJoint>,
}

/// Where the highest joint of a mesh is named first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct HighestJoint {
    pub(super) joint: u32,
    pub(super) primitive: usize,
    pub(super) vertex: usize,
}

const TARGET_SKIPPED: Words =
    ["morph target can't be used and moves nothing", "morph targets can't be used and move nothing"];

/// What an offset is charged as that a file does not spend a byte on; no real one has many.
const NUMBERS_OF_ZERO_OFFSET: usize = 12;

impl Deformation {
    /// Adds the morph targets of `vertex_count` vertices of a primitive, and what they hang on if `has_skin`.
    ///
    /// What is wrong is said in words that fit after "primitive 3: ".
    pub(super) fn add(
        &mut self,
        (index, primitive): (usize, &Primitive),
        vertex_count: usize,
        has_skin: bool,
        accessors: &Accessors<'_>,
        warnings: &mut Warnings,
    ) -> Result<(), String> {
        self.add_targets((index, primitive), vertex_count, accessors, warnings)?;
        if has_skin {
            self.add_influences((index, primitive), vertex_count, accessors)?;
        }
        self.vertex_count += vertex_count;
        Ok(())
    }

    fn add_targets(
        &mut self,
        (index, primitive): (usize, &Primitive),
        vertex_count: usize,
        accessors: &Accessors<'_>,
        warnings: &mut Warnings,
    ) -> Result<(), String> {
        let target_count = self.offsets.len().max(primitive.targets.len());
        // Where a primitive has fewer targets than others, the others move nothing of it; those zeros take memory too.
        accessors.charge(target_count - self.offsets.len(), NUMBERS_OF_ZERO_OFFSET * self.vertex_count)?;
        self.offsets.resize_with(target_count, || vec![Vec3::ZERO; self.vertex_count]);
        for (number, offsets) in self.offsets.iter_mut().enumerate() {
            let read = primitive.targets.get(number).and_then(|target| target.get("POSITION")).map(|&accessor| {
                let read = accessors.vectors::<3>(accessor)?;
                check_count("it", read.len(), vertex_count)?;
                // They are kept twice for a while, as read and as welded.
                accessors.charge(vertex_count, 3)?;
                let read: Vec<Vec3> = read.into_iter().map(|offset| DVec3::from(offset).as_vec3()).collect();
                match read.iter().position(|offset| !offset.is_finite()) {
                    Some(bad) => Err(format!("its offset {bad} is {}", read[bad])),
                    None => Ok(read),
                }
            });
            match read.transpose() {
                Ok(Some(read)) => offsets.extend(read),
                Ok(None) => {
                    accessors.charge(vertex_count, NUMBERS_OF_ZERO_OFFSET)?;
                    offsets.resize(offsets.len() + vertex_count, Vec3::ZERO);
                }
                Err(message) => {
                    warnings.add_one(TARGET_SKIPPED, || format!("target {number} of primitive {index}: {message}"));
                    accessors.charge(vertex_count, NUMBERS_OF_ZERO_OFFSET)?;
                    offsets.resize(offsets.len() + vertex_count, Vec3::ZERO);
                }
            }
        }
        Ok(())
    }

    fn add_influences(
        &mut self,
        (index, primitive): (usize, &Primitive),
        vertex_count: usize,
        accessors: &Accessors<'_>,
    ) -> Result<(), String> {
        let mut sets = Vec::new();
        for set in 0.. {
            let attribute = |name: &str| primitive.attributes.get(&format!("{name}_{set}"));
            let (Some(&joints), Some(&weights)) = (attribute("JOINTS"), attribute("WEIGHTS")) else { break };
            let (joints, weights) = (accessors.vectors::<4>(joints)?, accessors.vectors::<4>(weights)?);
            check_count("JOINTS", joints.len(), vertex_count)?;
            check_count("WEIGHTS", weights.len(), vertex_count)?;
            sets.push((joints, weights));
        }
        let mut on = Vec::new();
        for vertex in 0..vertex_count {
            on.clear();
            for (joints, weights) in &sets {
                on.extend(joints[vertex].iter().zip(&weights[vertex]).map(|(&joint, &weight)| (joint as u32, weight)));
            }
            let first = self.influences.len();
            normalized(&mut on, &mut self.influences).map_err(|message| format!("vertex {vertex} {message}"))?;
            let last = self.influences.len();
            self.influence_ranges.push([first as u32, last as u32]);
            let highest = self.influences[first..last].iter().map(|on| on.joint).max();
            if let Some(joint) = highest.filter(|&joint| self.highest_joint.is_none_or(|highest| joint > highest.joint))
            {
                self.highest_joint = Some(HighestJoint { joint, primitive: index, vertex });
            }
        }
        Ok(())
    }

    /// Whether nothing ever moves a vertex.
    pub(super) fn is_none(&self) -> bool {
        self.offsets.is_empty() && self.influence_ranges.is_empty()
    }

    /// Equal for two vertices exactly if everything moves both alike, see [`umbrae_core::Surface::weld_keys`].
    pub(super) fn weld_keys(&self) -> Vec<u32> {
        let mut keys = vec![0; self.vertex_count];
        for offsets in &self.offsets {
            // Adding +0 turns -0 into +0.
            split(&mut keys, |v| (offsets[v] + Vec3::ZERO).to_array().map(f32::to_bits));
        }
        let longest = self.influence_ranges.iter().map(|[start, end]| end - start).max().unwrap_or(0);
        for i in 0..longest {
            split(&mut keys, |v| {
                let [start, end] = self.influence_ranges[v];
                let on = (start + i < end).then(|| self.influences[(start + i) as usize]);
                on.map(|on| [on.joint, on.weight.to_bits()])
            });
        }
        keys
    }

    /// The same for the vertices of the mesh that was made of these.
    pub(super) fn of_mesh(&self, mesh: &Mesh) -> Deformer {
        let sources = || mesh.source_vertices().iter().map(|&v| v as usize);
        let mut deformer = Deformer {
            morph_offsets: self.offsets.iter().map(|offsets| sources().map(|v| offsets[v]).collect()).collect(),
            ..Deformer::default()
        };
        if !self.influence_ranges.is_empty() {
            for [start, end] in sources().map(|v| self.influence_ranges[v]) {
                let first = deformer.influences.len() as u32;
                deformer.influences.extend_from_slice(&self.influences[start as usize..end as usize]);
                deformer.influence_ranges.push([first, first + end - start]);
            }
        }
        deformer
    }
}

/// Splits classes of vertices with equal keys by one more thing in which they may differ.
fn split<T: Hash + Eq>(keys: &mut [u32], differing: impl Fn(usize) -> T) {
    let mut finer = FxHashMap::default();
    for (v, key) in keys.iter_mut().enumerate() {
        let next = finer.len() as u32;
        *key = *finer.entry((*key, differing(v))).or_insert(next);
    }
}

/// Weights are whole multiples of 1 / this, so that those of a vertex add up to 1 exactly: what is left over would be multiplied by
/// where the joints are, which may be far from the origin.
const WEIGHT_STEPS: f64 = (1 << 24) as f64;

/// Adds to `influences` those of one vertex: each joint once, in order, without weights of 0, with weights that add up to 1 exactly.
///
/// What is wrong is said in words that fit after "vertex 3 ".
fn normalized(on: &mut Vec<(u32, f64)>, influences: &mut Vec<Influence>) -> Result<(), String> {
    if let Some((joint, weight)) = on.iter().find(|(_, weight)| !(*weight >= 0.0 && weight.is_finite())) {
        return Err(format!("hangs on joint {joint} with a weight of {weight}"));
    }
    on.retain(|(_, weight)| *weight > 0.0);
    on.sort_unstable_by_key(|(joint, _)| *joint);
    on.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        kept.1 += if is_same { next.1 } else { 0.0 };
        is_same
    });
    let total: f64 = on.iter().map(|(_, weight)| weight).sum();
    let Some(&(strongest, _)) = on.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Err("hangs on no joint".to_owned());
    };
    for (_, weight) in on.iter_mut() {
        *weight = (*weight / total * WEIGHT_STEPS).floor();
    }
    let given: f64 = on.iter().map(|(_, steps)| steps).sum();
    for &(joint, steps) in on.iter() {
        // The strongest takes what rounding down left over.
        let steps = if joint == strongest { steps + (WEIGHT_STEPS - given) } else { steps };
        if steps > 0.0 {
            influences.push(Influence { joint, weight: (steps / WEIGHT_STEPS) as f32 });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(on: &[(u32, f64)]) -> Result<Vec<(u32, f32)>, String> {
        let mut influences = Vec::new();
        normalized(&mut on.to_vec(), &mut influences)?;
        Ok(influences.iter().map(|on| (on.joint, on.weight)).collect())
    }

    #[test]
    fn influences_that_mean_the_same_become_the_same() {
        let expected = Ok(vec![(2, 0.25), (7, 0.75)]);
        assert_eq!(of(&[(2, 0.25), (7, 0.75)]), expected);
        assert_eq!(of(&[(7, 3.0), (0, 0.0), (2, 1.0)]), expected, "any order, zeros, another scale");
        assert_eq!(of(&[(7, 0.5), (2, 0.25), (7, 0.25)]), expected, "a joint named twice");
    }

    #[test]
    fn weights_add_up_to_one_exactly() {
        let thirds = of(&[(0, 1.0), (1, 1.0), (2, 1.0)]).expect("good weights");
        assert_eq!(thirds.iter().map(|(_, weight)| weight).sum::<f32>(), 1.0);
        let bytes = of(&[(0, 127.0 / 255.0), (1, 76.0 / 255.0), (2, 51.0 / 255.0), (3, 1e-12)]).expect("good weights");
        assert_eq!(bytes.iter().map(|(_, weight)| weight).sum::<f32>(), 1.0);
        assert_eq!(bytes.len(), 3, "next to nothing is nothing");
    }

    #[test]
    fn weights_that_are_none_are_told() {
        assert_eq!(of(&[(3, 0.0)]), Err("hangs on no joint".to_owned()));
        assert_eq!(of(&[(3, 1.0), (4, -0.5)]), Err("hangs on joint 4 with a weight of -0.5".to_owned()));
        assert!(of(&[(3, f64::NAN)]).is_err());
    }

    #[test]
    fn keys_are_equal_exactly_where_everything_moves_vertices_alike() {
        let on = |joint, weight| Influence { joint, weight };
        let deformation = Deformation {
            vertex_count: 5,
            offsets: vec![
                vec![Vec3::X, Vec3::X, Vec3::Y, Vec3::X, Vec3::X],
                vec![Vec3::ZERO, -Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO],
            ],
            influence_ranges: vec![[0, 1], [1, 2], [2, 3], [3, 5], [5, 7]],
            influences: vec![on(0, 1.0), on(0, 1.0), on(0, 1.0), on(0, 0.5), on(1, 0.5), on(0, 0.5), on(2, 0.5)],
            highest_joint: None,
        };
        let keys = deformation.weld_keys();
        assert_eq!(keys[0], keys[1], "-0 is 0");
        let mut different = keys[1..].to_vec();
        different.sort_unstable();
        different.dedup();
        assert_eq!(different.len(), 4, "{keys:?}");
    }
}
