//! Hours of sun where they are known: each scene has a rule by which a pencil tells whether the sun at some azimuth and altitude reaches the receiver, and
//! the engine with refinement must find the same seconds.
//!
//! The rule knows no triangles; the sun is the same in both, as that is not what is tested here.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DVec3, Vec3};
use jiff::{SignedDuration, Timestamp};
use umbrae_core::{Caster, Mesh, Object, Scene, Surface, shapes};
use umbrae_study::{
    Blockers, Clock, Edge, LIFT_M, Packets, Period, Place, Receivers, Solids, SunHours, SunOptions, SunPath, Timetable,
    Zone, parse_dates,
};

/// A receiver, with what is around it and a rule.
struct Case<'a> {
    blocks: &'a [Surface],
    position: DVec3,
    normal: Vec3,
    /// Whether the sun reaches the receiver from the direction `(east, north, up)`.
    is_lit: &'a dyn Fn(DVec3) -> bool,
}

/// Studies `case` from sunrise to sunset of a day in Vienna in steps of a minute.
fn assert_hours(name: &str, date: &str, case: &Case) {
    let place = Place::from_degrees(48.2, 16.37).expect("a place");
    let options = SunOptions::default();
    let period = Period {
        clock: Clock::civil(Zone::named("Europe/Vienna").expect("a zone")),
        dates: parse_dates(date).expect("a date"),
        from: Edge::default(),
        to: Edge::default(),
        step: SignedDuration::from_mins(1),
    };
    let steps = Timetable::new(&place, &period, &options).expect("a timetable").steps;
    let (start, end) = (steps[0].start, steps[steps.len() - 1].end);
    let path = SunPath::new(&place, start, end, &options).expect("a path");
    let to_sun = |time: Timestamp| {
        let sun = path.at(time);
        sun.counts(&options).then(|| sun.direction(0.0))
    };

    let objects = case.blocks.iter().map(|surface| {
        Object::new("block", Arc::new(Mesh::new(surface.clone()).expect("a good mesh")), DAffine3::IDENTITY)
    });
    let casters = Caster::of_scene(&Scene { objects: objects.collect(), ..Scene::default() });
    let mut receivers = Receivers::default();
    receivers.add_points(name.to_owned(), vec![("it".to_owned(), case.position, case.normal)], &Solids::new(&[], &[]));
    let blockers = Blockers::new(&casters);
    let packets = Packets::new(&receivers);
    let suns: Vec<_> = steps.iter().map(|step| step.is_day.then(|| step.sun.direction(0.0))).collect();
    let exposure =
        blockers.expose(&receivers, &packets, 0..1, &suns, &AtomicBool::new(false), || {}).expect("nobody stops it");
    let (position, normal) = (receivers.positions[0], receivers.normals[0]);
    let sees = |time: Timestamp| to_sun(time).is_some_and(|to_sun| blockers.sees(position, normal, to_sun));
    let hours = SunHours::refined(&steps, |step| exposure.is_lit(0, 0, step), sees);

    let pencil = |time: Timestamp| to_sun(time).is_some_and(case.is_lit);
    let tenth = SignedDuration::from_millis(100);
    let (mut true_s, mut time) = (0.0, start + tenth / 2);
    while time < end {
        true_s += if pencil(time) { tenth.as_secs_f64() } else { 0.0 };
        time += tenth;
    }
    let day_s = end.duration_since(start).as_secs_f64();
    assert!(true_s > 600.0 && true_s < day_s - 600.0, "{name}: {true_s} s of {day_s} s shows nothing");
    let off = hours.total_s() - true_s;
    assert!(off.abs() < 1.0, "{name}, {date}: {} s found, {true_s} s true", hours.total_s());
    assert!(off.abs() <= hours.error_bound_s + 0.2, "{name}: {off} s off, at most {} s said", hours.error_bound_s);
    let rough = SunHours::of_steps(&steps, |step| exposure.is_lit(0, 0, step));
    assert!((rough.total_s() - true_s).abs() <= rough.error_bound_s + 60.0, "{name}: without refinement");
}

fn block(min: [f32; 3], max: [f32; 3]) -> Surface {
    shapes::cuboid(Vec3::from_array(min), Vec3::from_array(max))
}

/// Where a ray from `from` towards `to_sun` goes through the plane `axis = at`, if it does.
fn meets(from: DVec3, to_sun: DVec3, axis: usize, at: f64) -> Option<DVec3> {
    let t = (at - from[axis]) / to_sun[axis];
    (t > 0.0 && t.is_finite()).then(|| from + t * to_sun)
}

const DAYS: [&str; 3] = ["2026-03-21", "2026-06-21", "2026-12-21"];

#[test]
fn a_post_shades_a_point_while_the_sun_is_behind_it() {
    // A quarter of a metre thick, 12 m high, 2 m to the south.
    let from = DVec3::ZERO;
    let is_lit = |s: DVec3| {
        let blocked = [(1, -2.25), (1, -2.0)]
            .into_iter()
            .filter_map(|(axis, at)| meets(from, s, axis, at))
            .any(|p| p.x.abs() < 0.125 && p.z < 12.0)
            || [-0.125, 0.125]
                .into_iter()
                .filter_map(|at| meets(from, s, 0, at))
                .any(|p| (-2.25..-2.0).contains(&p.y) && p.z < 12.0)
            || meets(from, s, 2, 12.0).is_some_and(|p| p.x.abs() < 0.125 && (-2.25..-2.0).contains(&p.y));
        !blocked
    };
    let post = [block([-0.125, -2.25, 0.0], [0.125, -2.0, 12.0])];
    for day in DAYS {
        assert_hours("post", day, &Case { blocks: &post, position: from, normal: Vec3::ZERO, is_lit: &is_lit });
    }
}

#[test]
fn a_wall_to_the_south_shades_until_the_sun_is_above_it_or_beside_it() {
    // 10 m high and 10 m away, 16 m long. The receiver is 1.5 m up.
    let from = DVec3::new(0.0, 0.0, 1.5);
    let is_lit = |s: DVec3| {
        !meets(from, s, 1, -10.0).is_some_and(|p| p.x.abs() < 8.0 && p.z < 10.0)
            && !meets(from, s, 0, 8.0).is_some_and(|p| (-10.5..-10.0).contains(&p.y) && p.z < 10.0)
            && !meets(from, s, 0, -8.0).is_some_and(|p| (-10.5..-10.0).contains(&p.y) && p.z < 10.0)
    };
    let wall = [block([-8.0, -10.5, 0.0], [8.0, -10.0, 10.0])];
    for day in ["2026-02-20", "2026-12-21", "2026-02-01"] {
        assert_hours("wall", day, &Case { blocks: &wall, position: from, normal: Vec3::ZERO, is_lit: &is_lit });
    }
}

#[test]
fn a_canyon_is_lit_while_the_sun_is_above_its_profile_angle() {
    // A street from north to south, 20 m wide between walls of 15 m, so long that its ends don't matter: the sun is seen where tan(altitude) is above
    // |sin(azimuth)| times height over half the width.
    let is_lit = |s: DVec3| s.z / s.x.abs() > 15.0 / 10.0;
    let street =
        [block([-30.0, -5000.0, 0.0], [-10.0, 5000.0, 15.0]), block([10.0, -5000.0, 0.0], [30.0, 5000.0, 15.0])];
    for day in ["2026-03-21", "2026-06-21"] {
        assert_hours(
            "canyon",
            day,
            &Case { blocks: &street, position: DVec3::ZERO, normal: Vec3::ZERO, is_lit: &is_lit },
        );
    }
}

#[test]
fn an_overhang_shades_a_window_below_while_the_sun_is_high() {
    // A window in a wall that faces south, 2 m under a slab that stands out 1 m and is 40 m wide.
    let from = DVec3::new(0.0, -LIFT_M, 0.0);
    let is_lit = |s: DVec3| {
        let under = meets(from, s, 2, 2.0).is_some_and(|p| (-1.0..0.0).contains(&p.y) && p.x.abs() < 20.0);
        s.y < 0.0 && !under
    };
    let house = [block([-20.0, 0.0, -3.0], [20.0, 8.0, 6.0]), block([-20.0, -1.0, 2.0], [20.0, 0.0, 2.2])];
    for day in ["2026-03-21", "2026-04-20"] {
        assert_hours(
            "overhang",
            day,
            &Case { blocks: &house, position: DVec3::ZERO, normal: Vec3::NEG_Y, is_lit: &is_lit },
        );
    }
}

#[test]
fn a_courtyard_is_lit_through_its_opening() {
    // 16 by 24 m within walls of 9 m; the receiver is off its middle. Lit where the ray leaves through the opening on top.
    let from = DVec3::new(2.0, 5.0, 0.0);
    let is_lit = |s: DVec3| meets(from, s, 2, 9.0).is_some_and(|p| p.x.abs() < 8.0 && p.y.abs() < 12.0);
    let court = [
        block([-18.0, -22.0, 0.0], [18.0, -12.0, 9.0]),
        block([-18.0, 12.0, 0.0], [18.0, 22.0, 9.0]),
        block([-18.0, -12.0, 0.0], [-8.0, 12.0, 9.0]),
        block([8.0, -12.0, 0.0], [18.0, 12.0, 9.0]),
    ];
    for day in ["2026-03-21", "2026-06-21"] {
        assert_hours("courtyard", day, &Case { blocks: &court, position: from, normal: Vec3::ZERO, is_lit: &is_lit });
    }
}

#[test]
fn a_tilted_roof_sees_the_sun_while_that_is_before_its_plane() {
    // A gable roof of 45 degrees; the receiver is on the side that faces east, so it has the sun until that is in the roof's plane.
    let (ridge, eaves) = (9.0, 4.0);
    let corners = [
        [-5.0, -8.0, eaves],
        [5.0, -8.0, eaves],
        [5.0, 8.0, eaves],
        [-5.0, 8.0, eaves],
        [0.0, -8.0, ridge],
        [0.0, 8.0, ridge],
    ];
    let roof = Surface {
        positions: corners.map(Vec3::from_array).to_vec(),
        triangles: vec![[1, 2, 5], [1, 5, 4], [3, 0, 4], [3, 4, 5], [0, 1, 4], [2, 3, 5], [0, 2, 1], [0, 3, 2]],
        ..Surface::default()
    };
    let normal = DVec3::new(1.0, 0.0, 1.0) / 2.0_f64.sqrt();
    let is_lit = |s: DVec3| s.dot(normal) > 0.0;
    for day in DAYS {
        let position = DVec3::new(2.5, 0.0, 6.5);
        assert_hours(
            "roof",
            day,
            &Case { blocks: std::slice::from_ref(&roof), position, normal: normal.as_vec3(), is_lit: &is_lit },
        );
    }
}
