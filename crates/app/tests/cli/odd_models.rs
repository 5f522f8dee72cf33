//! Models that are odd and good: far away, several, partly broken, oddly named.

use std::fs;

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;

use crate::files::{BOX, Place, TRIANGLE, box_at, floats, glb, triangles_document};

const SIZE: [&str; 2] = ["--size", "160x120"];

/// The bytes of an 8-bit grey PNG.
fn grey(path: &str) -> Vec<u8> {
    match image::open(path).expect("a picture") {
        image::DynamicImage::ImageLuma8(picture) => picture.into_raw(),
        other => panic!("{path} is {:?}", other.color()),
    }
}

/// Renders, verified, and returns the mask.
fn mask(place: &Place, models: &[&str], options: &[&str]) -> Vec<u8> {
    let [picture, mask] = [place.out("x.png"), place.out("mask.png")];
    let outputs = ["-o", &picture, "--mask", &mask, "--verify"];
    place.umbrae(&[&["render"], models, &outputs, &SIZE, options].concat()).success();
    grey(&mask)
}

fn different(a: &[u8], b: &[u8]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

#[test]
fn a_model_far_from_zero_has_the_shadows_that_it_has_at_zero() {
    let place = Place::new();
    let near = place.file("near.obj", BOX);
    let at_zero = mask(&place, &[&near], &["--eye", "7,-8,5", "--target", "0.3,0.2,1", "--sun", "238,40"]);
    assert!([0, 128, 255].iter().all(|verdict| at_zero.iter().filter(|v| *v == verdict).count() > 500), "a dull view");
    // The file's y is up, so its z is south.
    let far = place.file("far.obj", box_at([2.5e7, 1.0e5, 4.0e6]));
    let view = ["--eye", "25000007,-4000008,100005", "--target", "25000000.3,-3999999.8,100001", "--sun", "238,40"];
    let differences = different(&at_zero, &mask(&place, &[&far], &view));
    assert!(differences <= 8, "{differences} pixels differ by more than rounding");
    let by_default = different(&mask(&place, &[&near], &[]), &mask(&place, &[&far], &[]));
    assert!(by_default <= 8, "{by_default} pixels differ in the default view");
}

#[test]
fn models_with_origins_of_their_own_stand_where_they_stand_in_one_file() {
    let place = Place::new();
    let offsets = [[2.5e7, 0.0, 0.0], [2.5e7 + 4.0, 0.0, -3.0]];
    let [a, b] = [0, 1].map(|i| place.file(&format!("{i}.obj"), box_at(offsets[i])));
    // Faces count their vertices from the end, so that they can follow each other.
    let relative = |obj: String| {
        let line = |line: &str| match line.strip_prefix("f ") {
            Some(face) => {
                let corners = face.split(' ').map(|c| (c.parse::<i32>().expect("a number") - 9).to_string());
                format!("f {}\n", corners.collect::<Vec<_>>().join(" "))
            }
            None => format!("{line}\n"),
        };
        obj.lines().map(line).collect::<String>()
    };
    let both = place.file("both.obj", offsets.map(|offset| relative(box_at(offset))).concat());
    let view = ["--eye", "25000009,-9,6", "--target", "25000002,1,1", "--sun", "238,40"];
    let apart = mask(&place, &[&a, &b], &view);
    let differences = different(&apart, &mask(&place, &[&both], &view));
    assert!(differences <= 8, "{differences} pixels differ by more than rounding");
    assert!(different(&apart, &mask(&place, &[&a], &view)) > 500, "the second model is not seen");
}

#[test]
fn formats_with_different_axes_stand_in_one_picture() {
    let place = Place::new();
    let y_up = place.file("a.obj", BOX);
    let z_up = place.file("b.obj", "v 2 -1 0\nv 4 -1 0\nv 3 1 0\nv 3 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    let glb = place.file("c.glb", glb(&triangles_document(&[0]), &floats(&TRIANGLE)));
    mask(&place, &[&y_up, &glb], &[]);
    mask(&place, &[&y_up, &z_up], &["--up", "z"]);
    place
        .umbrae(&["render", &y_up, &glb, "--up", "z", "-o", &place.out("x.png"), "--size", "40x30"])
        .success()
        .stderr(contains("warning: `").and(contains("c.glb")));
}

#[test]
fn a_file_with_some_good_meshes_is_drawn_with_a_warning() {
    let place = Place::new();
    let mut broken = TRIANGLE;
    broken[4] = f32::NAN;
    let document = triangles_document(&[0, 36]);
    let path = place.file("some.glb", glb(&document, &floats(&[broken, TRIANGLE].concat())));
    let warning =
        contains("some.glb`: ").and(contains("skipped")).and(contains("mesh 0 \"mesh 0\": vertex 1 is at (1, NaN, 0)"));
    let args = ["render", &path, "-o", &place.out("x.png"), "--size", "40x30", "--verify"];
    place.umbrae(&args).success().stderr(contains("warning: ").and(warning).and(contains("3 triangles in 2 objects")));
    let shown = place.umbrae(&["inspect", &path, "--json"]).success().stderr("").get_output().stdout.clone();
    let shown: serde_json::Value = serde_json::from_slice(&shown).expect("JSON");
    assert_eq!((shown["triangles"].as_u64(), shown["objects"].as_array().map(Vec::len)), (Some(1), Some(1)));
    assert!(shown["warnings"][0].as_str().is_some_and(|warning| warning.contains("skipped")), "{shown}");

    let path = place.file("some.obj", format!("{BOX}f 1 2 99\n"));
    let args = ["render", &path, "-o", &place.out("y.png"), "--size", "40x30", "--verify"];
    place.umbrae(&args).success().stderr(contains("1 triangle was skipped").and(contains("line 15")));
}

#[test]
fn paths_may_have_spaces_and_any_letters() {
    let place = Place::new();
    fs::create_dir(place.path("Größe ❤ und mehr")).expect("a folder");
    let model = place.file("Größe ❤ und mehr/mo del 'x'.OBJ", BOX);
    let picture = place.out("bild ö -.png");
    place.umbrae(&["render", &model, "-o", &picture, "--size", "40x30"]).success().stderr(contains("bild ö -.png"));
    place.umbrae(&["inspect", &model]).success().stdout(contains("Größe ❤ und mehr/mo del 'x'.OBJ: obj, y up"));
    place.refuses(&["inspect", "Größe ❤ und mehr/fehlt.obj"], &["Größe ❤ und mehr/fehlt.obj"]);
    let dashed = place.file("-v.obj", BOX);
    assert!(dashed.ends_with("/-v.obj"));
    place.umbrae(&["inspect", "--", "-v.obj"]).success();
}

#[cfg(target_os = "linux")]
#[test]
fn paths_need_not_be_utf_8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;

    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let odd = std::path::Path::new(&place.path("")).join(OsStr::from_bytes(b"od\xFFd.obj"));
    fs::rename(&model, &odd).expect("the folder can be written");
    let picture = std::path::Path::new(&place.path("out")).join(OsStr::from_bytes(b"od\xFFd.png"));
    let mut command = place.std_command(&["render", "--size", "40x30", "--json", "-", "-o"]);
    let run = command.arg(&picture).arg(&odd).output().expect("it starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(picture.is_file() && serde_json::from_slice::<serde_json::Value>(&run.stdout).is_ok());
}

/// The reader of a hostile or generated file may meet any size between these.
#[test]
fn tiny_and_huge_models_are_right_too() {
    let place = Place::new();
    for exponent in [-15, -6, 6, 15] {
        let line = |line: &str| match line.strip_prefix("v ") {
            Some(v) => format!("v {}\n", v.split(' ').map(|c| format!("{c}e{exponent} ")).collect::<String>()),
            None => format!("{line}\n"),
        };
        let model = place.file("box.obj", BOX.lines().map(line).collect::<String>());
        let seen = mask(&place, &[&model], &[]);
        assert!(seen.contains(&255) && seen.contains(&0), "1e{exponent}");
    }
}

#[test]
fn the_smallest_and_the_narrowest_pictures_are_pictures() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    for (size, pixels) in [("1x1", (1, 1)), ("1x300", (1, 300)), ("2000x1", (2000, 1))] {
        let [picture, mask] = [place.out("x.png"), place.out("mask.png")];
        place.umbrae(&["render", &model, "-o", &picture, "--mask", &mask, "--verify", "--size", size]).success();
        assert_eq!(image::image_dimensions(&picture).expect("a picture"), pixels);
        assert_eq!(image::image_dimensions(&mask).expect("a mask"), pixels);
    }
}

#[test]
fn the_mask_is_eight_bit_grey_with_three_values_and_the_picture_s_size() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    for samples in ["1", "4"] {
        let seen = mask(&place, &[&model], &["--samples", samples, "--eye", "7,-8,5", "--target", "0,0,1"]);
        assert_eq!(seen.len(), 160 * 120);
        let mut values = seen;
        values.sort_unstable();
        values.dedup();
        assert_eq!(values, [0, 128, 255]);
        assert_eq!(image::image_dimensions(place.out("x.png")).expect("a picture"), (160, 120));
    }
}
