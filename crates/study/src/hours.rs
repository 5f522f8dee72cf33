//! Bits into hours, and changes into moments.
//!
//! A step stands for its middle, so between two steps of which one is in the sun and one is not, the change is somewhere between the two
//! middles. [`SunHours::of_steps`] puts it where the steps meet, and says how wrong that may be; [`SunHours::refined`] looks for it.
//!
//! Where the sun is a disc, a step counts for as much as is seen of it in its middle: [`SunHours::of_shares`].
//!
//! What no bound covers: a gleam or a shade that begins and ends between two middles is not seen at all. Shorter steps find more of them.

use jiff::{SignedDuration, Timestamp};

use crate::Step;

/// A span of sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// When the sun arrives.
    pub start: Timestamp,
    /// When it is gone.
    pub end: Timestamp,
    /// What it is worth, in seconds of all of the sun: as long as it is, but where only part of the sun's disc is seen.
    pub sun_s: f64,
}

impl Interval {
    /// All of the sun from `start` to `end`.
    pub fn new(start: Timestamp, end: Timestamp) -> Self {
        let mut interval = Self { start, end, sun_s: 0.0 };
        interval.sun_s = interval.duration_s();
        interval
    }

    /// How long it is by the clock.
    pub fn duration_s(&self) -> f64 {
        self.end.duration_since(self.start).as_secs_f64()
    }
}

/// The sun of one receiver over some steps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SunHours {
    /// In order, apart from each other.
    pub intervals: Vec<Interval>,
    /// By how much [`SunHours::total_s`] may be wrong, either way, if no sun or shade shorter than a step was missed.
    pub error_bound_s: f64,
}

/// A change is looked for until it is known to half of this.
const RESOLUTION: SignedDuration = SignedDuration::from_millis(500);

impl SunHours {
    /// Sums `steps` for which `is_lit` says so, by index; neighbours join.
    ///
    /// Every change between two steps that follow each other without a gap adds half the longer one to the bound.
    pub fn of_steps(steps: &[Step], is_lit: impl Fn(usize) -> bool) -> Self {
        let mut hours = Self::default();
        for (i, step) in steps.iter().enumerate() {
            let is_lit_here = is_lit(i);
            if is_lit_here {
                hours.add(step.start, step.end);
            }
            if let Some(before) = previous(steps, i)
                && is_lit(i - 1) != is_lit_here
            {
                hours.error_bound_s += 0.5 * before.duration_s().max(step.duration_s());
            }
        }
        hours
    }

    /// Sums `steps` at which `share_at` says how much of the sun's disc is seen, 0 to 1, by index; neighbours at which some is seen join, and each step is worth as much of
    /// its length.
    ///
    /// Between two steps that follow each other without a gap the share is taken to be between theirs: that adds half of the longer one, times by how much the
    /// shares differ, to the bound. What changes within the first half of a run's first step, or the last of its last, is not in it: at sunrise that is what the disc
    /// takes to rise, some minutes, less than a step as a rule. For shares of 0 and 1 everything is as [`SunHours::of_steps`] has it.
    pub fn of_shares(steps: &[Step], share_at: impl Fn(usize) -> f64) -> Self {
        let mut hours = Self::default();
        let mut share_before = 0.0;
        for (i, step) in steps.iter().enumerate() {
            let share = share_at(i);
            if share > 0.0 {
                hours.add_worth(step.start, step.end, share * step.duration_s());
            }
            if let Some(before) = previous(steps, i) {
                hours.error_bound_s +=
                    0.5 * before.duration_s().max(step.duration_s()) * f64::abs(share - share_before);
            }
            share_before = share;
        }
        hours
    }

    /// As [`SunHours::of_steps`], with each change found to a quarter of a second by bisection: `is_lit_at` says whether the sun is there at a moment.
    ///
    /// The beginning and the end of the steps are asked as well, so that the halves of steps there are as certain as the rest. About ten
    /// questions for each change between steps of a quarter of an hour.
    pub fn refined(steps: &[Step], is_lit: impl Fn(usize) -> bool, is_lit_at: impl Fn(Timestamp) -> bool) -> Self {
        let mut hours = Self::default();
        // Where the present sun has begun, and the last moment that is known.
        let mut since: Option<Timestamp> = None;
        let mut known = (Timestamp::MIN, false);
        for (i, step) in steps.iter().enumerate() {
            if previous(steps, i).is_none() {
                known = (step.start, is_lit_at(step.start));
                since = known.1.then_some(step.start);
            }
            let is_last = steps.get(i + 1).is_none_or(|next| next.start != step.end);
            let moments = [Some((step.middle(), is_lit(i))), is_last.then(|| (step.end, is_lit_at(step.end)))];
            for (moment, is_lit_then) in moments.into_iter().flatten() {
                if is_lit_then != known.1 {
                    let change = hours.change_between(known.0, moment, known.1, &is_lit_at);
                    match since.take() {
                        Some(start) => hours.add(start, change),
                        None => since = Some(change),
                    }
                }
                known = (moment, is_lit_then);
            }
            if is_last && let Some(start) = since.take() {
                hours.add(start, step.end);
            }
        }
        hours
    }

    /// When what is `before` at `low` and not at `high` changes; adds what remains unknown to the bound.
    fn change_between(
        &mut self,
        mut low: Timestamp,
        mut high: Timestamp,
        before: bool,
        is_lit_at: impl Fn(Timestamp) -> bool,
    ) -> Timestamp {
        while high.duration_since(low) > RESOLUTION {
            let middle = low + high.duration_since(low) / 2;
            if is_lit_at(middle) == before {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.error_bound_s += 0.5 * high.duration_since(low).as_secs_f64();
        low + high.duration_since(low) / 2
    }

    fn add(&mut self, start: Timestamp, end: Timestamp) {
        match self.intervals.last_mut().filter(|last| last.end == start) {
            Some(last) => *last = Interval::new(last.start, end),
            None if start < end => self.intervals.push(Interval::new(start, end)),
            None => {}
        }
    }

    fn add_worth(&mut self, start: Timestamp, end: Timestamp, sun_s: f64) {
        match self.intervals.last_mut().filter(|last| last.end == start) {
            Some(last) => *last = Interval { end, sun_s: last.sun_s + sun_s, ..*last },
            None => self.intervals.push(Interval { start, end, sun_s }),
        }
    }

    /// All the sun, in seconds of all of its disc.
    pub fn total_s(&self) -> f64 {
        self.intervals.iter().map(|interval| interval.sun_s).sum()
    }

    /// The longest sun without a break, in seconds of all of its disc.
    pub fn longest_s(&self) -> f64 {
        self.intervals.iter().map(|interval| interval.sun_s).fold(0.0, f64::max)
    }
}

/// The step before step `i`, if there is no gap between them.
fn previous(steps: &[Step], i: usize) -> Option<&Step> {
    i.checked_sub(1).map(|before| &steps[before]).filter(|before| before.end == steps[i].start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Sun;

    /// Ten steps of a minute, with a gap of an hour after the fifth.
    fn steps() -> Vec<Step> {
        let start = |i: i64| Timestamp::UNIX_EPOCH + SignedDuration::from_mins(i + if i >= 5 { 60 } else { 0 });
        let sun = Sun { azimuth_rad: 0.0, altitude_rad: 1.0 };
        let step = |i| {
            let end = start(i) + SignedDuration::from_mins(1);
            Step { start: start(i), end, day: 0, utc_offset_s: 0, sun, is_day: true }
        };
        (0..10).map(step).collect()
    }

    fn at(seconds: f64) -> Timestamp {
        Timestamp::UNIX_EPOCH + SignedDuration::from_secs_f64(seconds)
    }

    #[test]
    fn neighbours_join_and_each_change_may_be_half_a_step_off() {
        let hours = SunHours::of_steps(&steps(), |i| [1, 2, 4, 5, 6].contains(&i));
        let spans: Vec<f64> = hours.intervals.iter().map(Interval::duration_s).collect();
        assert_eq!(spans, [120.0, 60.0, 120.0], "a gap parts steps that follow each other");
        assert_eq!(hours.error_bound_s, 4.0 * 30.0);
        assert_eq!([hours.total_s(), hours.longest_s()], [300.0, 120.0]);
    }

    #[test]
    fn shares_count_for_as_much_of_their_steps_and_whole_ones_as_bits_do() {
        let shares = [0.0, 0.25, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.125, 0.0];
        let hours = SunHours::of_shares(&steps(), |i| shares[i]);
        let worth: Vec<f64> = hours.intervals.iter().map(|interval| interval.sun_s).collect();
        assert_eq!(worth, [105.0, 120.0, 7.5]);
        assert_eq!(hours.intervals[0].duration_s(), 180.0);
        // 0.25, 0.75, 0.5, 0.5 before the gap, and after it 0, 1, 0.125, 0.125 of half a minute.
        assert_eq!(hours.error_bound_s, 30.0 * (2.0 + 1.25));
        assert_eq!([hours.total_s(), hours.longest_s()], [232.5, 120.0]);
        let is_lit = |i: usize| [1, 2, 4, 5, 6].contains(&i);
        let of_shares = SunHours::of_shares(&steps(), |i| f64::from(u8::from(is_lit(i))));
        assert_eq!(of_shares, SunHours::of_steps(&steps(), is_lit));
    }

    #[test]
    fn refined_changes_are_where_they_are() {
        let steps = steps();
        let truth = [[47.25, 171.5], [250.0, 300.0], [3900.0, 4000.125]];
        let is_lit_at = |t: Timestamp| truth.iter().any(|&[start, end]| at(start) <= t && t < at(end));
        let hours = SunHours::refined(&steps, |i| is_lit_at(steps[i].middle()), is_lit_at);
        assert_eq!(hours.intervals.len(), 3);
        for (interval, [start, end]) in hours.intervals.iter().zip(truth) {
            for (found, true_s) in [(interval.start, start), (interval.end, end)] {
                let off = found.duration_since(at(true_s)).as_secs_f64();
                assert!(off.abs() <= 0.25, "{off} s off");
            }
        }
        let sum: f64 = truth.iter().map(|[start, end]| end - start).sum();
        assert!((hours.total_s() - sum).abs() <= hours.error_bound_s && hours.error_bound_s <= 2.0);
    }

    #[test]
    fn sun_all_the_time_is_as_long_as_the_steps_and_certain() {
        for hours in [SunHours::of_steps(&steps(), |_| true), SunHours::refined(&steps(), |_| true, |_| true)] {
            assert_eq!([hours.total_s(), hours.error_bound_s], [600.0, 0.0]);
        }
    }
}
