//! `--time` and `--animation`: models that move, at one moment.

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::{Value, json};

use crate::files::{BOX, Place, TRIANGLE, floats, glb, push, triangles_document};

const SMALL: [&str; 6] = ["--size", "40x30", "--samples", "1", "--eye", "0.3,-9,3"];

/// A triangle that moves 2 m east in the second after 1 s, and, in another animation, 4 m up.
fn moving(place: &Place, name: &str, animations: &[(&str, [f32; 3])]) -> String {
    let mut document = triangles_document(&[0]);
    let times = [1.0_f32, 2.0];
    let mut bytes = floats(&TRIANGLE);
    let mut add = |document: &mut Value, values: &[f32], kind: &str, count: usize| {
        let offset = bytes.len();
        bytes.extend(floats(values));
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": 4 * values.len() });
        push(&mut document["bufferViews"], view);
        let view = document["bufferViews"].as_array().map_or(0, Vec::len) - 1;
        let accessor = json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind });
        push(&mut document["accessors"], accessor);
        view
    };
    document["animations"] = json!([]);
    for (name, to) in animations {
        let input = add(&mut document, &times, "SCALAR", 2);
        let output = add(&mut document, &[0.0, 0.0, 0.0, to[0], to[1], to[2]], "VEC3", 2);
        let animation = json!({
            "name": name,
            "samplers": [{ "input": input, "output": output }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
        });
        push(&mut document["animations"], animation);
    }
    document["buffers"] = json!([{ "byteLength": bytes.len() }]);
    place.file(name, glb(&document, &bytes))
}

/// Where the middle of the model is, by what a default view looks at, and what was said.
fn shown(place: &Place, models: &[&str], options: &[&str]) -> ([f64; 3], String) {
    let picture = place.out("x.png");
    let run =
        place.umbrae(&[&["render"], models, &["-o", &picture, "--json", "-"], &SMALL, options].concat()).success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    let target = serde_json::from_value(report["camera"]["target"].clone()).expect("three numbers");
    (target, String::from_utf8(run.get_output().stderr.clone()).expect("text"))
}

#[test]
fn a_moment_is_shown_and_without_one_the_model_is_at_rest() {
    let place = Place::new();
    let model = moving(&place, "moving.glb", &[("slide", [2.0, 0.0, 0.0])]);
    let (rest, said) = shown(&place, &[&model], &[]);
    assert!(said.contains("animation is not played") && said.contains("--time SECONDS"), "{said}");
    for (time, moved) in [("0", 0.0), ("1", 0.0), ("1.5", 1.0), ("2", 2.0), ("100", 2.0)] {
        let (middle, said) = shown(&place, &[&model], &["--time", time]);
        assert!((middle[0] - rest[0] - moved).abs() < 1e-5, "at {time} s it has moved from {rest:?} to {middle:?}");
        assert!(!said.contains("warning"), "{said}");
    }
}

#[test]
fn one_of_several_animations_is_chosen_by_name() {
    let place = Place::new();
    let model = moving(&place, "moving.glb", &[("slide", [2.0, 0.0, 0.0]), ("rise", [0.0, 4.0, 0.0])]);
    let (rest, _) = shown(&place, &[&model], &[]);
    let (risen, _) = shown(&place, &[&model], &["--time", "2", "--animation", "rise"]);
    assert!((risen[2] - rest[2] - 4.0).abs() < 1e-5 && (risen[0] - rest[0]).abs() < 1e-5, "{risen:?}");
    // Both move the same thing.
    let (first, said) = shown(&place, &[&model], &["--time", "2"]);
    assert!((first[0] - rest[0] - 2.0).abs() < 1e-5, "{first:?}");
    assert!(said.contains("only the first is played") && said.contains("--animation NAME"), "{said}");
}

#[test]
fn with_several_models_those_play_that_have_the_animation() {
    let place = Place::new();
    let slide = moving(&place, "slide.glb", &[("slide", [2.0, 0.0, 0.0])]);
    let still = place.file("box.obj", BOX);
    let (rest, _) = shown(&place, &[&still, &slide], &[]);
    let (moved, _) = shown(&place, &[&still, &slide], &["--time", "2", "--animation", "slide"]);
    assert!(moved[0] > rest[0] + 0.5, "{moved:?}");
}

#[test]
fn a_time_for_models_that_stand_still_is_a_warning() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let (_, said) = shown(&place, &[&model], &["--time", "1"]);
    assert!(said.contains("warning: --time changes nothing: no model has an animation"), "{said}");
}

#[test]
fn a_moment_that_can_not_be_is_refused() {
    let place = Place::new();
    let model = moving(&place, "moving.glb", &[("slide", [2.0, 0.0, 0.0]), ("rise", [0.0, 4.0, 0.0])]);
    let (still, picture) = (place.file("box.obj", BOX), place.out("x.png"));
    let cases: &[(&str, &[&str], &[&str])] = &[
        (&model, &["--time", "-1"], &["--time", "`-1` is not a time; write seconds from 0, such as 1.5"]),
        (&model, &["--time", "nan"], &["--time", "`nan` is not a time"]),
        (&model, &["--time", "1:30"], &["--time", "`1:30` is not a time"]),
        (&model, &["--animation", "rise"], &["--time"]),
        (&model, &["--time", "1", "--animation", "walk"], &["there is no animation `walk`; there are `slide`, `rise`"]),
        (
            &still,
            &["--time", "1", "--animation", "walk"],
            &["there is no animation `walk`: no model has any; leave --animation out"],
        ),
    ];
    for (model, options, words) in cases {
        place.refuses(&[&["render", model, "-o", &picture], *options].concat(), words);
    }
}

#[test]
fn inspect_tells_the_animations() {
    let place = Place::new();
    let model = moving(&place, "moving.glb", &[("slide", [2.0, 0.0, 0.0]), ("rise", [0.0, 4.0, 0.0])]);
    let rows = contains("  animation              slide: 2.000 s\n").and(contains("rise: 2.000 s\n"));
    place.umbrae(&["inspect", &model]).success().stdout(rows);
    let json = place.umbrae(&["inspect", &model, "--json"]).success().get_output().stdout.clone();
    let json: Value = serde_json::from_slice(&json).expect("JSON");
    assert_eq!(json["animations"][1], json!({ "name": "rise", "duration_s": 2.0 }));
}
