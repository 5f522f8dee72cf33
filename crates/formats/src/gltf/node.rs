//! The tree of nodes, and where each node is in the world.

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};

use super::document::{Document, Node};
use crate::error::Problem;

/// The nodes of one scene, parents before their children.
#[derive(Debug)]
pub(super) struct Tree {
    /// Each with its transform, in the file's axes; not finite where the file's can't be used.
    pub(super) nodes: Vec<(usize, DAffine3)>,
    /// For each of `nodes` the place of its parent among them, or [`NOT_IN_SCENE`] for a root.
    parents: Vec<u32>,
    /// For each node of the file its place in `nodes`, or [`NOT_IN_SCENE`].
    place_of_node: Vec<u32>,
}

const NOT_IN_SCENE: u32 = u32::MAX;

impl Tree {
    /// Walks the default scene; without a default the first; without scenes all nodes that are no one's child.
    pub(super) fn walk(document: &Document) -> Result<Self, Problem> {
        let place_of_node = vec![NOT_IN_SCENE; document.nodes.len()];
        let mut tree = Self { nodes: Vec::new(), parents: Vec::new(), place_of_node };
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
            let parent_place = parent.map_or(NOT_IN_SCENE, |parent| tree.place_of_node[parent]);
            let world_from_parent = tree
                .nodes
                .get(parent_place as usize)
                .map_or(DAffine3::IDENTITY, |(_, world_from_parent)| *world_from_parent);
            tree.place_of_node[index] = tree.nodes.len() as u32;
            tree.parents.push(parent_place);
            tree.nodes.push((index, world_from_parent * Local::of_node(node).parent_from_node()));
            waiting.extend(node.children.iter().rev().map(|&child| (child, Some(index))));
        }
        Ok(tree)
    }

    /// The place of a node in `nodes`, if it is in the scene.
    pub(super) fn place_of_node(&self, node: usize) -> Option<usize> {
        self.place_of_node.get(node).filter(|&&place| place != NOT_IN_SCENE).map(|&place| place as usize)
    }

    /// The place of the parent of the node at `place`; `None` for a root.
    pub(super) fn parent(&self, place: usize) -> Option<usize> {
        Some(self.parents[place]).filter(|&parent| parent != NOT_IN_SCENE).map(|parent| parent as usize)
    }

    /// Where a node is, if it is in the scene.
    pub(super) fn world_from_node(&self, node: usize) -> Option<DAffine3> {
        self.place_of_node(node).map(|place| self.nodes[place].1)
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

/// Where a node is in its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Local {
    /// A matrix, which no animation changes.
    Matrix(DAffine3),
    /// A scale, then a rotation, then a translation, each of which an animation may replace.
    Parts {
        scale: DVec3,
        /// `None` if the file's is none.
        rotation: Option<DQuat>,
        translation: DVec3,
    },
}

impl Local {
    /// As the file says.
    pub(super) fn of_node(node: &Node) -> Self {
        if let Some(matrix) = &node.matrix {
            return Self::Matrix(affine(&DMat4::from_cols_array(matrix)).unwrap_or(UNUSABLE));
        }
        Self::Parts {
            scale: node.scale.as_deref().map_or(DVec3::ONE, |&scale| scale.into()),
            rotation: node.rotation.as_deref().map_or(Some(DQuat::IDENTITY), |&rotation| rotation_of(rotation)),
            translation: node.translation.as_deref().map_or(DVec3::ZERO, |&translation| translation.into()),
        }
    }

    /// Not finite where the file's numbers can't be used.
    pub(super) fn parent_from_node(self) -> DAffine3 {
        match self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { scale, rotation, translation } => rotation
                .map_or(UNUSABLE, |rotation| DAffine3::from_scale_rotation_translation(scale, rotation, translation)),
        }
    }
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
