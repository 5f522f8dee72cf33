//! Where receivers stand: what was asked, and a good answer to what was left unsaid.

use anyhow::{bail, ensure};
use glam::{DVec2, DVec3};
use umbrae_core::{Bounds, SurfaceKind};
use umbrae_study::{GroundGrid, GroupKind, LIFT_M, Receivers};

use super::points;
use super::scene::{Models, Situation, When};
use crate::cli::{On, StudyArgs};

/// About so many points of a grid are computed in seconds, and make a sharp picture.
const USUAL_CELLS: f64 = 120_000.0;
/// Beyond, files are of no use to anyone.
const MOST_CELLS: f64 = 400e6;
/// A shadow is followed for so many heights of what casts it when the ground to study is chosen…
const FOLLOWED_HEIGHTS: f64 = 2.0;
/// Points further from the models than this, and than so many of their sizes, are in other coordinates.
const FAR_M: f64 = 5000.0;
const FAR_SIZES: f64 = 5.0;
/// …and around everything so many metres are left.
const MARGIN_M: f64 = 5.0;

/// Receivers as `args` ask for them, for `situations` of `models`, under `suns`; and what was chosen.
///
/// # Errors
///
/// When the file of points can't be read, or there is no receiver at all.
pub(super) fn receivers(
    args: &StudyArgs,
    models: &Models,
    situations: &[Situation],
    suns: &[Option<DVec3>],
) -> anyhow::Result<(Receivers, Vec<String>)> {
    let Some(situation) = situations.last() else { return Ok(Default::default()) };
    let mut receivers = Receivers::default();
    let mut said = Vec::new();
    let on = if args.on.is_empty() && args.points.is_none() { &[On::Ground][..] } else { &args.on };
    let area = studied_area(models, suns);
    let spacing = args.spacing.unwrap_or_else(|| usual_spacing(&area));
    if on.contains(&On::Ground) {
        let (min, max) = (area.min.truncate(), area.max.truncate());
        let cells = ((max - min) / spacing).ceil().element_product();
        ensure!(
            cells <= MOST_CELLS,
            "a grid every {spacing} m has {cells:.1e} points; give a --spacing of {} or more",
            nice_above(((max - min).element_product() / MOST_CELLS).sqrt())
        );
        let grid = GroundGrid::covering(min, max, spacing, models.ground_level() + LIFT_M);
        if args.spacing.is_none() {
            said.push(format!("a grid of {} x {} points, every {spacing} m (--spacing)", grid.columns, grid.rows));
        }
        receivers.add_ground(grid, &situation.terrain, &situation.solids);
    }
    let surfaces = [(On::Roof, SurfaceKind::Roof), (On::Wall, SurfaceKind::Wall)];
    for &object in &situation.objects {
        // Surfaces that come or go have no sun to compare, unless there is nothing else.
        let is_compared = models.when[object] == When::Always || !models.when.contains(&When::Always);
        for (_, surface) in surfaces.iter().filter(|(name, _)| is_compared && on.contains(name)) {
            let (caster, kinds) = (&models.casters[object], &models.kinds[object]);
            receivers.add_surfaces(object, caster, kinds, *surface, spacing, &situation.solids);
        }
    }
    if let Some(path) = &args.points {
        let (name, points) = points::read(path, models.scene.origin)?;
        let bounds = models.bounds();
        let away = |p: DVec3| (p - p.clamp(bounds.min, bounds.max)).length();
        let farthest = points.iter().max_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        if let Some((id, point, _)) =
            farthest.filter(|point| away(point.1) > FAR_M + FAR_SIZES * bounds.size().length())
        {
            let [low, high, at] = [bounds.min, bounds.max, *point].map(|p| p + models.scene.origin);
            bail!(
                "can't use the points in `{}`: point `{id}` at {:.1}, {:.1} is {:.0} km from the models, which lie between {:.1}, {:.1} and {:.1}, {:.1}; \
                 points are in the models' coordinates, not in longitude and latitude",
                path.display(),
                at.x,
                at.y,
                away(*point) / 1000.0,
                low.x,
                low.y,
                high.x,
                high.y
            );
        }
        receivers.add_points(name, points, &situation.solids);
    }
    let asked = on.iter().map(|on| on.name()).collect::<Vec<_>>().join(", ");
    ensure!(
        !receivers.is_empty(),
        "there is nothing to receive sun on: the models have no surface of the kind {asked}"
    );
    Ok((receivers, said))
}

/// The grid on the ground, if there is one.
pub(crate) fn ground(receivers: &Receivers) -> Option<(GroundGrid, std::ops::Range<usize>)> {
    receivers.groups.iter().find_map(|group| match group.kind {
        GroupKind::Ground(grid) => Some((grid, group.range.clone())),
        _ => None,
    })
}

/// The ground under the models, and around them where their shadows fall; on terrain, no further than that.
fn studied_area(models: &Models, suns: &[Option<DVec3>]) -> Bounds {
    let all = models.bounds();
    if models.has_terrain() {
        return all;
    }
    let mut area = all;
    for caster in models.casters.iter().filter(|caster| caster.role.casts) {
        let height = caster.bounds.max.z - all.min.z;
        for sun in suns.iter().flatten() {
            let level = DVec2::new(sun.x, sun.y);
            let reach = (level.length() / sun.z.max(1e-6)).min(FOLLOWED_HEIGHTS) * height;
            let offset = (-level.normalize_or_zero() * reach).extend(0.0);
            area = area.union(Bounds { min: caster.bounds.min + offset, max: caster.bounds.max + offset });
        }
    }
    let margin = DVec3::new(MARGIN_M, MARGIN_M, 0.0);
    Bounds { min: area.min - margin, max: area.max + margin }
}

fn usual_spacing(area: &Bounds) -> f64 {
    let size = area.size();
    nice_above((size.x * size.y / USUAL_CELLS).sqrt())
}

/// The next of 1, 1.5, 2, 3, 4, 5, 7.5, 10, 15, … and their tenths from `value` on.
fn nice_above(value: f64) -> f64 {
    let value = value.max(1e-3);
    let decade = 10_f64.powi((value.log10() - 1e-9).floor() as i32);
    let steps = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.5, 10.0].map(|step| step * decade);
    let nice = steps.into_iter().find(|&nice| nice >= value * (1.0 - 1e-9)).unwrap_or(10.0 * decade);
    // So that 0.15 is 0.15.
    (nice * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spacings_are_round_numbers() {
        let nice = [0.03, 0.2, 0.21, 0.99, 1.0, 1.3, 5.1, 70.0, 100.0].map(nice_above);
        assert_eq!(nice, [0.03, 0.2, 0.3, 1.0, 1.0, 1.5, 7.5, 75.0, 100.0]);
    }
}
