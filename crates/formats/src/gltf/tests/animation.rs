//! What moves, at a moment.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::{Builder, SHORT, assert_near, one_triangle, skinned, warnings, world};
use crate::{AnimationError, Model};

/// A quarter turn about z, x, y, z, w.
const QUARTER: [f32; 4] = [0.0, 0.0, FRAC_1_SQRT_2 as f32, FRAC_1_SQRT_2 as f32];
const NO_TURN: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

impl Builder {
    /// Adds an animation of one channel, which moves `path` of `node` along `values` at `times_s`.
    fn animate(&mut self, node: usize, path: &str, interpolation: &str, times_s: &[f32], values: &[f32]) {
        let (shape, width) = match path {
            "weights" => ("SCALAR", 1),
            "rotation" => ("VEC4", 4),
            _ => ("VEC3", 3),
        };
        let (input, output) = (self.floats("SCALAR", 1, times_s), self.floats(shape, width, values));
        let animation = json!({
            "name": path,
            "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
            "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        });
        if self.json["animations"].is_null() {
            self.json["animations"] = json!([]);
        }
        self.push("animations", animation);
    }
}

fn played(builder: &Builder, time_s: f64) -> Model {
    let mut model = builder.model();
    model.play(None, time_s).expect("a good time");
    model
}

#[test]
fn a_model_turned_in_a_line_is_at_45_degrees_at_half_time() {
    let mut builder = one_triangle();
    builder.animate(0, "rotation", "LINEAR", &[0.0, 2.0], [NO_TURN, QUARTER].as_flattened());
    let model = played(&builder, 1.0);
    let (s, c) = FRAC_PI_4.sin_cos();
    // In the file x turns towards y; y is up.
    assert_near(&world(&model, 0), &[[0.0; 3], [c, 0.0, s], [-s, 0.0, c]]);
    assert!(warnings(&model).is_empty(), "it is played: {:?}", warnings(&model));
    assert_near(&world(&played(&builder, 99.0), 0), &[[0.0; 3], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]);
}

#[test]
fn a_model_that_is_not_played_is_at_rest_and_says_how_to_play_it() {
    let mut builder = one_triangle();
    builder.json["nodes"][0]["translation"] = json!([7, 0, 0]);
    builder.animate(0, "translation", "STEP", &[0.0, 2.0], &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let model = builder.model();
    assert_eq!(world(&model, 0)[0], DVec3::X * 7.0, "not even the first key is applied");
    assert_eq!(
        warnings(&model),
        ["1 animation is not played: the model is at rest; use --time SECONDS to see it at a moment"]
    );
    let x_at = |time_s| world(&played(&builder, time_s), 0)[0].x;
    assert_eq!([-1.0, 0.0, 1.999, 2.0, 3.0].map(x_at), [1.0, 1.0, 1.0, 2.0, 2.0]);
}

#[test]
fn what_hangs_on_a_moving_node_moves_and_keeps_its_own_place() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([
        {"children": [1, 2, 3], "translation": [1, 0, 0]},
        {"mesh": 0, "translation": [0, 0, 5]},
        {"camera": 0},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "translation": [0, 0, 9]},
    ]);
    builder.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    builder.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    builder.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 8.0, 0.0]);
    builder.animate(0, "rotation", "STEP", &[0.0], &QUARTER);
    let model = played(&builder, 0.25);
    // 2 up; x becomes up, and y (up in the file) becomes -x.
    assert_near(&world(&model, 0)[..2], &[[0.0, -5.0, 2.0], [0.0, -5.0, 3.0]]);
    assert_near(&world(&model, 1)[..2], &[[0.0, -9.0, 0.0], [1.0, -9.0, 0.0]]);
    let camera = &model.scene.cameras[0];
    assert_near(&[camera.eye, camera.forward, camera.up], &[[0.0, 0.0, 2.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]);
    assert_near(&[model.scene.lights[0].position.homogeneous().truncate()], &[[0.0, 0.0, 2.0]]);
}

#[test]
fn a_skinned_mesh_follows_its_joints() {
    let mut builder = skinned();
    // Joint 1 is node 2, which is at (4, 6, 0) below node 1.
    builder.animate(2, "translation", "LINEAR", &[0.0, 1.0], &[4.0, 0.0, 0.0, 4.0, 8.0, 0.0]);
    builder.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[5.0, 5.0, 5.0, 6.0, 6.0, 6.0]);
    let model = played(&builder, 0.5);
    // Joint 0 lifts by (0, 0, 1), joint 1 by (4, 4, 1) - (4, 0, 0); its own node has no effect.
    assert_near(&world(&model, 0), &[[0.0, -1.0, 0.0], [1.0, -1.0, 2.0], [0.0, -1.0, 3.0]]);
    let pose = model.scene.objects[0].pose.as_ref().expect("it is posed");
    assert_eq!(pose.joints, [DVec3::Z, DVec3::new(0.0, 4.0, 1.0)].map(DAffine3::from_translation));
}

/// One morph target that moves the triangle along the file's z.
fn morphed() -> Builder {
    let mut builder = one_triangle();
    let target = builder.floats("VEC3", 3, &[0.0, 0.0, 2.0].repeat(3));
    builder.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": target}, {}]);
    builder
}

#[test]
fn morph_weights_are_animated_node_by_node() {
    let mut builder = morphed();
    builder.json["nodes"] = json!([{"mesh": 0, "weights": [3]}, {"mesh": 0, "weights": [0.25]}]);
    builder.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 9.0, 1.0, 9.0]);
    let model = played(&builder, 0.75);
    assert_eq!([0, 1].map(|object| world(&model, object)[0].y), [-1.5, -0.5]);
    assert_eq!(model.scene.objects[0].pose.as_ref().map(|pose| pose.morph_weights.clone()), Some(vec![0.75, 9.0]));
}

#[test]
fn normalised_integers_are_weights_from_minus_one_to_one() {
    let mut builder = morphed();
    let shorts: Vec<u8> = [0, 0, i16::MAX, 0].into_iter().flat_map(i16::to_le_bytes).collect();
    let output = builder.accessor("SCALAR", SHORT, 4, &shorts);
    builder.json["accessors"][output]["normalized"] = json!(true);
    builder.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0; 4]);
    builder.json["animations"][0]["samplers"][0]["output"] = json!(output);
    assert_eq!(world(&played(&builder, 1.0), 0)[0].y, -2.0);
}

#[test]
fn a_thing_of_no_size_at_rest_may_grow() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [0, 0, 0]}]);
    builder.animate(1, "scale", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 4.0, 4.0, 4.0]);
    assert_eq!(builder.model().scene.objects.len(), 2);
    assert_eq!(world(&played(&builder, 0.5), 1)[1], DVec3::X * 2.0);
    assert_eq!(world(&played(&builder, 0.0), 1)[1], DVec3::ZERO, "and shrink to nothing");
}

#[test]
fn vertices_at_one_place_weld_only_if_everything_moves_them_alike() {
    let quad = |second_row: &[f32]| {
        let mut builder = one_triangle();
        let position =
            builder.floats("VEC3", 3, &[0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1., 0., 1., 0., 0., 1., 1., 0.]);
        let target = builder.floats("VEC3", 3, &[[0.0; 9].as_slice(), second_row].concat());
        builder.json["meshes"][0]["primitives"] =
            json!([{"attributes": {"POSITION": position}, "targets": [{"POSITION": target}]}]);
        builder.model().scene.objects[0].mesh.positions().len()
    };
    assert_eq!(quad(&[0.0, -0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]), 4, "the common edge moves as one");
    assert_eq!(quad(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]), 5, "one end of it tears");
}

#[test]
fn all_animations_play_together_if_they_move_different_things() {
    let mut builder = one_triangle();
    builder.animate(0, "translation", "STEP", &[0.5], &[1.0, 2.0, 3.0]);
    builder.animate(0, "scale", "STEP", &[0.75], &[2.0, 2.0, 2.0]);
    let model = played(&builder, 0.0);
    assert_near(&world(&model, 0)[..2], &[[1.0, -3.0, 2.0], [3.0, -3.0, 2.0]]);
    assert!(warnings(&model).is_empty());
    assert_eq!(model.animations.choose(None).expect("both").duration_s(), 0.75);

    builder.animate(0, "scale", "STEP", &[4.0], &[3.0, 3.0, 3.0]);
    let mut model = played(&builder, 0.0);
    assert_near(&world(&model, 0)[..2], &[[1.0, -3.0, 2.0], [2.0, -3.0, 2.0]]);
    let note = "3 animations move the same things, so only the first is played; choose with --animation NAME \
                (\"translation\", \"scale\", \"scale\")";
    assert_eq!(warnings(&model), [note]);
    model.play(Some("scale"), 0.0).expect("there is one");
    assert_near(&world(&model, 0)[..2], &[[0.0; 3], [2.0, 0.0, 0.0]]);
    let error = model.play(Some("walk"), 0.0).expect_err("there is none");
    assert_eq!(
        error.to_string(),
        "there is no animation \"walk\"; the model has \"translation\", \"scale\", \"scale\""
    );
    assert!(matches!(model.play(None, f64::NAN), Err(AnimationError::BadTime { .. })));
    let still = one_triangle().model().play(Some("walk"), 0.0).expect_err("nothing moves");
    assert_eq!(still.to_string(), "there is no animation \"walk\"; the model has none");
}

#[test]
fn a_scene_that_lacks_what_is_moved_is_refused_and_left_alone() {
    let mut builder = one_triangle();
    builder.animate(0, "translation", "STEP", &[0.0], &[1.0, 2.0, 3.0]);
    let mut model = builder.model();
    let object = model.scene.objects.pop();
    assert_eq!(model.play(None, 0.0), Err(AnimationError::OtherScene));
    model.scene.objects.extend(object);
    model.play(None, 0.0).expect("it is whole again");
}

#[test]
fn what_an_animation_takes_too_far_is_at_rest_and_a_warning_says_so() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([{"mesh": 0, "name": "rocket", "translation": [1, 0, 0]}, {"mesh": 0}]);
    builder.animate(0, "translation", "STEP", &[0.0, 1.0], &[2.0, 0.0, 0.0, 1e30, 0.0, 0.0]);
    let mut model = builder.model();
    model.play(None, 1.0).expect("a good time");
    assert_eq!(world(&model, 0)[0], DVec3::X);
    let [warning] = warnings(&model).try_into().expect("one warning");
    assert!(
        warning.starts_with(
            "1 object, camera or light can't follow its animation and is at rest (first: \"rocket\" at 1 s: its transform \
             takes it to [1000000015047466200000000000000, 0, 0]"
        ),
        "{warning}"
    );
    model.play(None, 0.5).expect("a good time");
    assert_eq!(world(&model, 0)[0], DVec3::X * 2.0);
}

#[test]
fn a_channel_that_can_not_be_followed_is_skipped_and_named() {
    let with = |place: &str, value: Value| {
        let mut builder = morphed();
        builder.json["nodes"] = json!([{"mesh": 0}, {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}, {}]);
        builder.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 8.0, 0.0]);
        let nan = builder.floats("SCALAR", 1, &[0.0, f32::NAN]);
        let unsorted = builder.floats("SCALAR", 1, &[1.0, 0.0]);
        assert_eq!([nan, unsorted], [4, 5]);
        let (parent, field) = place.rsplit_once('/').expect("a field of something");
        builder.json.pointer_mut(&format!("/animations/0{parent}")).expect("a place in the file")[field] = value;
        let [skipped, not_played] = warnings(&builder.model()).try_into().expect("two warnings");
        assert!(not_played.contains("not played"));
        let start = "1 animation channel was skipped (first: animation 0 \"translation\": channel 0: ";
        let message = skipped.strip_prefix(start).and_then(|rest| rest.strip_suffix(')'));
        message.unwrap_or_else(|| panic!("{skipped}")).to_owned()
    };
    let target = "/channels/0/target";
    let sampler = "/samplers/0";
    assert_eq!(with(&format!("{target}/node"), json!(9)), "it moves node 9, but there are 3");
    assert_eq!(with(&format!("{target}/node"), Value::Null), "it moves no node");
    assert_eq!(
        with(&format!("{target}/path"), json!("pointer")),
        "it moves \"pointer\", not translation, rotation, scale or weights"
    );
    assert_eq!(
        with(&format!("{target}/node"), json!(1)),
        "it moves node 1, which has a matrix in place of parts that can be moved"
    );
    assert_eq!(
        with(target, json!({"node": 2, "path": "weights"})),
        "it moves the weights of node 2, which has no morph targets"
    );
    assert_eq!(
        with(&format!("{target}/path"), json!("rotation")),
        "its sampler 0: accessor 3: it is \"VEC3\" where VEC4 is needed"
    );
    assert_eq!(with("/channels/0/sampler", json!(7)), "its sampler 7: it does not exist; there are 1");
    assert_eq!(with("/channels/0/sampler", Value::Null), "it has no sampler");
    assert_eq!(
        with(&format!("{sampler}/interpolation"), json!("WILD")),
        "its sampler 0: there is no interpolation \"WILD\""
    );
    assert_eq!(
        with(&format!("{sampler}/interpolation"), json!("CUBICSPLINE")),
        "its sampler 0: its 2 keys need 9 numbers each, but its output has 6"
    );
    assert_eq!(with(&format!("{sampler}/input"), json!(4)), "its sampler 0: the time of its key 1 is NaN");
    assert_eq!(with(&format!("{sampler}/input"), json!(5)), "its sampler 0: its key 1 is at 0 s, before key 0 at 1 s");
    assert_eq!(with(&format!("{sampler}/input"), json!(99)), "its sampler 0: there is no accessor 99, only 6");
    assert_eq!(with(&format!("{sampler}/output"), Value::Null), "its sampler 0: it has no output");
}

#[test]
fn two_channels_of_an_animation_on_one_path_are_one_too_many() {
    let mut builder = one_triangle();
    builder.animate(0, "translation", "STEP", &[0.0], &[1.0, 2.0, 3.0]);
    let channel = builder.json["animations"][0]["channels"][0].clone();
    builder.json["animations"][0]["channels"] = json!([channel, channel]);
    let warnings = warnings(&played(&builder, 0.0));
    assert!(
        warnings[0].contains("channel 1: it moves what a channel before it moves, the same path of node 0"),
        "{warnings:?}"
    );
}

#[test]
fn what_is_not_in_the_scene_may_be_moved_in_silence() {
    let mut builder = one_triangle();
    builder.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0}]);
    builder.json["scenes"] = json!([{"nodes": [0]}]);
    builder.animate(1, "translation", "STEP", &[0.0], &[1.0, 2.0, 3.0]);
    let model = played(&builder, 0.0);
    assert_eq!((world(&model, 0)[0], warnings(&model).len()), (DVec3::ZERO, 0));
}

#[test]
fn a_morph_target_that_can_not_be_used_moves_nothing() {
    let mut builder = morphed();
    let bad = builder.floats("VEC3", 3, &[0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    builder.json["meshes"][0]["primitives"][0]["targets"] =
        json!([{"POSITION": bad}, {"POSITION": 1}, {"POSITION": 77}]);
    builder.json["meshes"][0]["weights"] = json!([1, 1, 1]);
    let model = builder.model();
    assert_eq!(world(&model, 0)[0].y, -2.0);
    assert_eq!(
        warnings(&model),
        [
            "2 morph targets can't be used and move nothing (first: target 0 of primitive 0: its offset 0 is [0, 0, NaN])"
        ]
    );
}

#[test]
fn an_instance_of_a_moving_node_moves_with_it() {
    let mut builder = one_triangle();
    let translation = builder.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    builder.json["nodes"][0] =
        json!({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation}}}});
    builder.animate(0, "rotation", "STEP", &[0.0], &QUARTER);
    let model = played(&builder, 0.0);
    assert_near(&[world(&model, 0)[0], world(&model, 1)[0]], &[[0.0; 3], [0.0, 0.0, 1.0]]);
}
