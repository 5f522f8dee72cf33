//! `--json` and `--verify`: what they tell, and that they tell when something is wrong.

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::{Value, json};

use crate::files::{BOX, Place, TRIANGLE, box_at, floats, glb, triangles_document};

/// Behind the box as seen from the sun, looking away from it: z-pass is wrong there by construction.
const IN_SHADOW: [&str; 8] = ["--sun", "238,40", "--eye", "1.5,1.5,0.3", "--target", "10,10,0", "--size", "96x72"];

/// The report of a picture, which must be alone on standard output.
fn report(place: &Place, args: &[&str]) -> Value {
    let picture = place.out("x.png");
    let args = [&["render"], args, &["-o", &picture, "--json", "-"]].concat();
    let output = place.umbrae(&args).success().get_output().stdout.clone();
    serde_json::from_slice(&output).expect("standard output is JSON and nothing else")
}

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().expect("an object").keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

#[test]
fn the_report_has_every_key() {
    let place = Place::new();
    let obj = place.file("box.obj", BOX);
    let other = place.file("other.glb", glb(&triangles_document(&[0]), &floats(&TRIANGLE)));
    let args = [&obj, &other, "--sun", "238,40", "--point", "3,-4,5", "--verify", "--size", "64x48", "--samples", "1"];
    let report = report(&place, &args);
    assert_eq!(
        keys(&report),
        [
            "adapter",
            "camera",
            "ground",
            "left_out",
            "lights",
            "method",
            "models",
            "origin",
            "passes",
            "posing",
            "samples",
            "silhouette",
            "times_ms",
            "verify",
            "version"
        ]
    );
    assert!(report["adapter"].as_str().is_some_and(|label| !label.is_empty()));
    assert_eq!(keys(&report["camera"]), ["eye", "fov_y_deg", "near", "size", "target", "up"]);
    assert_eq!(report["camera"]["size"], json!([64, 48]));
    assert_eq!(keys(&report["ground"]), ["center", "half_extent", "height"]);
    assert_eq!(report["origin"], json!([0.0, 0.0, 0.0]));
    assert_eq!((&report["method"], &report["samples"]), (&json!("auto"), &json!(1)));

    assert_eq!(report["models"].as_array().map(Vec::len), Some(2));
    for (model, (path, format)) in
        report["models"].as_array().expect("a list").iter().zip([(&obj, "obj"), (&other, "gltf")])
    {
        assert_eq!(keys(model), ["format", "path", "up", "warnings", "world_from_file"]);
        assert_eq!((&model["path"], &model["format"], &model["up"]), (&json!(path), &json!(format), &json!("y")));
        assert_eq!(model["world_from_file"], json!([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]));
    }

    let lights = report["lights"].as_array().expect("a list");
    assert_eq!(lights.len(), 2);
    assert_eq!(lights[0]["kind"], "directional");
    assert_eq!((&lights[1]["kind"], &lights[1]["position"]), (&json!("point"), &json!([3.0, -4.0, 5.0])));
    let towards: Vec<f64> = serde_json::from_value(lights[0]["direction_to_light"].clone()).expect("three numbers");
    assert!(
        (towards[2] - 40_f64.to_radians().sin()).abs() < 1e-6 && towards[0] < 0.0 && towards[1] < 0.0,
        "{towards:?}"
    );
    let common = [
        "batches",
        "cases",
        "casters",
        "color",
        "cost",
        "culled",
        "intensity",
        "kind",
        "name",
        "scissor",
        "silhouettes_and_volumes_ms",
        "strength",
    ];
    let with = |more: &[&'static str]| {
        let mut keys = [&common[..], more].concat();
        keys.sort_unstable();
        keys
    };
    assert_eq!(keys(&lights[0]), with(&["direction_to_light"]));
    assert_eq!(keys(&lights[1]), with(&["position", "range"]));
    for light in lights {
        let casters = light["casters"].as_array().expect("a list");
        assert_eq!(casters.len(), 3, "the box, the triangle and the ground");
        for caster in casters {
            let of_drawn = [
                "bytes_per_index",
                "case",
                "casts",
                "chain_triangles",
                "fate",
                "is_glass",
                "kind",
                "name",
                "parts",
                "scissor",
                "silhouette_edges",
                "triangles",
                "why",
            ];
            let is_drawn = caster["fate"] == "drawn";
            let expected = of_drawn.into_iter().filter(|key| is_drawn || !["case", "scissor", "why"].contains(key));
            assert_eq!(keys(caster), expected.collect::<Vec<_>>());
            assert_eq!((&caster["casts"], &caster["is_glass"]), (&json!(true), &json!(false)));
            assert_eq!(keys(&caster["triangles"]), ["dark_cap", "light_cap", "sides"]);
            assert_eq!(caster["case"].as_u64().is_some_and(|case| (1..=3).contains(&case)), is_drawn);
        }
        // A box has six silhouette edges; a point light's sides are quads.
        assert_eq!(casters[0]["silhouette_edges"], 6);
        let sides = if light["kind"] == "point" { 12 } else { 6 };
        assert_eq!(casters[0]["triangles"]["sides"], sides);
    }

    for pass in report["passes"].as_array().expect("a list") {
        assert_eq!(keys(pass), ["ms", "name"]);
        assert!(pass["ms"].as_f64().is_some_and(|ms| ms >= 0.0), "{pass}");
    }
    assert_eq!(keys(&report["times_ms"]), ["device", "load", "picture", "topology", "upload", "verify"]);

    let verify = &report["verify"];
    assert_eq!(keys(verify), ["decided", "errors", "lights", "pixels", "surface"]);
    assert_eq!((&verify["pixels"], &verify["errors"]), (&json!(2 * 64 * 48), &json!(0)));
    let names = |lights: &Value| -> Vec<Value> {
        lights.as_array().expect("a list").iter().map(|light| light["name"].clone()).collect()
    };
    assert_eq!(names(&verify["lights"]), names(&report["lights"]), "every light is verified");
    for key in ["pixels", "surface", "decided", "errors"] {
        let of_lights: u64 =
            verify["lights"].as_array().expect("a list").iter().map(|l| l[key].as_u64().expect(key)).sum();
        assert_eq!(verify[key].as_u64(), Some(of_lights), "{key}");
    }
    assert!(verify["decided"].as_u64() <= verify["surface"].as_u64());
}

#[test]
fn the_report_of_a_far_model_is_in_its_own_coordinates() {
    let place = Place::new();
    let far = place.file("far.obj", box_at([2.5e7, 1.0e5, 4.0e6]));
    let report = report(&place, &[&far, "--size", "40x30", "--no-ground", "--point", "25000003,-4000003,100007"]);
    assert_eq!(report["origin"], json!([2.5e7, -4.0e6, 100_001.0]));
    assert_eq!(report["ground"], Value::Null);
    assert_eq!(report["lights"][0]["position"], json!([25_000_003.0, -4_000_003.0, 100_007.0]));
    assert!(report.get("verify").is_none(), "there is none unless it is asked for");
    let target: Vec<f64> = serde_json::from_value(report["camera"]["target"].clone()).expect("three numbers");
    assert!((target[0] - 2.5e7).abs() < 2.0 && (target[1] + 4.0e6).abs() < 2.0, "{target:?}");
}

#[test]
fn the_report_in_a_file_is_the_one_on_standard_output() {
    let place = Place::new();
    let obj = place.file("box.obj", BOX);
    let mut on_stdout = report(&place, &[&obj, "--size", "40x30"]);
    let args = ["render", &obj, "-o", &place.out("x.png"), "--json", &place.out("x.json"), "--size", "40x30"];
    place.umbrae(&args).success().stdout("");
    let text = std::fs::read(place.out("x.json")).expect("it is there");
    let mut in_file: Value = serde_json::from_slice(&text).expect("JSON");
    for report in [&mut on_stdout, &mut in_file] {
        for times in ["times_ms", "passes"] {
            report[times] = Value::Null;
        }
        report["lights"][0]["silhouettes_and_volumes_ms"] = Value::Null;
    }
    assert_eq!(on_stdout, in_file);
}

#[test]
fn verify_finds_what_z_pass_gets_wrong_and_shows_where() {
    let place = Place::new();
    let obj = place.file("box.obj", BOX);
    let picture = place.out("x.png");
    let args = [&["render", &obj, "-o", &picture, "--verify", "--json", "-"], &IN_SHADOW[..]].concat();
    let said = contains("errors in")
        .and(contains("warning: wrong pixels are ringed in red in `"))
        .and(contains("x-errors.png"));
    let run = place.umbrae(&[&args[..], &["--method", "zpass"]].concat()).code(1).stderr(said);
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    assert_eq!(report["method"], "zpass");
    let verify = |key: &str| report["verify"][key].as_u64().expect("a number");
    assert!(verify("errors") > 1000 && verify("errors") <= verify("decided"), "{report}");
    assert_eq!(place.written(), ["x-errors.png", "x.png"]);
    let errors = image::open(place.out("x-errors.png")).expect("a picture").into_rgb8();
    assert_eq!(errors.dimensions(), (96, 72));
    let white = errors.pixels().filter(|pixel| pixel.0 == [255; 3]).count() as u64;
    assert_eq!(white, verify("errors"), "each wrong pixel has a white middle");

    std::fs::remove_file(place.out("x-errors.png")).expect("it is there");
    for method in ["auto", "zfail"] {
        let run = place.umbrae(&[&args[..], &["--method", method]].concat()).success();
        let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
        assert_eq!(report["verify"]["errors"], 0);
        assert_eq!(report["verify"]["decided"].as_u64(), Some(verify("decided")), "the rays do not know the method");
    }
    assert_eq!(place.written(), ["x.png"], "nothing is wrong, so nothing shows where");
}

/// Bug: that the picture of errors could not be written was found out only after the rays were cast.
#[test]
fn a_place_for_the_picture_of_errors_is_made_sure_of_first() {
    let place = Place::new();
    std::fs::create_dir(place.out("x-errors.png")).expect("a folder");
    let args = ["render", "nosuch.obj", "-o", "out/x.png", "--verify"];
    place.refuses(&args, &["can't write `out/x-errors.png`", "it is a folder"]);
}
