//! Which times are studied: some dates, a window of each, and steps in it.

use std::fmt;

use jiff::civil::Date;
use jiff::{SignedDuration, Timestamp};

use crate::{Clock, LocalDay, LocalTime, Place, SunDay, SunOptions, TimeError};

/// The dates of a study, the window of each day, and how finely it is cut.
///
/// ```
/// use umbrae_study::{Clock, Edge, Period, Place, SunOptions, Timetable, Zone, parse_date, parse_step};
///
/// let vienna = Place::from_degrees(48.21, 16.37)?;
/// let period = Period {
///     clock: Clock::civil(Zone::of_place(&vienna)),
///     dates: vec![parse_date("2026-09-18")?],
///     from: Edge::parse_from("09:00")?,
///     to: Edge::parse_to("17:00")?,
///     step: parse_step("15min")?,
/// };
/// let timetable = Timetable::new(&vienna, &period, &SunOptions::default())?;
/// assert_eq!(timetable.steps.len(), 32);
/// assert_eq!(timetable.steps[0].local_start().to_string(), "2026-09-18T09:00:00");
/// # Ok::<(), umbrae_study::TimeError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Period {
    /// By which dates and times of day are meant.
    pub clock: Clock,
    /// In any order, and any number of times; each is studied once.
    pub dates: Vec<Date>,
    /// Where a day's window begins.
    pub from: Edge,
    /// Where it ends; itself no longer in it.
    pub to: Edge,
    /// How long a step is, 1 s to 24 h. They follow each other from the window's start, without regard to what happens to the clock on the
    /// wall; the last one is shorter where they do not fill the window, and stands for its own middle.
    pub step: SignedDuration,
}

/// What is looked at of one day.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DayWindow {
    /// The day.
    pub day: LocalDay,
    /// Half-open spans of it, in order and without overlaps: one for most windows, none or more where they follow the sun.
    pub spans: Vec<[Timestamp; 2]>,
}

/// Where a window of the day begins or ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// So long after the sun rises (of the beginning) or sets (of the end); negative before. Where it does neither, it is the end of
    /// the day; in polar night the window is empty.
    Sun(SignedDuration),
    /// When the clock shows this.
    Local(LocalTime),
}

/// From sunrise to sunset.
impl Default for Edge {
    fn default() -> Self {
        Self::Sun(SignedDuration::ZERO)
    }
}

impl Edge {
    /// `09:00`, `sunrise`, `sunrise+1h`, `sunrise-30min`.
    ///
    /// # Errors
    ///
    /// [`TimeError::Edge`] and [`TimeError::Duration`] for anything else.
    pub fn parse_from(text: &str) -> Result<Self, TimeError> {
        Self::parse(text, "sunrise")
    }

    /// `17:00`, `24:00`, `sunset`, `sunset-1h`.
    ///
    /// # Errors
    ///
    /// As [`Edge::parse_from`].
    pub fn parse_to(text: &str) -> Result<Self, TimeError> {
        Self::parse(text, "sunset")
    }

    fn parse(text: &str, event: &str) -> Result<Self, TimeError> {
        let Some(rest) = text.trim().strip_prefix(event) else {
            let time = text.parse().map_err(|_| TimeError::Edge { text: text.to_owned() })?;
            return Ok(Self::Local(time));
        };
        let wrong = || TimeError::Edge { text: text.to_owned() };
        match rest.trim().split_at_checked(1) {
            None => Ok(Self::Sun(SignedDuration::ZERO)),
            Some(("+", duration)) => Ok(Self::Sun(parse_duration(duration.trim())?)),
            Some(("-", duration)) => Ok(Self::Sun(-parse_duration(duration.trim())?)),
            Some(_) => Err(wrong()),
        }
    }

    pub(crate) fn text(self, event: &str) -> String {
        match self {
            Self::Local(time) => time.to_string(),
            Self::Sun(SignedDuration::ZERO) => event.to_owned(),
            Self::Sun(after) if after.is_negative() => format!("{event}-{}", DurationText(-after)),
            Self::Sun(after) => format!("{event}+{}", DurationText(after)),
        }
    }
}

/// `15min`, `1h`, `90s`, `1h30min` or `PT15M` into a step.
///
/// # Errors
///
/// [`TimeError::Duration`] if it has no unit, and [`TimeError::Step`] if it is not from 1 s to 24 h.
pub fn parse_step(text: &str) -> Result<SignedDuration, TimeError> {
    parse_duration(text).and_then(checked_step)
}

fn parse_duration(text: &str) -> Result<SignedDuration, TimeError> {
    let wrong = || TimeError::Duration { text: text.to_owned() };
    let duration: SignedDuration = text.trim().parse().map_err(|_| wrong())?;
    if duration.is_negative() { Err(wrong()) } else { Ok(duration) }
}

/// `step`, if it can be one.
fn checked_step(step: SignedDuration) -> Result<SignedDuration, TimeError> {
    let is_step = SignedDuration::from_secs(1) <= step && step <= SignedDuration::from_hours(24);
    if is_step { Ok(step) } else { Err(TimeError::Step { seconds: step.as_secs_f64() }) }
}

impl Period {
    /// The dates in order, each once, with what is looked at of each.
    ///
    /// # Errors
    ///
    /// As [`Clock::moment`]; [`TimeError::NoDate`], [`TimeError::Step`], and [`TimeError::EmptyWindow`] for times of the clock that are not one after the other.
    pub fn windows(&self, place: &Place, options: &SunOptions) -> Result<Vec<DayWindow>, TimeError> {
        checked_step(self.step)?;
        let mut dates = self.dates.clone();
        dates.sort_unstable();
        dates.dedup();
        if dates.is_empty() {
            return Err(TimeError::NoDate);
        }
        let window = |date: Date| {
            let day = self.clock.day(place, date)?;
            Ok(DayWindow { day, spans: self.windows_of_day(place, &day, options)? })
        };
        dates.into_iter().map(window).collect()
    }

    fn windows_of_day(
        &self,
        place: &Place,
        day: &LocalDay,
        options: &SunOptions,
    ) -> Result<Vec<[Timestamp; 2]>, TimeError> {
        let moment = |time| self.clock.moment(place, day.date, time);
        let up = || self.up(place, day, options);
        match (self.from, self.to) {
            (Edge::Local(from), Edge::Local(to)) => {
                let [start, end] = [moment(from)?, moment(to)?];
                if start < end { Ok(vec![[start, end]]) } else { Err(self.empty(day.date)) }
            }
            (Edge::Sun(_), Edge::Sun(_)) => up(),
            (Edge::Local(from), Edge::Sun(_)) => {
                let start = moment(from)?;
                let end = up()?.last().map(|[_, end]| *end).filter(|end| start < *end);
                Ok(end.map(|end| [start, end]).into_iter().collect())
            }
            (Edge::Sun(_), Edge::Local(to)) => {
                let end = moment(to)?;
                let start = up()?.first().map(|[start, _]| *start).filter(|start| *start < end);
                Ok(start.map(|start| [start, end]).into_iter().collect())
            }
        }
    }

    /// When the sun is up on `day`, its rises and sets moved as the edges say.
    fn up(&self, place: &Place, day: &LocalDay, options: &SunOptions) -> Result<Vec<[Timestamp; 2]>, TimeError> {
        let after = |edge: Edge| match edge {
            Edge::Sun(after) => after,
            Edge::Local(_) => SignedDuration::ZERO,
        };
        let no_sun = |_| TimeError::NoSun { time: day.start };
        let sun = SunDay::between(place, day.start, day.end, options)?;
        let mut spans: Vec<[Timestamp; 2]> = Vec::new();
        for [start, end] in sun.up() {
            // The ends of the day are neither rise nor set.
            let start =
                if sun.rises.contains(&start) { start.checked_add(after(self.from)).map_err(no_sun)? } else { start };
            let end = if sun.sets.contains(&end) { end.checked_add(after(self.to)).map_err(no_sun)? } else { end };
            let start = spans.last().map_or(day.start, |[_, end]| *end).max(start);
            let end = end.min(day.end);
            if start < end {
                spans.push([start, end]);
            }
        }
        Ok(spans)
    }

    fn empty(&self, date: Date) -> TimeError {
        TimeError::EmptyWindow { date, from: self.from.text("sunrise"), to: self.to.text("sunset") }
    }

    /// What should be said of this period: times that a clock shows twice, and windows that steps do not fill. Each a sentence.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for edge in [self.from, self.to] {
            if let Edge::Local(time) = edge {
                notes.extend(self.dates.iter().filter_map(|date| self.clock.fold_note(*date, time)));
            }
        }
        if let (Edge::Local(from), Edge::Local(to)) = (self.from, self.to) {
            let window = SignedDuration::from_secs(i64::from(to.seconds()) - i64::from(from.seconds()));
            let rest = SignedDuration::from_nanos((window.as_nanos() % self.step.as_nanos().max(1)) as i64);
            if window.is_positive() && !rest.is_zero() {
                notes.push(format!(
                    "{from} to {to} is no whole number of steps of {}: the last is {}, and stands for its own middle",
                    DurationText(self.step),
                    DurationText(rest)
                ));
            }
        }
        notes
    }
}

/// `2026-09-18, 09:00 to 17:00, every 15min`, as it is written on the command line.
impl fmt::Display for Period {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut dates = self.dates.clone();
        dates.sort_unstable();
        dates.dedup();
        let is_range =
            dates.len() > 1 && dates.windows(2).all(|pair| pair[0].tomorrow().is_ok_and(|next| next == pair[1]));
        let text = match (dates.first(), dates.last()) {
            (Some(first), Some(last)) if is_range => format!("{first}..{last}"),
            _ => dates.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        };
        let (from, to) = (self.from.text("sunrise"), self.to.text("sunset"));
        write!(f, "{text}, {from} to {to}, every {}", DurationText(self.step))
    }
}

/// `1h 30min`, without what is 0.
struct DurationText(SignedDuration);

impl fmt::Display for DurationText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.0.as_secs();
        let parts = [(seconds / 3600, "h"), (seconds / 60 % 60, "min"), (seconds % 60, "s")];
        let mut parts: Vec<String> =
            parts.iter().filter(|(count, _)| *count != 0).map(|(count, unit)| format!("{count}{unit}")).collect();
        if self.0.subsec_nanos() != 0 {
            parts.push(format!("{}ns", self.0.subsec_nanos()));
        }
        if parts.is_empty() { f.write_str("0s") } else { f.write_str(&parts.join("")) }
    }
}
