//! `report.html`: one page that says what was asked and what came of it, with its pictures in it, to be read, printed and handed in.

use std::fmt::Write as _;
use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use umbrae_study::Step;
use umbrae_study::rules::{GroupVerdict, Outcome, Verdict};

use super::Shown;
use super::tables::{ObjectRow, rows};
use crate::show::numbers::{counted, grouped};
use crate::study::folder::Folder;
use crate::study::results::{Results, State, duration_text};
use crate::study::site::{days_text, hours_text, offset_text, offsets, on_clock};

const TEMPLATE: &str = include_str!("report.html");
/// The sun as a point, in the report.
const POINT: &str = "The sun is taken as a point in the middle of its disc; the half-shadow \
                     at edges, which is a hundredth of the distance wide, is not shown.</p>\n";
/// The sun as a disc, in the report.
const DISC: &str = "It is taken as a disc of 0.533 degrees, equally bright all over, about that place. Of it, what is below a level horizon, behind the receiver's own surface or behind \
                    any triangle is hidden, each part once; the rest is what a step counts for, by exact geometry. So the sun counts from when its upper edge rises until it has set, by \
                    less than all at first and at last; where a least altitude is asked for, all of it counts from when its middle is there. Verdicts by rules are of these hours: a span of sun \
                    goes on while any of the disc is seen, and is as long as the sun that it is worth. First and last sun are those of any part of the disc. \
                    Outlines of shadows, the moving plan, undecided steps and <code>bits.npz</code> are of the disc's middle; <code>fractions.npz</code> has the shares.</p>\n";
/// A page has no room for more; all are in a table of their own.
const MOST_OBJECTS: usize = 60;
/// Rows of the sun's table.
const MOST_SUNS: usize = 48;
/// Groups of a verdict.
const MOST_GROUPS: usize = 20;

/// Writes it.
pub(super) fn write(results: &Results, shown: &Shown, folder: &mut Folder) -> anyhow::Result<()> {
    let html = fill(&[
        ("subject", escaped(&results.subject)),
        ("coordinates", escaped(&results.site.coordinates())),
        ("period", escaped(&results.period_text())),
        ("banner", banner(results)),
        ("figures", figures(results)),
        ("verdicts", verdicts(results)),
        ("pictures", pictures(results, shown, folder)?),
        ("area", area(results)),
        ("objects", objects(results)),
        ("facts", facts(results)),
        ("sun", escaped(&results.sun_text())),
        ("suns", suns(results)),
        ("method", method(results)),
        ("warnings", warnings(results)),
        ("files", files(folder)),
        ("inputs", inputs(results)),
        ("software", format!("umbrae {}", env!("CARGO_PKG_VERSION"))),
    ]);
    folder.write("report.html", |file| Ok(file.write_all(html.as_bytes())?))
}

/// The template with its `{{name}}`s replaced, each once and in one pass: what is put in is not looked at again.
fn fill(values: &[(&str, String)]) -> String {
    let mut html = String::new();
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        html.push_str(before);
        html.extend(values.iter().find(|(known, _)| *known == name).map(|(_, value)| value.as_str()));
        rest = after;
    }
    html.push_str(rest);
    html
}

fn banner(results: &Results) -> String {
    if !results.is_partial {
        return String::new();
    }
    let all = results.states.iter().map(|s| s.is_inside.iter().filter(|&&inside| !inside).count()).sum::<usize>();
    let done = results.states.iter().flat_map(|state| &state.sums).flatten().count();
    let share = 100.0 * done as f64 / all.max(1) as f64;
    format!(
        "<div class=\"banner\">Partial: the study was stopped when {share:.0} % of it was computed. What is missing is marked.</div>"
    )
}

/// The numbers that one asks for first.
fn figures(results: &Results) -> String {
    let figure = |value: String, meaning: &str| format!("<div><b>{value}</b><span>{meaning}</span></div>");
    let mut figures = figure(format!("{:.2} h", results.possible_hours()), "of sun are possible in the period");
    if let (Some((_, range)), Some(state)) = (results.ground(), results.last()) {
        let hours: Vec<f64> = range.filter_map(|r| state.hours(r)).collect();
        let count = hours.len().max(1) as f64;
        let mean = hours.iter().sum::<f64>() / count;
        let dark = hours.iter().filter(|&&hours| hours == 0.0).count() as f64 / count;
        figures += &figure(format!("{mean:.2} h"), "reach the ground, on average");
        figures += &figure(format!("{:.1} %", 100.0 * dark), "of the ground has no sun at all");
    }
    let [_, mean_s] = results.error_bounds_s();
    figures += &figure(format!("&plusmn;{}", duration_text(mean_s)), "is the error bound of a point, on average");
    if let Some(check) = results.check {
        let counts = format!("{} of {}", grouped(check.disagreements), grouped(check.verdicts));
        figures += &figure(counts, "verdicts differ in a check by rays");
    }
    figures
}

fn verdicts(results: &Results) -> String {
    if results.verdicts.is_empty() {
        return String::new();
    }
    results.verdicts.iter().fold("<h2>Verdicts</h2>\n".to_owned(), |html, verdict| html + &verdict_text(verdict))
}

fn verdict_text(verdict: &Verdict) -> String {
    let (class, outcome) = outcome_text(verdict.outcome);
    let rule = &verdict.rule;
    let mut html = format!(
        "<div class=\"verdict {class}\"><h3>{}</h3><p><span class=\"outcome\">{outcome}.</span> {}</p>\
         <p class=\"small\">{}. Source: {}. Status: {}. {}</p></div>\n",
        escaped(&rule.title),
        escaped(&verdict.text),
        escaped(&rule.edition),
        escaped(&rule.source),
        escaped(&rule.status),
        escaped(&rule.disclaimer),
    );
    let judged: Vec<&GroupVerdict> =
        verdict.groups.iter().filter(|group| group.outcome != Outcome::NotApplicable).collect();
    if judged.is_empty() {
        return html;
    }
    html += "<table><thead><tr><th>Of</th><th>On</th><th class=\"n\">Receivers</th><th class=\"n\">Share with enough sun</th><th class=\"n\">Before</th><th>Deciding day</th><th>Outcome</th></tr></thead><tbody>";
    for group in judged.iter().take(MOST_GROUPS) {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>",
            escaped(&group.name),
            group.kind.name(),
            grouped(group.receiver_count as u64),
            percent(group.share.value),
            group.share_before.map_or_else(String::new, |share| percent(share.value)),
            group.deciding_day.map_or_else(String::new, |day| day.0.to_string()),
            outcome_text(group.outcome).1,
        );
    }
    html += "</tbody></table>\n";
    if judged.len() > MOST_GROUPS {
        let _ = writeln!(
            html,
            "<p class=\"small\">and {} in <code>run.json</code></p>",
            counted(judged.len() - MOST_GROUPS, "more")
        );
    }
    html
}

fn outcome_text(outcome: Outcome) -> (&'static str, &'static str) {
    match outcome {
        Outcome::Met => ("met", "Met"),
        Outcome::NotMet => ("not-met", "Not met"),
        Outcome::Undecided { is_met_as_computed: true } => {
            ("undecided", "Met as computed, undecided within the error bound")
        }
        Outcome::Undecided { is_met_as_computed: false } => {
            ("undecided", "Not met as computed, undecided within the error bound")
        }
        Outcome::NotApplicable => ("not-applicable", "Not applicable: nothing that the rule is about was studied"),
    }
}

fn pictures(results: &Results, shown: &Shown, folder: &Folder) -> anyhow::Result<String> {
    let mut html = String::new();
    if shown.maps.is_empty() && shown.perspectives.is_empty() {
        return Ok(html);
    }
    html += "<h2>Plans</h2>\n";
    for map in &shown.maps {
        let is_moving = map.name.ends_with("apng");
        let (class, mime) = if is_moving { (" class=\"moving\"", "image/apng") } else { ("", "image/png") };
        let data = STANDARD.encode(folder.read(&map.name)?);
        let title = escaped(&map.title);
        let _ = writeln!(
            html,
            "<figure{class}><img src=\"data:{mime};base64,{data}\" alt=\"{title}\"><figcaption>{title}. {} <code>{}</code></figcaption></figure>",
            escaped(explanation(&map.name)),
            map.name
        );
    }
    for view in &shown.perspectives {
        let data = STANDARD.encode(folder.read(view.file)?);
        let (caption, file) = (escaped(&view.caption), view.file);
        let _ = writeln!(
            html,
            "<figure><img src=\"data:image/png;base64,{data}\" alt=\"{caption}\"><figcaption>{caption}: {}. <code>{file}</code></figcaption></figure>",
            escaped(&results.subject)
        );
    }
    Ok(html)
}

/// What a plan shows, in a sentence.
fn explanation(name: &str) -> &'static str {
    let stem = name.split('.').next().unwrap_or(name);
    match stem {
        "difference" => "Where sun is lost and gained by what is proposed.",
        "profile_by_object" => "What each object puts in shadow at any time of the period.",
        _ if stem.starts_with("hours") => "How long the sun reaches each point of the ground in all.",
        _ if stem.starts_with("profile") => "Everything that is in shadow at any time, and for how much of it.",
        _ if stem.starts_with("day") => "The shadows of the day, moving.",
        _ => "",
    }
}

/// How much of the ground has at least so many hours.
fn area(results: &Results) -> String {
    let (Some((grid, range)), Some(state)) = (results.ground(), results.last()) else { return String::new() };
    let possible = results.possible_hours();
    let step = (possible / 10.0).ceil().max(1.0);
    let cell_m2 = grid.spacing * grid.spacing;
    let of_state = |state: &State| -> Vec<f64> { range.clone().filter_map(|r| state.hours(r)).collect() };
    let now = of_state(state);
    let before = (results.states.len() > 1).then(|| of_state(&results.states[0]));
    let mut html = "<h2>How much of the ground has sun</h2>\n<table><thead><tr><th class=\"n\">At least</th><th class=\"n\">Area</th>".to_owned();
    if before.is_some() {
        html += "<th class=\"n\">Before</th>";
    }
    html += "<th class=\"n\">Share</th><th></th></tr></thead><tbody>";
    for i in 0..=(possible / step + 1e-9).floor() as usize {
        let least = i as f64 * step;
        // Something is more than nothing.
        let has = |&&hours: &&f64| if i == 0 { hours > 0.0 } else { hours >= least - 1e-9 };
        let count = |hours: &[f64]| hours.iter().filter(has).count() as f64;
        let share = count(&now) / now.len().max(1) as f64;
        let label = if i == 0 { "any sun".to_owned() } else { format!("{least:.0} h") };
        let m2 = |count: f64| format!("{} m&sup2;", grouped((count * cell_m2).round() as u64));
        let _ = write!(html, "<tr><td class=\"n\">{label}</td><td class=\"n\">{}</td>", m2(count(&now)));
        if let Some(before) = &before {
            let _ = write!(html, "<td class=\"n\">{}</td>", m2(count(before)));
        }
        let percent = 100.0 * share;
        let _ = write!(
            html,
            "<td class=\"n\">{percent:.1} %</td><td class=\"bars\"><span class=\"bar\" style=\"width:{percent:.1}%\"></span></td></tr>"
        );
    }
    html += "</tbody></table>\n<p class=\"small\">Of the ground around and between the buildings that was studied; what is built on is left out.</p>\n";
    html
}

fn objects(results: &Results) -> String {
    let rows: Vec<ObjectRow> = rows(results).into_iter().filter(|row| row.part != "ground").collect();
    if rows.is_empty() {
        return String::new();
    }
    let has_before = rows.iter().any(|row| row.mean_before_h.is_some());
    let mut html = "<h2>Hours of sun by object</h2>\n<table><thead><tr><th>Object</th><th>Part</th><th class=\"n\">Area</th><th class=\"n\">Least</th><th class=\"n\">Mean</th><th class=\"n\">Most</th>".to_owned();
    if has_before {
        html += "<th class=\"n\">Mean before</th>";
    }
    html += "<th>First sun</th><th>Last sun</th></tr></thead><tbody>";
    let clock = |time: &Option<String>| {
        // Of one day, the day is known.
        let text = time.as_deref().unwrap_or("none");
        if results.timetable.days.len() == 1 {
            text.get(11..16).unwrap_or(text)
        } else {
            text.get(..16).unwrap_or(text)
        }
        .replace('T', " ")
    };
    for row in rows.iter().take(MOST_OBJECTS) {
        let area =
            if row.part == "points" { counted(row.receivers, "point") } else { format!("{:.0} m&sup2;", row.area) };
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{}</td><td class=\"n\">{area}</td><td class=\"n\">{:.2} h</td><td class=\"n\">{:.2} h</td><td class=\"n\">{:.2} h</td>",
            escaped(&row.object),
            row.part,
            row.least_h,
            row.mean_h,
            row.most_h
        );
        if has_before {
            let _ = write!(
                html,
                "<td class=\"n\">{}</td>",
                row.mean_before_h.map_or_else(String::new, |h| format!("{h:.2} h"))
            );
        }
        let _ = write!(html, "<td>{}</td><td>{}</td></tr>", clock(&row.first_sun), clock(&row.last_sun));
    }
    html += "</tbody></table>\n";
    if rows.len() > MOST_OBJECTS {
        let _ =
            writeln!(html, "<p class=\"small\">{} more in <code>objects.csv</code>.</p>", rows.len() - MOST_OBJECTS);
    }
    html
}

fn facts(results: &Results) -> String {
    let site = &results.site;
    let step_s = results.timetable.steps.first().map_or(0.0, Step::duration_s);
    let on: Vec<String> = results
        .receivers
        .groups
        .iter()
        .fold(Vec::<(&str, usize)>::new(), |mut kinds, group| {
            let on = super::receivers_csv::on(group);
            match kinds.iter_mut().find(|(kind, _)| *kind == on) {
                Some((_, count)) => *count += group.range.len(),
                None => kinds.push((on, group.range.len())),
            }
            kinds
        })
        .into_iter()
        .map(|(on, count)| format!("{} ({on})", grouped(count as u64)))
        .collect();
    let inside = results.last().map_or(0, |state| state.is_inside.iter().filter(|&&inside| inside).count());
    let system = results.frame.crs.as_ref();
    let mut facts = vec![
        ("Models", results.subject.clone()),
        ("Place", format!("{}, from {}", site.coordinates(), site.place_from)),
        (
            "Coordinates",
            system.map_or_else(
                || "the models' own, metres".to_owned(),
                |crs| format!("EPSG:{} ({})", crs.epsg(), crs.name()),
            ),
        ),
        ("True north", format!("{:.2}\u{b0} clockwise from the plans' vertical", site.north_deg)),
        ("Days", days_text(&results.timetable)),
        ("Hours of the day", hours_text(&results.timetable)),
        ("Clock", format!("{}, UTC{}", site.clock, offsets(&results.timetable).join(" and UTC"))),
        (
            "Step",
            format!(
                "{} min; each stands for its middle ({} with the sun up)",
                step_s / 60.0,
                counted(results.day_steps(), "step")
            ),
        ),
        ("Receivers", format!("{}; {} inside of solids are not counted", on.join(", "), grouped(inside as u64))),
        (
            "Casting",
            format!(
                "{} in {}",
                counted(results.models.scene.triangle_count(), "triangle"),
                counted(results.models.casters.len(), "object")
            ),
        ),
    ];
    if let Some((grid, _)) = results.ground() {
        facts.push(("Grid", format!("{} x {} points, every {} m", grid.columns, grid.rows, grid.spacing)));
    }
    if results.states.len() > 1 {
        facts.push(("Compared", "before: with what exists; after: with what is proposed".to_owned()));
    }
    facts.iter().map(|(name, value)| format!("<tr><th>{name}</th><td>{}</td></tr>", escaped(value))).collect()
}

fn suns(results: &Results) -> String {
    // Some of the disc may be up while its middle is not.
    let of_disc = results.disc.as_ref().map_or(results.suns.as_slice(), |disc| &disc.suns);
    let suns = results.suns.iter().zip(of_disc);
    let counts = suns.map(|(middle, disc)| middle.is_some() || disc.is_some());
    let days: Vec<&Step> = results.timetable.steps.iter().zip(counts).filter_map(|(s, c)| c.then_some(s)).collect();
    let every = days.len().div_ceil(MOST_SUNS).max(1);
    let mut html = "<table><thead><tr><th>Time</th><th>UTC offset</th><th class=\"n\">Azimuth</th><th class=\"n\">Altitude</th><th class=\"n\">Shadow of 1 m</th></tr></thead><tbody>".to_owned();
    for step in days.iter().step_by(every) {
        let time = on_clock(step.middle(), step.utc_offset_s).strftime("%Y-%m-%d %H:%M:%S").to_string();
        let shadow_m = 1.0 / step.sun.altitude_rad.tan().max(1e-6);
        let shadow = if step.is_day { format!("{shadow_m:.2} m") } else { "&ndash;".to_owned() };
        let [azimuth, altitude] = [step.sun.azimuth_rad, step.sun.altitude_rad].map(f64::to_degrees);
        let _ = write!(
            html,
            "<tr><td>{time}</td><td>{}</td><td class=\"n\">{azimuth:.2}&deg;</td><td class=\"n\">{altitude:.2}&deg;</td><td class=\"n\">{shadow}</td></tr>",
            offset_text(step.utc_offset_s),
        );
    }
    html += "</tbody></table>\n";
    if every > 1 {
        let _ = writeln!(
            html,
            "<p class=\"small\">Every {every}th of {}; all are in <code>bits.npz</code>.</p>",
            counted(days.len(), "step")
        );
    }
    html
}

fn method(results: &Results) -> String {
    let [largest_s, mean_s] = results.error_bounds_s();
    let sums = || results.states.iter().flat_map(|state| &state.sums).flatten();
    let undecided: u64 = sums().map(|sum| u64::from(sum.undecided)).sum();
    let verdicts = results.day_steps() as u64 * sums().count() as u64;
    let margin_mm = results.margin_m * 1000.0;
    let how = if results.disc.is_some() {
        "Between two of its looks at the sun the share of the disc is taken to be between theirs: that leaves half the time between them, times by how much they differ."
    } else if results.refinement.is_some() {
        "The sun was also looked for every minute, and where it turns to shadow or back between two minutes, the moment was found to a quarter of a second by rays."
    } else {
        "Where sun turns to shadow or back between two steps, the moment is known to half a step either way."
    };
    let sums = if results.disc.is_some() {
        "Hours are sums of steps, each times the share of the sun's disc that is seen in its middle (see below)."
    } else {
        "Hours are sums of steps."
    };
    let mut html = format!(
        "<p>For every receiver and every step it was decided whether anything of the models stands between it and the middle of the sun: \
         {} verdicts, each by the exact geometry of the triangles, not by pixels of a shadow map. A verdict holds for the whole step. \
         {sums}</p>\n\
         <p><b>Error bound.</b> {how} Summed over all such changes, the hours \
         of no point are off by more than {} ({} on average), provided that no sun or shade shorter than {} was missed. \
         What the models themselves have wrong, and what they lack (trees, balconies, new neighbours), is not in this bound.</p>\n\
         <p><b>Undecided.</b> {} verdicts are of receivers within {margin_mm:.2} mm of the edge of a shadow; they are given as computed, and counted \
         for each receiver in <code>receivers.csv</code>.</p>\n",
        grouped(verdicts),
        duration_text(largest_s),
        duration_text(mean_s),
        results.shortest_seen(),
        grouped(undecided),
    );
    if let Some(check) = results.check {
        let _ = writeln!(
            html,
            "<p><b>Check.</b> {} were decided once more, one ray each in double precision, by a method that shares nothing with the first: \
             <b>{}</b> of {} verdicts differ; {} more differ at edges of shadows.</p>",
            counted(check.receivers, "receiver"),
            grouped(check.disagreements),
            grouped(check.verdicts),
            grouped(check.undecided),
        );
    }
    if let Some(disc) = results.check.and_then(|check| check.disc) {
        let _ = writeln!(
            html,
            "<p><b>Check of the disc.</b> {} shares, {} of them neither nothing nor all, were estimated by 256 rays each to places all over the disc, and those that seemed to differ by 4,096: \
             <b>{}</b> differ by more than chance explains, {} more of receivers in the plane of a face or at its edge, and all together by {:+.4} of the disc on average.</p>",
            grouped(disc.shares),
            grouped(disc.partial),
            grouped(disc.disagreements),
            grouped(disc.undecided),
            disc.mean_difference(),
        );
    }
    html += "<p><b>The sun</b> is where NREL's solar position algorithm has it, to 0.0003 degrees. ";
    html += if results.disc.is_some() { DISC } else { POINT };
    html
}

fn warnings(results: &Results) -> String {
    if results.warnings.is_empty() {
        return String::new();
    }
    let items: String = results.warnings.iter().map(|warning| format!("<li>{}</li>", escaped(warning))).collect();
    format!("<h2>Warnings</h2>\n<ul>{items}</ul>\n")
}

fn files(folder: &Folder) -> String {
    let row = |name: &str| format!("<tr><td><code>{name}</code></td><td>{}</td></tr>", content(name));
    folder.names().into_iter().chain(["run.json"]).map(row).collect()
}

fn content(name: &str) -> &'static str {
    match name.rsplit_once('.').unwrap_or((name, "")) {
        ("difference", "tif") => "Hours of sun after less before: a grid of 32-bit floats for GIS",
        (_, "tif") => "Hours of sun: a grid of 32-bit floats for GIS, with all parameters in its tags",
        ("receivers", "csv") => "Each receiver with its hours, first and last sun, in the models' coordinates",
        ("objects", "csv") => "Hours of sun of each object's roofs, and of its walls by the side that they face",
        (stem, "npz") if stem.starts_with("fractions") => {
            "The share of the sun's disc that is seen, for each receiver and step, in 255ths, for numpy"
        }
        (_, "npz") => "Every verdict as a bit, for numpy: hours of any window can be summed again",
        (_, "geojson") => "The exact outlines of shadows on the level of the ground, for each step and object",
        ("run", "json") => "What was done with what, and how long it took",
        (_, "apng") => "The shadows of a day, moving",
        ("perspective", "png") => "The models and their shadows at one moment",
        ("perspective_profile", "png") => "The models and their shadows over the period, laid over each other",
        (_, "png") => "A plan of this report",
        _ => "",
    }
}

fn inputs(results: &Results) -> String {
    let row = |input: &crate::study::results::Input| {
        let path = escaped(&input.path.display().to_string());
        format!(
            "<tr><td>{path} ({})</td><td class=\"n\">{}</td><td><code>{}</code></td></tr>",
            input.role,
            grouped(input.bytes),
            input.sha256
        )
    };
    results.inputs.iter().map(row).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_filled_once_and_what_is_put_in_is_left_alone() {
        let html = fill(&[("subject", "{{period}} & co".to_owned()), ("period", "today".to_owned())]);
        assert!(html.contains("{{period}} & co"), "a name in a model's name is no name of ours");
        assert!(html.contains("<br>today"));
        assert!(!html.contains("{{banner}}"));
    }
}
