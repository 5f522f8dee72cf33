//! The number from which z-pass starts is that of the volumes around every point of the near rectangle.

use std::cell::Cell;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use umbrae_core::{
    Camera, Case, CaseChooser, Caster, Chain, Counting, LightPosition, Mesh, Object, ShadowVolume, Surface, Topology,
    shapes,
};

fn caster(surface: Surface) -> Option<Caster> {
    let mesh = Arc::new(Mesh::new(surface).ok()?);
    let topology = Arc::new(Topology::new(&mesh));
    Some(Caster::new(&Object::new("", mesh, DAffine3::IDENTITY), topology))
}

struct Counted {
    count: Option<u32>,
    case: Case,
    volume: ShadowVolume,
}

fn counted(camera: &Camera, caster: &Caster, light: LightPosition) -> Counted {
    let chain = Chain::new(caster, light, &Counting::outside(caster));
    let volume = ShadowVolume::new(caster, &chain);
    let chooser = CaseChooser::new(camera, light, &caster.bounds);
    Counted { count: chooser.eye_count(caster, &chain, &volume), case: chooser.case(caster), volume }
}

fn spheres(k: u32) -> Caster {
    let sphere = |i: u32| shapes::icosphere(Vec3::new(0.0, 0.0, 10.0 + i as f32 * 3.0), 1.0 + 0.1 * i as f32, 2);
    caster(shapes::joined((0..k).map(sphere))).expect("spheres are good")
}

#[test]
fn an_eye_under_a_row_of_spheres_is_in_as_many_volumes() {
    let camera = Camera::new(DVec3::ZERO, DVec3::Y, 0.8, 0.1, [64, 48]).expect("a good camera");
    let lights = [
        LightPosition::point(DVec3::new(0.0, 0.0, 100.0)),
        LightPosition::directional(DVec3::Z).expect("up"),
        LightPosition::directional(DVec3::new(0.01, 0.003, 1.0)).expect("up"),
    ];
    for (k, light) in (1..6).flat_map(|k| lights.map(|light| (k, light))) {
        assert_eq!(counted(&camera, &spheres(k), light).count, Some(k), "{light:?}");
    }
}

#[test]
fn a_sun_or_lamp_in_the_near_plane_still_shades_only_what_is_between() {
    // The picture is upright and the light overhead, so that it is in the plane of the near rectangle.
    let camera = Camera::new(DVec3::ZERO, DVec3::Y, 0.8, 0.5, [64, 48]).expect("a good camera");
    for light in [
        LightPosition::point(DVec3::new(0.0, 0.5, 100.0)),
        LightPosition::directional(DVec3::Z).expect("up"),
        LightPosition::point(DVec3::new(0.01, 0.5, 0.02)),
    ] {
        let cube = |x: f64| {
            let at = Vec3::new(x as f32, 0.5, 10.0);
            counted(&camera, &caster(shapes::cuboid(at - 2.0, at + 2.0)).expect("a box"), light)
        };
        let above = cube(0.0);
        let is_within = light.homogeneous().z > 0.0 && light.homogeneous().z < 1.0 && !light.is_directional();
        assert_eq!(above.count, Some(if is_within { 0 } else { 1 }), "{light:?}");
        assert_eq!(above.case == Case::Pass, is_within, "{light:?}");
        assert_eq!((cube(5.0).count, cube(5.0).case), (Some(0), Case::Pass), "{light:?}");
    }
}

#[test]
fn an_eye_beside_the_shadow_is_in_none_and_one_at_its_edge_has_no_number() {
    let light = LightPosition::point(DVec3::new(0.0, 0.0, 100.0));
    let camera = |x: f64| {
        let eye = DVec3::new(x, 0.0, 0.0);
        Camera::new(eye, eye + DVec3::Y, 0.8, 0.1, [64, 48]).expect("a good camera")
    };
    let sphere = spheres(1);
    assert_eq!(counted(&camera(3.0), &sphere, light).count, Some(0));
    // The shadow's radius at the eye is a little above 1.1 m, and the rectangle is 0.11 m wide.
    let across = (0..200).map(|i| counted(&camera(1.0 + 0.002 * f64::from(i)), &sphere, light).count);
    let mut numbers: Vec<Option<u32>> = across.collect();
    numbers.dedup();
    assert_eq!(numbers, [Some(1), None, Some(0)]);
}

#[test]
fn an_eye_that_is_in_shadow_while_its_near_rectangle_is_not_starts_from_none() {
    let light = LightPosition::point(DVec3::new(0.0, 0.0, 100.0));
    // The shadow ends between the eye and the rectangle.
    let camera = Camera::new(DVec3::new(0.0, 0.8, 0.0), DVec3::Y * 2.0, 0.3, 0.6, [64, 48]).expect("a good camera");
    assert_eq!(counted(&camera, &spheres(1), light).count, Some(0));
}

#[test]
fn a_body_cut_by_the_near_rectangle_has_no_number() {
    let camera = Camera::new(DVec3::ZERO, DVec3::Y, 0.8, 1.0, [64, 48]).expect("a good camera");
    // The rectangle is 0.85 m high, so the box's upper side cuts through it, with all edges far away.
    let cut = caster(shapes::cuboid(Vec3::new(-9.0, -9.0, -9.0), Vec3::new(9.0, 9.0, 0.1))).expect("a box");
    let light = LightPosition::directional(DVec3::new(0.1, 0.2, 1.0)).expect("a direction");
    assert_eq!(counted(&camera, &cut, light).count, None);
}

#[derive(Debug, Clone)]
struct Setting {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u8; 3]>,
    light: LightPosition,
    camera: Camera,
    places: Vec<[f64; 2]>,
    direction: [f64; 3],
}

fn setting() -> impl Strategy<Value = Setting> {
    let xyz = |size: f64| [-size..size, -size..size, -size..size];
    let light = prop_oneof![
        2 => xyz(9.0).prop_map(|p| LightPosition::point(p.into())),
        1 => xyz(1.0).prop_filter_map("no direction", |d| LightPosition::directional(d.into())),
    ];
    let camera = (xyz(6.0), xyz(6.0), 0.2..1.5_f64, -2.5..0.3_f64)
        .prop_filter_map("eye at target", |(eye, target, fov, near)| {
            Camera::new(eye.into(), target.into(), fov, 10_f64.powf(near), [32, 24]).ok()
        });
    let positions = prop::collection::vec(xyz(5.0), 4..24);
    let triangles = prop::collection::vec(any::<[u8; 3]>(), 1..16);
    (positions, triangles, light, camera, prop::collection::vec([0.0..1.0, 0.0..1.0_f64], 8), xyz(1.0)).prop_map(
        |(positions, triangles, light, camera, places, direction)| Setting {
            positions,
            triangles,
            light,
            camera,
            places,
            direction,
        },
    )
}

#[test]
fn every_point_of_the_near_rectangle_of_any_setting_is_in_that_many_volumes() {
    let counts = Cell::new([0; 4]);
    let config = Config { cases: 6_000, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[6; 32]);
    let check = |setting: Setting| {
        let n = setting.positions.len() as u32;
        let surface = Surface {
            positions: setting.positions.iter().map(|p| DVec3::from(*p).as_vec3()).collect(),
            triangles: setting.triangles.iter().map(|t| t.map(|i| u32::from(i) % n)).collect(),
            ..Surface::default()
        };
        let Some(caster) = caster(surface) else { return Ok(()) };
        let counted = counted(&setting.camera, &caster, setting.light);
        let [a, b, _, d] = setting.camera.near_rectangle();
        let at = |[x, y]: [f64; 2]| {
            let place = a + (b - a) * x + (d - a) * y;
            counted.volume.count_to_infinity(&caster.positions, setting.light, place, setting.direction.into())
        };
        let true_counts: Vec<i32> = setting.places.iter().filter_map(|&place| at(place)).collect();
        let mut seen = counts.get();
        match counted.count {
            Some(count) => {
                prop_assert!(true_counts.iter().all(|&n| n == count as i32), "{count}, but {true_counts:?}");
                seen[(count as usize).min(2)] += 1;
            }
            None => seen[3] += 1,
        }
        if counted.case == Case::Pass {
            prop_assert_eq!(counted.count, Some(0));
        }
        counts.set(seen);
        Ok(())
    };
    TestRunner::new_with_rng(config, rng).run(&setting(), check).expect("it holds in every setting");
    let [none, one, more, crossed] = counts.get();
    println!("{none} in no volume, {one} in one, {more} in more, {crossed} crossed by a side");
    assert!(none.min(one).min(more).min(crossed) > 50);
}
