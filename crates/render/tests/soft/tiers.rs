//! Devices that have less, and pictures that have more samples.

use glam::DVec3;
use umbrae_core::{Camera, Extent, Light, LightPosition};
use umbrae_render::{AdapterChoice, Gpu};

use crate::held_to_webgl2::held_to_webgl2;
use crate::stage::{Stage, camera, cuboid, light};

fn scene() -> (Vec<umbrae_core::Surface>, Camera, Light) {
    let bodies = vec![cuboid([-0.5, -0.4, 0.0], [0.5, 0.3, 1.2]), cuboid([0.9, 0.2, 0.0], [1.0, 0.3, 2.0])];
    let camera = camera([4.0, -5.0, 5.0], [0.3, 0.5, 0.0], 0.6, [160, 120]);
    let at = LightPosition::point(DVec3::new(-1.5, -2.5, 4.0));
    (bodies, camera, light("ball", at, Extent::Sphere { radius_m: 0.5 }))
}

#[test]
fn a_device_with_no_more_than_webgl2_finds_the_same_shares() {
    let (bodies, camera, light) = scene();
    let expected = Stage::new(bodies.clone()).seen(&camera, &light);
    let mut asked = 0;
    for backends in [wgpu::Backends::PRIMARY, wgpu::Backends::GL] {
        let Some(gpu) = held_to_webgl2(backends) else { continue };
        asked += 1;
        let label = gpu.label.clone();
        let seen = Stage::on(gpu, bodies.clone(), 1).seen(&camera, &light);
        let far_off = seen.iter().zip(&expected).filter(|(a, b)| (*a - *b).abs() > 0.01).count();
        let worst = seen.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("{label}: worst {worst}, {far_off} by more than 0.01");
        // Another driver draws some edges a pixel further.
        assert!(far_off < seen.len() / 500, "{label}: {far_off} of {} differ, the worst by {worst}", seen.len());
    }
    assert!(asked > 0, "tests need a graphics driver: run scripts/setup.sh");
}

/// Away from edges of surfaces, all samples of a pixel see nearly the same of the light.
#[test]
fn pictures_of_four_samples_have_the_penumbrae_of_those_of_one() {
    let (bodies, camera, light) = scene();
    let light = Light { strength: glam::Vec3::splat(12.0), ..light };
    let picture = |samples: u32| {
        let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default())).unwrap();
        Stage::on(gpu, bodies.clone(), samples).picture(&camera, &light).unwrap()
    };
    let (one, four) = (picture(1), picture(4));
    let mut differences: Vec<u8> = one.iter().zip(&four).map(|(a, b)| a.abs_diff(*b)).collect();
    differences.sort_unstable();
    let shades = one.iter().collect::<std::collections::BTreeSet<_>>().len();
    assert!(shades > 60, "{shades} shades");
    let most = differences[differences.len() * 97 / 100];
    assert!(most <= 3, "all but three of a hundred differ by up to {most}");
}

/// On a level floor under a level plate, light comes back step by small step: no bands, no halo.
#[test]
fn across_a_penumbra_the_light_only_grows() {
    let stage = Stage::new(vec![cuboid([-30.0, -30.0, 1.0], [0.0, 30.0, 1.02])]);
    let at = LightPosition::point(DVec3::new(0.0, 0.0, 4.0));
    let light = light("ball", at, Extent::Sphere { radius_m: 0.6 });
    let camera = camera([4.0, -2.5, 0.9], [0.2, 0.0, 0.0], 0.35, [320, 120]);
    let seen = stage.seen(&camera, &light);
    let mut by_x: Vec<(f64, f32)> = Vec::new();
    for (i, &seen) in seen.iter().enumerate() {
        let direction = camera.ray_direction((i % 320) as f64 + 0.5, (i / 320) as f64 + 0.5);
        let point = camera.eye() - direction * (camera.eye().z / direction.z);
        let is_in_band = direction.z < 0.0 && point.y.abs() < 0.4 && point.x.abs() < 1.0;
        if is_in_band {
            by_x.push((point.x, seen));
        }
    }
    by_x.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(by_x.len() > 500, "{} pixels", by_x.len());
    // The upper rim of the plate's edge makes a difference of its thickness.
    let falls = by_x.windows(2).map(|pair| pair[0].1 - pair[1].1).fold(0.0, f32::max);
    assert!(falls < 0.02, "it falls by {falls}");
    assert!(by_x[0].1 == 0.0 && by_x[by_x.len() - 1].1 == 1.0, "{:?} to {:?}", by_x[0], by_x[by_x.len() - 1]);
}
