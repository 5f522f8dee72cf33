use std::collections::BTreeSet;

use clap::ValueEnum;
use umbrae_core::{Caster, Scene};
use umbrae_formats::{Format, LoadOptions, load_bytes};

use super::*;

fn samples() -> impl Iterator<Item = (Sample, Scene)> {
    Sample::value_variants().iter().chain([&Sample::TownByNight]).map(|&sample| (sample, sample.scene()))
}

#[test]
fn samples_go_by_the_names_of_the_command_line() {
    let names: Vec<String> = Sample::value_variants()
        .iter()
        .map(|sample| sample.to_possible_value().expect("no sample is hidden").get_name().to_owned())
        .collect();
    assert_eq!(names, ["lattice-tower", "industry", "high-rise", "staircase", "town"]);
}

#[test]
fn samples_have_as_many_triangles_as_the_scenes_they_stand_in_for() {
    for (sample, scene) in samples() {
        let (expected, tolerance) = match sample {
            Sample::LatticeTower => (11_400.0, 0.03),
            Sample::Industry => (13_600.0, 0.03),
            Sample::HighRise => (182_000.0, 0.02),
            Sample::Staircase => (4_000.0, 0.25),
            Sample::Town => (60_000.0, 0.1),
            Sample::TownByNight => (64_000.0, 0.1),
        };
        let count = scene.triangle_count() as f64;
        assert!((count / expected - 1.0).abs() <= tolerance, "{sample:?} has {count} triangles");
    }
}

#[test]
fn a_sample_is_the_same_every_time() {
    for (sample, scene) in samples() {
        let again = sample.scene();
        assert_eq!(scene.materials, again.materials);
        assert_eq!(scene.objects.len(), again.objects.len());
        for (object, other) in scene.objects.iter().zip(&again.objects) {
            assert_eq!(object.name, other.name);
            assert_eq!(object.world_from_object, other.world_from_object);
            assert!(object.mesh == other.mesh, "{sample:?}, {}", object.name);
        }
    }
}

#[test]
fn every_mesh_is_closed_and_has_lost_no_triangle() {
    for (sample, scene) in samples() {
        for object in &scene.objects {
            let counts = object.mesh.counts();
            assert_eq!(counts.degenerate_triangles, 0, "{sample:?}, {}", object.name);
            let mut walks: BTreeSet<[u32; 2]> = BTreeSet::new();
            for &[a, b, c] in object.mesh.triangles() {
                for [p, q] in [[a, b], [b, c], [c, a]] {
                    // Twice the same way would also mean that two parts coincide.
                    assert!(walks.insert([p, q]), "{sample:?}, {}: edge {p}-{q} is walked twice", object.name);
                }
            }
            let open = walks.iter().filter(|&&[p, q]| !walks.contains(&[q, p])).count();
            assert_eq!(open, 0, "open edges in {sample:?}, {}", object.name);
        }
    }
}

#[test]
fn every_mesh_has_its_inside_inside() {
    for (sample, scene) in samples() {
        for object in &scene.objects {
            let positions = object.mesh.positions();
            let corners = object.mesh.triangles().iter().map(|t| t.map(|i| positions[i as usize].as_dvec3()));
            let volume: f64 = corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
            assert!(volume > 0.0, "{sample:?}, {}: {volume} m³", object.name);
        }
    }
}

#[test]
fn samples_stand_on_the_ground_and_are_as_large_as_they_say() {
    for (sample, scene) in samples() {
        let (low, high) = match sample {
            Sample::LatticeTower => ([125.0, 125.0, 300.0], [140.0, 140.0, 300.5]),
            Sample::Industry => ([200.0, 120.0, 60.0], [240.0, 160.0, 65.0]),
            Sample::HighRise => ([45.0, 35.0, 199.0], [55.0, 42.0, 204.0]),
            Sample::Staircase => ([4.0, 95.0, 52.0], [5.0, 98.0, 53.0]),
            Sample::Town | Sample::TownByNight => ([295.0, 240.0, 57.0], [312.0, 262.0, 60.0]),
        };
        let bounds = scene.bounds();
        assert!(bounds.min.z.abs() < 1e-6, "{sample:?} begins at {}", bounds.min.z);
        let size = bounds.size().to_array();
        let fits = (0..3).all(|axis| low[axis] <= size[axis] && size[axis] <= high[axis]);
        assert!(fits, "{sample:?} is {size:?} m large");
    }
}

#[test]
fn samples_have_their_structural_components_by_name() {
    for (sample, scene) in samples() {
        let components: &[&str] = match sample {
            Sample::LatticeTower => &["legs", "bracing", "platforms", "arches", "spire"],
            Sample::Industry => {
                &["halls", "roofs", "tanks", "silos", "conveyor", "chimneys", "cooling towers", "racks", "pipes"]
            }
            Sample::HighRise => &["concrete", "slabs", "facade", "diagrid"],
            Sample::Staircase => &["steps", "walls", "piers", "lamp"],
            Sample::Town => {
                &["house 1", "house 80", "church", "town hall", "wall 1", "tower 1", "gate south", "shed 1"]
            }
            Sample::TownByNight => &["house 1", "church", "lamp 1", "lamp 20"],
        };
        let names: BTreeSet<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
        assert_eq!(names.len(), scene.objects.len(), "names in {sample:?} are unique");
        for component in components {
            assert!(names.contains(component), "{sample:?} has no {component:?}: {names:?}");
        }
    }
    let town = Sample::Town.scene();
    let houses = town.objects.iter().filter(|object| object.name.starts_with("house ")).count();
    assert!((60..=125).contains(&houses), "{houses} houses");
    for place in ["court", "garden", "churchyard", "market", "street"] {
        let prefix = format!("trees {place} ");
        assert!(town.objects.iter().any(|object| object.name.starts_with(&prefix)), "{place}");
    }
}

#[test]
fn the_staircase_has_its_lamp() {
    let scene = Sample::Staircase.scene();
    assert_eq!(scene.lights.iter().map(|light| light.name.as_str()).collect::<Vec<_>>(), ["top"]);
    assert!(!scene.lights[0].position.is_directional());
}

#[test]
fn the_town_by_night_is_the_town_with_lamps() {
    let (day, night) = (Sample::Town.scene(), Sample::TownByNight.scene());
    assert!(day.lights.is_empty(), "by day there is the sun");
    assert_eq!(night.lights.len(), 20);
    assert_eq!(night.objects.len(), day.objects.len() + 20);
    for (night, day) in night.objects.iter().zip(&day.objects) {
        assert_eq!((&night.name, night.world_from_object), (&day.name, day.world_from_object));
        assert!(night.mesh == day.mesh, "{}", day.name);
    }
}

#[test]
fn only_the_town_has_lamps_to_light() {
    let with_night: Vec<_> = Sample::value_variants().iter().filter(|sample| sample.by_night().is_some()).collect();
    assert_eq!(with_night, [&Sample::Town]);
}

#[test]
fn a_sample_written_as_glb_and_loaded_again_casts_the_same_shadows() {
    for (sample, scene) in samples() {
        let loaded = load_bytes(&glb_bytes(&scene), Format::Gltf, "sample.glb", None, &LoadOptions::default())
            .expect("what we write can be read");
        assert!(loaded.warnings.is_empty(), "{sample:?}: {:?}", loaded.warnings);
        let loaded = loaded.scene;
        assert_eq!(loaded.origin, scene.origin);
        let materials =
            |scene: &Scene| scene.materials.iter().map(|m| (m.name.clone(), m.base_color)).collect::<Vec<_>>();
        // Loading appends glTF's default material.
        assert!(materials(&loaded).starts_with(&materials(&scene)), "{sample:?}");
        assert_eq!(loaded.objects.len(), scene.objects.len());
        for (found, written) in Caster::of_scene(&loaded).iter().zip(Caster::of_scene(&scene)) {
            assert_eq!(found.name, written.name);
            assert_eq!(found.mesh.triangles(), written.mesh.triangles(), "{sample:?}, {}", found.name);
            assert_eq!(found.mesh.triangle_materials(), written.mesh.triangle_materials());
            // To the bit: nothing is rounded on the way.
            assert!(found.positions == written.positions, "{sample:?}, {}", found.name);
        }
        assert_eq!(loaded.cameras.len(), scene.cameras.len());
        for (found, written) in loaded.cameras.iter().zip(&scene.cameras) {
            assert_eq!(found.name, written.name);
            assert!(found.eye.distance(written.eye) < 1e-5 && found.forward.distance(written.forward) < 1e-6);
            assert!(found.up.distance(written.up) < 1e-6);
        }
        assert_eq!(loaded.lights.len(), scene.lights.len());
        for (found, written) in loaded.lights.iter().zip(&scene.lights) {
            assert_eq!(found.name, written.name);
            // As they are drawn: JSON may be off by the last bit of a double.
            assert_eq!(found.position.rounded_to_f32(), written.position.rounded_to_f32());
            assert!(found.strength.distance(written.strength) < 1e-3, "{found:?}");
            assert_eq!(found.range_m, written.range_m);
            assert_eq!(found.cone.is_some(), written.cone.is_some(), "{found:?}");
            for (found, written) in found.cone.iter().zip(&written.cone) {
                assert!(found.axis.distance(written.axis) < 1e-6, "{found:?}");
                assert!(
                    (found.inner_rad - written.inner_rad).abs() + (found.outer_rad - written.outer_rad).abs() < 1e-12
                );
            }
        }
    }
}

#[test]
fn objects_that_share_a_mesh_share_it_in_the_file() {
    let town = Sample::Town.scene();
    let glb = glb_bytes(&town);
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).expect("the first chunk is JSON");
    let count = |key: &str| json[key].as_array().map_or(0, Vec::len);
    let trees = town.objects.iter().filter(|object| object.name.starts_with("trees ")).count();
    assert!(trees > 90, "{trees} trees");
    // Six kinds of trees; everything else is there once.
    assert_eq!(count("nodes") - count("meshes"), trees - 6);
}
