//! `umbrae`: exact shadows of real models.

use std::process::ExitCode;

use clap::Parser as _;
use umbrae::cli::{Cli, Command};
use umbrae::talk::Talk;
use umbrae::{doctor, inspect, render, sample};

/// The exit codes: all well; a verification found errors; the input or the machine is at fault.
const OK: u8 = 0;
const FOUND_ERRORS: u8 = 1;
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let talk = Talk::new(cli.quiet, cli.color);
    let result = match &cli.command {
        Command::Render(args) => render::run(args, &talk).map(|is_right| if is_right { OK } else { FOUND_ERRORS }),
        Command::Inspect(args) => inspect::run(args, &talk).map(|()| OK),
        Command::Sample(args) => sample::run(args, &talk).map(|()| OK),
        Command::Doctor => doctor::run().map(|()| OK),
        Command::Completions { shell } => umbrae::cli::write_completions(*shell).map(|()| OK),
    };
    ExitCode::from(result.unwrap_or_else(|error| {
        talk.error(&error);
        BAD_INPUT
    }))
}
