//! Triangles, colours, morph targets and skins, out of accessors of every kind.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use serde_json::json;
use umbrae_core::Object;

use super::{Builder, SHORT, UBYTE, assert_near, one_triangle, skinned, warnings, world};

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
