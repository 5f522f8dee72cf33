//! Hours to the second: a timetable looked at every minute, and each change of sun to shadow looked for between two minutes.
//!
//! The engine decides the minutes, as it is fast for many; rays find the changes, as each receiver has its own. What begins and ends within one
//! minute is not seen.

use std::ops::Range;

use glam::{DVec3, Vec3};
use jiff::Timestamp;

use crate::{Blockers, Place, Step, SunHours, SunOptions, SunPath, TimeError, Timetable};

/// A timetable divided into minutes, and the sun at any moment of it.
#[derive(Debug, Clone)]
pub struct Refinement {
    timetable: Timetable,
    suns: Vec<Option<DVec3>>,
    /// The sun of each run of steps without a gap: its beginning, its end, its path.
    runs: Vec<(Timestamp, Timestamp, SunPath)>,
    options: SunOptions,
    north_rad: f64,
}

/// The longest step: a gleam or a shade that is shorter may be missed.
const LONGEST_S: f64 = 60.0;

impl Refinement {
    /// Divides the steps of `timetable` into equal parts of a minute at most; `north_rad` as for [`crate::Sun::direction`].
    ///
    /// Takes milliseconds for each day.
    ///
    /// # Errors
    ///
    /// As [`crate::Sun::at`].
    pub fn new(place: &Place, timetable: &Timetable, options: &SunOptions, north_rad: f64) -> Result<Self, TimeError> {
        let mut runs = Vec::new();
        let mut steps = Vec::new();
        for run in timetable.steps.chunk_by(|a, b| a.end == b.start) {
            let (start, end) = (run[0].start, run[run.len() - 1].end);
            let path = SunPath::new(place, start, end, options)?;
            for step in run {
                steps.extend(parts(step).map(|part| {
                    let sun = path.at(part.middle());
                    Step { sun, is_day: sun.counts(options), ..part }
                }));
            }
            runs.push((start, end, path));
        }
        let timetable = Timetable { days: timetable.days.clone(), steps };
        let suns = timetable.directions(north_rad);
        Ok(Self { timetable, suns, runs, options: *options, north_rad })
    }

    /// The minutes.
    pub fn timetable(&self) -> &Timetable {
        &self.timetable
    }

    /// For each minute the direction to the sun, scene space; `None` where it does not count.
    pub fn suns(&self) -> &[Option<DVec3>] {
        &self.suns
    }

    /// The direction to the sun at `time`; `None` where it does not count, or outside the timetable.
    pub fn sun_at(&self, time: Timestamp) -> Option<DVec3> {
        let run = self.runs.partition_point(|(start, ..)| *start <= time).checked_sub(1)?;
        let (_, end, path) = &self.runs[run];
        let sun = (time <= *end).then(|| path.at(time))?;
        sun.counts(&self.options).then(|| sun.direction(self.north_rad))
    }

    /// The sun of a receiver during the minutes of `steps`, for which `is_lit` says what the engine has found, by index.
    ///
    /// # Panics
    ///
    /// If there are not so many minutes.
    pub fn hours(
        &self,
        blockers: &Blockers,
        (position, normal): (DVec3, Vec3),
        steps: Range<usize>,
        is_lit: impl Fn(usize) -> bool,
    ) -> SunHours {
        let first = steps.start;
        SunHours::refined(
            &self.timetable.steps[steps],
            |i| is_lit(first + i),
            |time| self.sun_at(time).is_some_and(|to_sun| blockers.sees(position, normal, to_sun)),
        )
    }
}

/// Equal parts of `step`, with its sun.
fn parts(step: &Step) -> impl Iterator<Item = Step> + '_ {
    let count = (step.duration_s() / LONGEST_S).ceil().max(1.0) as i32;
    let length = step.end.duration_since(step.start);
    let at = move |i: i32| if i == count { step.end } else { step.start + (length / count) * i };
    (0..count).map(move |i| Step { start: at(i), end: at(i + 1), ..*step })
}

#[cfg(test)]
mod tests {
    use jiff::SignedDuration;

    use super::*;
    use crate::{Clock, Edge, Period, Zone, parse_dates};

    fn refinement(from: &str, to: &str, step_s: i64) -> (Timetable, Refinement) {
        let place = Place::from_degrees(48.2, 16.37).expect("a place");
        let period = Period {
            clock: Clock::civil(Zone::named("Europe/Vienna").expect("a zone")),
            dates: parse_dates("2026-03-20..2026-03-21").expect("dates"),
            from: Edge::parse_from(from).expect("a time"),
            to: Edge::parse_to(to).expect("a time"),
            step: SignedDuration::from_secs(step_s),
        };
        let options = SunOptions::default();
        let timetable = Timetable::new(&place, &period, &options).expect("a timetable");
        let refinement = Refinement::new(&place, &timetable, &options, 0.3).expect("the sun is known");
        (timetable, refinement)
    }

    #[test]
    fn minutes_fill_the_steps_and_have_their_own_suns() {
        let (timetable, refinement) = refinement("09:00", "10:10", 1000);
        let fine = &refinement.timetable().steps;
        assert!(fine.iter().all(|step| step.duration_s() <= 60.0));
        let total = |steps: &[Step]| steps.iter().map(Step::duration_s).sum::<f64>();
        assert!((total(fine) - total(&timetable.steps)).abs() < 1e-6);
        assert_eq!(refinement.timetable().steps_of_day(1).len(), fine.len() / 2);
        for (step, sun) in fine.iter().zip(refinement.suns()) {
            let there = refinement.sun_at(step.middle()).expect("it is day");
            assert!(there.distance(sun.expect("it is day")) < 1e-9);
        }
    }

    #[test]
    fn there_is_no_sun_at_night_nor_outside_the_timetable() {
        let (timetable, refinement) = refinement("00:00", "24:00", 900);
        assert_eq!(refinement.sun_at(timetable.steps[0].start), None, "midnight");
        let (timetable, refinement) = self::refinement("09:00", "10:00", 900);
        let end = timetable.steps[timetable.steps.len() - 1].end;
        assert_eq!(refinement.sun_at(end + SignedDuration::from_secs(1)), None);
        assert_eq!(refinement.sun_at(timetable.steps[0].start - SignedDuration::from_secs(1)), None);
        assert!(refinement.sun_at(end).is_some());
        let nights = timetable.steps[0].end + SignedDuration::from_hours(12);
        assert_eq!(refinement.sun_at(nights), None, "between two days");
    }
}
