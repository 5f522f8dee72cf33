//! A study's shares of the sun's disc in a file: for each receiver a row, with a byte for each step.
//!
//! A byte is the share in 255ths: 0 where nothing of the disc is seen and 255 where all is, and only there, so a share is off by 1/255 at most and by half of that
//! nearly always. Sums of hours are not made of these.

use umbrae_study::{DiscExposure, Packets};

use super::rows::{bit, rows_of};

/// All of the disc.
const WHOLE: u8 = u8::MAX;

/// A share, 0 to 1, as it is kept.
fn to_byte(share: f64) -> u8 {
    if share <= 0.0 {
        0
    } else if share >= 1.0 {
        WHOLE
    } else {
        (share * f64::from(WHOLE)).round().clamp(1.0, f64::from(WHOLE - 1)) as u8
    }
}

/// What is kept, as a share.
pub(crate) fn from_byte(byte: u8) -> f64 {
    f64::from(byte) / f64::from(WHOLE)
}

/// The rows of all receivers of `exposure`: receiver and row, by receiver.
pub(super) fn fractions_of(exposure: &DiscExposure, packets: &Packets) -> Vec<(usize, Vec<u8>)> {
    let of_receiver = |(receiver, bits): (usize, Vec<u8>)| {
        let steps = 0..exposure.whole.step_count;
        let mut row: Vec<u8> = steps.map(|step| if bit(&bits, step) { WHOLE } else { 0 }).collect();
        for partial in exposure.of_receiver(receiver) {
            row[partial.step as usize] = to_byte(partial.share);
        }
        (receiver, row)
    };
    rows_of(&exposure.whole, packets).into_iter().map(of_receiver).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_nothing_is_0_and_only_all_is_255() {
        assert_eq!([0.0, 1e-9, 0.001, 0.5, 0.999_999, 1.0].map(to_byte), [0, 1, 1, 128, 254, 255]);
        for i in 0..=10_000 {
            let share = f64::from(i) / 10_000.0;
            assert!((from_byte(to_byte(share)) - share).abs() <= 1.0 / 255.0, "{share}");
        }
    }
}
