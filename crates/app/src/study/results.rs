//! Everything that a study's files are written from.

use std::fs::File;
use std::path::PathBuf;

use glam::DVec3;
use umbrae_study::rules::Verdict;
use umbrae_study::{GroundGrid, Receivers, Refinement, Step, SunDisc, SunOptions, Timetable};

use super::frame::Frame;
use super::receivers::ground;
use super::rows::RowShape;
use super::scene::Models;
use super::site::{Site, days_text, hours_text, offsets};
use super::sums::Sum;

/// A study that is computed, whole or in part.
#[derive(Debug)]
pub(crate) struct Results {
    /// The models' names.
    pub(crate) subject: String,
    pub(crate) site: Site,
    pub(crate) frame: Frame,
    pub(crate) models: Models,
    pub(crate) timetable: Timetable,
    /// For each step the direction to the sun, scene space; `None` where it does not count.
    pub(crate) suns: Vec<Option<DVec3>>,
    /// With it hours are to the second.
    pub(crate) refinement: Option<Refinement>,
    /// With it the sun is a disc, and hours are of its visible share.
    pub(crate) disc: Option<Disc>,
    pub(crate) receivers: Receivers,
    /// One, or two: before and after.
    pub(crate) states: Vec<State>,
    /// The second look at a sample, if it was asked for.
    pub(crate) check: Option<Check>,
    /// How near to an edge of a shadow a verdict counts as undecided, in metres.
    pub(crate) margin_m: f64,
    /// Whether it was stopped before its end.
    pub(crate) is_partial: bool,
    /// What the rules that were asked for say.
    pub(crate) verdicts: Vec<Verdict>,
    pub(crate) timings: Timings,
    pub(crate) inputs: Vec<Input>,
    pub(crate) options: serde_json::Value,
    pub(crate) warnings: Vec<String>,
}

/// What was found for one situation.
#[derive(Debug)]
pub(crate) struct State {
    /// "", "before" or "after".
    pub(crate) name: &'static str,
    /// Which objects of the models are there.
    pub(crate) objects: Vec<usize>,
    /// For each receiver.
    pub(crate) is_inside: Vec<bool>,
    /// For each receiver; `None` inside of solids, and where the study was stopped before.
    pub(crate) sums: Vec<Option<Sum>>,
    /// For each receiver a row of bits.
    pub(crate) rows: File,
    /// For each receiver a row of shares of the disc, a byte for each step (`fractions`), where the sun is one.
    pub(crate) fractions: Option<File>,
}

/// A file that was read.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct Input {
    pub(crate) path: PathBuf,
    pub(crate) role: &'static str,
    pub(crate) bytes: u64,
    pub(crate) sha256: String,
}

/// The suns of a study in which the sun is a disc.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Disc {
    /// For each step the direction to its middle, scene space; `None` where nothing of it counts.
    pub(crate) suns: Vec<Option<DVec3>>,
    /// The same for each minute of the refinement, if there is one.
    pub(crate) fine_suns: Vec<Option<DVec3>>,
}

impl Disc {
    /// Of the steps of `timetable`, and the minutes of `refinement`.
    pub(crate) fn new(
        timetable: &Timetable,
        refinement: Option<&Refinement>,
        options: &SunOptions,
        north_rad: f64,
    ) -> Self {
        let suns = |timetable: &Timetable| timetable.disc_directions(options, north_rad);
        Self { suns: suns(timetable), fine_suns: refinement.map_or_else(Vec::new, |fine| suns(fine.timetable())) }
    }
}

/// A sample of verdicts, found once more by rays.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub(crate) struct Check {
    /// How many receivers were looked at.
    pub(crate) receivers: usize,
    /// How many verdicts that makes.
    pub(crate) verdicts: u64,
    /// Verdicts that differ although no edge of a shadow is within the engine's margin of the receiver.
    pub(crate) disagreements: u64,
    /// Verdicts that differ where one is.
    pub(crate) undecided: u64,
    /// The same of shares of the sun's disc, where it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) disc: Option<DiscCheck>,
}

/// A sample of shares of the sun's disc, estimated by rays to places all over it.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub(crate) struct DiscCheck {
    /// How many shares were looked at.
    pub(crate) shares: u64,
    /// Of these, how many are neither nothing nor all.
    pub(crate) partial: u64,
    /// How many differ by more than chance explains.
    pub(crate) disagreements: u64,
    /// How many differ where the estimate is another one beside the receiver.
    pub(crate) undecided: u64,
    /// The sum of all shares, less that of the estimates.
    pub(crate) sum_of_differences: f64,
    /// The largest difference, with the estimate by the most rays.
    pub(crate) largest_difference: f64,
}

/// Seconds by the clock.
#[derive(Debug, Clone, Copy, Default, serde::Serialize)]
pub(crate) struct Timings {
    pub(crate) load_s: f64,
    pub(crate) prepare_s: f64,
    pub(crate) engine_s: f64,
    pub(crate) check_s: f64,
    pub(crate) rules_s: f64,
    pub(crate) write_s: f64,
    pub(crate) total_s: f64,
}

impl Results {
    /// The state that results are about first: the only one, or the one after.
    pub(crate) fn last(&self) -> Option<&State> {
        self.states.last()
    }

    /// The grid on the ground, if there is one.
    pub(crate) fn ground(&self) -> Option<(GroundGrid, std::ops::Range<usize>)> {
        ground(&self.receivers)
    }

    pub(crate) fn row_shape(&self) -> RowShape {
        RowShape { step_count: self.suns.len() }
    }

    /// Steps at which the sun counts.
    pub(crate) fn day_steps(&self) -> usize {
        self.suns.iter().flatten().count()
    }

    /// The time in which there can be sun, in hours; where it is a disc, each step as much of it as is above the horizon.
    pub(crate) fn possible_hours(&self) -> f64 {
        if let Some(disc) = &self.disc {
            let steps = match &self.refinement {
                Some(fine) => fine.timetable().steps.iter().zip(&disc.fine_suns),
                None => self.timetable.steps.iter().zip(&disc.suns),
            };
            let hours = |(step, sun): (&Step, &Option<DVec3>)| {
                sun.map_or(0.0, |to_sun| SunDisc::new(to_sun).share_above_horizon() * step.duration_s() / 3600.0)
            };
            return steps.map(hours).sum();
        }
        let steps = self.timetable.steps.iter().zip(&self.suns);
        steps.filter(|(_, sun)| sun.is_some()).map(|(step, _)| step.duration_s()).sum::<f64>() / 3600.0
    }

    /// `18 September 2026, 09:00 to 17:00, Europe/Vienna (UTC+02:00)`.
    pub(crate) fn period_text(&self) -> String {
        let offsets = offsets(&self.timetable).join(" and ");
        let (days, hours) = (days_text(&self.timetable), hours_text(&self.timetable));
        format!("{days}, {hours}, {} (UTC{offsets})", self.site.clock)
    }

    /// Where the sun is seen, and as what: `apparent, with standard refraction`.
    pub(crate) fn sun_text(&self) -> String {
        let disc = if self.disc.is_some() { "; a disc of 0.533\u{b0}, of which the visible share counts" } else { "" };
        format!("{}{disc}", self.site.sun)
    }

    /// What may be missed if it is shorter, in words.
    pub(crate) fn shortest_seen(&self) -> &'static str {
        if self.refinement.is_some() { "a minute" } else { "a step" }
    }

    /// The largest error bound of any receiver, in seconds, and the mean of all.
    pub(crate) fn error_bounds_s(&self) -> [f64; 2] {
        let errors = || self.states.iter().flat_map(|state| &state.sums).flatten().map(|sum| f64::from(sum.error_s));
        let count = errors().count().max(1);
        [errors().fold(0.0, f64::max), errors().sum::<f64>() / count as f64]
    }
}

impl State {
    /// `hours.tif`, or `hours_before.tif`.
    pub(crate) fn file_name(&self, stem: &str, ending: &str) -> String {
        if self.name.is_empty() { format!("{stem}.{ending}") } else { format!("{stem}_{}.{ending}", self.name) }
    }

    /// Hours of sun of a receiver; `None` inside of solids, and where the study was stopped before.
    pub(crate) fn hours(&self, receiver: usize) -> Option<f64> {
        self.sums[receiver].map(|sum| sum.hours())
    }
}

/// `8.4 min`, or `1.25 s` where it is less than a minute.
pub(crate) fn duration_text(seconds: f64) -> String {
    if seconds < 60.0 && seconds > 0.0 { format!("{seconds:.2} s") } else { format!("{:.1} min", seconds / 60.0) }
}
