//! Skins: the joints that a mesh hangs on.

use glam::{DAffine3, DMat4};

use super::accessor::Accessors;
use super::document::Document;
use super::node::{Tree, affine};

/// A skin; all its joints are in the scene.
#[derive(Debug)]
pub(super) struct Skin {
    /// Index into the file's nodes, of each joint.
    pub(super) joints: Vec<usize>,
    /// For each joint, where a vertex of the mesh is seen from it when nothing is bent.
    pub(super) joint_from_mesh: Vec<DAffine3>,
}

impl Skin {
    /// What is wrong is said in words that fit after "skin 3: ".
    pub(super) fn read(
        index: usize,
        document: &Document,
        accessors: &Accessors<'_>,
        tree: &Tree,
    ) -> Result<Self, String> {
        let skins = &document.skins;
        let skin = skins.get(index).ok_or_else(|| format!("it does not exist; there are {}", skins.len()))?;
        let joints = skin.joints.clone();
        if let Some(joint) = joints.iter().find(|&&joint| tree.place_of_node(joint).is_none()) {
            return Err(format!("its joint, node {joint}, is not in the scene"));
        }
        let binds = match skin.inverse_bind_matrices {
            Some(accessor) => accessors.vectors(accessor)?,
            None => {
                accessors.charge(joints.len(), 16)?;
                vec![DMat4::IDENTITY.to_cols_array(); joints.len()]
            }
        };
        if joints.is_empty() || binds.len() < joints.len() {
            return Err(format!("it has {} joints and {} inverse bind matrices", joints.len(), binds.len()));
        }
        let transform = |(joint, bind): (usize, &[f64; 16])| {
            let joint_from_mesh = affine(&DMat4::from_cols_array(bind)).filter(DAffine3::is_finite);
            joint_from_mesh.ok_or_else(|| unusable(joint))
        };
        let joint_from_mesh = binds.iter().take(joints.len()).enumerate().map(transform).collect::<Result<_, _>>()?;
        Ok(Self { joints, joint_from_mesh })
    }

    /// For each joint where it takes vertices from rest, in the file's root space, when the joints are where `world_from_node` says.
    ///
    /// What is wrong is said in words that fit after "skin 3: ".
    pub(super) fn pose(&self, world_from_node: impl Fn(usize) -> DAffine3) -> Result<Vec<DAffine3>, String> {
        let world_from_mesh = |(joint, (&node, bind)): (usize, (&usize, &DAffine3))| {
            Some(world_from_node(node) * *bind).filter(DAffine3::is_finite).ok_or_else(|| unusable(joint))
        };
        self.joints.iter().zip(&self.joint_from_mesh).enumerate().map(world_from_mesh).collect()
    }
}

fn unusable(joint: usize) -> String {
    format!("the transform of joint {joint} can't be used")
}
