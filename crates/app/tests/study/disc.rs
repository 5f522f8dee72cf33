//! The sun as a disc.

use std::process::Stdio;
use std::time::Duration;

use crate::files::Place;
use crate::studied::{Row, SLAB, Studied, WHEN};

/// From sunrise to sunset.
const DAY: &str = "--lat 48.2 --lon 16.37 --date 2026-03-20 --no-perspective --threads 2 --spacing 3";

fn hours(rows: &[Row]) -> Vec<f64> {
    rows.iter().map(|row| row.number("hours")).collect()
}

#[test]
fn hours_are_the_sum_of_the_fractions_and_bits_are_those_of_the_middle() {
    let place = Place::new();
    let model = place.file("slab.obj", SLAB);
    let [plain, disc] = ["", " --sun-disc"]
        .map(|flag| Studied::new(&place, &format!("d{}", flag.len()), &format!("{model} {DAY}{flag}")));
    assert!(!plain.names().contains(&"fractions.npz".to_owned()));
    assert_eq!(plain.bytes("bits.npz"), disc.bytes("bits.npz"));
    let (shape, fractions) = disc.array::<u8>("fractions.npz", "fractions");
    let (_, durations) = disc.array::<f64>("fractions.npz", "durations_s");
    let (_, bits) = disc.array::<u8>("bits.npz", "bits");
    let rows = disc.rows();
    assert_eq!(shape, [rows.len() as u64, durations.len() as u64]);
    let stride = durations.len().div_ceil(8);
    let mut partial = 0;
    for (r, row) in rows.iter().enumerate().filter(|(_, row)| row.text("note").is_empty()) {
        let fractions = &fractions[r * durations.len()..][..durations.len()];
        let sum_s: f64 = fractions.iter().zip(&durations).map(|(&f, s)| f64::from(f) / 255.0 * s).sum();
        assert!((sum_s / 3600.0 - row.number("hours")).abs() < 0.01, "{r}: {sum_s} s and {} h", row.number("hours"));
        for (step, &fraction) in fractions.iter().enumerate() {
            let is_lit = bits[r * stride + step / 8] >> (step % 8) & 1 == 1;
            assert!(if is_lit { fraction > 0 } else { fraction < 255 }, "{r} at {step}: {fraction} and {is_lit}");
            partial += usize::from(fraction > 0 && fraction < 255);
        }
    }
    assert!(partial > 100, "{partial}");
    // No shadow's edge is so slow that the two differ by more than both of their bounds.
    let without = plain.rows();
    let mut differ = 0;
    for (with, without) in rows.iter().zip(&without).filter(|(row, _)| row.text("note").is_empty()) {
        let bound_h = (with.number("error_s") + without.number("error_s")) / 3600.0;
        let off_h = with.number("hours") - without.number("hours");
        assert!(off_h.abs() <= bound_h + 0.02, "{off_h} h off, {bound_h} h said");
        differ += usize::from(off_h.abs() > 1e-6);
    }
    assert!(differ > 50, "{differ}");
}

/// While the middle of the disc is below the horizon some of it shines, and is counted.
#[test]
fn the_report_lists_the_steps_in_which_only_a_part_of_the_disc_is_up() {
    let place = Place::new();
    let model = place.file("slab.obj", SLAB);
    let sunrise =
        "--lat 48.2 --lon 16.37 --date 2026-03-20 --from 05:50 --to 06:10 --step 1m --spacing 10 --no-perspective";
    let [plain, disc] = ["", " --sun-disc"].map(|flag| {
        let study = Studied::new(&place, &format!("r{}", flag.len()), &format!("{model} {sunrise}{flag}"));
        let html = study.text("report.html");
        let rows = html.split("<tr>").filter(|row| row.contains("&deg;</td>"));
        rows.map(str::to_owned).collect::<Vec<_>>()
    });
    let is_below = |row: &&String| row.contains("&ndash;</td>");
    assert_eq!(plain.iter().filter(is_below).count(), 0, "{plain:?}");
    let below = disc.iter().filter(is_below).count();
    assert!((1..4).contains(&below) && disc.len() == plain.len() + below, "{below} of {disc:?}");
}

/// Whether a face hides what stands in its plane is a matter of rounding, and no error.
#[test]
fn a_receiver_in_the_plane_of_a_face_is_undecided() {
    let place = Place::new();
    let model = place.file("slab.obj", SLAB);
    // A centimetre above, which is where receivers are, is the top.
    let points = place.file("points.csv", "x,y,z,nx,ny,nz\n3,0.25,19.99,0,0,1\n4,0.25,20.5,0,0,1\n");
    let study = Studied::new(&place, "s", &format!("{model} {WHEN} --sun-disc --points {points}"));
    let disc = &study.json("run.json")["check"]["disc"];
    assert_eq!(disc["disagreements"], 0, "{disc}");
    let [undecided, shares] = ["undecided", "shares"].map(|name| disc[name].as_u64().expect("a number"));
    assert!(undecided > 0 && undecided <= shares / 2, "{disc}");
}

#[test]
fn every_file_says_that_the_sun_is_a_disc_and_the_check_finds_it_right() {
    let place = Place::new();
    let model = place.file("slab.obj", SLAB);
    let study =
        Studied::new(&place, "s", &format!("{model} {WHEN} --spacing 2 --sun-disc --on ground,wall --rule nsw-adg"));
    let run = study.json("run.json");
    assert_eq!(run["options"]["sun_disc"], true);
    assert_eq!(run["check"]["disagreements"], 0);
    let disc = &run["check"]["disc"];
    assert_eq!(disc["disagreements"], 0);
    assert!(disc["partial"].as_u64().expect("a number") > 50, "{disc}");
    let shares = disc["shares"].as_f64().expect("a number");
    let mean = disc["sum_of_differences"].as_f64().expect("a number") / shares;
    assert!(shares > 1000.0 && mean.abs() < 1e-3, "{disc}");
    let sun = run["parameters"]["sun"].as_str().expect("text");
    assert!(sun.contains("a disc of 0.533\u{b0}"), "{sun}");
    let verdict = run["verdicts"][0]["text"].as_str().expect("text");
    assert!(verdict.ends_with("Sun is counted by the share of its disc that is seen."), "{verdict}");
    let report = study.text("report.html");
    assert!(
        report.contains("taken as a disc") && report.contains("Check of the disc") && !report.contains("half-shadow")
    );
    assert_eq!(
        study.json("shadows.geojson")["study"]["outlines_of"],
        "the middle of the sun's disc; hours are of its visible share"
    );
}

#[test]
fn shares_summed_by_minutes_are_within_the_bound_of_those_summed_by_steps_and_have_a_smaller_one() {
    let place = Place::new();
    let model = place.file("slab.obj", SLAB);
    let [steps, minutes] = ["", " --refine"].map(|flag| {
        Studied::new(&place, &format!("r{}", flag.len()), &format!("{model} {WHEN} --spacing 4 --sun-disc{flag}"))
    });
    assert_eq!(steps.bytes("fractions.npz"), minutes.bytes("fractions.npz"), "these are of the steps");
    let (coarse, fine) = (steps.rows(), minutes.rows());
    let mut within = 0;
    assert_ne!(hours(&coarse), hours(&fine));
    for (coarse, fine) in coarse.iter().zip(&fine).filter(|(row, _)| row.text("note").is_empty()) {
        let bounds = [coarse, fine].map(|row| row.number("error_s"));
        let off_s = 3600.0 * (coarse.number("hours") - fine.number("hours"));
        within += usize::from(off_s.abs() <= bounds[0] + bounds[1] + 1.0);
        assert!(bounds[1] <= bounds[0].max(60.0) && bounds[1] <= 200.0, "{bounds:?}");
        // What changes in the first and the last half of a step has no neighbour to be told by.
        assert!(off_s.abs() <= bounds[0] + bounds[1] + 900.0, "{off_s} s off, {bounds:?}");
    }
    assert!(10 * within > 9 * coarse.iter().filter(|row| row.text("note").is_empty()).count(), "{within}");
}

#[test]
fn a_study_of_the_disc_goes_on_where_it_was_and_not_as_one_without() {
    let place = Place::new();
    place.file("slab.obj", SLAB);
    let words = "slab.obj --lat 48.2 --lon 16.37 --dates 2026-03-01..2026-03-10 --step 10min --spacing 1 --no-perspective --check 0";
    let start = |name: &str, more: &str| {
        let output = format!("out/{name}");
        let args: Vec<&str> =
            ["study", "-o", &output].into_iter().chain(words.split(' ')).chain(more.split(' ')).collect();
        place.std_command(&args).stderr(Stdio::null()).spawn().expect("it starts")
    };
    assert!(start("whole", "--sun-disc --threads 3").wait().expect("it ends").success());
    let mut child = start("killed", "--sun-disc --threads 1");
    let journal = place.out("killed/.umbrae/journal");
    while std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) < 3 {
        assert!(child.try_wait().expect("it is ours").is_none(), "it was done before it could be stopped");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("it is ours");
    child.wait().expect("it ends");
    assert_eq!(start("killed", "--resume --threads 1").wait().expect("it ends").code(), Some(2), "another study");
    assert!(start("killed", "--sun-disc --resume --threads 1").wait().expect("it ends").success());
    let [whole, killed] = ["whole", "killed"].map(|name| Studied::there(&place, name));
    assert_eq!(whole.names(), killed.names());
    for name in ["fractions.npz", "bits.npz", "hours.tif", "hours.png", "receivers.csv", "objects.csv"] {
        assert!(whole.bytes(name) == killed.bytes(name), "{name}");
    }
}
