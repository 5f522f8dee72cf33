//! When the sun rises, sets, crosses the meridian, and passes an altitude.

use jiff::civil::Date;
use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp};
use solar_positioning::{ElevationTarget, Horizon, HorizonState, SolarEvents, SolarPositions};

use crate::julian::{days, julian, lag_s, moment};
use crate::{Place, Sun, SunOptions, TimeError};

/// Of the sun's middle when its upper edge is on a level horizon at sea level: half a degree of refraction and a quarter of radius, without refraction.
///
/// What almanacs call sunrise and sunset.
pub const HORIZON_DEG: f64 = -50.0 / 60.0;

/// What the sun does in a span of time.
#[derive(Debug, Clone, PartialEq)]
pub struct SunDay {
    /// When it rises: mostly once. A day by the clock of a zone may have none or two of it, near a polar circle.
    pub rises: Vec<Timestamp>,
    /// When it crosses the meridian, north or south of the zenith.
    pub transits: Vec<Timestamp>,
    /// When it sets.
    pub sets: Vec<Timestamp>,
    /// The span.
    start: Timestamp,
    end: Timestamp,
    is_up_at_start: bool,
}

/// Whether the sun rises and sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DayKind {
    /// It does at least one of them.
    RisesOrSets,
    /// It is up all the time.
    PolarDay,
    /// It is down all the time.
    PolarNight,
}

impl SunDay {
    /// What the sun does between `start` and `end`, by the almanac's horizon ([`HORIZON_DEG`]); an event at `end` is the next day's.
    ///
    /// Times are right to a millisecond by the algorithm; what is seen differs by a minute and more with the air and the hills.
    ///
    /// # Errors
    ///
    /// [`TimeError::NoSun`] outside the years -500 to 3000.
    pub fn between(place: &Place, start: Timestamp, end: Timestamp, options: &SunOptions) -> Result<Self, TimeError> {
        Self::over_horizon(place, start, end, HORIZON_DEG, options)
    }

    /// The same for another altitude of the sun's middle without refraction, such as -6 degrees for civil twilight.
    ///
    /// # Errors
    ///
    /// As [`SunDay::between`].
    pub fn over_horizon(
        place: &Place,
        start: Timestamp,
        end: Timestamp,
        horizon_deg: f64,
        options: &SunOptions,
    ) -> Result<Self, TimeError> {
        let no_sun = |_| TimeError::NoSun { time: start };
        let lag_s = lag_s(start, options.delta_t_s)?;
        let events = SolarEvents::new()
            .for_interval_from_julian(days(start), days(end), place.location(), lag_s, Horizon::Custom(horizon_deg))
            .map_err(no_sun)?;
        let moments = |found: &[f64]| found.iter().filter_map(|&found| moment(found)).collect();
        Ok(Self {
            rises: moments(&events.rises),
            transits: moments(&events.transits),
            sets: moments(&events.sets),
            start,
            end,
            is_up_at_start: match events.state_at_start {
                HorizonState::Above => true,
                HorizonState::Below => false,
                // On it, and what it does next tells where it comes from.
                HorizonState::OnHorizon => events.sets.first() < events.rises.first(),
            },
        })
    }

    /// Whether it rises and sets at all.
    pub fn kind(&self) -> DayKind {
        match (self.rises.is_empty() && self.sets.is_empty(), self.is_up_at_start) {
            (false, _) => DayKind::RisesOrSets,
            (true, true) => DayKind::PolarDay,
            (true, false) => DayKind::PolarNight,
        }
    }

    /// The spans in which the sun is up, in order: from its rise, or the span's start, to its set, or the span's end.
    pub fn up(&self) -> Vec<[Timestamp; 2]> {
        spans(self.start, self.end, self.is_up_at_start, &self.rises, &self.sets)
    }

    /// How long the sun is up, in seconds.
    pub fn day_length_s(&self) -> f64 {
        self.up().iter().map(|[from, to]| to.duration_since(*from).as_secs_f64()).sum()
    }
}

/// The spans between `start` and `end` in which the sun counts by `options`: in which it stands at least at their least altitude, as seen
/// through their air.
///
/// A step of a timetable counts whole or not at all, by its middle; these spans are exact, to the millisecond, and what a refined study cuts
/// its first and last step with.
///
/// # Errors
///
/// As [`Sun::at`].
pub fn spans_of_sun(
    place: &Place,
    start: Timestamp,
    end: Timestamp,
    options: &SunOptions,
) -> Result<Vec<[Timestamp; 2]>, TimeError> {
    let no_sun = |_| TimeError::NoSun { time: start };
    let target = ElevationTarget {
        angle: options.min_altitude_rad.to_degrees(),
        height: place.elevation_m(),
        refraction: options.refraction.correction()?,
    };
    let (positions, lag_s) = (SolarPositions::new(), lag_s(start, options.delta_t_s)?);
    let crossings = |is_rise: bool| {
        let mut found = Vec::new();
        let mut from = days(start);
        loop {
            let next = if is_rise {
                positions.next_elevation_rise_from_julian(from, days(end), place.location(), lag_s, target)
            } else {
                positions.next_elevation_set_from_julian(from, days(end), place.location(), lag_s, target)
            };
            let Some(next) = next.map_err(no_sun)? else { return Ok(found) };
            found.extend(moment(next).filter(|&next| start < next && next < end));
            from = next;
        }
    };
    let is_up_at_start = Sun::at(place, start, options)?.counts(options);
    Ok(spans(start, end, is_up_at_start, &crossings(true)?, &crossings(false)?))
}

/// Up from each rise to the next set.
fn spans(
    start: Timestamp,
    end: Timestamp,
    is_up_at_start: bool,
    rises: &[Timestamp],
    sets: &[Timestamp],
) -> Vec<[Timestamp; 2]> {
    let mut spans = Vec::new();
    let mut up_since = is_up_at_start.then_some(start);
    let rises = rises.iter().map(|&time| (time, true));
    let mut changes: Vec<(Timestamp, bool)> = rises.chain(sets.iter().map(|&time| (time, false))).collect();
    changes.sort_unstable();
    for (time, is_rise) in changes {
        if is_rise {
            up_since.get_or_insert(time);
        } else if let Some(from) = up_since.take() {
            spans.push([from, time]);
        }
    }
    spans.extend(up_since.map(|from| [from, end]));
    spans.retain(|[from, to]| from < to);
    spans
}

/// The March equinox, the June solstice, the September equinox and the December solstice of `year`, to the second by the algorithm.
///
/// # Errors
///
/// [`TimeError::NoSun`] outside the years -500 to 3000.
pub fn equinoxes_and_solstices(year: i16) -> Result<[Timestamp; 4], TimeError> {
    let mut moments = [Timestamp::UNIX_EPOCH; 4];
    for (quarter, found) in moments.iter_mut().enumerate() {
        // They wander by some weeks in a thousand years; three weeks to either side the sun is still on the same side of its quarter's
        // right ascension.
        let about = Date::new(year, 3 * quarter as i8 + 3, 21)
            .and_then(|date| date.to_zoned(TimeZone::UTC))
            .map_err(|_| TimeError::NoSun { time: Timestamp::MIN })?
            .timestamp();
        let [mut before, mut after] = [-504, 504].map(|hours| about + SignedDuration::from_hours(hours));
        while after.duration_since(before) > SignedDuration::from_secs(1) {
            let middle = before + after.duration_since(before) / 2;
            let past_deg = right_ascension_deg(middle)? - 90.0 * quarter as f64;
            let is_past = (past_deg + 180.0).rem_euclid(360.0) >= 180.0;
            (before, after) = if is_past { (before, middle) } else { (middle, after) };
        }
        *found = after;
    }
    Ok(moments)
}

fn right_ascension_deg(time: Timestamp) -> Result<f64, TimeError> {
    let prepared = SolarPositions::new().for_time_from_julian(julian(time, None)?);
    prepared.map(|prepared| prepared.right_ascension()).map_err(|_| TimeError::NoSun { time })
}
