//! The sun's days as JSON.

use serde::Serialize;
use umbrae_study::{ClockKind, DayKind, Zone};

use super::almanac::{Almanac, Day, Seen};

#[derive(Debug, Serialize)]
struct ReportJson<'a> {
    /// Degrees, north and east positive.
    latitude: f64,
    longitude: f64,
    clock: &'static str,
    zone: &'a str,
    /// Whether it was found from the place and not given.
    zone_is_derived: bool,
    zone_rules: &'static str,
    method: &'static str,
    accuracy_degrees: f64,
    angles: &'static str,
    min_altitude_degrees: f64,
    notes: &'a [String],
    days: Vec<DayJson>,
}

#[derive(Debug, Serialize)]
struct DayJson {
    date: String,
    utc_offset: String,
    start_utc: String,
    end_utc: String,
    kind: &'static str,
    sunrises: Vec<SeenJson>,
    transits: Vec<SeenJson>,
    sunsets: Vec<SeenJson>,
    day_length_s: f64,
    rows: Vec<SeenJson>,
}

#[derive(Debug, Serialize)]
struct SeenJson {
    /// With the clock's offset from UTC.
    local: String,
    utc: String,
    utc_offset_s: i32,
    /// Degrees clockwise from true north.
    azimuth: f64,
    /// Degrees above the horizon.
    altitude: f64,
    /// Whether the sun is high enough to count.
    counts: bool,
}

/// All that the table has.
pub(super) fn json(almanac: &Almanac) -> anyhow::Result<String> {
    let days: Result<Vec<DayJson>, _> = almanac.days.iter().map(|day| day_json(almanac, day)).collect();
    let report = ReportJson {
        latitude: almanac.place.latitude_deg(),
        longitude: almanac.place.longitude_deg(),
        clock: match almanac.clock.kind {
            ClockKind::Civil => "civil",
            ClockKind::Solar => "true solar time",
        },
        zone: almanac.clock.zone.name(),
        zone_is_derived: almanac.clock.zone.is_derived(),
        zone_rules: Zone::database_version(),
        method: "NREL solar position algorithm; rise and set of the upper limb at 50' below a level horizon",
        accuracy_degrees: 0.0003,
        angles: almanac.air(),
        min_altitude_degrees: almanac.options.min_altitude_rad.to_degrees(),
        notes: &almanac.notes,
        days: days?,
    };
    Ok(format!("{}\n", serde_json::to_string_pretty(&report)?))
}

fn day_json(almanac: &Almanac, day: &Day) -> anyhow::Result<DayJson> {
    let all = |times: &[jiff::Timestamp]| -> anyhow::Result<Vec<SeenJson>> {
        times.iter().map(|&time| Ok(seen_json(almanac, &almanac.seen(time)?))).collect()
    };
    Ok(DayJson {
        date: day.local.date.to_string(),
        utc_offset: day.offsets.clone(),
        start_utc: day.local.start.to_string(),
        end_utc: day.local.end.to_string(),
        kind: match day.sun.kind() {
            DayKind::RisesOrSets => "rises or sets",
            DayKind::PolarDay => "polar day",
            DayKind::PolarNight => "polar night",
        },
        sunrises: all(&day.sun.rises)?,
        transits: all(&day.sun.transits)?,
        sunsets: all(&day.sun.sets)?,
        day_length_s: day.sun.day_length_s(),
        rows: day.rows.iter().map(|row| seen_json(almanac, row)).collect(),
    })
}

fn seen_json(almanac: &Almanac, seen: &Seen) -> SeenJson {
    SeenJson {
        local: format!("{}{}", seen.local(), super::almanac::offset_text(seen.utc_offset_s)),
        utc: seen.time.to_string(),
        utc_offset_s: seen.utc_offset_s,
        azimuth: seen.sun.azimuth_rad.to_degrees(),
        altitude: seen.sun.altitude_rad.to_degrees(),
        counts: seen.sun.counts(&almanac.options),
    }
}
