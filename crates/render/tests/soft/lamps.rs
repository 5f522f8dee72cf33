//! Balls and rectangles of light.

use glam::{DVec3, Vec3};
use umbrae_core::{Extent, Light, LightPosition, shapes};

use crate::stage::{Stage, camera, cuboid, light};

fn ball(at: [f64; 3], radius_m: f64) -> Light {
    light("ball", LightPosition::point(DVec3::from(at)), Extent::Sphere { radius_m })
}

/// Shines down.
fn panel(at: [f64; 3], [half_x, half_y]: [f64; 2]) -> Light {
    let extent = Extent::Rectangle { half_right: DVec3::Y * half_y, half_up: DVec3::X * half_x };
    light("panel", LightPosition::point(DVec3::from(at)), extent)
}

/// Level, at this height, so that every light has the same silhouette of it.
fn plate(height_m: f32, [x, y]: [f32; 2], half_m: f32) -> umbrae_core::Surface {
    let corner = Vec3::new(x - half_m, y - half_m, height_m);
    shapes::sheet(corner, Vec3::X * (2.0 * half_m), Vec3::Y * (2.0 * half_m), [1, 1])
}

#[test]
fn a_plate_under_a_ball_is_as_rays_find_it() {
    let stage = Stage::new(vec![plate(1.5, [0.2, 0.1], 0.7)]);
    let camera = camera([5.0, -6.0, 6.0], [0.0, 0.0, 0.0], 0.7, [160, 120]);
    stage.assert_like_rays(&camera, &ball([0.3, -0.4, 4.0], 0.5), (0.003, 0.03));
}

#[test]
fn a_plate_under_a_panel_is_as_rays_find_it() {
    let stage = Stage::new(vec![plate(1.5, [0.2, 0.1], 0.7)]);
    let camera = camera([5.0, -6.0, 6.0], [0.0, 0.0, 0.0], 0.7, [160, 120]);
    stage.assert_like_rays(&camera, &panel([0.3, -0.4, 4.0], [0.5, 0.9]), (0.003, 0.03));
}

#[test]
fn a_plate_nearer_to_the_light_than_its_radius_is_as_rays_find_it() {
    // From further away, the disc that faces the point is cut by the plate.
    let camera = camera([3.4, -4.0, 2.5], [0.3, -0.4, 0.0], 0.35, [120, 90]);
    for light in [ball([0.3, -0.4, 4.0], 1.0), panel([0.3, -0.4, 4.0], [0.9, 0.7])] {
        let stage = Stage::new(vec![plate(3.6, [0.1, -0.2], 0.4)]);
        stage.assert_like_rays(&camera, &light, (0.006, 0.04));
    }
}

#[test]
fn a_post_that_rises_past_the_light_shades_with_what_is_below_it() {
    let stage = Stage::new(vec![cuboid([1.5, 0.5, 0.0], [1.6, 0.6, 9.0])]);
    let camera = camera([-5.0, -6.0, 6.0], [2.0, 0.0, 0.0], 0.9, [160, 120]);
    for light in [ball([0.0, 0.0, 3.0], 0.4), panel([0.0, 0.0, 3.0], [0.4, 0.3])] {
        stage.assert_like_rays(&camera, &light, (0.003, 0.05));
    }
}

#[test]
fn a_round_body_of_many_edges_is_as_rays_find_it() {
    let stage = Stage::new(vec![shapes::icosphere(Vec3::new(0.0, 0.0, 1.5), 0.8, 3)]);
    let camera = camera([5.0, -6.0, 6.0], [0.0, 0.0, 0.0], 0.7, [160, 120]);
    stage.assert_like_rays(&camera, &ball([0.3, -0.4, 5.0], 0.3), (0.004, 0.08));
}

#[test]
fn where_no_edge_is_seen_in_front_of_the_light_it_is_seen_whole_or_not_at_all() {
    let stage = Stage::new(vec![plate(1.5, [0.0, 0.0], 1.5)]);
    let camera = camera([3.0, -9.0, 1.2], [0.0, 0.0, 0.0], 0.4, [160, 120]);
    for light in [ball([0.3, -0.4, 4.0], 0.2), panel([0.3, -0.4, 4.0], [0.2, 0.1])] {
        let (seen, truth) = (stage.seen(&camera, &light), stage.truth(&camera, &light, 16));
        let mut dark = 0;
        for (seen, truth) in seen.iter().zip(&truth) {
            match truth {
                Some(0.0) => {
                    dark += 1;
                    assert!(*seen < 0.02, "{seen} in the umbra");
                }
                Some(1.0) => assert!(*seen > 0.98, "{seen} in full light"),
                _ => {}
            }
        }
        let whole = seen.iter().filter(|&&seen| seen == 0.0).count();
        assert!(dark > 500 && whole > dark * 9 / 10, "{whole} are exactly 0 of {dark}");
    }
}

/// What each leaves is known from pictures with one of them.
#[test]
fn two_casters_cover_no_less_than_the_larger_and_no_more_than_both() {
    let (first, second) = (plate(1.5, [0.0, 0.0], 0.6), plate(2.2, [0.5, 0.3], 0.5));
    let camera = camera([5.0, -6.0, 6.0], [0.0, 0.0, 0.0], 0.5, [160, 120]);
    for light in [ball([0.3, -0.4, 4.0], 0.5), panel([0.3, -0.4, 4.0], [0.6, 0.5])] {
        let covered = |bodies: Vec<umbrae_core::Surface>| -> Vec<f32> {
            Stage::new(bodies).seen(&camera, &light).into_iter().map(|seen| 1.0 - seen).collect()
        };
        let (of_first, of_second) = (covered(vec![first.clone()]), covered(vec![second.clone()]));
        let both = Stage::new(vec![first.clone(), second.clone()]);
        let of_both = both.seen(&camera, &light);
        let truth = both.truth(&camera, &light, 24);
        let mut overlaps = 0;
        let mut errors = Vec::new();
        for i in 0..of_both.len() {
            let Some(truth) = truth[i] else { continue };
            errors.push((f64::from(of_both[i]) - truth).abs());
            let (a, b, c) = (of_first[i], of_second[i], 1.0 - of_both[i]);
            if a.min(b) > 0.05 && a.max(b) < 0.95 && (1.0 - f64::from(c) - truth).abs() < 0.3 {
                overlaps += 1;
                assert!(c > a.max(b) - 0.01 && c < (a + b).min(1.0) + 0.01, "{c} of {a} and {b}");
            }
        }
        errors.sort_by(f64::total_cmp);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let worst = errors[errors.len() - 1];
        println!("{overlaps} overlaps, mean error {mean}, worst {worst}");
        assert!(overlaps > 100 && mean < 0.004, "{overlaps} pixels, mean error {mean}");
    }
}
