//! Every good model beside the project loads, and has what SOURCES.md says was measured of it by others.

mod counts;
mod shared_data;

use counts::Counts;
use umbrae_formats::{LoadOptions, Warning, load};

/// Where SOURCES.md measured something else than what is shown, and why.
const EXCEPTIONS: [(&str, usize, &str); 2] = [
    ("gltf/SimpleInstancing.glb", 125 * 12, "measured without EXT_mesh_gpu_instancing"),
    ("gltf/MultipleScenes/MultipleScenes.gltf", 2, "edges were measured in both scenes"),
];

/// The rows of SOURCES.md for models of ours, with what was measured.
fn measured(sources: &str) -> Vec<(&str, &str)> {
    sources
        .lines()
        .filter_map(|line| {
            let mut cells = line.split('|').map(str::trim).skip(1);
            let (file, _bytes, what) = (cells.next()?, cells.next()?, cells.next()?);
            let is_ours = file.starts_with("gltf/") || file.starts_with("mesh/") || file.ends_with(".glb");
            (is_ours && what.contains(" tri") && !file.starts_with("nasty/")).then_some((file, what))
        })
        .collect()
}

/// The number before `unit` in a text like "12 tri (24 instanced in default scene), open, 8 boundary edges".
fn number_before(text: &str, unit: &str) -> Option<usize> {
    text[..text.find(unit)?].rsplit(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

fn expected(what: &str) -> Counts {
    let shown =
        number_before(what, " instanced").or_else(|| number_before(what, " tri")).expect("a number of triangles");
    Counts {
        shown,
        border: number_before(what, " boundary edges").unwrap_or(0),
        non_manifold: number_before(what, " non-manifold edges").unwrap_or(0),
        inconsistent: number_before(what, " inconsistently wound edges").unwrap_or(0),
    }
}

#[test]
fn every_model_loads_and_has_the_edges_that_others_measured() {
    let Some(folder) = shared_data::folder() else { return };
    let sources = std::fs::read_to_string(folder.join("SOURCES.md")).expect("the list of models");
    let mut agreeing = 0;
    for (file, what) in measured(&sources) {
        let model = load(&folder.join(file), &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let counts = counts::of_model(&model);
        match EXCEPTIONS.iter().find(|(name, ..)| *name == file) {
            Some((_, shown, why)) => assert_eq!(counts.shown, *shown, "{file}: {why}"),
            None => {
                assert_eq!(counts, expected(what), "{file}");
                agreeing += 1;
            }
        }
    }
    assert!(agreeing >= 50, "only {agreeing} models were compared");
}

/// What is left out of real models is what we know we leave out.
#[test]
fn no_model_loses_anything_unexpected() {
    let Some(folder) = shared_data::folder() else { return };
    let known = [
        "animation",
        "cut-out material",
        "line primitive",
        "material librar",
        "orthographic camera",
        "point primitive",
        "transmitting material",
    ];
    let sources = std::fs::read_to_string(folder.join("SOURCES.md")).expect("the list of models");
    for (file, _) in measured(&sources) {
        let model = load(&folder.join(file), &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let unknown: Vec<&Warning> = model
            .warnings
            .iter()
            .filter(|warning| !known.iter().any(|known| warning.message.contains(known)))
            .collect();
        assert!(unknown.is_empty(), "{file}: {unknown:?}");
    }
}

/// A walking man, posed by his joints: about 1.5 m tall, upright, and not where his node says.
#[test]
fn a_skinned_man_stands_upright() {
    let Some(folder) = shared_data::folder() else { return };
    let man = load(&folder.join("gltf/CesiumMan.glb"), &LoadOptions::default()).expect("he loads");
    let size = man.scene.bounds().size();
    assert!((1.4..1.6).contains(&size.z) && size.x < 1.2 && size.y < 1.2, "{size}");
    assert!(man.scene.bounds().min.z.abs() < 0.05, "he stands on the ground: {}", man.scene.bounds().min);
}

#[test]
fn cameras_and_lights_come_with_their_models() {
    let Some(folder) = shared_data::folder() else { return };
    let cameras = load(&folder.join("gltf/Cameras/Cameras.gltf"), &LoadOptions::default()).expect("it loads");
    assert_eq!(cameras.scene.cameras.len(), 1, "the other is orthographic");
    let lamp = load(&folder.join("gltf/LightsPunctualLamp.glb"), &LoadOptions::default()).expect("it loads");
    assert_eq!(lamp.scene.lights.len(), 5);
    assert!(lamp.scene.lights.iter().all(|light| light.cone.is_none() && light.range_m.is_none()), "five bare points");
}
