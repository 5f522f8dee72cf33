//! What came out, and the numbers behind it.

use std::fmt;

use jiff::civil::Date;
use serde::{Serialize, Serializer};

use super::fields::ReceiverKind;
use super::{Bounded, Rule};

/// Whether a rule is met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It is, whatever the hours are within their error bounds.
    Met,
    /// It is not, likewise.
    NotMet,
    /// Some hours within their error bounds would turn it.
    Undecided {
        /// What it is with the hours as computed.
        is_met_as_computed: bool,
    },
    /// There is nothing that the rule is about.
    NotApplicable,
}

/// The verdict on everything that a rule is about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The rule, so that a verdict can be checked by whoever has only this.
    pub rule: Rule,
    /// Whether it is met.
    pub outcome: Outcome,
    /// In a sentence.
    pub text: String,
    /// One for each group of the evidence, in its order.
    pub groups: Vec<GroupVerdict>,
    /// How many groups the rule is about.
    pub group_count: usize,
    /// How many of these are met.
    pub groups_met: Bounded,
    /// How many of these have no receiver with any sun on any day.
    pub groups_without_sun: Bounded,
}

/// The verdict on one group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupVerdict {
    /// What it is called.
    pub name: String,
    /// What its receivers are on.
    pub kind: ReceiverKind,
    /// Whether it has enough receivers with enough sun, or kept enough of them.
    pub outcome: Outcome,
    /// How many receivers it has.
    pub receiver_count: usize,
    /// The share of them that have enough sun, by weight, 0 to 1.
    pub share: Bounded,
    /// That share before.
    pub share_before: Option<Bounded>,
    /// By how much the share as computed is above what is enough, in shares; negative below. For "one" of them, that is above 0; for "all", above 1.
    pub margin: f64,
    /// How often the share before the share now is; `None` without a before, and where nothing had enough sun before.
    pub ratio: Option<f64>,
    /// The day that decided, where it was one day: the worst, or the only one.
    pub deciding_day: Option<Day>,
    /// In the order of the days.
    pub days: Vec<DayNumbers>,
}

/// The numbers of a group on one day.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DayNumbers {
    /// Which day.
    pub day: Day,
    /// The share of receivers that have enough sun on it, by weight, 0 to 1.
    pub share: Bounded,
    /// The sun that counts, as computed, of the receiver with the least, seconds.
    pub least_sun_s: f64,
    /// The mean over all receivers, by weight, seconds.
    pub mean_sun_s: f64,
    /// That of the receiver with the most, seconds.
    pub most_sun_s: f64,
    /// The longest piece of any receiver, seconds.
    pub longest_piece_s: f64,
}

/// A date, which is serialised as `2026-03-21`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Day(pub Date);

impl Serialize for Day {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

/// A share, 0 to 1, in words: `62 %`, `49.7 %`. Never rounded up to 100 %, nor down to 0.
pub(super) struct Percent(pub(super) f64);

impl fmt::Display for Percent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = self.0 * 100.0;
        let tenths = (percent * 10.0).round() / 10.0;
        match tenths {
            100.0 if percent < 100.0 - 1e-7 => f.write_str("just under 100 %"),
            0.0 if percent > 0.0 => f.write_str("just over 0 %"),
            _ if tenths.fract() == 0.0 => write!(f, "{tenths:.0} %"),
            _ => write!(f, "{tenths:.1} %"),
        }
    }
}

/// Seconds as hours: `2 h`, `1.5 h`.
struct Hours(f64);

impl fmt::Display for Hours {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} h", (self.0 / 36.0).round() / 100.0)
    }
}

impl Outcome {
    /// Of the least, the computed and the most favourable hours.
    pub(super) fn of(is_met: [bool; 3]) -> Self {
        match is_met {
            [true, _, _] => Self::Met,
            [_, _, false] => Self::NotMet,
            [_, is_met_as_computed, _] => Self::Undecided { is_met_as_computed },
        }
    }

    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::NotMet => "not met",
            Self::Undecided { is_met_as_computed: true } => {
                "met as computed, but the error bound of the hours could turn it"
            }
            Self::Undecided { is_met_as_computed: false } => {
                "not met as computed, but the error bound of the hours could turn it"
            }
            Self::NotApplicable => "not applicable",
        }
    }
}

impl Verdict {
    /// The sentence for [`Verdict::text`].
    pub(super) fn sentence(&self) -> String {
        let (title, outcome) = (&self.rule.title, self.outcome.text());
        let judged: Vec<&GroupVerdict> =
            self.groups.iter().filter(|group| group.outcome != Outcome::NotApplicable).collect();
        let worst = judged.iter().min_by(|a, b| a.margin.total_cmp(&b.margin));
        let Some(worst) = worst else {
            let kinds = self.rule.receivers.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(" or ");
            return format!("{title}: {outcome}, as there is no receiver of kind {kinds}.");
        };
        let sun = self.rule.sun.in_words();
        let of_worst = worst.in_words(&self.rule);
        if judged.len() == 1 {
            return format!("{title}: {outcome}: in {}, {of_worst} with {sun}.", worst.name);
        }
        let groups =
            format!("{} of {} groups ({} needed)", self.groups_met.value, self.group_count, self.rule.enough_groups);
        let without = self.rule.most_groups_without_sun.map_or(String::new(), |most| {
            format!("; {} without any sun ({} allowed)", self.groups_without_sun.value, Percent(most))
        });
        format!(
            "{title}: {outcome}: {groups} have enough receivers with {sun}{without}; the least is {}, with {of_worst}.",
            worst.name
        )
    }
}

impl GroupVerdict {
    fn in_words(&self, rule: &Rule) -> String {
        let [share, enough] =
            [self.share.value, rule.enough_receivers.threshold()].map(|share| Percent(share).to_string());
        // What is rounded to the threshold is not at it.
        let almost = if share == enough && !rule.enough_receivers.is_met_by(self.share.value) && self.share.value > 0.0
        {
            "just under "
        } else {
            ""
        };
        let share = format!("{almost}{share} of the receivers ({} needed)", rule.enough_receivers);
        let day =
            self.deciding_day.filter(|_| self.days.len() > 1).map_or(String::new(), |Day(day)| format!(" on {day}"));
        let before = match (rule.least_ratio, self.share_before, self.ratio) {
            (Some(least), Some(before), Some(ratio)) => {
                format!(", {:.2} times the {} before ({least} needed if too few)", ratio, Percent(before.value))
            }
            (Some(_), Some(_), None) => ", and none before".to_owned(),
            (Some(_), None, _) => ", and what it was before is not known".to_owned(),
            (None, ..) => String::new(),
        };
        format!("{share}{day}{before}")
    }
}

impl super::SunNeeded {
    fn in_words(&self) -> String {
        let total = self.total_s.map(|s| format!("{} of sun", Hours(s)));
        let longest = self.longest_s.map(|s| format!("{} of sun in one piece", Hours(s)));
        let both = [total, longest].into_iter().flatten().collect::<Vec<_>>().join(" and ");
        let pieces = format!(", pieces under {} min not counted", self.least_span_s / 60.0);
        format!("{both} a day{}", if self.least_span_s > 0.0 { &pieces } else { "" })
    }
}
