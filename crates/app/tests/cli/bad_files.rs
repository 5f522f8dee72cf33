//! Files that can't be used: each is refused in one sentence that names the file, the place, the value and the way out.

use serde_json::json;

use crate::files::{BOX, Place, TRIANGLE, floats, glb, push, triangles_document};

/// Both commands that read models refuse `path` with `words`.
fn refuses(place: &Place, path: &str, words: &[&str]) {
    place.refuses(&["inspect", path], words);
    place.refuses(&["inspect", path, "--json"], words);
    let outputs = [&place.out("x.png"), &place.out("mask.png"), &place.out("x.json")];
    place.refuses(&["render", path, "-o", outputs[0], "--mask", outputs[1], "--json", outputs[2], "--verify"], words);
    place.refuses(&["render", path, "-o", outputs[0], "--json", "-"], words);
}

#[test]
fn what_is_no_file_is_refused() {
    let place = Place::new();
    refuses(&place, &place.path("nosuch.obj"), &["there is no file", "nosuch.obj"]);
    std::fs::create_dir(place.path("folder.obj")).expect("a folder");
    refuses(&place, &place.path("folder.obj"), &["folder.obj is not a file"]);
    let below_a_file = format!("{}/x.obj", place.file("box.obj", BOX));
    refuses(&place, &below_a_file, &["box.obj/x.obj"]);
}

/// A pipe may have no end, and no beginning.
#[cfg(unix)]
#[test]
fn a_pipe_is_refused_without_waiting_for_it() {
    let place = Place::new();
    let pipe = place.path("pipe.obj");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    refuses(&place, &pipe, &["pipe.obj is not a file"]);
}

#[test]
fn what_is_no_model_is_refused() {
    let place = Place::new();
    refuses(
        &place,
        &place.file("plan.dwg", "AC1032"),
        &["plan.dwg", ".glb, .gltf, .obj, .ply, .ply.gz, .stl, .city.json"],
    );
    refuses(&place, &place.file("plan", "AC1032"), &["its ending must be one of"]);
    refuses(&place, &place.file("wrong.glb", "glTX\x02\0\0\0"), &["wrong.glb"]);
    refuses(&place, &place.file("picture.glb", b"\x89PNG\r\n\x1a\n"), &["picture.glb", "a picture under another name"]);
    refuses(&place, &place.file("zip.stl", b"PK\x03\x04...."), &["a zip archive under another name"]);
    refuses(&place, &place.file("glb.obj", glb(&json!({}), &[])), &["a .glb file under another name"]);
    refuses(&place, &place.file("noise.ply", [0xAB; 300]), &["noise.ply"]);
    refuses(&place, &place.file("noise.gltf", "[".repeat(100_000)), &["noise.gltf", "line 1", "JSON"]);
}

#[test]
fn a_file_that_was_cut_off_is_refused_wherever_it_was_cut() {
    let place = Place::new();
    let whole = glb(&triangles_document(&[0]), &floats(&TRIANGLE));
    for length in [0, 3, 4, 11, 12, 19, 20, 200, whole.len() - 37, whole.len() - 1] {
        refuses(&place, &place.file("cut.glb", &whole[..length]), &["cut.glb"]);
    }
    let stl = [&[b'x'; 80][..], &2_u32.to_le_bytes(), &[0; 50]].concat();
    refuses(&place, &place.file("cut.stl", stl), &["cut.stl", "2 facets", "50 bytes follow"]);
}

#[test]
fn an_index_out_of_range_is_named() {
    let place = Place::new();
    let mut document = triangles_document(&[0]);
    document["meshes"][0]["primitives"][0]["indices"] = 1.into();
    push(&mut document["accessors"], json!({ "bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR" }));
    push(&mut document["bufferViews"], json!({ "buffer": 0, "byteOffset": 36, "byteLength": 12 }));
    document["buffers"][0]["byteLength"] = 48.into();
    let binary = [floats(&TRIANGLE), [0_u32, 1, 7].map(u32::to_le_bytes).concat()].concat();
    refuses(
        &place,
        &place.file("index.glb", glb(&document, &binary)),
        &["mesh 0 \"mesh 0\"", "is vertex 7, but there are 3"],
    );
    refuses(&place, &place.file("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), &["index.obj", "line 4"]);
}

#[test]
fn coordinates_that_are_no_numbers_are_named() {
    let place = Place::new();
    for bad in ["nan", "inf", "-inf", "1e39", "1e300", "1e999"] {
        let obj = format!("v 0 0 0\nv 1 {bad} 0\nv 0 1 0\nf 1 2 3\n");
        refuses(&place, &place.file("bad.obj", obj), &["bad.obj: line 2", bad]);
    }
    for (bad, name) in
        [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf"), (2e18, "2000000000000000000")]
    {
        let mut corners = TRIANGLE;
        corners[4] = bad;
        let path = place.file("bad.glb", glb(&triangles_document(&[0]), &floats(&corners)));
        refuses(&place, &path, &["mesh 0 \"mesh 0\": vertex 1 is at (", name, "must be finite and below 1e18"]);
    }
}

#[test]
fn a_cycle_of_nodes_is_named() {
    let place = Place::new();
    let mut document = triangles_document(&[0]);
    document["nodes"] = json!([{ "mesh": 0, "children": [1] }, { "children": [0] }]);
    let path = place.file("cycle.glb", glb(&document, &floats(&TRIANGLE)));
    refuses(&place, &path, &["cycle.glb: node 1", "without cycles"]);
}

#[test]
fn a_missing_buffer_is_named() {
    let place = Place::new();
    let mut document = triangles_document(&[0]);
    document["buffers"][0]["uri"] = "walls.bin".into();
    let path = place.file("house.gltf", document.to_string());
    refuses(&place, &path, &["house.gltf: mesh 0", "walls.bin", "put it beside the model"]);
}

#[test]
fn a_file_without_a_triangle_is_refused() {
    let place = Place::new();
    for name in ["empty.obj", "empty.ply", "empty.ply.gz", "empty.stl", "empty.glb", "empty.gltf"] {
        refuses(&place, &place.file(name, ""), &[name, "empty (0 bytes)"]);
    }
    refuses(&place, &place.file("points.obj", "v 0 0 0\nv 1 0 0\n"), &["no usable face in it; vertices: 2"]);
    refuses(&place, &place.file("none.gltf", r#"{"asset":{"version":"2.0"}}"#), &["there is no mesh in it"]);
    let same_corners = "v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\nf 2 3 1\n";
    refuses(
        &place,
        &place.file("points.obj", same_corners),
        &["no triangle is left (2 read, 2 of them with two equal corners)"],
    );
}

/// Bug: such a model was drawn as an empty ground. `inspect` still shows it, so that one can see what is wrong.
#[test]
fn a_model_of_lines_is_not_drawn() {
    let place = Place::new();
    let path = place.file("lines.obj", "v 0 0 0\nv 1 0 0\nv 3 0 0\nv 0 5 5\nv 0 6 6\nv 0 7 7\nf 1 2 3\nf 4 5 6\n");
    let words = ["can't draw", "lines.obj", "every triangle of the model is a line or a point"];
    place.refuses(&["render", &path, "-o", &place.out("x.png")], &words);
    place.umbrae(&["inspect", &path]).success();
}

/// Bug: above about 8e16 m, the ground's corners were beyond what a mesh may hold, and the program panicked; below `f32`'s normal
/// numbers, every pixel was wrong.
#[test]
fn a_model_too_large_for_its_ground_or_too_small_for_f32_is_refused() {
    let place = Place::new();
    let scaled = |factor: f64| {
        let line = |line: &str| match line.strip_prefix("v ") {
            Some(v) => format!("v {}\n", v.split(' ').map(|c| format!("{c}e{factor} ")).collect::<String>()),
            None => format!("{line}\n"),
        };
        BOX.lines().map(line).collect::<String>()
    };
    let large = place.file("large.obj", scaled(17.0));
    let args = ["render", &large, "-o", &place.out("x.png"), "--size", "40x30"];
    place.refuses(&args, &["large.obj", "too large for a ground plane", "--no-ground"]);
    place.umbrae(&[&args[..], &["--no-ground", "--verify"]].concat()).success();
    let small = place.file("small.obj", scaled(-40.0));
    place.refuses(&["render", &small, "-o", &place.out("y.png")], &["small.obj", "too small to draw; scale it up"]);
}

/// Names in a file may hold anything; a terminal must not obey it.
#[test]
fn a_name_in_a_file_can_not_command_the_terminal() {
    let place = Place::new();
    let mut document = triangles_document(&[0, 0]);
    for node in 0..2 {
        document["nodes"][node]["name"] = "a\u{1b}[31m\nb\u{7}".into();
    }
    push(&mut document["nodes"], json!({ "camera": 0, "name": "c\u{1b}]0;d\n" }));
    document["scenes"][0]["nodes"] = json!([0, 1, 2]);
    document["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } }]);
    let path = place.file("names.glb", glb(&document, &floats(&[TRIANGLE, TRIANGLE].concat())));
    let shown = place.umbrae(&["inspect", &path]).success().get_output().stdout.clone();
    let shown = String::from_utf8(shown).expect("text");
    assert!(shown.contains("a\\u{1b}[31m\\nb\\u{7}") && shown.contains("c\\u{1b}]0;d\\n"), "{shown}");
    assert!(!shown.contains(|c: char| c.is_control() && c != '\n'), "{shown}");
    place.refuses(
        &["render", &path, "-o", &place.out("x.png"), "--camera", "e"],
        &["no camera `e`", "`c\\u{1b}]0;d\\n`"],
    );
}
