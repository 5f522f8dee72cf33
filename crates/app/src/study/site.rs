//! The place and the clock of a study, as results name them.

use jiff::tz::{Offset, TimeZone};
use jiff::{Timestamp, Zoned};
use umbrae_study::{Place, Step, SunOptions, Timetable, Zone};

/// Where and by which clock.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Site {
    pub(crate) place: Place,
    pub(crate) zone: Zone,
    pub(crate) options: SunOptions,
    /// Where the place is from: "--lat and --lon", "the model's coordinate reference system".
    pub(crate) place_from: &'static str,
    /// "Europe/Vienna", "true solar time".
    pub(crate) clock: String,
    /// Where true north is in the scene: clockwise from the y axis, degrees.
    pub(crate) north_deg: f64,
    /// "apparent (standard refraction)" or "geometric (no refraction)".
    pub(crate) sun: &'static str,
}

/// `time` on a clock that is `utc_offset_s` ahead of UTC.
pub(crate) fn on_clock(time: Timestamp, utc_offset_s: i32) -> Zoned {
    time.to_zoned(TimeZone::fixed(Offset::from_seconds(utc_offset_s).unwrap_or(Offset::UTC)))
}

/// `2026-09-18T09:00:00+02:00`.
pub(crate) fn iso(time: Timestamp, utc_offset_s: i32) -> String {
    let zoned = on_clock(time, utc_offset_s);
    if utc_offset_s % 60 == 0 {
        zoned.strftime("%Y-%m-%dT%H:%M:%S%:z").to_string()
    } else {
        zoned.strftime("%Y-%m-%dT%H:%M:%S%::z").to_string()
    }
}

/// `+02:00`.
pub(crate) fn offset_text(utc_offset_s: i32) -> String {
    let sign = if utc_offset_s < 0 { '-' } else { '+' };
    let s = utc_offset_s.unsigned_abs();
    let seconds = if s.is_multiple_of(60) { String::new() } else { format!(":{:02}", s % 60) };
    format!("{sign}{:02}:{:02}{seconds}", s / 3600, s / 60 % 60)
}

/// All offsets that occur, in order of time: `+01:00, +02:00`.
pub(crate) fn offsets(timetable: &Timetable) -> Vec<String> {
    let mut offsets: Vec<i32> = timetable.steps.iter().map(|step| step.utc_offset_s).collect();
    offsets.dedup();
    let mut texts: Vec<String> = Vec::new();
    for text in offsets.into_iter().map(offset_text) {
        if !texts.contains(&text) {
            texts.push(text);
        }
    }
    texts
}

/// The offset of the step that holds `time`, or of the nearest.
pub(crate) fn offset_at(steps: &[Step], time: Timestamp) -> i32 {
    let after = steps.partition_point(|step| step.start <= time);
    // An end of a step belongs to it, and not to a gap that follows.
    let step = after.checked_sub(1).or_else(|| (!steps.is_empty()).then_some(0));
    step.map_or(0, |i| steps[i].utc_offset_s)
}

impl Site {
    /// `48.2000 N, 16.3700 E`.
    pub(crate) fn coordinates(&self) -> String {
        let [lat, lon] = [self.place.latitude_deg(), self.place.longitude_deg()];
        let (ns, ew) = (if lat < 0.0 { 'S' } else { 'N' }, if lon < 0.0 { 'W' } else { 'E' });
        format!("{:.4}\u{b0} {ns}, {:.4}\u{b0} {ew}", lat.abs(), lon.abs())
    }
}

/// `18 September 2026`, or `1 February 2026 to 21 March 2026 (49 days)`, or days that are apart one by one.
pub(crate) fn days_text(timetable: &Timetable) -> String {
    let text = |date: &jiff::civil::Date| date.strftime("%-d %B %Y").to_string();
    match timetable.days.as_slice() {
        [] => "no day".to_owned(),
        [one] => text(one),
        [first, .., last] => {
            let is_run = timetable.days.windows(2).all(|pair| pair[0].tomorrow().ok() == Some(pair[1]));
            let count = timetable.days.len();
            if is_run {
                format!("{} to {} ({count} days)", text(first), text(last))
            } else if count <= 4 {
                timetable.days.iter().map(text).collect::<Vec<_>>().join(", ")
            } else {
                format!("{count} days from {} to {}", text(first), text(last))
            }
        }
    }
}

/// `09:00 to 17:00`: from the earliest step of any day to the latest.
pub(crate) fn hours_text(timetable: &Timetable) -> String {
    let seconds = |time: Timestamp, step: &Step, day_end: bool| {
        let time = on_clock(time, step.utc_offset_s).time();
        let s = i64::from(time.hour()) * 3600 + i64::from(time.minute()) * 60 + i64::from(time.second());
        if day_end && s == 0 { 86_400 } else { s }
    };
    let first = timetable.steps.iter().map(|step| seconds(step.start, step, false)).min();
    let last = timetable.steps.iter().map(|step| seconds(step.end, step, true)).max();
    let text = |s: i64| {
        if s % 60 == 0 {
            format!("{:02}:{:02}", s / 3600, s / 60 % 60)
        } else {
            format!("{:02}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
        }
    };
    first.zip(last).map_or_else(|| "no time".to_owned(), |(first, last)| format!("{} to {}", text(first), text(last)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_have_a_sign_and_seconds_only_where_they_must() {
        assert_eq!([7200, -12_600, 0, 3929].map(offset_text), ["+02:00", "-03:30", "+00:00", "+01:05:29"]);
        let time = Timestamp::from_second(1_789_714_800).expect("a time");
        assert_eq!(iso(time, 7200), "2026-09-18T09:00:00+02:00");
        assert_eq!(iso(time, 3929), "2026-09-18T08:05:29+01:05:29");
    }
}
