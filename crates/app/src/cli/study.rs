//! What a study of sun and shadow is asked.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{LoadArgs, PeriodArgs, PlaceArgs};
use crate::cast::{CastChoice, Pattern};
use crate::parse::metres;

/// What receivers stand on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum On {
    /// A grid on the ground: on terrain where the model has some, else level (--ground)
    Ground,
    /// Points on roofs
    Roof,
    /// Points on walls
    Wall,
}

impl On {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ground => "ground",
            Self::Roof => "roof",
            Self::Wall => "wall",
        }
    }
}

/// Find where the sun reaches over a period: hours, shadow profiles, verdicts; needs no graphics driver
///
/// Without options beside the place and the date: a grid on the ground, fine enough for about a hundred thousand points, from sunrise to sunset,
/// every 15 minutes. A step stands for its middle. Everything goes into one folder; `report.html` in it tells what the rest is. Hours are of a clear
/// sky: where the sun would reach if there were no clouds.
#[derive(Debug, Args)]
pub struct StudyArgs {
    /// Models that are there before and after: see `umbrae inspect --help` for formats
    #[arg(required_unless_present_any = ["existing", "proposed"], value_name = "MODEL")]
    pub models: Vec<PathBuf>,

    /// Folder to write to; made if it is not there
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,

    /// A model of what is there before and goes; may be repeated. Results are then given before, after and as their difference
    #[arg(long, value_name = "MODEL", help_heading = "Before and after")]
    pub existing: Vec<PathBuf>,

    /// A model of what is there after; may be repeated
    #[arg(long, value_name = "MODEL", help_heading = "Before and after")]
    pub proposed: Vec<PathBuf>,

    /// Only these cast shadows: names of objects or materials, separated by commas, in which * stands for anything and ? for one character
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = Pattern::new, help_heading = "Who casts")]
    pub cast: Vec<Pattern>,

    /// These cast no shadow, even if --cast names them
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = Pattern::new, help_heading = "Who casts")]
    pub no_cast: Vec<Pattern>,

    /// Let glass cast like anything else
    #[arg(long, help_heading = "Who casts")]
    pub glass_casts: bool,

    /// What receivers stand on; with --points, the default is nothing else
    #[arg(long, value_name = "WHAT", value_delimiter = ',', help_heading = "Receivers")]
    pub on: Vec<On>,

    /// From one receiver to the next (default: such that there are about a hundred thousand)
    #[arg(long, value_name = "METRES", value_parser = metres, allow_hyphen_values = true, help_heading = "Receivers")]
    pub spacing: Option<f64>,

    /// Height of the ground where there is no terrain, in the models' coordinates (default: that on which half of the objects stand)
    #[arg(long, value_name = "METRES", allow_hyphen_values = true, value_parser = height, help_heading = "Receivers")]
    pub ground: Option<f64>,

    /// Receivers from a CSV file with a header: x,y,z and perhaps nx,ny,nz (the side that they are open to) and id, in the model's coordinates
    #[arg(long, value_name = "FILE", help_heading = "Receivers")]
    pub points: Option<PathBuf>,

    /// Find hours to the second: look every minute, and for each change between two minutes when it is; with --sun-disc, sum the disc's share minute by
    /// minute. The pictures and bits remain those of --step. Without, each change may be half a step off; the error bound says how much that makes
    #[arg(long, help_heading = "Results")]
    pub refine: bool,

    /// Take the sun as a disc of 0.533 degrees: each step counts for as much of it as is seen, exactly, and hours are sums of that. Then the sun counts from when
    /// the disc's upper edge rises until it has set. `fractions.npz` has the share for each receiver and step; outlines and bits remain those of its middle
    #[arg(long, help_heading = "Results")]
    pub sun_disc: bool,

    /// Colour the shadow profile by the objects that cast
    #[arg(long, help_heading = "Results")]
    pub by_object: bool,

    /// Judge by a rule: a preset, or a TOML file, each with variants after colons (en17037:germany:high). May be repeated. Presets: en17037, bre209,
    /// tno-light, tno-strict, pl-wt60, nsw-adg
    #[arg(long = "rule", value_name = "NAME|FILE", help_heading = "Results")]
    pub rules: Vec<String>,

    /// Draw no perspective picture, and do not look for a graphics adapter
    #[arg(long, help_heading = "Results")]
    pub no_perspective: bool,

    /// Decide so many receivers once more at every step, by rays in double precision, and tell in how many verdicts that differs
    #[arg(long, value_name = "COUNT", default_value_t = 1000, help_heading = "Results")]
    pub check: usize,

    /// Continue a study that was stopped, if models and options are as they were
    #[arg(long, help_heading = "Machine")]
    pub resume: bool,

    /// Threads to compute on (default: one for each core); results do not depend on it
    #[arg(long, value_name = "COUNT", help_heading = "Machine")]
    pub threads: Option<NonZeroUsize>,

    /// Degrees from the y axis of the models clockwise to true north (default: as their coordinate reference system has it, else 0)
    #[arg(long, value_name = "DEGREES", value_parser = north_deg, allow_hyphen_values = true, help_heading = "Place")]
    pub north: Option<f64>,

    /// Where.
    #[command(flatten)]
    pub place: PlaceArgs,

    /// When.
    #[command(flatten)]
    pub period: PeriodArgs,

    /// How models are read.
    #[command(flatten)]
    pub load: LoadArgs,
}

impl StudyArgs {
    /// Who casts.
    pub fn cast_choice(&self) -> CastChoice {
        CastChoice { cast: self.cast.clone(), no_cast: self.no_cast.clone(), glass_casts: self.glass_casts }
    }
}

fn north_deg(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse().ok().filter(|degrees| (-360.0..=360.0).contains(degrees));
    degrees.ok_or_else(|| format!("`{text}` is not a direction; write degrees from -360 to 360, such as 12.5"))
}

fn height(text: &str) -> Result<f64, String> {
    let metres = text.trim().parse().ok().filter(|metres: &f64| metres.abs() < 1e5);
    metres.ok_or_else(|| format!("`{text}` is not a height; write metres, such as 171.5"))
}
