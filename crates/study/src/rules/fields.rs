//! What a rule is made of: days of the year, times of day, kinds of receivers, and how many are enough.

use std::fmt;
use std::str::FromStr;

use jiff::civil::Date;
use serde::{Serialize, Serializer};

use crate::{ClockKind, Edge};

/// A day of every year, `MM-DD`; never 29 February, which most years lack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct MonthDay {
    month: i8,
    day: i8,
}

/// A year without 29 February.
const COMMON_YEAR: i16 = 2023;

impl MonthDay {
    /// That day of `year`; `None` in years that the calendar does not have (before -9999, after 9999).
    pub fn of_year(self, year: i16) -> Option<Date> {
        Date::new(year, self.month, self.day).ok()
    }
}

impl FromStr for MonthDay {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |part: &str| (part.len() == 2).then(|| part.parse::<i8>().ok())?;
        let parts = text.split_once('-').and_then(|(month, day)| Some((number(month)?, number(day)?)));
        let (month, day) = parts.ok_or("is not written MM-DD")?;
        if (month, day) == (2, 29) {
            return Err("is not in every year; take 02-28 or 03-01");
        }
        Date::new(COMMON_YEAR, month, day).map_err(|_| "is in no calendar")?;
        Ok(Self { month, day })
    }
}

impl fmt::Display for MonthDay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02}-{:02}", self.month, self.day)
    }
}

/// The dates on which sun is asked for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dates {
    /// These, in order, each once.
    Days(Vec<MonthDay>),
    /// From the first to the second, both included.
    Window(MonthDay, MonthDay),
}

/// On which of its dates a rule must be met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Need {
    /// A receiver has enough sun if it has on some date, not necessarily that of another receiver.
    Any,
    /// A receiver has enough sun only if it has on every date.
    Each,
    /// Each date is judged by itself, and that with the smallest share of receivers counts; before a project as well as now, so
    /// that a ratio may be of two dates.
    Worst,
}

/// By which clock, and from when to when, sun counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RuleClock {
    /// The law's time or the sun's.
    pub kind: ClockKind,
    /// The first moment that counts.
    pub from: Edge,
    /// The first that does not any more.
    pub to: Edge,
}

impl Serialize for RuleClock {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let kind = match self.kind {
            ClockKind::Civil => "civil",
            ClockKind::Solar => "solar",
        };
        serializer.collect_map([("kind", kind), ("from", &self.from.text("sunrise")), ("to", &self.to.text("sunset"))])
    }
}

impl Serialize for MonthDay {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// What receivers are on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReceiverKind {
    /// A grid on the ground.
    Ground,
    /// Points of windows.
    Window,
    /// Points on walls.
    Wall,
    /// Points on roofs.
    Roof,
    /// Any points that the user gave.
    Points,
}

impl ReceiverKind {
    pub(super) const ALL: [Self; 5] = [Self::Ground, Self::Window, Self::Wall, Self::Roof, Self::Points];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ground => "ground",
            Self::Window => "window",
            Self::Wall => "wall",
            Self::Roof => "roof",
            Self::Points => "points",
        }
    }
}

/// How many of some things are enough.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Enough {
    /// One of them.
    One,
    /// Every one.
    All,
    /// This part of them, by area where they have one: more than 0, 1 at most.
    Share(f64),
}

/// Summing a million areas of `f32` may lose so much of a share.
pub(super) const SHARE_ROUNDING: f64 = 1e-9;

impl Enough {
    /// The share that they are measured by: more than 0 for one of them, 1 for all.
    pub fn threshold(self) -> f64 {
        match self {
            Self::One => 0.0,
            Self::All => 1.0,
            Self::Share(least) => least,
        }
    }

    /// Whether `share` of them, 0 to 1, is enough.
    pub fn is_met_by(self, share: f64) -> bool {
        match self {
            Self::One => share > 0.0,
            Self::All => share >= 1.0 - SHARE_ROUNDING,
            Self::Share(least) => share >= least - SHARE_ROUNDING,
        }
    }
}

impl fmt::Display for Enough {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One => f.write_str("one"),
            Self::All => f.write_str("all"),
            Self::Share(share) => write!(f, "{}", super::verdict::Percent(*share)),
        }
    }
}
