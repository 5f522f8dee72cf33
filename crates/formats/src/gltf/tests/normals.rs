//! Normals of vertices, at the corners of triangles.

use std::sync::Arc;

use glam::Vec3;
use serde_json::json;

use super::{Builder, UBYTE, one_triangle, skinned, warnings};

/// A triangle whose corners have the normals x, y and z, and the accessor of these.
fn triangle_with_normals() -> (Builder, usize) {
    let mut builder = one_triangle();
    let normal = builder.floats("VEC3", 3, &[2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5]);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    (builder, normal)
}

#[test]
fn normals_are_read_where_they_are_asked_for_and_stay_in_the_space_of_their_mesh() {
    let (mut builder, _) = triangle_with_normals();
    builder.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [-1, 1, 3]}]);
    let model = builder.with_normals();
    let [plain, mirrored] = model.scene.objects.as_slice() else { panic!("two objects") };
    assert!(Arc::ptr_eq(&plain.mesh, &mirrored.mesh));
    assert_eq!(plain.mesh.corner_normals(), [[Vec3::X, Vec3::Y, Vec3::Z]]);
    assert!(mirrored.world_from_object.matrix3.determinant() < 0.0, "the object's own transform mirrors them");
    assert!(builder.model().scene.objects[0].mesh.corner_normals().is_empty());
}

#[test]
fn normals_follow_the_indices_of_their_primitive_and_others_have_none() {
    let (mut builder, normal) = triangle_with_normals();
    let indices = builder.accessor("SCALAR", UBYTE, 3, &[2, 0, 1]);
    let strip = builder.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    let of_strip = builder.floats("VEC3", 3, &[-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0]);
    builder.json["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0}},
        {"attributes": {"POSITION": 0, "NORMAL": normal}, "indices": indices},
        {"attributes": {"POSITION": 0}, "indices": indices},
        {"attributes": {"POSITION": strip, "NORMAL": of_strip}, "mode": 5},
        {"attributes": {"POSITION": 0}},
    ]);
    let none = [Vec3::ZERO; 3];
    assert_eq!(
        builder.with_normals().scene.objects[0].mesh.corner_normals(),
        [
            none,
            [Vec3::Z, Vec3::X, Vec3::Y],
            none,
            [Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z],
            [Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z],
            none
        ]
    );
}

#[test]
fn normals_may_be_quantised() {
    const BYTE: u32 = 5120;
    let (mut builder, _) = triangle_with_normals();
    let bytes = [127_i8, 0, 0, -128, 0, 0, 0, 100, 0].map(|value| value as u8);
    let normal = builder.accessor("VEC3", BYTE, 3, &bytes);
    builder.json["accessors"][normal]["normalized"] = json!(true);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    let model = builder.with_normals();
    assert_eq!(model.scene.objects[0].mesh.corner_normals(), [[Vec3::X, Vec3::NEG_X, Vec3::Y]]);
}

#[test]
fn a_mesh_that_is_bent_has_the_normals_of_its_rest() {
    let mut builder = skinned();
    let normal = builder.floats("VEC3", 3, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    let model = builder.with_normals();
    let object = &model.scene.objects[0];
    assert!(object.pose.is_some());
    assert_eq!(object.mesh.corner_normals(), [[Vec3::X, Vec3::Y, Vec3::Z]]);
}

#[test]
fn normals_that_can_not_be_used_are_left_out_and_the_mesh_keeps_its_shape() {
    let (mut builder, _) = triangle_with_normals();
    let short = builder.floats("VEC3", 3, &[0.0, 0.0, 1.0]);
    let flat = builder.floats("VEC2", 2, &[0.0; 6]);
    for (normal, expected) in [
        (short, "NORMAL has 1 elements for 3 vertices".to_owned()),
        (flat, format!("NORMAL: accessor {flat}: it is \"VEC2\" where VEC3 is needed")),
        (99, "NORMAL: there is no accessor 99".to_owned()),
    ] {
        builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
        let model = builder.with_normals();
        assert!(model.scene.objects[0].mesh.corner_normals().is_empty());
        let [warning] = model.warnings.as_slice() else { panic!("one warning: {:?}", model.warnings) };
        let start = format!("1 primitive has no normals to use (first: {expected}");
        assert!(warning.to_string().starts_with(&start), "{warning}");
        assert!(builder.model().warnings.is_empty(), "nobody asked for them");
    }
    let bad = builder.floats("VEC3", 3, &[0.0, 0.0, 2.0, f32::NAN, 0.0, 0.0, f32::INFINITY, 0.0, 0.0]);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(bad);
    let model = builder.with_normals();
    assert_eq!(model.scene.objects[0].mesh.corner_normals(), [[Vec3::Z, Vec3::ZERO, Vec3::ZERO]]);
    assert_eq!(warnings(&model), ["2 corners' normals are not finite and were left out"]);
}
