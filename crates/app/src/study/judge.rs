//! Rules: each is about days and hours of its own, so it is computed by itself, on the same receivers.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use anyhow::Context as _;
use glam::DVec3;
use umbrae_core::SurfaceKind;
use umbrae_study::rules::{CountedSun, Evidence, GroupEvidence, ReceiverKind, Rule, RuleError, Verdict};
use umbrae_study::{
    Clock, DiscExposure, GroupKind, Packets, Period, Receivers, Refinement, SunHours, SunOptions, Timetable,
};

use super::results::Results;
use super::rows::{bit, rows_of};
use super::scene::Situation;

/// The rules of `--rule`: names of presets, or files, each perhaps with variants after colons.
///
/// # Errors
///
/// When one is neither, or the file is no rule.
pub(super) fn rules(names: &[String]) -> anyhow::Result<Vec<Rule>> {
    names.iter().map(|name| rule(name)).collect()
}

fn rule(name: &str) -> anyhow::Result<Rule> {
    let is_file = name.split(':').next().is_some_and(|first| first.ends_with(".toml"));
    if !is_file {
        return Ok(Rule::preset(name)?);
    }
    let mut parts = name.split(':');
    let path = parts.next().unwrap_or_default();
    let text = fs::read_to_string(Path::new(path)).with_context(|| format!("can't read the rule `{path}`"))?;
    let parsed: Result<Rule, RuleError> = Rule::parse(&text, &parts.collect::<Vec<_>>());
    parsed.with_context(|| format!("can't use the rule `{path}`"))
}

/// Judges `rule` in the year of the study's first day; `None` if `stop` was set before the end.
///
/// # Errors
///
/// When the rule's days or hours are none at the place.
pub(super) fn judge(
    rule: &Rule,
    results: &Results,
    situations: &[Situation],
    of_state: &[Receivers],
    stop: &AtomicBool,
) -> anyhow::Result<Option<Verdict>> {
    let year = results.timetable.days.first().map_or(2000, |day| day.year());
    let needs = rule.needs(year);
    let site = &results.site;
    let clock = Clock { kind: needs.clock.kind, zone: site.zone.clone() };
    let steps = results.timetable.steps.iter().map(|step| step.end.duration_since(step.start));
    let period = Period {
        clock,
        dates: needs.dates,
        from: needs.clock.from,
        to: needs.clock.to,
        // The last step of a day may be cut short.
        step: steps.max().context("the period of the study has no step")?,
    };
    let options = SunOptions { min_altitude_rad: needs.min_altitude_rad, ..site.options };
    let timetable =
        Timetable::new(&site.place, &period, &options).with_context(|| format!("can't judge {}", rule.title))?;
    let north_rad = site.north_deg.to_radians();
    let suns = timetable.directions(north_rad);
    let has_disc = results.disc.is_some();
    let moments = if results.refinement.is_some() {
        let fine = Refinement::new(&site.place, &timetable, &options, north_rad)?;
        let timetable = fine.timetable().clone();
        let disc_suns = has_disc.then(|| timetable.disc_directions(&options, north_rad));
        Moments { timetable, suns: fine.suns().to_vec(), refinement: Some(fine), disc_suns }
    } else {
        let disc_suns = has_disc.then(|| timetable.disc_directions(&options, north_rad));
        Moments { timetable, suns, refinement: None, disc_suns }
    };

    let mut of_states = Vec::new();
    for (situation, receivers) in situations.iter().zip(of_state) {
        let is_wanted = |group: &umbrae_study::Group| needs.receivers.contains(&kind(&group.kind, receivers, group));
        let Some(counted) = count(rule, &moments, situation, receivers, is_wanted, stop) else {
            return Ok(None);
        };
        of_states.push(counted);
    }
    let Some(after) = of_states.pop() else { return Ok(None) };
    let mut before = of_states.pop();
    let Some(receivers) = of_state.last() else { return Ok(None) };
    let mut groups = Vec::new();
    for (i, group) in receivers.groups.iter().enumerate() {
        let weights = weights(group, receivers, of_state);
        let kept: Vec<usize> = group.range.clone().filter(|&r| is_outside(r, of_state)).collect();
        let of = |counted: &Counted| kept.iter().flat_map(|r| counted[*r].iter().copied()).collect::<Vec<_>>();
        let is_about = needs.receivers.contains(&kind(&group.kind, receivers, group));
        if is_about {
            groups.push(GroupEvidence {
                name: if group.name.is_empty() { format!("group {}", i + 1) } else { group.name.clone() },
                kind: kind(&group.kind, receivers, group),
                weights,
                sun: of(&after),
                sun_before: before.as_mut().map(|before| of(before)),
            });
        }
    }
    let mut verdict = rule.judge(&Evidence { days: moments.timetable.days.clone(), groups });
    if has_disc {
        verdict.text += " Sun is counted by the share of its disc that is seen.";
    }
    Ok(Some(verdict))
}

/// For each receiver the sun of each day, as far as the rule counts it; nothing for receivers that it is not about.
type Counted = Vec<Vec<CountedSun>>;

/// When a rule looks.
struct Moments {
    timetable: Timetable,
    /// For each step the direction to the sun, scene space; `None` where it does not count.
    suns: Vec<Option<DVec3>>,
    /// With it changes are found to the second.
    refinement: Option<Refinement>,
    /// With them the sun is a disc about each, and what is seen of it counts.
    disc_suns: Option<Vec<Option<DVec3>>>,
}

fn count(
    rule: &Rule,
    Moments { timetable, suns, refinement, disc_suns }: &Moments,
    situation: &Situation,
    receivers: &Receivers,
    is_wanted: impl Fn(&umbrae_study::Group) -> bool,
    stop: &AtomicBool,
) -> Option<Counted> {
    let mut wanted = receivers.clone();
    for group in receivers.groups.iter().filter(|group| !is_wanted(group)) {
        wanted.is_inside[group.range.clone()].fill(true);
    }
    let packets = Packets::new(&wanted);
    let mut counted: Counted = vec![Vec::new(); receivers.len()];
    // As many packets at a time as have their words in some megabytes.
    let block = ((8 << 20) / (8 * suns.len().max(1))).max(1);
    for first in (0..packets.len()).step_by(block) {
        let range = first..packets.len().min(first + block);
        if let Some(suns) = disc_suns {
            let exposure = situation.blockers.expose_disc(&wanted, &packets, range, suns, stop, || ())?;
            for (receiver, row) in rows_of(&exposure.whole, &packets) {
                let partial = exposure.of_receiver(receiver);
                let of_day = |day: usize| {
                    let steps = timetable.steps_of_day(day);
                    let share = |i: usize| DiscExposure::share(partial, steps.start + i, bit(&row, steps.start + i));
                    rule.count(&SunHours::of_shares(&timetable.steps[steps.clone()], share))
                };
                counted[receiver] = (0..timetable.days.len()).map(of_day).collect();
            }
            continue;
        }
        let exposure = situation.blockers.expose(&wanted, &packets, range, suns, stop, || ())?;
        let rows = rows_of(&exposure, &packets);
        for (receiver, row) in rows {
            let at = (wanted.positions[receiver], wanted.normals[receiver]);
            counted[receiver] = (0..timetable.days.len())
                .map(|day| {
                    let steps = timetable.steps_of_day(day);
                    let is_lit = |step: usize| bit(&row, step);
                    let hours = match refinement {
                        Some(fine) => fine.hours(&situation.blockers, at, steps, is_lit),
                        None => SunHours::of_steps(&timetable.steps[steps.clone()], |i| is_lit(steps.start + i)),
                    };
                    rule.count(&hours)
                })
                .collect();
        }
    }
    Some(counted)
}

/// What a group is to rules: points with normals are windows.
fn kind(kind: &GroupKind, receivers: &Receivers, group: &umbrae_study::Group) -> ReceiverKind {
    match kind {
        GroupKind::Ground(_) => ReceiverKind::Ground,
        GroupKind::Surface { surface: SurfaceKind::Roof, .. } => ReceiverKind::Roof,
        GroupKind::Surface { .. } => ReceiverKind::Wall,
        GroupKind::Points { .. } if receivers.normals[group.range.clone()].iter().all(|&n| n != glam::Vec3::ZERO) => {
            ReceiverKind::Window
        }
        GroupKind::Points { .. } => ReceiverKind::Points,
    }
}

/// What each receiver outside of solids stands for.
fn weights(group: &umbrae_study::Group, receivers: &Receivers, of_state: &[Receivers]) -> Vec<f64> {
    debug_assert!(group.range.end <= receivers.len());
    let weight = |i: usize| match &group.kind {
        GroupKind::Ground(grid) => grid.spacing * grid.spacing,
        GroupKind::Surface { areas, .. } => f64::from(areas[i]),
        GroupKind::Points { .. } => 1.0,
    };
    let members = group.range.clone().enumerate();
    members.filter(|&(_, r)| is_outside(r, of_state)).map(|(i, _)| weight(i)).collect()
}

/// Whether a receiver is outside of solids before and after, so that the two can be compared.
fn is_outside(receiver: usize, of_state: &[Receivers]) -> bool {
    of_state.iter().all(|receivers| !receivers.is_inside[receiver])
}
