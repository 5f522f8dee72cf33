//! How fast parts of the program are, on models of one's own: the figures are the machine's, but their form and what they are about is not.

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::Value;

use crate::files::{BOX, Place};

const CPU: [&str; 5] = ["plain", "scan", "dual", "cones", "coherent"];
const FINDER_KEYS: [&str; 8] =
    ["build_ms", "bytes", "edges_found", "edges_tested", "equal", "median_us", "name", "p95_us"];

fn keys(object: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = object.as_object().expect("an object").keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

fn measured(place: &Place, args: &[&str]) -> Value {
    let run = place.umbrae(&[&["bench", "silhouettes", "--json", "-q"], args].concat()).success().stderr("");
    serde_json::from_slice(&run.get_output().stdout).expect("JSON")
}

fn finders(model: &Value) -> &Vec<Value> {
    model["finders"].as_array().expect("a list")
}

#[test]
fn every_finder_is_measured_and_finds_what_the_scan_finds() {
    let place = Place::new();
    let tower = place.path("tower.glb");
    place.umbrae(&["sample", "lattice-tower", "-o", &tower]).success();
    let model = measured(&place, &[&tower, "--lights", "10"]);
    assert_eq!(keys(&model), ["edges", "finders", "model", "triangles"]);
    assert_eq!(model["model"], tower);
    assert_eq!(model["triangles"], 11_512);
    let names: Vec<&str> = finders(&model).iter().filter_map(|finder| finder["name"].as_str()).collect();
    assert_eq!(names[..CPU.len()], CPU);
    assert!(names[CPU.len()..].iter().all(|name| ["gpu", "gpu-basic"].contains(name)), "{names:?}");
    let found_by_plain = &finders(&model)[0]["edges_found"];
    for finder in finders(&model) {
        assert_eq!(keys(finder), FINDER_KEYS);
        assert_eq!(finder["equal"], true, "{finder}");
        for key in ["build_ms", "bytes", "median_us", "p95_us", "edges_tested", "edges_found"] {
            assert!(finder[key].as_f64().is_some_and(|figure| figure > 0.0), "{key} of {finder}");
        }
        assert!(finder["median_us"].as_f64() <= finder["p95_us"].as_f64(), "{finder}");
        let is_on_cpu = finder["name"].as_str().is_some_and(|name| CPU.contains(&name));
        assert!(!is_on_cpu || &finder["edges_found"] == found_by_plain, "{finder}");
    }
}

#[test]
fn one_model_is_an_object_and_several_are_a_list_in_their_order() {
    let place = Place::new();
    let models = [place.file("a.obj", BOX), place.file("b.obj", BOX)];
    let one = measured(&place, &[&models[0], "--lights", "5"]);
    assert_eq!((&one["triangles"], &one["edges"]), (&12.into(), &18.into()));
    let several = measured(&place, &[&models[0], &models[1], "--lights", "5"]);
    let several = several.as_array().expect("a list");
    assert_eq!(
        several.iter().map(|model| model["model"].as_str()).collect::<Vec<_>>(),
        models.each_ref().map(|m| Some(m.as_str()))
    );
    // A box has twelve edges between different faces, and a loop looks at each.
    for model in several.iter().chain([&one]) {
        assert_eq!(finders(model)[0]["edges_tested"], 12.0);
    }
}

#[test]
fn the_table_says_for_whoever_reads_it_how_coherent_was_measured_and_what_memory_it_took() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let table = contains("12 triangles, 18 edges (12 between different faces), 7 lights")
        .and(contains("\ncoherent, by minutes "))
        .and(contains("sun in 951 steps of one minute"));
    let run = place.umbrae(&["bench", "silhouettes", &model, "--lights", "7"]).success().stdout(table);
    if cfg!(target_os = "linux") {
        run.stdout(contains("peak memory so far: "));
    }
}

#[test]
fn without_a_driver_the_gpu_is_left_out_and_that_is_said() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let mut command = place.command(&["bench", "silhouettes", "--json", &model, "--lights", "3"]);
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "LIBGL_DRIVERS_PATH", "__EGL_VENDOR_LIBRARY_FILENAMES"] {
        command.env(name, "/nonexistent");
    }
    if cfg!(target_os = "linux") {
        let run = command.assert().success().stderr(contains("gpu and gpu-basic are left out: "));
        let model: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
        assert_eq!(finders(&model).iter().map(|finder| finder["name"].as_str()).collect::<Vec<_>>(), CPU.map(Some));
    } else {
        println!("skipped: only on Linux can the drivers be hidden");
    }
}

#[test]
fn a_model_that_can_not_be_read_is_one_sentence_and_nothing_is_printed() {
    let place = Place::new();
    let good = place.file("box.obj", BOX);
    let bad = place.file("bad.obj", "v 0 0 0\nf 1 2 3\n");
    place.refuses(&["bench", "silhouettes", "nosuch.obj"], &["nosuch.obj"]);
    place.refuses(&["bench", "silhouettes", &good, &bad, "--lights", "1"], &["bad.obj"]);
    place.refuses(&["bench", "silhouettes"], &["MODEL"]);
}

#[test]
fn no_lights_are_nothing_to_measure() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    for count in ["0", "-1", "many", "100001"] {
        place.refuses(&["bench", "silhouettes", &model, "--lights", count], &["--lights", count]);
    }
}

#[test]
fn only_one_model_and_none_too_large_is_made_finer_and_never_overwritten() {
    let place = Place::new();
    let (model, large) = (place.file("box.obj", BOX), place.path("large.glb"));
    let plot = place.out("growth.svg");
    place.umbrae(&["sample", "high-rise", "-o", &large]).success();
    let refuses = |args: &[&str], words: &[&str]| place.refuses(&[&["bench", "silhouettes"], args].concat(), words);
    refuses(&[&model, &model, "--grow", &plot], &["--grow makes one model finer", "2 are given"]);
    refuses(&[&large, "--grow", &plot], &["large.glb", "181596 triangles", "at most 100000"]);
    refuses(&[&model, "--grow", &model], &["--grow would overwrite the model"]);
    refuses(&[&model, "--grow", &place.path("no/growth.svg")], &["there is no folder"]);
    refuses(&[&model, "--grow", &plot, "--json"], &["--grow", "--json"]);
}
