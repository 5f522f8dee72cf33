//! What is wrong with a file is said by the part of it that is wrong.

use serde_json::{Value, json};

use super::{FLOAT, UBYTE, one_triangle, warnings};
use crate::{Format, LoadOptions, load_bytes};

#[test]
fn trees_that_are_none_are_refused() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([{"children": [1]}, {"children": [0]}]);
    assert!(builder.error().contains("no node of its scene shows a mesh"), "a cycle without a root is no one's");
    builder.json["scenes"] = json!([{"nodes": [0]}]);
    assert!(builder.error().contains("node 1: its child is node 0, which already has a place"));
    builder.json["nodes"] = json!([{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}]);
    assert!(builder.error().contains("which already has a place"), "two parents");
    builder.json["nodes"] = json!([{"name": "top", "children": [5]}]);
    assert_eq!(builder.error(), "model.gltf: node 0 \"top\": its child is node 5, but there are 1");
}

#[test]
fn a_bad_part_is_skipped_beside_a_good_one_and_refused_alone() {
    let mut builder = one_triangle();
    let bad = builder.floats("VEC3", 3, &[0.0, 0.0, f32::NAN, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let mesh = json!({"name": "bad", "primitives": [{"attributes": {"POSITION": bad}}]});
    builder.push("meshes", mesh);
    builder.json["nodes"] =
        json!([{"mesh": 0}, {"mesh": 1}, {"mesh": 1}, {"mesh": 0, "scale": [1, 0, 1]}, {"mesh": 8}]);
    let reason = "mesh 1 \"bad\": vertex 0 is at (0, 0, NaN); coordinates must be finite and below 1e18";
    assert_eq!(warnings(&builder.model()), [format!("4 objects were skipped (first: {reason})")]);
    builder.json["nodes"] = json!([{"mesh": 1}]);
    assert_eq!(builder.error(), format!("model.gltf: {reason}"));
}

#[test]
fn what_does_not_fit_is_told_by_its_mesh_and_accessor() {
    let with = |place: &str, value: Value| {
        let mut builder = one_triangle();
        let indices = builder.accessor("SCALAR", UBYTE, 3, &[0, 1, 2]);
        builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        let (parent, field) = place.rsplit_once('/').expect("a field of something");
        builder.json.pointer_mut(parent).expect("a place in the file")[field] = value;
        let error = builder.error();
        error.strip_prefix("model.gltf: mesh 0 \"tri\": primitive 0: ").expect("the mesh is named").to_owned()
    };
    assert_eq!(with("/meshes/0/primitives/0/attributes", json!({})), "it has no POSITION");
    assert_eq!(
        with("/meshes/0/primitives/0/attributes/POSITION", json!(9)),
        "POSITION: there is no accessor 9, only 2"
    );
    assert_eq!(with("/accessors/0/type", json!("VEC2")), "POSITION: accessor 0: it is \"VEC2\" where VEC3 is needed");
    assert_eq!(
        with("/accessors/0/componentType", json!(7)),
        "POSITION: accessor 0: its component type 7 does not exist"
    );
    assert_eq!(with("/accessors/0/bufferView", json!(7)), "POSITION: accessor 0: there is no buffer view 7, only 2");
    assert_eq!(with("/bufferViews/0/buffer", json!(7)), "POSITION: accessor 0: there is no buffer 7, only 1");
    assert_eq!(
        with("/accessors/0/count", json!(4)),
        "POSITION: accessor 0: its 4 elements of 12 bytes, 12 apart from byte 0, reach beyond the 36 bytes of buffer view 0"
    );
    assert_eq!(
        with("/bufferViews/0/byteLength", json!(40)),
        "POSITION: accessor 0: buffer view 0 is 40 bytes from byte 0, but buffer 0 has 39"
    );
    assert_eq!(with("/accessors/1/componentType", json!(FLOAT)), "accessor 1: indices can't have component type 5126");
    assert_eq!(with("/accessors/1/byteOffset", json!(u64::MAX)).matches("reach beyond").count(), 1);
    assert!(with("/accessors/0/count", json!(1_000_000_000)).contains("more than 64 numbers for each of its bytes"));
}

#[test]
fn files_that_are_not_gltf_2_say_so() {
    let error = |text: &str| {
        let read = load_bytes(text.as_bytes(), Format::Gltf, "a.gltf", None, &LoadOptions::default());
        read.expect_err("a bad file").to_string()
    };
    assert_eq!(
        error(r#"{"asset": {"version": "1.0"}, "meshes": {"a": {}}}"#),
        "a.gltf: it is glTF version \"1.0\"; only 2 can be read, so convert it"
    );
    assert_eq!(
        error("{\n\"asset\": "),
        "a.gltf: line 2: its JSON can't be read at column 9: EOF while parsing a value"
    );
    assert!(error(&format!("{{\"asset\": {:?}}}", "x".repeat(1_000_000))).len() < 300);
    let mut builder = one_triangle();
    builder.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(builder.error().contains("it needs the extension KHR_draco_mesh_compression"));
    builder.json["extensionsRequired"] = json!(["ACME_shape"]);
    assert_eq!(warnings(&builder.model()), ["1 required extension is unknown and ignored (first: \"ACME_shape\")"]);
}

#[test]
fn buffers_that_can_not_be_had_say_why() {
    let with = |uri: &str| {
        let mut builder = one_triangle();
        builder.json["buffers"] = json!([{"byteLength": 36, "uri": uri}]);
        let text = builder.json.to_string();
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("short.bin"), "short").expect("a file");
        let options = LoadOptions::default();
        let read = load_bytes(text.as_bytes(), Format::Gltf, "a.gltf", Some(folder.path()), &options);
        read.expect_err("a bad buffer").to_string()
    };
    assert!(with("no%20such.bin").ends_with("buffer 0: its file \"no such.bin\" is missing; put it beside the model"));
    assert!(with("short.bin").ends_with("buffer 0: it announces 36 bytes, but has 5; it was cut off"));
    assert!(with("..").ends_with("buffer 0: its file \"..\" is missing; put it beside the model"));
    assert!(with("https://x.org/a.bin").contains("it is at \"https://x.org/a.bin\"; download it"));
    assert!(with("data:;base64,AAAA").ends_with("it announces 36 bytes, but has 3; it was cut off"));
}
