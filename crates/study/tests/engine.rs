//! The engine against rays in double precision, on scenes that are made to hurt: every verdict that the engine calls decided is the rays'.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DVec2, DVec3, Vec3};
use umbrae_core::{Caster, Mesh, Object, Scene, Surface, shapes};
use umbrae_study::{Blockers, Exposure, GroundGrid, Packets, Receivers, Solids, Terrain};

/// The same numbers on every run.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }

    fn between(&mut self, min: f64, max: f64) -> f64 {
        min + self.unit() * (max - min)
    }

    fn point(&mut self, min: DVec3, max: DVec3) -> DVec3 {
        DVec3::new(self.between(min.x, max.x), self.between(min.y, max.y), self.between(min.z, max.z))
    }
}

fn casters(surfaces: Vec<Surface>) -> Vec<Caster> {
    let object = |surface| Object::new("it", Arc::new(Mesh::new(surface).expect("a good mesh")), DAffine3::IDENTITY);
    Caster::of_scene(&Scene { objects: surfaces.into_iter().map(object).collect(), ..Scene::default() })
}

fn receivers(points: Vec<(DVec3, Vec3)>) -> Receivers {
    let named = points.into_iter().enumerate().map(|(i, (p, n))| (i.to_string(), p, n)).collect();
    let mut receivers = Receivers::default();
    receivers.add_points("points".to_owned(), named, &Solids::new(&[], &[]));
    receivers
}

fn suns(random: &mut Random, count: usize) -> Vec<Option<DVec3>> {
    let sun = |random: &mut Random| {
        let (azimuth, altitude) = (random.between(0.0, std::f64::consts::TAU), random.between(0.005, 1.57));
        Some(DVec3::new(altitude.cos() * azimuth.sin(), altitude.cos() * azimuth.cos(), altitude.sin()))
    };
    (0..count).map(|_| sun(random)).collect()
}

fn expose(casters: &[Caster], receivers: &Receivers, suns: &[Option<DVec3>]) -> (Blockers, Packets, Exposure) {
    let blockers = Blockers::new(casters);
    let packets = Packets::new(receivers);
    let exposure = blockers
        .expose(receivers, &packets, 0..packets.len(), suns, &AtomicBool::new(false), || {})
        .expect("nobody stops it");
    (blockers, packets, exposure)
}

/// Asserts that all decided verdicts are those of rays, that some receivers are lit and some not, and few are undecided.
fn assert_agrees(casters: &[Caster], receivers: &Receivers, suns: &[Option<DVec3>], most_undecided: f64) {
    let (blockers, packets, exposure) = expose(casters, receivers, suns);
    let check = blockers.check(receivers, &packets, &exposure, suns, 1);
    assert_eq!(check.disagreements, 0, "of {} verdicts", check.verdicts);
    let lit: u32 = exposure.lit.iter().map(|word| word.count_ones()).sum();
    assert!(lit > 0 && (lit as usize) < check.verdicts, "{lit} of {} are lit", check.verdicts);
    let undecided = exposure.undecided.len() as f64 / check.verdicts as f64;
    assert!(undecided <= most_undecided, "{undecided} undecided");
}

#[test]
fn soups_of_loose_triangles_shade_as_rays_say() {
    let mut random = Random(1);
    for (size, count) in [(0.3, 3000), (3.0, 300), (40.0, 6)] {
        let (min, max) = (DVec3::splat(-20.0), DVec3::splat(20.0));
        let mut surface = Surface::default();
        for t in 0..count {
            let at = random.point(min, max);
            for _ in 0..3 {
                let corner = at + random.point(DVec3::splat(-size), DVec3::splat(size));
                surface.positions.push(corner.as_vec3());
            }
            surface.triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
        }
        let points = (0..500).map(|_| (random.point(min, max), Vec3::ZERO)).collect();
        assert_agrees(&casters(vec![surface]), &receivers(points), &suns(&mut random, 60), 0.01);
    }
}

#[test]
fn overlapping_closed_boxes_shade_the_ground_and_each_other() {
    let mut random = Random(2);
    let boxes = (0..60)
        .map(|_| {
            let (min, size) = (
                random.point(DVec3::new(-80.0, -80.0, 0.0), DVec3::new(80.0, 80.0, 5.0)),
                random.point(DVec3::splat(2.0), DVec3::splat(30.0)),
            );
            shapes::cuboid(min.as_vec3(), (min + size).as_vec3())
        })
        .collect();
    let casters = casters(boxes);
    let kinds: Vec<_> = casters.iter().map(|c| umbrae_study::kind_of_triangles(c, &[])).collect();
    let solids = Solids::new(&casters, &kinds);
    let mut receivers = Receivers::default();
    let grid = GroundGrid::covering(DVec2::splat(-100.0), DVec2::splat(100.0), 5.0, 0.0);
    receivers.add_ground(grid, &Terrain::new(&casters, &kinds), &solids);
    for (i, caster) in casters.iter().enumerate() {
        for surface in [umbrae_core::SurfaceKind::Roof, umbrae_core::SurfaceKind::Wall] {
            receivers.add_surfaces(i, caster, &kinds[i], surface, 4.0, &solids);
        }
    }
    assert!(receivers.is_inside.iter().any(|&inside| inside) && receivers.groups.len() == 121);
    assert_agrees(&casters, &receivers, &suns(&mut random, 40), 0.001);
}

#[test]
fn ground_under_a_house_that_stands_little_higher_is_built_on_whenever_it_is_asked() {
    let above = |z: f32| casters(vec![shapes::cuboid(Vec3::new(0.0, 0.0, z), Vec3::new(10.0, 10.0, z + 8.0))]);
    let solids = |casters: &[Caster]| {
        let kinds: Vec<_> = casters.iter().map(|c| umbrae_study::kind_of_triangles(c, &[])).collect();
        Solids::new(casters, &kinds)
    };
    let (low, high) = (solids(&above(1.0)), solids(&above(3.0)));
    let mut receivers = Receivers::default();
    let grid = GroundGrid::covering(DVec2::splat(-5.0), DVec2::splat(15.0), 1.0, 0.0);
    receivers.add_ground(grid, &Terrain::new(&[], &[]), &low);
    assert_eq!(receivers.is_inside.iter().filter(|&&inside| inside).count(), 100);
    assert_eq!(receivers.inside_of(&low), receivers.is_inside);
    assert!(!receivers.inside_of(&high).contains(&true), "one walks under a house on posts");
}

#[test]
fn suns_along_the_axes_and_receivers_on_edges_are_decided_by_rays_or_not_at_all() {
    let tower = shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 30.0));
    let mut points = Vec::new();
    for i in -4..=8 {
        for j in -4..=8 {
            points.push((DVec3::new(f64::from(i) * 2.5, f64::from(j) * 2.5, 0.0), Vec3::ZERO));
        }
    }
    let slant = DVec3::new(1.0, 0.0, 1.0) / 2.0_f64.sqrt();
    let suns = [DVec3::Z, DVec3::X, DVec3::NEG_Y, slant].map(Some);
    let receivers = receivers(points);
    let (blockers, packets, exposure) = expose(&casters(vec![tower]), &receivers, &suns);
    assert_eq!(blockers.check(&receivers, &packets, &exposure, &suns, 1).disagreements, 0);
    assert!(!exposure.undecided.is_empty(), "points on the outline can't be decided");
    // Under a sun on the horizon everything is level with the foot of the walls.
    let on_outline = |&(r, step): &(u32, u32)| {
        let p = receivers.positions[r as usize];
        step == 1 || step == 2 || [p.x, p.y].iter().any(|c| *c == 0.0 || *c == 10.0)
    };
    assert!(exposure.undecided.iter().all(on_outline));
}

#[test]
fn a_receiver_does_not_see_the_sun_behind_its_own_wall() {
    let tower = shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 30.0));
    let east = (DVec3::new(10.0, 5.0, 5.0), Vec3::X);
    let free = (DVec3::new(50.0, 5.0, 5.0), Vec3::X);
    let receivers = receivers(vec![east, free]);
    let low = |x: f64| Some(DVec3::new(x, 0.1, 0.2).normalize_or_zero());
    let (_, packets, exposure) = expose(&casters(vec![tower]), &receivers, &[low(1.0), low(-1.0), None]);
    let lane = |r: u32| packets.members(0).iter().position(|&member| member == r).expect("all are in the packet");
    for r in [0, 1] {
        let seen: Vec<bool> = (0..3).map(|step| exposure.is_lit(0, lane(r), step)).collect();
        assert_eq!(seen, [true, false, false], "receiver {r}");
    }
    assert!(exposure.undecided.is_empty());
}

#[test]
fn a_large_city_far_from_its_origin_is_as_exact_as_a_small_one() {
    let mut random = Random(4);
    let boxes = (0..400)
        .map(|_| {
            let at = random.point(DVec3::new(-6000.0, -6000.0, 0.0), DVec3::new(6000.0, 6000.0, 0.0));
            let size = random.point(DVec3::new(20.0, 20.0, 50.0), DVec3::new(90.0, 90.0, 300.0));
            shapes::cuboid(at.as_vec3(), (at + size).as_vec3())
        })
        .collect();
    let points = (0..3000)
        .map(|_| (random.point(DVec3::new(-6000.0, -6000.0, 0.0), DVec3::new(6000.0, 6000.0, 20.0)), Vec3::ZERO));
    let receivers = receivers(points.collect());
    assert_agrees(&casters(boxes), &receivers, &suns(&mut random, 30), 0.001);
}

#[test]
fn a_receiver_far_away_is_in_the_shadow_of_a_house_that_rounding_moves() {
    let house = casters(vec![shapes::cuboid(Vec3::ZERO, Vec3::new(20.0, 20.0, 6.0))]);
    let mut random = Random(6);
    // Along the shadow of a low sun, some kilometres away, about the shadow's edges.
    let sun = DVec3::new(-1.0, 0.0, 0.001).normalize_or_zero();
    let points = (0..4000).map(|_| {
        let x = random.between(1000.0, 5500.0);
        (DVec3::new(x, random.between(-0.01, 0.01) + if random.unit() < 0.5 { 0.0 } else { 20.0 }, 0.0), Vec3::ZERO)
    });
    assert_agrees(&house, &receivers(points.collect()), &[Some(sun)], 0.9);
}

#[test]
fn nothing_casts_nothing_and_every_thread_finds_the_same() {
    let points: Vec<_> = (0..200).map(|i| (DVec3::new(f64::from(i), 0.0, 0.0), Vec3::ZERO)).collect();
    let receivers = receivers(points);
    let (_, packets, exposure) = expose(&[], &receivers, &[Some(DVec3::Z)]);
    let lit: u32 = exposure.lit.iter().map(|word| word.count_ones()).sum();
    assert_eq!((packets.len(), lit), (4, 200));
    let wall = casters(vec![shapes::cuboid(Vec3::new(20.0, -1.0, 0.0), Vec3::new(90.0, 1.0, 9.0))]);
    let suns = suns(&mut Random(5), 20);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| expose(&wall, &receivers, &suns).2)
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn what_is_stopped_gives_nothing() {
    let receivers = receivers(vec![(DVec3::ZERO, Vec3::ZERO)]);
    let blockers = Blockers::new(&[]);
    let packets = Packets::new(&receivers);
    let stop = AtomicBool::new(true);
    assert_eq!(blockers.expose(&receivers, &packets, 0..1, &[Some(DVec3::Z)], &stop, || {}), None);
}
