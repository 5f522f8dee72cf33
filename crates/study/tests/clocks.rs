//! Clocks: what zones have done to days, and the sundial.

use std::f64::consts::{PI, TAU};

use jiff::civil::Date;
use jiff::{SignedDuration, Timestamp};
use proptest::prelude::*;
use umbrae_study::{Clock, LocalTime, Place, Refraction, Sun, SunOptions, TimeError, Zone, parse_date, parse_dates};

fn clock(zone: &str) -> Clock {
    Clock::civil(Zone::named(zone).expect(zone))
}

fn date(text: &str) -> Date {
    parse_date(text).expect(text)
}

fn time(text: &str) -> LocalTime {
    text.parse().expect(text)
}

fn anywhere() -> Place {
    Place::from_degrees(48.21, 16.37).expect("a place")
}

/// The moment, in UTC.
fn moment(clock: &Clock, on: &str, at: &str) -> Result<String, TimeError> {
    clock.moment(&anywhere(), date(on), time(at)).map(|moment| moment.to_string())
}

fn day_length(clock: &Clock, on: &str) -> SignedDuration {
    clock.day(&anywhere(), date(on)).expect(on).duration()
}

#[test]
fn in_vienna_half_past_two_does_not_exist_on_the_29_of_march_2026() {
    let vienna = clock("Europe/Vienna");
    let error = moment(&vienna, "2026-03-29", "02:30").expect_err("clocks skip it").to_string();
    assert_eq!(
        error,
        "02:30 on 2026-03-29 does not exist in Europe/Vienna: clocks went from 02:00 (+01:00) straight to 03:00 (+02:00); \
         give a time before or after that"
    );
    assert!(moment(&vienna, "2026-03-29", "02:00").is_err(), "the first that is skipped");
    assert_eq!(moment(&vienna, "2026-03-29", "01:59:59").as_deref(), Ok("2026-03-29T00:59:59Z"));
    assert_eq!(moment(&vienna, "2026-03-29", "03:00").as_deref(), Ok("2026-03-29T01:00:00Z"));
    assert_eq!(day_length(&vienna, "2026-03-29"), SignedDuration::from_hours(23));
}

#[test]
fn in_vienna_half_past_two_comes_twice_on_the_25_of_october_2026() {
    let vienna = clock("Europe/Vienna");
    assert_eq!(moment(&vienna, "2026-10-25", "02:30").as_deref(), Ok("2026-10-25T00:30:00Z"));
    assert_eq!(moment(&vienna, "2026-10-25", "02:30+02:00").as_deref(), Ok("2026-10-25T00:30:00Z"));
    assert_eq!(moment(&vienna, "2026-10-25", "02:30+01:00").as_deref(), Ok("2026-10-25T01:30:00Z"));
    let note = vienna.fold_note(date("2026-10-25"), time("02:30")).expect("it comes twice");
    assert!(note.contains("comes twice on 2026-10-25 in Europe/Vienna") && note.contains("02:30+01:00"), "{note}");
    assert_eq!(vienna.fold_note(date("2026-10-24"), time("02:30")), None);
    assert_eq!(vienna.fold_note(date("2026-10-25"), time("02:30+01:00")), None);
    assert_eq!(day_length(&vienna, "2026-10-25"), SignedDuration::from_hours(25));
}

#[test]
fn an_offset_that_the_clocks_do_not_have_is_refused() {
    let vienna = clock("Europe/Vienna");
    let error = moment(&vienna, "2026-07-01", "09:00+01:00").expect_err("it is summer").to_string();
    assert!(error.contains("whose clocks are +02:00 then") && error.ends_with("the time zone +01:00"), "{error}");
    assert_eq!(moment(&clock("+01:00"), "2026-07-01", "09:00").as_deref(), Ok("2026-07-01T08:00:00Z"));
    assert_eq!(moment(&clock("+01:00"), "2026-07-01", "09:00+01:00").as_deref(), Ok("2026-07-01T08:00:00Z"));
}

#[test]
fn on_lord_howe_clocks_are_changed_by_half_an_hour() {
    let island = clock("Australia/Lord_Howe");
    assert_eq!(day_length(&island, "2026-04-05"), SignedDuration::from_mins(24 * 60 + 30));
    assert_eq!(day_length(&island, "2026-10-04"), SignedDuration::from_mins(24 * 60 - 30));
    let error = moment(&island, "2026-10-04", "02:15").expect_err("clocks skip it").to_string();
    assert!(error.contains("from 02:00 (+10:30) straight to 02:30 (+11:00)"), "{error}");
    assert_eq!(moment(&island, "2026-04-05", "01:45+10:30").as_deref(), Ok("2026-04-04T15:15:00Z"));
}

#[test]
fn kathmandu_and_chatham_are_a_quarter_of_an_hour_off() {
    assert_eq!(moment(&clock("Asia/Kathmandu"), "2026-06-21", "12:00").as_deref(), Ok("2026-06-21T06:15:00Z"));
    assert_eq!(moment(&clock("Pacific/Chatham"), "2026-06-21", "12:00").as_deref(), Ok("2026-06-20T23:15:00Z"));
    assert_eq!(moment(&clock("Pacific/Chatham"), "2026-12-21", "12:00").as_deref(), Ok("2026-12-20T22:15:00Z"));
    let error = moment(&clock("Pacific/Chatham"), "2026-09-27", "03:00").expect_err("clocks skip it").to_string();
    assert!(error.contains("from 02:45 (+12:45) straight to 03:45 (+13:45)"), "{error}");
}

#[test]
fn samoa_had_no_30_of_december_2011() {
    let samoa = clock("Pacific/Apia");
    let error = moment(&samoa, "2011-12-30", "12:00").expect_err("there was none").to_string();
    assert_eq!(
        error,
        "there was no 2011-12-30 in Pacific/Apia: its clocks went from 2011-12-29 straight to 2011-12-31"
    );
    let [before, after] = ["2011-12-29", "2011-12-31"].map(|on| samoa.day(&anywhere(), date(on)).expect(on));
    assert_eq!(before.end, after.start);
    assert_eq!([before.duration(), after.duration()], [SignedDuration::from_hours(24); 2]);
    // Nor has a sundial under its calendar.
    let place = Place::from_degrees(-13.8, -171.8).expect("Apia");
    let sundial = Clock::solar(samoa.zone);
    assert!(matches!(sundial.day(&place, date("2011-12-30")), Err(TimeError::SkippedDay { .. })));
}

#[test]
fn at_troll_clocks_are_changed_by_two_hours() {
    let troll = clock("Antarctica/Troll");
    assert_eq!(day_length(&troll, "2026-03-29"), SignedDuration::from_hours(22));
    assert_eq!(day_length(&troll, "2026-10-25"), SignedDuration::from_hours(26));
    assert_eq!(moment(&troll, "2026-10-25", "02:30").as_deref(), Ok("2026-10-25T00:30:00Z"));
    assert_eq!(moment(&troll, "2026-10-25", "02:30+00:00").as_deref(), Ok("2026-10-25T02:30:00Z"));
}

#[test]
fn a_day_whose_clock_skips_midnight_begins_with_its_first_moment() {
    // Cuba: from 00:00 to 01:00.
    let havana = clock("America/Havana");
    assert_eq!(moment(&havana, "2026-03-08", "00:00").as_deref(), Ok("2026-03-08T05:00:00Z"));
    assert_eq!(moment(&havana, "2026-03-07", "24:00").as_deref(), Ok("2026-03-08T05:00:00Z"));
    assert_eq!(day_length(&havana, "2026-03-08"), SignedDuration::from_hours(23));
    assert!(moment(&havana, "2026-03-08", "00:30").is_err());
    // Toronto in 1919: from 23:30 to 00:30 of the next day.
    let toronto = clock("America/Toronto");
    assert_eq!(day_length(&toronto, "1919-03-30"), SignedDuration::from_mins(23 * 60 + 30));
    assert_eq!(day_length(&toronto, "1919-03-31"), SignedDuration::from_mins(23 * 60 + 30));
}

#[test]
fn east_and_west_of_the_date_line_the_same_noon_has_two_dates() {
    assert_eq!(moment(&clock("Pacific/Kiritimati"), "2026-06-22", "12:00").as_deref(), Ok("2026-06-21T22:00:00Z"));
    assert_eq!(moment(&clock("Pacific/Pago_Pago"), "2026-06-21", "11:00").as_deref(), Ok("2026-06-21T22:00:00Z"));
    // Sundials as well: both islands are at some 160 to 170 degrees west.
    for (zone, longitude) in [("Pacific/Kiritimati", -157.4), ("Pacific/Pago_Pago", -170.7), ("Pacific/Fiji", 178.4)] {
        let place = Place::from_degrees(0.0, longitude).expect("a place");
        let zone = Zone::named(zone).expect(zone);
        let noon = Clock::solar(zone.clone()).moment(&place, date("2026-06-21"), time("12:00")).expect("in 2026");
        let civil = zone.time_zone().to_datetime(noon);
        assert_eq!(civil.date(), date("2026-06-21"), "{civil}");
        assert!((11..=13).contains(&civil.hour()), "{civil}");
    }
}

#[test]
fn the_days_of_a_year_follow_each_other_and_only_changes_of_clocks_make_them_longer_or_shorter() {
    let zones = [
        ("Europe/Vienna", &[60, -60][..]),
        ("America/New_York", &[60, -60]),
        ("Australia/Lord_Howe", &[30, -30]),
        ("Pacific/Chatham", &[60, -60]),
        ("Antarctica/Troll", &[120, -120]),
        ("Africa/Cairo", &[60, -60]),
        ("Asia/Kathmandu", &[]),
        ("Pacific/Kiritimati", &[]),
        ("Etc/GMT+12", &[]),
        ("UTC", &[]),
    ];
    for (zone, odd_minutes) in zones {
        let clock = clock(zone);
        let days = parse_dates("2026-01-01..2026-12-31").expect("a year");
        let days = days.into_iter().map(|date| clock.day(&anywhere(), date).expect(zone));
        let days: Vec<_> = days.collect();
        assert!(days.windows(2).all(|pair| pair[0].end == pair[1].start), "{zone}");
        let mut odd: Vec<i64> = days.iter().map(|day| day.duration().as_mins() - 1440).filter(|m| *m != 0).collect();
        odd.sort_unstable_by(|a, b| b.cmp(a));
        assert_eq!(odd, odd_minutes, "{zone}");
        for day in &days {
            let zone = clock.zone.time_zone();
            assert_eq!(zone.to_datetime(day.start).date(), day.date);
            assert_eq!(zone.to_datetime(day.end - SignedDuration::from_nanos(1)).date(), day.date);
        }
    }
}

#[test]
fn places_have_the_zones_that_people_there_have() {
    let places = [
        (48.21, 16.37, "Europe/Vienna"),
        (52.52, 13.405, "Europe/Berlin"),
        (-33.87, 151.21, "Australia/Sydney"),
        (27.7, 85.3, "Asia/Kathmandu"),
        (-31.55, 159.08, "Australia/Lord_Howe"),
        (1.87, -157.43, "Pacific/Kiritimati"),
        (-13.83, -171.76, "Pacific/Apia"),
        (40.71, -74.0, "America/New_York"),
        // At sea, whole hours: the sign of these names is the opposite of what it looks like.
        (30.0, -40.0, "Etc/GMT+3"),
        (0.0, 0.0, "Etc/GMT"),
    ];
    for (latitude, longitude, name) in places {
        let zone = Zone::of_place(&Place::from_degrees(latitude, longitude).expect(name));
        assert_eq!(zone.name(), name);
        assert!(zone.is_derived());
    }
    for (latitude, longitude) in [(90.0, 0.0), (-90.0, 0.0), (0.0, 180.0), (0.0, -180.0), (90.0, 180.0)] {
        let place = Place::from_degrees(latitude, longitude).expect("a place");
        assert!(!Zone::of_place(&place).name().is_empty());
    }
}

#[test]
fn at_noon_by_the_sundial_the_sun_is_due_south_or_north() {
    let bare = SunOptions { refraction: Refraction::None, ..SunOptions::default() };
    for (latitude, longitude, due_rad) in
        [(48.21, 16.37, PI), (-33.87, 151.21, 0.0), (60.0, -150.0, PI), (-78.0, 166.7, 0.0)]
    {
        let place = Place::from_degrees(latitude, longitude).expect("a place");
        let sundial = Clock::solar(Zone::of_place(&place));
        for on in ["2026-02-11", "2026-06-21", "2026-11-03", "2026-12-21"] {
            let noon = sundial.moment(&place, date(on), time("12:00")).expect("in 2026");
            let sun = Sun::at(&place, noon, &bare).expect("in 2026");
            let off_rad = (sun.azimuth_rad - due_rad + PI).rem_euclid(TAU) - PI;
            // A hundredth of a second of the sun's way.
            assert!(off_rad.abs() < 2e-6, "{latitude} {on}: {sun:?}");
            // The other days' midnights are lower transits: due north, or south.
            let midnight = sundial.day(&place, date(on)).expect("in 2026").start;
            let sun = Sun::at(&place, midnight, &bare).expect("in 2026");
            let off_rad = (sun.azimuth_rad - due_rad).rem_euclid(TAU) - PI;
            assert!(off_rad.abs() < 2e-6, "{latitude} {on}: {sun:?}");
        }
    }
}

#[test]
fn days_of_a_sundial_follow_each_other_and_are_within_half_a_minute_of_24_hours() {
    let vienna = anywhere();
    let sundial = Clock::solar(Zone::of_place(&vienna));
    let days = parse_dates("2026-01-01..2026-12-31").expect("a year");
    let days: Vec<_> = days.into_iter().map(|date| sundial.day(&vienna, date).expect("in 2026")).collect();
    for pair in days.windows(2) {
        let apart = pair[1].start.duration_since(pair[0].end);
        assert!(apart.abs() < SignedDuration::from_micros(100), "{pair:?}");
        let off_s = pair[0].duration().as_secs_f64() - 86_400.0;
        assert!(off_s.abs() < 31.0, "{pair:?}");
    }
    let longest = days.iter().map(|day| day.duration().as_secs_f64()).fold(0.0, f64::max);
    assert!((longest - 86_429.8).abs() < 0.5, "22 December is the longest: {longest}");
    let error = sundial.moment(&vienna, date("2026-06-21"), time("12:00+02:00")).expect_err("an offset").to_string();
    assert!(error.contains("true solar time has not"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// What a clock is said to show it shows, or it skips it.
    #[test]
    fn a_moment_of_a_clock_is_shown_by_it(
        zone in prop::sample::select(vec![
            "Europe/Vienna", "Europe/Dublin", "America/St_Johns", "America/Havana", "Asia/Tehran", "Africa/Cairo",
            "Australia/Lord_Howe", "Pacific/Apia", "Antarctica/Troll", "Africa/Casablanca", "Asia/Kathmandu",
        ]),
        day in 0_i32..50_000,
        second in 1_u32..86_400,
    ) {
        let clock = clock(zone);
        let date = date("1900-01-01").checked_add(jiff::Span::new().days(day)).expect("in the calendar");
        let text = format!("{:02}:{:02}:{:02}", second / 3600, second / 60 % 60, second % 60);
        let shown = |moment: Timestamp| clock.zone.time_zone().to_datetime(moment);
        match clock.moment(&anywhere(), date, time(&text)) {
            Ok(moment) => {
                prop_assert_eq!(shown(moment).date(), date);
                prop_assert_eq!(shown(moment).time().to_string(), text);
                let day = clock.day(&anywhere(), date).expect("it has the moment");
                let is_in_it = day.start <= moment && moment < day.end;
                // The clock may have gone back over midnight.
                prop_assert!(is_in_it || clock.fold_note(date, time("00:00:30")).is_some(), "{:?} {}", day, moment);
            }
            Err(TimeError::Gap { before, after, .. }) => {
                let skipped = date.to_datetime(text.parse().expect("a time"));
                prop_assert!(before <= skipped && skipped < after);
            }
            Err(TimeError::SkippedDay { .. }) => prop_assert_eq!(zone, "Pacific/Apia"),
            Err(other) => prop_assert!(false, "{}", other),
        }
    }
}
