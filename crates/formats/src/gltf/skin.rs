//! Where the joints of a skin are when nothing moves.

use glam::{DAffine3, DMat4, DVec3};

use super::accessor::Accessors;
use super::document::Document;
use super::node::{Tree, affine};

/// A skin at rest.
#[derive(Debug)]
pub(super) struct Skin {
    /// Where the posed mesh is placed: a mere translation, so that its positions stay small numbers.
    pub(super) world_from_posed: DAffine3,
    /// For each joint, where it takes vertices from the mesh's own space to the posed one's.
    pub(super) posed_from_mesh: Vec<DAffine3>,
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
        let world_from_joint = |&joint: &usize| {
            tree.world_from_node(joint).ok_or_else(|| format!("its joint, node {joint}, is not in the scene"))
        };
        let joints: Vec<DAffine3> = skin.joints.iter().map(world_from_joint).collect::<Result<_, _>>()?;
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
        let first = joints.first().map_or(DVec3::ZERO, |joint| joint.translation);
        let world_from_mesh = |(joint, (world_from_joint, bind)): (usize, (&DAffine3, &[f64; 16]))| {
            let joint_from_mesh = affine(&DMat4::from_cols_array(bind));
            let world_from_mesh = joint_from_mesh.map(|joint_from_mesh| *world_from_joint * joint_from_mesh);
            world_from_mesh
                .filter(DAffine3::is_finite)
                .ok_or_else(|| format!("the transform of joint {joint} can't be used"))
        };
        let to_posed = DAffine3::from_translation(-first);
        let posed_from_mesh = joints
            .iter()
            .zip(&binds)
            .enumerate()
            .map(|joint| world_from_mesh(joint).map(|world_from_mesh| to_posed * world_from_mesh))
            .collect::<Result<_, _>>()?;
        Ok(Self { world_from_posed: DAffine3::from_translation(first), posed_from_mesh })
    }
}
