//! What can be asked of the sun.

use std::path::PathBuf;

use clap::Args;

use super::{PeriodArgs, PlaceArgs};

/// Tell where the sun is on a day, and draw its path; needs no model
///
/// Prints for each date when the sun rises, crosses the meridian and sets, how long it is up, and a line for each step of the clock: the local time
/// with its offset from UTC, and where the sun is. Azimuths are clockwise from true north; azimuths and altitudes are those of the middle of the
/// sun's disc, by NREL's solar position algorithm, within 0.0003 degrees. Rise and set are of its upper edge, on a level horizon at sea level.
///
/// Without --from and --to it is the whole day, and lines are left out where the sun does not count. Lines are the beginnings of steps and the end of the last
/// one; a study takes the sun at the middles of its steps, which --middles shows.
#[derive(Debug, Args)]
pub struct SunArgs {
    /// Where.
    #[command(flatten)]
    pub place: PlaceArgs,

    /// When.
    #[command(flatten)]
    pub period: PeriodArgs,

    /// Show the middles of steps, for which a study takes the sun, and no others
    #[arg(long)]
    pub middles: bool,

    /// Write JSON, all of the table in it (- for standard output, in place of the table)
    #[arg(long, value_name = "FILE", help_heading = "Files to write")]
    pub json: Option<PathBuf>,

    /// Draw the sun's path over the dates, the solstices and the equinoxes (SVG)
    #[arg(long, value_name = "FILE", help_heading = "Files to write")]
    pub diagram: Option<PathBuf>,
}
