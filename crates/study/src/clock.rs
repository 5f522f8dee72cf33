//! From what a clock shows to the moment, and back.
//!
//! A civil clock is set by the rules of a zone. A sundial shows true solar time: 12 when the sun crosses the meridian, and so on by its hour
//! angle, 15 degrees an hour. Its days go from midnight to midnight of the sun and are up to 30 seconds longer or shorter than 24 h; they
//! bear the date that the zone's calendar has at their noon, so that the date line is where people have it.

use jiff::civil::{Date, DateTime};
use jiff::tz::{AmbiguousOffset, Offset, TimeZone};
use jiff::{SignedDuration, Timestamp};
use solar_positioning::{Location, SolarPositions};

use crate::julian::julian;
use crate::local_time::DAY_S;
use crate::{LocalTime, Place, TimeError, Zone};

/// By what times of day are meant.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// On the wall or in the sun.
    pub kind: ClockKind,
    /// Of the clock on the wall; of a sundial, of the calendar that hangs there.
    pub zone: Zone,
}

/// The two kinds of clocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ClockKind {
    /// The law's time, with daylight saving where there is any.
    #[default]
    Civil,
    /// True solar time.
    Solar,
}

/// One date of one clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LocalDay {
    /// What the calendar shows.
    pub date: Date,
    /// Its first moment.
    pub start: Timestamp,
    /// The first moment of the next day. Between are mostly 24 hours, 23 or 25 where clocks are changed, and anything from 0.5 to 47
    /// in the history of zones.
    pub end: Timestamp,
}

impl LocalDay {
    /// How long it is.
    pub fn duration(&self) -> SignedDuration {
        self.end.duration_since(self.start)
    }
}

/// Corrections of the sundial's time until it is within microseconds: each leaves some 0.0004 of the error, which is 17 minutes at first.
const SOLAR_ITERATIONS: usize = 3;
/// Of the Earth's equator as seen from the sun at its mean distance.
const PARALLAX_ARCSEC: f64 = 8.794;

impl Clock {
    /// The clock on the wall.
    pub fn civil(zone: Zone) -> Self {
        Self { kind: ClockKind::Civil, zone }
    }

    /// The sundial, under the calendar of `zone`.
    pub fn solar(zone: Zone) -> Self {
        Self { kind: ClockKind::Solar, zone }
    }

    /// The day that the clock at `place` dates `date`.
    ///
    /// A day begins when the clock first shows its 00:00, or with its first moment where clocks skip that, and ends where the next begins:
    /// every moment belongs to exactly one day.
    ///
    /// # Errors
    ///
    /// [`TimeError::SkippedDay`] where the zone has left the date out, and [`TimeError::NoSun`] of a sundial too far from our time.
    pub fn day(&self, place: &Place, date: Date) -> Result<LocalDay, TimeError> {
        let civil = self.civil_day(date)?;
        match self.kind {
            ClockKind::Civil => Ok(civil),
            ClockKind::Solar => {
                let start = self.solar_moment(place, date, 0.0)?;
                Ok(LocalDay { date, start, end: self.solar_moment(place, date, f64::from(DAY_S))? })
            }
        }
    }

    /// When the clock at `place` shows `time` on `date`.
    ///
    /// Where it does so twice the first is meant, unless `time` says which by its offset. 00:00 and 24:00 are the ends of the day,
    /// whatever the clock shows there.
    ///
    /// # Errors
    ///
    /// As [`Clock::day`]; [`TimeError::Gap`] if it never does, and [`TimeError::OffsetNotInUse`] or [`TimeError::OffsetOfSolarTime`] where
    /// the time's own offset is not the clock's.
    pub fn moment(&self, place: &Place, date: Date, time: LocalTime) -> Result<Timestamp, TimeError> {
        let day = self.day(place, date)?;
        if self.kind == ClockKind::Solar {
            if time.offset().is_some() {
                return Err(TimeError::OffsetOfSolarTime { time });
            }
            return self.solar_moment(place, date, f64::from(time.seconds()));
        }
        if let Some(offset) = time.offset() {
            return self.moment_at_offset(date, time, offset);
        }
        match time {
            LocalTime::START_OF_DAY => Ok(day.start),
            LocalTime::END_OF_DAY => Ok(day.end),
            _ => self.civil_moment(date, time),
        }
    }

    /// What the clock at `place` is ahead of UTC at `time`, in seconds; a sundial to the nearest.
    ///
    /// # Errors
    ///
    /// [`TimeError::NoSun`] of a sundial too far from our time.
    pub fn utc_offset_s(&self, place: &Place, time: Timestamp) -> Result<i32, TimeError> {
        let zone_offset = self.zone.offset_at(time);
        match self.kind {
            ClockKind::Civil => Ok(zone_offset.seconds()),
            ClockKind::Solar => {
                let offset_s = mean_solar_offset_s(place, zone_offset) + equation_of_time_s(time)?;
                Ok(offset_s.round() as i32)
            }
        }
    }

    /// `duration` after `time`, by this clock's own running: a second of a sundial is longer or shorter by up to 0.0004 of it.
    ///
    /// # Errors
    ///
    /// [`TimeError::NoSun`] too far from our time.
    pub fn after(&self, time: Timestamp, duration: SignedDuration) -> Result<Timestamp, TimeError> {
        let no_sun = |_| TimeError::NoSun { time };
        let later = time.checked_add(duration).map_err(no_sun)?;
        if self.kind == ClockKind::Civil {
            return Ok(later);
        }
        let ahead_s = equation_of_time_s(time)?;
        let mut moment = later;
        for _ in 0..SOLAR_ITERATIONS {
            moment = shifted(later, ahead_s - equation_of_time_s(moment)?)?;
        }
        Ok(moment)
    }

    /// What there is to say of `time` on `date` where the clock shows it twice; `None` where it does not.
    pub fn fold_note(&self, date: Date, time: LocalTime) -> Option<String> {
        if self.kind == ClockKind::Solar || time.offset().is_some() || time.seconds().is_multiple_of(DAY_S) {
            return None;
        }
        let zone = self.zone.name();
        match self.zone.time_zone().to_ambiguous_timestamp(date_time(date, time)).offset() {
            AmbiguousOffset::Fold { before, after } => Some(format!(
                "{time} comes twice on {date} in {zone}; the first is meant: write {time}{} for the second, or {time}{} to say so",
                crate::zone::offset_text(after),
                crate::zone::offset_text(before),
            )),
            _ => None,
        }
    }

    fn civil_day(&self, date: Date) -> Result<LocalDay, TimeError> {
        let zone = self.zone.time_zone();
        let no_sun = |_| TimeError::NoSun { time: Timestamp::MAX };
        let start = first_moment(zone, date)?;
        let end = first_moment(zone, date.tomorrow().map_err(no_sun)?)?;
        if zone.to_datetime(start).date() == date {
            return Ok(LocalDay { date, start, end });
        }
        let before = start.checked_sub(SignedDuration::from_nanos(1)).map_err(no_sun)?;
        Err(TimeError::SkippedDay {
            date,
            zone: self.zone.name().to_owned(),
            before: zone.to_datetime(before).date(),
            after: zone.to_datetime(start).date(),
        })
    }

    fn civil_moment(&self, date: Date, time: LocalTime) -> Result<Timestamp, TimeError> {
        let zone = self.zone.time_zone();
        let ambiguous = zone.to_ambiguous_timestamp(date_time(date, time));
        if let AmbiguousOffset::Gap { before, after } = ambiguous.offset() {
            let change = change_of_clocks(zone, date_time(date, time), before)?;
            return Err(TimeError::Gap {
                time,
                date,
                zone: self.zone.name().to_owned(),
                before: before.to_datetime(change),
                before_offset: before,
                after: after.to_datetime(change),
                after_offset: after,
            });
        }
        ambiguous.earlier().map_err(|_| TimeError::NoSun { time: Timestamp::MAX })
    }

    fn moment_at_offset(&self, date: Date, time: LocalTime, given: Offset) -> Result<Timestamp, TimeError> {
        let moment = at_offset(date_time(date, time), given)?;
        let used = self.zone.offset_at(moment);
        // The last moment of a day may have the offset of either side.
        let used_before = self.zone.offset_at(moment.checked_sub(SignedDuration::from_nanos(1)).unwrap_or(moment));
        if used == given || used_before == given {
            return Ok(moment);
        }
        Err(TimeError::OffsetNotInUse { time, date, zone: self.zone.name().to_owned(), used, given })
    }

    /// When the sundial shows `seconds` on `date`.
    fn solar_moment(&self, place: &Place, date: Date, seconds: f64) -> Result<Timestamp, TimeError> {
        let day = self.civil_day(date)?;
        let noon = day.start + day.duration() / 2;
        let mean_offset_s = mean_solar_offset_s(place, self.zone.offset_at(noon));
        let shown = at_offset(date.to_datetime(jiff::civil::Time::midnight()), Offset::UTC)?;
        let mean = shifted(shown, seconds - mean_offset_s)?;
        let mut moment = mean;
        for _ in 0..SOLAR_ITERATIONS {
            moment = shifted(mean, -equation_of_time_s(moment)?)?;
        }
        Ok(moment)
    }
}

/// What sundials are ahead of clocks that keep mean solar time, at `time`, in seconds: -855 to 987.
///
/// # Errors
///
/// [`TimeError::NoSun`] too far from our time.
pub fn equation_of_time_s(time: Timestamp) -> Result<f64, TimeError> {
    let no_sun = |_| TimeError::NoSun { time };
    let moment = julian(time, None)?;
    let prepared = SolarPositions::new().for_time_from_julian(moment).map_err(no_sun)?;
    // From the equator, east and up tell the hour angle, but for the parallax of who stands there.
    let seen = prepared.at(Location { latitude: 0.0, longitude: 0.0 }, 0.0, None).map_err(no_sun)?;
    let (sin_zenith, cos_zenith) = seen.zenith_angle().to_radians().sin_cos();
    let east = sin_zenith * seen.azimuth().to_radians().sin();
    let distance_au = prepared.earth_radius_vector().unwrap_or(1.0);
    let up = cos_zenith + (PARALLAX_ARCSEC / 3600.0 / distance_au).to_radians().sin();
    let hour_angle_s = (-east).atan2(up).to_degrees() * 240.0;
    let day_s = f64::from(DAY_S);
    let shown_s = day_s / 2.0 + hour_angle_s;
    let mean_s = time.as_second().rem_euclid(i64::from(DAY_S)) as f64 + f64::from(time.subsec_nanosecond()) * 1e-9;
    Ok((shown_s - mean_s + day_s / 2.0).rem_euclid(day_s) - day_s / 2.0)
}

/// What mean solar time is ahead of UTC at `place`, on the side of the date line where clocks with `zone_offset` are.
fn mean_solar_offset_s(place: &Place, zone_offset: Offset) -> f64 {
    let by_longitude = place.mean_solar_offset_s();
    let day_s = f64::from(DAY_S);
    by_longitude + ((f64::from(zone_offset.seconds()) - by_longitude) / day_s).round() * day_s
}

/// When clocks first show 00:00 of `date`, or are put forward over it.
fn first_moment(zone: &TimeZone, date: Date) -> Result<Timestamp, TimeError> {
    let midnight = date.to_datetime(jiff::civil::Time::midnight());
    let ambiguous = zone.to_ambiguous_timestamp(midnight);
    match ambiguous.offset() {
        AmbiguousOffset::Gap { before, .. } => change_of_clocks(zone, midnight, before),
        _ => ambiguous.earlier().map_err(|_| TimeError::NoSun { time: Timestamp::MAX }),
    }
}

/// When the clocks were put forward that never showed `skipped`, and had the offset `before` until then.
fn change_of_clocks(zone: &TimeZone, skipped: DateTime, before: Offset) -> Result<Timestamp, TimeError> {
    let after = at_offset(skipped, before)?;
    // The moment itself may be the change, and what precedes it does not include it.
    let next = after.checked_add(SignedDuration::from_nanos(1)).unwrap_or(after);
    Ok(zone.preceding(next).next().map_or(after, |change| change.timestamp()))
}

fn date_time(date: Date, time: LocalTime) -> DateTime {
    let midnight = date.to_datetime(jiff::civil::Time::midnight());
    midnight.checked_add(SignedDuration::from_secs(i64::from(time.seconds()))).unwrap_or(DateTime::MAX)
}

fn at_offset(shown: DateTime, offset: Offset) -> Result<Timestamp, TimeError> {
    offset.to_timestamp(shown).map_err(|_| TimeError::NoSun { time: Timestamp::MAX })
}

fn shifted(time: Timestamp, seconds: f64) -> Result<Timestamp, TimeError> {
    let by = SignedDuration::try_from_secs_f64(seconds).map_err(|_| TimeError::NoSun { time })?;
    time.checked_add(by).map_err(|_| TimeError::NoSun { time })
}
