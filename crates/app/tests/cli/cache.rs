//! What silhouettes are found with is kept for the next time, and what is kept is never trusted blindly.

use std::fs;
use std::path::PathBuf;

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;

use crate::files::{BOX, Place, box_at};

const FOLDER: &str = "kept/by us";

/// What is in the cache, in order.
fn kept(place: &Place) -> Vec<PathBuf> {
    let entries = fs::read_dir(place.path(FOLDER)).expect("a folder");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files
}

/// Draws `model` with a cache, and returns its picture and what is said.
fn drawn(place: &Place, model: &str, options: &[&str]) -> (Vec<u8>, String) {
    let (picture, folder) = (place.out("x.png"), place.path(FOLDER));
    let args = ["render", model, "-o", &picture, "--size", "64x48", "--sun", "238,40", "--cache", &folder];
    let run = place.umbrae(&[&args[..], options].concat()).success();
    let said = String::from_utf8(run.get_output().stderr.clone()).expect("what is said is text");
    (fs::read(&picture).expect("a picture"), said)
}

#[test]
fn a_picture_is_the_same_with_what_was_kept_and_nothing_is_said_of_it() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let (first, said) = drawn(&place, &model, &[]);
    assert!(!said.contains("cache"), "{said}");
    // The box and the ground under it.
    let files = kept(&place);
    assert_eq!(files.len(), 2);
    let contents: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).expect("it is there")).collect();
    let (second, said) = drawn(&place, &model, &[]);
    assert!(first == second && !said.contains("cache"), "{said}");
    assert_eq!(kept(&place), files);
    assert!(files.iter().zip(contents).all(|(file, content)| fs::read(file).expect("it is there") == content));
    // Another way of finding, and another model, have files of their own.
    drawn(&place, &model, &["--silhouette", "cones"]);
    assert_eq!(kept(&place).len(), 4);
    let elsewhere = place.file("elsewhere.obj", box_at([3.0, 0.0, 0.0]));
    drawn(&place, &elsewhere, &["--no-ground"]);
    assert_eq!(kept(&place).len(), 5);
    // What is found on the GPU needs none.
    drawn(&place, &elsewhere, &["--silhouette", "gpu"]);
    assert_eq!(kept(&place).len(), 5);
}

#[test]
fn what_is_damaged_cut_off_or_of_another_version_is_made_anew_and_that_is_said() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let (picture, _) = drawn(&place, &model, &["--no-ground"]);
    let [file] = kept(&place).try_into().expect("one box");
    let good = fs::read(&file).expect("it is there");
    let version = b"umbrae finder\n".len();
    let flipped = |place: usize| {
        let mut bytes = good.clone();
        bytes[place] ^= 0x10;
        bytes
    };
    let cases = [
        (Vec::new(), "it holds no finder"),
        (flipped(0), "it holds no finder"),
        (flipped(version), "it is of version"),
        (flipped(good.len() / 2), "it is damaged"),
        (flipped(good.len() - 1), "it is damaged"),
        (good[..good.len() / 3].to_vec(), "it is damaged"),
        ([&good[..], b"more"].concat(), "it is damaged"),
    ];
    for (bytes, reason) in cases {
        fs::write(&file, &bytes).expect("the folder can be written");
        let (again, said) = drawn(&place, &model, &["--no-ground"]);
        assert!(said.contains(reason) && said.contains("it is made anew"), "not {reason:?} but\n{said}");
        assert!(again == picture, "{reason}");
        assert!(fs::read(&file).expect("it is there") == good, "{reason}");
        assert_eq!(kept(&place), std::slice::from_ref(&file), "no temporary file stays");
    }
}

#[test]
fn the_bench_keeps_one_of_each_and_says_that_reading_takes_the_time() {
    let place = Place::new();
    let (model, folder) = (place.file("box.obj", BOX), place.path(FOLDER));
    for _ in 0..2 {
        let args = ["bench", "silhouettes", &model, "--lights", "2", "--cache", &folder];
        place
            .umbrae(&args)
            .success()
            .stdout(contains("\ncones ").and(contains(" NO").not()))
            .stderr(contains("made anew").not());
        assert_eq!(kept(&place).len(), 5);
    }
    place.umbrae(&["bench", "silhouettes", "--help"]).success().stdout(contains("what reading it takes"));
}

#[test]
fn a_file_is_no_cache() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    place.refuses(&["render", &model, "-o", &place.out("x.png"), "--cache", &model], &["box.obj", "folder"]);
    place.refuses(&["bench", "silhouettes", &model, "--cache", &model], &["box.obj", "folder"]);
}
