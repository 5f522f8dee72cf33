//! Damaged and crafted files never panic, and are done with in no time.

mod shared_data;

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use umbrae_formats::{Format, LoadError, LoadOptions, Model, load_bytes};

/// Small files of every format and encoding.
const VICTIMS: [&str; 28] = [
    "city/building_with_innerring.city.json",
    "city/geometry_template_lod3.json",
    "city/multi_lod.json",
    "city/paris_tower.city.jsonl",
    "city/twobuildings.city.json",
    "gltf/AnimatedMorphCube.glb",
    "gltf/Box-embedded.gltf",
    "gltf/BoxAnimated.glb",
    "gltf/BoxInterleaved.glb",
    "gltf/BoxVertexColors.glb",
    "gltf/Cameras/Cameras.gltf",
    "gltf/Fox.glb",
    "gltf/InterpolationTest.glb",
    "gltf/MeshPrimitiveModes/MeshPrimitiveModes.gltf",
    "gltf/SimpleInstancing.glb",
    "gltf/SimpleSkin/SimpleSkin.gltf",
    "gltf/SimpleSparseAccessor/SimpleSparseAccessor.gltf",
    "gltf/nested.glb",
    "mesh/CornellBox-Original.obj",
    "nasty/concave_polygon.obj",
    "nasty/nancolor.obj",
    "nasty/wallhole.obj",
    "nasty/cube_binary_header_with_RN_newline.ply",
    "nasty/cube_quads.ply",
    "nasty/mirror.ply",
    "nasty/large_block.STL",
    "nasty/multibody.stl",
    "nasty/triangle_with_two_solids.stl",
];

/// Of each kind of damage, to each file.
const ROUNDS: u64 = 250;

/// Far more than any of these takes, even where the machine is busy.
const PATIENCE: Duration = Duration::from_secs(5);

/// Numbers that look random and are the same on every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        // SplitMix64, by G. Steele, D. Lea and C. Flood, 2014.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

fn read(bytes: &[u8], format: Format, folder: Option<&Path>) -> Result<Model, LoadError> {
    let start = Instant::now();
    let options = LoadOptions { normals: true, ..LoadOptions::default() };
    let result = load_bytes(bytes, format, "hostile", folder, &options);
    assert!(start.elapsed() < PATIENCE, "it took {:?}", start.elapsed());
    result
}

/// Whatever moves, every vertex is somewhere at all times.
fn play(mut model: Model) {
    let start = Instant::now();
    let names: Vec<String> = model.animations.iter().map(|animation| animation.name.to_owned()).collect();
    for name in [None].into_iter().chain(names.iter().map(|name| Some(name.as_str()))) {
        let playing = model.animations.choose(name).expect("it has that name");
        for time_s in [0.0, 0.3 * playing.duration_s(), 1.0, f64::MAX] {
            model.animations.pose(&mut model.scene, &playing, time_s).expect("its own scene and a good time");
            let bounds = model.scene.bounds();
            let furthest = bounds.min.abs().max(bounds.max.abs()).max_element();
            assert!(furthest < 1.001e18, "{name:?} at {time_s} s: {bounds:?}");
        }
    }
    assert!(start.elapsed() < PATIENCE, "playing took {:?}", start.elapsed());
}

fn flipped(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len());
        bytes[at] ^= 1 << random.below(8);
    }
    bytes
}

/// One of the numbers in its text replaced by something worse.
fn renumbered(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let is_start = |&at: &usize| bytes[at].is_ascii_digit() && (at == 0 || !bytes[at - 1].is_ascii_digit());
    let starts: Vec<usize> = (0..bytes.len()).filter(is_start).collect();
    if starts.is_empty() {
        return bytes.to_vec();
    }
    let start = starts[random.below(starts.len())];
    let length = bytes[start..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let worse =
        ["0", "1", "-1", "255", "65536", "2147483648", "4294967295", "18446744073709551615", "1e300", "null", "nan"];
    let worse = worse[random.below(worse.len())];
    [&bytes[..start], worse.as_bytes(), &bytes[start + length..]].concat()
}

#[test]
fn damaged_files_load_or_fail_but_never_panic() {
    let Some(root) = shared_data::folder() else { return };
    for (number, file) in VICTIMS.iter().enumerate() {
        let path = root.join(file);
        let bytes = fs::read(&path).expect("a file beside the project");
        let format = Format::of_path(&path).expect("a format of ours");
        let mut random = Random(number as u64);
        for _ in 0..ROUNDS {
            let damaged = [
                bytes[..random.below(bytes.len())].to_vec(),
                flipped(&bytes, &mut random),
                renumbered(&bytes, &mut random),
            ];
            for damaged in damaged {
                match read(&damaged, format, path.parent()) {
                    Ok(model) if model.animations.is_empty() => {}
                    Ok(model) => play(model),
                    Err(error) => {
                        let message = error.to_string();
                        assert!(!message.contains('\n') && message.len() < 2000, "{file}: {message}");
                    }
                }
            }
        }
    }
}

/// Houses with a courtyard, in a bow and in a collection, in degrees.
const FOOTPRINTS: &str = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:OGC:1.3:CRS84"}},
    "features":[{"type":"Feature","id":7,"properties":{"height":12,"min_height":3},"geometry":{"type":"Polygon","coordinates":[
    [[16.37,48.2],[16.371,48.2],[16.371,48.201],[16.37,48.201],[16.37,48.2]],
    [[16.3703,48.2003],[16.3707,48.2003],[16.3707,48.2007],[16.3703,48.2007],[16.3703,48.2003]]]}},
    {"type":"Feature","properties":{"levels":"4"},"geometry":{"type":"MultiPolygon","coordinates":[[[[16.372,48.2],[16.373,48.201],
    [16.373,48.2],[16.372,48.201],[16.372,48.2]]]]}},{"properties":{"height":"40 ft"},"geometry":{"type":"GeometryCollection",
    "geometries":[{"type":"Polygon","coordinates":[[[16.375,48.2,7],[16.376,48.2,7],[16.376,48.201,7]]]}]}}]}"#;

/// A hill of 6 by 5 samples in half metres of RD New, as plain TIFF.
fn hill() -> Vec<u8> {
    use tiff::encoder::{TiffEncoder, colortype::Gray32Float};
    use tiff::tags::Tag;

    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).expect("memory takes it");
    let mut image = encoder.new_image::<Gray32Float>(6, 5).expect("a good size");
    let keys: [u16; 12] = [1, 1, 0, 2, 1025, 0, 1, 1, 3072, 0, 1, 28992];
    image.encoder().write_tag(Tag::ModelPixelScaleTag, [0.5, 0.5, 0.0_f64].as_slice()).expect("memory takes it");
    let tie = [0.0, 0.0, 0.0, 92_000.0, 437_000.0, 0.0_f64];
    image.encoder().write_tag(Tag::ModelTiepointTag, tie.as_slice()).expect("memory takes it");
    image.encoder().write_tag(Tag::GeoKeyDirectoryTag, keys.as_slice()).expect("memory takes it");
    image.encoder().write_tag(Tag::GdalNodata, "-9999").expect("memory takes it");
    let samples: Vec<f32> = (0..30).map(|i| (i % 7) as f32).collect();
    image.write_data(&samples).expect("memory takes it");
    bytes.into_inner()
}

#[test]
fn damaged_footprints_and_hills_load_or_fail_but_never_panic() {
    let mut random = Random(99);
    for (bytes, format) in [(FOOTPRINTS.as_bytes().to_vec(), Format::GeoJson), (hill(), Format::GeoTiff)] {
        read(&bytes, format, None).expect("a good file");
        for _ in 0..4 * ROUNDS {
            let cut_off = bytes[..random.below(bytes.len())].to_vec();
            for damaged in [cut_off, flipped(&bytes, &mut random), renumbered(&bytes, &mut random)] {
                if let Err(error) = read(&damaged, format, None) {
                    let message = error.to_string();
                    assert!(!message.contains('\n') && message.len() < 2000, "{message}");
                }
            }
        }
    }
}

/// One triangle with this picture on it.
fn with_picture(picture: &[u8]) -> Vec<u8> {
    let escaped: String = picture.iter().map(|byte| format!("%{byte:02x}")).collect();
    let data = "%00%00%00@%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00@%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00@";
    format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"images":[{{"uri":"data:,{escaped}"}}],
        "textures":[{{"source":0}}],"materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"data:,{data}"}}]}}"#
    )
    .into_bytes()
}

#[test]
fn a_damaged_picture_leaves_the_model_as_it_is() {
    let mut random = Random(77);
    let texel = |x: u32, y: u32| [(x * 7 + y * 13) as u8, (x ^ y) as u8, (x * y) as u8, 200];
    let picture = image::RgbaImage::from_fn(24, 20, |x, y| image::Rgba(texel(x, y)));
    let picture = image::DynamicImage::ImageRgba8(picture);
    let kinds = [
        (picture.clone(), image::ImageFormat::Png),
        (picture.to_luma16().into(), image::ImageFormat::Png),
        (picture.to_rgb8().into(), image::ImageFormat::Jpeg),
    ];
    for (picture, format) in kinds {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).expect("memory takes it");
        let bytes = bytes.into_inner();
        assert_eq!(read(&with_picture(&bytes), Format::Gltf, None).expect("a good file").scene.textures.len(), 1);
        for _ in 0..ROUNDS {
            for damaged in [bytes[..random.below(bytes.len())].to_vec(), flipped(&bytes, &mut random)] {
                let model = read(&with_picture(&damaged), Format::Gltf, None).expect("the triangle is good");
                assert_eq!(model.scene.triangle_count(), 1);
                let is_told =
                    model.warnings.iter().any(|warning| warning.message.contains("texture 0: image 0: its picture"));
                assert_ne!(model.scene.textures.is_empty(), model.scene.materials[0].base_color_texture.is_some());
                assert_eq!(model.scene.textures.is_empty(), is_told, "{:?}", model.warnings);
            }
        }
    }
}

fn error(bytes: &[u8], format: Format) -> String {
    read(bytes, format, None).expect_err("a crafted file").to_string()
}

fn glb(json: &str) -> Vec<u8> {
    let length = (20 + json.len()) as u32;
    [b"glTF\x02\0\0\0", length.to_le_bytes().as_slice(), &(json.len() as u32).to_le_bytes(), b"JSON", json.as_bytes()]
        .concat()
}

fn one_accessor(accessor: &str) -> Vec<u8> {
    glb(&format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "buffers":[{{"byteLength":6,"uri":"data:,abcdef"}}],"bufferViews":[{{"buffer":0,"byteLength":6}}],
        "accessors":[{{"componentType":5126,"type":"VEC3",{accessor}}}]}}"#
    ))
}

#[test]
fn a_billion_announced_vertices_in_300_bytes_are_not_believed() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let ply = format!(
            "ply\nformat {encoding} 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\nproperty list uint uint vertex_indices\nend_header\n{}",
            "0 0 0\n".repeat(20)
        );
        assert!(error(ply.as_bytes(), Format::Ply).contains("announces 1000000000 rows of \"vertex\""));
    }
    let mut stl = [0_u8; 300];
    stl[80..84].copy_from_slice(&1_000_000_000_u32.to_le_bytes());
    assert!(error(&stl, Format::Stl).contains("announces 1000000000 facets"));
    let zeros = one_accessor(r#""count":1000000000"#);
    assert!(error(&zeros, Format::Gltf).contains("1000000000 elements bring"));
    let stored = one_accessor(r#""count":1000000000,"bufferView":0"#);
    assert!(error(&stored, Format::Gltf).contains("1000000000 elements"));
    let same = String::from_utf8(stored)
        .expect("it is text")
        .replace(r#""byteLength":6}]"#, r#""byteLength":6,"byteStride":0}]"#);
    let json = &same[same.find('{').expect("its JSON")..];
    assert!(read(&glb(json), Format::Gltf, None).is_err());
}

#[test]
fn lists_and_polygons_longer_than_the_file_are_not_believed() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uint uchar vertex_indices\nend_header\n";
    let bytes = [header.as_bytes(), &[0; 12], &u32::MAX.to_le_bytes(), &[0; 100]].concat();
    assert!(error(&bytes, Format::Ply).contains("a list announces 4294967295 items, but 100 bytes are left"));
}

#[test]
fn sums_and_products_that_overflow_are_out_of_range() {
    let max = u64::MAX;
    for accessor in [
        format!(r#""count":{max}"#),
        format!(r#""count":{max},"bufferView":0"#),
        format!(r#""count":1,"bufferView":0,"byteOffset":{max}"#),
        format!(r#""count":{},"bufferView":0"#, max / 12 + 2),
        format!(
            r#""count":1,"sparse":{{"count":{max},"indices":{{"bufferView":0,"componentType":5125}},"values":{{"bufferView":0}}}}"#
        ),
    ] {
        assert!(error(&one_accessor(&accessor), Format::Gltf).contains("elements"), "{accessor}");
    }
    let mut header = glb("{}");
    header[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(error(&header, Format::Gltf).contains("announces 4294967295 bytes"));
    header[8..12].copy_from_slice(&3_u32.to_le_bytes());
    assert!(error(&header, Format::Gltf).contains("announces 3 bytes"));
}

#[test]
fn nesting_and_cycles_end() {
    let deep = format!(r#"{{"asset":{{"version":"2.0"}},"extras":{}{}}}"#, "[".repeat(100_000), "]".repeat(100_000));
    assert!(read(&glb(&deep), Format::Gltf, None).is_err());
    let deep = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":{}{}}}"#, "[".repeat(100_000), "]".repeat(100_000));
    assert!(error(deep.as_bytes(), Format::Gltf).contains("its JSON can't be read"));
    let chain: Vec<String> = (1..100_000).map(|child| format!(r#"{{"children":[{child}]}}"#)).collect();
    let nodes = |last: &str| {
        format!(r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{},{last}]}}"#, chain.join(","))
    };
    assert!(error(nodes("{}").as_bytes(), Format::Gltf).contains("there is no mesh"));
    assert!(error(nodes(r#"{"children":[0]}"#).as_bytes(), Format::Gltf).contains("which already has a place"));
}

/// Each node shows both nodes of the next level: 2^40 of them, if it were no tree that is asked for.
#[test]
fn nodes_that_double_at_each_level_are_refused() {
    let nodes: Vec<String> = (0..40).map(|level| format!(r#"{{"children":[{0},{0}]}}"#, level + 1)).collect();
    let json = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{},{{}}]}}"#, nodes.join(","));
    assert!(error(json.as_bytes(), Format::Gltf).contains("which already has a place"));
}

/// Hundreds of animations that each have hundreds of channels which name the same keys.
#[test]
fn animations_that_repeat_themselves_are_read_once() {
    let channels = |node: usize| format!(r#"{{"sampler":0,"target":{{"node":{node},"path":"translation"}}}}"#);
    let channels = (0..300).map(channels).collect::<Vec<_>>().join(",");
    let animation = format!(r#"{{"channels":[{channels}],"samplers":[{{"input":1,"output":2}}]}}"#);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "buffers":[{{"byteLength":36,"uri":"data:,%00%00%00@%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00@%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00@"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"animations":[{}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}},
        {{"componentType":5126,"type":"SCALAR","count":50000}},{{"componentType":5126,"type":"VEC3","count":50000}}]}}"#,
        vec![r#"{"mesh":0}"#; 300].join(","),
        vec![animation; 200].join(","),
    );
    let mut model = read(json.as_bytes(), Format::Gltf, None).expect("its keys are zeros");
    assert_eq!((model.animations.iter().count(), model.scene.objects.len()), (200, 300));
    model.play(None, 1.0).expect("a good time");
    assert!(model.warnings[0].message.starts_with("animations move the same things"), "{:?}", model.warnings);
}

/// Thousands of meshes that name the same accessor would take the square of the file's size.
#[test]
fn a_file_that_repeats_itself_without_end_is_shown_in_part() {
    // As floats 0, 2, 0; 2, 0, 0; 0, 0, 2 over and over: triangles.
    let data = "%00%00%00%00%00%00%00@%00%00%00%00%00%00%00@%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00@"
        .repeat(1000);
    let mesh = vec![r#"{"primitives":[{"attributes":{"POSITION":0}}]}"#; 3000].join(",");
    let nodes: Vec<String> = (0..3000).map(|mesh| format!(r#"{{"mesh":{mesh}}}"#)).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{}],"meshes":[{mesh}],"buffers":[{{"byteLength":36000,"uri":"data:,{data}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36000,"byteStride":4}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":8997}}]}}"#,
        nodes.join(","),
    );
    let model = read(json.as_bytes(), Format::Gltf, None).expect("the first of them are shown");
    let warning = model.warnings[0].to_string();
    assert!(
        warning.contains("objects were skipped") && warning.contains("64 numbers for each of its bytes"),
        "{warning}"
    );
    assert!((100..2000).contains(&model.scene.objects.len()), "{} objects", model.scene.objects.len());
}

#[test]
fn indices_of_any_size_are_out_of_range_or_skipped() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4294967296\nf 1 2 -99999999999\nf 1 2 9223372036854775807\nf 1 2 0\n";
    let model = read(obj.as_bytes(), Format::Obj, None).expect("one face is good");
    assert_eq!((model.scene.triangle_count(), model.warnings.iter().map(|w| w.count).sum::<usize>()), (1, 4));
}

#[test]
fn nothing_and_next_to_nothing_are_refused() {
    for format in [Format::Gltf, Format::Obj, Format::Ply, Format::Stl] {
        assert_eq!(error(b"", format), "hostile: the file is empty (0 bytes)");
        for bytes in [&b"\0"[..], b"\n", b"{", b"\xff\xfe", b"solid", b"ply", b"glTF", b"v", b"f", b"\x1f\x8b", b"\\"] {
            let _ = error(bytes, format);
        }
    }
}

/// A polygon for which ear cutting takes longest, as large as it may get.
#[test]
fn large_polygons_are_cut_in_time() {
    for corners in [1_000, 16_000, 100_000] {
        let spike = |i: usize| if i.is_multiple_of(2) { 1.0 } else { 0.1 };
        let angle = |i: usize| i as f64 / corners as f64 * std::f64::consts::TAU;
        let mut obj: String = (0..corners)
            .map(|i| format!("v {} {} 0\n", angle(i).cos() * spike(i), angle(i).sin() * spike(i)))
            .collect();
        obj.push('f');
        obj.extend((1..=corners).map(|i| format!(" {i}")));
        let model = read(obj.as_bytes(), Format::Obj, None).expect("a star");
        assert_eq!(model.scene.triangle_count(), corners - 2);
    }
}

#[test]
fn a_great_many_groups_are_read_in_time() {
    let groups: String = (0..50_000).map(|i| format!("g {i}\nf 1 2 3\n")).collect();
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".repeat(10_000);
    let model = read(format!("{vertices}{groups}").as_bytes(), Format::Obj, None).expect("good groups");
    assert_eq!(model.scene.objects.len(), 50_000);
}
