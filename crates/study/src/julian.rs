//! Moments as the algorithms of the sun count them: days of universal time since 4713 BC, and how far the Earth's rotation lags.
//!
//! UTC is taken for UT1: they differ by less than 0.9 s, in which the sun moves by less than 0.004 degrees of hour angle.

use jiff::{SignedDuration, Timestamp};
use solar_positioning::delta_t;
use solar_positioning::time::JulianDate;

use crate::TimeError;

/// 1970-01-01T00:00Z.
const UNIX_EPOCH_DAYS: f64 = 2_440_587.5;
/// 2000-01-01T00:00Z.
const YEAR_2000_DAYS: f64 = 2_451_544.5;
const DAY_S: f64 = 86_400.0;
/// Of the Gregorian calendar, on average.
const YEAR_DAYS: f64 = 365.2425;

/// `time` in days; to some 40 microseconds, which is what is left of `f64` there.
pub(crate) fn days(time: Timestamp) -> f64 {
    UNIX_EPOCH_DAYS + time.as_second() as f64 / DAY_S + f64::from(time.subsec_nanosecond()) / (DAY_S * 1e9)
}

/// The moment that is `days`, `None` beyond the calendar.
pub(crate) fn moment(days: f64) -> Option<Timestamp> {
    let since_epoch = SignedDuration::try_from_secs_f64((days - UNIX_EPOCH_DAYS) * DAY_S).ok()?;
    Timestamp::from_duration(since_epoch).ok()
}

/// What terrestrial time is ahead of universal time at `time`, in seconds: `given`, or else an estimate.
pub(crate) fn lag_s(time: Timestamp, given: Option<f64>) -> Result<f64, TimeError> {
    let year = 2000.0 + (days(time) - YEAR_2000_DAYS) / YEAR_DAYS;
    given.map_or_else(|| delta_t::estimate(year).map_err(|_| TimeError::NoSun { time }), Ok)
}

/// `time` with its lag.
pub(crate) fn julian(time: Timestamp, given_lag_s: Option<f64>) -> Result<JulianDate, TimeError> {
    JulianDate::new(days(time), lag_s(time, given_lag_s)?).map_err(|_| TimeError::NoSun { time })
}
