//! A number for each receiver and step: how much of the sun's disc is seen.

use crate::Exposure;

/// What is seen of the sun's disc by the receivers of some packets at every step of a timetable.
///
/// Nearly all see all of it or nothing, so only those that see part have a number of their own.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DiscExposure {
    /// A bit where all of the disc is seen. Nothing is undecided: what is near to an edge has a share.
    pub whole: Exposure,
    /// Where part of it is seen: by receiver, then step. Where neither this nor a bit says so, nothing is.
    pub partial: Vec<PartialSun>,
}

/// What a receiver sees at a step, if that is neither nothing nor all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartialSun {
    /// Index of the receiver.
    pub receiver: u32,
    /// Index of the step.
    pub step: u32,
    /// Between 0 and 1, of the disc's area.
    pub share: f64,
}

impl DiscExposure {
    /// The partial suns of a receiver, by step.
    pub fn of_receiver(&self, receiver: usize) -> &[PartialSun] {
        let start = self.partial.partition_point(|partial| (partial.receiver as usize) < receiver);
        let of_others = |partial: &PartialSun| partial.receiver as usize <= receiver;
        let end = start + self.partial[start..].partition_point(of_others);
        &self.partial[start..end]
    }

    /// The share of the disc that is seen at `step` by a receiver of which `partial` are the partial suns, and which sees all of it if `is_whole`.
    pub fn share(partial: &[PartialSun], step: usize, is_whole: bool) -> f64 {
        if is_whole {
            return 1.0;
        }
        partial.binary_search_by_key(&step, |partial| partial.step as usize).map_or(0.0, |i| partial[i].share)
    }
}
