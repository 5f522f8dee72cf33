//! What is wrong with a place, a date, a clock time or a zone.

use jiff::Timestamp;
use jiff::civil::{Date, DateTime};

use crate::LocalTime;
use crate::zone::offset_text;

/// Why there is no [`crate::Place`], no [`crate::Period`] or no [`crate::Timetable`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TimeError {
    /// Not from the south pole to the north pole.
    #[error("a latitude of {degrees:?} is not on Earth; write degrees from -90 (south) to 90 (north)")]
    Latitude {
        /// As given.
        degrees: f64,
    },
    /// Not once around.
    #[error(
        "a longitude of {degrees:?} is not on Earth; write degrees from -180 (west) to 180 (east), or 0 to 360 eastwards"
    )]
    Longitude {
        /// As given.
        degrees: f64,
    },
    /// Neither on the ground nor anywhere near.
    #[error("an elevation of {metres:?} m is not on Earth; write metres above the sea from -500 to 10000")]
    Elevation {
        /// As given.
        metres: f64,
    },
    /// No such zone.
    #[error("there is no time zone `{name}`{}; write a name of the IANA database such as Europe/Vienna, or an offset such as +01:00", suggestion(.near))]
    UnknownZone {
        /// As given.
        name: String,
        /// Names that are written similarly, the nearest first.
        near: Vec<String>,
    },
    /// Not a day of the calendar, or not written as one.
    #[error("`{text}` is no date: {reason}")]
    Date {
        /// As given.
        text: String,
        /// What about it.
        reason: String,
    },
    /// A range that ends before it begins.
    #[error("the dates {first}..{last} end before they begin; write the earlier one first")]
    DatesReversed {
        /// As given.
        first: Date,
        /// As given.
        last: Date,
    },
    /// Nothing to look at.
    #[error("there is no date; give at least one")]
    NoDate,
    /// Left out by a zone that has moved across the date line.
    #[error("there was no {date} in {zone}: its clocks went from {before} straight to {after}")]
    SkippedDay {
        /// The date.
        date: Date,
        /// Of which clock.
        zone: String,
        /// The local date before.
        before: Date,
        /// The local date after.
        after: Date,
    },
    /// Not a time of day, or not written as one.
    #[error("`{text}` is no time of day; write hours and minutes from 00:00 to 24:00, such as 09:30")]
    LocalTime {
        /// As given.
        text: String,
    },
    /// As [`TimeError::LocalTime`], where sunrise and sunset will do as well.
    #[error(
        "`{text}` is no time of day; write hours and minutes from 00:00 to 24:00, such as 09:30, or sunrise or sunset, such as sunrise+1h"
    )]
    Edge {
        /// As given.
        text: String,
    },
    /// Clocks were put forward over it.
    #[error(
        "{time} on {date} does not exist in {zone}: clocks went from {} ({}) straight to {} ({}); give a time before or after that",
        shown(*before, *date),
        offset_text(*before_offset),
        shown(*after, *date),
        offset_text(*after_offset)
    )]
    Gap {
        /// The time that does not exist.
        time: LocalTime,
        /// On which day.
        date: Date,
        /// In which zone.
        zone: String,
        /// What the clock showed when it was put forward; the first time that does not exist.
        before: DateTime,
        /// Of UTC, until then.
        before_offset: jiff::tz::Offset,
        /// What it showed then; the first time that exists again.
        after: DateTime,
        /// Of UTC, from then.
        after_offset: jiff::tz::Offset,
    },
    /// A time with an offset that the zone does not have then.
    #[error(
        "{time} on {date} is not a time of {zone}, whose clocks are {} then; leave the offset out, or count in it all along with the time zone {}",
        offset_text(*used),
        offset_text(*given)
    )]
    OffsetNotInUse {
        /// The time, with its offset.
        time: LocalTime,
        /// On which day.
        date: Date,
        /// In which zone.
        zone: String,
        /// What the clocks have.
        used: jiff::tz::Offset,
        /// What the time has.
        given: jiff::tz::Offset,
    },
    /// An offset from UTC on a sundial.
    #[error("{time} has an offset from UTC, which true solar time has not; leave one of them out")]
    OffsetOfSolarTime {
        /// The time, with its offset.
        time: LocalTime,
    },
    /// Nothing between the two.
    #[error("on {date} the time from {from} to {to} is empty; the second has to be the later one, 24:00 at the latest")]
    EmptyWindow {
        /// On which day.
        date: Date,
        /// As given.
        from: String,
        /// As given.
        to: String,
    },
    /// Not a length of time, or not written as one.
    #[error("`{text}` is no length of time; write a number and its unit, such as 15min, 1h, 90s or PT15M")]
    Duration {
        /// As given.
        text: String,
    },
    /// Too short or too long to be a step.
    #[error("a step of {seconds} s can't be used; it can be from 1 s to 24 h")]
    Step {
        /// As given.
        seconds: f64,
    },
    /// More than memory should be asked for.
    #[error("these are more than {most} steps; take fewer dates or a longer step")]
    TooManySteps {
        /// So many would do.
        most: usize,
    },
    /// Not an altitude that the sun can be asked to have.
    #[error("a least altitude of {degrees:?} degrees can't be used; it can be from 0 up to 90")]
    MinAltitude {
        /// As given.
        degrees: f64,
    },
    /// Not the air of the Earth.
    #[error(
        "air of {pressure_hpa:?} hPa and {temperature_c:?} °C can't be used; it can be from above 0 to 2000 hPa and from -272 to 100 °C"
    )]
    Air {
        /// As given.
        pressure_hpa: f64,
        /// As given.
        temperature_c: f64,
    },
    /// Too long ago, or too far ahead.
    #[error("where the sun is on {} is not known: the rotation of the Earth can be estimated for the years -500 to 3000", .time.strftime("%Y-%m-%d"))]
    NoSun {
        /// The moment.
        time: Timestamp,
    },
}

fn suggestion(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    if names.is_empty() { String::new() } else { format!("; did you mean {}?", names.join(" or ")) }
}

/// The time alone where the date is clear.
fn shown(clock: DateTime, date: Date) -> String {
    let time = clock.strftime(if clock.second() == 0 { "%H:%M" } else { "%H:%M:%S" });
    if clock.date() == date { time.to_string() } else { format!("{time} of {}", clock.date()) }
}
