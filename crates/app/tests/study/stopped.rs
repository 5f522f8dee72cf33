//! Studies that are stopped, and go on.

use std::fs;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::files::Place;
use crate::studied::{SLAB, Studied};

/// Long enough to be stopped in its midst, short enough to be waited for: 365 days.
const LONG: &str = "slab.obj --lat 48.2 --lon 16.37 --dates 2026-01-01..2026-12-31 --step 30min --spacing 1 \
                    --no-perspective --check 10 --threads 1";

fn start(place: &Place, name: &str, more: &[&str]) -> Child {
    let output = format!("out/{name}");
    let args: Vec<&str> =
        ["study", "-o", &output].into_iter().chain(LONG.split_whitespace()).chain(more.iter().copied()).collect();
    place.std_command(&args).stderr(Stdio::null()).spawn().expect("it starts")
}

/// Waits until some blocks are finished and not all.
fn wait_for_blocks(place: &Place, name: &str, child: &mut Child) {
    let journal = place.out(&format!("{name}/.umbrae/journal"));
    for _ in 0..6000 {
        let blocks = fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
        if blocks >= 3 {
            return;
        }
        assert!(child.try_wait().expect("it is ours").is_none(), "it was done before it could be stopped");
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no block was finished");
}

#[test]
fn a_study_that_is_killed_and_resumed_ends_with_the_same_bytes() {
    let place = Place::new();
    place.file("slab.obj", SLAB);
    assert!(start(&place, "whole", &[]).wait().expect("it ends").success());
    let mut child = start(&place, "killed", &[]);
    wait_for_blocks(&place, "killed", &mut child);
    child.kill().expect("it is ours");
    child.wait().expect("it ends");
    let [whole, killed] = ["whole", "killed"].map(|name| Studied::there(&place, name));
    assert_eq!(killed.names(), [".umbrae", ".umbrae-lock"], "no result is there before all are");
    // What a killed study leaves half written is cleared away, and what is damaged is computed again.
    fs::write(killed.path(".umbrae-half.part"), "half").expect("the folder can be written");
    let rows = killed.path(".umbrae/rows-0");
    let mut bytes = fs::read(&rows).expect("there are rows");
    let half = bytes.len() / 2;
    bytes[..half].fill(0);
    fs::write(&rows, bytes).expect("it can be written");

    assert!(start(&place, "killed", &["--resume"]).wait().expect("it ends").success());
    assert_eq!(whole.names(), killed.names());
    for name in ["bits.npz", "hours.tif", "hours.png", "receivers.csv", "objects.csv"] {
        assert!(whole.bytes(name) == killed.bytes(name), "{name}");
    }
}

#[test]
fn two_studies_do_not_write_to_one_folder() {
    let place = Place::new();
    place.file("slab.obj", SLAB);
    let mut first = start(&place, "s", &[]);
    wait_for_blocks(&place, "s", &mut first);
    let args: Vec<&str> = ["study", "-o", "out/s"].into_iter().chain(LONG.split_whitespace()).collect();
    let said = place.umbrae(&args).code(2).get_output().stderr.clone();
    first.kill().expect("it is ours");
    first.wait().expect("it ends");
    let said = String::from_utf8_lossy(&said).into_owned();
    assert!(said.contains("another study is writing to `out/s`"), "{said}");
}

#[test]
fn another_study_is_not_resumed_in_its_place() {
    let place = Place::new();
    place.file("slab.obj", SLAB);
    let mut child = start(&place, "s", &[]);
    wait_for_blocks(&place, "s", &mut child);
    child.kill().expect("it is ours");
    child.wait().expect("it ends");
    let args: Vec<&str> =
        ["study", "-o", "out/s", "--resume", "--north", "5"].into_iter().chain(LONG.split_whitespace()).collect();
    let said = place.umbrae(&args).code(2).get_output().stderr.clone();
    let said = String::from_utf8_lossy(&said).into_owned();
    assert!(said.contains("can't resume the study in `out/s`: models or options have changed"), "{said}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_what_is_finished_and_says_that_it_is_not_all() {
    let place = Place::new();
    place.file("slab.obj", SLAB);
    let mut child = start(&place, "s", &[]);
    wait_for_blocks(&place, "s", &mut child);
    let interrupt = ["-INT", &child.id().to_string()].map(str::to_owned);
    assert!(std::process::Command::new("kill").args(interrupt).status().expect("there is kill").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    let study = Studied::there(&place, "s");
    let run = study.json("run.json");
    assert_eq!((&run["partial"], &run["parameters"]["partial"]), (&true.into(), &"yes".into()));
    assert!(study.text("report.html").contains("Partial: the study was stopped"));
    let rows = study.rows();
    let missing = rows.iter().filter(|row| row.text("note") == "not computed").count();
    assert!(missing > 0 && missing < rows.len(), "{missing} of {}", rows.len());
    assert!(rows.iter().all(|row| row.text("hours").is_empty() != row.text("note").is_empty()));
    // And it goes on from there.
    assert!(start(&place, "s", &["--resume"]).wait().expect("it ends").success());
    assert_eq!(study.json("run.json")["partial"], false);
}
