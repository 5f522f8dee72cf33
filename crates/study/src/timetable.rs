//! The moments of a study, each with its sun.

use glam::DVec3;
use jiff::civil::{Date, DateTime};
use jiff::tz::Offset;
use jiff::{SignedDuration, Timestamp};
use rayon::prelude::*;

use crate::zone::offset_s_text;
use crate::{Period, Place, Sun, SunOptions, TimeError};

/// Two thousand years of hours, or a year of seconds for every third day: beyond, it is a slip of the pen.
const MOST_STEPS: usize = 20_000_000;
/// What is left of a window after its last whole step is a step of its own if it is longer; else it is the rounding of a sundial.
const LEAST_REST: SignedDuration = SignedDuration::from_millis(1);

/// One span of time that is taken to be like its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// When it begins.
    pub start: Timestamp,
    /// When the next one begins.
    pub end: Timestamp,
    /// Index into [`Timetable::days`].
    pub day: u32,
    /// What the study's clock is ahead of UTC at the start, in seconds.
    pub utc_offset_s: i32,
    /// The sun at the middle.
    pub sun: Sun,
    /// Whether the sun is high enough to count.
    pub is_day: bool,
}

impl Step {
    /// The moment that it stands for.
    pub fn middle(&self) -> Timestamp {
        self.start + SignedDuration::from_nanos((self.duration_s() * 0.5e9).round() as i64)
    }

    /// What the clock shows at its start.
    pub fn local_start(&self) -> DateTime {
        self.local(self.start)
    }

    /// What the clock shows at its middle, if it is not changed before.
    pub fn local_middle(&self) -> DateTime {
        self.local(self.middle())
    }

    /// `time` by the clock as it is set at the start.
    pub fn local(&self, time: Timestamp) -> DateTime {
        Offset::from_seconds(self.utc_offset_s).unwrap_or(Offset::UTC).to_datetime(time)
    }

    /// How long it is.
    pub fn duration_s(&self) -> f64 {
        self.end.duration_since(self.start).as_secs_f64()
    }
}

/// The steps of a study, in order of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Timetable {
    /// Local dates, each once, in order.
    pub days: Vec<Date>,
    /// Steps of one day follow each other.
    pub steps: Vec<Step>,
}

impl Timetable {
    /// The steps of `period` at `place`, each with the sun at its middle.
    ///
    /// In a step in which the sun rises, sets or passes the least altitude the middle decides for the whole: hours are off by half a step at most
    /// each time. [`crate::spans_of_sun`] has the exact moments, with which a refined study cuts such steps.
    ///
    /// Takes some 10 microseconds a step, four times that by a sundial, and a millisecond or two for each day's rise and set where the window
    /// asks for them: a second for the days of a year in quarters of an hour.
    ///
    /// # Errors
    ///
    /// As [`Period::windows`] and [`Sun::at`]; [`TimeError::MinAltitude`] and [`TimeError::TooManySteps`].
    pub fn new(place: &Place, period: &Period, options: &SunOptions) -> Result<Self, TimeError> {
        if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&options.min_altitude_rad) {
            return Err(TimeError::MinAltitude { degrees: options.min_altitude_rad.to_degrees() });
        }
        let windows = period.windows(place, options)?;
        let mut spans: Vec<(u32, [Timestamp; 2])> = Vec::new();
        for (day, window) in windows.iter().enumerate() {
            for &window in &window.spans {
                cut(period, window, |span| {
                    spans.push((day as u32, span));
                    if spans.len() <= MOST_STEPS { Ok(()) } else { Err(TimeError::TooManySteps { most: MOST_STEPS }) }
                })?;
            }
        }
        let step = |&(day, [start, end]): &(u32, [Timestamp; 2])| {
            let utc_offset_s = period.clock.utc_offset_s(place, start)?;
            let night = Sun { azimuth_rad: 0.0, altitude_rad: 0.0 };
            let step = Step { start, end, day, utc_offset_s, sun: night, is_day: false };
            let sun = Sun::at(place, step.middle(), options)?;
            Ok(Step { sun, is_day: sun.counts(options), ..step })
        };
        let steps: Result<Vec<Step>, TimeError> = spans.par_iter().map(step).collect();
        Ok(Self { days: windows.iter().map(|window| window.day.date).collect(), steps: steps? })
    }

    /// What the clock is ahead of UTC on day `day`, in words: `+02:00`, `+01:00, from 03:00 +02:00`, or, of a sundial, `+01:05:28 to
    /// +01:05:31`. Empty for a day without steps.
    pub fn offsets_of_day(&self, day: usize) -> String {
        let steps = &self.steps[self.steps_of_day(day)];
        let changes: Vec<&Step> =
            steps.chunk_by(|a, b| a.utc_offset_s == b.utc_offset_s).filter_map(<[Step]>::first).collect();
        match changes.as_slice() {
            [] => String::new(),
            [only] => offset_s_text(only.utc_offset_s),
            [before, after] if (before.utc_offset_s - after.utc_offset_s).abs() >= 60 => format!(
                "{}, from {} {}",
                offset_s_text(before.utc_offset_s),
                after.local_start().strftime("%H:%M"),
                offset_s_text(after.utc_offset_s)
            ),
            [first, .., last] => {
                format!("{} to {}", offset_s_text(first.utc_offset_s), offset_s_text(last.utc_offset_s))
            }
        }
    }

    /// For each step the direction to the sun in a scene; `None` where it does not count. `north_rad` as for [`Sun::direction`].
    pub fn directions(&self, north_rad: f64) -> Vec<Option<DVec3>> {
        self.steps.iter().map(|step| step.is_day.then(|| step.sun.direction(north_rad))).collect()
    }

    /// The same for the sun as a disc, which counts while any of it is above the horizon: see [`Sun::counts_as_disc`].
    pub fn disc_directions(&self, options: &SunOptions, north_rad: f64) -> Vec<Option<DVec3>> {
        let direction = |step: &Step| step.sun.counts_as_disc(options).then(|| step.sun.direction(north_rad));
        self.steps.iter().map(direction).collect()
    }

    /// Indices of the steps of day `day`.
    pub fn steps_of_day(&self, day: usize) -> std::ops::Range<usize> {
        let start = self.steps.partition_point(|step| (step.day as usize) < day);
        let end = self.steps.partition_point(|step| (step.day as usize) <= day);
        start..end
    }
}

/// Hands the steps of `period` in `window` to `take`, in order.
fn cut(
    period: &Period,
    [start, end]: [Timestamp; 2],
    mut take: impl FnMut([Timestamp; 2]) -> Result<(), TimeError>,
) -> Result<(), TimeError> {
    let mut from = start;
    for count in 1_i32.. {
        let to = period.clock.after(start, period.step * count)?;
        if end.duration_since(to) < LEAST_REST {
            break;
        }
        take([from, to])?;
        from = to;
    }
    take([from, end])
}
