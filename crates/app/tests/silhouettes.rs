//! Every finder on the CPU finds the same silhouettes on every real model, under 64 lights each: the boundary of the chain.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod data;

use glam::DVec3;
use rayon::prelude::*;
use umbrae::sample::Sample;
use umbrae_core::{Bounds, Caster, Counting, Finder, FinderKind, Found, LightPosition, Scene, silhouette};
use umbrae_formats::{LoadOptions, load};

const LIGHTS: usize = 64;

/// Suns, lamps far and near, inside the box, and in the plane of a triangle.
fn lights(scene: &Scene, casters: &[Caster]) -> Vec<LightPosition> {
    let bounds = Caster::bounds_of(casters);
    let corners = |i: usize| {
        let caster = &casters[i % casters.len()];
        let count = caster.mesh.triangles().len();
        caster.corners((i * 7919) % count).map(glam::Vec3::as_dvec3)
    };
    (0..LIGHTS)
        .map(|i| {
            // As Fibonacci has them on a sphere.
            let height = 1.0 - 2.0 * (i as f64 + 0.5) / LIGHTS as f64;
            let (sin, cos) = (2.399_963 * i as f64).sin_cos();
            let flat = (1.0 - height * height).sqrt();
            let way = DVec3::new(cos * flat, sin * flat, height);
            match i % 5 {
                0 => LightPosition::directional(way).unwrap(),
                1 => LightPosition::point(bounds.center() + way * 50.0 * bounds.radius()),
                2 => LightPosition::point(bounds.center() + way * 1.5 * bounds.radius()),
                3 => LightPosition::point(bounds.center() + way * 0.3 * bounds.radius()),
                _ if scene.triangle_count() > 0 => {
                    let [a, b, c] = corners(i);
                    LightPosition::point(a + 3.0 * (b - a) - 1.5 * (c - a))
                }
                _ => LightPosition::point(Bounds::EMPTY.min),
            }
            .rounded_to_f32()
        })
        .collect()
}

fn sorted(sides: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let mut sides = sides.to_vec();
    sides.sort_unstable();
    sides
}

/// Compares all finders on one caster; returns how many edges they found.
fn compare(caster: &Caster, lights: &[LightPosition], model: &str) -> usize {
    let counting = Counting::outside(caster);
    let finders = FinderKind::ALL.map(|kind| Finder::new(caster, kind));
    let mut founds = FinderKind::ALL.map(|_| Found::default());
    let mut edges = 0;
    for (i, &light) in lights.iter().enumerate() {
        let chain = finders[0].chain(light, &counting);
        let boundary: Vec<[u32; 2]> = silhouette(&caster.topology, &chain)
            .iter()
            .flat_map(|edge| std::iter::repeat_n([edge.start, edge.end], edge.multiplicity as usize))
            .collect();
        let boundary = sorted(&boundary);
        edges += boundary.len();
        for (finder, found) in finders.iter().zip(&mut founds) {
            finder.find(light, found);
            let (name, object) = (finder.kind().name(), &caster.name);
            assert!(sorted(&found.sides) == boundary, "{model}, `{object}`: {name} differs under light {i}");
        }
    }
    edges
}

#[test]
fn every_finder_finds_the_boundary_of_the_chain_of_every_model_under_64_lights() {
    let Some(folder) = data::folder() else { return };
    let mut models: Vec<(String, Scene)> = data::models(&folder)
        .into_iter()
        .map(|path| (path.display().to_string(), load(&path, &LoadOptions::default()).unwrap().scene))
        .collect();
    models.extend([Sample::LatticeTower, Sample::Industry].map(|sample| (format!("{sample:?}"), sample.scene())));
    assert!(models.len() >= 50, "only {} models", models.len());
    let edges: usize = models
        .par_iter()
        .map(|(name, scene)| {
            let casters = Caster::of_scene(scene);
            let lights = lights(scene, &casters);
            let casters = casters.iter().filter(|caster| !caster.mesh.triangles().is_empty());
            casters.map(|caster| compare(caster, &lights, name)).sum::<usize>()
        })
        .sum();
    assert!(edges > 10_000_000, "models have silhouettes: {edges}");
}
