//! glTF files in the making; the tests that make them are by what they test.

mod animation;
mod materials;
mod meshes;
mod nodes;
mod normals;
mod refusals;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde_json::{Value, json};

use crate::{Format, LoadError, LoadOptions, Model, load_bytes};

/// A glTF file in the making: one buffer, in a data URI.
struct Builder {
    json: Value,
    bytes: Vec<u8>,
}

const FLOAT: u32 = 5126;
const UBYTE: u32 = 5121;
const SHORT: u32 = 5122;

impl Builder {
    fn new() -> Self {
        let json = json!({"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "nodes": [{"mesh": 0}]});
        Self { json, bytes: Vec::new() }
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list of the file");
        list.push(value);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        self.push("bufferViews", view)
    }

    fn accessor(&mut self, shape: &str, kind: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({"bufferView": view, "componentType": kind, "count": count, "type": shape}))
    }

    fn floats(&mut self, shape: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(shape, FLOAT, values.len() / width, &bytes)
    }

    /// A right triangle in the x, y plane.
    fn triangle(&mut self) -> usize {
        self.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    }

    fn text(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        json.to_string().into_bytes()
    }

    fn read(&self) -> Result<Model, LoadError> {
        load_bytes(&self.text(), Format::Gltf, "model.gltf", None, &LoadOptions::default())
    }

    fn with_normals(&self) -> Model {
        let options = LoadOptions { normals: true, ..LoadOptions::default() };
        load_bytes(&self.text(), Format::Gltf, "model.gltf", None, &options).expect("a good file")
    }

    fn model(&self) -> Model {
        self.read().expect("a good file")
    }

    fn error(&self) -> String {
        self.read().expect_err("a bad file").to_string()
    }
}

/// One triangle, shown by node 0.
fn one_triangle() -> Builder {
    let mut builder = Builder::new();
    let position = builder.triangle();
    builder.json["meshes"] = json!([{"name": "tri", "primitives": [{"attributes": {"POSITION": position}}]}]);
    builder
}

fn warnings(model: &Model) -> Vec<String> {
    model.warnings.iter().map(ToString::to_string).collect()
}

/// Where the object's vertices are, in the model's own coordinates.
fn world(model: &Model, object: usize) -> Vec<DVec3> {
    let object = &model.scene.objects[object];
    object.positions().map(|p| p + model.scene.origin).collect()
}

fn assert_near(actual: &[DVec3], expected: &[[f64; 3]]) {
    assert_eq!(actual.len(), expected.len());
    for (a, e) in actual.iter().zip(expected) {
        assert!((*a - DVec3::from(*e)).length() < 1e-6, "{actual:?} is not {expected:?}");
    }
}

/// A triangle whose first corner hangs on joint 0 and whose others hang half on each.
fn skinned() -> Builder {
    let mut builder = one_triangle();
    let joints = builder.accessor("VEC4", UBYTE, 3, &[0, 1, 0, 0].repeat(3));
    let weights = builder.floats("VEC4", 4, &[1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    let primitive = &mut builder.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["JOINTS_0"] = json!(joints);
    primitive["attributes"]["WEIGHTS_0"] = json!(weights);
    let mut binds = [[0.0_f32; 16]; 2];
    for bind in &mut binds {
        for diagonal in [0, 5, 10, 15] {
            bind[diagonal] = 1.0;
        }
    }
    binds[1][12] = -4.0;
    let binds = builder.floats("MAT4", 16, binds.as_flattened());
    builder.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": binds}]);
    builder.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [1000, 1000, 1000]},
        {"translation": [0, 0, 1], "children": [2]},
        {"translation": [4, 6, 0]},
    ]);
    builder
}
