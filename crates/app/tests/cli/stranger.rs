//! A stranger's session: help, version, doctor, samples, completions; and where things are said, in what colour, and how quietly.

use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::{contains, starts_with};

use crate::files::{BOX, Place};

#[test]
fn every_command_explains_itself() {
    let place = Place::new();
    for command in ["", "render", "inspect", "sample", "bench", "bench silhouettes", "doctor", "completions"] {
        let args: Vec<&str> = command.split_whitespace().chain(["--help"]).collect();
        let output = place.umbrae(&args).success().stderr("").get_output().stdout.clone();
        let help = String::from_utf8(output).expect("help is text");
        assert!(help.contains("Usage: umbrae") && !help.contains('\u{1b}'), "{help}");
        let longest = help.lines().map(|line| line.chars().count()).max();
        assert!(longest <= Some(110), "a line of {longest:?} characters in the help of `{command}`");
    }
    place.umbrae(&["--help"]).stdout(contains("Exit codes:"));
    place.umbrae(&[]).code(2).stdout("").stderr(contains("Usage: umbrae"));
}

#[test]
fn version_is_one_line_on_standard_output() {
    Place::new().umbrae(&["--version"]).success().stdout(format!("umbrae {}\n", env!("CARGO_PKG_VERSION"))).stderr("");
}

#[test]
fn completions_come_for_every_shell() {
    let place = Place::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        place.umbrae(&["completions", shell]).success().stdout(contains("no-ground")).stderr("");
    }
    place.umbrae(&["completions", "bash"]).stdout(starts_with("_umbrae()"));
}

#[test]
fn doctor_lists_the_adapters_and_says_what_is_missing() {
    let lines = contains("adapter 1: ").and(contains("(used by default)")).and(contains("missing: "));
    Place::new().umbrae(&["doctor"]).success().stdout(lines).stderr("");
}

#[test]
fn a_sample_is_written_drawn_and_inspected() {
    let place = Place::new();
    let glb = place.out("x.glb");
    place.umbrae(&["sample", "town", "-o", &glb]).success().stdout("").stderr(contains("triangles in"));
    place.umbrae(&["render", &glb, "-o", &place.out("x.png"), "--size", "64x36"]).success();
    place.umbrae(&["inspect", &glb]).success().stdout(contains("closed, consistently wound"));
    assert_eq!(place.written(), ["x.glb", "x.png"]);
    assert_eq!(image::image_dimensions(place.out("x.png")).expect("a picture"), (64, 36));
}

#[test]
fn talk_goes_to_standard_error_and_quiet_leaves_only_errors() {
    let place = Place::new();
    // A warning too: the line is skipped.
    let model = place.file("box.obj", format!("{BOX}l 1 2\n"));
    let args = ["render", &model, "-o", &place.out("x.png"), "--size", "40x30", "--verify"];
    let said = contains("warning: ")
        .and(contains("verify sun: 0 errors in"))
        .and(contains("14 triangles in 2 objects, 1 light on"));
    place.umbrae(&args).success().stdout("").stderr(said);
    place.umbrae(&[&args[..], &["--quiet"]].concat()).success().stdout("").stderr("");
    place.umbrae(&["-q", "inspect", &model]).success().stderr("").stdout(contains("triangles              12"));
    place.umbrae(&["-q", "inspect", "nosuch.obj"]).code(2).stdout("").stderr(starts_with("error: "));
}

#[test]
fn a_pipe_gets_no_colour_and_no_progress_bar_unless_it_is_asked_for() {
    let place = Place::new();
    let model = place.file("box.obj", format!("{BOX}l 1 2\n"));
    let args = ["render", &model, "-o", &place.out("x.png"), "--size", "40x30", "--verify"];
    let colour = || contains("\u{1b}[");
    let bar = contains("casting rays").or(contains("\r"));
    place.umbrae(&args).stderr(colour().or(bar).not());
    for color in [&["--color", "never"][..], &["--color=never"]] {
        place.umbrae(&[&args[..], color].concat()).success().stderr(colour().not());
        place.umbrae(&[color, &["render"]].concat()).code(2).stderr(colour().not());
    }
    place.umbrae(&[&args[..], &["--color", "always"]].concat()).stderr(colour());
    place.umbrae(&["inspect", "nosuch.obj", "--color", "always"]).stderr(colour());
    place.umbrae(&["--color", "always", "bogus"]).code(2).stderr(colour());
}

/// Bug: Mesa's device-select layer let libwayland print that `XDG_RUNTIME_DIR` is invalid or not set, as an error.
#[test]
fn nothing_is_said_about_the_runtime_folder_of_a_desktop_that_is_not_there() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let args = ["render", &model, "-q", "-o", &place.out("x.png"), "--size", "40x30"];
    place.command(&args).env_remove("XDG_RUNTIME_DIR").assert().success().stderr("");
    place.command(&args).env("XDG_RUNTIME_DIR", "relative").assert().success().stderr("");
}

#[test]
fn without_any_driver_the_package_to_install_is_named() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let picture = place.out("x.png");
    for args in [&["render", &model, "-o", &picture][..], &["doctor"]] {
        let mut command = place.command(args);
        for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "LIBGL_DRIVERS_PATH", "__EGL_VENDOR_LIBRARY_FILENAMES"] {
            command.env(name, "/nonexistent");
        }
        if cfg!(target_os = "linux") {
            let package = contains("error: no Vulkan or OpenGL driver was found").and(contains("mesa-vulkan-drivers"));
            command.assert().code(2).stdout("").stderr(package);
        } else {
            println!("skipped: only on Linux can the drivers be hidden");
        }
    }
    assert!(place.written().is_empty());
    place.command(&["inspect", &model]).env("VK_DRIVER_FILES", "/nonexistent").assert().success();
}

/// Bug: the generator of completions panicked when standard output was full, and `head` was an error.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_one_sentence_and_a_reader_that_leaves_is_no_error() {
    use std::fs::OpenOptions;
    use std::process::Stdio;

    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let picture = place.out("x.png");
    let render = ["render", &model, "-q", "-o", &picture, "--size", "40x30", "--json", "-"];
    for args in
        [&["completions", "bash"][..], &["inspect", &model], &["inspect", &model, "--json"], &["doctor"], &render]
    {
        let full = OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
        let run = place.std_command(args).stdout(full).output().expect("it starts");
        let said = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.starts_with("error: can't write to standard output\n  caused by: "), "{args:?}: {said}");
        assert!(place.written().is_empty(), "{args:?} wrote a file");
    }
    for args in [&["completions", "bash"][..], &["inspect", &model], &render] {
        let mut child =
            place.std_command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop(child.stdout.take());
        let run = child.wait_with_output().expect("it ends");
        assert!(run.status.success() && run.stderr.is_empty(), "{args:?}: {}", String::from_utf8_lossy(&run.stderr));
    }
    assert_eq!(place.written(), ["x.png"]);
}
