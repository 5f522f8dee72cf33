//! How shadows are determined: methods and switches that change no picture, and what the report tells about them.

use serde_json::{Value, json};

use crate::files::{BOX, Place, box_at};

const VIEW: [&str; 6] = ["--eye", "1.6,1.2,0.4", "--target", "-4,-6,0.5", "--size", "96x72"];
/// Two lamps and a sun; the second lamp reaches only the box that stands apart.
const LIGHTS: [&str; 8] = ["--point", "-3,-2,4", "--point", "-8,-9,3", "--light-range", "4", "--sun", "238,40"];

/// Two boxes of 2 m, one in the middle and one 10 m to the south-west, and one behind the eye of [`VIEW`].
fn models(place: &Place) -> [String; 3] {
    [
        place.file("middle.obj", BOX),
        place.file("apart.obj", box_at([-8.0, 0.0, 7.0])),
        place.file("behind.obj", box_at([30.0, 0.0, -30.0])),
    ]
}

/// The report and the mask of the first light.
fn determined(place: &Place, options: &[&str]) -> (Value, Vec<u8>) {
    let [a, b, c] = models(place);
    let (picture, mask) = (place.out("x.png"), place.out("mask.png"));
    let outputs = ["-o", &picture, "--mask", &mask, "--json", "-", "-q"];
    let run = place.umbrae(&[&["render", &a, &b, &c], &outputs[..], &VIEW, options].concat()).success();
    let report = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    (report, image::open(&mask).expect("a picture").into_luma8().into_raw())
}

fn sum(values: &Value) -> u64 {
    let numbers: Vec<u64> = match values {
        Value::Array(list) => list.iter().filter_map(Value::as_u64).collect(),
        Value::Object(fields) => fields.values().filter_map(Value::as_u64).collect(),
        other => panic!("{other} has no parts"),
    };
    numbers.iter().sum()
}

#[test]
fn no_switch_changes_what_is_lit() {
    let place = Place::new();
    let (_, expected) = determined(&place, &LIGHTS);
    let switches: &[&[&str]] = &[
        &["--no-cull"],
        &["--no-light-cull"],
        &["--no-reach-cull"],
        &["--no-view-cull"],
        &["--no-cap-cull"],
        &["--no-scissor"],
        &["--no-light-scissor"],
        &["--no-caster-scissor"],
        &["--no-light-mark"],
        &["--light-mark", "exact"],
        &["--light-mark", "select"],
        &["--silhouette", "auto"],
        &["--silhouette", "scan"],
        &["--silhouette", "dual"],
        &["--silhouette", "cones"],
        &["--silhouette", "coherent"],
        &["--silhouette", "gpu"],
        &["--silhouette", "gpu", "--method", "zfail"],
        &["--method", "zfail"],
        &["--method", "eye-count"],
        &["--no-cull", "--no-scissor", "--no-light-mark", "--method", "zfail"],
    ];
    for switch in switches {
        let (report, mask) = determined(&place, &[&LIGHTS[..], switch].concat());
        let silhouette = if let ["--silhouette", name, ..] = switch { name } else { "auto" };
        assert_eq!(report["silhouette"], silhouette);
        assert!(mask == expected, "{switch:?} changes the mask");
        assert!(report["lights"].as_array().is_some_and(|lights| lights.len() == 3));
    }
}

#[test]
fn the_report_leaves_out_what_only_the_gpu_knows() {
    let place = Place::new();
    let (report, _) = determined(&place, &[&LIGHTS[..], &["--silhouette", "gpu"]].concat());
    let lights = report["lights"].as_array().expect("a list");
    let casters = lights.iter().flat_map(|light| light["casters"].as_array().expect("a list"));
    let (mut drawn, mut left_out) = (0, 0);
    for caster in casters {
        let is_known = caster["fate"] != "drawn" || caster["kind"] == "sphere";
        for key in ["silhouette_edges", "triangles", "chain_triangles"] {
            assert_eq!(caster.get(key).is_some(), is_known, "{key} of {caster}");
        }
        drawn += usize::from(!is_known);
        left_out += usize::from(is_known);
    }
    assert!(drawn > 0 && left_out > 0);
}

#[test]
fn the_report_tells_what_was_left_out_and_why() {
    let place = Place::new();
    let (report, _) = determined(&place, &LIGHTS);
    assert_eq!(report["left_out"]["light_mark"], "exact");
    assert_eq!(report["left_out"]["caster_scissor"], true);
    let lights = report["lights"].as_array().expect("a list");
    for light in lights {
        let casters = light["casters"].as_array().expect("a list");
        let fates = |fate: &str| casters.iter().filter(|caster| caster["fate"] == fate).count();
        for (key, fate) in [
            ("not_casting", "not casting"),
            ("light_out_of_view", "light out of view"),
            ("out_of_reach", "out of reach"),
            ("shadow_out_of_view", "shadow out of view"),
        ] {
            assert_eq!(light["culled"][key], json!(fates(fate)), "{light}");
        }
        assert_eq!(sum(&light["cases"]), fates("drawn") as u64);
        for caster in casters {
            let is_drawn = caster["fate"] == "drawn";
            for key in ["case", "why", "scissor"] {
                assert_eq!(caster.get(key).is_some(), is_drawn, "{key} of {caster}");
            }
        }
        for part in ["sides", "dark_cap", "light_cap"] {
            let of_casters: u64 = casters.iter().filter_map(|caster| caster["triangles"][part].as_u64()).sum();
            assert_eq!(light["cost"]["triangles"][part], json!(of_casters));
        }
        assert!(light.get("cost_without_culling").is_none() && light["cost"].get("fragments").is_none());
    }
    let near = &lights[1];
    assert!(near["culled"]["out_of_reach"].as_u64().is_some_and(|count| count >= 2), "{near}");

    let (report, _) = determined(&place, &[&LIGHTS[..], &["--no-cull", "--no-scissor", "--no-light-mark"]].concat());
    assert_eq!(report["left_out"]["light_mark"], "off");
    for light in report["lights"].as_array().expect("a list") {
        assert_eq!(sum(&light["cases"]), 4, "three boxes and the ground: {light}");
        assert_eq!(light["scissor"], json!({ "min": [0, 0], "max": [96, 72] }));
    }
}

#[test]
fn fragments_are_counted_with_and_without_culling() {
    let place = Place::new();
    let (report, _) = determined(&place, &[&LIGHTS[..], &["--count-fragments"]].concat());
    for light in report["lights"].as_array().expect("a list") {
        let [with, without] = ["cost", "cost_without_culling"].map(|key| &light[key]);
        assert!(with["fragments"].is_u64() && without["fragments"].as_u64() > Some(0), "{with} {without}");
        assert!(sum(&with["triangles"]) <= sum(&without["triangles"]), "{with} {without}");
    }
    let lamp = &report["lights"][1];
    assert!(lamp["cost"]["fragments"].as_u64() < lamp["cost_without_culling"]["fragments"].as_u64(), "{lamp}");
}

#[test]
fn eye_count_tells_how_many_volumes_the_eye_is_in() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    // Behind the box as seen from the sun.
    let view = ["--sun", "238,40", "--eye", "1.5,1.5,0.3", "--target", "10,10,0", "--size", "96x72", "--no-ground"];
    let args = ["render", &model, "-o", &place.out("x.png"), "--json", "-", "--method", "eye-count", "--verify"];
    let run = place.umbrae(&[&args[..], &view].concat()).success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    assert_eq!(report["method"], "eye-count");
    assert_eq!(report["verify"]["errors"], 0);
    let caster = &report["lights"][0]["casters"][0];
    let shadow_reaches_eye = caster["fate"] == "drawn";
    assert!(shadow_reaches_eye, "{caster}");
    assert_eq!((&caster["why"], &caster["volumes_around_eye"]), (&json!("eye counted"), &json!(1)), "{caster}");
}

#[test]
fn switches_that_contradict_or_count_for_nobody_are_refused() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let picture = place.out("x.png");
    let args = ["render", &model, "-o", &picture];
    let cases: &[(&[&str], &[&str])] = &[
        (&["--light-mark", "exact", "--no-light-mark"], &["--light-mark", "--no-light-mark"]),
        (&["--light-mark", "maybe"], &["--light-mark", "off, exact, select, receivers"]),
        (&["--count-fragments"], &["--json"]),
        (&["--method", "guess"], &["--method", "auto, zpass, zfail, eye-count"]),
    ];
    for (options, words) in cases {
        place.refuses(&[&args[..], options].concat(), words);
    }
}
