//! Options that make no picture: each is refused in one sentence that names the option and the value.

use crate::files::{BOX, Place, TRIANGLE, box_at, floats, glb, push, triangles_document};
use serde_json::json;

#[test]
fn options_that_make_no_picture_are_refused() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let cases: &[(&[&str], &[&str])] = &[
        (&["--size", "0x0"], &["--size", "a picture of 0x0 has no pixels", "1280x720"]),
        (&["--size", "640x0"], &["--size", "no pixels"]),
        (&["--size", "100000x100000"], &["--size", "100000x100000 is too large", "up to 16384 pixels"]),
        (&["--size", "4294967297x1"], &["--size", "`4294967297x1` is not a size"]),
        (&["--size", "-5x3"], &["--size", "`-5x3` is not a size"]),
        (&["--size", "big"], &["--size", "`big` is not a size"]),
        (&["--samples", "2"], &["--samples", "[possible values: 1, 4]"]),
        (&["--eye", "nan,0,0"], &["--eye", "`nan,0,0` is not a point"]),
        (&["--eye", "1,2"], &["--eye", "`1,2` is not a point"]),
        (&["--eye", "0,-inf,0"], &["--eye", "`0,-inf,0` is not a point"]),
        (&["--eye", "1e300,0,0"], &["--eye", "too far away", "below 1e18"]),
        (&["--target", "0,0,1e18"], &["--target", "too far away", "below 1e18"]),
        // Bug: such a lamp was infinitely far away in f32, and the picture black.
        (&["--point", "1e39,0,0"], &["--point", "too far away", "below 1e18"]),
        (
            &["--eye", "3,4,5", "--target", "3,4,5"],
            &["the eye and its target are both at 3.0,4.0,5.0; move one of them"],
        ),
        (&["--eye", "1e-200,0,0", "--target", "0,0,0"], &["both at 1e-200,0.0,0.0"]),
        (&["--eye", "0,0,1"], &["the eye is at 0.0,0.0,1.0, in the model's middle", "give a --target"]),
        (&["--fov", "0"], &["--fov", "degrees from 1 to 170"]),
        // Bug: this was an unexpected argument, with advice to write `-- -5`.
        (&["--fov", "-5"], &["--fov", "`-5` is not a field of view"]),
        (&["--fov", "180"], &["--fov", "`180` is not a field of view"]),
        (&["--fov", "nan"], &["--fov", "`nan` is not a field of view"]),
        (&["--sun", "90"], &["--sun", "`90` is not a sun"]),
        (&["--sun", "90,91"], &["--sun", "an altitude of 91.0 degrees is not from -90 to 90"]),
        (&["--sun", "1e300,45"], &["--sun", "an azimuth of 1e300 degrees is not from -360 to 360"]),
        (&["--sun", "nan,45"], &["--sun", "`nan,45` is not a sun"]),
        (&["--method", "guess"], &["--method", "auto, zpass, zfail"]),
        (&["--up", "x"], &["--up", "possible values: y, z"]),
        (&["--camera", "front"], &["there is no camera `front`: the model has none; use --eye and --target"]),
        (&["--camera", "front", "--eye", "1,2,3"], &["--camera", "--eye"]),
        (&["--adapter", "nosuch"], &["no adapter named `nosuch`; this machine has: "]),
        (&["--adapter", "nosuch", "--software"], &["no software adapter named `nosuch`; this machine has: "]),
        (&["--color", "pink"], &["--color", "auto, always, never"]),
        (&["--bogus"], &["unexpected argument '--bogus'"]),
    ];
    let picture = place.out("x.png");
    for (options, words) in cases {
        place.refuses(&[&["render", &model, "-o", &picture], *options].concat(), words);
    }
    place.refuses(&["render", "-o", &picture], &["<MODEL>"]);
    place.refuses(&["draw", &model], &["unrecognized subcommand 'draw'"]);
    place.refuses(&["sample", "village", "-o", &place.out("x.glb")], &["lattice-tower", "town"]);
    place.refuses(&["sample", "town", "-o", &place.out("x.obj")], &["x.obj", "give a name that ends in .glb"]);
    place.refuses(&["completions", "tcsh"], &["bash", "zsh"]);
}

#[test]
fn an_unknown_camera_lists_those_that_there_are() {
    let place = Place::new();
    let mut document = triangles_document(&[0]);
    push(&mut document["nodes"], json!({ "camera": 0, "name": "gate", "translation": [0.3, 0.3, 4] }));
    push(&mut document["nodes"], json!({ "camera": 0, "name": "roof", "translation": [0.2, 0.4, 9] }));
    document["scenes"][0]["nodes"] = json!([0, 1, 2]);
    document["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } }]);
    let model = place.file("cameras.glb", glb(&document, &floats(&TRIANGLE)));
    let args = ["render", &model, "-o", &place.out("x.png"), "--size", "40x30", "--camera"];
    place.refuses(&[&args[..], &["front"]].concat(), &["there is no camera `front`; the model has `gate`, `roof`"]);
    place.umbrae(&[&args[..], &["roof", "--verify"]].concat()).success();
}

#[test]
fn an_unknown_adapter_lists_those_that_doctor_shows() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let shown = place.umbrae(&["doctor"]).success().get_output().stdout.clone();
    let shown = String::from_utf8(shown).expect("text");
    let first = shown.lines().find_map(|line| line.strip_prefix("adapter 1: ")).expect("an adapter");
    let label = first.trim_end_matches("(used by default)").trim_end();
    place.refuses(&["render", &model, "-o", &place.out("x.png"), "--adapter", "nosuch"], &[label]);
    let args = ["render", &model, "-o", &place.out("x.png"), "--size", "40x30", "--adapter"];
    place.umbrae(&[&args[..], &[&label.to_uppercase()]].concat()).success();
}

#[test]
fn models_too_far_from_each_other_for_one_origin_are_refused() {
    let place = Place::new();
    let (here, there) = (place.file("here.obj", BOX), place.file("there.obj", box_at([2.5e7, 0.0, 0.0])));
    let words = ["can't join", "there.obj", "25000000 m apart", "within 100000 m"];
    place.refuses(&["render", &here, &there, "-o", &place.out("x.png")], &words);
}

/// Bug: "is below the horizon" was said of a sun on it.
#[test]
fn a_sun_that_is_not_up_is_drawn_with_a_warning() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    for sun in ["90,0", "90,-90", "-360,-10"] {
        let args = ["render", &model, "-o", &place.out("x.png"), "--size", "40x30", "--verify", "--sun", sun];
        let warning = "warning: the sun is not above the horizon: level ground is dark";
        place.umbrae(&args).success().stderr(predicates::str::contains(warning));
    }
}
