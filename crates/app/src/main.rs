//! `umbrae`: exact shadows of real models.

use std::env;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser as _;
use umbrae::cli::{Cli, Command, explain};
use umbrae::study::Ending;
use umbrae::talk::Talk;
use umbrae::{bench, doctor, inspect, render, sample, study, sun};

/// The exit codes: all well; a verification found errors; the input or the machine is at fault; stopped by Ctrl-C, as shells have it.
const OK: u8 = 0;
const FOUND_ERRORS: u8 = 1;
const BAD_INPUT: u8 = 2;
const STOPPED: u8 = 130;

fn main() -> ExitCode {
    silence_device_select();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(said) => return explain(&said),
    };
    let talk = Talk::new(cli.quiet, cli.color);
    let result = match &cli.command {
        Command::Render(args) => render::run(args, &talk).map(|is_right| if is_right { OK } else { FOUND_ERRORS }),
        Command::Study(args) => study::run(args, &talk).map(|ending| match ending {
            Ending::Whole => OK,
            Ending::Disagreed => FOUND_ERRORS,
            Ending::Stopped => STOPPED,
        }),
        Command::Inspect(args) => inspect::run(args, &talk).map(|()| OK),
        Command::Sample(args) => sample::run(args, &talk).map(|()| OK),
        Command::Sun(args) => sun::run(args, &talk).map(|()| OK),
        Command::Bench { what } => bench::run(what, &talk).map(|()| OK),
        Command::Doctor => doctor::run().map(|()| OK),
        Command::Completions { shell } => umbrae::cli::write_completions(*shell).map(|()| OK),
    };
    ExitCode::from(result.unwrap_or_else(|error| {
        talk.error(&error);
        BAD_INPUT
    }))
}

/// Keeps Mesa's device-select layer for Vulkan from asking a Wayland compositor that can't be there.
///
/// The layer asks whatever is drawn, a window or not, and where `XDG_RUNTIME_DIR` names no folder (a container, CI, cron, `sudo`)
/// libwayland complains of that on standard error. Who chooses a device by the layer's own variables keeps the layer.
fn silence_device_select() {
    let has_runtime_folder = env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).is_absolute());
    let is_in_use =
        ["NODEVICE_SELECT", "MESA_VK_DEVICE_SELECT", "DRI_PRIME"].iter().any(|name| env::var_os(name).is_some());
    if has_runtime_folder || is_in_use {
        return;
    }
    #[expect(unsafe_code, reason = "the layer listens to nothing but its variable")]
    // SAFETY: this is the first thing that the program does, so no other thread reads the environment.
    unsafe {
        env::set_var("NODEVICE_SELECT", "1");
    }
}
