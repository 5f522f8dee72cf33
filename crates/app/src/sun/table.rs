//! The sun's days as text.

use std::fmt::Write as _;

use jiff::Timestamp;
use umbrae_study::{DayKind, TimeError, Zone};

use super::almanac::{Almanac, Day, offset_text};

/// All days, each with its rise, its highest point and its set, and a line for each row.
pub(super) fn text(almanac: &Almanac) -> Result<String, TimeError> {
    let mut text = format!(
        "{}; {}, time zone rules {}\n{}; by NREL's solar position algorithm, within 0.0003°\n",
        almanac.place_text(),
        almanac.clock_text(),
        Zone::database_version(),
        almanac.air()
    );
    for day in &almanac.days {
        let date = day.local.date;
        // Writing to a string does not fail.
        let _ = write!(text, "\n{date}, {}, UTC{}\n", date.strftime("%A"), day.offsets);
        for line in events(almanac, day)? {
            let _ = writeln!(text, "{line}");
        }
        if day.rows.is_empty() {
            continue;
        }
        let width = day.rows.iter().map(|row| 8 + offset_text(row.utc_offset_s).len()).max().unwrap_or_default();
        let _ = writeln!(text, "{:width$}   azimuth  altitude", "time");
        for row in &day.rows {
            let time = format!("{}{}", row.clock_text(date), offset_text(row.utc_offset_s));
            let [azimuth, altitude] = angles_deg(row.sun);
            let _ = writeln!(text, "{time:width$}  {azimuth:8.4}  {altitude:8.4}");
        }
    }
    Ok(text)
}

/// Degrees, the azimuth so that it never rounds up to 360.
fn angles_deg(sun: umbrae_study::Sun) -> [f64; 2] {
    let azimuth = sun.azimuth_rad.to_degrees();
    [if azimuth >= 359.999_95 { 0.0 } else { azimuth }, sun.altitude_rad.to_degrees()]
}

/// A sentence for each thing that the sun does, in order.
fn events(almanac: &Almanac, day: &Day) -> Result<Vec<String>, TimeError> {
    let mut events: Vec<(Timestamp, String)> = Vec::new();
    let of = |times: &[Timestamp], name: &str| {
        let lines = times.iter().map(|&time| {
            let seen = almanac.seen(time)?;
            let [azimuth, altitude] = angles_deg(seen.sun);
            let at =
                if name == "transit" { format!("altitude {altitude:.4}") } else { format!("azimuth {azimuth:.4}") };
            Ok((time, format!("{name:8} {}  {at}", seen.clock_text(day.local.date))))
        });
        lines.collect::<Result<Vec<_>, TimeError>>()
    };
    events.extend(of(&day.sun.rises, "sunrise")?);
    events.extend(of(&day.sun.transits, "transit")?);
    events.extend(of(&day.sun.sets, "sunset")?);
    events.sort_by_key(|(time, _)| *time);
    let mut lines: Vec<String> = events.into_iter().map(|(_, line)| line).collect();
    lines.push(match day.sun.kind() {
        DayKind::PolarDay => "polar day: the sun does not set".to_owned(),
        DayKind::PolarNight => "polar night: the sun does not rise".to_owned(),
        DayKind::RisesOrSets => format!("the sun is up for {}", duration_text(day.sun.day_length_s())),
    });
    Ok(lines)
}

/// `12 h 18 min 47 s`.
fn duration_text(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    format!("{} h {:02} min {:02} s", seconds / 3600, seconds / 60 % 60, seconds % 60)
}
