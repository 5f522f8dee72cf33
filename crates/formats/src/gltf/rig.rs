//! What the animations of a file move, and where that is at a moment.
//!
//! Everything is found again for each moment, from rest: what a moment looks like does not depend on what was shown before.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use umbrae_core::Scene;

use super::animation::{Channel, Clip, Path};
use super::appearance;
use super::document::{self, Document};
use super::node::{Local, Tree};
use super::shape::{Placement, Reach, morph_weights};
use super::skin::Skin;
use crate::error::quoted;
use crate::warnings::{Warnings, Words};
use crate::{UpAxis, Warning};

/// What can move: nodes that are moved or are below one that is, and what is shown there.
#[derive(Debug)]
pub(crate) struct Rig {
    pub(crate) clips: Vec<Clip>,
    nodes: Nodes,
    objects: Vec<MovingObject>,
    cameras: Vec<Shown>,
    lights: Vec<Shown>,
    /// As in the file.
    file_cameras: Vec<document::Camera>,
    file_lights: Vec<document::Light>,
    origin: DVec3,
}

/// The nodes that can move.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    /// Parents before their children.
    nodes: Vec<MovingNode>,
    /// From the file's number of a node to its place in `nodes`.
    place_of_node: BTreeMap<usize, usize>,
}

#[derive(Debug)]
struct MovingNode {
    parent: Parent,
    rest: Local,
}

#[derive(Debug)]
enum Parent {
    /// Where it always is.
    Fixed(DAffine3),
    /// Its place in [`Nodes::nodes`].
    Moving(usize),
}

/// An object that can move or bend.
#[derive(Debug)]
pub(super) struct MovingObject {
    /// Index into [`Scene::objects`].
    pub(super) object: usize,
    /// The file's number.
    pub(super) node: usize,
    pub(super) instance: Option<DAffine3>,
    pub(super) skin: Option<Arc<PlacedSkin>>,
    pub(super) reach: Arc<Reach>,
    pub(super) rest_weights: Vec<f32>,
}

/// A skin in the scene.
#[derive(Debug)]
pub(super) struct PlacedSkin {
    skin: Skin,
    /// For each joint where it takes vertices at rest, in the file's root space.
    pub(super) rest: Vec<DAffine3>,
    /// Whether some joint can move.
    pub(super) is_moving: bool,
    /// If so, where those joints are that can't, by the file's numbers.
    fixed: BTreeMap<usize, DAffine3>,
}

/// A camera or a light on a node that can move.
#[derive(Debug)]
pub(super) struct Shown {
    /// Index into the scene's.
    pub(super) in_scene: usize,
    /// Index into the file's.
    pub(super) in_file: usize,
    /// The file's number.
    pub(super) node: usize,
}

/// What of a scene can move, collected while it is built.
#[derive(Debug, Default)]
pub(super) struct Cast {
    pub(super) clips: Vec<Clip>,
    pub(super) nodes: Nodes,
    pub(super) objects: Vec<MovingObject>,
    pub(super) cameras: Vec<Shown>,
    pub(super) lights: Vec<Shown>,
}

/// Where everything is at one moment.
struct Moment {
    /// Of each of [`Nodes::nodes`].
    world_from_node: Vec<DAffine3>,
    /// By the file's numbers of nodes, where an animation says them.
    weights: BTreeMap<usize, Vec<f64>>,
}

const AT_REST: Words = [
    "object, camera or light can't follow its animation and is at rest",
    "objects, cameras or lights can't follow their animations and are at rest",
];

impl Nodes {
    /// Those that a channel of `clips` moves, and all below them.
    pub(super) fn new(clips: &[Clip], document: &Document, tree: &Tree) -> Self {
        let mut moved: Vec<usize> = clips.iter().flat_map(|clip| &clip.channels).map(|channel| channel.node).collect();
        moved.sort_unstable();
        let mut all = Self::default();
        if moved.is_empty() {
            return all;
        }
        for (place, (node, _)) in tree.nodes.iter().enumerate() {
            let parent = tree.parent(place).map(|parent| &tree.nodes[parent]);
            let moving_parent = parent.and_then(|(parent, _)| all.place_of_node.get(parent));
            let parent = match (moving_parent, parent) {
                (Some(&parent), _) => Parent::Moving(parent),
                (None, _) if moved.binary_search(node).is_err() => continue,
                (None, Some((_, world_from_parent))) => Parent::Fixed(*world_from_parent),
                (None, None) => Parent::Fixed(DAffine3::IDENTITY),
            };
            all.place_of_node.insert(*node, all.nodes.len());
            all.nodes.push(MovingNode { parent, rest: Local::of_node(&document.nodes[*node]) });
        }
        all
    }

    /// Whether a node, by the file's number, can move.
    pub(super) fn has(&self, node: usize) -> bool {
        self.place_of_node.contains_key(&node)
    }
}

impl PlacedSkin {
    /// What is wrong is said in words that fit after "skin 3: ".
    pub(super) fn new(skin: Skin, tree: &Tree, nodes: &Nodes) -> Result<Self, String> {
        let world_from_joint = |joint| tree.world_from_node(joint).unwrap_or(DAffine3::NAN);
        let rest = skin.pose(world_from_joint)?;
        let is_moving = skin.joints.iter().any(|&joint| nodes.has(joint));
        let fixed = skin.joints.iter().filter(|&&joint| is_moving && !nodes.has(joint));
        let fixed = fixed.map(|&joint| (joint, world_from_joint(joint))).collect();
        Ok(Self { skin, rest, is_moving, fixed })
    }
}

impl Rig {
    /// Everything that `cast` collected from the file that has these cameras and lights; `None` if the file has no animation.
    pub(super) fn new(
        cast: Cast,
        file_cameras: Vec<document::Camera>,
        file_lights: Vec<document::Light>,
        origin: DVec3,
    ) -> Option<Self> {
        let Cast { clips, nodes, objects, cameras, lights } = cast;
        (!clips.is_empty()).then_some(Self {
            clips,
            nodes,
            objects,
            cameras,
            lights,
            file_cameras,
            file_lights,
            origin,
        })
    }

    /// Shows `scene`, which is the one that was loaded, as it is `time_s` into those of the clips that `playing` names.
    ///
    /// Gives warnings for what can't be where its animation puts it, and is at rest. `None` if `scene` lacks what is moved.
    pub(crate) fn pose(&self, scene: &mut Scene, playing: &[usize], time_s: f64) -> Option<Vec<Warning>> {
        let is_there = |shown: &[Shown], count: usize| shown.iter().all(|shown| shown.in_scene < count);
        let has_objects = self.objects.iter().all(|moving| moving.object < scene.objects.len());
        if !has_objects || !is_there(&self.cameras, scene.cameras.len()) || !is_there(&self.lights, scene.lights.len())
        {
            return None;
        }
        let mut warnings = Warnings::default();
        let moment = self.moment(playing.iter().flat_map(|&clip| &self.clips[clip].channels), time_s);
        let rest = OnceCell::new();
        let rest = || rest.get_or_init(|| self.moment([], 0.0));
        for moving in &self.objects {
            let object = &mut scene.objects[moving.object];
            let placed = self.checked_placement(moving, &moment).or_else(|message| {
                warnings.add_one(AT_REST, || format!("{} at {time_s} s: {message}", quoted(&object.name)));
                self.placement(moving, rest())
            });
            let Ok(Placement { mut world_from_object, morph_weights, joints }) = placed else { continue };
            world_from_object.translation -= self.origin;
            object.world_from_object = world_from_object;
            if let Some(pose) = &mut object.pose {
                pose.morph_weights = morph_weights;
                pose.joints = joints;
            }
        }
        for shown in &self.cameras {
            let camera = &mut scene.cameras[shown.in_scene];
            let file = &self.file_cameras[shown.in_file];
            let at = |moment: &Moment| {
                appearance::camera(
                    file,
                    camera.name.clone(),
                    &self.turned(shown.node, moment),
                    &mut Warnings::default(),
                )
            };
            let moved = at(&moment).or_else(|| {
                warnings.add_one(AT_REST, || format!("camera {} at {time_s} s", quoted(&camera.name)));
                at(rest())
            });
            if let Some(moved) = moved {
                camera.eye = moved.eye - self.origin;
                (camera.forward, camera.up) = (moved.forward, moved.up);
            }
        }
        for shown in &self.lights {
            let light = &mut scene.lights[shown.in_scene];
            let file = &self.file_lights[shown.in_file];
            let at = |moment: &Moment| {
                appearance::light(file, light.name.clone(), &self.turned(shown.node, moment), &mut Warnings::default())
            };
            let moved = at(&moment).or_else(|| {
                warnings.add_one(AT_REST, || format!("light {} at {time_s} s", quoted(&light.name)));
                at(rest())
            });
            if let Some(moved) = moved {
                light.position = moved.position.moved_by(-self.origin);
                light.cone = moved.cone;
            }
        }
        Some(warnings.finish())
    }

    fn moment<'a>(&self, channels: impl IntoIterator<Item = &'a Channel>, time_s: f64) -> Moment {
        let mut locals: Vec<Local> = self.nodes.nodes.iter().map(|node| node.rest).collect();
        let mut weights = BTreeMap::new();
        for Channel { node, path, track } in channels {
            let Some(&place) = self.nodes.place_of_node.get(node) else { continue };
            match (path, &mut locals[place]) {
                (Path::Weights, _) => {
                    weights.insert(*node, track.numbers(time_s).collect());
                }
                (Path::Translation, Local::Parts { translation, .. }) => *translation = track.vector(time_s),
                (Path::Rotation, Local::Parts { rotation, .. }) => *rotation = Some(track.rotation(time_s)),
                (Path::Scale, Local::Parts { scale, .. }) => *scale = track.vector(time_s),
                // Channels that move nodes with a matrix were skipped.
                (_, Local::Matrix(_)) => {}
            }
        }
        let mut world_from_node: Vec<DAffine3> = Vec::with_capacity(locals.len());
        for (node, local) in self.nodes.nodes.iter().zip(locals) {
            let world_from_parent = match node.parent {
                Parent::Fixed(world_from_parent) => world_from_parent,
                Parent::Moving(parent) => world_from_node[parent],
            };
            world_from_node.push(world_from_parent * local.parent_from_node());
        }
        Moment { world_from_node, weights }
    }

    fn world_from_node(&self, node: usize, moment: &Moment) -> Option<DAffine3> {
        self.nodes.place_of_node.get(&node).map(|&place| moment.world_from_node[place])
    }

    /// Where a node that can move is, in scene axes.
    fn turned(&self, node: usize, moment: &Moment) -> DAffine3 {
        scene_from_file() * self.world_from_node(node, moment).unwrap_or(DAffine3::NAN)
    }

    fn checked_placement(&self, moving: &MovingObject, moment: &Moment) -> Result<Placement, String> {
        let placement = self.placement(moving, moment)?;
        placement.bounds(&moving.reach).map(|_| placement)
    }

    fn placement(&self, moving: &MovingObject, moment: &Moment) -> Result<Placement, String> {
        let given = moment.weights.get(&moving.node);
        let weights = match given {
            Some(given) => morph_weights(given.iter().copied(), moving.rest_weights.len()),
            None => moving.rest_weights.clone(),
        };
        let (world_from_mesh, joints) = match moving.skin.as_deref() {
            Some(PlacedSkin { skin, fixed, .. }) => {
                let world_from_node = |node| {
                    self.world_from_node(node, moment).or_else(|| fixed.get(&node).copied()).unwrap_or(DAffine3::NAN)
                };
                (scene_from_file(), skin.pose(world_from_node)?)
            }
            None => (self.turned(moving.node, moment), Vec::new()),
        };
        let world_from_object = moving.instance.map_or(world_from_mesh, |instance| world_from_mesh * instance);
        Ok(Placement { world_from_object, morph_weights: weights, joints })
    }
}

/// Scene axes from the file's.
pub(super) fn scene_from_file() -> DAffine3 {
    DAffine3::from_mat3(UpAxis::Y.scene_from_file())
}
