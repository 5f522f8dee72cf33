//! What a receiver's bits add up to.

use jiff::Timestamp;
use umbrae_study::SunHours;

/// The sun of one receiver over the whole period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum {
    /// Seconds of sun.
    pub(crate) lit_s: f64,
    /// By how much that may be wrong, either way.
    pub(crate) error_s: f32,
    /// The longest sun without a break, in seconds.
    pub(crate) longest_s: f32,
    /// When the first sun arrives and the last is gone; `None` where there is none.
    pub(crate) first_last: Option<[Timestamp; 2]>,
    /// Steps at which it is as near to an edge of a shadow as can't be told.
    pub(crate) undecided: u32,
}

/// Bytes of a [`Sum`] in its file.
pub(crate) const SUM_BYTES: usize = 37;

/// The first byte of a receiver that was computed.
const PRESENT: u8 = 1;
/// That has sun.
const LIT: u8 = 2;

impl Sum {
    pub(crate) fn new(hours: &SunHours, undecided: u32) -> Self {
        let first_last = hours.intervals.first().zip(hours.intervals.last());
        Self {
            // No sun is 0, and not -0, which a sum of nothing is.
            lit_s: hours.total_s() + 0.0,
            error_s: hours.error_bound_s as f32,
            longest_s: hours.longest_s() as f32,
            first_last: first_last.map(|(first, last)| [first.start, last.end]),
            undecided,
        }
    }

    /// Hours of sun.
    pub(crate) fn hours(&self) -> f64 {
        self.lit_s / 3600.0
    }

    /// The longest sun without a break in hours, which rounding does not make longer than all.
    pub(crate) fn longest_hours(&self) -> f64 {
        (f64::from(self.longest_s) / 3600.0).min(self.hours())
    }

    /// As it is kept between runs.
    pub(crate) fn to_bytes(self) -> [u8; SUM_BYTES] {
        let [first, last] = self.first_last.map_or([0; 2], |both| both.map(Timestamp::as_millisecond));
        let mut bytes = [0; SUM_BYTES];
        bytes[0] = if self.first_last.is_some() { PRESENT | LIT } else { PRESENT };
        bytes[1..9].copy_from_slice(&self.lit_s.to_le_bytes());
        bytes[9..13].copy_from_slice(&self.error_s.to_le_bytes());
        bytes[13..17].copy_from_slice(&self.longest_s.to_le_bytes());
        bytes[17..25].copy_from_slice(&first.to_le_bytes());
        bytes[25..33].copy_from_slice(&last.to_le_bytes());
        bytes[33..37].copy_from_slice(&self.undecided.to_le_bytes());
        bytes
    }

    /// What [`Sum::to_bytes`] gave; `None` for zeros: a receiver that was not computed.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; SUM_BYTES] = bytes.try_into().ok()?;
        let word = |at: usize| std::array::from_fn(|i| bytes[at + i]);
        let long = |at: usize| std::array::from_fn(|i| bytes[at + i]);
        let time = |at: usize| Timestamp::from_millisecond(i64::from_le_bytes(long(at))).ok();
        (bytes[0] & PRESENT != 0).then(|| Self {
            lit_s: f64::from_le_bytes(long(1)),
            error_s: f32::from_le_bytes(word(9)),
            longest_s: f32::from_le_bytes(word(13)),
            first_last: if bytes[0] & LIT != 0 { time(17).zip(time(25)).map(<[_; 2]>::from) } else { None },
            undecided: u32::from_le_bytes(word(33)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_comes_back_as_it_was_and_zeros_are_none() {
        let times = [1_700_000_000_123, 1_700_000_900_000].map(|ms| Timestamp::from_millisecond(ms).expect("a time"));
        let sum = Sum { lit_s: 1234.5, error_s: 7.5, longest_s: 900.0, first_last: Some(times), undecided: 70_000 };
        let dark = Sum { lit_s: 0.0, error_s: 0.0, longest_s: 0.0, first_last: None, undecided: 0 };
        for sum in [sum, dark] {
            assert_eq!(Sum::from_bytes(&sum.to_bytes()), Some(sum));
        }
        assert_eq!(Sum::from_bytes(&[0; SUM_BYTES]), None);
    }
}
