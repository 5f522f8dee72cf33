//! `render --smooth`, `--soft` beside it, and `bench smooth`: boundaries that do not show how finely a mesh is cut.

use std::fmt::Write as _;
use std::fs;

use glam::Vec3;
use predicates::str::contains;
use serde_json::Value;
use umbrae_core::{Surface, shapes};

use crate::files::{BOX, Place};

/// A ball of radius 1 four metres up, over a pebble; z up.
fn ball(subdivisions: u32) -> String {
    let ball = shapes::icosphere(Vec3::Z * 4.0, 1.0, subdivisions);
    obj(&shapes::joined([ball, shapes::cuboid(Vec3::ZERO, Vec3::splat(0.01))]))
}

fn obj(surface: &Surface) -> String {
    let mut text = String::new();
    for p in &surface.positions {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("a string takes all");
    }
    for [a, b, c] in surface.triangles.iter().map(|t| t.map(|i| i + 1)) {
        writeln!(text, "f {a} {b} {c}").expect("a string takes all");
    }
    text
}

/// Straight down on where the ball's shadow falls, which fills about half of the picture.
const VIEW: [&str; 10] =
    ["--up", "z", "--sun", "180,45", "--eye", "0,4,9", "--target", "0,4.001,0", "--size", "200x200"];

fn mask(place: &Place, model: &str, more: &[&str]) -> Vec<u8> {
    let all = [&["render", model, "-o", "out/x.png", "--mask", "out/m.png", "--fov", "20"], &VIEW[..], more].concat();
    place.umbrae(&all).success();
    image::open(place.out("m.png")).expect("a picture").to_luma8().into_raw()
}

fn differing(a: &[u8], b: &[u8]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

#[test]
fn a_ball_of_eighty_triangles_casts_the_shadow_of_a_round_one() {
    let place = Place::new();
    let coarse = place.file("coarse.obj", ball(1));
    let fine = place.file("fine.obj", ball(5));
    let round = mask(&place, &fine, &[]);
    let dark = round.iter().filter(|&&verdict| verdict == 0).count();
    assert!((8_000..32_000).contains(&dark), "{dark} of 40,000 pixels are dark");
    let flat = differing(&mask(&place, &coarse, &[]), &round);
    let smooth = differing(&mask(&place, &coarse, &["--smooth"]), &round);
    assert!(flat > 600, "{flat} pixels show the triangles");
    assert!(smooth * 10 < flat, "{smooth} pixels differ from the round shadow, {flat} without --smooth");
}

#[test]
fn an_outline_is_cut_finer_where_that_is_asked_for() {
    let place = Place::new();
    let coarse = place.file("coarse.obj", ball(1));
    let report = |more: &[&str]| -> Value {
        let all =
            [&["render", &coarse, "-o", "out/x.png", "--json", "out/x.json", "--smooth"], &VIEW[..], more].concat();
        place.umbrae(&all).success();
        serde_json::from_slice(&fs::read(place.out("x.json")).expect("it was written")).expect("JSON")
    };
    let edges = |report: &Value| -> u64 {
        let casters = report["lights"][0]["casters"].as_array().expect("a list");
        casters.iter().filter_map(|caster| caster["silhouette_edges"].as_u64()).sum()
    };
    let [coarse, fine] =
        ["0.1", "0.0005"].map(|epsilon_m| edges(&report(&["--epsilon-px", "100", "--epsilon", epsilon_m])));
    assert!(fine > 3 * coarse, "{fine} pieces and {coarse}");
    place
        .umbrae(&["render", "coarse.obj", "-o", "out/t.png", "--smooth", "--tessellate", "4", "--size", "64x64"])
        .success()
        .stderr(contains("triangles"));
}

#[test]
fn what_has_no_curves_is_drawn_as_ever() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let draw = |more: &[&str]| {
        let all = [&["render", &model, "-o", "out/x.png", "--size", "96x64"], more].concat();
        let run = place.umbrae(&all).success();
        (
            fs::read(place.out("x.png")).expect("it was written"),
            String::from_utf8_lossy(&run.get_output().stderr).into_owned(),
        )
    };
    let (plain, _) = draw(&[]);
    let (smooth, said) = draw(&["--smooth"]);
    assert_eq!(plain, smooth);
    assert!(said.contains("0 of 1 object cast smooth shadows"), "{said}");
}

#[test]
fn contours_are_three_lines_of_smooth_objects_alone() {
    let place = Place::new();
    let model = place.file("coarse.obj", ball(1));
    let all =
        ["render", &model, "-o", "out/x.png", "--size", "320x240", "--smooth", "--show", "contours", "--json", "-"];
    let run = place.umbrae(&all).success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    let legend = report["show"]["legend"].to_string();
    for said in ["of the triangles", "where normals turn away", "on the smooth surface"] {
        assert!(legend.contains(said), "{legend}");
    }
    place.refuses(&["render", &model, "-o", "out/x.png", "--show", "contours"], &["--smooth"]);
}

/// Nothing of such a ball faces the lamp, so it has no silhouette and no cap: there is nothing to draw.
#[test]
fn a_smooth_ball_with_eye_and_lamp_inside_is_lit_all_over() {
    let place = Place::new();
    let model = place.file("ball.obj", obj(&shapes::icosphere(Vec3::Z * 4.0, 1.0, 2)));
    let inside = ["--up", "z", "--point", "0.2,0.1,4.3", "--eye", "0,-0.6,4", "--target", "0,1,4", "--size", "60x40"];
    for more in [&[][..], &["--smooth"], &["--smooth", "--method", "zfail"], &["--smooth", "--light-radius", "0.1"]] {
        let all = [&["render", &model, "-o", "out/x.png", "--mask", "out/m.png"], &inside[..], more].concat();
        place.umbrae(&all).success();
        let mask = image::open(place.out("m.png")).expect("a picture").to_luma8().into_raw();
        assert!(mask.iter().all(|&verdict| verdict == 255), "{more:?}");
    }
}

/// What is shown is what casts, and not the outline of the triangles.
#[test]
fn volumes_and_silhouettes_that_are_shown_are_smooth_where_the_shadow_is() {
    let place = Place::new();
    let model = place.file("coarse.obj", ball(1));
    for (mode, words) in [("volumes", "sides of 2 volumes"), ("silhouettes", "pieces of curves")] {
        let pieces = ["0.1", "0.001"].map(|epsilon| {
            let all = ["render", &model, "-o", "out/x.png", "--size", "96x64", "--smooth", "--epsilon", epsilon];
            let run = place.umbrae(&[&all[..], &["--show", mode, "--json", "-", "-q"]].concat()).success();
            let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
            let legend = report["show"]["legend"].to_string();
            assert!(legend.contains(words), "{legend}");
            let before = legend[..legend.find(words).expect("it is there")].trim_end();
            before.rsplit([' ', '"']).next().and_then(|number| number.parse::<u32>().ok()).expect("a number")
        });
        assert!(pieces[1] > pieces[0] + 20, "{mode}: {pieces:?}");
    }
}

#[test]
fn options_that_can_not_be_are_refused() {
    let place = Place::new();
    let model = place.file("coarse.obj", ball(0));
    let refuses =
        |more: &[&str], words: &[&str]| place.refuses(&[&["render", &model, "-o", "out/x.png"], more].concat(), words);
    refuses(&["--smooth", "--epsilon", "0"], &["0", "metres"]);
    refuses(&["--smooth", "--epsilon", "-1"], &["-1", "metres"]);
    refuses(&["--smooth", "--epsilon-px", "nan"], &["nan", "0.01 to 100"]);
    refuses(&["--smooth", "--crease", "181"], &["181", "0 to 180"]);
    refuses(&["--smooth", "--tessellate", "1"], &["1", "2..=16"]);
    refuses(&["--crease", "30"], &["--smooth"]);
    refuses(&["--smooth", "--verify"], &["--smooth", "--verify"]);
    refuses(&["--smooth", "--posing", "gpu"], &["--posing gpu", "--smooth"]);
}

#[test]
fn frames_with_three_kinds_of_silhouettes_are_measured() {
    let place = Place::new();
    let model = place.file("coarse.obj", ball(2));
    let all = ["bench", "smooth", &model, "--json", "-q", "--frames", "1", "--size", "64x48", "--up", "z"];
    let run = place.umbrae(&all).success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    let kinds = report["kinds"].as_array().expect("a list");
    let names: Vec<&str> = kinds.iter().filter_map(|kind| kind["name"].as_str()).collect();
    assert_eq!(names, ["discrete", "accurate", "smooth"]);
    for kind in kinds {
        for key in ["frame_ms", "kept_ms", "pieces", "frame_ratio", "kept_ratio"] {
            assert!(kind[key].as_f64().is_some_and(|figure| figure > 0.0), "{key} of {kind}");
        }
    }
    let flat = place.file("box.obj", BOX);
    place.refuses(&["bench", "smooth", &flat], &["box.obj", "no smooth object"]);
    let posed = [&all[..], &["--time", "1"]].concat();
    place.umbrae(&posed[..]).success();
    place.refuses(&[&posed[..], &["--animation", "walk"]].concat(), &["no animation `walk`"]);
}
