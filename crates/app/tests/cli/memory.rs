//! Small files that claim to be large cost no memory: the program reads them under a limit of the operating system.

#![cfg(target_os = "linux")]

use std::process::Command;

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::json;

use crate::files::{Place, TRIANGLE, assert_one_sentence, floats, glb, program, push, triangles_document};

/// Address space that `inspect` may take, its own code and the stacks of its threads included.
const LIMIT_KIB: u32 = 150_000;
const CLAIMED: u32 = 1_000_000_000;

fn inspect_within_the_limit(path: &str) -> (Option<i32>, String) {
    let run = Command::new("sh")
        .args(["-c", &format!("ulimit -v {LIMIT_KIB} && exec \"$0\" inspect \"$1\"")])
        .arg(program())
        .arg(path)
        .output()
        .expect("there is a shell");
    (run.status.code(), String::from_utf8_lossy(&run.stderr).into_owned())
}

fn claims() -> Vec<(&'static str, Vec<u8>)> {
    let accessor = |of_what: &str| match of_what {
        "vertices in a view" => json!({ "bufferView": 0, "componentType": 5126, "count": CLAIMED, "type": "VEC3" }),
        "indices" => json!({ "componentType": 5125, "count": CLAIMED, "type": "SCALAR" }),
        _ => json!({ "componentType": 5126, "count": CLAIMED, "type": "VEC3" }),
    };
    let with = |of_what: &str| {
        let mut document = triangles_document(&[0]);
        match of_what {
            "indices" => {
                push(&mut document["accessors"], accessor(of_what));
                document["meshes"][0]["primitives"][0]["indices"] = 1.into();
            }
            "instances" => {
                push(&mut document["accessors"], accessor(of_what));
                document["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
                document["nodes"][0]["extensions"] =
                    json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 1 } } });
            }
            _ => document["accessors"][0] = accessor(of_what),
        }
        glb(&document, &floats(&TRIANGLE))
    };
    let ply = |vertices: u32, faces: u32, format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {faces}\nproperty list uint int vertex_indices\nend_header\n"
        )
        .into_bytes()
    };
    let binary = "binary_little_endian";
    let mut zipped = GzEncoder::new(Vec::new(), Compression::best());
    std::io::Write::write_all(&mut zipped, &[ply(CLAIMED, 1, binary), vec![0; 200_000_000]].concat()).expect("memory");
    vec![
        ("view.glb", with("vertices in a view")),
        ("zeros.glb", with("vertices without a view")),
        ("indices.glb", with("indices")),
        ("instances.glb", with("instances")),
        ("vertices.ply", [ply(CLAIMED, 1, binary), vec![0; 100]].concat()),
        ("faces.ply", [ply(3, CLAIMED, binary), floats(&TRIANGLE), vec![0; 100]].concat()),
        ("list.ply", [ply(3, 1, binary), floats(&TRIANGLE), vec![0xFF; 16]].concat()),
        ("text.ply", [ply(CLAIMED, CLAIMED, "ascii"), b"0 0 0\n1 0 0\n".to_vec()].concat()),
        ("bomb.ply.gz", zipped.finish().expect("memory")),
        ("facets.stl", [vec![b'x'; 80], CLAIMED.to_le_bytes().to_vec(), vec![0; 216]].concat()),
        ("index.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {CLAIMED}\nf -1 -2 -{CLAIMED}\n").into_bytes()),
    ]
}

#[test]
fn a_billion_claimed_vertices_cost_no_memory() {
    let place = Place::new();
    for (name, bytes) in claims() {
        assert!(bytes.len() < 1000 || name == "bomb.ply.gz", "{name} is {} bytes", bytes.len());
        let path = place.file(name, bytes);
        place.refuses(&["inspect", &path], &[name]);
        let (code, said) = inspect_within_the_limit(&path);
        assert_eq!(code, Some(2), "{name} within {LIMIT_KIB} KiB: {said}");
        assert_one_sentence(&[name], &said, &[name]);
    }
}

#[test]
fn the_limit_is_enough_for_a_good_file_and_too_little_for_a_large_one() {
    let place = Place::new();
    let good = place.file("good.glb", glb(&triangles_document(&[0]), &floats(&TRIANGLE)));
    assert_eq!(inspect_within_the_limit(&good).0, Some(0));
    let large = place.file("large.ply", vec![b' '; LIMIT_KIB as usize * 1024]);
    assert_ne!(inspect_within_the_limit(&large).0, Some(0), "the limit does not limit");
}
