//! The street lamps of the town by night: lanterns on posts, and hoods on arms that light only what is below them.
//!
//! A lantern is open but for its roof and its foot, and a hood is open below: the lamp is in the free air inside, and its shade casts.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use umbrae_core::{Cone, Light, LightPosition, Mesh, shapes};

use super::layout;
use crate::random::Random;
use crate::sample::model::{Model, Paint, Parts, standing};

const SEED: u64 = 20;

/// Where the lamp is, over the foot of its post.
const IN_LANTERN: Vec3 = Vec3::new(0.0, 0.0, 4.55);
/// As [`IN_LANTERN`], at the end of an arm that points east.
const IN_HOOD: Vec3 = Vec3::new(1.3, 0.0, 5.53);

/// Linear colours.
const WARM: Vec3 = Vec3::new(1.0, 0.68, 0.32);
const RED: Vec3 = Vec3::new(1.0, 0.16, 0.08);
const GREEN: Vec3 = Vec3::new(0.25, 1.0, 0.40);
const BLUE: Vec3 = Vec3::new(0.25, 0.45, 1.0);
const WHITE: Vec3 = Vec3::new(1.0, 0.93, 0.82);

/// Beyond the rim of the hood, so that its edge is seen and not the hood's.
const OUTER_DEG: f64 = 62.0;
const INNER_DEG: f64 = 44.0;

#[derive(Debug, Clone, Copy)]
enum Shade {
    Lantern,
    Hood,
}

/// Where each stands, whereto its arm points (any length), and its colour.
fn places() -> [(Shade, Vec2, Vec2, Vec3); 20] {
    let beside_row = |row, column, share, side, color| {
        let (at, to_street) = layout::beside_row(row, column, share, side);
        (Shade::Lantern, at, to_street, color)
    };
    let beside_column = |column, row, share, side, color| {
        let (at, to_street) = layout::beside_column(column, row, share, side);
        (Shade::Lantern, at, to_street, color)
    };
    let hood = |x, y, to_x, to_y, color| (Shade::Hood, Vec2::new(x, y), Vec2::new(to_x, to_y), color);
    [
        // The avenue, midway between its trees.
        beside_row(2, 0, 0.4, 1.0, WARM),
        beside_row(2, 1, 0.2, -1.0, WARM),
        beside_row(2, 1, 0.6, 1.0, WARM),
        beside_row(2, 3, 0.2, -1.0, WARM),
        beside_row(2, 3, 0.6, 1.0, WARM),
        // The street to the south of the market.
        beside_row(1, 0, 0.5, 1.0, WARM),
        beside_row(1, 1, 0.5, -1.0, WARM),
        beside_row(1, 2, 0.35, -1.0, WARM),
        beside_row(1, 3, 0.45, 1.0, GREEN),
        // The street to the north of the church.
        beside_row(3, 0, 0.55, -1.0, WARM),
        beside_row(3, 1, 0.5, 1.0, BLUE),
        beside_row(3, 2, 0.5, 1.0, WARM),
        // Streets to the gates, and across.
        beside_column(2, 0, 0.5, 1.0, RED),
        beside_column(2, 3, 0.5, -1.0, WARM),
        beside_column(1, 1, 0.5, 1.0, WARM),
        beside_column(3, 2, 0.6, -1.0, WARM),
        // The market.
        hood(17.5, -19.0, -1.0, -0.6, WHITE),
        hood(33.0, -24.0, -1.0, 0.0, WHITE),
        hood(8.0, -36.0, 0.4, 1.0, RED),
        hood(27.0, -37.5, 0.0, 1.0, BLUE),
    ]
}

/// Adds "lamp 1" to "lamp 20", posts and lights alike, and a camera "market" among them.
pub(super) fn add(model: &mut Model) {
    model.add_camera("market", DVec3::new(42.0, -43.0, 9.0), DVec3::new(8.0, -18.0, 3.0), 60.0);
    let iron = model.paint("iron", [0.06, 0.06, 0.07]);
    let lantern = Arc::new(lantern(iron).into_mesh());
    let hood = Arc::new(hood(iron).into_mesh());
    let mut random = Random::new(SEED);
    for (number, (shade, at, arm, color)) in (1..).zip(places()) {
        let name = format!("lamp {number}");
        let (mesh, lamp, intensity_cd, range_m) = match shade {
            Shade::Lantern => (&lantern, IN_LANTERN, random.between(260.0, 380.0), half_metres(&mut random, 12, 16)),
            Shade::Hood => (&hood, IN_HOOD, random.between(420.0, 560.0), half_metres(&mut random, 15, 18)),
        };
        let world_from_lamp = standing(at, arm.to_angle(), 1.0);
        // Rounded as files have it.
        let position = world_from_lamp.transform_point3(lamp.as_dvec3()).as_vec3().as_dvec3();
        model.place(name.clone(), Arc::<Mesh>::clone(mesh), world_from_lamp);
        model.add_light(Light {
            cone: match shade {
                Shade::Lantern => None,
                Shade::Hood => Some(Cone {
                    axis: DVec3::NEG_Z,
                    inner_rad: INNER_DEG.to_radians(),
                    outer_rad: OUTER_DEG.to_radians(),
                }),
            },
            range_m: Some(range_m),
            ..Light::new(name, LightPosition::point(position), color * intensity_cd)
        });
    }
}

/// From `low` to `high`, in steps that files hold exactly.
fn half_metres(random: &mut Random, low: u8, high: u8) -> f64 {
    let steps: Vec<u8> = (2 * low..=2 * high).collect();
    0.5 * f64::from(random.pick(&steps))
}

/// A post with a lantern of four bars under a roof, 5 m high; 170 triangles.
fn lantern(iron: Paint) -> Parts {
    let mut parts = Parts::default();
    let post = [(0.17, 0.0), (0.17, 0.3), (0.1, 0.42), (0.06, 1.0), (0.045, 4.1), (0.075, 4.18), (0.075, 4.22)];
    parts.add(iron, shapes::revolution(Vec3::ZERO, &post.map(Vec2::from), 8));
    for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        let corner = |out: f32, z: f32| Vec3::new(out * x, out * y, z);
        parts.add(iron, shapes::strut(corner(0.04, 4.2), corner(0.16, 4.8), 0.012, 4));
    }
    let roof = [(0.27, 4.78), (0.27, 4.81), (0.06, 4.98), (0.06, 5.03), (0.0, 5.12)].map(Vec2::from);
    parts.add(iron, shapes::revolution(Vec3::ZERO, &roof, 8));
    parts
}

/// A mast with an arm to the east and a hood at its end, open below, 6 m high; 150 triangles.
fn hood(iron: Paint) -> Parts {
    let mut parts = Parts::default();
    let foot = [(0.18, 0.0), (0.18, 0.35), (0.08, 0.5), (0.07, 0.9)].map(Vec2::from);
    parts.add(iron, shapes::revolution(Vec3::ZERO, &foot, 8));
    let mast = [(0.0, 0.05), (0.0, 5.3), (0.3, 5.7), (1.3, 5.85)].map(|(x, z)| Vec3::new(x, 0.0, z));
    parts.add(iron, shapes::tube(&mast, 0.05, 6));
    // From the middle of the hollow to its rim, and over the outside to the top.
    let bell = [(0.0, 5.72), (0.14, 5.7), (0.27, 5.45), (0.3, 5.45), (0.17, 5.76), (0.08, 5.9), (0.0, 5.92)];
    parts.add(iron, shapes::revolution(IN_HOOD.with_z(0.0), &bell.map(Vec2::from), 10));
    parts
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use umbrae_core::{Caster, Windings, distance_to_triangle};

    use super::*;
    use crate::sample::Sample;

    /// From `p` to the surface of `caster`; infinite where it is further than 3 m.
    fn distance_to_caster(p: DVec3, caster: &Caster) -> f64 {
        let nearest_in_box = p.clamp(caster.bounds.min, caster.bounds.max);
        if p.distance(nearest_in_box) > 3.0 {
            return f64::INFINITY;
        }
        let triangles = 0..caster.mesh.triangles().len();
        let distances = triangles.map(|t| distance_to_triangle(p, caster.corners(t).map(Vec3::as_dvec3)));
        distances.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn every_lamp_shines_in_free_air() {
        let scene = Sample::TownByNight.scene();
        let casters = Caster::of_scene(&scene);
        let far_away = DVec3::splat(1e4);
        let mut near = Vec::new();
        for light in &scene.lights {
            let p = light.position.homogeneous().truncate();
            for caster in &casters {
                let is_outside = Windings::of_point(caster, p) == Windings::of_point(caster, far_away);
                assert!(is_outside, "{} is in {}", light.name, caster.name);
                let least = if caster.name == light.name { 0.05 } else { 0.8 };
                let distance = distance_to_caster(p, caster);
                if distance < least {
                    near.push(format!("{} is {distance:.2} m from {}", light.name, caster.name));
                }
            }
        }
        assert!(near.is_empty(), "{near:#?}");
    }

    #[test]
    fn every_lamp_post_stands_clear_of_everything_else() {
        let scene = Sample::TownByNight.scene();
        let casters = Caster::of_scene(&scene);
        let mut near = Vec::new();
        for post in casters.iter().filter(|caster| caster.name.starts_with("lamp ")) {
            let foot = post.positions[0].as_dvec3().with_z(0.0);
            for other in casters.iter().filter(|other| other.name != post.name) {
                let heights = (0..24).map(|i| foot.with_z(0.25 * f64::from(i)));
                let distance = heights.map(|p| distance_to_caster(p, other)).fold(f64::INFINITY, f64::min);
                if distance < 0.4 {
                    near.push(format!("{} is {distance:.2} m from {}", post.name, other.name));
                }
            }
        }
        assert!(near.is_empty(), "{near:#?}");
    }

    #[test]
    fn the_lamps_are_warm_lanterns_with_a_few_coloured_ones_and_hoods_that_shine_down() {
        let lights = Sample::TownByNight.scene().lights;
        let is_spot = |light: &&Light| light.cone.is_some_and(|cone| cone.axis == DVec3::NEG_Z);
        assert_eq!(lights.iter().filter(is_spot).count(), 4);
        assert_eq!(lights.iter().filter(|light| light.cone.is_none()).count(), 16);
        let is_warm = |light: &&Light| light.strength.x > light.strength.y && light.strength.y > 2.0 * light.strength.z;
        assert!((12..=16).contains(&lights.iter().filter(is_warm).count()));
        for light in &lights {
            assert!(light.range_m.is_some_and(|range| (12.0..=18.0).contains(&range)), "{light:?}");
        }
    }
}
