//! TOML into a rule: nothing is guessed, and what is wrong is named.
//!
//! A file is one rule, and may have variants of it: tables that hold the keys that are different there, and nothing else.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::{Table, Value};

use super::fields::{Dates, Enough, MonthDay, Need, ReceiverKind, RuleClock};
use super::rule::{Rule, SunNeeded};
use crate::{ClockKind, Edge, TimeError};

/// Why there is no rule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RuleError {
    /// Not TOML, or not with the keys that a rule has.
    #[error("line {line}: {problem}")]
    Text {
        /// From 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A key has a value that it can't have.
    #[error("`{key}` is {value}, but {problem}")]
    Value {
        /// Tables and key, with dots.
        key: &'static str,
        /// As in the file.
        value: String,
        /// What is wrong, and what would be right.
        problem: String,
    },
    /// A variant is not one.
    #[error("variant `{variant}`: {problem}")]
    Variant {
        /// Its name.
        variant: String,
        /// What is wrong.
        problem: String,
    },
    /// There is no such preset.
    #[error("there is no rule `{name}`; there are {known}, and files of your own")]
    UnknownPreset {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// The rule has no such variant.
    #[error("the rule `{rule}` has no variant `{variant}`; it has {known}")]
    UnknownVariant {
        /// Which rule.
        rule: String,
        /// What was asked for.
        variant: String,
        /// What there is.
        known: String,
    },
}

/// A file as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RuleFile {
    name: String,
    title: String,
    edition: String,
    source: String,
    status: String,
    disclaimer: String,
    receivers: Vec<String>,
    min_altitude_deg: f64,
    dates: DatesFile,
    clock: ClockFile,
    sun: SunFile,
    share: ShareFile,
    before: Option<BeforeFile>,
    #[serde(default)]
    variants: BTreeMap<String, Table>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DatesFile {
    days: Option<Vec<String>>,
    window: Option<String>,
    need: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ClockFile {
    kind: String,
    from: String,
    to: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SunFile {
    hours: Option<f64>,
    contiguous_hours: Option<f64>,
    least_span_minutes: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShareFile {
    enough_receivers: Value,
    enough_groups: Value,
    most_groups_without_sun: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct BeforeFile {
    least_ratio: f64,
}

/// See [`Rule::parse`].
pub(super) fn parse(text: &str, variants: &[&str]) -> Result<Rule, RuleError> {
    let in_text = |error: &toml::de::Error| RuleError::Text {
        line: error.span().map_or(1, |span| 1 + text[..span.start.min(text.len())].matches('\n').count()),
        problem: one_line(error.message()),
    };
    let file: RuleFile = toml::from_str(text).map_err(|error| in_text(&error))?;
    let known: Vec<String> = file.variants.keys().cloned().collect();
    let base: Table = toml::from_str(text).map_err(|error| in_text(&error))?;
    let rule = checked(file)?;
    // A variant that is wrong is known before someone needs it.
    for (variant, changes) in variant_tables(&base) {
        let mut table = base.clone();
        merge(&mut table, changes);
        of_table(table, variant)?;
    }
    let mut table = base.clone();
    for variant in variants {
        let changes = variant_tables(&base).find(|(name, _)| name == variant).map(|(_, changes)| changes);
        merge(
            &mut table,
            changes.ok_or_else(|| RuleError::UnknownVariant {
                rule: rule.name.clone(),
                variant: (*variant).to_owned(),
                known: if known.is_empty() { "none".to_owned() } else { known.join(", ") },
            })?,
        );
    }
    if variants.is_empty() { Ok(rule) } else { of_table(table, &variants.join(":")) }
}

fn variant_tables(base: &Table) -> impl Iterator<Item = (&String, &Table)> {
    let variants = base.get("variants").and_then(Value::as_table).into_iter().flatten();
    variants.filter_map(|(name, changes)| Some((name, changes.as_table()?)))
}

/// The rule of `table`, in which `variant` was merged.
fn of_table(table: Table, variant: &str) -> Result<Rule, RuleError> {
    let wrong = |problem: String| RuleError::Variant { variant: variant.to_owned(), problem };
    let file = RuleFile::deserialize(table).map_err(|error| wrong(one_line(error.message())))?;
    checked(file).map_err(|error| wrong(error.to_string()))
}

/// Puts what `changes` has in the place of what `table` has, key by key.
fn merge(table: &mut Table, changes: &Table) {
    for (key, change) in changes {
        match (table.get_mut(key), change) {
            (Some(Value::Table(inner)), Value::Table(changes)) => merge(inner, changes),
            _ => {
                table.insert(key.clone(), change.clone());
            }
        }
    }
}

fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn wrong(key: &'static str, value: &impl ToString, problem: impl Into<String>) -> RuleError {
    RuleError::Value { key, value: value.to_string(), problem: problem.into() }
}

fn checked(file: RuleFile) -> Result<Rule, RuleError> {
    let altitude_deg = file.min_altitude_deg;
    if !(0.0..90.0).contains(&altitude_deg) {
        return Err(wrong("min_altitude_deg", &altitude_deg, "the sun is between 0 and 90 degrees high"));
    }
    Ok(Rule {
        name: named("name", file.name)?,
        title: named("title", file.title)?,
        edition: named("edition", file.edition)?,
        source: named("source", file.source)?,
        status: named("status", file.status)?,
        disclaimer: named("disclaimer", file.disclaimer)?,
        need: need(&file.dates.need)?,
        dates: dates(file.dates)?,
        clock: clock(&file.clock)?,
        min_altitude_rad: altitude_deg.to_radians(),
        receivers: receivers(&file.receivers)?,
        sun: sun(&file.sun)?,
        enough_receivers: enough("share.enough_receivers", &file.share.enough_receivers)?,
        enough_groups: enough("share.enough_groups", &file.share.enough_groups)?,
        most_groups_without_sun: file
            .share
            .most_groups_without_sun
            .map(|share| in_range("share.most_groups_without_sun", share, 0.0, 1.0, "it is a share, from 0 to 1"))
            .transpose()?,
        least_ratio: file
            .before
            .map(|before| {
                positive("before.least_ratio", before.least_ratio, 1.0, "it is a ratio, above 0 and 1 at most")
            })
            .transpose()?,
        variants: file.variants.into_keys().collect(),
    })
}

fn named(key: &'static str, text: String) -> Result<String, RuleError> {
    if text.trim().is_empty() {
        Err(wrong(key, &"empty", "a verdict without it can't be checked; write it"))
    } else {
        Ok(text)
    }
}

fn need(text: &str) -> Result<Need, RuleError> {
    match text {
        "any" => Ok(Need::Any),
        "each" => Ok(Need::Each),
        "worst" => Ok(Need::Worst),
        _ => Err(wrong("dates.need", &quoted(text), "it is \"any\", \"each\" or \"worst\"")),
    }
}

fn dates(file: DatesFile) -> Result<Dates, RuleError> {
    let day = |key: &'static str, text: &str| {
        text.parse::<MonthDay>().map_err(|problem| wrong(key, &quoted(text), format!("that {problem}")))
    };
    match (file.days, file.window) {
        (Some(days), None) => {
            let mut known = days.iter().map(|text| day("dates.days", text)).collect::<Result<Vec<_>, _>>()?;
            known.sort_unstable();
            known.dedup();
            if known.is_empty() {
                Err(wrong("dates.days", &"empty", "a rule has one day at least"))
            } else {
                Ok(Dates::Days(known))
            }
        }
        (None, Some(window)) => {
            let key = "dates.window";
            let (first, last) =
                window.split_once("..").ok_or_else(|| wrong(key, &quoted(&window), "it is written MM-DD..MM-DD"))?;
            let (first, last) = (day(key, first.trim())?, day(key, last.trim())?);
            if first > last {
                return Err(wrong(
                    key,
                    &quoted(&window),
                    "that ends before it begins; make it two rules, one for each year",
                ));
            }
            Ok(Dates::Window(first, last))
        }
        (Some(_), Some(_)) => Err(wrong("dates", &"given twice", "a rule has `days` or a `window`, not both")),
        (None, None) => Err(wrong("dates", &"without days", "a rule has `days` or a `window`")),
    }
}

fn clock(file: &ClockFile) -> Result<RuleClock, RuleError> {
    let kind = match file.kind.as_str() {
        "civil" => ClockKind::Civil,
        "solar" => ClockKind::Solar,
        other => {
            let kinds = "it is \"civil\" (the clock on the wall) or \"solar\" (true solar time)";
            return Err(wrong("clock.kind", &quoted(other), kinds));
        }
    };
    let from = edge("clock.from", &file.from, Edge::parse_from(&file.from))?;
    let to = edge("clock.to", &file.to, Edge::parse_to(&file.to))?;
    if let (Edge::Local(start), Edge::Local(end)) = (from, to)
        && start.seconds() >= end.seconds()
    {
        return Err(wrong("clock.to", &quoted(&file.to), format!("that is not after {}", file.from)));
    }
    Ok(RuleClock { kind, from, to })
}

/// `parsed`, unless it is a time of one zone only.
fn edge(key: &'static str, text: &str, parsed: Result<Edge, TimeError>) -> Result<Edge, RuleError> {
    match parsed {
        Ok(Edge::Local(time)) if time.offset().is_some() => {
            Err(wrong(key, &quoted(text), "a rule holds in every zone; leave the offset away"))
        }
        Ok(edge) => Ok(edge),
        Err(error) => Err(wrong(key, &quoted(text), error.to_string())),
    }
}

fn receivers(names: &[String]) -> Result<Vec<ReceiverKind>, RuleError> {
    let kind = |name: &String| {
        let known = ReceiverKind::ALL.into_iter().find(|kind| kind.name() == name);
        let all = ReceiverKind::ALL.map(ReceiverKind::name).join(", ");
        known.ok_or_else(|| wrong("receivers", &quoted(name), format!("there are {all}")))
    };
    let mut kinds = names.iter().map(kind).collect::<Result<Vec<_>, _>>()?;
    kinds.sort_unstable();
    kinds.dedup();
    if kinds.is_empty() { Err(wrong("receivers", &"empty", "something must have the sun")) } else { Ok(kinds) }
}

fn sun(file: &SunFile) -> Result<SunNeeded, RuleError> {
    let seconds = |key: &'static str, hours: Option<f64>| -> Result<Option<f64>, RuleError> {
        let checked = |hours| positive(key, hours, 24.0, "it is more than 0 hours of a day and 24 at most");
        Ok(hours.map(checked).transpose()?.map(|hours| hours * 3600.0))
    };
    let total_s = seconds("sun.hours", file.hours)?;
    let longest_s = seconds("sun.contiguous_hours", file.contiguous_hours)?;
    if total_s.is_none() && longest_s.is_none() {
        return Err(wrong("sun", &"empty", "a rule asks for `hours`, for `contiguous_hours`, or for both"));
    }
    let minutes = file.least_span_minutes.unwrap_or(0.0);
    let minutes =
        in_range("sun.least_span_minutes", minutes, 0.0, 1440.0, "it is from 0 to the 1440 minutes of a day")?;
    Ok(SunNeeded { total_s, longest_s, least_span_s: minutes * 60.0 })
}

fn enough(key: &'static str, value: &Value) -> Result<Enough, RuleError> {
    let way_out = "it is \"one\", \"all\", or a share above 0 and up to 1";
    match value {
        Value::String(word) if word == "one" => Ok(Enough::One),
        Value::String(word) if word == "all" => Ok(Enough::All),
        Value::Float(share) => positive(key, *share, 1.0, way_out).map(Enough::Share),
        Value::Integer(share) => positive(key, *share as f64, 1.0, way_out).map(Enough::Share),
        other => Err(wrong(key, other, way_out)),
    }
}

fn positive(key: &'static str, number: f64, most: f64, way_out: &str) -> Result<f64, RuleError> {
    if number > 0.0 && number <= most { Ok(number) } else { Err(wrong(key, &number, way_out)) }
}

fn in_range(key: &'static str, number: f64, least: f64, most: f64, way_out: &str) -> Result<f64, RuleError> {
    if (least..=most).contains(&number) { Ok(number) } else { Err(wrong(key, &number, way_out)) }
}

fn quoted(text: &str) -> String {
    format!("{text:?}")
}
