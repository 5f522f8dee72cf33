//! What the sun does on some days, as numbers.

use jiff::civil::{Date, DateTime, Time};
use jiff::tz::Offset;
use jiff::{SignedDuration, Timestamp};
use umbrae_study::{
    Clock, ClockKind, Edge, LocalDay, LocalTime, Period, Place, Refraction, Sun, SunDay, SunOptions, TimeError,
    Timetable,
};

use crate::cli::SunArgs;

/// Days of the sun at a place.
#[derive(Debug)]
pub(super) struct Almanac {
    pub(super) place: Place,
    pub(super) clock: Clock,
    pub(super) options: SunOptions,
    /// In order.
    pub(super) days: Vec<Day>,
    /// What should be said of the times that were asked for.
    pub(super) notes: Vec<String>,
}

/// One day.
#[derive(Debug)]
pub(super) struct Day {
    pub(super) local: LocalDay,
    /// What the clock is ahead of UTC, in words.
    pub(super) offsets: String,
    pub(super) sun: SunDay,
    pub(super) rows: Vec<Seen>,
}

/// The sun at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) time: Timestamp,
    /// What the clock is ahead of UTC.
    pub(super) utc_offset_s: i32,
    pub(super) sun: Sun,
}

impl Almanac {
    pub(super) fn new(place: Place, args: &SunArgs) -> Result<Self, TimeError> {
        let options = args.period.sun_options();
        let asked = args.period.period(args.place.zone(&place));
        // A study's window follows the sun; a table's lines are at full steps of the clock.
        let edge = |given: Option<Edge>, end: LocalTime| given.unwrap_or(Edge::Local(end));
        let by_clock = Period {
            from: edge(args.period.from, LocalTime::START_OF_DAY),
            to: edge(args.period.to, LocalTime::END_OF_DAY),
            ..asked.clone()
        };
        let is_all_shown = args.period.from.is_some() && args.period.to.is_some();
        let period = if args.middles { asked } else { by_clock };
        let timetable = Timetable::new(&place, &period, &options)?;
        let mut almanac = Self { place, clock: period.clock.clone(), options, days: Vec::new(), notes: period.notes() };
        for (index, &date) in timetable.days.iter().enumerate() {
            let steps = &timetable.steps[timetable.steps_of_day(index)];
            let mut moments: Vec<Timestamp> = Vec::new();
            for (i, step) in steps.iter().enumerate() {
                if args.middles {
                    moments.push(step.middle());
                    continue;
                }
                moments.push(step.start);
                if steps.get(i + 1).is_none_or(|next| next.start != step.end) {
                    moments.push(step.end);
                }
            }
            let mut rows = Vec::new();
            for time in moments {
                let seen = almanac.seen(time)?;
                if is_all_shown || args.middles || seen.sun.counts(&options) {
                    rows.push(seen);
                }
            }
            let day = Day { rows, ..almanac.day(date)? };
            almanac.days.push(day);
        }
        Ok(almanac)
    }

    /// The day dated `date`, without rows.
    pub(super) fn day(&self, date: Date) -> Result<Day, TimeError> {
        let local = self.clock.day(&self.place, date)?;
        let sun = SunDay::between(&self.place, local.start, local.end, &self.options)?;
        Ok(Day { local, offsets: self.offsets(&local)?, sun, rows: Vec::new() })
    }

    /// The sun at `time`.
    pub(super) fn seen(&self, time: Timestamp) -> Result<Seen, TimeError> {
        Ok(Seen {
            time,
            utc_offset_s: self.clock.utc_offset_s(&self.place, time)?,
            sun: Sun::at(&self.place, time, &self.options)?,
        })
    }

    /// `+02:00`, `+01:00, from 03:00 +02:00`, or what a sundial has at its noon.
    fn offsets(&self, day: &LocalDay) -> Result<String, TimeError> {
        if self.clock.kind == ClockKind::Solar {
            let noon = day.start + day.duration() / 2;
            return Ok(offset_text(self.clock.utc_offset_s(&self.place, noon)?));
        }
        let zone = self.clock.zone.time_zone();
        let mut text = offset_text(self.clock.zone.offset_at(day.start).seconds());
        for change in zone.following(day.start).take_while(|change| change.timestamp() < day.end) {
            let after = change.offset();
            let shown = after.to_datetime(change.timestamp()).strftime("%H:%M").to_string();
            text.push_str(&format!(", from {shown} {}", offset_text(after.seconds())));
        }
        Ok(text)
    }

    /// How angles are meant, in words.
    pub(super) fn air(&self) -> &'static str {
        match self.options.refraction {
            Refraction::None => "the sun's middle where geometry has it, without refraction",
            _ => "the sun's middle as seen through a standard atmosphere (1013.25 hPa, 15 °C)",
        }
    }

    /// Which clock it is, in words.
    pub(super) fn clock_text(&self) -> String {
        let zone = &self.clock.zone;
        let source = if zone.is_derived() { "found from the place" } else { "as asked for" };
        match self.clock.kind {
            ClockKind::Civil => format!("clocks of {} ({source})", zone.name()),
            ClockKind::Solar => format!("true solar time, by the calendar of {} ({source})", zone.name()),
        }
    }

    /// `48.2000° N, 16.3700° E`.
    pub(super) fn place_text(&self) -> String {
        let (lat, lon) = (self.place.latitude_deg(), self.place.longitude_deg());
        let (north, east) = (if lat < 0.0 { 'S' } else { 'N' }, if lon < 0.0 { 'W' } else { 'E' });
        format!("{:.4}° {north}, {:.4}° {east}", lat.abs(), lon.abs())
    }
}

impl Seen {
    /// What the clock shows.
    pub(super) fn local(&self) -> DateTime {
        Offset::from_seconds(self.utc_offset_s).unwrap_or(Offset::UTC).to_datetime(self.time)
    }

    /// What the clock shows to the nearest second on the day `date`, whose end is its 24:00:00.
    pub(super) fn clock_text(&self, date: Date) -> String {
        self.rounded_text(date, SignedDuration::from_millis(500), "%H:%M:%S", "24:00:00")
    }

    /// The same to the nearest minute.
    pub(super) fn minutes_text(&self, date: Date) -> String {
        self.rounded_text(date, SignedDuration::from_secs(30), "%H:%M", "24:00")
    }

    fn rounded_text(&self, date: Date, half: SignedDuration, format: &str, end: &str) -> String {
        let shown = self.local().saturating_add(half);
        let is_end = shown.date() > date && shown.time().duration_since(Time::midnight()) < half * 2;
        if is_end { end.to_owned() } else { shown.strftime(format).to_string() }
    }
}

/// `+02:00`; of a sundial with seconds.
pub(super) fn offset_text(seconds: i32) -> String {
    let sign = if seconds < 0 { '-' } else { '+' };
    let shown = Time::midnight() + SignedDuration::from_secs(i64::from(seconds.abs()));
    format!("{sign}{}", shown.strftime(if seconds % 60 == 0 { "%H:%M" } else { "%H:%M:%S" }))
}
