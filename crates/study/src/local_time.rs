//! Times of day, as a clock shows them and as people write them.

use std::fmt;
use std::str::FromStr;

use jiff::tz::Offset;

use crate::TimeError;
use crate::zone::{offset_text, parse_offset, two_digits};

/// The seconds of a day on which no clock is touched.
pub(crate) const DAY_S: u32 = 86_400;

/// A time of day, 00:00 to 24:00, of any day.
///
/// ```
/// use umbrae_study::LocalTime;
///
/// assert_eq!("9:30".parse::<LocalTime>()?.to_string(), "09:30");
/// assert_eq!("24:00".parse::<LocalTime>()?.seconds(), 86_400);
/// assert!("24:01".parse::<LocalTime>().is_err());
/// # Ok::<(), umbrae_study::TimeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LocalTime {
    seconds: u32,
    offset: Option<Offset>,
}

impl LocalTime {
    /// When a day begins. On a day whose clock skips midnight this is its first moment all the same.
    pub const START_OF_DAY: Self = Self { seconds: 0, offset: None };
    /// When the next day begins.
    pub const END_OF_DAY: Self = Self { seconds: DAY_S, offset: None };

    /// What the clock shows, in seconds from 00:00; 86400 is 24:00.
    pub fn seconds(&self) -> u32 {
        self.seconds
    }

    /// The offset from UTC that was written with it, which tells two times apart where clocks are put back.
    pub fn offset(&self) -> Option<Offset> {
        self.offset
    }
}

impl FromStr for LocalTime {
    type Err = TimeError;

    /// `9:30`, `09:30:15`, `24:00`, `02:30+02:00`.
    fn from_str(text: &str) -> Result<Self, TimeError> {
        let wrong = || TimeError::LocalTime { text: text.to_owned() };
        let trimmed = text.trim();
        let (clock, offset) = match trimmed.find(['+', '-', '\u{2212}', 'Z', 'z']) {
            Some(at) => (&trimmed[..at], Some(parse_offset(&trimmed[at..]).ok_or_else(wrong)?)),
            None => (trimmed, None),
        };
        let parts: Option<Vec<i32>> = clock.split(':').map(two_digits).collect();
        let [hours, minutes, seconds] = match parts.ok_or_else(wrong)?.as_slice() {
            [hours, minutes] => [*hours, *minutes, 0],
            [hours, minutes, seconds] => [*hours, *minutes, *seconds],
            _ => return Err(wrong()),
        };
        let total = (hours * 3600 + minutes * 60 + seconds) as u32;
        let is_time = minutes < 60 && seconds < 60 && total <= DAY_S;
        if is_time { Ok(Self { seconds: total, offset }) } else { Err(wrong()) }
    }
}

impl fmt::Display for LocalTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02}:{:02}", self.seconds / 3600, self.seconds / 60 % 60)?;
        if !self.seconds.is_multiple_of(60) {
            write!(f, ":{:02}", self.seconds % 60)?;
        }
        self.offset.map_or(Ok(()), |offset| f.write_str(&offset_text(offset)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_they_are_written() {
        for text in ["00:00", "09:30", "23:59:59", "24:00", "02:30+02:00", "02:30-09:30"] {
            assert_eq!(text.parse::<LocalTime>().expect(text).to_string(), text);
        }
    }

    #[test]
    fn what_no_clock_shows_is_no_time() {
        for bad in
            ["", "9", "25:00", "24:00:01", "12:60", "12:00:60", "-1:00", "12:00+", "12h", "noon", "012:00", "é:00"]
        {
            let error = bad.parse::<LocalTime>().expect_err(bad).to_string();
            assert!(error.starts_with(&format!("`{bad}` is no time of day")), "{error}");
        }
    }
}
