//! Values between the keys of an animation, as glTF 2.0 says in its appendix C.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::node::rotation_of;

/// How values go from key to key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Interpolation {
    /// A key's value holds until the next key.
    Step,
    /// Straight; rotations turn evenly, the shorter way.
    Linear,
    /// Each key has the slope at which values arrive, the value, and the slope at which they leave.
    CubicSpline,
}

impl Interpolation {
    /// By the name in the file.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "STEP" => Self::Step,
            "LINEAR" => Self::Linear,
            "CUBICSPLINE" => Self::CubicSpline,
            _ => return None,
        })
    }

    /// Elements of the output for each key.
    fn elements_per_key(self) -> usize {
        if self == Self::CubicSpline { 3 } else { 1 }
    }
}

/// Checked keys: there is at least one, times are finite and never decrease, values are finite.
#[derive(Debug, Clone)]
pub(super) struct Track {
    times_s: Arc<[f64]>,
    /// For each key `width` numbers, or three times as many.
    values: Arc<[f64]>,
    width: usize,
    interpolation: Interpolation,
}

/// Where a value of a key begins in [`Track::values`], and how much of it is in the result.
type Term = (usize, f64);

impl Track {
    /// A track of values of `width` numbers each; the times were checked by [`check_times`].
    ///
    /// What is wrong is said in words that fit after "its sampler 3: ".
    pub(super) fn new(
        times_s: Arc<[f64]>,
        values: Arc<[f64]>,
        width: usize,
        interpolation: Interpolation,
    ) -> Result<Self, String> {
        let per_key = width * interpolation.elements_per_key();
        let expected = times_s.len().checked_mul(per_key);
        if expected != Some(values.len()) {
            let (keys, numbers) = (times_s.len(), values.len());
            return Err(format!("its {keys} keys need {per_key} numbers each, but its output has {numbers}"));
        }
        if let Some(bad) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!("number {bad} of its output is {}", values[bad]));
        }
        Ok(Self { times_s, values, width, interpolation })
    }

    /// Refuses keys that are no rotations.
    pub(super) fn check_rotations(&self) -> Result<(), String> {
        match (0..self.times_s.len()).find(|&key| self.rotation_of_key(key).is_none()) {
            Some(key) => Err(format!("the rotation of its key {key} is (0, 0, 0, 0)")),
            None => Ok(()),
        }
    }

    /// The time of the last key, in seconds.
    pub(super) fn end_s(&self) -> f64 {
        self.times_s.last().copied().unwrap_or(0.0)
    }

    /// The numbers of the value at `time_s`; before the first key its value, after the last that one's.
    pub(super) fn numbers(&self, time_s: f64) -> impl Iterator<Item = f64> + '_ {
        let terms = self.terms(time_s);
        (0..self.width).map(move |i| terms.into_iter().map(|(start, part)| part * self.values[start + i]).sum())
    }

    /// The value at `time_s` of a track of three numbers.
    pub(super) fn vector(&self, time_s: f64) -> DVec3 {
        DVec3::from_array(self.array(time_s))
    }

    fn array<const N: usize>(&self, time_s: f64) -> [f64; N] {
        let terms = self.terms(time_s);
        std::array::from_fn(|i| terms.into_iter().map(|(start, part)| part * self.values[start + i]).sum())
    }

    /// The value at `time_s` of a track of rotations, x, y, z, w.
    pub(super) fn rotation(&self, time_s: f64) -> DQuat {
        let (key, part) = self.segment(time_s);
        let from = self.rotation_of_key(key).unwrap_or_default();
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear if part == 0.0 => from,
            Interpolation::Linear => from.slerp(self.rotation_of_key(key + 1).unwrap_or_default(), part),
            // A curve through 0 has no rotation there.
            Interpolation::CubicSpline => rotation_of(self.array(time_s)).unwrap_or(from),
        }
    }

    fn rotation_of_key(&self, key: usize) -> Option<DQuat> {
        self.values[self.start_of(key)..].first_chunk().and_then(|numbers| rotation_of(*numbers))
    }

    /// Where the value of a key begins.
    fn start_of(&self, key: usize) -> usize {
        match self.interpolation {
            Interpolation::CubicSpline => (3 * key + 1) * self.width,
            Interpolation::Step | Interpolation::Linear => key * self.width,
        }
    }

    /// The key before `time_s`, and how much of the way to the next has gone: 0 to 1, and 0 where there is no next.
    fn segment(&self, time_s: f64) -> (usize, f64) {
        let after = self.times_s.partition_point(|&key_s| key_s <= time_s);
        if after == 0 || after == self.times_s.len() {
            return (after.saturating_sub(1), 0.0);
        }
        let (from_s, to_s) = (self.times_s[after - 1], self.times_s[after]);
        (after - 1, (time_s - from_s) / (to_s - from_s))
    }

    fn terms(&self, time_s: f64) -> [Term; 4] {
        const NONE: Term = (0, 0.0);
        let (key, part) = self.segment(time_s);
        let start = self.start_of(key);
        if part == 0.0 || self.interpolation == Interpolation::Step {
            return [(start, 1.0), NONE, NONE, NONE];
        }
        let next = self.start_of(key + 1);
        if self.interpolation == Interpolation::Linear {
            return [(start, 1.0 - part), (next, part), NONE, NONE];
        }
        let duration_s = self.times_s[key + 1] - self.times_s[key];
        let (square, cube) = (part * part, part * part * part);
        [
            (start, 2.0 * cube - 3.0 * square + 1.0),
            (start + self.width, duration_s * (cube - 2.0 * square + part)),
            (next, -2.0 * cube + 3.0 * square),
            (next - self.width, duration_s * (cube - square)),
        ]
    }
}

/// Refuses times that are not in order.
pub(super) fn check_times(times_s: &[f64]) -> Result<(), String> {
    if times_s.is_empty() {
        return Err("it has no keys".to_owned());
    }
    if let Some(bad) = times_s.iter().position(|time_s| !time_s.is_finite()) {
        return Err(format!("the time of its key {bad} is {}", times_s[bad]));
    }
    match times_s.array_windows().position(|[a, b]| a > b) {
        Some(key) => {
            Err(format!("its key {} is at {} s, before key {key} at {} s", key + 1, times_s[key + 1], times_s[key]))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(times_s: &[f64], values: &[f64], width: usize, interpolation: Interpolation) -> Track {
        check_times(times_s).expect("good times");
        Track::new(times_s.into(), values.into(), width, interpolation).expect("a good track")
    }

    fn first(track: &Track, time_s: f64) -> f64 {
        track.numbers(time_s).next().expect("it has a number")
    }

    #[test]
    fn a_step_holds_until_the_next_key_and_ends_hold_for_ever() {
        let track = track(&[1.0, 2.0, 4.0], &[10.0, 20.0, 40.0], 1, Interpolation::Step);
        let at = |time_s| first(&track, time_s);
        assert_eq!([-9.0, 1.0, 1.999, 2.0, 3.9, 4.0, 99.0].map(at), [10.0, 10.0, 10.0, 20.0, 20.0, 40.0, 40.0]);
        assert_eq!(track.end_s(), 4.0);
    }

    #[test]
    fn a_line_goes_straight_between_its_keys() {
        let track = track(&[1.0, 2.0, 4.0], &[0.0, 1.0, 8.0, 3.0, 10.0, 1.0], 2, Interpolation::Linear);
        assert_eq!(track.numbers(1.25).collect::<Vec<_>>(), [2.0, 1.5]);
        assert_eq!(track.numbers(3.0).collect::<Vec<_>>(), [9.0, 2.0]);
        assert_eq!(track.numbers(0.0).collect::<Vec<_>>(), [0.0, 1.0]);
    }

    #[test]
    fn two_keys_at_one_time_are_a_jump() {
        let track = track(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0], 1, Interpolation::Linear);
        assert_eq!([0.5, 1.0, 1.5].map(|time_s| first(&track, time_s)), [0.5, 5.0, 5.5]);
    }

    /// Any cubic polynomial is its own spline: its values and slopes at two keys give all of it.
    #[test]
    fn a_cubic_spline_through_a_cubic_polynomial_is_that_polynomial() {
        let value = |t: f64| 2.0 * t * t * t - 3.0 * t * t + 5.0 * t - 7.0;
        let slope = |t: f64| 6.0 * t * t - 6.0 * t + 5.0;
        let times = [0.5, 2.0, 5.0];
        let keys: Vec<f64> = times.iter().flat_map(|&t| [slope(t), value(t), slope(t)]).collect();
        let track = track(&times, &keys, 1, Interpolation::CubicSpline);
        for time_s in [0.5, 0.75, 1.3, 2.0, 2.7, 4.999, 5.0] {
            let difference = first(&track, time_s) - value(time_s);
            assert!(difference.abs() < 1e-10, "{time_s}: {difference}");
        }
    }

    #[test]
    fn slopes_of_a_spline_are_for_a_second_and_not_for_a_segment() {
        // From 0 to 0 over 4 s, leaving at 1 a second and arriving level: 4 (u^3 - 2 u^2 + u), at u = 1/2.
        let track = track(&[0.0, 4.0], &[9.0, 0.0, 1.0, 0.0, 0.0, 9.0], 1, Interpolation::CubicSpline);
        assert_eq!(first(&track, 2.0), 0.5);
    }

    #[test]
    fn rotations_turn_evenly_the_shorter_way() {
        let about_z = |degrees: f64| DQuat::from_rotation_z(degrees.to_radians());
        let second = -about_z(90.0);
        let keys = [about_z(0.0).to_array(), second.to_array()].concat();
        let track = track(&[0.0, 3.0], &keys, 4, Interpolation::Linear);
        track.check_rotations().expect("good rotations");
        for (time_s, degrees) in [(0.0, 0.0), (1.0, 30.0), (1.5, 45.0), (2.0, 60.0), (3.0, 90.0)] {
            let turned = track.rotation(time_s) * DVec3::X;
            assert!(turned.distance(about_z(degrees) * DVec3::X) < 1e-12, "{time_s}: {turned}");
        }
    }

    #[test]
    fn a_spline_of_rotations_stays_a_rotation() {
        let zero = [0.0; 4];
        let (from, to) = (DQuat::IDENTITY.to_array(), DQuat::from_rotation_x(1.0).to_array());
        let keys = [zero, from, zero, zero, to, zero].concat();
        let track = track(&[0.0, 1.0], &keys, 4, Interpolation::CubicSpline);
        let half = track.rotation(0.5);
        assert!((half.length() - 1.0).abs() < 1e-15);
        assert!(half.angle_between(DQuat::from_rotation_x(0.5)) < 1e-7, "halfway by symmetry: {half}");
        let through_nothing = [zero, from, zero, zero, (-DQuat::IDENTITY).to_array(), zero].concat();
        let track = Track::new([0.0, 1.0].into(), through_nothing.into(), 4, Interpolation::CubicSpline);
        assert_eq!(track.expect("a good track").rotation(0.5), DQuat::IDENTITY, "0 is no rotation");
    }

    #[test]
    fn keys_that_can_not_be_used_are_told() {
        assert_eq!(check_times(&[]), Err("it has no keys".to_owned()));
        assert_eq!(check_times(&[0.0, f64::NAN]), Err("the time of its key 1 is NaN".to_owned()));
        assert_eq!(check_times(&[0.0, 2.0, 1.0]), Err("its key 2 is at 1 s, before key 1 at 2 s".to_owned()));
        let of = |values: &[f64]| Track::new([0.0, 1.0].into(), values.into(), 1, Interpolation::CubicSpline);
        assert_eq!(of(&[0.0; 5]).err().as_deref(), Some("its 2 keys need 3 numbers each, but its output has 5"));
        assert_eq!(of(&[0.0, 1.0, 0.0, 0.0, f64::NAN, 0.0]).err().as_deref(), Some("number 4 of its output is NaN"));
        let none = Track::new([0.0].into(), [0.0; 4].into(), 4, Interpolation::Step).expect("good numbers");
        assert!(none.check_rotations().is_err());
    }
}
