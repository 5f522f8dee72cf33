//! glTF 2.0 and GLB.
//!
//! ```text
//!   container    chunks, files beside, data URIs     -> bytes of each buffer
//!   document     the JSON                            -> what the file says
//!   accessor     both, and a budget                  -> checked numbers
//!   node         the tree of the scene               -> transforms in f64
//!   mesh, skin   primitives, morphs, joints at rest  -> one surface for each mesh
//!   appearance   materials, lights, cameras
//!   texture      pictures, and where on them corners are
//! ```
//!
//! A mesh stays in its own space and is shared by all nodes that show it as it is; its nodes' transforms carry the
//! turn from y up to z up, and the origin. What the file means to move is drawn at rest.

mod accessor;
mod appearance;
mod budget;
mod container;
mod document;
mod mesh;
mod node;
mod skin;
mod texture;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use umbrae_core::{Bounds, Light, Material, Mesh, NamedCamera, Object, Scene};

use crate::error::{Problem, quoted};
use crate::load::Context;
use crate::place::{MAX_COORDINATE, OBJECT_SKIPPED, is_in_range, origin_of};
use crate::warnings::Warnings;
use crate::{Format, Model, UpAxis};

use accessor::Accessors;
use container::{Buffers, Chunks};
use document::{Document, Instancing, Node};
use mesh::{Materials, Pose};
use node::{Tree, is_usable, rotation_of};
use skin::Skin;
use texture::{Textures, UvSource};

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
    let mut stage = Stage {
        document: &document,
        accessors: &accessors,
        uv_sources: looks.uv_sources,
        tree: &tree,
        shapes: BTreeMap::new(),
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
    let animations =
        ["animation is not played: the model is at rest", "animations are not played: the model is at rest"];
    stage.warnings.add(document.animations.len(), animations);
    if stage.scene.objects.is_empty() {
        return Err(stage.nothing_shown());
    }
    stage.move_to_origin();
    Ok(Model { scene: stage.scene, format: Format::Gltf, up: UpAxis::Y, warnings: stage.warnings.finish() })
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
const NUMBERS_OF_OBJECT: usize = 32;

/// A mesh and the box around it, in its own space.
#[derive(Debug, Clone)]
struct Shape {
    mesh: Arc<Mesh>,
    bounds: Bounds,
}

/// The scene while its nodes are walked; in scene axes, not yet about its origin.
struct Stage<'a> {
    document: &'a Document,
    accessors: &'a Accessors<'a>,
    /// For each material of the file.
    uv_sources: Vec<Option<UvSource>>,
    tree: &'a Tree,
    /// Those shown as they are; `None` for one without triangles, and what is wrong with one that can't be used.
    shapes: BTreeMap<usize, Result<Option<Shape>, Problem>>,
    /// Holds all objects.
    bounds: Bounds,
    triangles_shown: usize,
    first_problem: Option<Problem>,
    scene: Scene,
    warnings: Warnings,
}

impl Stage<'_> {
    fn show_node(&mut self, index: usize, world_from_node: DAffine3) {
        let node = &self.document.nodes[index];
        let world_from_node = DAffine3::from_mat3(UpAxis::Y.scene_from_file()) * world_from_node;
        if let Some(mesh) = node.mesh
            && let Err(problem) = self.show_mesh(index, node, mesh as usize, world_from_node)
        {
            self.skip_object(problem);
        }
        if let Some(camera) = node.camera {
            let shown = self.camera(node, camera as usize, &world_from_node);
            self.scene.cameras.extend(shown);
        }
        if let Some(light) = node.extensions.as_ref().and_then(|extensions| extensions.light.as_ref()) {
            let shown = self.light(node, light.light, &world_from_node);
            self.scene.lights.extend(shown);
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
        let (shape, world_from_shape) = match self.skinned(node, mesh_index) {
            Some(skinned) => skinned,
            None if node.weights.is_some() => (
                self.read_shape(mesh_index, &Pose { weights: weights(node, source), ..Pose::default() })?,
                world_from_node,
            ),
            None => (self.shared_shape(mesh_index)?, world_from_node),
        };
        let Some(shape) = shape else { return Ok(()) };
        let instancing = node.extensions.as_ref().and_then(|extensions| extensions.instancing.as_ref());
        let Some(instancing) = instancing else { return self.show(name, &shape, world_from_shape).map_err(in_node) };
        let instances = self.instances(instancing).map_err(|message| in_node(format!("its instances: {message}")))?;
        for (i, world_from_instance) in instances.into_iter().enumerate() {
            let shown = self.show(format!("{name} {i}"), &shape, world_from_shape * world_from_instance);
            if let Err(message) = shown {
                self.skip_object(in_node(format!("instance {i}: {message}")));
            }
        }
        Ok(())
    }

    fn show(&mut self, name: String, shape: &Shape, world_from_object: DAffine3) -> Result<(), String> {
        if !is_usable(&world_from_object) {
            return Err("its transform can't be used: a number in it is not finite, or its scale is 0".to_owned());
        }
        // A mesh turned with its box stays inside; looking at every vertex of every instance could take forever.
        let corners = shape.bounds.corners().map(|corner| world_from_object.transform_point3(corner));
        if let Some(far) = corners.iter().find(|corner| !is_in_range(**corner)) {
            return Err(format!("its transform takes it to {far}; coordinates must be below {MAX_COORDINATE:e}"));
        }
        let shown = self.triangles_shown + shape.mesh.triangles().len();
        if shown > MAX_TRIANGLES_SHOWN {
            return Err(format!("with it, the scene would have more than {MAX_TRIANGLES_SHOWN} triangles"));
        }
        self.triangles_shown = shown;
        self.bounds = self.bounds.union(Bounds::of_points(corners));
        self.scene.objects.push(Object::new(name, shape.mesh.clone(), world_from_object));
        Ok(())
    }

    /// The shape of a node with a skin, at rest, and where it is; `None` if it has no skin that can be used.
    ///
    /// As glTF says, the joints alone place it: the node's own transform has no effect.
    fn skinned(&mut self, node: &Node, mesh_index: usize) -> Option<(Option<Shape>, DAffine3)> {
        let skin_index = node.skin? as usize;
        let skin = Skin::read(skin_index, self.document, self.accessors, self.tree);
        let posed = skin.map_err(|message| Problem::in_part("skin", skin_index, None, message)).and_then(|skin| {
            let weights = weights(node, &self.document.meshes[mesh_index]);
            let shape = self.read_shape(mesh_index, &Pose { weights, joints: skin.posed_from_mesh })?;
            Ok((shape, DAffine3::from_mat3(UpAxis::Y.scene_from_file()) * skin.world_from_posed))
        });
        if let Err(problem) = &posed {
            let words = [
                "skin can't be used, so its mesh is as it was modelled",
                "skins can't be used, so their meshes are as they were modelled",
            ];
            self.warnings.add_one(words, || problem.to_string());
        }
        posed.ok()
    }

    fn shared_shape(&mut self, mesh_index: usize) -> Result<Option<Shape>, Problem> {
        if let Some(shape) = self.shapes.get(&mesh_index) {
            return shape.clone();
        }
        let weights = &self.document.meshes[mesh_index].weights;
        let shape = self.read_shape(mesh_index, &Pose { weights, ..Pose::default() });
        self.shapes.insert(mesh_index, shape.clone());
        shape
    }

    /// A mesh that exists; `None` if it has no triangles but only points or lines.
    fn read_shape(&mut self, mesh_index: usize, pose: &Pose<'_>) -> Result<Option<Shape>, Problem> {
        let source = &self.document.meshes[mesh_index];
        let in_mesh = |message: String| Problem::in_part("mesh", mesh_index, source.name.as_deref(), message);
        let materials = Materials(&self.uv_sources);
        let surface = mesh::surface(source, pose, self.accessors, materials, &mut self.warnings).map_err(in_mesh)?;
        if surface.triangles.is_empty() {
            return Ok(None);
        }
        let mesh = Mesh::new(surface).map_err(|error| in_mesh(error.to_string()))?;
        Ok(Some(Shape { bounds: mesh.bounds(), mesh: Arc::new(mesh) }))
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

/// The node's own morph weights, else the mesh's.
fn weights<'a>(node: &'a Node, mesh: &'a document::Mesh) -> &'a [f64] {
    node.weights.as_deref().unwrap_or(&mesh.weights)
}

/// The node's name, else that of what it shows, else "mesh 3".
fn name_of(node: &Node, own: Option<&str>, what: &str, index: usize) -> String {
    let names = [node.name.as_deref(), own];
    names.into_iter().flatten().find(|name| !name.is_empty()).map_or_else(|| format!("{what} {index}"), str::to_owned)
}

#[cfg(test)]
mod tests;
