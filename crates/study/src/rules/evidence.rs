//! What is known about the sun of receivers.

use jiff::civil::Date;
use serde::Serialize;

use super::ReceiverKind;
use crate::SunHours;

/// A number, and between what numbers it may be.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Bounded {
    /// It is not less.
    pub least: f64,
    /// As computed.
    pub value: f64,
    /// It is not more.
    pub most: f64,
}

impl Bounded {
    /// A number that is exact.
    pub fn exact(value: f64) -> Self {
        Self { least: value, value, most: value }
    }

    /// A number of 0 or more that may be wrong by `error` either way.
    pub fn within(value: f64, error: f64) -> Self {
        Self { least: (value - error).max(0.0), value, most: value + error }
    }

    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self { least: f(self.least), value: f(self.value), most: f(self.most) }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { least: self.least + other.least, value: self.value + other.value, most: self.most + other.most }
    }
}

/// The sun of one receiver on one day, as far as a rule counts it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct CountedSun {
    /// All of it, seconds.
    pub total_s: Bounded,
    /// The longest in one piece, seconds.
    pub longest_s: Bounded,
}

impl CountedSun {
    /// Of `hours`, the pieces that are worth `least_span_s` seconds of the sun or more. Where the sun is a disc, a piece goes on while any of it is seen.
    ///
    /// Which end of which piece is wrong is not known, so each piece may be wrong by all of [`SunHours::error_bound_s`]; a piece that may be too short is in
    /// the upper bounds only, one that may be long enough as well.
    pub fn of(hours: &SunHours, least_span_s: f64) -> Self {
        let error_s = hours.error_bound_s;
        let spans = || hours.intervals.iter().map(|interval| interval.sun_s);
        let total = |least: f64| spans().filter(|&s| s >= least).sum::<f64>();
        let longest = |least: f64| spans().filter(|&s| s >= least).fold(0.0, f64::max);
        // With no least length, what was seen is sure to count.
        let (sure, likely) =
            if least_span_s > 0.0 { (least_span_s + error_s, least_span_s - error_s) } else { (0.0, 0.0) };
        let bounded = |sum: &dyn Fn(f64) -> f64| Bounded {
            least: (sum(sure) - error_s).max(0.0),
            value: sum(least_span_s),
            most: sum(likely) + error_s,
        };
        Self { total_s: bounded(&total), longest_s: bounded(&longest) }
    }
}

/// The sun of all receivers, on the days that a rule asks for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evidence {
    /// In order.
    pub days: Vec<Date>,
    /// In any order.
    pub groups: Vec<GroupEvidence>,
}

/// The sun of receivers that belong together: of one garden, one flat, one building.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupEvidence {
    /// What it is called.
    pub name: String,
    /// What its receivers are on.
    pub kind: ReceiverKind,
    /// What each receiver stands for: square metres, or 1. Those inside of solids are left out.
    pub weights: Vec<f64>,
    /// That of receiver `r` on day `d` is number `r * days + d`.
    pub sun: Vec<CountedSun>,
    /// As [`GroupEvidence::sun`], before what is proposed was there.
    pub sun_before: Option<Vec<CountedSun>>,
}
