//! Smooth volumes of bodies with creases and without, under many lights.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::*;
use crate::{Caster, LightPosition, Mesh, Object, RayCaster, Surface, Topology, shapes};

pub(super) fn caster_of(surface: Surface) -> Caster {
    let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
    let topology = Arc::new(Topology::new(&mesh));
    Caster::new(&Object::new("body", mesh, DAffine3::IDENTITY), topology)
}

const CREASE_RAD: f64 = 0.76;

pub(super) fn body_of(caster: &Caster) -> SmoothBody {
    SmoothBody::new(caster, &corner_normals(caster, &[], CREASE_RAD)).expect("it is round")
}

/// 64 of all kinds: suns, lamps far and near.
pub(super) fn lights() -> impl Iterator<Item = LightPosition> {
    (0..64).map(|i| {
        let (sin, cos) = (0.7 * f64::from(i)).sin_cos();
        let way = DVec3::new(cos, sin, 0.09 * f64::from(i % 21) - 0.9);
        match i % 3 {
            0 => LightPosition::directional(way).expect("not zero"),
            1 => LightPosition::point(30.0 * way),
            _ => LightPosition::point(3.1 * way),
        }
    })
}

/// What is left of the boundary of light cap, folds and fins when the sides are taken away.
fn gaps(caster: &Caster, body: &SmoothBody, volume: &SmoothVolume) -> Vec<([u32; 2], i32)> {
    let (_, flat) = volume.flattened(body, caster);
    let mut sums: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    let mut add = |[a, b]: [u32; 2], times: i32| {
        let (edge, times) = if a < b { ([a, b], times) } else { ([b, a], -times) };
        *sums.entry(edge).or_default() += times;
    };
    for [a, b, c] in flat.light_cap {
        [[a, b], [b, c], [c, a]].into_iter().for_each(|edge| add(edge, 1));
    }
    flat.sides.into_iter().for_each(|side| add(side, -1));
    sums.into_iter().filter(|(_, times)| *times != 0).collect()
}

fn smooth(epsilon_m: f64) -> Smoothness {
    Smoothness::Smooth(Precision::in_world(epsilon_m))
}

pub(super) fn bodies() -> Vec<(&'static str, Caster)> {
    vec![
        ("icosahedron", caster_of(shapes::icosphere(Vec3::ZERO, 1.0, 0))),
        ("sphere", caster_of(shapes::icosphere(Vec3::ZERO, 1.0, 2))),
        ("torus", caster_of(shapes::torus(Vec3::ZERO, 1.5, 0.5, 12, 8))),
        ("cylinder", caster_of(shapes::cylinder(Vec3::ZERO, 1.0, 2.0, 12))),
        ("cone", caster_of(shapes::cone(Vec3::ZERO, 0.5, 1.5, 12))),
        ("tube", caster_of(shapes::tube(&[Vec3::ZERO, Vec3::X, Vec3::new(1.5, 1.0, 0.5)], 0.3, 10))),
    ]
}

#[test]
fn volumes_are_closed_under_every_light() {
    for (name, caster) in bodies() {
        let body = body_of(&caster);
        for (i, light) in lights().enumerate() {
            for smoothness in [Smoothness::Accurate, smooth(0.01), smooth(1e-4)] {
                let volume = SmoothVolume::new(&body, light, &smoothness);
                assert_eq!(gaps(&caster, &body, &volume), [], "{name} under light {i}, {smoothness:?}");
                let walked: usize = volume.loops().iter().map(Vec::len).sum();
                assert_eq!(walked, volume.sides.len());
                assert!(!volume.sides.is_empty());
            }
        }
    }
}

/// Numbers from -1 to 1, the same on every run.
pub(super) fn random() -> impl FnMut() -> f32 {
    let mut seed = 1_u64;
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    }
}

/// `caster` with any normals at all.
fn with_random_normals(caster: &Caster, random: &mut impl FnMut() -> f32) -> SmoothBody {
    let normals: Vec<[Vec3; 3]> = (0..caster.mesh.triangles().len())
        .map(|_| std::array::from_fn(|_| Vec3::new(random(), random(), random()).normalize_or_zero()))
        .collect();
    SmoothBody::new(caster, &normals).expect("they are not flat")
}

#[test]
fn random_normals_leave_volumes_closed() {
    let mut random = random();
    for (name, caster) in bodies() {
        let body = with_random_normals(&caster, &mut random);
        for (i, light) in lights().enumerate() {
            let volume = SmoothVolume::new(&body, light, &smooth(0.01));
            assert_eq!(gaps(&caster, &body, &volume), [], "{name} under light {i}");
        }
    }
}

#[test]
fn behind_a_body_no_count_is_below_0_whatever_its_normals() {
    let mut random = random();
    let (mut decided, mut dark) = (0, 0);
    for (name, caster) in bodies() {
        for body in [body_of(&caster), with_random_normals(&caster, &mut random)] {
            for (i, light) in lights().enumerate().step_by(7) {
                let volume = SmoothVolume::new(&body, light, &smooth(0.01));
                let (positions, flat) = volume.flattened(&body, &caster);
                let way = light.offset_from(DVec3::ZERO).normalize_or_zero();
                for _ in 0..100 {
                    let beside = DVec3::new(random().into(), random().into(), random().into()) * 2.0;
                    let behind = beside - way * (way.dot(beside) + 7.0);
                    let count = flat.count_to_infinity(&positions, light, behind, DVec3::new(0.3, 0.2, 0.1));
                    assert!(count.is_none_or(|count| count >= 0), "{name}: {count:?} under light {i} at {behind}");
                    decided += usize::from(count.is_some());
                    dark += usize::from(count.is_some_and(|count| count > 0));
                }
            }
        }
    }
    assert!(decided > 10_000 && dark > 1_000, "{decided} counts, {dark} of them in the dark");
}

#[test]
fn volumes_made_on_all_threads_at_once_are_those_made_one_by_one() {
    let body = body_of(&caster_of(shapes::torus(Vec3::ZERO, 1.0, 0.4, 48, 24)));
    let lights: Vec<LightPosition> = lights().collect();
    let make = |light: &LightPosition| SmoothVolume::new(&body, *light, &smooth(0.001));
    let one_by_one: Vec<SmoothVolume> = lights.iter().map(make).collect();
    // More threads than there may be processors, so that some wait for others, and are given more to do meanwhile.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(8).build().expect("there is room for threads");
    for _ in 0..10 {
        let at_once: Vec<SmoothVolume> = pool.install(|| lights.par_iter().map(make).collect());
        assert!(at_once == one_by_one);
    }
}

#[test]
fn a_sphere_of_eighty_triangles_has_a_round_silhouette() {
    for subdivisions in [1, 2, 3] {
        let caster = caster_of(shapes::icosphere(Vec3::ZERO, 1.0, subdivisions));
        let body = body_of(&caster);
        for light in lights().filter(|light| light.is_directional()) {
            let volume = SmoothVolume::new(&body, light, &smooth(0.01));
            let way = light.offset_from(DVec3::ZERO);
            for corners in volume.loops() {
                for p in corners {
                    let p = volume.points[p as usize].as_dvec3();
                    let across = (p - way * way.dot(p)).length();
                    assert!((across - 1.0).abs() < 0.004, "{across} from the axis, after {subdivisions} subdivisions");
                }
            }
            assert_eq!(volume.loops().len(), 1);
        }
    }
}

#[test]
fn the_rim_of_a_cylinder_is_a_circle_seen_from_above() {
    let caster = caster_of(shapes::cylinder(Vec3::ZERO, 1.0, 2.0, 12));
    let body = body_of(&caster);
    let sun = LightPosition::directional(DVec3::new(0.3, 0.1, 1.0)).expect("not zero");
    let volume = SmoothVolume::new(&body, sun, &smooth(1e-3));
    let on_rim = volume.sides.iter().flatten().map(|&p| volume.points[p as usize]).filter(|p| p.z > 1.999);
    let radii: Vec<f64> = on_rim.map(|p| DVec2::new(p.x.into(), p.y.into()).length()).collect();
    assert!(radii.len() > 20 && radii.iter().all(|r| (r - 1.0).abs() < 1e-4), "{radii:?}");
}

#[test]
fn what_has_flat_faces_or_no_inside_is_left_alone() {
    let cube = caster_of(shapes::cuboid(-Vec3::ONE, Vec3::ONE));
    assert_eq!(SmoothBody::new(&cube, &corner_normals(&cube, &[], CREASE_RAD)).err(), Some(NotSmooth::Flat));
    let inside_out = shapes::icosphere(Vec3::ZERO, 1.0, 1);
    let triangles = inside_out.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let inside_out = caster_of(Surface { triangles, ..inside_out });
    let normals = corner_normals(&inside_out, &[], CREASE_RAD);
    assert_eq!(SmoothBody::new(&inside_out, &normals).err(), Some(NotSmooth::InsideOut));
    let sheet = caster_of(shapes::sheet(Vec3::ZERO, Vec3::X, Vec3::Y, [2, 2]));
    assert_eq!(SmoothBody::new(&sheet, &corner_normals(&sheet, &[], CREASE_RAD)).err(), Some(NotSmooth::Open));
}

#[test]
fn counts_are_within_the_bound_and_the_same_on_every_path() {
    let mut decided = 0;
    for (name, caster) in bodies() {
        let body = body_of(&caster);
        for (i, light) in lights().enumerate().step_by(5) {
            let volume = SmoothVolume::new(&body, light, &smooth(0.01));
            let most = volume.most_overlaps(&body, &caster, light, 0) as i32;
            let (positions, flat) = volume.flattened(&body, &caster);
            for k in 0..40 {
                let way = f64::from(k) * 2.4;
                let point = DVec3::new(way.cos(), way.sin(), (1.7 * way).sin()) * (0.3 + 0.08 * f64::from(k));
                let counts = [DVec3::new(0.3, 0.2, 0.9), DVec3::new(-0.5, 0.8, -0.1), DVec3::new(0.1, -0.4, -0.7)]
                    .map(|direction| flat.count_to_infinity(&positions, light, point, direction));
                let known: Vec<i32> = counts.into_iter().flatten().collect();
                decided += known.len();
                assert!(known.iter().all(|&c| c == known[0]), "{name} under light {i} at {point}: {counts:?}");
                assert!(known.iter().all(|c| c.abs() <= most), "{name} under light {i}: {counts:?} above {most}");
            }
        }
    }
    assert!(decided > 8000, "{decided} counts");
}

/// A sphere, one of whose vertices has a normal that is turned away where it is most lit.
#[test]
fn a_normal_that_is_turned_away_tears_no_hole_into_the_shadow() {
    let sphere = caster_of(shapes::icosphere(Vec3::ZERO, 1.0, 2));
    let mut normals = corner_normals(&sphere, &[], 0.76);
    let top = sphere.corners(0)[0];
    for (t, normals) in normals.iter_mut().enumerate() {
        for (place, normal) in sphere.corners(t).iter().zip(normals) {
            if *place == top {
                *normal = (top.any_orthogonal_vector() - 0.2 * top).normalize_or_zero();
            }
        }
    }
    let body = SmoothBody::new(&sphere, &normals).expect("it is round");
    let towards = top.as_dvec3();
    for light in [LightPosition::directional(towards).expect("not zero"), LightPosition::point(towards * 3.0)] {
        let volume = SmoothVolume::new(&body, light, &smooth(0.001));
        let (positions, flat) = volume.flattened(&body, &sphere);
        assert!(flat.is_closed());
        for k in 0..200 {
            let (sin, cos) = (2.4 * f64::from(k)).sin_cos();
            let (u, v) = towards.any_orthonormal_pair();
            let behind = towards * -2.0 + (u * cos + v * sin) * (0.9 * f64::from(k) / 200.0);
            let count = flat.count_to_infinity(&positions, light, behind, DVec3::new(0.3, 0.2, 0.1));
            assert!(count.is_none_or(|count| count > 0), "{count:?} at {behind} under {light:?}");
        }
    }
}

#[test]
fn light_falls_through_a_ring() {
    let ring = caster_of(shapes::torus(Vec3::ZERO, 1.5, 0.5, 12, 8));
    let body = body_of(&ring);
    let sun = LightPosition::directional(DVec3::new(0.02, 0.01, 1.0)).expect("not zero");
    for smoothness in [Smoothness::Accurate, Smoothness::Smooth(Precision::in_world(0.01))] {
        let volume = SmoothVolume::new(&body, sun, &smoothness);
        let (positions, flat) = volume.flattened(&body, &ring);
        let count = |x: f64| {
            let point = DVec3::new(x, 0.1, -5.0);
            flat.count_to_infinity(&positions, sun, point, DVec3::new(0.3, 0.2, 0.1))
        };
        assert_eq!([count(0.0), count(1.5)], [Some(0), Some(1)], "{smoothness:?}");
    }
}

/// How far the first three metres of the way from `point` to `light` go into the ring of radii 1 and 0.35 about the origin.
fn depth_in_ring(point: DVec3, light: LightPosition) -> f64 {
    let towards = light.offset_from(point).normalize_or_zero();
    let depth = |p: DVec3| 0.35 - DVec2::new(p.truncate().length() - 1.0, p.z).length();
    (0..300).map(|i| depth(point + towards * (0.01 * f64::from(i)))).fold(f64::NEG_INFINITY, f64::max)
}

/// Where the surface is hollow, light that has gone through all of a body meets the body again right behind it.
#[test]
fn no_light_falls_through_a_coarse_ring_onto_itself() {
    let ring = caster_of(shapes::torus(Vec3::ZERO, 1.0, 0.35, 20, 12));
    let body = body_of(&ring);
    let normals = corner_normals(&ring, &[], CREASE_RAD);
    let (mut dark, mut leaks) = (0, Vec::new());
    for light in lights() {
        let volume = SmoothVolume::new(&body, light, &smooth(0.01));
        let (positions, flat) = volume.flattened(&body, &ring);
        let cap = RayCaster::new([(positions.as_slice(), flat.light_cap.as_slice())]);
        for (t, normals) in normals.iter().enumerate() {
            let [a, b, c] = ring.corners(t).map(Vec3::as_dvec3);
            for weights in [[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [1, 3, 3], [3, 1, 3], [3, 3, 1]] {
                let [u, v, w] = weights.map(|part| f64::from(part) / f64::from(weights.iter().sum::<i32>()));
                let point = a * u + b * v + c * w;
                let [na, nb, nc] = normals.map(Vec3::as_dvec3);
                let towards = light.offset_from(point).normalize_or_zero();
                if (na * u + nb * v + nc * w).dot(towards) < 0.02 || depth_in_ring(point, light) < 0.05 {
                    continue;
                }
                dark += 1;
                let mut count = 0;
                cap.for_each_hit(point, towards, 1e-6, f64::INFINITY, |hit| {
                    count += if cap.normal(&hit).dot(towards) > 0.0 { 1 } else { -1 };
                });
                if count < 1 {
                    leaks.push((light, point, count));
                }
            }
        }
    }
    assert!(dark > 5000 && leaks.is_empty(), "{} of {dark}: {:?}", leaks.len(), leaks.first());
}
