//! The sun as a disc: shares against closed forms, and against thousands of rays on scenes that are made to hurt.

use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DVec3, Vec3};
use jiff::SignedDuration;
use umbrae_core::{Caster, Mesh, Object, SUN_DIAMETER_RAD, Scene, Surface, shapes};
use umbrae_study::{
    Blockers, Clock, DiscExposure, Edge, Packets, Period, Place, Receivers, Refinement, Solids, SunHours, SunOptions,
    Timetable, Zone, parse_dates,
};

/// The same numbers on every run.
struct Random(u64);

impl Random {
    fn between(&mut self, min: f64, max: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        min + (self.0 >> 40) as f64 / (1_u64 << 24) as f64 * (max - min)
    }

    fn point(&mut self, min: DVec3, max: DVec3) -> DVec3 {
        DVec3::new(self.between(min.x, max.x), self.between(min.y, max.y), self.between(min.z, max.z))
    }
}

fn casters(surfaces: Vec<Surface>) -> Vec<Caster> {
    let object = |surface| Object::new("it", Arc::new(Mesh::new(surface).expect("a good mesh")), DAffine3::IDENTITY);
    Caster::of_scene(&Scene { objects: surfaces.into_iter().map(object).collect(), ..Scene::default() })
}

fn block(min: [f32; 3], max: [f32; 3]) -> Surface {
    shapes::cuboid(Vec3::from_array(min), Vec3::from_array(max))
}

fn blockers(surfaces: Vec<Surface>) -> Blockers {
    Blockers::new(&casters(surfaces))
}

/// Without its last face, and with the others turned now this way and now that.
fn damaged(mut surface: Surface) -> Surface {
    surface.triangles.truncate(surface.triangles.len() - 2);
    surface.triangles.iter_mut().step_by(3).for_each(|triangle| triangle.swap(0, 1));
    surface
}

fn receivers(points: impl IntoIterator<Item = (DVec3, Vec3)>) -> Receivers {
    let named = points.into_iter().enumerate().map(|(i, (p, n))| (i.to_string(), p, n)).collect();
    let mut receivers = Receivers::default();
    receivers.add_points("points".to_owned(), named, &Solids::new(&[], &[]));
    receivers
}

fn expose(blockers: &Blockers, receivers: &Receivers, suns: &[Option<DVec3>]) -> (Packets, DiscExposure) {
    let packets = Packets::new(receivers);
    let exposure = blockers.expose_disc(receivers, &packets, 0..packets.len(), suns, &AtomicBool::new(false), || {});
    (packets, exposure.expect("nobody stops it"))
}

/// The share for each receiver, by step.
fn shares(blockers: &Blockers, receivers: &Receivers, suns: &[Option<DVec3>]) -> Vec<Vec<f64>> {
    let (packets, exposure) = expose(blockers, receivers, suns);
    let mut all = vec![Vec::new(); receivers.len()];
    for packet in 0..packets.len() {
        for (lane, &r) in packets.members(packet).iter().enumerate() {
            let partial = exposure.of_receiver(r as usize);
            let is_whole = |step| exposure.whole.is_lit(packet, lane, step);
            all[r as usize] = (0..suns.len()).map(|step| DiscExposure::share(partial, step, is_whole(step))).collect();
        }
    }
    all
}

fn sun(azimuth_deg: f64, altitude_deg: f64) -> DVec3 {
    let [(sin_az, cos_az), (sin_alt, cos_alt)] = [azimuth_deg, altitude_deg].map(|deg| deg.to_radians().sin_cos());
    DVec3::new(cos_alt * sin_az, cos_alt * cos_az, sin_alt)
}

fn slope() -> f64 {
    (0.5 * SUN_DIAMETER_RAD).tan()
}

/// What is seen of the disc beyond a straight edge that is `t` of its radii from its middle; all from -1 on, nothing from 1 on.
fn beyond_edge(t: f64) -> f64 {
    let t = t.clamp(-1.0, 1.0);
    (t.acos() - t * (1.0 - t * t).sqrt()) / PI
}

#[test]
fn behind_a_long_wall_the_share_is_that_of_a_half_plane() {
    // 10 m high and kilometres long, 10 m to the south; and the same in pieces, open and badly wound.
    let whole = block([-4000.0, -10.5, 0.0], [4000.0, -10.0, 10.0]);
    let pieces: Vec<_> =
        (-50..50).map(|i| damaged(block([i as f32 * 4.0, -10.5, 0.0], [i as f32 * 4.0 + 4.5, -10.0, 10.0]))).collect();
    let altitude_deg = 38.0_f64;
    // From where the edge is a radius above the middle of the sun to where it is a radius below.
    let places: Vec<f64> =
        (0..=400).map(|i| 10.0 / altitude_deg.to_radians().tan() - 10.0 + f64::from(i - 200) * 1e-3).collect();
    let receivers = receivers(places.iter().map(|&y| (DVec3::new(0.3, y, 0.0), Vec3::ZERO)));
    for surfaces in [vec![whole], pieces] {
        let shares = shares(&blockers(surfaces), &receivers, &[Some(sun(180.0, altitude_deg))]);
        let mut partial = 0;
        for (share, y) in shares.iter().zip(&places) {
            let edge_altitude = 10.0_f64.atan2(y + 10.0);
            let expected = beyond_edge((edge_altitude - altitude_deg.to_radians()).tan() / slope());
            assert!((share[0] - expected).abs() < 1e-9, "at {y}: {}, not {expected}", share[0]);
            partial += usize::from(expected > 0.0 && expected < 1.0);
        }
        assert!(partial > 100 && partial < 400, "{partial}");
    }
}

#[test]
fn beside_the_shadow_of_a_post_of_100_m_the_share_and_the_width_of_the_penumbra_are_the_closed_forms() {
    let (half_width, distance, altitude_deg) = (1.5, 80.0, 30.0_f64);
    let post = blockers(vec![block([-1.5, -1.0, 0.0], [1.5, 0.0, 100.0])]);
    let to_sun = sun(180.0, altitude_deg);
    let share = |x: f64| post.visible_share(DVec3::new(x, distance, 0.0), Vec3::ZERO, to_sun);
    // Each upright edge is a plane through the receiver, in which the zenith is. Of the post only the side to the north is seen, and from beside it one more.
    let edge = |x: f64, edge_x: f64, edge_y: f64| {
        let to_edge = DVec3::new(edge_x - x, edge_y - distance, 0.0);
        let normal = to_edge.cross(DVec3::Z).normalize_or(DVec3::X);
        let along = normal.dot(to_sun);
        along / (1.0 - along * along).sqrt() / slope()
    };
    for i in 0..=4000 {
        let x = f64::from(i) * 1e-3 - 0.2;
        let west = edge(x, -half_width, 0.0);
        let east = edge(x, half_width, if x > half_width { -1.0 } else { 0.0 });
        let expected = 1.0 - (beyond_edge(east) - beyond_edge(west)).abs();
        assert!((share(x) - expected).abs() < 1e-9, "at {x}: {}, not {expected}", share(x));
    }
    // Where the sun is first seen, and where all of it is.
    let first = |is_there: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, 4.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            (low, high) = if is_there(middle) { (low, middle) } else { (middle, high) };
        }
        low
    };
    let width = first(&|x| share(x) >= 1.0) - first(&|x| share(x) > 0.0);
    // The disc's edge is in the plane where sin(radius) = sin(turn) cos(altitude); the far edge of the post's side hides last.
    let turn = ((0.5 * SUN_DIAMETER_RAD).sin() / altitude_deg.to_radians().cos()).asin();
    let expected = (half_width + (distance + 1.0) * turn.tan()) - (half_width - distance * turn.tan());
    assert!((width / expected - 1.0).abs() < 1e-6, "{width} m, not {expected} m");
}

#[test]
fn what_two_blockers_hide_together_is_not_counted_twice() {
    // Two slabs above the receiver, at 50 m and at 100 m, that both reach over the middle of a sun in the zenith, from the west.
    let edges = [0.05_f32, -0.125];
    let slab = |i: usize| block([-30.0, -30.0, 50.0 * (i + 1) as f32], [edges[i], 30.0, 50.0 * (i + 1) as f32 + 1.0]);
    let t = |i: usize| f64::from(edges[i]) / (50.0 * (i + 1) as f64) / slope();
    let share = |surfaces| blockers(surfaces).visible_share(DVec3::ZERO, Vec3::ZERO, DVec3::Z);
    // The slab's farther side is narrower, seen from below, only to the west.
    let far = |i: usize| f64::from(edges[i]) / (50.0 * (i + 1) as f64 + 1.0) / slope();
    let of = |i: usize| beyond_edge(t(i).max(far(i)));
    assert!((share(vec![slab(0)]) - of(0)).abs() < 1e-9);
    assert!((share(vec![slab(1)]) - of(1)).abs() < 1e-9);
    assert!((share(vec![slab(0), slab(1)]) - of(0).min(of(1))).abs() < 1e-9);
    assert!((share(vec![slab(1), slab(0), slab(1)]) - of(0).min(of(1))).abs() < 1e-9);
}

#[test]
fn through_a_hole_as_much_is_seen_as_it_is_large() {
    // A square hole of a quarter of a metre in a roof 100 m above.
    let (h, w) = (100.0_f32, 0.125_f32);
    let roof = vec![
        block([-20.0, -20.0, h], [-w, 20.0, h + 0.001]),
        block([w, -20.0, h], [20.0, 20.0, h + 0.001]),
        block([-20.0, -20.0, h], [20.0, -w, h + 0.001]),
        block([-20.0, w, h], [20.0, 20.0, h + 0.001]),
    ];
    let top = f64::from(h + 0.001);
    let half = f64::from(w) / top / slope();
    let share = blockers(roof).visible_share(DVec3::ZERO, Vec3::ZERO, DVec3::Z);
    assert!((share - 4.0 * half * half / PI).abs() < 1e-9, "{share}");
}

#[test]
fn a_facade_and_the_horizon_hide_what_is_behind_them() {
    let nothing = Blockers::new(&[]);
    let share = |normal: Vec3, to_sun: DVec3| nothing.visible_share(DVec3::ZERO, normal, to_sun);
    assert_eq!(share(Vec3::ZERO, sun(90.0, 10.0)), 1.0);
    assert_eq!([share(Vec3::X, sun(90.0, 10.0)), share(Vec3::NEG_X, sun(90.0, 10.0))], [1.0, 0.0]);
    // Along the facade, and as it rises.
    assert!((share(Vec3::X, sun(0.0, 40.0)) - 0.5).abs() < 1e-9);
    assert!((share(Vec3::ZERO, sun(90.0, 0.0)) - 0.5).abs() < 1e-9);
    assert!((share(Vec3::X, sun(0.0, 0.0)) - 0.25).abs() < 1e-9, "both at once");
    for i in -5..=5 {
        let t = f64::from(i) / 5.0;
        let altitude_deg = (t * slope()).atan().to_degrees();
        assert!((share(Vec3::ZERO, sun(77.0, altitude_deg)) - beyond_edge(-t)).abs() < 1e-9, "at {t} radii");
    }
}

/// Asserts that shares are those of 4,096 rays each, as far as these can tell: none is off by more than six standard deviations of the worst case, and all together are not off.
fn assert_rays_agree(casters: &[Caster], receivers: &Receivers, suns: &[Option<DVec3>], least_partial: usize) {
    let blockers = Blockers::new(casters);
    let shares = shares(&blockers, receivers, suns);
    let (mut partial, mut off_by, mut off, mut worst) = (0, 0.0, 0.0, 0.0_f64);
    for (r, shares) in shares.iter().enumerate() {
        let (position, normal) = (receivers.positions[r], receivers.normals[r]);
        for (&share, to_sun) in shares.iter().zip(suns.iter().flatten()) {
            let is_plain = share == 0.0 || share == 1.0;
            // Of those that see all or nothing, a look at some places is enough.
            let rays = blockers.visible_share_by_rays(position, normal, *to_sun, if is_plain { 8 } else { 64 });
            if is_plain {
                assert_eq!(share, rays, "receiver {r} at {position} under {to_sun}");
                continue;
            }
            partial += 1;
            off_by += (share - rays).abs();
            off += share - rays;
            worst = worst.max((share - rays).abs());
        }
    }
    assert!(partial >= least_partial, "{partial} see part");
    let count = partial as f64;
    assert!(worst < 0.047, "worst {worst}");
    assert!(off_by / count < 0.004, "off by {} on average", off_by / count);
    assert!((off / count).abs() < 5.0 * 0.008 / count.sqrt(), "all are off by {}", off / count);
}

#[test]
fn soups_of_loose_triangles_hide_what_rays_say() {
    let mut random = Random(1);
    for (size, count, least) in [(0.3, 2000, 100), (3.0, 300, 100), (40.0, 6, 5)] {
        let (min, max) = (DVec3::splat(-20.0), DVec3::splat(20.0));
        let mut surface = Surface::default();
        for t in 0..count {
            let at = random.point(min, max);
            for _ in 0..3 {
                surface.positions.push((at + random.point(DVec3::splat(-size), DVec3::splat(size))).as_vec3());
            }
            surface.triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
        }
        let points: Vec<_> = (0..150).map(|_| (random.point(min, max), Vec3::ZERO)).collect();
        let suns: Vec<_> = (0..20).map(|_| Some(sun(random.between(0.0, 360.0), random.between(-0.2, 90.0)))).collect();
        assert_rays_agree(&casters(vec![surface]), &receivers(points), &suns, least);
    }
}

#[test]
fn overlapping_boxes_open_and_closed_hide_what_rays_say_from_the_ground_and_from_walls() {
    let mut random = Random(2);
    let boxes = (0..60).map(|i| {
        let min = random.point(DVec3::new(-80.0, -80.0, 0.0), DVec3::new(80.0, 80.0, 5.0));
        let size = random.point(DVec3::splat(2.0), DVec3::splat(30.0));
        let surface = shapes::cuboid(min.as_vec3(), (min + size).as_vec3());
        if i % 3 == 0 { damaged(surface) } else { surface }
    });
    let casters = casters(boxes.collect());
    let on_ground =
        (0..1500).map(|_| (random.point(DVec3::new(-90.0, -90.0, -0.01), DVec3::new(90.0, 90.0, -0.01)), Vec3::ZERO));
    let mut points: Vec<_> = on_ground.collect();
    for caster in &casters {
        for t in 0..caster.mesh.triangles().len() {
            let [a, b, c] = caster.corners(t).map(Vec3::as_dvec3);
            let normal = (b - a).cross(c - a).as_vec3();
            points.push(((a + b + c) / 3.0, if t % 2 == 0 { normal } else { -normal }));
        }
    }
    let suns: Vec<_> = (0..16).map(|_| Some(sun(random.between(0.0, 360.0), random.between(-0.2, 60.0)))).collect();
    assert_rays_agree(&casters, &receivers(points), &suns, 150);
}

#[test]
fn a_large_city_far_from_its_origin_is_as_exact_as_a_small_one() {
    let mut random = Random(4);
    let boxes = (0..400).map(|_| {
        let at = random.point(DVec3::new(-6000.0, -6000.0, 0.0), DVec3::new(6000.0, 6000.0, 0.0));
        let size = random.point(DVec3::new(20.0, 20.0, 50.0), DVec3::new(90.0, 90.0, 300.0));
        shapes::cuboid(at.as_vec3(), (at + size).as_vec3())
    });
    let casters = casters(boxes.collect());
    let points = (0..1500)
        .map(|_| (random.point(DVec3::new(-6000.0, -6000.0, -0.01), DVec3::new(6000.0, 6000.0, 20.0)), Vec3::ZERO));
    let receivers = receivers(points.collect::<Vec<_>>());
    let suns: Vec<_> = (0..12).map(|_| Some(sun(random.between(0.0, 360.0), random.between(0.3, 40.0)))).collect();
    assert_rays_agree(&casters, &receivers, &suns, 300);
}

#[test]
fn every_thread_finds_the_same_and_one_receiver_alone_what_it_finds_among_others() {
    let mut random = Random(6);
    let boxes = (0..30).map(|_| {
        let min = random.point(DVec3::splat(-40.0), DVec3::splat(40.0));
        damaged(shapes::cuboid(min.as_vec3(), (min + random.point(DVec3::ONE, DVec3::splat(9.0))).as_vec3()))
    });
    let blockers = blockers(boxes.collect());
    let points: Vec<_> =
        (0..900).map(|_| (random.point(DVec3::splat(-50.0), DVec3::splat(50.0)), Vec3::ZERO)).collect();
    let receivers = receivers(points);
    let suns: Vec<_> =
        (0..9).map(|i| (i != 4).then(|| sun(100.0 + 20.0 * f64::from(i), 5.0 * f64::from(i) + 0.1))).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| expose(&blockers, &receivers, &suns).1)
    };
    assert_eq!(with(1), with(3));
    let shares = shares(&blockers, &receivers, &suns);
    for (r, shares) in shares.iter().enumerate() {
        assert_eq!(shares[4], 0.0, "there is no sun at night");
        for (step, to_sun) in suns.iter().enumerate().filter_map(|(step, to_sun)| Some((step, (*to_sun)?))) {
            let alone = blockers.visible_share(receivers.positions[r], Vec3::ZERO, to_sun);
            assert!((alone - shares[step]).abs() < 1e-9, "receiver {r}, step {step}: {alone}, not {}", shares[step]);
        }
    }
}

#[test]
fn the_hours_of_a_day_behind_a_wall_are_the_integral_of_the_closed_form() {
    let place = Place::from_degrees(48.2, 16.37).expect("a place");
    let options = SunOptions::default();
    let timetable = |step: SignedDuration| {
        let period = Period {
            clock: Clock::civil(Zone::named("Europe/Vienna").expect("a zone")),
            dates: parse_dates("2026-02-20").expect("a date"),
            from: Edge::default(),
            to: Edge::default(),
            step,
        };
        Timetable::new(&place, &period, &options).expect("a timetable")
    };
    // A wall to the south that is long enough for the whole day, but for a sun so low that it is beside it.
    let wall = blockers(vec![block([-40_000.0, -10.5, 0.0], [40_000.0, -10.0, 6.0])]);
    let receivers = receivers([(DVec3::ZERO, Vec3::ZERO)]);
    let closed_form = |to_sun: DVec3| {
        let above_horizon = beyond_edge(-to_sun.z / (1.0 - to_sun.z * to_sun.z).sqrt() / slope());
        if to_sun.y >= 0.01 {
            return above_horizon;
        }
        // The plane through the receiver and the wall's upper edge.
        let along = DVec3::new(0.0, 6.0, 10.0).normalize_or(DVec3::Z).dot(to_sun);
        beyond_edge(-along / (1.0 - along * along).sqrt() / slope())
    };
    let hours = |timetable: &Timetable| {
        let suns = timetable.disc_directions(&options, 0.0);
        let shares = shares(&wall, &receivers, &suns);
        SunHours::of_shares(&timetable.steps, |step| shares[0][step])
    };
    let seconds = timetable(SignedDuration::from_secs(1));
    let suns = seconds.disc_directions(&options, 0.0);
    let integral: f64 = seconds
        .steps
        .iter()
        .zip(&suns)
        .filter_map(|(step, to_sun)| Some(closed_form((*to_sun)?) * step.duration_s()))
        .sum();
    for minutes in [1, 5] {
        let found = hours(&timetable(SignedDuration::from_mins(minutes)));
        let off = found.total_s() - integral;
        assert!(
            off.abs() < 2.0 * minutes as f64 && off.abs() < found.error_bound_s,
            "every {minutes} min: {off} s off {integral} s"
        );
        assert!(found.error_bound_s <= 60.0 * minutes as f64 * 2.0, "{}", found.error_bound_s);
    }
    let quarters = timetable(SignedDuration::from_mins(15));
    let refined = Refinement::new(&place, &quarters, &options, 0.0).expect("the sun is known");
    let found = hours(refined.timetable());
    assert!((found.total_s() - integral).abs() < 2.0, "{} s, not {integral} s", found.total_s());
}
