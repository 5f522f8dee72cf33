//! A mesh as objects show it, and how far its vertices get in a pose, without a look at each of them.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrae_core::{Bounds, Deformer, Mesh};

use super::deform::HighestJoint;
use crate::place::{MAX_COORDINATE, is_in_range};

/// What the objects that show one mesh share.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) mesh: Arc<Mesh>,
    /// `None` where nothing moves vertices.
    pub(super) deformer: Option<Arc<Deformer>>,
    pub(super) highest_joint: Option<HighestJoint>,
    pub(super) reach: Arc<Reach>,
}

/// Boxes around the vertices of a mesh at rest, and around the offsets of its morph targets.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reach {
    /// The vertices that hang on each joint that any hang on; or all, on no joint.
    rest: Vec<(Option<u32>, Bounds)>,
    offsets: Vec<Bounds>,
}

impl Reach {
    pub(super) fn new(mesh: &Mesh, deformer: Option<&Deformer>) -> Self {
        let Some(deformer) = deformer.filter(|deformer| !deformer.influence_ranges.is_empty()) else {
            return Self { rest: vec![(None, mesh.bounds())], offsets: deformer.map_or(Vec::new(), offsets) };
        };
        let mut boxes: BTreeMap<u32, Bounds> = BTreeMap::new();
        for (position, &[start, end]) in mesh.positions().iter().zip(&deformer.influence_ranges) {
            for on in &deformer.influences[start as usize..end as usize] {
                let bounds = boxes.entry(on.joint).or_insert(Bounds::EMPTY);
                *bounds = bounds.including(position.as_dvec3());
            }
        }
        let rest = boxes.into_iter().map(|(joint, bounds)| (Some(joint), bounds)).collect();
        Self { rest, offsets: offsets(deformer) }
    }

    /// A box that holds the mesh in `placement`; an `Err` is where it leaves the range of coordinates.
    ///
    /// A vertex is somewhere between the places to which its joints take it, so it is in a box around the boxes of the joints.
    fn bounds(&self, placement: &Placement) -> Result<Bounds, DVec3> {
        let mut moved = Bounds { min: DVec3::ZERO, max: DVec3::ZERO };
        for (&weight, offset) in placement.morph_weights.iter().zip(&self.offsets) {
            let [a, b] = [offset.min, offset.max].map(|end| f64::from(weight) * end);
            moved = Bounds { min: moved.min + a.min(b), max: moved.max + a.max(b) };
        }
        let mut all = Bounds::EMPTY;
        for (joint, rest) in &self.rest {
            let morphed = Bounds { min: rest.min + moved.min, max: rest.max + moved.max };
            let mut world_from_mesh = placement.world_from_object;
            if let Some(joint) = joint {
                world_from_mesh *= placement.joints[*joint as usize];
            }
            for corner in morphed.corners().map(|corner| world_from_mesh.transform_point3(corner)) {
                if !is_in_range(corner) {
                    return Err(corner);
                }
                all = all.including(corner);
            }
        }
        Ok(all)
    }
}

/// Where an object is and how it is bent, in scene axes but not yet about the scene's origin.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placement {
    /// For an object with a skin from the file's root space, as glTF says: the joints alone place it, its node has no effect.
    pub(super) world_from_object: DAffine3,
    /// One for each morph target.
    pub(super) morph_weights: Vec<f32>,
    /// One for each joint that a vertex hangs on, at least; from the mesh's own space to the file's root space.
    pub(super) joints: Vec<DAffine3>,
}

impl Placement {
    /// A box that holds the mesh there. What is wrong is said in words that fit after "node 3: ".
    pub(super) fn bounds(&self, reach: &Reach) -> Result<Bounds, String> {
        if !self.world_from_object.is_finite() {
            return Err(TRANSFORM.to_owned());
        }
        if let Some(bad) = self.morph_weights.iter().position(|weight| !weight.is_finite()) {
            return Err(format!("its morph weight {bad} is {}", self.morph_weights[bad]));
        }
        let far = |far: DVec3| format!("its transform takes it to {far}; coordinates must be below {MAX_COORDINATE:e}");
        reach.bounds(self).map_err(far)
    }
}

/// Said of a node whose place is none.
pub(super) const TRANSFORM: &str = "its transform can't be used: a number in it is not finite, or its scale is 0";

/// As many weights as there are morph targets; without a weight a target moves nothing.
pub(super) fn morph_weights(given: impl IntoIterator<Item = f64>, target_count: usize) -> Vec<f32> {
    let given = given.into_iter().map(|weight| weight as f32);
    given.chain(std::iter::repeat(0.0)).take(target_count).collect()
}

fn offsets(deformer: &Deformer) -> Vec<Bounds> {
    let bounds = |offsets: &Vec<Vec3>| Bounds::of_points(offsets.iter().map(|offset| offset.as_dvec3()));
    deformer.morph_offsets.iter().map(bounds).collect()
}

#[cfg(test)]
mod tests {
    use umbrae_core::{Influence, Object, Pose, shapes};

    use super::*;

    #[test]
    fn no_vertex_of_a_pose_is_outside_of_its_reach() {
        let mesh = Arc::new(Mesh::new(shapes::cuboid(Vec3::ZERO, Vec3::ONE)).expect("a good box"));
        let count = mesh.positions().len() as u32;
        let wave =
            |scale: f32| (0..count).map(|v| scale * Vec3::new((v as f32).sin(), (v as f32).cos(), v as f32)).collect();
        let deformer = Arc::new(Deformer {
            morph_offsets: vec![wave(1.0), wave(-0.25)],
            influence_ranges: (0..count).map(|v| [2 * v, 2 * v + 2]).collect(),
            influences: (0..count)
                .flat_map(|v| [(0, 0.25 * (v % 4) as f32), (1 + v % 2, 1.0 - 0.25 * (v % 4) as f32)])
                .map(|(joint, weight)| Influence { joint, weight })
                .collect(),
        });
        let joints: Vec<DAffine3> = (0..3)
            .map(|j| DAffine3::from_rotation_y(f64::from(j)) * DAffine3::from_translation(DVec3::X * f64::from(j)))
            .collect();
        let placement =
            Placement { world_from_object: DAffine3::from_rotation_z(1.0), morph_weights: vec![-1.5, 2.0], joints };
        let reach = Reach::new(&mesh, Some(&deformer)).bounds(&placement).expect("it is not far");
        let Placement { world_from_object, morph_weights, joints } = placement;
        let pose = Some(Pose { deformer, morph_weights, joints });
        let bounds = Object { pose, ..Object::new("box", mesh, world_from_object) }.bounds();
        assert_eq!(reach.union(bounds), reach);
        assert!(reach.radius() < 3.0 * bounds.radius(), "and it is not much larger: {reach:?} around {bounds:?}");
    }
}
