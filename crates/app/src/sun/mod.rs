//! `umbrae sun`: where the sun is on a day.

mod almanac;
mod diagram;
mod diagram_legend;
mod report;
mod table;

use std::path::Path;

use anyhow::{Context as _, ensure};

use self::almanac::Almanac;
use crate::cli::SunArgs;
use crate::output::{Output, write_to_stdout};
use crate::talk::Talk;

/// Prints the table that `args` ask for, and writes its files.
///
/// # Errors
///
/// When place or dates are missing, the clock skips a time that was asked for, or a file can't be written; then nothing is.
pub fn run(args: &SunArgs, talk: &Talk) -> anyhow::Result<()> {
    let place = args.place.place()?.context("the sun of which place? give --lat and --lon")?;
    ensure!(!args.period.all_dates().is_empty(), "the sun of which day? give --date or --dates");
    let json_to_stdout = args.json.as_deref().is_some_and(|path| path == Path::new("-"));
    let json = args.json.as_deref().filter(|_| !json_to_stdout).map(Output::create).transpose()?;
    let diagram = args.diagram.as_deref().map(svg_output).transpose()?;
    if let (Some(json), Some(diagram)) = (&json, &diagram) {
        ensure!(
            !json.is_same_file_as(diagram),
            "--json and --diagram can't both be written to `{}`",
            json.path().display()
        );
    }

    let almanac = Almanac::new(place, args)?;
    for note in &almanac.notes {
        talk.note(note);
    }
    let report = if args.json.is_some() { report::json(&almanac)? } else { String::new() };
    // Made before anything is published, so that nothing half is left.
    let drawing = diagram.map(|output| output.stage(diagram::svg(&almanac)?.into_bytes())).transpose()?;
    let written = json.map(|output| output.stage(report.clone().into_bytes())).transpose()?;
    for staged in [drawing, written].into_iter().flatten() {
        staged.publish()?;
    }
    let text = if json_to_stdout { report } else { table::text(&almanac)? };
    write_to_stdout(text.as_bytes())
}

fn svg_output(path: &Path) -> anyhow::Result<Output> {
    let output = Output::create(path)?;
    let is_svg = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg")) || output.is_stream();
    ensure!(is_svg, "can't write `{}`: diagrams are SVG files; give a name that ends in .svg", path.display());
    Ok(output)
}
