//! Textures, the coordinates they are looked up by, and what alpha means.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec2;
use serde_json::{Value, json};
use umbrae_core::{AlphaMode, Wrap};

use super::{Builder, UBYTE, one_triangle, warnings};
use crate::{Format, LoadOptions, load_bytes};

/// A PNG of 2 by 1 texels, red and blue.
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::RgbImage::from_vec(2, 1, vec![255, 0, 0, 0, 0, 255]).expect("two texels");
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes it");
    bytes.into_inner()
}

/// A triangle with texture coordinates in two sets, and a material for it.
fn one_textured_triangle(texture: &Value) -> Builder {
    let mut builder = one_triangle();
    let first = builder.floats("VEC2", 2, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let second = builder.accessor("VEC2", UBYTE, 3, &[0, 0, 255, 0, 0, 51]);
    builder.json["accessors"][second]["normalized"] = json!(true);
    builder.json["meshes"][0]["primitives"][0] =
        json!({"attributes": {"POSITION": 0, "TEXCOORD_0": first, "TEXCOORD_1": second}, "material": 0});
    builder.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": texture}}]);
    let view = builder.view(&png());
    builder.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    builder.json["textures"] = json!([{"source": 0}]);
    builder
}

#[test]
fn a_texture_comes_from_a_buffer_a_data_uri_or_a_file_beside_the_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("red and blue.png"), png()).expect("a file");
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    let embedded = builder.json["images"][0].clone();
    let data = format!("data:image/png;base64,{}", STANDARD.encode(png()));
    for image in [embedded, json!({"uri": data}), json!({"uri": "red%20and%20blue.png"})] {
        builder.json["images"] = json!([image]);
        let options = LoadOptions::default();
        let model = load_bytes(&builder.text(), Format::Gltf, "model.gltf", Some(folder.path()), &options);
        let model = model.expect("a good file");
        let [texture] = model.scene.textures.as_slice() else { panic!("one texture: {:?}", model.scene.textures) };
        assert_eq!((texture.size_px, texture.rgba.as_slice()), ([2, 1], [255, 0, 0, 255, 0, 0, 255, 255].as_slice()));
        assert_eq!(model.scene.materials[0].base_color_texture, Some(0));
        assert_eq!(model.scene.objects[0].mesh.corner_uvs(), [[Vec2::ZERO, Vec2::X, Vec2::Y]]);
        assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    }
}

#[test]
fn texture_coordinates_are_of_the_set_and_under_the_transform_that_the_material_names() {
    let uvs = |texture: Value| one_textured_triangle(&texture).model().scene.objects[0].mesh.corner_uvs()[0];
    assert_eq!(uvs(json!({"index": 0, "texCoord": 1})), [Vec2::ZERO, Vec2::X, Vec2::new(0.0, 0.2)]);
    let turn = json!({"offset": [0.5, 0.25], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 1]});
    // Counter-clockwise with v down: from right (1, 0) to up (0, -1), and from down (0, 1) to right.
    let [origin, right, down] = uvs(json!({"index": 0, "extensions": {"KHR_texture_transform": turn}}));
    for (uv, expected) in [(origin, [0.5, 0.25]), (right, [0.5, -1.75]), (down, [1.5, 0.25])] {
        assert!(uv.distance(Vec2::from(expected)) < 1e-6, "{uv} is not {expected:?}");
    }
    let other = json!({"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 1}}});
    assert_eq!(uvs(other)[2], Vec2::new(0.0, 0.2), "the transform's set wins");
}

#[test]
fn materials_share_textures_and_samplers_set_them_apart() {
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    builder.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}, {"magFilter": 9729}]);
    builder.json["textures"] = json!([{"source": 0}, {"source": 0, "sampler": 0}, {"source": 0, "sampler": 1}]);
    builder.json["materials"] =
        (0..3).map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}})).collect();
    let scene = builder.model().scene;
    let of_material: Vec<Option<u32>> = scene.materials.iter().map(|m| m.base_color_texture).collect();
    assert_eq!(of_material, [Some(0), Some(1), Some(0), None], "the third samples as one without a sampler");
    assert_eq!((scene.textures[0].wrap, scene.textures[0].is_nearest), ([Wrap::Repeat; 2], false));
    assert_eq!((scene.textures[1].wrap, scene.textures[1].is_nearest), ([Wrap::Clamp, Wrap::Mirror], true));
}

#[test]
fn a_texture_that_can_not_be_had_is_left_out_and_named() {
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    let webp = json!([{"extensions": {"EXT_texture_webp": {"source": 0}}}]);
    let good = builder.json["textures"].clone();
    let cases = [
        (webp, json!({}), "texture 0: it has no PNG or JPEG (its picture may be"),
        (good.clone(), json!({}), "texture 0: image 0: it has neither a uri nor a buffer view"),
        (good.clone(), json!({"bufferView": 0}), "texture 0: image 0: its picture is something else; only PNG"),
        (good.clone(), json!({"uri": "data:,abc"}), "texture 0: image 0: its picture is something else; only PNG"),
        (good.clone(), json!({"uri": "a.png"}), "texture 0: image 0: \"a.png\": it is in the file \"a.png\", which"),
        (good.clone(), json!({"bufferView": 99}), "texture 0: image 0: there is no buffer view 99"),
        (json!([{"source": 7}]), json!({}), "texture 0: there is no image 7, only 1"),
    ];
    for (textures, image, expected) in cases {
        builder.json["textures"] = textures;
        builder.json["images"] = json!([image]);
        let model = builder.model();
        let [warning] = model.warnings.as_slice() else { panic!("one warning: {:?}", model.warnings) };
        let expected = format!("1 base colour texture was left out (first: {expected}");
        assert!(warning.to_string().starts_with(&expected), "{warning}");
        assert_eq!(model.scene.materials[0].base_color_texture, None);
    }
}

#[test]
fn a_textured_primitive_without_coordinates_keeps_its_shape() {
    let mut builder = one_textured_triangle(&json!({"index": 0, "texCoord": 3}));
    let model = builder.model();
    assert!(model.scene.objects[0].mesh.corner_uvs().is_empty());
    assert_eq!(warnings(&model), ["1 primitive has no texture coordinates to use (first: there is no TEXCOORD_3)"]);
    let short = builder.floats("VEC2", 2, &[0.0; 4]);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_3"] = json!(short);
    let expected = "1 primitive has no texture coordinates to use (first: TEXCOORD_3 has 2 elements for 3 vertices)";
    assert_eq!(warnings(&builder.model()), [expected]);
}

#[test]
fn primitives_with_and_without_textures_share_a_mesh() {
    let mut builder = one_textured_triangle(&json!({"index": 0}));
    let textured = builder.json["meshes"][0]["primitives"][0].clone();
    let plain = json!({"attributes": {"POSITION": 0}});
    builder.json["meshes"][0]["primitives"] = json!([plain, textured, plain]);
    let corner_uvs = builder.model().scene.objects[0].mesh.corner_uvs().to_vec();
    assert_eq!(corner_uvs, [[Vec2::ZERO; 3], [Vec2::ZERO, Vec2::X, Vec2::Y], [Vec2::ZERO; 3]]);
}

#[test]
fn alpha_means_what_its_mode_says() {
    let mut builder = one_triangle();
    let transmission = |factor: f64| json!({"KHR_materials_transmission": {"transmissionFactor": factor}});
    let quarter = json!({"baseColorFactor": [1, 1, 1, 0.25]});
    builder.json["materials"] = json!([
        {"pbrMetallicRoughness": quarter},
        {"name": "leaf", "alphaMode": "MASK", "pbrMetallicRoughness": quarter},
        {"alphaMode": "MASK", "alphaCutoff": 0.375, "pbrMetallicRoughness": quarter},
        {"alphaMode": "BLEND", "pbrMetallicRoughness": quarter},
        {"name": "pane", "extensions": transmission(1.0)},
        {"extensions": transmission(0.0)},
    ]);
    let model = builder.model();
    let modes: Vec<AlphaMode> = model.scene.materials.iter().map(|material| material.alpha_mode).collect();
    let cut = |cutoff: f32| AlphaMode::Mask { cutoff };
    use AlphaMode::{Blend, Opaque};
    assert_eq!(modes, [Opaque, cut(0.5), cut(0.375), Blend, Blend, Opaque, Opaque]);
    assert_eq!(model.scene.materials[3].alpha, 0.25);
    assert!((model.scene.materials[4].alpha - 0.3).abs() < 1e-6);
    assert_eq!(
        warnings(&model),
        [
            "2 cut-out materials cast as full triangles (first: \"leaf\")",
            "1 transmitting material is drawn as plain glass (first: \"pane\")",
        ]
    );
}

#[test]
fn a_material_that_is_whole_everywhere_is_opaque_whatever_it_says() {
    for (alpha, is_whole) in [(255, true), (254, false)] {
        let mut builder = one_textured_triangle(&json!({"index": 0}));
        let picture = image::RgbaImage::from_vec(2, 1, vec![9, 9, 9, 255, 9, 9, 9, alpha]).expect("two texels");
        let mut png = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut png, image::ImageFormat::Png).expect("memory takes it");
        let view = builder.view(&png.into_inner());
        builder.json["images"] = json!([{"bufferView": view}]);
        let material = |mode: &str, cutoff: f32| {
            let texture = json!({"baseColorTexture": {"index": 0}});
            json!({"alphaMode": mode, "alphaCutoff": cutoff, "pbrMetallicRoughness": texture})
        };
        builder.json["materials"] = json!([material("BLEND", 0.5), material("MASK", 0.5), material("MASK", 1.0)]);
        let modes: Vec<AlphaMode> = builder.model().scene.materials.iter().map(|m| m.alpha_mode).collect();
        let expected = if is_whole {
            [AlphaMode::Opaque; 3]
        } else {
            [AlphaMode::Blend, AlphaMode::Opaque, AlphaMode::Mask { cutoff: 1.0 }]
        };
        assert_eq!(modes[..3], expected);
    }
    let mut builder = one_triangle();
    builder.json["materials"] = json!([{"alphaMode": "BLEND"}]);
    assert_eq!(builder.model().scene.materials[0].alpha_mode, AlphaMode::Opaque, "nothing shows through");
}
