//! `umbrae sun`: the table, the JSON and the diagram, and what it refuses.

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::Value;

use crate::files::Place;

const VIENNA: [&str; 5] = ["sun", "--lat", "48.2", "--lon", "16.37"];

fn lines(place: &Place, args: &[&str]) -> String {
    let output = place.umbrae(args).success().get_output().stdout.clone();
    String::from_utf8(output).expect("text")
}

#[test]
fn a_day_is_printed_with_the_offset_of_its_clock() {
    let place = Place::new();
    let args = [&VIENNA[..], &["--date", "2026-09-18", "--from", "09:00", "--to", "17:00", "--step", "1h"]].concat();
    let text = lines(&place, &args);
    // By NREL's calculator: rise 06:35, transit 12:48:41, set 19:01.
    for words in [
        "48.2000° N, 16.3700° E; clocks of Europe/Vienna (found from the place)",
        "2026-09-18, Friday, UTC+02:00",
        "sunrise  06:35:2",
        "transit  12:48:41",
        "sunset   19:01:0",
        "12:00:00+02:00  163.41",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert_eq!(text.lines().filter(|line| line.contains("00:00+02:00")).count(), 9, "{text}");
    assert!(place.written().is_empty());
}

#[test]
fn the_clocks_of_two_sides_of_a_change_are_told_apart() {
    let place = Place::new();
    let text = lines(
        &place,
        &[&VIENNA[..], &["--date", "2026-03-29", "--from", "00:00", "--to", "06:00", "--step", "1h"]].concat(),
    );
    assert!(text.contains("2026-03-29, Sunday, UTC+01:00, from 03:00 +02:00"), "{text}");
    assert!(
        text.contains("01:00:00+01:00") && text.contains("03:00:00+02:00") && !text.contains("02:00:00+"),
        "{text}"
    );
    let twice = [&VIENNA[..], &["--date", "2026-10-25", "--from", "02:30", "--to", "04:00"]].concat();
    place
        .umbrae(&twice)
        .success()
        .stderr(contains("02:30 comes twice on 2026-10-25 in Europe/Vienna; the first is meant"));
}

#[test]
fn polar_days_and_nights_are_said_in_words() {
    let place = Place::new();
    let tromso =
        ["sun", "--lat", "69.65", "--lon", "18.96", "--date", "2026-06-21", "--date", "2026-12-21", "--step", "6h"];
    let text = lines(&place, &tromso);
    assert!(text.contains("polar day: the sun does not set"), "{text}");
    assert!(text.contains("polar night: the sun does not rise"), "{text}");
    let night = text.split("2026-12-21").nth(1).expect("the second day");
    assert!(!night.contains("azimuth  altitude"), "there is nothing to list: {night}");
}

#[test]
fn the_sundial_has_its_noon_at_twelve() {
    let place = Place::new();
    let text = lines(&place, &[&VIENNA[..], &["--date", "2026-02-11", "--solar-time", "--step", "2h"]].concat());
    assert!(text.contains("true solar time, by the calendar of Europe/Vienna"), "{text}");
    assert!(text.contains("transit  12:00:00") && text.contains("12:00:00+00:51:18  180.0000"), "{text}");
}

#[test]
fn the_json_has_what_a_study_takes() {
    let place = Place::new();
    let args = [
        &VIENNA[..],
        &["--date", "2026-09-18", "--from", "09:00", "--to", "17:00", "--middles", "--geometric", "--json", "-"],
    ];
    let json: Value = serde_json::from_str(&lines(&place, &args.concat())).expect("JSON and nothing else");
    assert_eq!((&json["zone"], &json["zone_is_derived"]), (&"Europe/Vienna".into(), &true.into()));
    let rows = json["days"][0]["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 32);
    assert_eq!(rows[0]["local"], "2026-09-18T09:07:30+02:00");
    assert_eq!(rows[0]["utc"], "2026-09-18T07:07:30Z");
    assert!(json["angles"].as_str().expect("text").contains("without refraction"));
}

#[test]
fn the_diagram_is_an_svg_with_a_way_for_each_date_and_season() {
    let place = Place::new();
    let (svg, json) = (place.out("sun.svg"), place.out("sun.json"));
    let dates = ["--date", "2026-09-18", "--date", "2026-11-05", "--diagram", &svg, "--json", &json];
    place.umbrae(&[&VIENNA[..], &dates].concat()).success().stdout(contains("sunrise"));
    assert_eq!(place.written(), ["sun.json", "sun.svg"]);
    let drawing = std::fs::read_to_string(&svg).expect("it was written");
    for words in [
        "The sun at 48.2000° N, 16.3700° E",
        "2026-09-18",
        "2026-11-05",
        "21 June (solstice)",
        "20 March and 23 September (equinoxes)",
        "21 December (solstice)",
        "hours of UTC+02:00",
        "</svg>",
    ] {
        assert!(drawing.contains(words), "{words}");
    }
    assert!(!drawing.contains("NaN") && !drawing.contains("inf"));
    // Both ways cross the meridian below the zenith at 90 - 48.2 + declination degrees, and neither leaves the sky.
    let circle = |line: &str| {
        let number =
            |name: &str| -> Option<f64> { line.split_once(&format!("{name}=\""))?.1.split('"').next()?.parse().ok() };
        Some([number(" cx")?, number(" cy")?])
    };
    let dots: Vec<[f64; 2]> = drawing.lines().filter(|line| line.contains("r=\"3\"")).filter_map(circle).collect();
    assert_eq!(dots.len(), 13 + 9, "full hours from 7 to 19 and from 7 to 16 but for that of the rise: {dots:?}");
    assert!(dots.iter().all(|[x, y]| (x - 410.0).hypot(y - 470.0) < 350.0), "{dots:?}");
}

#[test]
fn many_dates_are_drawn_in_part_and_the_legend_says_so() {
    let place = Place::new();
    let svg = place.out("sun.svg");
    let args = [&VIENNA[..], &["--dates", "2026-02-01..2026-03-21", "--step", "6h", "--diagram", &svg]].concat();
    place.umbrae(&args).success();
    let drawing = std::fs::read_to_string(&svg).expect("it was written");
    assert!(drawing.contains("2026-02-01") && drawing.contains("2026-03-21"));
    assert!(drawing.contains("43 dates between these are not drawn"));
}

#[test]
fn what_has_no_sun_is_refused_in_a_sentence_and_nothing_is_written() {
    let place = Place::new();
    let (svg, json) = (place.out("sun.svg"), place.out("sun.json"));
    let files = ["--diagram", svg.as_str(), "--json", json.as_str()];
    let cases: &[(&[&str], &[&str])] = &[
        (&["--date", "2026-09-18"], &["the sun of which place? give --lat and --lon"]),
        (&["--lat", "48.2", "--lon", "16.37"], &["the sun of which day? give --date or --dates"]),
        (&["--lat", "95", "--lon", "0", "--date", "2026-09-18"], &["--lat", "a latitude of 95.0 is not on Earth"]),
        (&["--lat", "48", "--lon", "0", "--date", "2026-02-30"], &["--date", "February 2026 has days 01 to 28"]),
        (
            &["--lat", "48", "--lon", "0", "--date", "2026-09-18", "--tz", "Europe/Viena"],
            &["--tz", "there is no time zone `Europe/Viena`; did you mean `Europe/Vienna`"],
        ),
        (
            &["--lat", "48.2", "--lon", "16.37", "--date", "2026-03-29", "--from", "02:30", "--to", "09:00"],
            &["02:30 on 2026-03-29 does not exist in Europe/Vienna", "from 02:00 (+01:00) straight to 03:00 (+02:00)"],
        ),
        (
            &["--lat", "-13.83", "--lon", "-171.76", "--date", "2011-12-30"],
            &["there was no 2011-12-30 in Pacific/Apia", "from 2011-12-29 straight to 2011-12-31"],
        ),
        (
            &["--lat", "48.2", "--lon", "16.37", "--date", "2026-09-18", "--from", "17:00", "--to", "09:00"],
            &["on 2026-09-18 the time from 17:00 to 09:00 is empty"],
        ),
        (
            &["--lat", "48.2", "--lon", "16.37", "--date", "3500-01-01"],
            &["where the sun is on 3499-12-31 is not known"],
        ),
    ];
    for (options, words) in cases {
        place.refuses(&[&["sun"], *options, &files].concat(), words);
    }
    let day = ["--date", "2026-09-18", "--diagram", "sun.png"];
    place.refuses(&[&VIENNA[..], &day].concat(), &["sun.png", "give a name that ends in .svg"]);
    assert!(place.written().is_empty(), "{:?}", place.written());
}

#[test]
fn the_zone_can_be_another_than_that_of_the_place() {
    let place = Place::new();
    let args = [&VIENNA[..], &["--date", "2026-09-18", "--tz", "-09:30", "--step", "6h"]].concat();
    let as_asked = contains("clocks of -09:30 (as asked for)").and(contains("UTC-09:30"));
    place.umbrae(&args).success().stdout(as_asked);
}
