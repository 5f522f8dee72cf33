//! Bits into hours.

use jiff::Timestamp;

use crate::Step;

/// A span of sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// When the sun arrives.
    pub start: Timestamp,
    /// When it is gone.
    pub end: Timestamp,
}

impl Interval {
    /// How long it is.
    pub fn duration_s(&self) -> f64 {
        self.end.duration_since(self.start).as_secs_f64()
    }
}

/// The sun of one receiver over some steps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SunHours {
    /// In order, apart from each other.
    pub intervals: Vec<Interval>,
    /// By how much [`SunHours::total_s`] may be wrong, either way, if no sun or shade shorter than a step was missed.
    pub error_bound_s: f64,
}

impl SunHours {
    /// Sums `steps` for which `is_lit` says so; neighbours join.
    ///
    /// Every change between two steps that follow each other without a gap is wrong by half a step at most, as a step stands for its middle.
    pub fn of_steps(steps: &[Step], is_lit: impl Fn(usize) -> bool) -> Self {
        let mut hours = Self::default();
        for (i, step) in steps.iter().enumerate() {
            if !is_lit(i) {
                continue;
            }
            let next = |j: usize| steps.get(j).is_some_and(|other| other.start == step.end);
            let previous = i.checked_sub(1).filter(|&j| steps[j].end == step.start);
            match hours.intervals.last_mut().filter(|last| last.end == step.start) {
                Some(last) => last.end = step.end,
                None => hours.intervals.push(Interval { start: step.start, end: step.end }),
            }
            hours.error_bound_s += previous.filter(|&j| !is_lit(j)).map_or(0.0, |_| step.duration_s() / 2.0);
            hours.error_bound_s += if next(i + 1) && !is_lit(i + 1) { step.duration_s() / 2.0 } else { 0.0 };
        }
        hours
    }

    /// All the sun, in seconds.
    pub fn total_s(&self) -> f64 {
        self.intervals.iter().map(Interval::duration_s).sum()
    }

    /// The longest sun without a break, in seconds.
    pub fn longest_s(&self) -> f64 {
        self.intervals.iter().map(Interval::duration_s).fold(0.0, f64::max)
    }
}
