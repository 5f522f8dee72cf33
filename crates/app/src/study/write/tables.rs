//! Hours for each object: of its roofs, and of its walls by the side that they face.

use std::collections::BTreeMap;

use umbrae_core::SurfaceKind;
use umbrae_study::{GroupKind, Step};

use super::receivers_csv::on;
use crate::study::folder::Folder;
use crate::study::results::Results;
use crate::study::site::{iso, offset_at};

/// One row: some receivers of an object.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ObjectRow {
    pub(super) object: String,
    /// "ground", "roof", "wall facing south".
    pub(super) part: String,
    pub(super) receivers: usize,
    /// Square metres; for points, how many.
    pub(super) area: f64,
    pub(super) least_h: f64,
    /// By area.
    pub(super) mean_h: f64,
    pub(super) most_h: f64,
    /// The mean before, where there is a before.
    pub(super) mean_before_h: Option<f64>,
    pub(super) first_sun: Option<String>,
    pub(super) last_sun: Option<String>,
}

/// Sums on the way to a row.
#[derive(Debug, Clone, Default)]
struct Sums {
    receivers: usize,
    area: f64,
    hours: f64,
    before: f64,
    least: Option<f64>,
    most: f64,
    first_last: Option<[jiff::Timestamp; 2]>,
}

/// The rows, by object and part; receivers without a value are left out.
pub(super) fn rows(results: &Results) -> Vec<ObjectRow> {
    let Some(state) = results.last() else { return Vec::new() };
    let before = (results.states.len() > 1).then(|| &results.states[0]);
    let mut sums: BTreeMap<(String, String), Sums> = BTreeMap::new();
    for group in &results.receivers.groups {
        for (i, receiver) in group.range.clone().enumerate() {
            let Some(sum) = state.sums[receiver] else { continue };
            let then = before.map(|before| before.hours(receiver));
            if then == Some(None) {
                continue;
            }
            let (part, area) = match &group.kind {
                GroupKind::Ground(grid) => ("ground".to_owned(), grid.spacing * grid.spacing),
                GroupKind::Points { .. } => ("points".to_owned(), 1.0),
                GroupKind::Surface { surface: SurfaceKind::Wall, areas, .. } => {
                    let side = side(results.receivers.normals[receiver], results.site.north_deg);
                    (format!("wall facing {side}"), f64::from(areas[i]))
                }
                GroupKind::Surface { areas, .. } => (on(group).to_owned(), f64::from(areas[i])),
            };
            let row = sums.entry((group.name.clone(), part)).or_default();
            row.receivers += 1;
            row.area += area;
            row.hours += area * sum.hours();
            row.before += area * then.flatten().unwrap_or(0.0);
            row.least = Some(row.least.map_or(sum.hours(), |least| least.min(sum.hours())));
            row.most = row.most.max(sum.hours());
            row.first_last = match (row.first_last, sum.first_last) {
                (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
                (one, other) => one.or(other),
            };
        }
    }
    let steps = &results.timetable.steps;
    sums.into_iter().map(|((object, part), sums)| sums.row(object, part, before.is_some(), steps)).collect()
}

impl Sums {
    fn row(self, object: String, part: String, has_before: bool, steps: &[Step]) -> ObjectRow {
        let area = self.area.max(f64::MIN_POSITIVE);
        let [first_sun, last_sun] = match self.first_last {
            Some(times) => times.map(|time| Some(iso(time, offset_at(steps, time)))),
            None => [None, None],
        };
        ObjectRow {
            object,
            part,
            receivers: self.receivers,
            area: self.area,
            least_h: self.least.unwrap_or(0.0),
            mean_h: self.hours / area,
            most_h: self.most,
            mean_before_h: has_before.then_some(self.before / area),
            first_sun,
            last_sun,
        }
    }
}

/// The side of the compass that a wall faces, by true north.
fn side(normal: glam::Vec3, north_deg: f64) -> &'static str {
    let azimuth_deg = f64::from(normal.x).atan2(f64::from(normal.y)).to_degrees() - north_deg;
    ["north", "east", "south", "west"][((azimuth_deg + 45.0).rem_euclid(360.0) / 90.0) as usize % 4]
}

/// Writes `objects.csv`.
pub(super) fn write(results: &Results, folder: &mut Folder) -> anyhow::Result<()> {
    let rows = rows(results);
    folder.write("objects.csv", |file| {
        let mut table = csv::Writer::from_writer(file);
        table.write_record([
            "object",
            "part",
            "receivers",
            "area_m2",
            "least_hours",
            "mean_hours",
            "most_hours",
            "mean_hours_before",
            "first_sun",
            "last_sun",
        ])?;
        for row in rows {
            table.write_record([
                row.object,
                row.part,
                row.receivers.to_string(),
                format!("{:.2}", row.area),
                format!("{:.4}", row.least_h),
                format!("{:.4}", row.mean_h),
                format!("{:.4}", row.most_h),
                row.mean_before_h.map_or_else(String::new, |hours| format!("{hours:.4}")),
                row.first_sun.unwrap_or_default(),
                row.last_sun.unwrap_or_default(),
            ])?;
        }
        Ok(table.flush()?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn walls_face_the_nearest_side_of_the_compass_by_true_north() {
        assert_eq!([Vec3::Y, Vec3::X, -Vec3::Y, -Vec3::X].map(|n| side(n, 0.0)), ["north", "east", "south", "west"]);
        // A wall that faces 40 degrees on paper faces 50 where true north is 10 degrees to the left.
        let normal = Vec3::new(40_f32.to_radians().sin(), 40_f32.to_radians().cos(), 0.0);
        assert_eq!((side(normal, 0.0), side(normal, -10.0)), ("north", "east"));
    }
}
