use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DVec3, Vec2, Vec3};
use serde_json::{Value, json};
use umbrae_core::Object;

use umbrae_core::{AlphaMode, Wrap};

use crate::{Format, LoadError, LoadOptions, Model, UpAxis, load_bytes};

/// A glTF file in the making: one buffer, in a data URI.
pub(super) struct Builder {
    pub(super) json: Value,
    bytes: Vec<u8>,
}

const FLOAT: u32 = 5126;
pub(super) const UBYTE: u32 = 5121;
pub(super) const SHORT: u32 = 5122;

impl Builder {
    fn new() -> Self {
        let json = json!({"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "nodes": [{"mesh": 0}]});
        Self { json, bytes: Vec::new() }
    }

    pub(super) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list of the file");
        list.push(value);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        self.push("bufferViews", view)
    }

    pub(super) fn accessor(&mut self, shape: &str, kind: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({"bufferView": view, "componentType": kind, "count": count, "type": shape}))
    }

    pub(super) fn floats(&mut self, shape: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(shape, FLOAT, values.len() / width, &bytes)
    }

    /// A right triangle in the x, y plane.
    fn triangle(&mut self) -> usize {
        self.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    }

    pub(super) fn text(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        json.to_string().into_bytes()
    }

    pub(super) fn read(&self) -> Result<Model, LoadError> {
        load_bytes(&self.text(), Format::Gltf, "model.gltf", None, &LoadOptions::default())
    }

    pub(super) fn model(&self) -> Model {
        self.read().expect("a good file")
    }

    fn error(&self) -> String {
        self.read().expect_err("a bad file").to_string()
    }
}

/// One triangle, shown by node 0.
pub(super) fn one_triangle() -> Builder {
    let mut builder = Builder::new();
    let position = builder.triangle();
    builder.json["meshes"] = json!([{"name": "tri", "primitives": [{"attributes": {"POSITION": position}}]}]);
    builder
}

pub(super) fn warnings(model: &Model) -> Vec<String> {
    model.warnings.iter().map(ToString::to_string).collect()
}

/// Where the object's vertices are, in the model's own coordinates.
pub(super) fn world(model: &Model, object: usize) -> Vec<DVec3> {
    let object = &model.scene.objects[object];
    object.positions().map(|p| p + model.scene.origin).collect()
}

pub(super) fn assert_near(actual: &[DVec3], expected: &[[f64; 3]]) {
    assert_eq!(actual.len(), expected.len());
    for (a, e) in actual.iter().zip(expected) {
        assert!((*a - DVec3::from(*e)).length() < 1e-6, "{actual:?} is not {expected:?}");
    }
}

#[test]
fn y_up_becomes_z_up_and_an_up_axis_of_the_users_is_ignored_aloud() {
    let builder = one_triangle();
    let options = LoadOptions { up: Some(UpAxis::Z) };
    let model = load_bytes(&builder.text(), Format::Gltf, "model.gltf", None, &options).expect("a good file");
    assert_near(&world(&model, 0), &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!((model.up, model.scene.objects[0].name.as_str()), (UpAxis::Y, "tri"));
    assert_eq!(warnings(&model), ["1 up axis was ignored, because glTF says that y is up"]);
}

#[test]
fn transforms_compose_down_the_tree_mirrors_included() {
    let mut builder = one_triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    builder.json["nodes"] = json!([
        // A quarter turn about z, twice as long: x becomes y.
        {"children": [1], "translation": [10, 0, 0], "rotation": [0, 0, 2.0 * half, 2.0 * half], "scale": [2, 2, 2]},
        {"mesh": 0, "name": "mirrored", "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]},
    ]);
    let model = builder.model();
    // In the file: (0, 0, 0) -> (5, 0, 0) -> (10, 10, 0), and so on; then (x, y, z) -> (x, -z, y).
    assert_near(&world(&model, 0), &[[10.0, 0.0, 10.0], [10.0, 0.0, 8.0], [8.0, 0.0, 10.0]]);
    assert_eq!(model.scene.objects[0].name, "mirrored");
    assert!(model.scene.objects[0].world_from_object.matrix3.determinant() < 0.0, "a mirror stays one");
}

#[test]
fn a_building_in_national_coordinates_loses_nothing() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([{"mesh": 0, "translation": [25_000_000.125, 400.0, -4_000_000.25]}, {"camera": 0}]);
    builder.json["nodes"][1]["translation"] = json!([25_000_010.0, 400.0, -4_000_000.0]);
    builder.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    let model = builder.model();
    assert_eq!(world(&model, 0)[1], DVec3::new(25_000_001.125, 4_000_000.25, 400.0));
    let small = model.scene.objects[0].world_from_object.translation.abs().max_element();
    assert!(small < 2.0, "the origin takes up what is large, {small} is left");
    assert_eq!(model.scene.cameras[0].eye + model.scene.origin, DVec3::new(25_000_010.0, 4_000_000.0, 400.0));
}

#[test]
fn nodes_that_show_one_mesh_share_it() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}]);
    let objects = builder.model().scene.objects;
    assert!(Arc::ptr_eq(&objects[0].mesh, &objects[1].mesh));
}

#[test]
fn only_the_default_scene_is_loaded() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b"}, {"mesh": 9, "name": "c"}]);
    builder.json["scenes"] = json!([{"nodes": [0]}, {"nodes": [1]}]);
    assert_eq!(builder.model().scene.objects[0].name, "a", "the first without a default");
    builder.json["scene"] = json!(1);
    assert_eq!(builder.model().scene.objects[0].name, "b");
    builder.json["scene"] = json!(7);
    assert_eq!(builder.error(), "model.gltf: its default scene is 7, but there are 2");
}

#[test]
fn primitives_of_a_mesh_become_one_mesh_with_their_materials() {
    let mut builder = one_triangle();
    let other = builder.floats("VEC3", 3, &[5.0, 0.0, 0.0, 6.0, 0.0, 0.0, 5.0, 1.0, 0.0]);
    let indices = builder.accessor("SCALAR", UBYTE, 4, &[2, 1, 0, 0]);
    builder.json["materials"] = json!([
        {"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "baseColorTexture": {"index": 0}}},
        {"name": "glass", "alphaMode": "BLEND"},
    ]);
    builder.json["meshes"] = json!([{"primitives": [
        {"attributes": {"POSITION": 0}, "material": 1},
        {"attributes": {"POSITION": other}, "indices": indices, "material": 0},
        {"attributes": {"POSITION": 0}, "material": 7},
        {"attributes": {"POSITION": 0}, "mode": 1},
    ]}]);
    let model = builder.model();
    let mesh = &model.scene.objects[0].mesh;
    assert_eq!(mesh.triangle_materials(), [1, 0, 2]);
    assert_eq!(mesh.counts().vertices_read, 6, "primitives share vertices of the same accessors");
    assert_eq!((model.scene.materials[0].base_color, model.scene.objects[0].name.as_str()), (Vec3::X, "mesh 0"));
    assert_eq!(mesh.positions()[mesh.triangles()[1][0] as usize], Vec3::new(5.0, 1.0, 0.0), "indices are offset");
    assert_eq!(
        warnings(&model),
        [
            "1 base colour texture was left out (first: texture 0: there are 0)",
            "1 index beyond the last whole triangle was skipped",
            "1 material that does not exist was replaced (first: material 7 of 2)",
            "1 line primitive was skipped",
        ]
    );
}

#[test]
fn sparse_values_replace_those_of_the_accessor_or_zeros() {
    for is_based in [true, false] {
        let mut builder = one_triangle();
        let places = builder.view(&[1, 2]);
        let values: Vec<u8> = [3.0_f32, 0.0, 0.0, 0.0, 7.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let values = builder.view(&values);
        let accessor = &mut builder.json["accessors"][0];
        accessor["sparse"] = json!({
            "count": 2,
            "indices": {"bufferView": places, "componentType": UBYTE},
            "values": {"bufferView": values},
        });
        if !is_based {
            accessor.as_object_mut().expect("an object").remove("bufferView");
        }
        let mesh = builder.model().scene.objects[0].mesh.clone();
        assert_eq!(mesh.positions(), [Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 7.0]);
        builder.json["accessors"][0]["count"] = json!(2);
        assert!(
            builder.error().contains("accessor 0: its sparse value 1 is for element 2 of 2"),
            "{}",
            builder.error()
        );
    }
}

#[test]
fn interleaved_and_quantised_positions_are_read() {
    let mut builder = Builder::new();
    let rows = [[0_i16, 0, 0, 99], [i16::MAX, 0, 0, 99], [0, i16::MAX, i16::MIN, 99]];
    let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let position = builder.accessor("VEC3", SHORT, 3, &bytes);
    builder.json["bufferViews"][0]["byteStride"] = json!(8);
    builder.json["accessors"][position]["normalized"] = json!(true);
    builder.json["extensionsRequired"] = json!(["KHR_mesh_quantization", "KHR_materials_unlit"]);
    builder.json["meshes"] = json!([{"primitives": [{"attributes": {"POSITION": position}}]}]);
    let model = builder.model();
    assert_eq!(model.scene.objects[0].mesh.positions(), [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, -1.0)]);
    assert!(model.warnings.is_empty());
}

#[test]
fn vertex_colours_are_linear_and_white_where_a_primitive_has_none() {
    let mut builder = one_triangle();
    let other = builder.triangle();
    let colors = builder.accessor("VEC4", UBYTE, 3, &[255, 0, 51, 9].repeat(3));
    builder.json["accessors"][colors]["normalized"] = json!(true);
    builder.json["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0}},
        {"attributes": {"POSITION": other, "COLOR_0": colors}},
    ]);
    let colors = builder.model().scene.objects[0].mesh.corner_colors().to_vec();
    assert_eq!(colors, [[Vec3::ONE; 3], [Vec3::new(1.0, 0.0, 0.2); 3]]);
}

#[test]
fn instances_multiply_a_node() {
    let mut builder = one_triangle();
    let translation = builder.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 9.0, 9.0, 9.0]);
    let scale = builder.floats("VEC3", 3, &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0]);
    // Half a turn about z, as bytes of any length.
    let rotation = builder.accessor("VEC4", 5120, 3, &[0, 0, 0, 127, 0, 0, 100, 0, 0, 0, 127, 0]);
    builder.json["accessors"][rotation]["normalized"] = json!(true);
    builder.json["nodes"][0] = json!({"mesh": 0, "name": "tree", "translation": [100, 0, 0], "extensions": {
        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation, "SCALE": scale, "ROTATION": rotation}},
    }});
    let model = builder.model();
    let names: Vec<&str> = model.scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["tree 0", "tree 1"]);
    assert_near(&world(&model, 1), &[[101.0, -3.0, 2.0], [99.0, -3.0, 2.0], [101.0, -3.0, 0.0]]);
    assert!(warnings(&model)[0].starts_with("1 object was skipped (first: node 0 \"tree\": instance 2: its transform"));
}

#[test]
fn lights_and_cameras_are_where_their_nodes_are() {
    let mut builder = one_triangle();
    builder.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "color": [1, 0.5, 0], "intensity": 2, "name": "sun"},
        {"type": "spot", "spot": {}}, {"type": "area"},
    ]}});
    builder.json["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.25}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 1, "znear": 0}},
        {"type": "perspective", "perspective": {"yfov": 4.0, "znear": 0.25}},
    ]);
    let light = |light: u32| json!({"translation": [1, 2, 3], "extensions": {"KHR_lights_punctual": {"light": light}}});
    builder.json["nodes"] = json!([
        {"mesh": 0}, light(0), light(1), light(2), {"camera": 0, "name": "eye", "translation": [1, 2, 3]}, {"camera": 1},
        {"camera": 2},
    ]);
    let model = builder.model();
    let [sun, spot] = model.scene.lights.as_slice() else { panic!("two lights: {:?}", model.scene.lights) };
    assert_eq!((sun.name.as_str(), sun.strength), ("sun", Vec3::new(2.0, 1.0, 0.0)));
    assert_eq!(sun.position.homogeneous(), glam::DVec4::new(0.0, -1.0, 0.0, 0.0), "it shines along -z, which is north");
    assert_eq!((spot.name.as_str(), spot.position.homogeneous()), ("light 1", glam::DVec4::new(1.0, -3.0, 2.0, 1.0)));
    let camera = &model.scene.cameras[0];
    assert_eq!((camera.name.as_str(), camera.eye), ("eye", DVec3::new(1.0, -3.0, 2.0)));
    assert_eq!((camera.forward, camera.up, camera.fov_y_rad, camera.near), (DVec3::Y, DVec3::Z, 0.5, 0.25));
    assert_eq!(
        warnings(&model),
        [
            "1 light was skipped (first: \"light 2\" is \"area\" of strength [1, 1, 1] in no usable place)",
            "1 orthographic camera was skipped (first: \"camera 1\")",
            "1 camera was skipped (first: \"camera 2\" at [0, 0, 0] with yfov 4 and znear 0.25)",
        ]
    );
}

#[test]
fn spot_lights_shine_along_their_nodes_and_have_the_cone_and_the_range_of_the_file() {
    let mut builder = one_triangle();
    let spot = |inner: f64, outer: f64| json!({"type": "spot", "range": 2.5, "spot": {"innerConeAngle": inner, "outerConeAngle": outer}});
    builder.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        spot(0.25, 0.5), {"type": "spot"}, spot(0.5, 0.25), spot(-1.0, 3.0), spot(0.5, 0.5),
        {"type": "point", "range": -1.0}, {"type": "directional", "range": 7.0}, {"type": "point", "range": 10.0},
    ]}});
    let light = |light: usize| json!({"scale": [2, 2, 2], "rotation": [0, 1, 0, 1], "extensions": {"KHR_lights_punctual": {"light": light}}});
    builder.json["nodes"] = (0..8).map(light).chain([json!({"mesh": 0})]).collect();
    let model = builder.model();
    let cone = |i: usize| model.scene.lights[i].cone;
    let angles = |i: usize| cone(i).map(|cone| [cone.inner_rad, cone.outer_rad]);
    let axis = cone(0).expect("a spot light has a cone").axis;
    assert!(axis.distance(DVec3::NEG_X) < 1e-12, "a quarter turn about the file's up takes -z to -x: {axis}");
    assert_eq!(angles(0), Some([0.25, 0.5]));
    assert_eq!(angles(1), Some([0.0, std::f64::consts::FRAC_PI_4]), "glTF's defaults");
    for i in 0..5 {
        let [inner, outer] = angles(i).expect("a spot light has a cone");
        assert!(0.0 <= inner && inner < outer && outer <= std::f64::consts::FRAC_PI_2, "{i}: {inner} {outer}");
    }
    let ranges: Vec<Option<f64>> = model.scene.lights.iter().map(|light| light.range_m).collect();
    assert_eq!(ranges[4..], [Some(2.5), None, None, Some(10.0)], "a node's scale does not change a range");
    assert_eq!(
        warnings(&model),
        [
            "2 spot lights' angles were brought into range (first: inner 0.5 and outer 0.25 of \"light 2\")",
            "1 light's range was ignored (first: -1 m of \"light 5\")",
        ]
    );
}

#[test]
fn morph_targets_add_what_their_weights_say_and_a_nodes_weights_win() {
    let mut builder = one_triangle();
    let target = builder.floats("VEC3", 3, &[0.0, 0.0, 2.0].repeat(3));
    builder.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": target}]);
    builder.json["meshes"][0]["weights"] = json!([0.5]);
    builder.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "weights": [2]}]);
    builder.json["animations"] = json!([{"channels": [], "samplers": []}]);
    let model = builder.model();
    assert_eq!([0, 1].map(|object| world(&model, object)[0]), [DVec3::NEG_Y, DVec3::NEG_Y * 4.0]);
    let [first, second] = model.scene.objects.as_slice() else { panic!("two objects") };
    assert!(Arc::ptr_eq(&first.mesh, &second.mesh), "one mesh in two poses");
    let deformer = |object: &Object| object.pose.as_ref().expect("it is posed").deformer.clone();
    assert!(Arc::ptr_eq(&deformer(first), &deformer(second)));
    assert_eq!(
        warnings(&model),
        ["1 animation is not played: the model is at rest; use --time SECONDS to see it at a moment"]
    );
}

/// A triangle whose first corner hangs on joint 0 and whose others hang half on each.
pub(super) fn skinned() -> Builder {
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

#[test]
fn a_skinned_mesh_is_where_its_joints_are_and_not_its_node() {
    // Joint 0 lifts by (0, 0, 1), joint 1 by (4, 6, 1) - (4, 0, 0).
    let model = skinned().model();
    assert_near(&world(&model, 0), &[[0.0, -1.0, 0.0], [1.0, -1.0, 3.0], [0.0, -1.0, 4.0]]);
}

#[test]
fn a_skin_that_can_not_be_used_leaves_its_mesh_as_modelled() {
    let mut builder = skinned();
    builder.json["skins"][0]["joints"] = json!([1]);
    let model = builder.model();
    assert_eq!(world(&model, 0)[0], DVec3::new(1000.0, -1000.0, 1000.0));
    assert_eq!(
        warnings(&model),
        [
            "1 skin can't be used, so its mesh is as it was modelled (first: mesh 0 \"tri\": primitive 0: vertex 1 hangs on \
          joint 1, but its skin has 1)"
        ]
    );
}

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

/// A PNG of 2 by 1 texels, red and blue.
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::RgbImage::from_vec(2, 1, vec![255, 0, 0, 0, 0, 255]).expect("two texels");
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes it");
    bytes.into_inner()
}

/// A triangle with texture coordinates in two sets, and a material for it.
fn one_textured_triangle(texture: &Value) -> Builder {
    let mut builder = one_triangle();
    let first = builder.floats("VEC2", 2, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let second = builder.accessor("VEC2", UBYTE, 3, &[0, 0, 255, 0, 0, 51]);
    builder.json["accessors"][second]["normalized"] = json!(true);
    builder.json["meshes"][0]["primitives"][0] =
        json!({"attributes": {"POSITION": 0, "TEXCOORD_0": first, "TEXCOORD_1": second}, "material": 0});
    builder.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": texture}}]);
    let view = builder.view(&png());
    builder.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    builder.json["textures"] = json!([{"source": 0}]);
    builder
}

#[test]
fn a_texture_comes_from_a_buffer_a_data_uri_or_a_file_beside_the_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("red and blue.png"), png()).expect("a file");
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    let embedded = builder.json["images"][0].clone();
    let data = format!("data:image/png;base64,{}", STANDARD.encode(png()));
    for image in [embedded, json!({"uri": data}), json!({"uri": "red%20and%20blue.png"})] {
        builder.json["images"] = json!([image]);
        let options = LoadOptions::default();
        let model = load_bytes(&builder.text(), Format::Gltf, "model.gltf", Some(folder.path()), &options);
        let model = model.expect("a good file");
        let [texture] = model.scene.textures.as_slice() else { panic!("one texture: {:?}", model.scene.textures) };
        assert_eq!((texture.size_px, texture.rgba.as_slice()), ([2, 1], [255, 0, 0, 255, 0, 0, 255, 255].as_slice()));
        assert_eq!(model.scene.materials[0].base_color_texture, Some(0));
        assert_eq!(model.scene.objects[0].mesh.corner_uvs(), [[Vec2::ZERO, Vec2::X, Vec2::Y]]);
        assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    }
}

#[test]
fn texture_coordinates_are_of_the_set_and_under_the_transform_that_the_material_names() {
    let uvs = |texture: Value| one_textured_triangle(&texture).model().scene.objects[0].mesh.corner_uvs()[0];
    assert_eq!(uvs(json!({"index": 0, "texCoord": 1})), [Vec2::ZERO, Vec2::X, Vec2::new(0.0, 0.2)]);
    let turn = json!({"offset": [0.5, 0.25], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 1]});
    // Counter-clockwise with v down: from right (1, 0) to up (0, -1), and from down (0, 1) to right.
    let [origin, right, down] = uvs(json!({"index": 0, "extensions": {"KHR_texture_transform": turn}}));
    for (uv, expected) in [(origin, [0.5, 0.25]), (right, [0.5, -1.75]), (down, [1.5, 0.25])] {
        assert!(uv.distance(Vec2::from(expected)) < 1e-6, "{uv} is not {expected:?}");
    }
    let other = json!({"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 1}}});
    assert_eq!(uvs(other)[2], Vec2::new(0.0, 0.2), "the transform's set wins");
}

#[test]
fn materials_share_textures_and_samplers_set_them_apart() {
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    builder.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}, {"magFilter": 9729}]);
    builder.json["textures"] = json!([{"source": 0}, {"source": 0, "sampler": 0}, {"source": 0, "sampler": 1}]);
    builder.json["materials"] =
        (0..3).map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}})).collect();
    let scene = builder.model().scene;
    let of_material: Vec<Option<u32>> = scene.materials.iter().map(|m| m.base_color_texture).collect();
    assert_eq!(of_material, [Some(0), Some(1), Some(0), None], "the third samples as one without a sampler");
    assert_eq!((scene.textures[0].wrap, scene.textures[0].is_nearest), ([Wrap::Repeat; 2], false));
    assert_eq!((scene.textures[1].wrap, scene.textures[1].is_nearest), ([Wrap::Clamp, Wrap::Mirror], true));
}

#[test]
fn a_texture_that_can_not_be_had_is_left_out_and_named() {
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    let webp = json!([{"extensions": {"EXT_texture_webp": {"source": 0}}}]);
    let good = builder.json["textures"].clone();
    let cases = [
        (webp, json!({}), "texture 0: it has no PNG or JPEG (its picture may be"),
        (good.clone(), json!({}), "texture 0: image 0: it has neither a uri nor a buffer view"),
        (good.clone(), json!({"bufferView": 0}), "texture 0: image 0: its picture is something else; only PNG"),
        (good.clone(), json!({"uri": "data:,abc"}), "texture 0: image 0: its picture is something else; only PNG"),
        (good.clone(), json!({"uri": "a.png"}), "texture 0: image 0: \"a.png\": it is in the file \"a.png\", which"),
        (good.clone(), json!({"bufferView": 99}), "texture 0: image 0: there is no buffer view 99"),
        (json!([{"source": 7}]), json!({}), "texture 0: there is no image 7, only 1"),
    ];
    for (textures, image, expected) in cases {
        builder.json["textures"] = textures;
        builder.json["images"] = json!([image]);
        let model = builder.model();
        let [warning] = model.warnings.as_slice() else { panic!("one warning: {:?}", model.warnings) };
        let expected = format!("1 base colour texture was left out (first: {expected}");
        assert!(warning.to_string().starts_with(&expected), "{warning}");
        assert_eq!(model.scene.materials[0].base_color_texture, None);
    }
}

#[test]
fn a_textured_primitive_without_coordinates_keeps_its_shape() {
    let mut builder = one_textured_triangle(&json!({"index": 0, "texCoord": 3}));
    let model = builder.model();
    assert!(model.scene.objects[0].mesh.corner_uvs().is_empty());
    assert_eq!(warnings(&model), ["1 primitive has no texture coordinates to use (first: there is no TEXCOORD_3)"]);
    let short = builder.floats("VEC2", 2, &[0.0; 4]);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_3"] = json!(short);
    let expected = "1 primitive has no texture coordinates to use (first: TEXCOORD_3 has 2 elements for 3 vertices)";
    assert_eq!(warnings(&builder.model()), [expected]);
}

#[test]
fn primitives_with_and_without_textures_share_a_mesh() {
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    let textured = builder.json["meshes"][0]["primitives"][0].clone();
    let plain = json!({"attributes": {"POSITION": 0}});
    builder.json["meshes"][0]["primitives"] = json!([plain, textured, plain]);
    let corner_uvs = builder.model().scene.objects[0].mesh.corner_uvs().to_vec();
    assert_eq!(corner_uvs, [[Vec2::ZERO; 3], [Vec2::ZERO, Vec2::X, Vec2::Y], [Vec2::ZERO; 3]]);
}

#[test]
fn alpha_means_what_its_mode_says() {
    let mut builder = one_triangle();
    let transmission = |factor: f64| json!({"KHR_materials_transmission": {"transmissionFactor": factor}});
    let quarter = json!({"baseColorFactor": [1, 1, 1, 0.25]});
    builder.json["materials"] = json!([
        {"pbrMetallicRoughness": quarter},
        {"name": "leaf", "alphaMode": "MASK", "pbrMetallicRoughness": quarter},
        {"alphaMode": "MASK", "alphaCutoff": 0.375, "pbrMetallicRoughness": quarter},
        {"alphaMode": "BLEND", "pbrMetallicRoughness": quarter},
        {"name": "pane", "extensions": transmission(1.0)},
        {"extensions": transmission(0.0)},
    ]);
    let model = builder.model();
    let modes: Vec<AlphaMode> = model.scene.materials.iter().map(|material| material.alpha_mode).collect();
    let cut = |cutoff: f32| AlphaMode::Mask { cutoff };
    use AlphaMode::{Blend, Opaque};
    assert_eq!(modes, [Opaque, cut(0.5), cut(0.375), Blend, Blend, Opaque, Opaque]);
    assert_eq!(model.scene.materials[3].alpha, 0.25);
    assert!((model.scene.materials[4].alpha - 0.3).abs() < 1e-6);
    assert_eq!(
        warnings(&model),
        [
            "2 cut-out materials cast as full triangles (first: \"leaf\")",
            "1 transmitting material is drawn as plain glass (first: \"pane\")",
        ]
    );
}

#[test]
fn a_material_that_is_whole_everywhere_is_opaque_whatever_it_says() {
    for (alpha, is_whole) in [(255, true), (254, false)] {
        let mut builder = one_textured_triangle(&json!({"index": 0}));
        let picture = image::RgbaImage::from_vec(2, 1, vec![9, 9, 9, 255, 9, 9, 9, alpha]).expect("two texels");
        let mut png = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut png, image::ImageFormat::Png).expect("memory takes it");
        let view = builder.view(&png.into_inner());
        builder.json["images"] = json!([{"bufferView": view}]);
        let material = |mode: &str, cutoff: f32| {
            let texture = json!({"baseColorTexture": {"index": 0}});
            json!({"alphaMode": mode, "alphaCutoff": cutoff, "pbrMetallicRoughness": texture})
        };
        builder.json["materials"] = json!([material("BLEND", 0.5), material("MASK", 0.5), material("MASK", 1.0)]);
        let modes: Vec<AlphaMode> = builder.model().scene.materials.iter().map(|m| m.alpha_mode).collect();
        let expected = if is_whole {
            [AlphaMode::Opaque; 3]
        } else {
            [AlphaMode::Blend, AlphaMode::Opaque, AlphaMode::Mask { cutoff: 1.0 }]
        };
        assert_eq!(modes[..3], expected);
    }
    let mut builder = one_triangle();
    builder.json["materials"] = json!([{"alphaMode": "BLEND"}]);
    assert_eq!(builder.model().scene.materials[0].alpha_mode, AlphaMode::Opaque, "nothing shows through");
}
