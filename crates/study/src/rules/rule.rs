//! A rule, the presets, and what a study must compute for it.

use jiff::SignedDuration;
use jiff::civil::Date;
use serde::Serialize;

use super::evidence::CountedSun;
use super::fields::{Dates, Enough, Need, ReceiverKind, RuleClock};
use super::file::{self, RuleError};
use crate::{Clock, Period, SunHours, Zone};

/// What ships with the program: name, and the text of the file.
const PRESETS: [(&str, &str); 6] = [
    ("en17037", include_str!("../../rules/en17037.toml")),
    ("bre209", include_str!("../../rules/bre209.toml")),
    ("tno-light", include_str!("../../rules/tno-light.toml")),
    ("tno-strict", include_str!("../../rules/tno-strict.toml")),
    ("pl-wt60", include_str!("../../rules/pl-wt60.toml")),
    ("nsw-adg", include_str!("../../rules/nsw-adg.toml")),
];

/// Who must have how much sun, and when.
///
/// ```
/// use umbrae_study::rules::Rule;
///
/// let rule = Rule::preset("en17037:germany")?;
/// assert_eq!(rule.min_altitude_rad, 11_f64.to_radians());
/// assert_eq!(rule.sun.total_s, Some(1.5 * 3600.0));
/// let needs = rule.needs(2026);
/// assert_eq!(needs.dates.len(), 28 + 21);
/// # Ok::<(), umbrae_study::rules::RuleError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rule {
    /// What it is called for on a command line.
    pub name: String,
    /// What people call it.
    pub title: String,
    /// Which text it is, of what year.
    pub edition: String,
    /// Where that, or what it was taken from, is found.
    pub source: String,
    /// What of it was verified, and how.
    pub status: String,
    /// That it is no legal advice.
    pub disclaimer: String,
    /// When sun is asked for.
    pub dates: Dates,
    /// On which of these.
    pub need: Need,
    /// At what times of day.
    pub clock: RuleClock,
    /// Lower suns do not count; 0 to less than a right angle.
    pub min_altitude_rad: f64,
    /// What must have it; never empty.
    pub receivers: Vec<ReceiverKind>,
    /// How much a receiver must have.
    pub sun: SunNeeded,
    /// How many receivers of a group must have it.
    pub enough_receivers: Enough,
    /// How many groups must have enough receivers.
    pub enough_groups: Enough,
    /// The largest share of groups that may have no sun at all; `None` asks nothing more.
    pub most_groups_without_sun: Option<f64>,
    /// A group with too few receivers is still well if the share that has enough sun is at least so many times what it was before.
    pub least_ratio: Option<f64>,
    /// What else the file has, by name.
    pub variants: Vec<String>,
}

/// How much sun a receiver must have in a day; at least one of the first two.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SunNeeded {
    /// In all, seconds.
    pub total_s: Option<f64>,
    /// In one piece, seconds.
    pub longest_s: Option<f64>,
    /// Shorter pieces do not count, seconds.
    pub least_span_s: f64,
}

/// What a study must compute so that a rule can be judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Needs {
    /// In order.
    pub dates: Vec<Date>,
    /// From when to when, by which clock.
    pub clock: RuleClock,
    /// Lower suns do not count.
    pub min_altitude_rad: f64,
    /// One kind of these at least.
    pub receivers: Vec<ReceiverKind>,
    /// Whether the sun before a project, too, may decide.
    pub uses_before: bool,
}

impl Needs {
    /// The period to study in `zone`, in steps of `step`.
    pub fn period(&self, zone: Zone, step: SignedDuration) -> Period {
        let RuleClock { kind, from, to } = self.clock;
        Period { clock: Clock { kind, zone }, dates: self.dates.clone(), from, to, step }
    }
}

impl Rule {
    /// The rules that ship with the program, as [`Rule::preset`] wants them.
    pub fn preset_names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|&(name, _)| name)
    }

    /// One of these, with any of its variants after colons: `en17037`, `en17037:germany`, `en17037:germany:high`. Later ones win.
    ///
    /// # Errors
    ///
    /// [`RuleError::UnknownPreset`] and [`RuleError::UnknownVariant`].
    pub fn preset(name_and_variants: &str) -> Result<Self, RuleError> {
        let mut parts = name_and_variants.split(':');
        let wanted = parts.next().unwrap_or_default();
        let (_, text) = PRESETS.iter().find(|(name, _)| *name == wanted).ok_or_else(|| RuleError::UnknownPreset {
            name: wanted.to_owned(),
            known: Self::preset_names().collect::<Vec<_>>().join(", "),
        })?;
        Self::parse(text, &parts.collect::<Vec<_>>())
    }

    /// The rule that `text`, a TOML file, describes, changed as each of `variants` of that file says. Later ones win.
    ///
    /// # Errors
    ///
    /// [`RuleError`], for the file and for each of its variants, wanted or not.
    pub fn parse(text: &str, variants: &[&str]) -> Result<Self, RuleError> {
        file::parse(text, variants)
    }

    /// What is to be computed for a study of `year`.
    pub fn needs(&self, year: i16) -> Needs {
        let dates = match &self.dates {
            Dates::Days(days) => days.iter().filter_map(|day| day.of_year(year)).collect(),
            Dates::Window(first, last) => {
                let last = last.of_year(year);
                let days = first.of_year(year).into_iter().flat_map(|day| day.series(jiff::Span::new().days(1)));
                days.take_while(|&day| last.is_some_and(|last| day <= last)).collect()
            }
        };
        Needs {
            dates,
            clock: self.clock,
            min_altitude_rad: self.min_altitude_rad,
            receivers: self.receivers.clone(),
            uses_before: self.least_ratio.is_some(),
        }
    }

    /// What of a receiver's sun of one day, within the rule's times of it, counts.
    pub fn count(&self, hours: &SunHours) -> CountedSun {
        CountedSun::of(hours, self.sun.least_span_s)
    }
}
