//! A rule and evidence into a verdict.
//!
//! Everything is worked out three times side by side: with the hours as short as their error bounds allow, as computed, and as long. More sun never makes
//! a rule's outcome worse, so the first and the last bound all that may be; where a ratio to the state before is asked for, the hours before are taken long where
//! those now are short.

use super::evidence::{Bounded, CountedSun, Evidence, GroupEvidence};
use super::fields::{Need, SHARE_ROUNDING};
use super::rule::Rule;
use super::verdict::{Day, DayNumbers, GroupVerdict, Outcome, Verdict};

/// Something that is or is not: with the shortest hours, as computed, with the longest.
type Told = [bool; 3];

/// How many of the groups, or how much of one, is so in each of the three.
fn bounded(told: Told, weight: f64) -> Bounded {
    let [least, value, most] = told.map(|is| if is { weight } else { 0.0 });
    Bounded { least, value, most }
}

fn tell(number: Bounded, is: impl Fn(f64) -> bool) -> Told {
    [number.least, number.value, number.most].map(is)
}

fn both([a, b, c]: Told, [d, e, f]: Told) -> Told {
    [a && d, b && e, c && f]
}

fn either([a, b, c]: Told, [d, e, f]: Told) -> Told {
    [a || d, b || e, c || f]
}

impl Rule {
    /// Whether `evidence` meets the rule, and the numbers behind it. Groups of kinds that the rule is not about, and groups without receivers, are not judged.
    ///
    /// Linear in receivers times days.
    ///
    /// # Panics
    ///
    /// If a group does not have the sun of each receiver on each day.
    pub fn judge(&self, evidence: &Evidence) -> Verdict {
        let groups: Vec<(GroupVerdict, Told)> =
            evidence.groups.iter().map(|group| self.judge_group(evidence, group)).collect();
        let is_judged = |verdict: &GroupVerdict| verdict.outcome != Outcome::NotApplicable;
        let mut met = Bounded::default();
        let mut without_sun = Bounded::default();
        let mut group_count = 0;
        for ((_, told), group) in groups.iter().zip(&evidence.groups).filter(|((verdict, _), _)| is_judged(verdict)) {
            group_count += 1;
            met = met.plus(bounded(*told, 1.0));
            without_sun = without_sun.plus(bounded(has_no_sun(group), 1.0));
        }
        let total = (group_count as f64).max(1.0);
        let mut is_met = tell(met.map(|count| count / total), |share| self.enough_groups.is_met_by(share));
        if let Some(most) = self.most_groups_without_sun {
            // Told of the most groups first, as those are left by the shortest hours.
            let [most_dark, dark, least_dark] = [without_sun.most, without_sun.value, without_sun.least];
            is_met = both(is_met, [most_dark, dark, least_dark].map(|count| count / total <= most));
        }
        let outcome = if group_count == 0 { Outcome::NotApplicable } else { Outcome::of(is_met) };
        let mut verdict = Verdict {
            rule: self.clone(),
            outcome,
            text: String::new(),
            groups: groups.into_iter().map(|(verdict, _)| verdict).collect(),
            group_count,
            groups_met: met,
            groups_without_sun: without_sun,
        };
        verdict.text = verdict.sentence();
        verdict
    }

    fn judge_group(&self, evidence: &Evidence, group: &GroupEvidence) -> (GroupVerdict, Told) {
        let day_count = evidence.days.len();
        let days: Vec<DayNumbers> = (0..day_count)
            .map(|d| self.day_numbers(Day(evidence.days[d]), group, |r| group.sun[r * day_count + d]))
            .collect();
        let (share, deciding_day) = self.share(group, &group.sun, day_count);
        let before = group.sun_before.as_ref().map(|before| self.share(group, before, day_count).0);
        let mut told = tell(share, |share| self.enough_receivers.is_met_by(share));
        if let (Some(least_ratio), Some(before)) = (self.least_ratio, before) {
            let keeps = |now: f64, before: f64| now >= least_ratio * before - SHARE_ROUNDING;
            told = either(
                told,
                [keeps(share.least, before.most), keeps(share.value, before.value), keeps(share.most, before.least)],
            );
        }
        let is_judged = self.receivers.contains(&group.kind) && !group.weights.is_empty() && day_count > 0;
        let verdict = GroupVerdict {
            name: group.name.clone(),
            kind: group.kind,
            outcome: if is_judged { Outcome::of(told) } else { Outcome::NotApplicable },
            receiver_count: group.weights.len(),
            share,
            share_before: before,
            margin: share.value - self.enough_receivers.threshold(),
            ratio: before.filter(|before| before.value > 0.0).map(|before| share.value / before.value),
            deciding_day: deciding_day.map(|d| Day(evidence.days[d])),
            days,
        };
        (verdict, told)
    }

    /// The share of receivers with enough sun, and the day that decided, if one did.
    fn share(&self, group: &GroupEvidence, sun: &[CountedSun], day_count: usize) -> (Bounded, Option<usize>) {
        assert_eq!(
            sun.len(),
            group.weights.len() * day_count,
            "{} has the sun of each receiver on each day",
            group.name
        );
        let of_receiver = |r: usize| sun[r * day_count..(r + 1) * day_count].iter().map(|day| self.has_enough(day));
        let only = (day_count == 1).then_some(0);
        match self.need {
            Need::Any => (share_of(group, |r| of_receiver(r).fold([false; 3], either)), only),
            Need::Each => (share_of(group, |r| of_receiver(r).fold([true; 3], both)), only),
            Need::Worst => {
                let on_day = |d: usize| share_of(group, |r| self.has_enough(&sun[r * day_count + d]));
                let shares: Vec<Bounded> = (0..day_count).map(on_day).collect();
                let lowest = |of: fn(&Bounded) -> f64| shares.iter().map(of).fold(f64::INFINITY, f64::min);
                let worst = (0..day_count).min_by(|&a, &b| shares[a].value.total_cmp(&shares[b].value));
                let share =
                    Bounded { least: lowest(|s| s.least), value: lowest(|s| s.value), most: lowest(|s| s.most) };
                (if day_count == 0 { Bounded::default() } else { share }, worst)
            }
        }
    }

    /// Whether a receiver has enough sun on one day.
    fn has_enough(&self, sun: &CountedSun) -> Told {
        let reaches =
            |number: Bounded, least: Option<f64>| least.map_or([true; 3], |least| tell(number, |s| s >= least));
        both(reaches(sun.total_s, self.sun.total_s), reaches(sun.longest_s, self.sun.longest_s))
    }

    fn day_numbers(&self, day: Day, group: &GroupEvidence, sun: impl Fn(usize) -> CountedSun) -> DayNumbers {
        let receivers = || (0..group.weights.len()).map(&sun);
        let totals = || receivers().map(|sun| sun.total_s.value);
        let weight: f64 = group.weights.iter().sum();
        let weighted: f64 = totals().zip(&group.weights).map(|(total, weight)| total * weight).sum();
        DayNumbers {
            day,
            share: share_of(group, |r| self.has_enough(&sun(r))),
            least_sun_s: totals().reduce(f64::min).unwrap_or(0.0),
            mean_sun_s: if weight > 0.0 { weighted / weight } else { 0.0 },
            most_sun_s: totals().fold(0.0, f64::max),
            longest_piece_s: receivers().map(|sun| sun.longest_s.value).fold(0.0, f64::max),
        }
    }
}

/// By weight; 0 without any.
fn share_of(group: &GroupEvidence, has: impl Fn(usize) -> Told) -> Bounded {
    let weight: f64 = group.weights.iter().sum();
    let sum = (0..group.weights.len()).fold(Bounded::default(), |sum, r| sum.plus(bounded(has(r), group.weights[r])));
    if weight > 0.0 { sum.map(|part| part / weight) } else { Bounded::default() }
}

/// Whether no receiver has any sun on any day: surely, as computed, possibly.
fn has_no_sun(group: &GroupEvidence) -> Told {
    let is_dark = |of: fn(&Bounded) -> f64| group.sun.iter().all(|sun| of(&sun.total_s) == 0.0);
    [is_dark(|s| s.most), is_dark(|s| s.value), is_dark(|s| s.least)]
}
