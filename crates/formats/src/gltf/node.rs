//! The tree of nodes, and where each node is in the world.

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};

use super::document::{Document, Node};
use crate::error::Problem;

/// The nodes of one scene, parents before their children.
#[derive(Debug)]
pub(super) struct Tree {
    /// Each with its transform, in the file's axes; not finite where the file's can't be used.
    pub(super) nodes: Vec<(usize, DAffine3)>,
    /// For each node of the file its place in `nodes`, or [`NOT_IN_SCENE`].
    place_of_node: Vec<u32>,
}

const NOT_IN_SCENE: u32 = u32::MAX;

impl Tree {
    /// Walks the default scene; without a default the first; without scenes all nodes that are no one's child.
    pub(super) fn walk(document: &Document) -> Result<Self, Problem> {
        let mut tree = Self { nodes: Vec::new(), place_of_node: vec![NOT_IN_SCENE; document.nodes.len()] };
        // A stack of our own: a file may nest nodes as deep as it is long. `None` above the roots.
        let mut waiting: Vec<(usize, Option<usize>)> =
            roots(document)?.into_iter().rev().map(|root| (root, None)).collect();
        while let Some((index, parent)) = waiting.pop() {
            let problem = |what: &str| match parent {
                Some(parent) => {
                    let name = document.nodes[parent].name.as_deref();
                    Problem::in_part("node", parent, name, format!("its child is node {index}, {what}"))
                }
                None => Problem::whole(format!("its scene shows node {index}, {what}")),
            };
            let Some(node) = document.nodes.get(index) else {
                return Err(problem(&format!("but there are {}", document.nodes.len())));
            };
            if tree.place_of_node[index] != NOT_IN_SCENE {
                return Err(problem("which already has a place; nodes must form a tree, without cycles"));
            }
            let world_from_parent =
                parent.map_or(DAffine3::IDENTITY, |parent| tree.nodes[tree.place_of_node[parent] as usize].1);
            tree.place_of_node[index] = tree.nodes.len() as u32;
            tree.nodes.push((index, world_from_parent * parent_from_node(node)));
            waiting.extend(node.children.iter().rev().map(|&child| (child, Some(index))));
        }
        Ok(tree)
    }

    /// Where a node is, if it is in the scene.
    pub(super) fn world_from_node(&self, node: usize) -> Option<DAffine3> {
        let place = *self.place_of_node.get(node)?;
        self.nodes.get(place as usize).map(|(_, world_from_node)| *world_from_node)
    }
}

fn roots(document: &Document) -> Result<Vec<usize>, Problem> {
    if document.scenes.is_empty() {
        let mut is_child = vec![false; document.nodes.len()];
        for &child in document.nodes.iter().flat_map(|node| &node.children) {
            if let Some(is_child) = is_child.get_mut(child) {
                *is_child = true;
            }
        }
        return Ok((0..document.nodes.len()).filter(|&node| !is_child[node]).collect());
    }
    let scene = document.scene.unwrap_or(0);
    let roots = document.scenes.get(scene).ok_or_else(|| {
        Problem::whole(format!("its default scene is {scene}, but there are {}", document.scenes.len()))
    })?;
    Ok(roots.nodes.clone())
}

fn parent_from_node(node: &Node) -> DAffine3 {
    if let Some(matrix) = &node.matrix {
        return affine(&DMat4::from_cols_array(matrix)).unwrap_or(UNUSABLE);
    }
    let rotation = node.rotation.as_deref().map_or(Some(DQuat::IDENTITY), |&rotation| rotation_of(rotation));
    let scale = node.scale.as_deref().map_or(DVec3::ONE, |&scale| scale.into());
    let translation = node.translation.as_deref().map_or(DVec3::ZERO, |&translation| translation.into());
    rotation.map_or(UNUSABLE, |rotation| DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}

const UNUSABLE: DAffine3 = DAffine3::NAN;

/// The rotation of a quaternion x, y, z, w of any length but 0.
pub(super) fn rotation_of(quaternion: [f64; 4]) -> Option<DQuat> {
    DVec4::from(quaternion).try_normalize().map(DQuat::from_vec4)
}

/// What inverting a matrix in `f32` leaves in the row that should be 0, 0, 0, 1.
const AFFINE_TOLERANCE: f64 = 1e-5;

/// The affine transform that a matrix is; `None` if it is a projection.
pub(super) fn affine(matrix: &DMat4) -> Option<DAffine3> {
    matrix.row(3).abs_diff_eq(DVec4::W, AFFINE_TOLERANCE).then(|| DAffine3::from_mat4(*matrix))
}

/// Whether something placed by this transform is anywhere, and has a size.
pub(super) fn is_usable(transform: &DAffine3) -> bool {
    transform.is_finite() && transform.matrix3.determinant() != 0.0
}
