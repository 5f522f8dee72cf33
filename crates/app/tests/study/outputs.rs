//! Each file of a study, read again.

use serde_json::Value;
use tiff::tags::Tag;

use crate::files::Place;
use crate::studied::{SLAB, Studied, WHEN};

fn slab(place: &Place, name: &str, more: &str) -> Studied {
    let model = place.file("slab.obj", SLAB);
    Studied::new(place, name, &format!("{model} {WHEN} {more}"))
}

#[test]
fn all_files_are_there_and_run_json_names_them() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2");
    let mut expected = vec![
        "bits.npz",
        "day.apng",
        "hours.png",
        "hours.tif",
        "objects.csv",
        "profile.png",
        "receivers.csv",
        "report.html",
        "shadows.geojson",
    ];
    let run = study.json("run.json");
    let mut named: Vec<&str> = run["files"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    named.sort_unstable();
    assert_eq!(named, expected);
    expected.push("run.json");
    expected.sort_unstable();
    assert_eq!(study.names(), expected, "and nothing of the work is left");
    assert_eq!(run["partial"], false);
    assert!(run["timings"]["engine_s"].as_f64().expect("a number") > 0.0);
    assert_eq!(run["check"]["disagreements"], 0);
    assert!(run["check"]["verdicts"].as_u64().expect("a number") > 10_000);
    // sha256sum of the file.
    assert_eq!(run["inputs"][0]["sha256"].as_str().map(str::len), Some(64));
    assert_eq!(run["parameters"]["utc_offset"], "+02:00");
    assert_eq!(run["parameters"]["hours_of_day"], "09:00 to 17:00");
}

#[test]
fn the_grid_of_the_tiff_is_that_of_the_table() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2");
    let (width, height, values) = study.tif("hours.tif");
    let rows = study.rows();
    assert_eq!((rows.len(), values.len()), (width * height, width * height));
    let mut decoder = study.decoder("hours.tif");
    let scale = decoder.get_tag_f64_vec(Tag::ModelPixelScaleTag).expect("a scale");
    let tie = decoder.get_tag_f64_vec(Tag::ModelTiepointTag).expect("a tie point");
    assert_eq!(scale, [2.0, 2.0, 0.0]);
    let mut inside = 0;
    for (i, (row, &value)) in rows.iter().zip(&values).enumerate() {
        // The middle of the cell, from its corner.
        let middle = [tie[3] + ((i % width) as f64 + 0.5) * 2.0, tie[4] - ((i / width) as f64 + 0.5) * 2.0];
        assert!((middle[0] - row.number("x")).abs() < 1e-3 && (middle[1] - row.number("y")).abs() < 1e-3, "{row:?}");
        let hours = row.number("hours") as f32;
        assert_eq!(hours.to_bits(), value.to_bits(), "{row:?}");
        assert!(!row.text("hours").starts_with('-'), "no sun is 0 and not -0: {row:?}");
        inside += usize::from(row.text("note") == "inside a solid");
        assert_eq!(value.is_nan(), row.text("note") == "inside a solid");
    }
    assert!((15..=80).contains(&inside), "40 m x 2 m are 20 cells or so: {inside}");
    let nodata = decoder.get_tag_ascii_string(Tag::Unknown(42113)).expect("a value that means none");
    assert_eq!(nodata.trim_end_matches('\0'), "nan");
    let about = decoder.get_tag_ascii_string(Tag::Unknown(42112)).expect("metadata");
    for words in ["<Item name=\"UTC_OFFSET\">+02:00</Item>", "hours of sun", "role=\"unittype\">h<"] {
        assert!(about.contains(words), "{words}: {about}");
    }
}

/// The sun of 9 to 17 h is in the south, so the ground right behind the slab has none at noon, and that far before it has all.
#[test]
fn it_is_dark_behind_the_slab_and_light_before_it() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2");
    for row in study.rows().iter().filter(|row| row.text("note").is_empty()) {
        let [x, y, hours] = ["x", "y", "hours"].map(|column| row.number(column));
        if y < -3.0 {
            assert_eq!(hours, 8.0, "{row:?}");
            assert_eq!(row.text("first_sun"), "2026-09-18T09:00:00+02:00");
            assert_eq!(row.text("last_sun"), "2026-09-18T17:00:00+02:00");
        }
        if (1.5..8.0).contains(&y) && x.abs() < 4.0 {
            assert!(hours < 1.0, "{row:?}");
        }
    }
}

#[test]
fn hours_of_any_window_are_sums_of_the_bits() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2 --on ground,wall,roof");
    let (shape, bits) = study.array::<u8>("bits.npz", "bits");
    let (_, durations) = study.array::<f64>("bits.npz", "durations_s");
    let (_, starts) = study.array::<i64>("bits.npz", "steps_utc_s");
    let (_, altitudes) = study.array::<f64>("bits.npz", "altitude_deg");
    let rows = study.rows();
    assert_eq!(shape, [rows.len() as u64, 4]);
    assert_eq!((starts[0], durations.len()), (1_789_714_800, 32), "9 h in Vienna is 7 h UTC");
    assert!(altitudes.iter().all(|altitude| (15.0..45.0).contains(altitude)));
    for (row, bits) in rows.iter().zip(bits.chunks_exact(4)) {
        let lit = (0..32).filter(|step| bits[step / 8] >> (step % 8) & 1 == 1);
        let hours = lit.map(|step| durations[step]).sum::<f64>() / 3600.0;
        let expected = if row.text("hours").is_empty() { 0.0 } else { row.number("hours") };
        assert!((hours - expected).abs() < 1e-6, "{row:?}");
    }
}

/// Of a slab seen by a low sun: exactly what its height and width say.
#[test]
fn outlines_have_the_area_that_the_sun_and_the_slab_say_and_the_grid_agrees() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 0.5");
    let shadows = study.json("shadows.geojson");
    assert!(shadows["coordinates"].as_str().expect("it says so").contains("not longitude and latitude"));
    let features = shadows["features"].as_array().expect("a list");
    let (_, starts) = study.array::<i64>("bits.npz", "steps_utc_s");
    let (_, bits) = study.array::<u8>("bits.npz", "bits");
    let (_, inside) = study.array::<u8>("bits.npz", "inside");
    let mut instants = 0;
    for feature in features.iter().filter(|feature| feature["properties"]["kind"] == "instant") {
        let properties = &feature["properties"];
        let number = |name: &str| properties[name].as_f64().expect("a number");
        let [azimuth, altitude] = ["azimuth_deg", "altitude_deg"].map(|name| number(name).to_radians());
        // The footprint, 40 by 2 m, drawn along the shadow: its extent across, times how far it is drawn.
        let length = 20.0 / altitude.tan();
        let expected = 80.0 + length * (40.0 * azimuth.cos().abs() + 2.0 * azimuth.sin().abs());
        assert!((number("area_m2") - expected).abs() < 0.01, "{properties}: {expected}");
        let ring = feature["geometry"]["coordinates"][0][0].as_array().expect("a ring");
        assert_eq!(ring.first(), ring.last(), "rings are closed");
        let corner = |i: usize| [0, 1].map(|axis| ring[i][axis].as_f64().expect("a number"));
        let doubled: f64 =
            (1..ring.len()).map(|i| corner(i - 1)[0] * corner(i)[1] - corner(i)[0] * corner(i - 1)[1]).sum();
        assert!((0.5 * doubled - expected).abs() < 0.5, "counter-clockwise, and of that area");
        let time: jiff::Timestamp = properties["time"].as_str().expect("a time").parse().expect("a time");
        let step = starts.iter().position(|&start| start + 450 == time.as_second()).expect("the middle of a step");
        let dark = bits
            .chunks_exact(4)
            .zip(&inside)
            .filter(|(bits, inside)| **inside == 1 || bits[step / 8] >> (step % 8) & 1 == 0);
        let of_grid = 0.25 * dark.count() as f64;
        // Half a cell along the outline, at the most.
        let perimeter = 2.0 * (44.0 + length);
        assert!((of_grid - expected).abs() < 0.25 * perimeter, "{properties}: the grid has {of_grid}");
        instants += usize::from(properties["source"] == "all");
    }
    assert_eq!(instants, 32);
}

#[test]
fn walls_are_told_by_the_side_that_they_face() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2 --on roof,wall");
    let mut reader = csv::Reader::from_path(study.path("objects.csv")).expect("a table");
    let rows: Vec<csv::StringRecord> = reader.records().map(|record| record.expect("a row")).collect();
    let mean = |part: &str| -> f64 {
        let row = rows.iter().find(|row| &row[1] == part).unwrap_or_else(|| panic!("{part} in {rows:?}"));
        row[5].parse().expect("hours")
    };
    assert_eq!((mean("roof"), mean("wall facing south"), mean("wall facing north")), (8.0, 8.0, 0.0));
    let [east, west] = ["wall facing east", "wall facing west"].map(mean);
    assert!((east + west - 8.0).abs() < 1e-6, "the sun leaves one when it comes to the other: {east} and {west}");
    assert!(!study.names().contains(&"hours.tif".to_owned()), "there is no grid");
}

#[test]
fn pictures_are_large_and_the_film_has_a_frame_for_each_step() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2 --by-object");
    for name in ["hours.png", "profile.png", "profile_by_object.png"] {
        let (width, height) = image::image_dimensions(study.path(name)).expect("a picture");
        assert!(width >= 1200 && height >= 800, "{name}: {width} x {height}");
    }
    let decoder = png::Decoder::new(std::io::Cursor::new(study.bytes("day.apng")));
    let reader = decoder.read_info().expect("a film");
    assert_eq!(reader.info().animation_control.expect("it moves").num_frames, 32);
}

#[test]
fn the_report_stands_alone_and_says_what_a_reader_asks() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2 --rule bre209");
    let report = study.text("report.html");
    for words in [
        "slab.obj",
        "48.2000° N, 16.3700° E",
        "18 September 2026, 09:00 to 17:00",
        "UTC+02:00",
        "Europe/Vienna",
        "Error bound",
        "0</b> of",
        "BRE 209",
        "data:image/png;base64,",
        "Clear sky",
        "umbrae ",
    ] {
        assert!(report.to_lowercase().contains(&words.to_lowercase()), "{words}");
    }
    assert!(!report.contains("{{"), "every name is filled in");
    for outside in ["http://", "src=\"hours", "<script", "<link"] {
        assert!(!report.contains(outside), "{outside}");
    }
    let run = study.json("run.json");
    assert_eq!(run["verdicts"][0]["rule"]["name"], "bre209");
}

#[test]
fn two_threads_write_the_same_bytes_as_one() {
    let place = Place::new();
    let [one, two] = [1, 3].map(|threads| {
        let model = place.file("slab.obj", SLAB);
        let when = WHEN.replace("--threads 2", "");
        Studied::new(
            &place,
            &format!("t{threads}"),
            &format!("{model} {} --spacing 1 --threads {threads}", when.trim()),
        )
    });
    for name in ["bits.npz", "hours.tif", "hours.png", "receivers.csv", "shadows.geojson", "objects.csv", "day.apng"] {
        assert!(one.bytes(name) == two.bytes(name), "{name}");
    }
}

#[test]
fn points_keep_their_names_and_face_where_they_are_said_to() {
    let place = Place::new();
    let points =
        "id,x,y,z,nx,ny,nz\nsouth window,0,-1.1,10,0,-1,0\nnorth window,0,1.1,10,0,1,0\n\"in, side\",0,0,10,0,1,0\n";
    let points = place.file("points.csv", points);
    let study = slab(&place, "s", &format!("--points {points}"));
    let rows = study.rows();
    let told: Vec<(&str, f64)> = rows.iter().map(|row| (row.text("id"), row.number("hours"))).collect();
    assert_eq!(told[..2], [("south window", 8.0), ("north window", 0.0)]);
    assert_eq!((rows[2].text("id"), rows[2].text("note")), ("in, side", "inside a solid"));
    assert!(told[2].1.is_nan());
}

#[test]
fn what_does_not_cast_takes_no_sun() {
    let place = Place::new();
    let study = slab(&place, "s", "--spacing 2 --no-cast slab");
    assert!(study.rows().iter().filter(|row| row.text("note").is_empty()).all(|row| row.number("hours") == 8.0));
    let run = study.json("run.json");
    assert_eq!(run["warnings"][0], "nothing casts a shadow");
    assert_eq!(run["options"]["no_cast"][0], "slab");
}

#[test]
fn refined_hours_are_those_of_steps_of_seconds_and_bits_those_of_the_steps() {
    let place = Place::new();
    // Points and not a grid, which is where shadows are, and so depends on the steps.
    let points = (0..120).map(|i| format!("{},{},0\n", -50 + 9 * (i % 12), -4 + 5 * (i / 12)));
    let points = place.file("points.csv", format!("x,y,z\n{}", points.collect::<String>()));
    let studied = |name: &str, more: &str| slab(&place, name, &format!("--points {points} {more}"));
    let rough = studied("rough", "--step 15min");
    let (refined, fine) = (studied("refined", "--refine"), studied("fine", "--step 5s"));
    assert_eq!(rough.array::<u8>("bits.npz", "bits"), refined.array::<u8>("bits.npz", "bits"));
    let mut changing = 0;
    for ((rough, refined), fine) in rough.rows().iter().zip(refined.rows()).zip(fine.rows()) {
        let (hours, error_s) = (refined.number("hours"), refined.number("error_s"));
        if hours.is_nan() {
            continue;
        }
        let off_s = (hours - fine.number("hours")).abs() * 3600.0;
        assert!(off_s <= error_s + fine.number("error_s") + 0.01, "{off_s} s apart, {error_s} s said");
        assert!(error_s < 2.0, "{error_s}");
        let rough_s = (hours - rough.number("hours")).abs() * 3600.0;
        assert!(rough_s <= rough.number("error_s") + error_s + 0.01, "{rough_s} s apart without refinement");
        changing += u32::from(rough.number("error_s") > 0.0);
    }
    assert!(changing > 30, "{changing} receivers see the sun come or go");
}
