//! Lamps on the command line: what is said about which, how far they reach, lamps with a size, and the town by night.

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::{Value, json};

use crate::files::{BOX, Place, TRIANGLE, floats, glb, push, triangles_document};

const SMALL: [&str; 4] = ["--size", "40x30", "--samples", "1"];

/// The lights of a report on [`BOX`] under what `options` say.
fn lights(place: &Place, options: &[&str]) -> Vec<Value> {
    let (model, picture) = (place.file("box.obj", BOX), place.out("x.png"));
    let args = [&["render", &model, "-q", "-o", &picture, "--json", "-"], &SMALL[..], options].concat();
    let output = place.umbrae(&args).success().stderr("").get_output().stdout.clone();
    let report: Value = serde_json::from_slice(&output).expect("JSON");
    report["lights"].as_array().expect("a list").clone()
}

fn names(lights: &[Value]) -> Vec<&str> {
    lights.iter().map(|light| light["name"].as_str().expect("a name")).collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|n| n.as_f64().expect("a number")).collect()
}

fn is_near(value: &Value, expected: f64) -> bool {
    value.as_f64().is_some_and(|value| (value - expected).abs() <= 1e-5 * expected.abs().max(1.0))
}

#[test]
fn what_is_said_after_a_lamp_is_about_that_lamp() {
    let place = Place::new();
    let options = [
        &["--spot", "3,0,4:-3,0,-4:30", "--light-inner", "10", "--light-color", "#ff0000"][..],
        &["--point", "0,-5,3", "--light-intensity", "50", "--light-color", "1,0.5,0.25", "--light-range", "8"],
        &["--sun", "90,45", "--light-color", "white", "--light-intensity", "2"],
        &["--point", "0,5,3"],
    ]
    .concat();
    let lights = lights(&place, &options);
    assert_eq!(names(&lights), ["spot 1", "point 1", "sun", "point 2"], "they stay in order");
    let kinds: Vec<&Value> = lights.iter().map(|light| &light["kind"]).collect();
    assert_eq!(kinds, ["spot", "point", "directional", "point"]);

    assert_eq!(lights[0]["position"], json!([3.0, 0.0, 4.0]));
    assert_eq!(lights[0]["color"], json!([1.0, 0.0, 0.0]));
    let cone = &lights[0]["cone"];
    assert!(is_near(&cone["inner_deg"], 10.0) && is_near(&cone["outer_deg"], 30.0), "{cone}");
    let direction = numbers(&cone["direction"]);
    assert!((direction[0] + 0.6).abs() < 1e-6 && (direction[2] + 0.8).abs() < 1e-6, "{cone}");

    assert_eq!(lights[1]["strength"], json!([50.0, 25.0, 12.5]));
    assert_eq!((&lights[1]["intensity"], &lights[1]["color"]), (&json!(50.0), &json!([1.0, 0.5, 0.25])));
    assert_eq!(lights[1]["range"], json!(8.0));
    assert_eq!(lights[2]["strength"], json!([2.0, 2.0, 2.0]));

    for key in ["range", "position", "cone"] {
        assert!(lights[2].get(key).is_none(), "the sun has no {key}");
    }
    assert!(lights[1].get("cone").is_none() && lights[3].get("cone").is_none());
}

#[test]
fn a_lamp_without_a_range_reaches_as_far_as_a_display_can_show() {
    let place = Place::new();
    let reaches = |options: &[&str]| lights(&place, options)[0]["range"].as_f64().expect("a lamp has one");
    let alone = reaches(&["--point", "0,0,6"]);
    // 1.05 at the middle, 5 m away, and 1 / 512 where it ends.
    assert!((alone / (5.0 * (1.05_f64 * 512.0).sqrt()) - 1.0).abs() < 0.01, "{alone}");
    // What the brightest outshines a hundredfold reaches a tenth as far.
    let dim = reaches(&["--point", "0,0,6", "--light-intensity", "1", "--point", "0,0,6", "--light-intensity", "100"]);
    assert!((dim / alone - 0.1).abs() < 1e-3, "{dim} of {alone}");
}

#[test]
fn lamps_of_a_model_shine_where_the_user_names_none_and_keep_their_ranges() {
    let place = Place::new();
    let mut document = triangles_document(&[0]);
    document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "intensity": 20, "range": 7.5 },
        { "type": "spot", "intensity": 20, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.5 } },
    ] } });
    for light in 0..2 {
        let extensions = json!({ "KHR_lights_punctual": { "light": light } });
        push(
            &mut document["nodes"],
            json!({ "name": format!("l{light}"), "translation": [0.3, 3, 1], "extensions": extensions }),
        );
    }
    document["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let model = place.file("lamps.glb", glb(&document, &floats(&TRIANGLE)));
    let args = ["render", &model, "-o", &place.out("x.png"), "--json", "-", "--verify"];
    let run = place.umbrae(&[&args[..], &SMALL].concat()).success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    let lights = report["lights"].as_array().expect("a list");
    assert_eq!(names(lights), ["l0", "l1"]);
    assert_eq!((&lights[0]["kind"], &lights[0]["range"]), (&json!("point"), &json!(7.5)));
    assert_eq!(lights[1]["kind"], "spot");
    assert!(lights[1]["range"].as_f64().is_some_and(|range| range > 0.0));
    assert!(is_near(&lights[1]["cone"]["outer_deg"], 0.5_f64.to_degrees()));
}

#[test]
fn lamps_with_a_size_are_many_of_the_same_strength_together() {
    let place = Place::new();
    let options = ["--point", "0,0,6", "--spot", "4,0,6:-4,0,-6:30", "--sun", "200,40"];
    let whole = lights(&place, &options);
    let many = lights(&place, &[&options[..], &["--area-samples", "5", "--area-radius", "0.5"]].concat());
    assert_eq!(many.len(), 11, "the sun stays one");
    assert_eq!((names(&many)[0], names(&many)[9], names(&many)[10]), ("point 1 #1", "spot 1 #5", "sun"));
    for (lamp, range) in [(0, 0..5), (1, 5..10)] {
        let parts = &many[range];
        let total: f64 = parts.iter().map(|part| part["intensity"].as_f64().expect("a number")).sum();
        assert!(is_near(&whole[lamp]["intensity"], total), "{total} of {}", whole[lamp]["intensity"]);
        let center = numbers(&whole[lamp]["position"]);
        for part in parts {
            // Together they are seen as far as the lamp was, though each alone would not be.
            assert_eq!(part["range"], whole[lamp]["range"]);
            let offset = numbers(&part["position"]).iter().zip(&center).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            assert!(offset.sqrt() <= 0.5 + 1e-5, "{part}");
        }
    }
    assert_eq!(many[10]["strength"], whole[2]["strength"]);
}

#[test]
fn a_size_without_a_lamp_is_a_warning() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let args = ["render", &model, "-o", &place.out("x.png"), "--area-samples", "4"];
    let warning = contains("warning: --area-samples changes nothing: no light is a lamp");
    place.umbrae(&[&args[..], &SMALL].concat()).success().stderr(warning);
}

#[test]
fn the_shadow_of_a_lamp_with_a_size_is_soft() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    // From straight above; the shadow of the box's upper edge lies at x = -5.67, 8 pixels wide for a lamp of 1 m.
    let highest_step = |options: &[&str]| {
        let picture = place.out("x.png");
        let view =
            ["--eye", "0,-0.1,30", "--target", "0,0,0", "--point", "6,0,5", "--size", "160x120", "--samples", "1"];
        place.umbrae(&[&["render", &model, "-q", "-o", &picture], &view[..], options].concat()).success();
        let picture = image::open(&picture).expect("a picture").into_luma8();
        let row: Vec<i16> = (34..54).map(|x| i16::from(picture.get_pixel(x, 60).0[0])).collect();
        row.windows(2).map(|pair| (pair[1] - pair[0]).abs()).max().expect("twenty pixels")
    };
    let (hard, soft) = (highest_step(&[]), highest_step(&["--area-samples", "16", "--area-radius", "1"]));
    assert!(hard >= 20 && soft <= hard / 3, "steps of {hard} hard, {soft} soft");
}

#[test]
fn what_is_said_about_no_lamp_or_the_wrong_one_is_refused() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let picture = place.out("x.png");
    let point = ["--point", "1,2,3"];
    let spot = ["--spot", "0,0,5:0,0,-1:30"];
    let cases: &[(Vec<&str>, &[&str])] = &[
        (
            vec!["--light-range", "12", "--point", "1,2,3"],
            &["`--light-range 12` stands before any lamp; put it after the --point, --spot or --sun that it is about"],
        ),
        (vec!["--light-color", "red"], &["`--light-color red` stands before any lamp"]),
        (
            [&point[..], &["--light-range", "12", "--light-range", "14"]].concat(),
            &["`--light-range 12` and `--light-range 14` are both about `--point 1,2,3`; leave one out"],
        ),
        (
            vec!["--sun", "200,30", "--light-range", "12"],
            &["`--light-range 12` is about `--sun 200,30`, which shines without end; put it after a --point or --spot"],
        ),
        (
            [&point[..], &["--light-inner", "12"]].concat(),
            &["`--light-inner 12` is about `--point 1,2,3`, which has no cone; put it after a --spot"],
        ),
        (
            [&spot[..], &["--light-inner", "30"]].concat(),
            &["`--light-inner 30` is not inside the cone of `--spot 0,0,5:0,0,-1:30`; give less than 30 degrees"],
        ),
        (vec!["--spot", "0,0,5"], &["--spot", "`0,0,5` is not a spot; write its place, its direction and degrees"]),
        (vec!["--spot", "0,5:0,0,-1:30"], &["--spot", "`0,5` is not a point"]),
        (vec!["--spot", "0,0,5:0,0,0:30"], &["--spot", "`0,0,0` is not a direction", "not all of them 0"]),
        (vec!["--spot", "-1,0,5:0,0,-1:91"], &["--spot", "`91` is not an angle of a cone", "to 90"]),
        (vec!["--spot", "0,0,5:0,0,-1:0"], &["--spot", "`0` is not an angle of a cone"]),
        ([&spot[..], &["--light-inner", "-3"]].concat(), &["--light-inner", "`-3` is not an angle of a cone"]),
        ([&point[..], &["--light-color", "1,2,3"]].concat(), &["--light-color", "`1,2,3` is not a colour", "#rrggbb"]),
        ([&point[..], &["--light-color", "-1,0,0"]].concat(), &["--light-color", "`-1,0,0` is not a colour"]),
        ([&point[..], &["--light-color", "bluish"]].concat(), &["--light-color", "`bluish` is not a colour"]),
        ([&point[..], &["--light-range", "0"]].concat(), &["--light-range", "`0` is not a length", "12.5"]),
        ([&point[..], &["--light-range", "-4"]].concat(), &["--light-range", "`-4` is not a length"]),
        ([&point[..], &["--light-intensity", "-4"]].concat(), &["--light-intensity", "`-4` is not an intensity"]),
        ([&point[..], &["--light-intensity", "nan"]].concat(), &["--light-intensity", "`nan` is not an intensity"]),
        ([&point[..], &["--area-samples", "0"]].concat(), &["--area-samples", "0", "1..=4096"]),
        ([&point[..], &["--area-samples", "-2"]].concat(), &["--area-samples", "-2"]),
        ([&point[..], &["--area-radius", "1"]].concat(), &["--area-samples"]),
        (
            [&point[..], &["--area-samples", "2", "--area-radius", "0"]].concat(),
            &["--area-radius", "`0` is not a length"],
        ),
    ];
    for (options, words) in cases {
        place.refuses(&[&["render", &model, "-o", &picture], &options[..]].concat(), words);
    }
}

#[test]
fn the_town_by_night_has_twenty_lamps_that_reach_a_few_houses() {
    let place = Place::new();
    let town = place.out("night.glb");
    place.umbrae(&["sample", "town", "--night", "-o", &town]).success().stderr(contains(", 20 lights"));
    let text = place.umbrae(&["inspect", &town]).success().get_output().stdout.clone();
    let text = String::from_utf8(text).expect("text");
    let lights: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("  light ")).map(str::trim).collect();
    assert_eq!(lights.len(), 20, "{text}");
    for light in &lights {
        assert!(light.starts_with("lamp ") && light.contains(", reaches 1") && light.ends_with(" m"), "{light}");
    }
    assert_eq!(lights.iter().filter(|light| light.contains(": spot, 62 degrees to its edge")).count(), 4);
    let json = place.umbrae(&["inspect", &town, "--json"]).success().get_output().stdout.clone();
    let json: Value = serde_json::from_slice(&json).expect("JSON");
    assert_eq!(json["lights"].as_array().map(Vec::len), Some(20));
    assert_eq!(json["cameras"], json!(["market"]));
}

#[test]
fn only_the_town_has_a_night() {
    let place = Place::new();
    for sample in ["high-rise", "industry", "lattice-tower", "staircase"] {
        let words = [&format!("the sample {sample} has no street lamps"), "only `umbrae sample town --night` has"];
        place.refuses(&["sample", sample, "--night", "-o", &place.out("x.glb")], &words);
    }
    let day = place.umbrae(&["sample", "town", "-o", &place.out("x.glb")]).success();
    day.stderr(contains("triangles in").and(contains("light").not()));
}

#[test]
fn lights_have_the_size_that_one_says_and_the_report_tells_it() {
    let place = Place::new();
    let options = [
        "--light-radius",
        "0.25",
        "--point",
        "3,0,4",
        "--spot",
        "0,-3,4:0,3,-4:40",
        "--light-size",
        "0.8x0.4",
        "--sun",
        "90,45",
        "--sun-disc",
    ];
    let lights = lights(&place, &options);
    assert_eq!(lights[0]["extent"], json!({ "shape": "ball", "radius": 0.25 }));
    assert_eq!(lights[1]["extent"]["shape"], "rectangle");
    let (right, up) = (numbers(&lights[1]["extent"]["half_right"]), numbers(&lights[1]["extent"]["half_up"]));
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((length(&right) - 0.4).abs() < 1e-6 && (length(&up) - 0.2).abs() < 1e-6, "{right:?} {up:?}");
    assert_eq!(lights[2]["extent"]["shape"], "disc");
    assert!(is_near(&lights[2]["extent"]["radius_deg"], 0.2665), "{}", lights[2]);
}

/// What is drawn soft differs from what is drawn hard along shadows, and nowhere in the mask, which is about the middle of the light.
#[test]
fn soft_pictures_differ_from_hard_ones_and_masks_and_proofs_do_not() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let drawn = |name: &str, options: &[&str]| {
        let (picture, mask) = (place.out(&format!("{name}.png")), place.out(&format!("{name}-mask.png")));
        let files = ["render", &model, "-q", "-o", &picture, "--mask", &mask, "--verify", "--size", "80x60"];
        place.umbrae(&[&files[..], &["--point", "2,-2,5"], options].concat()).success();
        [picture, mask].map(|path| std::fs::read(path).expect("it was written"))
    };
    for samples in ["1", "4"] {
        let [hard, hard_mask] = drawn("hard", &["--samples", samples]);
        let [soft, soft_mask] = drawn("soft", &["--samples", samples, "--light-radius", "0.5"]);
        assert_ne!(hard, soft, "{samples} samples");
        assert_eq!(hard_mask, soft_mask);
    }
}

#[test]
fn what_reaches_into_a_light_with_a_size_is_told() {
    let place = Place::new();
    let (model, picture) = (place.file("box.obj", BOX), place.out("x.png"));
    let files = ["render", &model, "-o", &picture];
    let run = |options: &[&str]| place.umbrae(&[&files[..], &SMALL[..], options].concat()).success();
    let lamp = ["--point", "0.5,0.5,2.7"];
    let told = "into the light `point 1`: its soft shadow is not right";
    run(&[&lamp[..], &["--light-radius", "0.8"]].concat()).stderr(contains(told));
    run(&[&lamp[..], &["--light-radius", "0.6"]].concat()).stderr(contains(told).not());
    run(&[&lamp[..], &["--light-radius", "0.8", "--no-cast", "*"]].concat()).stderr(contains(told).not());
    run(&[&lamp[..], &["--light-size", "0.5x0.5"]].concat()).stderr(contains(told).not());
    run(&lamp).stderr(contains(told).not());
    let ball = ["--sphere", "1.2,0.5,2.7:0.5"];
    run(&[&lamp[..], &ball, &["--light-radius", "0.3"]].concat()).stderr(contains(told));
    run(&[&lamp[..], &ball, &["--light-radius", "0.1"]].concat()).stderr(contains(told).not());
}

#[test]
fn a_size_that_can_not_be_is_refused_and_one_that_changes_nothing_is_told() {
    let place = Place::new();
    let (model, picture) = (place.file("box.obj", BOX), place.out("x.png"));
    let run = |options: &[&str]| place.umbrae(&[&["render", &model, "-o", &picture], &SMALL[..], options].concat());
    for (options, said) in [
        (&["--point", "2,-2,5", "--light-radius", "0"][..], "`0` is not a length"),
        (&["--point", "2,-2,5", "--light-radius", "-1"], "`-1` is not a length"),
        (&["--point", "2,-2,5", "--light-radius", "nan"], "`nan` is not a length"),
        (&["--point", "2,-2,5", "--light-radius", "1000"], "too large for `point 1`"),
        (&["--point", "2,-2,5", "--light-size", "1"], "`1` is not a size"),
        (&["--point", "2,-2,5", "--light-size", "1x1000"], "too large for `point 1`"),
        (&["--point", "0,0,1", "--light-size", "0.1x0.1"], "faces nothing; a spot says where it faces"),
        (&["--sun", "90,45", "--light-radius", "1"], "--sun-disc gives the sun its size"),
        (&["--point", "2,-2,5", "--light-radius", "1", "--area-samples", "4"], "cannot be used with"),
    ] {
        run(options).code(2).stderr(contains(said));
        assert!(!std::path::Path::new(&picture).exists(), "{options:?} wrote a picture");
    }
    // A lamp in the middle of a room is where lamps are.
    run(&["--point", "0,0,1", "--light-radius", "0.1"]).success();
    run(&["--soft"]).success().stderr(contains("--soft changes nothing"));
    run(&["--light-radius", "1"]).success().stderr(contains("change nothing: no light is a lamp"));
    run(&["--point", "2,-2,5", "--sun-disc"]).success().stderr(contains("--sun-disc changes nothing"));
}
