//! A scene as one GLB file.
//!
//! glTF is y up: `(x, y, z)` here is `(x, z, -y)` there. Nothing is rounded on the way, so reading the file gives
//! the same bits back.
//!
//! Source: Khronos Group, "glTF 2.0 Specification", 2021, section 4; `KHR_lights_punctual`.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use serde_json::{Map, Value, json};
use umbrae_core::{Light, Mesh, NamedCamera, Scene};

/// `componentType` of indices.
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
/// `target` of buffer views.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// 0xffff would restart a strip, and is no vertex.
const MAX_SHORT_VERTICES: usize = 0xffff;

/// `scene` as a GLB 2.0 file: one node for each object, camera and light; objects that share a mesh share it in
/// the file; one primitive for each material of a mesh.
///
/// Positions are about the scene's origin, which the file does not hold. Vertex colours are not written: no sample has
/// any. Transforms are rounded to `f32`, as glTF has them.
pub fn glb_bytes(scene: &Scene) -> Vec<u8> {
    let mut file = File::default();
    let mut mesh_of: BTreeMap<*const Mesh, usize> = BTreeMap::new();
    for object in &scene.objects {
        let mesh =
            *mesh_of.entry(Arc::as_ptr(&object.mesh)).or_insert_with(|| file.add_mesh(&object.mesh, &object.name));
        let mut node = json!({ "name": object.name, "mesh": mesh });
        if object.world_from_object != DAffine3::IDENTITY {
            node["matrix"] = json!(y_up_matrix(&object.world_from_object));
        }
        file.nodes.push(node);
    }
    let mut cameras = Vec::new();
    for camera in &scene.cameras {
        file.nodes.push(camera_node(camera, cameras.len()));
        cameras.push(json!({
            "name": camera.name,
            "type": "perspective",
            "perspective": { "yfov": camera.fov_y_rad, "znear": camera.near },
        }));
    }
    let mut lights = Vec::new();
    for light in &scene.lights {
        file.nodes.push(light_node(light, lights.len()));
        lights.push(punctual_light(light));
    }
    let materials: Vec<Value> = scene
        .materials
        .iter()
        .map(|material| {
            let [r, g, b] = material.base_color.to_array();
            json!({
                "name": material.name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [r, g, b, 1.0],
                    "metallicFactor": 0.0,
                    "roughnessFactor": 1.0,
                },
                "doubleSided": true,
            })
        })
        .collect();

    let node_indices: Vec<usize> = (0..file.nodes.len()).collect();
    let mut root = Map::new();
    root.insert(
        "asset".into(),
        json!({ "version": "2.0", "generator": concat!("umbrae ", env!("CARGO_PKG_VERSION")) }),
    );
    root.insert("scene".into(), json!(0));
    // glTF has no empty lists.
    let mut insert = |key: &str, list: Vec<Value>| {
        if !list.is_empty() {
            root.insert(key.into(), Value::Array(list));
        }
    };
    insert("nodes", file.nodes);
    insert("meshes", file.meshes);
    insert("materials", materials);
    insert("accessors", file.accessors);
    insert("bufferViews", file.views);
    insert("cameras", cameras);
    if !file.bytes.is_empty() {
        insert("buffers", vec![json!({ "byteLength": file.bytes.len() })]);
    }
    let scene_nodes = if node_indices.is_empty() { json!({}) } else { json!({ "nodes": node_indices }) };
    insert("scenes", vec![scene_nodes]);
    if !lights.is_empty() {
        insert("extensionsUsed", vec![json!("KHR_lights_punctual")]);
        root.insert("extensions".into(), json!({ "KHR_lights_punctual": { "lights": lights } }));
    }
    container(&Value::Object(root).to_string(), &file.bytes)
}

/// The JSON and the bytes that it describes, as chunks.
fn container(json: &str, bytes: &[u8]) -> Vec<u8> {
    let mut glb = Vec::with_capacity(json.len() + bytes.len() + 64);
    glb.extend_from_slice(b"glTF");
    glb.extend_from_slice(&2_u32.to_le_bytes());
    glb.extend_from_slice(&0_u32.to_le_bytes());
    for (kind, chunk, filler) in [(b"JSON", json.as_bytes(), b' '), (b"BIN\0", bytes, 0)] {
        if chunk.is_empty() {
            continue;
        }
        let length = chunk.len().next_multiple_of(4);
        glb.extend_from_slice(&(length as u32).to_le_bytes());
        glb.extend_from_slice(kind);
        glb.extend_from_slice(chunk);
        glb.resize(glb.len() + length - chunk.len(), filler);
    }
    let total = glb.len() as u32;
    glb[8..12].copy_from_slice(&total.to_le_bytes());
    glb
}

/// The lists of the file, as they grow.
#[derive(Debug, Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl File {
    /// Writes `mesh` and gives its index: all positions once, then the triangles of each material.
    fn add_mesh(&mut self, mesh: &Mesh, name: &str) -> usize {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut bytes = Vec::with_capacity(12 * mesh.positions().len());
        for p in mesh.positions() {
            let p = y_up(*p);
            (low, high) = (low.min(p), high.max(p));
            bytes.extend(p.to_array().into_iter().flat_map(f32::to_le_bytes));
        }
        let view = self.add_view(&bytes, ARRAY_BUFFER);
        let positions = self.add_accessor(json!({
            "bufferView": view,
            "componentType": FLOAT,
            "count": mesh.positions().len(),
            "type": "VEC3",
            "min": low.to_array(),
            "max": high.to_array(),
        }));

        let is_short = mesh.positions().len() <= MAX_SHORT_VERTICES;
        let mut bytes_of_material: BTreeMap<u32, Vec<u8>> = BTreeMap::new();
        for (triangle, &material) in mesh.triangles().iter().zip(mesh.triangle_materials()) {
            let bytes = bytes_of_material.entry(material).or_default();
            for &index in triangle {
                let wide = index.to_le_bytes();
                // The low half comes first.
                bytes.extend_from_slice(if is_short { &wide[..2] } else { &wide });
            }
        }
        let (component_type, size) = if is_short { (UNSIGNED_SHORT, 2) } else { (UNSIGNED_INT, 4) };
        let mut primitives = Vec::new();
        for (material, bytes) in bytes_of_material {
            let view = self.add_view(&bytes, ELEMENT_ARRAY_BUFFER);
            let indices = self.add_accessor(json!({
                "bufferView": view,
                "componentType": component_type,
                "count": bytes.len() / size,
                "type": "SCALAR",
            }));
            primitives
                .push(json!({ "attributes": { "POSITION": positions }, "indices": indices, "material": material }));
        }
        self.meshes.push(json!({ "name": name, "primitives": primitives }));
        self.meshes.len() - 1
    }

    fn add_view(&mut self, bytes: &[u8], target: u32) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len(), "target": target }));
        self.views.len() - 1
    }

    fn add_accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

fn y_up(p: Vec3) -> Vec3 {
    // Adding +0 turns -0 into +0.
    Vec3::new(p.x, p.z, -p.y) + Vec3::ZERO
}

/// The rotation that takes the axes of this project to those of glTF.
const Y_UP_FROM_Z_UP: DMat3 = DMat3::from_cols(DVec3::X, DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.0, 1.0, 0.0));

/// The same transform between spaces that are both y up, column by column.
fn y_up_matrix(world_from_object: &DAffine3) -> [f32; 16] {
    let to = DAffine3::from_mat3(Y_UP_FROM_Z_UP);
    let back = DAffine3::from_mat3(Y_UP_FROM_Z_UP.transpose());
    let columns = (to * *world_from_object * back).to_cols_array();
    let mut matrix = [0.0; 16];
    for (column, entries) in columns.chunks(3).enumerate() {
        for (row, &entry) in entries.iter().enumerate() {
            matrix[4 * column + row] = entry as f32 + 0.0;
        }
    }
    matrix[15] = 1.0;
    matrix
}

fn rotation_and_translation(rotation: DQuat, at: DVec3) -> (Value, Value) {
    (json!(rotation.as_quat().to_array()), json!(y_up(at.as_vec3()).to_array()))
}

/// Cameras and lights look along their own -z.
fn camera_node(camera: &NamedCamera, index: usize) -> Value {
    let (back, up) = (Y_UP_FROM_Z_UP * -camera.forward, Y_UP_FROM_Z_UP * camera.up);
    let rotation = DQuat::from_mat3(&DMat3::from_cols(up.cross(back), up, back));
    let (rotation, translation) = rotation_and_translation(rotation, camera.eye);
    json!({ "name": camera.name, "camera": index, "rotation": rotation, "translation": translation })
}

/// Directional lights and spots shine along their node's own -z.
fn light_node(light: &Light, index: usize) -> Value {
    let position = light.position.homogeneous().truncate();
    let mut node = json!({ "name": light.name, "extensions": { "KHR_lights_punctual": { "light": index } } });
    let is_directional = light.position.is_directional();
    let backwards = if is_directional { Some(position) } else { light.cone.map(|cone| -cone.axis) };
    if let Some(backwards) = backwards {
        let rotation = DQuat::from_rotation_arc(DVec3::Z, Y_UP_FROM_Z_UP * backwards);
        node["rotation"] = json!(rotation.as_quat().to_array());
    }
    if !is_directional {
        node["translation"] = json!(y_up(position.as_vec3()).to_array());
    }
    node
}

/// Intensity is the strongest channel's; the colour has the ratios.
fn punctual_light(light: &Light) -> Value {
    let intensity = light.strength.max_element();
    let color = if intensity > 0.0 { light.strength / intensity } else { Vec3::ZERO };
    let mut punctual = json!({ "name": light.name, "color": color.to_array(), "intensity": intensity });
    if light.position.is_directional() {
        punctual["type"] = json!("directional");
        return punctual;
    }
    punctual["type"] = json!("point");
    if let Some(cone) = light.cone {
        punctual["type"] = json!("spot");
        punctual["spot"] = json!({ "innerConeAngle": cone.inner_rad, "outerConeAngle": cone.outer_rad });
    }
    if let Some(range_m) = light.range_m {
        punctual["range"] = json!(range_m);
    }
    punctual
}
