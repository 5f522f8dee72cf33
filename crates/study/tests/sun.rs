//! The sun against NREL's own program, the paper's example, the almanac of the US Naval Observatory, and itself.

mod data;

use data::{rows, solar};
use jiff::civil::Time;
use jiff::tz::{Offset, TimeZone};
use jiff::{SignedDuration, Timestamp, ToSpan as _};
use umbrae_study::{
    DayKind, HORIZON_DEG, Place, Refraction, Sun, SunDay, SunOptions, SunPath, TimeError, equation_of_time_s,
    equinoxes_and_solstices, spans_of_sun,
};

/// What the algorithm promises, and what its own program prints.
const TOLERANCE_DEG: f64 = 0.0003;
/// Tables of rises and sets have whole minutes or seconds.
const TOLERANCE_S: f64 = 60.0;

fn place(latitude: &str, longitude: &str) -> Place {
    let degrees = |text: &str| text.parse().expect("a number");
    Place::from_degrees(degrees(latitude), degrees(longitude)).expect("a place on Earth")
}

fn moment(text: &str) -> Timestamp {
    text.parse().expect(text)
}

fn apart_deg(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

/// As the tables of NREL were made.
fn as_in_the_tables() -> SunOptions {
    SunOptions {
        refraction: Refraction::Air { pressure_hpa: 1000.0, temperature_c: 10.0 },
        delta_t_s: Some(0.0),
        ..SunOptions::default()
    }
}

#[test]
fn the_sun_is_where_nrel_has_it() {
    let Some(table) = solar("spa_azimuth_zenith.csv") else { return };
    let (mut count, mut worst) = (0, [0.0_f64; 2]);
    for row in rows(&table) {
        let [time, latitude, longitude, azimuth, zenith] = row[..] else { panic!("{row:?}") };
        let sun = Sun::at(&place(latitude, longitude), moment(time), &as_in_the_tables()).expect("its time is known");
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let off = [
            apart_deg(sun.azimuth_rad.to_degrees(), number(azimuth)),
            (90.0 - sun.altitude_rad.to_degrees() - number(zenith)).abs(),
        ];
        assert!(off.iter().all(|off| *off <= TOLERANCE_DEG), "{row:?}: {off:?}");
        worst = [worst[0].max(off[0]), worst[1].max(off[1])];
        count += 1;
    }
    println!("{count} rows; off by {worst:?} degrees at most");
    assert!(count > 500, "{count} rows");
}

#[test]
fn the_example_of_the_paper_comes_out() {
    let Some(text) = solar("nrel_spa_paper_example.json") else { return };
    let example: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let input = |name: &str| example["input"][name].as_f64().expect(name);
    let expected = |name: &str| example["expected"][name].as_f64().expect(name);
    let place = Place::from_degrees(input("latitude"), input("longitude")).expect("a place");
    let place = place.with_elevation(input("elevation_m")).expect("in Colorado");
    let time = moment(example["input"]["local_time"].as_str().expect("a time"));
    let options = SunOptions {
        refraction: Refraction::Air { pressure_hpa: input("pressure_hPa"), temperature_c: input("temperature_C") },
        delta_t_s: Some(input("delta_t_s")),
        ..SunOptions::default()
    };
    let sun = Sun::at(&place, time, &options).expect("in 2003");
    assert!((sun.altitude_rad.to_degrees() - expected("e")).abs() < 1e-5, "{sun:?}");
    assert!((sun.azimuth_rad.to_degrees() - expected("azimuth")).abs() < 1e-5, "{sun:?}");
    let bare = Sun::at(&place, time, &SunOptions { refraction: Refraction::None, ..options }).expect("in 2003");
    assert!((bare.altitude_rad.to_degrees() - expected("e0")).abs() < 1e-5, "{bare:?}");
    assert_eq!(bare.azimuth_rad, sun.azimuth_rad);

    // The rise and set of Golden, Colorado, are of the zone's days.
    let zone = TimeZone::fixed(Offset::constant(-7));
    for day in example["rise_set_golden_co_mst"].as_array().expect("days") {
        let text = |name: &str| day[name].as_str().expect("text").to_owned();
        let date: jiff::civil::Date = text("date").parse().expect("a date");
        let [start, end] =
            [date, date + 1.day()].map(|date| date.to_zoned(zone.clone()).expect("in our time").timestamp());
        let sun = SunDay::between(&place, start, end, &options).expect("in our time");
        for (found, name) in [(&sun.rises, "sunrise"), (&sun.transits, "transit"), (&sun.sets, "sunset")] {
            let clock: Time = text(name).parse().expect("a time");
            let expected = date.to_datetime(clock).to_zoned(zone.clone()).expect("in our time").timestamp();
            // Golden's summer sun sets after midnight UTC, and the algorithm's own recipe for sets, made for days of UTC, has the evening
            // before there: a minute later than that of the date itself.
            let is_of_the_evening_before = (text("date").as_str(), name) == ("2015-08-02", "sunset");
            let found = if is_of_the_evening_before {
                SunDay::between(&place, start - 24.hours(), start, &options).expect("in our time").sets
            } else {
                found.clone()
            };
            let off = found[0].duration_since(expected).as_secs_f64().abs();
            let off = if is_of_the_evening_before { (off - 86_400.0).abs() } else { off };
            assert!(found.len() == 1 && off <= 2.0, "{} {name}: {found:?}, off by {off} s", text("date"));
        }
    }
}

#[test]
fn nrel_has_the_same_rises_transits_and_sets() {
    let Some(table) = solar("spa_sunrise.csv") else { return };
    let (mut count, mut worst) = (0, 0.0_f64);
    for row in rows(&table) {
        let [time, latitude, longitude, rise, transit, set] = row[..] else { panic!("{row:?}") };
        let midnight = midnight_of(time);
        // An event near midnight may be the neighbouring day's.
        let [start, end] = [midnight - 12.hours(), midnight + 36.hours()];
        let sun =
            SunDay::between(&place(latitude, longitude), start, end, &as_in_the_tables()).expect("its time is known");
        let is_polar = rise.is_empty();
        if is_polar {
            let day =
                SunDay::between(&place(latitude, longitude), midnight, midnight + 24.hours(), &as_in_the_tables());
            assert_ne!(day.expect("its time is known").kind(), DayKind::RisesOrSets, "{row:?}");
            continue;
        }
        for (found, expected) in [(&sun.rises, rise), (&sun.transits, transit), (&sun.sets, set)] {
            let off = off_s(found, midnight, expected);
            assert!(off <= TOLERANCE_S, "{row:?}: {found:?}");
            worst = worst.max(off);
            count += 1;
        }
    }
    println!("{count} events; off by {worst:.1} s at most");
    assert!(count > 300, "{count} events");
}

#[test]
fn the_almanac_has_the_same_rises_and_sets_and_polar_days() {
    let tables = [
        ("usno_sunrise.csv", HORIZON_DEG, 100),
        ("usno_sunrise_civil.csv", -6.0, 100),
        ("usno_sunrise_extreme.csv", HORIZON_DEG, 60),
    ];
    for (name, horizon_deg, least) in tables {
        let Some(table) = solar(name) else { return };
        let (mut count, mut worst) = (0, 0.0_f64);
        for row in rows(&table) {
            let [time, latitude, longitude, kind, rise, set] = row[..] else { panic!("{row:?}") };
            let (place, midnight) = (place(latitude, longitude), midnight_of(time));
            let options = SunOptions::default();
            let sun = SunDay::over_horizon(&place, midnight, midnight + 24.hours(), horizon_deg, &options);
            let sun = sun.expect("in 2020");
            let expected = match kind {
                "NORMAL" => DayKind::RisesOrSets,
                "ALL_DAY" => DayKind::PolarDay,
                "ALL_NIGHT" => DayKind::PolarNight,
                _ => panic!("{row:?}"),
            };
            assert_eq!(sun.kind(), expected, "{row:?}");
            for (found, expected) in [(&sun.rises, rise), (&sun.sets, set)] {
                if expected.is_empty() {
                    assert!(found.is_empty(), "{row:?}: {found:?}");
                    continue;
                }
                let off = off_s(found, midnight, expected);
                assert!(off <= TOLERANCE_S, "{row:?}: {found:?}, off by {off} s");
                worst = worst.max(off);
            }
            count += 1;
        }
        println!("{name}: {count} days; off by {worst:.1} s at most, of which 30 s may be its rounding");
        assert!(count >= least, "{name}: {count} days");
    }
}

/// UTC, of the day of `time`.
fn midnight_of(time: &str) -> Timestamp {
    moment(&format!("{}T00:00:00Z", &time[..10]))
}

/// From the nearest of `found` to the time of day `expected`, which may have seconds.
fn off_s(found: &[Timestamp], midnight: Timestamp, expected: &str) -> f64 {
    let clock: Time = expected.parse().expect(expected);
    let expected = midnight + clock.duration_since(Time::midnight());
    let off = found.iter().map(|found| found.duration_since(expected).as_secs_f64().abs());
    off.fold(f64::INFINITY, f64::min)
}

/// Tromso in a year: its polar night, its polar day, and the days around them on which the sun only rises or only sets by the clock.
#[test]
fn beyond_the_polar_circle_the_sun_is_up_as_long_as_the_spans_say() {
    let tromso = place("69.65", "18.96");
    let options = SunOptions::default();
    let mut kinds = [0; 3];
    let mut midnight = moment("2026-01-01T00:00:00Z");
    for _ in 0..365 {
        let end = midnight + 24.hours();
        let sun = SunDay::between(&tromso, midnight, end, &options).expect("in 2026");
        // Each minute's sun, as a slow second opinion.
        let minutes = (0..1440).filter(|minute| {
            let geometric = SunOptions { refraction: Refraction::None, ..options };
            let time = midnight + SignedDuration::from_secs(minute * 60 + 30);
            Sun::at(&tromso, time, &geometric).expect("in 2026").altitude_rad.to_degrees() > HORIZON_DEG
        });
        // Each rise and set falls into one minute, which counts whole.
        let off_s = (sun.day_length_s() - minutes.count() as f64 * 60.0).abs();
        assert!(off_s <= 30.0 * (sun.rises.len() + sun.sets.len()) as f64 + 0.01, "{midnight}: {sun:?}, off {off_s} s");
        kinds[sun.kind() as usize] += 1;
        midnight = end;
    }
    assert!(kinds[1] > 60 && kinds[2] > 40, "{kinds:?}");
}

#[test]
fn spans_of_the_sun_begin_and_end_at_its_least_altitude_as_it_is_seen() {
    let vienna = place("48.21", "16.37");
    let [start, end] = ["2026-03-19T23:00:00Z", "2026-03-21T23:00:00Z"].map(moment);
    for refraction in [Refraction::Standard, Refraction::None] {
        for degrees in [0.0_f64, 11.0, 30.0] {
            let options = SunOptions { refraction, min_altitude_rad: degrees.to_radians(), ..SunOptions::default() };
            let spans = spans_of_sun(&vienna, start, end, &options).expect("in 2026");
            assert_eq!(spans.len(), 2, "{spans:?}");
            for edge in spans.into_iter().flatten() {
                let sun = Sun::at(&vienna, edge, &options).expect("in 2026");
                assert!((sun.altitude_rad.to_degrees() - degrees).abs() < 1e-5, "{edge}: {sun:?}");
            }
        }
    }
    let too_high = SunOptions { min_altitude_rad: 1.4, ..SunOptions::default() };
    assert_eq!(spans_of_sun(&vienna, start, end, &too_high), Ok(Vec::new()));
}

#[test]
fn a_path_is_the_sun_to_a_millisecond_of_its_way() {
    let places = ["48.21,16.37", "0,0", "-77.85,166.67", "89.9,0", "23.43,-170", "-33.9,151.2"];
    let air = Refraction::Air { pressure_hpa: 800.0, temperature_c: -10.0 };
    for text in places {
        let (latitude, longitude) = text.split_once(',').expect("two numbers");
        let place = place(latitude, longitude);
        for refraction in [Refraction::Standard, Refraction::None, air] {
            let options = SunOptions { refraction, ..SunOptions::default() };
            for date in ["2026-03-20", "2026-06-21", "2026-12-21"] {
                let start = moment(&format!("{date}T00:00:07Z"));
                let end = start + 24.hours();
                let path = SunPath::new(&place, start, end, &options).expect("in 2026");
                let mut worst = 0.0_f64;
                for time in start.series(61.seconds()).take_while(|time| *time <= end).chain([end]) {
                    let (slow, fast) = (Sun::at(&place, time, &options).expect("in 2026"), path.at(time));
                    // The algorithm bends no light from below the horizon: where that begins the two may differ by a rounding and so by half a degree.
                    let is_at_the_jump = (slow.altitude_rad.to_degrees() - HORIZON_DEG).abs() < 1e-6
                        || (fast.altitude_rad.to_degrees() - HORIZON_DEG).abs() < 1e-6;
                    if !is_at_the_jump {
                        worst = worst.max(slow.direction(0.0).distance(fast.direction(0.0)));
                    }
                }
                assert!(worst < 1e-8, "{text} {date} {refraction:?}: {worst:e}");
            }
        }
    }
}

#[test]
#[should_panic(expected = "is not on the path from")]
fn a_path_does_not_go_on_for_ever() {
    let [start, end] = ["2026-03-20T00:00:00Z", "2026-03-20T01:00:00Z"].map(moment);
    let path = SunPath::new(&place("0", "0"), start, end, &SunOptions::default()).expect("in 2026");
    path.at(end + 1.second());
}

#[test]
fn the_equation_of_time_is_the_almanacs() {
    // Meeus, Astronomical Algorithms, example 28.b: 13 min 42.6 s at 0 h dynamical time.
    let off_s = equation_of_time_s(moment("1992-10-12T23:59:01Z")).expect("in 1992");
    // His mean sun goes on for the 59 s between the two times, which is 0.16 s, and his sun is good to 0.01 degrees.
    assert!((off_s - (13.0 * 60.0 + 42.6)).abs() < 0.5, "{off_s}");
    // By his formulas of low accuracy, 0.01 degrees, which is 2.4 s.
    let of = |date: &str| equation_of_time_s(moment(&format!("{date}T12:00:00Z"))).expect("in 2026");
    assert!((of("2026-02-11") - -851.9).abs() < 2.4, "{}", of("2026-02-11"));
    assert!((of("2026-11-03") - 986.6).abs() < 2.4, "{}", of("2026-11-03"));
    assert!((of("2026-04-15") - -2.1).abs() < 2.4 && (of("2026-06-13") - -6.0).abs() < 2.4);
}

#[test]
fn the_seasons_of_2026_begin_when_the_almanac_says() {
    let seasons = equinoxes_and_solstices(2026).expect("in 2026");
    let almanac = ["2026-03-20T14:46:00Z", "2026-06-21T08:24:00Z", "2026-09-23T00:05:00Z", "2026-12-21T20:50:00Z"];
    for (found, expected) in seasons.into_iter().zip(almanac) {
        assert!(found.duration_since(moment(expected)).as_secs_f64().abs() <= 60.0, "{found} {expected}");
    }
}

#[test]
fn a_sun_that_nobody_knows_is_refused() {
    let rome = place("41.9", "12.5");
    for time in ["-000600-03-15T12:00:00Z", "+003500-01-01T00:00:00Z"] {
        let refused = Sun::at(&rome, moment(time), &SunOptions::default());
        assert!(matches!(refused, Err(TimeError::NoSun { .. })), "{refused:?}");
    }
    let nonsense = Refraction::Air { pressure_hpa: -1.0, temperature_c: 10.0 };
    let options = SunOptions { refraction: nonsense, ..SunOptions::default() };
    let refused = Sun::at(&rome, moment("2026-01-01T00:00:00Z"), &options);
    assert!(matches!(refused, Err(TimeError::Air { .. })), "{refused:?}");
}
