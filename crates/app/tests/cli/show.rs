//! `render --show`: pictures of how it works, and what the report says of them.

use std::fs;

use predicates::str::contains;
use serde_json::Value;

use crate::files::{BOX, Place};

const MODES: [&str; 7] = ["volumes", "silhouettes", "cases", "counts", "topology", "bounds", "fill"];

#[test]
fn every_mode_draws_a_picture_of_its_own_and_says_what_it_shows() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let draw = |arguments: &[&str]| {
        let mut all = vec!["render", &model, "-o", "out/x.png", "--size", "320x180", "--json", "out/x.json"];
        all.extend(arguments);
        place.umbrae(&all).success();
        let json = fs::read(place.out("x.json")).expect("it was written");
        let report: Value = serde_json::from_slice(&json).expect("it is JSON");
        (fs::read(place.out("x.png")).expect("it was written"), report)
    };
    let (plain, report) = draw(&[]);
    assert!(report.get("show").is_none(), "nothing was shown");
    let mut pictures = vec![plain];
    for mode in MODES {
        let (picture, report) = draw(&["--show", mode]);
        assert!(!pictures.contains(&picture), "{mode} looks like another one");
        pictures.push(picture);
        let show = &report["show"];
        assert_eq!(show["mode"], mode);
        let said = show["legend"].as_array().expect("a list").len();
        assert!(said >= 3, "{mode}: {show}");
        let lights: &[&str] = if mode == "topology" { &[] } else { &["sun"] };
        assert_eq!(show["lights"], serde_json::json!(lights), "{mode}");
    }
}

#[test]
fn a_light_is_shown_by_its_name() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let lamps = ["--point", "3,0,4", "--point", "0,3,4", "--size", "64x48", "--show", "cases"];
    let with =
        |light: &[&'static str]| [&["render", &model, "-o", "out/x.png", "--json", "-"], &lamps[..], light].concat();
    place.umbrae(&with(&["--show-light", "point 2"])).success().stdout(contains("light \\\"point 2\\\""));
    place.umbrae(&with(&[])).success().stdout(contains("light \\\"point 1\\\""));
    let words = ["there is no light \"moon\" to show", "\"point 1\", \"point 2\""];
    place.refuses(&with(&["--show-light", "moon"]), &words);
    place.refuses(&["render", &model, "-o", "out/x.png", "--show-light", "sun"], &["--show"]);
    place.refuses(&["render", &model, "-o", "out/x.png", "--show", "nothing"], &["volumes", "silhouettes", "fill"]);
}

/// What is shown goes over the picture, and changes neither verdicts nor the mask.
#[test]
fn showing_leaves_mask_and_verification_alone() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let mask = |arguments: &[&str]| {
        let mut all = vec!["render", &model, "-o", "out/x.png", "--mask", "out/m.png", "--size", "96x54", "--verify"];
        all.extend(arguments);
        place.umbrae(&all).success();
        fs::read(place.out("m.png")).expect("it was written")
    };
    let plain = mask(&[]);
    for mode in ["volumes", "bounds", "fill"] {
        assert_eq!(mask(&["--show", mode]), plain, "{mode}");
    }
}
