//! What stands where: transforms, instances, scenes, lights and cameras.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use serde_json::json;

use super::{assert_near, one_triangle, warnings, world};
use crate::{Format, LoadOptions, UpAxis, load_bytes};

#[test]
fn y_up_becomes_z_up_and_an_up_axis_of_the_users_is_ignored_aloud() {
    let builder = one_triangle();
    let options = LoadOptions { up: Some(UpAxis::Z), ..LoadOptions::default() };
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
