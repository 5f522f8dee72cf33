//! What stands beside the diagram of the sun: which line is which day, and how it all is meant.

use std::fmt::Write as _;

use jiff::Timestamp;
use umbrae_study::{ClockKind, DayKind, TimeError};

use super::almanac::{Almanac, offset_text};
use super::diagram::{HEIGHT, Style, Way, badge, noon};

/// Its left edge.
const LEFT: f64 = 826.0;
/// Beside a line's sample.
const TEXT_LEFT: f64 = LEFT + 56.0;
const LINE_PX: f64 = 19.0;

/// Writes the title and the legend.
pub(super) fn legend(almanac: &Almanac, ways: &[Way], svg: &mut String) -> Result<(), TimeError> {
    // Writing to a string does not fail.
    let _ = writeln!(
        svg,
        "<text x=\"24\" y=\"36\" font-size=\"22\" font-weight=\"bold\">The sun at {}</text>",
        almanac.place_text()
    );
    let mut y = 60.0;
    let asked_first = ways.iter().filter(|way| matches!(way.style, Style::Asked(..)));
    let seasons_then = ways.iter().filter(|way| matches!(way.style, Style::Season(_)));
    for way in asked_first.chain(seasons_then) {
        let _ = writeln!(svg, "<path d=\"M{LEFT} {0}H{1}\" {2}/>", y - 5.0, LEFT + 44.0, way.style.stroke());
        if let Style::Asked(color, letter) = way.style {
            badge(svg, [LEFT + 22.0, y - 5.0], color, letter);
        }
        line(svg, TEXT_LEFT, y, "14", &format!("<tspan font-weight=\"bold\">{}</tspan>", way.name));
        for words in events(almanac, way)? {
            y += LINE_PX;
            line(svg, TEXT_LEFT, y, "13", &words);
        }
        y += LINE_PX * 1.6;
    }
    let left_out = almanac.days.len() - ways.iter().filter(|way| matches!(way.style, Style::Asked(..))).count();
    if left_out > 0 {
        line(svg, LEFT, y, "13", &format!("{left_out} dates between these are not drawn"));
    }
    let notes = notes(almanac);
    let mut y = HEIGHT - 20.0 - LINE_PX * 0.85 * (notes.len() as f64 - 1.0);
    for note in &notes {
        line(svg, LEFT, y, "12", note);
        y += LINE_PX * 0.85;
    }
    Ok(())
}

fn line(svg: &mut String, x: f64, y: f64, size: &str, words: &str) {
    let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"#202020\">{words}</text>");
}

/// When the sun of a way is up, in two lines or one.
fn events(almanac: &Almanac, way: &Way) -> Result<Vec<String>, TimeError> {
    let day = &way.day;
    let offset = format!("UTC{}", day.offsets);
    let shown = |time: Timestamp| Ok(almanac.seen(time)?.minutes_text(day.local.date));
    let up = match day.sun.kind() {
        DayKind::PolarDay => "polar day: it does not set".to_owned(),
        DayKind::PolarNight => "polar night: it does not rise".to_owned(),
        DayKind::RisesOrSets => {
            let spans: Result<Vec<String>, TimeError> =
                day.sun.up().iter().map(|[from, to]| Ok(format!("{} to {}", shown(*from)?, shown(*to)?))).collect();
            format!("{}, {offset}", spans?.join(" and "))
        }
    };
    let mut lines = vec![up];
    if let Some(&transit) = day.sun.transits.first().filter(|_| day.sun.kind() != DayKind::PolarNight) {
        let altitude = almanac.seen(transit)?.sun.altitude_rad.to_degrees();
        let minutes = (day.sun.day_length_s() / 60.0).round() as u32;
        let length = format!("{} h {:02} min", minutes / 60, minutes % 60);
        lines.push(format!("highest {altitude:.1}° at {}; {length} up", shown(transit)?));
    }
    Ok(lines)
}

/// How it all is meant, from the top down.
fn notes(almanac: &Almanac) -> Vec<String> {
    let first = almanac.days.first();
    let hours = match (almanac.clock.kind, first) {
        (ClockKind::Solar, _) | (_, None) => "Grey lines: hours of true solar time".to_owned(),
        (ClockKind::Civil, Some(first)) => {
            let offset = almanac.clock.zone.offset_at(noon(first)).seconds();
            format!("Grey lines: hours of UTC{} over the year", offset_text(offset))
        }
    };
    let mut notes = vec![
        "Top view of the sky, true north up; rings: degrees above".to_owned(),
        "the horizon (outside: 0°), stereographic projection".to_owned(),
        hours,
        "Dots: full hours of the date's own clock".to_owned(),
    ];
    let zone = almanac.clock.zone.name();
    let source = if almanac.clock.zone.is_derived() { "found from the place" } else { "as asked for" };
    notes.push(match almanac.clock.kind {
        ClockKind::Civil => format!("Clocks of {zone} ({source})"),
        ClockKind::Solar => format!("Calendar of {zone} ({source})"),
    });
    let least = almanac.options.min_altitude_rad.to_degrees();
    if least > 0.0 {
        notes.push(format!("Dashed red ring: below {least}° the sun does not count"));
    }
    notes.push("Rise and set of the upper edge, on a level horizon".to_owned());
    let air = almanac.air().replace("the sun's middle ", "The sun's middle ");
    let (head, tail) = air.split_at(air.find(" (").or_else(|| air.find(", ")).unwrap_or(air.len()));
    notes.push(format!("{head}{}", if tail.is_empty() { "" } else { "," }).replace(",,", ","));
    notes.push(tail.trim_start_matches([' ', ',']).trim_matches(['(', ')']).to_owned());
    notes.push(format!("NREL's solar position algorithm; umbrae {}", env!("CARGO_PKG_VERSION")));
    notes
}
