//! The moments of a study, each with its sun.

use jiff::civil::Date;
use jiff::{SignedDuration, Timestamp};

use crate::Sun;

/// One span of time that is taken to be like its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// When it begins.
    pub start: Timestamp,
    /// When the next one begins.
    pub end: Timestamp,
    /// Index into [`Timetable::days`].
    pub day: u32,
    /// What the clock on the wall is ahead of UTC, in seconds.
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
    /// Indices of the steps of day `day`.
    pub fn steps_of_day(&self, day: usize) -> std::ops::Range<usize> {
        let start = self.steps.partition_point(|step| (step.day as usize) < day);
        let end = self.steps.partition_point(|step| (step.day as usize) <= day);
        start..end
    }
}
