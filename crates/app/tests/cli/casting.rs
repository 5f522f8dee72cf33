//! `--cast`, `--no-cast` and `--glass-casts`: who casts, and how a user finds the names.

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::{Value, json};

use crate::files::{Place, TRIANGLE, floats, glb, triangles_document};

const SMALL: [&str; 4] = ["--size", "40x30", "--samples", "1"];

/// "Facade" of concrete, "Window" of glass, "tree 1" without a material.
fn model(place: &Place) -> String {
    let mut document = triangles_document(&[0, 36, 72]);
    for (i, name) in ["Facade", "Window", "tree 1"].iter().enumerate() {
        document["nodes"][i]["name"] = json!(name);
    }
    document["materials"] = json!([
        { "name": "concrete" },
        { "name": "pane", "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.3] } },
    ]);
    for i in 0..2 {
        document["meshes"][i]["primitives"][0]["material"] = json!(i);
    }
    let at = |z: f32| TRIANGLE.map(|n| n + z);
    place.file("house.glb", glb(&document, &floats(&[at(0.0), at(1.0), at(2.0)].concat())))
}

/// Names of what casts according to the report, and what was said.
fn casting(place: &Place, options: &[&str]) -> (Vec<String>, String) {
    let model = model(place);
    let picture = place.out("x.png");
    let args = [&["render", &model, "-o", &picture, "--json", "-"], &SMALL[..], options].concat();
    let run = place.umbrae(&args).success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    let casters = report["lights"][0]["casters"].as_array().expect("a list");
    let names = casters.iter().filter(|caster| caster["casts"] == true);
    let said = String::from_utf8(run.get_output().stderr.clone()).expect("text");
    (names.map(|caster| caster["name"].as_str().expect("a name").to_owned()).collect(), said)
}

#[test]
fn patterns_choose_who_casts() {
    let place = Place::new();
    let all = ["Facade", "Window", "tree 1", "ground"];
    let without = |left_out: &str| all.iter().filter(|name| **name != left_out).copied().collect::<Vec<_>>();
    let cases: &[(&[&str], Vec<&str>)] = &[
        (&[], without("Window")),
        (&["--glass-casts"], all.to_vec()),
        (&["--cast", "facade,ground"], vec!["Facade", "ground"]),
        (&["--cast", "CONC*", "--cast", "tree ?"], vec!["Facade", "tree 1"]),
        (&["--no-cast", "tree*,ground"], vec!["Facade"]),
        (&["--cast", "*", "--no-cast", "concrete"], vec!["tree 1", "ground"]),
        (&["--cast", "pane", "--glass-casts"], vec!["Window"]),
    ];
    for (options, expected) in cases {
        let (casts, said) = casting(&place, options);
        assert_eq!(casts, *expected, "{options:?}");
        assert!(!said.contains("--cast") && !said.contains("nothing casts"), "{options:?}: {said}");
    }
}

#[test]
fn a_pattern_that_is_no_name_is_a_warning_with_the_closest_names() {
    let place = Place::new();
    let (casts, said) = casting(&place, &["--no-cast", "trees*,grund", "--cast", "Fasade"]);
    assert!(casts.is_empty());
    for sentence in [
        "warning: `--cast Fasade` is the name of no object or material; the closest are `Facade`, ",
        "warning: `--no-cast trees*` is the name of no object or material; the closest are `tree 1`, ",
        "warning: `--no-cast grund` is the name of no object or material; the closest are `ground`, ",
        "warning: nothing casts a shadow",
    ] {
        assert!(said.contains(sentence), "{sentence:?} is not in:\n{said}");
    }
}

#[test]
fn patterns_that_name_nothing_are_refused() {
    let place = Place::new();
    let model = model(&place);
    let args = ["render", &model, "-o", &place.out("x.png")];
    for options in [["--cast", ""], ["--cast", "a,,b"], ["--no-cast", ","]] {
        let words = [options[0], "an empty pattern names nothing", "separated by commas"];
        place.refuses(&[&args[..], &options].concat(), &words);
    }
}

#[test]
fn inspect_tells_the_names_of_objects_and_materials() {
    let place = Place::new();
    let model = model(&place);
    let materials = |names: &'static str| contains("    materials              ".to_owned() + names + "\n");
    place
        .umbrae(&["inspect", &model])
        .success()
        .stdout(contains("3 objects\n  Facade\n").and(materials("concrete")).and(materials("pane")));
    let json = place.umbrae(&["inspect", &model, "--json"]).success().get_output().stdout.clone();
    let json: Value = serde_json::from_slice(&json).expect("JSON");
    assert_eq!(json["objects"][1]["name"], "Window");
    assert_eq!(json["objects"][1]["materials"], json!(["pane"]));
}
