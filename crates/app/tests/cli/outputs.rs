//! Files that are written: whole or not at all, where they were asked for, and never over something else.

use std::fs;

use predicates::str::contains;

use crate::files::{BOX, Place};

#[test]
fn what_can_not_be_written_is_said_before_any_work() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let protected = place.out("protected.png");
    fs::write(&protected, "old").expect("the folder can be written");
    let mut permissions = fs::metadata(&protected).expect("it is there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&protected, permissions).expect("it is ours");

    let long = format!("{}.png", "x".repeat(300));
    let cases: &[(&str, &[&str])] = &[
        ("nosuch/x.png", &["can't write `nosuch/x.png`", "there is no folder `nosuch`"]),
        ("box.obj/x.png", &["there is no folder `box.obj`"]),
        ("out", &["can't write `out`", "it is a folder; give a file name in it"]),
        ("out/", &["can't write `out/`", "it is a folder"]),
        // Bug: found out only after the picture was drawn.
        ("newfolder/", &["can't write `newfolder/`", "it is a folder"]),
        (".", &["it is a folder"]),
        ("..", &["it is a folder"]),
        ("/", &["it is a folder"]),
        // Bug: renaming replaced a file that no one may write.
        ("out/protected.png", &["out/protected.png", "it is write-protected"]),
        (&long, &["can't write `xxxxx"]),
        // Bug: a PNG under the name of something else.
        ("out/x.jpg", &["can't write `out/x.jpg`", "a name that ends in .png"]),
        ("-", &["can't write `-`", "a name that ends in .png"]),
    ];
    for (path, words) in cases {
        // A model that is not there shows that the output is looked at first.
        place.refuses(&["render", "nosuch.obj", "-o", path], words);
        place.refuses(&["render", "nosuch.obj", "-o", "out/x.png", "--mask", path], words);
        if !words.iter().any(|word| word.contains(".png") || word.contains("xxx")) {
            place.refuses(&["render", &model, "-o", "out/x.png", "--json", path], words);
        }
    }
    for path in ["nosuch/x.glb", "out/"] {
        place.refuses(&["sample", "staircase", "-o", path], &[path]);
    }
    assert_eq!(fs::read(&protected).expect("it is there"), b"old");
}

/// Bug: the reason why a model can't be read was said twice.
#[cfg(unix)]
#[test]
fn a_folder_that_can_not_be_written_and_a_model_that_can_not_be_read_are_named() {
    use std::os::unix::fs::PermissionsExt as _;

    let place = Place::new();
    fs::set_permissions(place.path("out"), fs::Permissions::from_mode(0o555)).expect("it is ours");
    if fs::write(place.out("probe"), "").is_ok() {
        fs::remove_file(place.out("probe")).expect("it was just made");
        println!("skipped: the superuser can write anywhere");
        return;
    }
    place.refuses(&["render", "nosuch.obj", "-o", "out/x.png"], &["the folder `out` is write-protected"]);
    let model = place.file("box.obj", BOX);
    fs::set_permissions(&model, fs::Permissions::from_mode(0o000)).expect("it is ours");
    let said = "error: can't read box.obj\n  caused by: Permission denied (os error 13)\n";
    place.umbrae(&["inspect", "box.obj"]).code(2).stdout("").stderr(said);
}

/// Bug: the mask replaced the picture, the report replaced either, and any of them the model.
#[test]
fn no_output_replaces_another_or_a_model() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let cases: &[(&[&str], &[&str])] = &[
        (&["--mask", "out/x.png"], &["--output and --mask would both be written to `out/x.png`"]),
        (&["--mask", "./out/../out/x.png"], &["--output and --mask would both be written to"]),
        (&["--json", "out/x.png"], &["--output and --json would both be written to"]),
        (&["--mask", "out/m.png", "--json", "out/m.png"], &["--mask and --json would both be written to"]),
        (&["--mask", "out/x-errors.png", "--verify"], &["--mask and the picture of --verify would both"]),
        (&["--json", "box.obj"], &["--json would overwrite the model `box.obj`"]),
        (&["--json", "out/../box.obj"], &["--json would overwrite the model"]),
    ];
    for (options, words) in cases {
        place.refuses(&[&["render", &model, "-o", "out/x.png"], *options].concat(), words);
    }
    place.refuses(&["render", &model, "-o", "box.obj"], &["can't write `box.obj`"]);
    assert_eq!(fs::read_to_string(&model).expect("it is there"), BOX);
}

#[cfg(unix)]
#[test]
fn a_model_is_not_overwritten_through_a_link_and_a_link_to_a_picture_stays_one() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    let place = Place::new();
    let model = place.file("box.obj", BOX);
    symlink(&model, place.out("innocent.png")).expect("links");
    place.refuses(&["render", &model, "-o", "out/innocent.png"], &["--output would overwrite the model"]);

    let real = place.path("real.png");
    fs::write(&real, "old").expect("the folder can be written");
    fs::set_permissions(&real, fs::Permissions::from_mode(0o600)).expect("it is ours");
    symlink(&real, place.out("link.png")).expect("links");
    place.umbrae(&["render", &model, "-o", "out/link.png", "--size", "40x30"]).success();
    assert!(fs::symlink_metadata(place.out("link.png")).expect("it is there").is_symlink());
    assert_eq!(image::image_dimensions(&real).expect("a picture"), (40, 30));
    let mode = fs::metadata(&real).expect("it is there").permissions().mode();
    assert_eq!(mode & 0o777, 0o600, "a private file stays private");
}

/// Bug: a pipe or a device was replaced by a file; as the superuser, `/dev/null` for the whole machine.
#[cfg(unix)]
#[test]
fn a_pipe_is_written_to_and_not_replaced() {
    use std::os::unix::fs::FileTypeExt as _;
    use std::process::{Command, Stdio};

    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let pipe = place.path("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let reader = Command::new("cat").arg(&pipe).stdout(Stdio::piped()).spawn().expect("there is cat");
    place.umbrae(&["render", &model, "-o", "out/x.png", "--size", "40x30", "--json", &pipe]).success();
    let read = reader.wait_with_output().expect("it ends").stdout;
    // Nor is there a picture of errors beside it.
    let reader_of_pictures = Command::new("cat").arg(&pipe).stdout(Stdio::piped()).spawn().expect("there is cat");
    place.umbrae(&["render", &model, "-o", &pipe, "--size", "40x30", "--verify"]).success();
    assert!(reader_of_pictures.wait_with_output().expect("it ends").stdout.starts_with(b"\x89PNG"));
    let report: serde_json::Value = serde_json::from_slice(&read).expect("the report");
    assert_eq!(report["camera"]["size"], serde_json::json!([40, 30]));
    assert!(fs::metadata(&pipe).expect("it is there").file_type().is_fifo());
}

/// Bug: the picture was there although the report could not be written.
#[cfg(target_os = "linux")]
#[test]
fn what_was_there_stays_as_it_was_when_something_fails() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    for name in ["x.png", "mask.png"] {
        fs::write(place.out(name), "old").expect("the folder can be written");
    }
    let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
    let args = ["render", &model, "-o", "out/x.png", "--mask", "out/mask.png", "--size", "40x30", "--json", "-"];
    let run = place.std_command(&args).stdout(full).output().expect("it starts");
    assert_eq!(run.status.code(), Some(2));
    assert_eq!(place.written(), ["mask.png", "x.png"]);
    for name in place.written() {
        assert_eq!(fs::read(place.out(&name)).expect("it is there"), b"old");
    }
}

/// Bug: a temporary file lay beside the picture during all the work, and stayed if the program was stopped.
#[cfg(unix)]
#[test]
fn a_program_that_is_stopped_leaves_nothing() {
    use std::process::Stdio;

    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let args = ["render", &model, "-o", "out/x.png", "--size", "4000x4000", "--verify"];
    let mut child = place.std_command(&args).stderr(Stdio::null()).spawn().expect("it starts");
    std::thread::sleep(std::time::Duration::from_millis(700));
    child.kill().expect("it is ours");
    let status = child.wait().expect("it ends");
    assert!(!status.success(), "it was done before it could be stopped");
    assert!(place.written().is_empty(), "{:?}", place.written());
}

#[test]
fn an_old_picture_is_replaced() {
    let place = Place::new();
    let model = place.file("box.obj", BOX);
    let args = ["render", &model, "-o", "out/x.png", "--json", "out/x.json", "--size"];
    for size in ["40x30", "30x40"] {
        place.umbrae(&[&args[..], &[size]].concat()).success().stderr(contains("`out/x.png`: 14 triangles"));
    }
    assert_eq!(image::image_dimensions(place.out("x.png")).expect("a picture"), (30, 40));
    assert_eq!(place.written(), ["x.json", "x.png"]);
}

#[test]
fn without_a_name_the_picture_has_the_models_and_is_in_the_current_folder() {
    let place = Place::new();
    let model = place.file("a house.obj", BOX);
    place.umbrae(&["render", &model, "--size", "32x24"]).success().stderr(contains("`a house.png`"));
    assert!(fs::read(place.path("a house.png")).expect("it was written").starts_with(b"\x89PNG"));
    place.refuses(&["render", "nosuch/tower.glb"], &["nosuch/tower.glb"]);
}
