//! Rules that ask for sun, and whether they are met.
//!
//! ```text
//!   file.toml  ->  Rule  ->  Needs (dates, clock, least altitude, receivers)  ->  a study
//!                   |                                                               |
//!                   |                 Evidence (groups of receivers, their sun)  <--'
//!                   '----------------------->  Verdict (outcome, numbers, margins)
//!
//!   fields    what a rule is made of       rule      the rule, its presets, what it needs
//!   file      TOML into a rule             evidence  what is known about the sun of receivers
//!   judge     rule + evidence -> verdict   verdict   the outcome and the numbers behind it, in words
//! ```
//!
//! Hours of sun have an error bound, and so has every number that follows from them: a verdict that some hours within their bounds would turn is
//! [`Outcome::Undecided`], whatever the hours as computed say.
//!
//! None of this is legal advice. Presets say in their files what was verified and what was not.

mod evidence;
mod fields;
mod file;
mod judge;
mod rule;
#[cfg(test)]
mod tests;
mod verdict;

pub use evidence::{Bounded, CountedSun, Evidence, GroupEvidence};
pub use fields::{Dates, Enough, MonthDay, Need, ReceiverKind, RuleClock};
pub use file::RuleError;
pub use rule::{Needs, Rule, SunNeeded};
pub use verdict::{DayNumbers, GroupVerdict, Outcome, Verdict};
