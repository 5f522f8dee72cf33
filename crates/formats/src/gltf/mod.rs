//! glTF 2.0 and GLB.
//!
//! ```text
//!   container    chunks, files beside, data URIs     -> bytes of each buffer
//!   document     the JSON                            -> what the file says
//!   accessor     both, and a budget                  -> checked numbers
//!   node         the tree of the scene               -> transforms in f64
//!   mesh         primitives                          -> one surface for each mesh
//!   deform       morph targets, joints of vertices   -> what moves the vertices of a mesh
//!   skin         joints                              -> a transform for each
//!   shape        both                                -> what objects that show a mesh share, and where they are
//!   appearance   materials, lights, cameras
//!   texture      pictures, and where on them corners are
//!   animation    channels, and keys with `sampler`   -> what moves nodes
//!   rig          all of it                           -> the scene at a moment
//! ```
//!
//! A mesh stays in its own space, where it was modelled, and is shared by all nodes that show it; its nodes' transforms carry the turn
//! from y up to z up, and the origin. Morph weights and joints are poses of the objects that show it; a model that was loaded is at rest.
//!
//! The space of an object with a skin is the root space of the file, in which glTF places joints: its pose takes the mesh there, and
//! [`Object::world_from_object`] is the turn and the origin (and an instance's transform), whatever moves.

mod accessor;
mod animation;
mod appearance;
mod budget;
mod container;
mod deform;
mod document;
mod mesh;
mod node;
mod rig;
mod sampler;
mod shape;
mod skin;
mod texture;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use umbrae_core::{Bounds, Light, Material, Mesh, NamedCamera, Object, Pose, Scene};

use crate::animation::NOT_PLAYED;
use crate::error::{Problem, quoted};
use crate::load::Context;
use crate::place::{NORMAL_LEFT_OUT, OBJECT_SKIPPED, origin_of};
use crate::warnings::Warnings;
use crate::{Animations, Format, Model, UpAxis};

use accessor::Accessors;
use container::{Buffers, Chunks};
use deform::HighestJoint;
use document::{Document, Instancing, Node};
use mesh::Materials;
use node::{Tree, is_usable, rotation_of};
use rig::{Cast, MovingObject, Nodes, PlacedSkin, Shown, scene_from_file};
use shape::{Placement, Reach, Shape, morph_weights};
use skin::Skin;
use texture::{Textures, UvSource};

pub(crate) use rig::Rig;

/// Reads a glTF or GLB file, and the buffers beside it.
pub(crate) fn read(bytes: &[u8], context: Context<'_>) -> Result<Model, Problem> {
    let mut warnings = Warnings::default();
    let chunks = Chunks::split(bytes)?;
    let document = Document::read(chunks.json)?;
    check_extensions(&document, &mut warnings)?;
    if context.options.up.is_some() {
        warnings.add(1, ["up axis was ignored, because glTF says that y is up", "up axes were ignored"]);
    }
    let buffers = Buffers::load(&document, chunks.binary, context.folder);
    let accessors = Accessors::new(&document, buffers, bytes.len());
    let looks = appearance::materials(&document, Textures::new(&document, &accessors, context.folder), &mut warnings);
    let tree = Tree::walk(&document)?;
    let clips = animation::clips(&document, &accessors, &tree, &mut warnings);
    let nodes = Nodes::new(&clips, &document, &tree);
    let mut stage = Stage {
        document: &document,
        accessors: &accessors,
        wants_normals: context.options.normals,
        uv_sources: looks.uv_sources,
        tree: &tree,
        cast: Cast { clips, nodes, ..Cast::default() },
        shapes: BTreeMap::new(),
        skins: BTreeMap::new(),
        bounds: Bounds::EMPTY,
        triangles_shown: 0,
        first_problem: None,
        scene: Scene { materials: looks.materials, textures: looks.textures, ..Scene::default() },
        warnings,
    };
    // Comes after the file's own; for primitives that have none.
    stage.scene.materials.push(Material::default());
    for (index, world_from_node) in &tree.nodes {
        stage.show_node(*index, *world_from_node);
    }
    stage.warnings.add(document.animations.len(), NOT_PLAYED);
    if stage.scene.objects.is_empty() {
        return Err(stage.nothing_shown());
    }
    stage.move_to_origin();
    let (scene, cast, warnings) = (stage.scene, stage.cast, stage.warnings.finish());
    let rig = Rig::new(cast, document.cameras, document.extensions.punctual.lights, scene.origin);
    Ok(Model {
        scene,
        format: Format::Gltf,
        up: UpAxis::Y,
        crs: None,
        source_crs: None,
        warnings,
        animations: Animations::new(rig),
    })
}

/// Those without which shapes can't be read at all.
const UNREADABLE: [&str; 4] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_gaussian_splatting"];

/// Those that we read, or that concern only how surfaces look.
fn is_harmless(extension: &str) -> bool {
    ["KHR_mesh_quantization", "KHR_lights_punctual", "EXT_mesh_gpu_instancing"].contains(&extension)
        || ["KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "EXT_lights_"]
            .iter()
            .any(|prefix| extension.starts_with(prefix))
}

fn check_extensions(document: &Document, warnings: &mut Warnings) -> Result<(), Problem> {
    for extension in &document.extensions_required {
        if UNREADABLE.contains(&extension.as_str()) {
            return Err(Problem::whole(format!(
                "it needs the extension {extension}, which umbrae can't read; export it again without (for a file at \
                 hand: npx @gltf-transform/cli copy IN.glb OUT.glb)"
            )));
        }
        if !is_harmless(extension) {
            let words = ["required extension is unknown and ignored", "required extensions are unknown and ignored"];
            warnings.add_one(words, || quoted(extension));
        }
    }
    Ok(())
}

/// More than this many triangles, instances counted each, can be neither held nor drawn; a small file can ask for them.
const MAX_TRIANGLES_SHOWN: usize = 1 << 26;

/// What an object is charged as, see `budget`.
const NUMBERS_OF_OBJECT: usize = 64;

/// A transform takes as much memory as this many of the numbers that are charged.
const NUMBERS_OF_JOINT: usize = 24;

/// The scene while its nodes are walked; in scene axes, not yet about its origin.
struct Stage<'a> {
    document: &'a Document,
    accessors: &'a Accessors<'a>,
    wants_normals: bool,
    /// For each material of the file.
    uv_sources: Vec<Option<UvSource>>,
    tree: &'a Tree,
    cast: Cast,
    /// By mesh, and whether its vertices hang on joints; `None` for one without triangles, and what is wrong with one that can't be used.
    shapes: BTreeMap<(usize, bool), Result<Option<Shape>, Problem>>,
    skins: BTreeMap<usize, Result<Arc<PlacedSkin>, String>>,
    /// Holds all objects.
    bounds: Bounds,
    triangles_shown: usize,
    first_problem: Option<Problem>,
    scene: Scene,
    warnings: Warnings,
}

/// What a node shows, in one place or as many instances.
struct Actor<'a> {
    /// The file's number.
    node: usize,
    shape: Shape,
    skin: Option<Arc<PlacedSkin>>,
    /// Of the morph targets.
    weights: &'a [f64],
    /// In scene axes, not yet about the scene's origin.
    world_from_object: DAffine3,
    /// Whether an animation moves it.
    is_moving: bool,
}

impl Stage<'_> {
    fn show_node(&mut self, index: usize, world_from_node: DAffine3) {
        let node = &self.document.nodes[index];
        let world_from_node = scene_from_file() * world_from_node;
        if let Some(mesh) = node.mesh
            && let Err(problem) = self.show_mesh(index, node, mesh as usize, world_from_node)
        {
            self.skip_object(problem);
        }
        if let Some(camera) = node.camera {
            let in_file = camera as usize;
            if let Some(camera) = self.camera(node, in_file, &world_from_node) {
                let shown = Shown { in_scene: self.scene.cameras.len(), in_file, node: index };
                self.cast.cameras.extend(Some(shown).filter(|_| self.cast.nodes.has(index)));
                self.scene.cameras.push(camera);
            }
        }
        if let Some(light) = node.extensions.as_ref().and_then(|extensions| extensions.light.as_ref()) {
            let in_file = light.light;
            if let Some(light) = self.light(node, in_file, &world_from_node) {
                let shown = Shown { in_scene: self.scene.lights.len(), in_file, node: index };
                self.cast.lights.extend(Some(shown).filter(|_| self.cast.nodes.has(index)));
                self.scene.lights.push(light);
            }
        }
    }

    fn skip_object(&mut self, problem: Problem) {
        self.warnings.add_one(OBJECT_SKIPPED, || problem.to_string());
        self.first_problem.get_or_insert(problem);
    }

    fn camera(&mut self, node: &Node, index: usize, world_from_node: &DAffine3) -> Option<NamedCamera> {
        let Some(camera) = self.document.cameras.get(index) else {
            let words = ["camera that does not exist was skipped", "cameras that do not exist were skipped"];
            self.warnings.add_one(words, || format!("camera {index} of {}", self.document.cameras.len()));
            return None;
        };
        let name = name_of(node, camera.name.as_deref(), "camera", index);
        appearance::camera(camera, name, world_from_node, &mut self.warnings)
    }

    fn light(&mut self, node: &Node, index: usize, world_from_node: &DAffine3) -> Option<Light> {
        let lights = &self.document.extensions.punctual.lights;
        let Some(light) = lights.get(index) else {
            let words = ["light that does not exist was skipped", "lights that do not exist were skipped"];
            self.warnings.add_one(words, || format!("light {index} of {}", lights.len()));
            return None;
        };
        let name = name_of(node, light.name.as_deref(), "light", index);
        appearance::light(light, name, world_from_node, &mut self.warnings)
    }

    /// Adds the object or the instances that a node is.
    fn show_mesh(
        &mut self,
        index: usize,
        node: &Node,
        mesh_index: usize,
        world_from_node: DAffine3,
    ) -> Result<(), Problem> {
        let name = node.name.as_deref();
        let in_node = |message: String| Problem::in_part("node", index, name, message);
        let Some(source) = self.document.meshes.get(mesh_index) else {
            return Err(in_node(format!("its mesh is {mesh_index}, but there are {}", self.document.meshes.len())));
        };
        let name = name_of(node, source.name.as_deref(), "mesh", mesh_index);
        let (shape, skin) = match self.skinned(node, mesh_index) {
            Some((shape, skin)) => (shape, Some(skin)),
            None => (self.shape(mesh_index, false)?, None),
        };
        let Some(shape) = shape else { return Ok(()) };
        let actor = Actor {
            node: index,
            // As glTF says, the joints alone place a mesh with a skin: the node's own transform has no effect.
            world_from_object: if skin.is_some() { scene_from_file() } else { world_from_node },
            is_moving: self.cast.nodes.has(index) || skin.as_ref().is_some_and(|skin| skin.is_moving),
            weights: node.weights.as_deref().unwrap_or(&source.weights),
            shape,
            skin,
        };
        let instancing = node.extensions.as_ref().and_then(|extensions| extensions.instancing.as_ref());
        let Some(instancing) = instancing else { return self.show(name, &actor, None).map_err(in_node) };
        let instances = self.instances(instancing).map_err(|message| in_node(format!("its instances: {message}")))?;
        for (i, world_from_instance) in instances.into_iter().enumerate() {
            if let Err(message) = self.show(format!("{name} {i}"), &actor, Some(world_from_instance)) {
                self.skip_object(in_node(format!("instance {i}: {message}")));
            }
        }
        Ok(())
    }

    /// Adds an object at rest, and what moves it.
    fn show(&mut self, name: String, actor: &Actor<'_>, instance: Option<DAffine3>) -> Result<(), String> {
        let Actor { node, shape, skin, weights, is_moving, .. } = actor;
        let world_from_object = instance.map_or(actor.world_from_object, |instance| actor.world_from_object * instance);
        // What an animation moves may come out of nothing.
        let has_place = if *is_moving { world_from_object.is_finite() } else { is_usable(&world_from_object) };
        if !has_place {
            return Err(shape::TRANSFORM.to_owned());
        }
        let triangles_shown = self.triangles_shown + shape.mesh.triangles().len();
        if triangles_shown > MAX_TRIANGLES_SHOWN {
            return Err(format!("with it, the scene would have more than {MAX_TRIANGLES_SHOWN} triangles"));
        }
        // Twice: the object has them, and so has what moves it.
        let target_count = shape.deformer.as_ref().map_or(0, |deformer| deformer.morph_offsets.len());
        let rest_joints = skin.as_ref().map_or(&[][..], |skin| &skin.rest);
        self.accessors.charge(2, target_count + NUMBERS_OF_JOINT * rest_joints.len())?;
        let placement = Placement {
            world_from_object,
            morph_weights: morph_weights(weights.iter().copied(), target_count),
            joints: rest_joints.to_vec(),
        };
        self.bounds = self.bounds.union(placement.bounds(&shape.reach)?);
        self.triangles_shown = triangles_shown;
        let Placement { morph_weights, joints, .. } = placement;
        self.cast.objects.extend(is_moving.then(|| MovingObject {
            object: self.scene.objects.len(),
            node: *node,
            instance,
            skin: skin.clone(),
            reach: shape.reach.clone(),
            rest_weights: morph_weights.clone(),
        }));
        let pose = shape.deformer.clone().map(|deformer| Pose { deformer, morph_weights, joints });
        self.scene.objects.push(Object { pose, ..Object::new(name, shape.mesh.clone(), world_from_object) });
        Ok(())
    }

    /// The shape of a node with a skin, and the skin; `None` if it has no skin that can be used.
    fn skinned(&mut self, node: &Node, mesh_index: usize) -> Option<(Option<Shape>, Arc<PlacedSkin>)> {
        let skin_index = node.skin? as usize;
        let skin = self.skin(skin_index).map_err(|message| Problem::in_part("skin", skin_index, None, message));
        let shown = skin.and_then(|skin| Ok((self.shape(mesh_index, true)?, skin))).and_then(|(shape, skin)| {
            let count = skin.rest.len();
            let highest = shape.as_ref().and_then(|shape| shape.highest_joint);
            let Some(highest) = highest.filter(|highest| highest.joint as usize >= count) else {
                return Ok((shape, skin));
            };
            let HighestJoint { joint, primitive, vertex } = highest;
            let message =
                format!("primitive {primitive}: vertex {vertex} hangs on joint {joint}, but its skin has {count}");
            let name = self.document.meshes[mesh_index].name.as_deref();
            Err(Problem::in_part("mesh", mesh_index, name, message))
        });
        if let Err(problem) = &shown {
            let words = [
                "skin can't be used, so its mesh is as it was modelled",
                "skins can't be used, so their meshes are as they were modelled",
            ];
            self.warnings.add_one(words, || problem.to_string());
        }
        shown.ok()
    }

    fn skin(&mut self, index: usize) -> Result<Arc<PlacedSkin>, String> {
        let (document, accessors, tree, nodes) = (self.document, self.accessors, self.tree, &self.cast.nodes);
        let read = || {
            Skin::read(index, document, accessors, tree)
                .and_then(|skin| PlacedSkin::new(skin, tree, nodes))
                .map(Arc::new)
        };
        self.skins.entry(index).or_insert_with(read).clone()
    }

    /// A mesh that exists; `None` if it has no triangles but only points or lines.
    fn shape(&mut self, mesh_index: usize, has_skin: bool) -> Result<Option<Shape>, Problem> {
        if let Some(shape) = self.shapes.get(&(mesh_index, has_skin)) {
            return shape.clone();
        }
        let shape = self.read_shape(mesh_index, has_skin);
        self.shapes.insert((mesh_index, has_skin), shape.clone());
        shape
    }

    fn read_shape(&mut self, mesh_index: usize, has_skin: bool) -> Result<Option<Shape>, Problem> {
        let source = &self.document.meshes[mesh_index];
        let in_mesh = |message: String| Problem::in_part("mesh", mesh_index, source.name.as_deref(), message);
        let materials = Materials(&self.uv_sources);
        let (surface, deformation) =
            mesh::surface(source, has_skin, self.wants_normals, self.accessors, materials, &mut self.warnings)
                .map_err(in_mesh)?;
        if surface.triangles.is_empty() {
            return Ok(None);
        }
        let mesh = Mesh::new(surface).map_err(|error| in_mesh(error.to_string()))?;
        self.warnings.add(mesh.counts().unusable_normals, NORMAL_LEFT_OUT);
        let deformer = (!deformation.is_none()).then(|| Arc::new(deformation.of_mesh(&mesh)));
        let reach = Arc::new(Reach::new(&mesh, deformer.as_deref()));
        Ok(Some(Shape { mesh: Arc::new(mesh), deformer, highest_joint: deformation.highest_joint, reach }))
    }

    /// Where the instances of a node are, seen from it.
    fn instances(&self, instancing: &Instancing) -> Result<Vec<DAffine3>, String> {
        let attribute = |name: &str| instancing.attributes.get(name).copied();
        let vectors = |name: &str| attribute(name).map(|accessor| self.accessors.vectors::<3>(accessor)).transpose();
        let translations = vectors("TRANSLATION")?;
        let scales = vectors("SCALE")?;
        let rotations = attribute("ROTATION").map(|accessor| self.accessors.vectors::<4>(accessor)).transpose()?;
        let counts =
            [translations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len)];
        let count = counts.into_iter().flatten().max().ok_or("they have no TRANSLATION, ROTATION or SCALE")?;
        if counts.into_iter().flatten().any(|other| other != count) {
            return Err("their attributes differ in number".to_owned());
        }
        let instance = |i: usize| {
            let translation = translations.as_ref().map_or(DVec3::ZERO, |all| all[i].into());
            let scale = scales.as_ref().map_or(DVec3::ONE, |all| all[i].into());
            match rotations.as_ref().map_or(Some(glam::DQuat::IDENTITY), |all| rotation_of(all[i])) {
                Some(rotation) => DAffine3::from_scale_rotation_translation(scale, rotation, translation),
                None => DAffine3::NAN,
            }
        };
        // An object takes more memory than what is read for it.
        self.accessors.charge(count, NUMBERS_OF_OBJECT)?;
        Ok((0..count).map(instance).collect())
    }

    /// Chooses the origin, and places everything about it.
    fn move_to_origin(&mut self) {
        let scene = &mut self.scene;
        scene.origin = origin_of(self.bounds);
        let offset = -scene.origin;
        for object in &mut scene.objects {
            object.world_from_object.translation += offset;
        }
        for camera in &mut scene.cameras {
            camera.eye += offset;
        }
        for light in &mut scene.lights {
            light.position = light.position.moved_by(offset);
        }
    }

    /// Why there is no object.
    fn nothing_shown(self) -> Problem {
        if let Some(problem) = self.first_problem {
            return problem;
        }
        let shows_mesh = |&&(node, _): &&(usize, DAffine3)| self.document.nodes[node].mesh.is_some();
        let nodes = self.tree.nodes.len();
        let message = if self.document.meshes.is_empty() {
            "there is no mesh in it".to_owned()
        } else if self.tree.nodes.iter().find(shows_mesh).is_none() {
            format!("no node of its scene shows a mesh (nodes: {nodes}, meshes: {})", self.document.meshes.len())
        } else {
            let reasons: Vec<String> = self.warnings.finish().iter().map(ToString::to_string).collect();
            format!("no mesh in its scene has a triangle ({})", reasons.join("; "))
        };
        Problem::whole(message)
    }
}

/// The node's name, else that of what it shows, else "mesh 3".
fn name_of(node: &Node, own: Option<&str>, what: &str, index: usize) -> String {
    let names = [node.name.as_deref(), own];
    names.into_iter().flatten().find(|name| !name.is_empty()).map_or_else(|| format!("{what} {index}"), str::to_owned)
}

#[cfg(test)]
mod tests;
