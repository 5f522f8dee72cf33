//! One bit for each receiver and step: in the sun or not.

use std::ops::Range;

/// Verdicts for some packets and every step of a timetable.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exposure {
    /// Which packets.
    pub packets: Range<usize>,
    /// How many steps.
    pub step_count: usize,
    /// Bit `lane` of word `(packet - packets.start) * step_count + step`: in the sun.
    pub lit: Vec<u64>,
    /// Verdicts that hold for the receiver as given, but not for some point within [`crate::Blockers::margin_m`] of it: receiver, step. In order.
    pub undecided: Vec<(u32, u32)>,
}

impl Exposure {
    /// Whether the receiver in `lane` of `packet` is in the sun at `step`.
    pub fn is_lit(&self, packet: usize, lane: usize, step: usize) -> bool {
        self.lit[(packet - self.packets.start) * self.step_count + step] >> lane & 1 == 1
    }
}
