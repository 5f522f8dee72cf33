//! Steps of a study: which there are, what they stand for, and what the clock shows.

use jiff::SignedDuration;
use umbrae_study::{
    Clock, Edge, Period, Place, Sun, SunDay, SunOptions, TimeError, Timetable, Zone, parse_dates, parse_step,
    spans_of_sun,
};

fn place(latitude: f64, longitude: f64) -> Place {
    Place::from_degrees(latitude, longitude).expect("a place")
}

fn vienna() -> Place {
    place(48.21, 16.37)
}

fn period(place: &Place, dates: &str, from: &str, to: &str, step: &str) -> Period {
    Period {
        clock: Clock::civil(Zone::of_place(place)),
        dates: parse_dates(dates).expect(dates),
        from: Edge::parse_from(from).expect(from),
        to: Edge::parse_to(to).expect(to),
        step: parse_step(step).expect(step),
    }
}

fn timetable(place: &Place, dates: &str, from: &str, to: &str, step: &str) -> Timetable {
    Timetable::new(place, &period(place, dates, from, to, step), &SunOptions::default()).expect("it has steps")
}

#[test]
fn steps_fill_the_window_and_stand_for_their_middles() {
    let timetable = timetable(&vienna(), "2026-09-18", "09:00", "17:00", "15min");
    assert_eq!(timetable.steps.len(), 32);
    assert!(timetable.steps.windows(2).all(|pair| pair[0].end == pair[1].start));
    assert_eq!(timetable.steps[0].local_start().to_string(), "2026-09-18T09:00:00");
    assert_eq!(timetable.steps[0].local_middle().to_string(), "2026-09-18T09:07:30");
    assert_eq!(timetable.steps[31].end.to_string(), "2026-09-18T15:00:00Z");
    for step in &timetable.steps {
        assert_eq!(Ok(step.sun), Sun::at(&vienna(), step.middle(), &SunOptions::default()));
        assert!(step.is_day && step.utc_offset_s == 7200);
    }
    assert_eq!(timetable.offsets_of_day(0), "+02:00");
}

#[test]
fn what_is_left_of_a_window_is_a_shorter_step_with_a_middle_of_its_own() {
    let period = period(&vienna(), "2026-09-18", "09:00", "10:10", "30min");
    let timetable = Timetable::new(&vienna(), &period, &SunOptions::default()).expect("it has steps");
    let lengths: Vec<f64> = timetable.steps.iter().map(umbrae_study::Step::duration_s).collect();
    assert_eq!(lengths, [1800.0, 1800.0, 600.0]);
    assert_eq!(timetable.steps[2].local_middle().to_string(), "2026-09-18T10:05:00");
    let note = "09:00 to 10:10 is no whole number of steps of 30min: the last is 10min, and stands for its own middle";
    assert_eq!(period.notes(), [note]);
}

#[test]
fn days_on_which_clocks_are_changed_have_each_moment_once() {
    for (date, hours, offsets) in [
        ("2026-03-29", 23, "+01:00, from 03:00 +02:00"),
        ("2026-10-25", 25, "+02:00, from 02:00 +01:00"),
        ("2026-10-26", 24, "+01:00"),
    ] {
        let timetable = timetable(&vienna(), date, "00:00", "24:00", "1h");
        assert_eq!(timetable.steps.len(), hours, "{date}");
        assert!(timetable.steps.windows(2).all(|pair| pair[0].end == pair[1].start));
        assert_eq!(timetable.offsets_of_day(0), offsets);
    }
    // The clock shows two o'clock twice, at two moments.
    let shown = timetable(&vienna(), "2026-10-25", "02:00", "03:00", "1h");
    assert_eq!(shown.steps.len(), 2);
    assert_eq!(shown.steps.iter().map(|step| step.utc_offset_s).collect::<Vec<_>>(), [7200, 3600]);
}

#[test]
fn a_window_that_begins_in_a_gap_is_refused_and_one_in_a_fold_is_told() {
    let gap = period(&vienna(), "2026-03-28..2026-03-30", "02:30", "17:00", "15min");
    let refused = Timetable::new(&vienna(), &gap, &SunOptions::default());
    assert!(matches!(refused, Err(TimeError::Gap { .. })), "{refused:?}");
    let fold = period(&vienna(), "2026-10-25", "02:30", "17:00", "15min");
    assert_eq!(fold.notes().len(), 1, "{:?}", fold.notes());
    let steps = Timetable::new(&vienna(), &fold, &SunOptions::default()).expect("the first of the two").steps;
    assert_eq!(steps[0].start.to_string(), "2026-10-25T00:30:00Z");
}

#[test]
fn without_times_a_day_is_from_sunrise_to_sunset() {
    let timetable = timetable(&vienna(), "2026-06-20..2026-06-22", "sunrise", "sunset", "15min");
    assert_eq!(timetable.days.len(), 3);
    for day in 0..3 {
        let steps = &timetable.steps[timetable.steps_of_day(day)];
        let (first, last) = (steps.first().expect("the sun is up"), steps.last().expect("the sun is up"));
        let length_h = last.end.duration_since(first.start).as_secs_f64() / 3600.0;
        assert!((length_h - 16.07).abs() < 0.02, "{length_h}");
        assert!(steps.iter().all(|step| step.is_day && step.day as usize == day));
    }
}

#[test]
fn edges_move_with_the_sun() {
    let place = vienna();
    let of = |from: &str, to: &str| {
        let steps = timetable(&place, "2026-03-20", from, to, "1h").steps;
        [steps[0].start, steps[steps.len() - 1].end]
    };
    let (whole, cut) = (of("sunrise", "sunset"), of("sunrise+1h", "sunset-90min"));
    assert_eq!(cut[0].duration_since(whole[0]), SignedDuration::from_hours(1));
    assert_eq!(whole[1].duration_since(cut[1]), SignedDuration::from_mins(90));
    assert_eq!(of("12:00", "sunset")[1], whole[1]);
    assert_eq!(of("sunrise", "12:00")[0], whole[0]);
    assert!(timetable(&place, "2026-03-20", "20:00", "sunset", "1h").steps.is_empty(), "it has set by then");
}

#[test]
fn in_polar_night_there_are_no_steps_and_in_polar_day_they_fill_the_day() {
    let tromso = place(69.65, 18.96);
    assert!(timetable(&tromso, "2026-12-21", "sunrise", "sunset", "15min").steps.is_empty());
    let night = timetable(&tromso, "2026-12-21", "09:00", "17:00", "15min");
    assert!(night.steps.len() == 32 && night.steps.iter().all(|step| !step.is_day));
    let day = timetable(&tromso, "2026-06-21", "sunrise+1h", "sunset", "15min");
    assert!(day.steps.len() == 96 && day.steps.iter().all(|step| step.is_day));
}

/// In June the sun of Reykjavik sets after midnight and rises soon again: a date has the end of one day and most of the next.
#[test]
fn a_date_on_which_the_sun_sets_before_it_rises_has_two_windows() {
    let reykjavik = place(64.15, -21.94);
    let period = period(&reykjavik, "2026-06-21", "sunrise", "sunset", "15min");
    let windows = period.windows(&reykjavik, &SunOptions::default()).expect("in 2026");
    assert_eq!(windows[0].spans.len(), 2, "{windows:?}");
    let timetable = Timetable::new(&reykjavik, &period, &SunOptions::default()).expect("in 2026");
    assert_eq!(timetable.steps[0].local_start().to_string(), "2026-06-21T00:00:00");
    let total_s: f64 = timetable.steps.iter().map(umbrae_study::Step::duration_s).sum();
    let sun = SunDay::between(&reykjavik, windows[0].day.start, windows[0].day.end, &SunOptions::default());
    assert!((total_s - sun.expect("in 2026").day_length_s()).abs() < 1e-6);
}

#[test]
fn steps_count_as_long_as_the_sun_does_but_for_half_a_step_at_each_edge() {
    let places = [vienna(), place(-33.87, 151.21), place(69.65, 18.96), place(0.0, 0.0)];
    for place in places {
        for degrees in [0.0_f64, 5.0, 11.0] {
            let options = SunOptions { min_altitude_rad: degrees.to_radians(), ..SunOptions::default() };
            let period = period(&place, "2026-02-01..2026-02-10", "00:00", "24:00", "10min");
            let timetable = Timetable::new(&place, &period, &options).expect("in 2026");
            let days = period.windows(&place, &options).expect("in 2026");
            for (day, window) in days.iter().enumerate() {
                let steps = &timetable.steps[timetable.steps_of_day(day)];
                let steps_s: f64 = steps.iter().filter(|step| step.is_day).map(umbrae_study::Step::duration_s).sum();
                let spans = spans_of_sun(&place, window.day.start, window.day.end, &options).expect("in 2026");
                let exact_s: f64 = spans.iter().map(|[from, to]| to.duration_since(*from).as_secs_f64()).sum();
                assert!((steps_s - exact_s).abs() <= 600.0 + 1e-3, "{place:?} {degrees}: {steps_s} {exact_s}");
            }
        }
    }
}

#[test]
fn steps_of_a_sundial_are_hours_of_the_sun() {
    let place = vienna();
    let civil = period(&place, "2026-12-22", "08:00", "16:00", "1h");
    let solar = Period { clock: Clock::solar(civil.clock.zone.clone()), ..civil };
    let timetable = Timetable::new(&place, &solar, &SunOptions::default()).expect("in 2026");
    assert_eq!(timetable.steps.len(), 8);
    for pair in timetable.steps.windows(2) {
        assert_eq!(pair[0].end, pair[1].start);
    }
    for (i, step) in timetable.steps.iter().enumerate() {
        // On that day hours of the sun are 1.24 s longer than others.
        assert!((step.duration_s() - 3601.24).abs() < 0.02, "{}", step.duration_s());
        assert_eq!(step.local_start().round(jiff::Unit::Second).expect("in range").hour(), 8 + i as i8);
        // As high before noon as after it, but for the change of the season.
        let mirrored = timetable.steps[7 - i].sun;
        assert!((step.sun.altitude_rad - mirrored.altitude_rad).abs() < 1e-4);
        assert!((step.sun.azimuth_rad + mirrored.azimuth_rad - std::f64::consts::TAU).abs() < 1e-4);
    }
    assert!(timetable.offsets_of_day(0).starts_with("+01:0"), "{}", timetable.offsets_of_day(0));
}

#[test]
fn each_date_is_studied_once_and_in_order() {
    let place = vienna();
    let mut twice = period(&place, "2026-03-20..2026-03-22", "12:00", "13:00", "1h");
    twice.dates.extend(parse_dates("2026-03-19..2026-03-20").expect("dates"));
    let timetable = Timetable::new(&place, &twice, &SunOptions::default()).expect("in 2026");
    let days: Vec<String> = timetable.days.iter().map(ToString::to_string).collect();
    assert_eq!(days, ["2026-03-19", "2026-03-20", "2026-03-21", "2026-03-22"]);
    assert_eq!(timetable.steps.len(), 4);
}

#[test]
fn periods_that_make_no_study_are_refused() {
    let place = vienna();
    let good = period(&place, "2026-03-20", "09:00", "17:00", "15min");
    let refusal = |period: Period| {
        let refused = Timetable::new(&place, &period, &SunOptions::default());
        refused.map(|timetable| timetable.steps.len()).expect_err("it is no study").to_string()
    };
    assert_eq!(refusal(Period { dates: Vec::new(), ..good.clone() }), "there is no date; give at least one");
    let reversed = Period { to: Edge::parse_to("08:00").expect("a time"), ..good.clone() };
    assert!(refusal(reversed).contains("the time from 09:00 to 08:00 is empty"));
    let instant = Period { to: Edge::parse_to("09:00").expect("a time"), ..good.clone() };
    assert!(refusal(instant).contains("is empty"));
    let frozen = Period { step: SignedDuration::ZERO, ..good.clone() };
    assert!(refusal(frozen).contains("a step of 0 s can't be used"));
    let seconds = Period {
        dates: parse_dates("2026-01-01..2029-12-31").expect("dates"),
        step: SignedDuration::from_secs(1),
        ..good.clone()
    };
    assert!(refusal(seconds).contains("more than 20000000 steps"));
    let below = SunOptions { min_altitude_rad: -0.1, ..SunOptions::default() };
    assert!(matches!(Timetable::new(&place, &good, &below), Err(TimeError::MinAltitude { .. })));
}
