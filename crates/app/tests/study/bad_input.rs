//! What can't be studied is refused in a sentence, and nothing is left.

use predicates::str::contains;

use crate::files::{Place, box_at};
use crate::studied::SLAB;

#[test]
fn every_mistake_is_one_sentence_with_the_way_out() {
    let place = Place::new();
    place.file("slab.obj", SLAB);
    place.file("points.csv", "x,y,z\n1,2,three\n");
    place.file("degrees.csv", "x,y,z\n1600000,480000,0\n");
    place.file("a file", "");
    let cases: &[(&str, &[&str])] = &[
        ("slab.obj --date 2026-09-18", &["not known", "--lat and --lon"]),
        ("slab.obj --lat 48 --lon 16", &["no date", "--date 2026-09-18"]),
        ("slab.obj --lat 95 --lon 16 --date 2026-09-18", &["latitude of 95"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-02-30", &["2026-02-30"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --tz Europe/Viena", &["Europe/Viena"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-03-29 --from 02:30 --to 09:00", &["02:30", "2026-03-29"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --points points.csv", &["points.csv", "line 2", "`three`"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --points nosuch.csv", &["nosuch.csv"]),
        (
            "slab.obj --lat 48 --lon 16 --date 2026-09-18 --points degrees.csv",
            &[
                "degrees.csv",
                "point `0` at 1600000.0, 480000.0 is 1670 km from the models",
                "not in longitude and latitude",
            ],
        ),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --spacing 0.00001", &["--spacing"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --spacing -1", &["not a length"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --rule nosuch", &["nosuch", "en17037"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --rule nosuch.toml", &["can't read the rule `nosuch.toml`"]),
        ("slab.obj --lat 48 --lon 16 --date 2026-09-18 --threads 0", &["--threads"]),
        ("nosuch.obj --lat 48 --lon 16 --date 2026-09-18", &["nosuch.obj"]),
        ("--lat 48 --lon 16 --date 2026-09-18", &["MODEL"]),
    ];
    for (args, words) in cases {
        let args: Vec<&str> = ["study", "-o", "out/s"].into_iter().chain(args.split(' ')).collect();
        place.refuses(&args, words);
    }
    let args = ["study", "slab.obj", "--lat", "48", "--lon", "16", "--date", "2026-09-18", "-o"];
    place.refuses(&[&args[..], &["a file"]].concat(), &["`a file`", "it is a file; give a folder"]);
    place.refuses(&[&args[..], &["a file/in it"]].concat(), &["`a file` is a file"]);
}

#[test]
fn a_model_as_high_as_a_mountain_is_warned_of() {
    let place = Place::new();
    // The slab in centimetres is 2000 m high.
    let scaled: String = SLAB.lines().map(|line| line.replace("20", "2000") + "\n").collect();
    place.file("cm.obj", scaled);
    let args =
        "study cm.obj -o out/s --lat 48.2 --lon 16.37 --date 2026-09-18 --step 4h --spacing 200 --no-perspective";
    let args: Vec<&str> = args.split(' ').collect();
    place.umbrae(&args).success().stderr(contains("2000 m high")).stderr(contains("millimetres or feet"));
}

#[test]
fn a_model_at_the_zero_of_its_reference_system_is_warned_of() {
    let place = Place::new();
    place.file("box.obj", box_at([0.0; 3]));
    let args = "study box.obj -o out/s --crs EPSG:25833 --date 2026-09-18 --step 4h --spacing 5 --no-perspective";
    let args: Vec<&str> = args.split(' ').collect();
    let told = "the models are at the zero of EPSG:25833, and so at 0.0000,10.5113";
    place.umbrae(&args).success().stderr(contains(told)).stderr(contains("give --lat and --lon"));
    // There the place is known, and that it is elsewhere is told.
    let args = [&args[..], &["--lat", "52.5", "--lon", "13.4"]].concat();
    place.umbrae(&args).success().stderr(contains("km from where the models' coordinate reference system has them"));
}

#[test]
fn a_polar_night_has_no_sun_and_says_so() {
    let place = Place::new();
    place.file("box.obj", box_at([0.0; 3]));
    let args = "study box.obj -o out/s --lat 80 --lon 20 --date 2026-12-21 --from 09:00 --to 15:00 --no-perspective";
    let args: Vec<&str> = args.split(' ').collect();
    place.umbrae(&args).success().stderr(contains("the sun does not count at any step"));
}

/// A folder that can't be written and a disk that is full look alike from here.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_can_not_be_written_is_told_before_any_work() {
    let place = Place::new();
    place.file("slab.obj", SLAB);
    let args = ["study", "nosuch.obj", "--lat", "48", "--lon", "16", "--date", "2026-09-18", "-o", "/proc/nosuch"];
    place.refuses(&args, &["can't write to `/proc/nosuch`"]);
}
