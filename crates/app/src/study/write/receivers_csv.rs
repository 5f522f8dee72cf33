//! `receivers.csv`: a row for each receiver, in the model's own coordinates.

use jiff::Timestamp;
use rustc_hash::FxHashMap;
use umbrae_core::SurfaceKind;
use umbrae_study::{Group, GroupKind};

use crate::study::folder::Folder;
use crate::study::results::Results;
use crate::study::site::{iso, offset_at};

/// Writes it.
pub(super) fn write(results: &Results, folder: &mut Folder) -> anyhow::Result<()> {
    let Some(last) = results.last() else { return Ok(()) };
    let before = results.states.split_last().and_then(|(_, before)| before.last());
    folder.write("receivers.csv", |file| {
        let mut table = csv::Writer::from_writer(file);
        let mut header = vec![
            "id",
            "x",
            "y",
            "z",
            "hours",
            "first_sun",
            "last_sun",
            "undecided_steps",
            "error_s",
            "longest_hours",
            "on",
            "object",
            "note",
        ];
        if before.is_some() {
            header.extend(["hours_before", "difference"]);
        }
        table.write_record(&header)?;
        let mut clock = Clock { results, texts: FxHashMap::default() };
        for group in &results.receivers.groups {
            for (i, receiver) in group.range.clone().enumerate() {
                let id = match &group.kind {
                    GroupKind::Points { names } => names[i].clone(),
                    _ => receiver.to_string(),
                };
                let place = results.frame.to_model(results.receivers.positions[receiver]);
                let sum = last.sums[receiver];
                let hours = |hours: Option<f64>| hours.map_or_else(String::new, |hours| (hours as f32).to_string());
                let first_last = sum.and_then(|sum| sum.first_last).map(|times| times.map(|time| clock.text(time)));
                let [first, latest] = first_last.unwrap_or_default();
                let mut row = vec![
                    id,
                    format!("{:.3}", place.x),
                    format!("{:.3}", place.y),
                    format!("{:.3}", place.z),
                    hours(last.hours(receiver)),
                    first,
                    latest,
                    sum.map_or_else(String::new, |sum| sum.undecided.to_string()),
                    sum.map_or_else(String::new, |sum| sum.error_s.to_string()),
                    sum.map_or_else(String::new, |sum| sum.longest_hours().to_string()),
                    on(group).to_owned(),
                    group.name.clone(),
                    if last.is_inside[receiver] {
                        "inside a solid"
                    } else if sum.is_none() {
                        "not computed"
                    } else {
                        ""
                    }
                    .to_owned(),
                ];
                if let Some(before) = before {
                    let then = before.hours(receiver);
                    let difference = then.zip(last.hours(receiver)).map(|(then, now)| now - then);
                    row.extend([hours(then), hours(difference)]);
                }
                table.write_record(&row)?;
            }
        }
        Ok(table.flush()?)
    })
}

/// What a group of receivers is on, as a word.
pub(super) fn on(group: &Group) -> &'static str {
    match group.kind {
        GroupKind::Ground(_) => "ground",
        GroupKind::Surface { surface, .. } => match surface {
            SurfaceKind::Roof => "roof",
            SurfaceKind::Wall => "wall",
            SurfaceKind::Base => "base",
            SurfaceKind::Terrain => "terrain",
            SurfaceKind::Unknown => "surface",
        },
        GroupKind::Points { .. } => "point",
    }
}

/// Moments as texts: there are few, and each is at many receivers.
struct Clock<'a> {
    results: &'a Results,
    texts: FxHashMap<Timestamp, String>,
}

impl Clock<'_> {
    fn text(&mut self, time: Timestamp) -> String {
        let of_steps = || iso(time, offset_at(&self.results.timetable.steps, time));
        self.texts.entry(time).or_insert_with(of_steps).clone()
    }
}
