//! However a file is made, reading it takes no more memory than a multiple of its size.
//!
//! Each file is read in a process of its own, whose peak Linux tells; other systems are not asked.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Write;
use std::process::Command;

use flate2::Compression;
use flate2::write::GzEncoder;
use umbrae_formats::{Format, LoadOptions, load_bytes};

/// Bytes of memory for each byte of a file, for the worst of them: empty nodes and empty vertices, of which one
/// takes two or three bytes of text. Ordinary files take 5 to 20.
const MAX_MULTIPLE: usize = 160;

/// What a reader may take for any file, however small.
const FREE_BYTES: usize = 24 << 20;

/// What it may take on top for pictures: the largest one, as stored and as kept.
const PICTURE_BYTES: usize = 8192 * 8192 * 12;

/// What it may take on top for that many samples of terrain; ten times as many can be read.
const TERRAIN_BYTES: usize = 1_000_000 * 200;

/// Set for a process that is to read one file: its number.
const CASE: &str = "UMBRAE_MEMORY_CASE";

/// A field of what Linux says about this process, in bytes.
fn status(name: &str) -> usize {
    let status = fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find(|line| line.starts_with(name)).expect("it has this line");
    let kilobytes = line.split_whitespace().nth(1).and_then(|number| number.parse::<usize>().ok());
    kilobytes.expect("it is a number") * 1024
}

/// The most memory that reading takes, above what was there before.
fn peak_bytes(bytes: &[u8], format: Format) -> usize {
    // Forgets the peak so far. Where that is not allowed, what making the file took counts too.
    let _ = fs::write("/proc/self/clear_refs", "5");
    let before = status("VmRSS:");
    let _ = load_bytes(bytes, format, "hostile", None, &LoadOptions { normals: true, ..LoadOptions::default() });
    status("VmHWM:").saturating_sub(before)
}

fn gltf(parts: &str) -> Vec<u8> {
    format!(r#"{{"asset":{{"version":"2.0"}},{parts}}}"#).into_bytes()
}

/// A thousand triangles that `nodes` show, and a thousand places.
fn thousand(nodes: &str) -> Vec<u8> {
    let data = "%00%00%00@%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00@%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00@"
        .repeat(1000);
    gltf(&format!(
        r#""nodes":[{nodes}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3000}}],
        "bufferViews":[{{"buffer":0,"byteLength":36000}}],"buffers":[{{"byteLength":36000,"uri":"data:,{data}"}}]"#
    ))
}

/// `item` over and over, with commas between.
fn list(item: &str, count: usize) -> String {
    let mut list = format!("{item},").repeat(count);
    list.pop();
    list
}

fn zipped_spaces(count: usize) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    for _ in 0..count / 1024 {
        encoder.write_all(&[b' '; 1024]).expect("memory takes it");
    }
    encoder.finish().expect("memory takes it")
}

/// Black pictures of `side` texels a side, which take next to nothing in a file.
fn pictures(side: u32, count: usize) -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(side, side).write_to(&mut png, image::ImageFormat::Png).expect("memory takes it");
    let escaped: String = png.into_inner().iter().map(|byte| format!("%{byte:02x}")).collect();
    let list = |item: &dyn Fn(usize) -> String| (0..count).map(item).collect::<Vec<_>>().join(",");
    gltf(&format!(
        r#""buffers":[{{"byteLength":1,"uri":"data:,{escaped}"}}],"bufferViews":[{{"buffer":0,"byteLength":{}}}],
        "images":[{}],"textures":[{}],"materials":[{}]"#,
        escaped.len() / 3,
        list(&|_| r#"{"bufferView":0}"#.to_owned()),
        list(&|i| format!(r#"{{"source":{i}}}"#)),
        list(&|i| format!(r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":{i}}}}}}}"#)),
    ))
}

fn obj(head: &str, line: &str, count: usize) -> Vec<u8> {
    [head.as_bytes(), line.repeat(count).as_bytes()].concat()
}

/// A flat square of `side` samples a side, compressed to next to nothing.
fn terrain(side: u32) -> Vec<u8> {
    use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, colortype::Gray8};
    use tiff::tags::Tag;

    let mut bytes = std::io::Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut bytes).expect("memory takes it");
    let mut encoder = encoder.with_compression(Compression::Deflate(DeflateLevel::Best));
    let mut image = encoder.new_image::<Gray8>(side, side).expect("a good size");
    image.encoder().write_tag(Tag::ModelPixelScaleTag, [1.0, 1.0, 0.0_f64].as_slice()).expect("memory takes it");
    image.encoder().write_tag(Tag::ModelTiepointTag, [0.0_f64; 6].as_slice()).expect("memory takes it");
    image.write_data(&vec![1; (side * side) as usize]).expect("memory takes it");
    bytes.into_inner()
}

fn city(parts: &str) -> Vec<u8> {
    format!(r#"{{"type":"CityJSON","version":"2.0",{parts}}}"#).into_bytes()
}

/// One city object with these surfaces.
fn surfaces(list: &str) -> Vec<u8> {
    city(&format!(
        r#""vertices":[[0,0,0],[1,0,0],[0,1,0]],"CityObjects":{{"":{{"type":"","geometry":[{{"type":"MultiSurface","boundaries":[{list}]}}]}}}}"#
    ))
}

fn features(list: &str) -> Vec<u8> {
    format!(r#"{{"type":"FeatureCollection","features":[{list}]}}"#).into_bytes()
}

const THREE: &str = "v 1 2 3\nv 2 3 4\nv 1 1 1\n";

/// A name, a format and how to make the bytes.
type Case = (&'static str, Format, fn() -> Vec<u8>);

const CASES: [Case; 36] = [
    ("a million samples of terrain", Format::GeoTiff, || terrain(1000)),
    ("vertices of a city", Format::CityJson, || city(&format!(r#""vertices":[{}]"#, list("[0,0,0]", 400_000)))),
    ("city objects of nothing", Format::CityJson, || {
        let objects: String = (0..100_000).map(|i| format!(r#""{i}":{{"type":""}},"#)).collect();
        city(&format!(r#""CityObjects":{{{}}}"#, objects.trim_end_matches(',')))
    }),
    ("city objects of one surface", Format::CityJson, || {
        let objects: String = (0..40_000)
            .map(|i| format!(r#""{i}":{{"type":"","geometry":[{{"type":"MultiSurface","boundaries":[[[0,1,2]]]}}]}},"#))
            .collect();
        city(&format!(r#""vertices":[[0,0,0],[1,0,0],[0,1,0]],"CityObjects":{{{}}}"#, objects.trim_end_matches(',')))
    }),
    ("surfaces of nothing", Format::CityJson, || surfaces(&list("[]", 1_000_000))),
    ("surfaces of three corners", Format::CityJson, || surfaces(&list("[[0,1,2]]", 400_000))),
    ("a surface of one corner and another", Format::CityJson, || surfaces(&format!("[[{}]]", list("0,1", 500_000)))),
    ("features of nothing", Format::GeoJson, || features(&list("{}", 1_000_000))),
    ("properties of nothing", Format::GeoJson, || {
        features(&format!(r#"{{"properties":{{{}}}}}"#, list(r#""":0"#, 500_000)))
    }),
    ("footprints of three corners", Format::GeoJson, || {
        let footprint =
            r#"{"properties":{"height":1},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1e-4,0],[0,1e-4]]]}}"#;
        features(&list(footprint, 20_000))
    }),
    ("a footprint of many corners", Format::GeoJson, || {
        let ring = list("[0,0],[1e-4,0],[0,1e-4]", 100_000);
        features(&format!(
            r#"{{"properties":{{"height":1}},"geometry":{{"type":"Polygon","coordinates":[[{ring}]]}}}}"#
        ))
    }),
    ("nodes of nothing", Format::Gltf, || gltf(&format!(r#""nodes":[{}]"#, list("{}", 1_000_000)))),
    ("materials of nothing", Format::Gltf, || gltf(&format!(r#""materials":[{}]"#, list("{}", 1_000_000)))),
    ("meshes of nothing", Format::Gltf, || gltf(&format!(r#""meshes":[{}]"#, list("{}", 1_000_000)))),
    ("animations of nothing", Format::Gltf, || gltf(&format!(r#""animations":[{}]"#, list("{}", 1_000_000)))),
    ("channels of nothing", Format::Gltf, || {
        gltf(&format!(r#""animations":[{{"channels":[{}]}}]"#, list("{}", 1_000_000)))
    }),
    ("nodes that all move", Format::Gltf, || {
        let channel = r#"{"sampler":0,"target":{"node":0,"path":"translation"}}"#;
        let animation = format!(r#"{{"channels":[{channel}],"samplers":[{{"input":1,"output":1}}]}}"#);
        let children: String = (1..200_000).map(|child| format!(",{child}")).collect();
        let nodes = format!(r#"{{"children":[{}]}},{}"#, &children[1..], list(r#"{"mesh":0}"#, 199_999));
        let text = String::from_utf8(thousand(&nodes)).expect("it is text");
        let keys = r#""animations":[ANIMATION],"accessors":[ZEROS,"#
            .replace("ANIMATION", &animation.replace("\"output\":1", "\"output\":0"));
        let zeros =
            r#"{"componentType":5126,"type":"VEC3","count":1},{"componentType":5126,"type":"SCALAR","count":1}"#;
        text.replace(r#""accessors":["#, &keys.replace("ZEROS", zeros))
            .replace("\"POSITION\":0", "\"POSITION\":2")
            .into_bytes()
    }),
    ("morph targets of nothing", Format::Gltf, || {
        let primitive = format!(r#""attributes":{{"POSITION":0}},"targets":[{}]"#, list("{}", 100_000));
        let text = String::from_utf8(thousand(r#"{"mesh":0}"#)).expect("it is text");
        text.replace(r#""attributes":{"POSITION":0}"#, &primitive).into_bytes()
    }),
    ("weights of many nodes", Format::Gltf, || {
        let text = String::from_utf8(thousand(&list(r#"{"mesh":0}"#, 50_000))).expect("it is text");
        let primitive = format!(r#""attributes":{{"POSITION":0}},"targets":[{}]"#, list("{}", 1_000));
        text.replace(r#""attributes":{"POSITION":0}"#, &primitive).into_bytes()
    }),
    ("joints of many nodes", Format::Gltf, || {
        let nodes = list(r#"{"mesh":0,"skin":0}"#, 50_000);
        let skin = format!(r#""skins":[{{"joints":[{}]}}],"accessors":[ZEROS,"#, list("0", 1_000));
        let zeros = r#"{"componentType":5121,"type":"VEC4","count":3000},
            {"componentType":5121,"normalized":true,"type":"VEC4","count":3000,"bufferView":1}"#;
        let text = String::from_utf8(thousand(&nodes)).expect("it is text");
        text.replace(r#""accessors":["#, &skin.replace("ZEROS", zeros))
            .replace(r#""POSITION":0"#, r#""POSITION":2,"JOINTS_0":0,"WEIGHTS_0":1"#)
            // The same four bytes for all, of which the last is not 0.
            .replace(r#"36000}],"buffers""#, r#"36000},{"buffer":0,"byteLength":36000,"byteStride":0}],"buffers""#)
            .into_bytes()
    }),
    ("a mesh of zeros", Format::Gltf, || {
        gltf(
            r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "accessors":[{"componentType":5126,"type":"VEC3","count":80000}]"#,
        )
    }),
    ("many nodes", Format::Gltf, || thousand(&list(r#"{"mesh":0}"#, 100_000))),
    ("nodes with weights of their own", Format::Gltf, || thousand(&list(r#"{"mesh":0,"weights":[]}"#, 100_000))),
    ("instances of instances", Format::Gltf, || {
        let node = r#"{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}}"#;
        thousand(&list(node, 10_000))
    }),
    ("the largest picture", Format::Gltf, || pictures(8192, 1)),
    ("a thousand times one picture", Format::Gltf, || pictures(1024, 1000)),
    ("text that is no JSON", Format::Gltf, || vec![b'['; 3_000_000]),
    ("vertices of nothing", Format::Obj, || obj("", "v\n", 2_000_000)),
    ("faces of three vertices", Format::Obj, || obj(THREE, "f 1 2 3\n", 400_000)),
    ("faces of which one names a normal", Format::Obj, || {
        obj("v 1 2 3\nv 2 3 4\nv 1 1 1\nvn 0 0 1\nf 1//1 2 3\n", "f 1 2 3\n", 400_000)
    }),
    ("normals of zeros for a strip of zeros", Format::Gltf, || {
        gltf(
            r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":1,"mode":5}]}],
            "accessors":[{"componentType":5126,"type":"VEC3","count":10},{"componentType":5125,"type":"SCALAR","count":200000}]"#,
        )
    }),
    ("a face of one vertex", Format::Obj, || obj("v 0 0 0\nf", " 1", 1_500_000)),
    ("objects of one face", Format::Obj, || obj(THREE, "o\nf 1 2 3\n", 300_000)),
    ("announced facets", Format::Stl, || [[0; 80].as_slice(), &[0xff; 4], &[0; 300]].concat()),
    ("announced rows", Format::Ply, || {
        let header = "ply\nformat binary_big_endian 1.0\nelement e 4000000000\nelement vertex 4000000000\n\
            property float x\nproperty float y\nproperty float z\nend_header\n";
        header.as_bytes().to_vec()
    }),
    ("an archive of spaces", Format::Ply, || zipped_spaces(1 << 28)),
];

#[test]
fn no_file_takes_more_memory_than_a_multiple_of_its_size() {
    if let Some(case) = std::env::var_os(CASE) {
        let case: usize = case.to_str().and_then(|case| case.parse().ok()).expect("a number");
        let (_, format, bytes) = CASES[case];
        println!("peak {}", peak_bytes(&bytes(), format));
        return;
    }
    for (case, (name, _, bytes)) in CASES.iter().enumerate() {
        let bytes = bytes();
        let this_test = Command::new(std::env::current_exe().expect("this process has a file"))
            .args(["--nocapture", "--test-threads=1"])
            .env(CASE, case.to_string())
            .output()
            .expect("it can be started again");
        let output = String::from_utf8_lossy(&this_test.stdout);
        let peak =
            output.lines().find_map(|line| line.split_once("peak ")).map(|(_, peak)| peak.trim().parse::<usize>());
        let Some(Ok(peak)) = peak else { panic!("{name}: no peak in {output}") };
        let fixed = match name {
            _ if name.contains("picture") => PICTURE_BYTES,
            _ if name.contains("terrain") => TERRAIN_BYTES,
            _ => 0,
        };
        let limit = FREE_BYTES + MAX_MULTIPLE * bytes.len() + fixed;
        println!("{name}: {:.1} MB for {:.1} MB", peak as f64 / 1e6, bytes.len() as f64 / 1e6);
        assert!(peak <= limit, "{name}: {peak} bytes of memory for a file of {}", bytes.len());
    }
}
