//! How many volumes of one caster can overlap, so that a narrow counter is used only where it can't wrap.
//!
//! ```text
//!         .-------.             What the light sees of a chain's boundary, laid over a grid. The count
//!       / 1   .-----.           only grows along a ray from the light, so it is nowhere more than the
//!      |    / 2 |    \          winding number w of the boundary around the ray. From the middle of a
//!      |   |    |  1  |         cell one gets anywhere in it across the edges that touch the cell, M in
//!       \   \  /     /          number: there w is at most w(middle) + M.
//!         '--'------'
//! ```
//!
//! A second bound is better where many edges run together, and needs no grid. Upwards along a line across the whole plane, from where w is
//! known, w grows by at most 1 for each edge that has its inner side above; downwards, for each other one. As the line is swept
//! across the plane, these two numbers change at corners only, which are sorted. They are exact for a convex body: 1.
//!
//! The grid is laid on a plane before the light, so that edges are straight on it: one that all of the caster is behind, or, where
//! the light is in the caster's box, four that stand around the light and reach up and down to infinity.
//!
//! Rounding of the edges' places on the grid does no harm. It can make a path from the middle of a cell cross an edge other than it
//! truly does, but only an edge that passes within rounding of the path; that touches the cell, whose outline is
//! widened by more, and so is in M.
//!
//! Not in the papers. M. McGuire et al. 2003, section 4, names the limit (a staircase with the light at its top) and leaves it.

mod columns;
mod stacked;
mod sweep;

use glam::{DVec2, DVec3, Vec3};

use self::columns::Columns;
pub(crate) use self::stacked::Stack;
use self::sweep::Sweep;

use crate::{Bounds, Caster, Chain, LightPosition, ShadowVolume};

/// Where the bound is as low as this, it is not worth a grid.
const LOW: i64 = 8;
/// Where the bound is as low as this, it is not worth a finer grid: it leaves half of what seven bits can count to others.
const FAIR: i64 = 64;
/// Rows and columns of the coarsest grid and the finest, powers of two; the first is as fine as there are edges to fill it.
const CELLS: [usize; 2] = [32, 512];
/// Cells are widened by this part of their size on each side.
const WIDENED: f64 = 2e-3;
/// An edge across less than this part of a column is as good as parallel to it.
const UPRIGHT: f64 = 1e-2;
/// A grid is wider than the caster by this, relative to its coordinates, so that they differ by more than rounding across a cell.
const BORDER: f64 = 1e-7;
/// An edge nearer to the axis than this, relative to its distance, may pass it on either side.
const AT_AXIS: f64 = 1e-9;

/// A number that the count of `volume`, of `caster` and `light`, reaches nowhere above.
///
/// At most [`ShadowVolume::most_triangles`]; 1 for a convex body. Takes a few tenths of a microsecond for each silhouette edge, and more
/// where the number is large or the light [is in the caster's box](needs_light_cap).
///
/// # Panics
///
/// If the light is in the caster's box and `volume` is one of sides alone.
pub fn most_overlaps(caster: &Caster, volume: &ShadowVolume, light: LightPosition) -> u32 {
    most_overlaps_of((&caster.positions, &caster.bounds), volume, light, 0)
}

/// The same for a volume over `positions` in a box; a number no better than `enough` is as good as any.
pub(crate) fn most_overlaps_of(
    (positions, bounds): (&[Vec3], &Bounds),
    volume: &ShadowVolume,
    light: LightPosition,
    enough: u32,
) -> u32 {
    let (triangles, enough) = (volume.most_triangles, i64::from(enough));
    let most = if triangles <= 1 {
        triangles as i64
    } else if let Some(ahead) = ahead_of(bounds, light) {
        let right = ahead.any_orthonormal_vector();
        let up = right.cross(ahead);
        let chart = Chart::around(light, [right, up, ahead], bounds);
        let upright = Chart::around(light, [up, -right, ahead], bounds);
        let swept = upright.sweep(positions, volume).most(Poles::default(), 1)[0];
        let most = || chart.most(positions, volume, Poles::default(), enough);
        if swept <= LOW.max(enough) { swept } else { swept.min(most()) }
    } else {
        assert!(!volume.light_cap.is_empty(), "around a light in its box, a volume is told from its cap");
        let axis = DVec3::Z;
        let poles = Poles::new(positions, volume, light, axis);
        let around = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
        let charts = around.map(|ahead| Chart::quarter(light, [ahead.cross(axis), axis, ahead]));
        charts.iter().fold(0, |most, chart| most.max(chart.most(positions, volume, poles, enough.max(most))))
    };
    most.clamp(0, triangles as i64) as u32
}

/// Whether [`most_overlaps`] needs the light cap: where `light` is in the box of `caster`.
pub fn needs_light_cap(caster: &Caster, light: LightPosition) -> bool {
    ahead_of(&caster.bounds, light).is_none()
}

/// A direction from the light that all of `bounds` is strictly ahead in; `None` when the light is in them.
pub(crate) fn ahead_of(bounds: &Bounds, light: LightPosition) -> Option<DVec3> {
    let position = light.homogeneous().truncate();
    if light.is_directional() {
        return Some(-position);
    }
    let (below, above) = (bounds.min - position, position - bounds.max);
    let beyond = below.max(above);
    // From as far outside as can be.
    let axis = beyond.max_position();
    let sign = if below[axis] > above[axis] { 1.0 } else { -1.0 };
    (beyond[axis] > 0.0).then(|| sign * DVec3::AXES[axis])
}

/// The winding number along the axis of a chart, at most.
#[derive(Debug, Clone, Copy, Default)]
struct Poles {
    below: i64,
    above: i64,
    /// Edges that may pass the axis on the other side than they seem to.
    unsure: i64,
}

impl Poles {
    fn new(positions: &[Vec3], volume: &ShadowVolume, light: LightPosition, axis: DVec3) -> Self {
        let position = light.homogeneous().truncate();
        let at = |i: u32| positions[i as usize].as_dvec3() - position;
        let flat = |p: DVec3| p - axis * axis.dot(p);
        let turn = |a: DVec3, b: DVec3| axis.dot(a.cross(b));
        let mut poles = Self::default();
        for triangle in &volume.light_cap {
            let corners = triangle.map(at);
            let around: [[f64; 2]; 3] = std::array::from_fn(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                [turn(a, b), AT_AXIS * a.length() * b.length()]
            });
            let is_left = around.iter().all(|[turn, rounding]| *turn >= -rounding);
            let is_right = around.iter().all(|[turn, rounding]| *turn <= *rounding);
            if is_left || is_right {
                let heights = corners.map(|p| axis.dot(p));
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                // Where the triangle meets the axis, unless it is along it.
                let (height, scale) = (normal.dot(corners[0]), normal.length() * corners[0].length());
                let slope = normal.dot(axis);
                let is_clear = height.abs() > AT_AXIS * scale && slope.abs() > AT_AXIS * normal.length();
                let is_above = heights.iter().any(|&h| h > 0.0) && (!is_clear || height * slope > 0.0);
                let is_below = heights.iter().any(|&h| h < 0.0) && (!is_clear || height * slope < 0.0);
                poles.above += i64::from(is_above);
                poles.below += i64::from(is_below);
            }
        }
        for side in &volume.sides {
            let [a, b] = side.map(at);
            let [across_a, across_b] = [flat(a), flat(b)];
            let scale = AT_AXIS * across_a.length() * across_b.length();
            let is_between = turn(a, b).abs() <= scale && across_a.dot(across_b) <= scale;
            let is_end = across_a.length() <= AT_AXIS * a.length() || across_b.length() <= AT_AXIS * b.length();
            poles.unsure += i64::from(is_between || is_end);
        }
        poles
    }
}

/// A plane before the light and the grid on it.
#[derive(Debug, Clone)]
pub(crate) struct Chart {
    light: LightPosition,
    /// To the right and up on the plane as the light sees it, and towards it.
    axes: [DVec3; 3],
    /// What the grid covers, as [`Chart::mapped`] has it.
    min: DVec2,
    max: DVec2,
    /// Of the grid's width and height, for each unit of what it covers.
    per_unit: DVec2,
    /// Whether there are three more around the light, and this one ends where it is as far to the side as ahead.
    is_quarter: bool,
}

/// An edge's end as a homogeneous point of the plane: right, up, and the divisor, which is not negative on the chart.
pub(crate) type Flat = DVec3;

impl Chart {
    /// Over what is seen of `bounds`, which are ahead of the light.
    pub(crate) fn around(light: LightPosition, axes: [DVec3; 3], bounds: &Bounds) -> Self {
        let (min, max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut chart = Self { light, axes, min, max, per_unit: DVec2::ZERO, is_quarter: false };
        for corner in bounds.corners() {
            let mapped = chart.mapped(chart.flat(corner));
            let border = BORDER * (1.0 + mapped.abs());
            chart.min = chart.min.min(mapped - border);
            chart.max = chart.max.max(mapped + border);
        }
        chart.per_unit = 1.0 / (chart.max - chart.min);
        chart
    }

    fn quarter(light: LightPosition, axes: [DVec3; 3]) -> Self {
        let (min, max, per_unit) = (DVec2::new(-0.5, -1.0), DVec2::new(0.5, 1.0), DVec2::new(1.0, 0.5));
        Self { light, axes, min, max, per_unit, is_quarter: true }
    }

    #[inline]
    pub(crate) fn flat(&self, point: DVec3) -> Flat {
        let [right, up, ahead] = self.axes;
        if self.light.is_directional() {
            return DVec3::new(right.dot(point), up.dot(point), 1.0);
        }
        let from_light = -self.light.offset_from(point);
        DVec3::new(right.dot(from_light), up.dot(from_light), ahead.dot(from_light))
    }

    /// Both coordinates on the plane; for a point light squeezed into -1 to 1, so that a plane that reaches far has a grid too.
    #[inline]
    fn mapped(&self, p: Flat) -> DVec2 {
        let along = p.truncate();
        let divisor = if self.light.is_directional() { DVec2::splat(p.z) } else { p.z.abs() + along.abs() };
        // 0 / 0 is on the axis, where edges are known to be unsure.
        DVec2::select(along.cmpeq(DVec2::ZERO), DVec2::ZERO, along / divisor)
    }

    /// From 0 to 1 across the grid and up it.
    #[inline]
    fn on_grid(&self, p: Flat) -> DVec2 {
        (self.mapped(p) - self.min) * self.per_unit
    }

    /// The place on the plane that is so far across the grid, in units of the divisor.
    fn right_at(&self, part: f64) -> f64 {
        let mapped = self.min.x + part * (self.max.x - self.min.x);
        if self.light.is_directional() { mapped } else { mapped / (1.0 - mapped.abs()) }
    }

    /// The part of the edge that is on the chart.
    #[inline]
    fn clipped(&self, mut a: Flat, mut b: Flat) -> Option<[Flat; 2]> {
        if !self.is_quarter {
            return Some([a, b]);
        }
        for side in [1.0, -1.0] {
            // A little over the end, so that what just touches it is on both charts.
            let inside = |p: Flat| p.z * (1.0 + AT_AXIS) - side * p.x;
            let (at_a, at_b) = (inside(a), inside(b));
            if at_a < 0.0 && at_b < 0.0 {
                return None;
            }
            let crossing = || a + (b - a) * (at_a / (at_a - at_b));
            if at_a < 0.0 {
                a = crossing();
            } else if at_b < 0.0 {
                b = crossing();
            }
        }
        Some([a, b])
    }

    /// A bound of the winding number anywhere on the chart; one no better than `enough` is as good as any.
    fn most(&self, positions: &[Vec3], volume: &ShadowVolume, poles: Poles, enough: i64) -> i64 {
        let sweep = self.sweep(positions, volume);
        let swept = sweep.most(poles, 1)[0];
        if swept <= LOW.max(enough) {
            return swept;
        }
        let [coarsest, finest] = CELLS;
        // For each column of the finest grid; each grid has only those columns in which the bound is still too high.
        let mut bounds = sweep.most(poles, finest);
        let edges = volume.sides.len() / if self.is_quarter { 4 } else { 1 };
        let first = (1.5 * (edges as f64).sqrt()) as usize;
        for (size, good) in [(first.next_power_of_two().clamp(coarsest, finest), LOW), (finest, FAIR)] {
            let per_column = finest / size;
            let is_wanted = |bounds: &[i64]| bounds.iter().any(|&bound| bound > good.max(enough));
            let wanted: Vec<bool> = bounds.chunks_exact(per_column).map(is_wanted).collect();
            if !wanted.contains(&true) {
                break;
            }
            let mut columns = Columns::new(&wanted);
            for [a, b] in self.edges(positions, volume) {
                self.add_edge(&mut columns, a, b);
            }
            for (bounds, cells) in bounds.chunks_exact_mut(per_column).zip(columns.most(poles)) {
                bounds.iter_mut().for_each(|bound| *bound = cells.map_or(*bound, |cells| cells.min(*bound)));
            }
            if size == finest {
                break;
            }
        }
        bounds.into_iter().max().unwrap_or(0)
    }

    /// The edges that are on the chart, as far as they are.
    fn edges<'a>(&'a self, positions: &'a [Vec3], volume: &'a ShadowVolume) -> impl Iterator<Item = [Flat; 2]> + 'a {
        let flat = |i: u32| self.flat(positions[i as usize].as_dvec3());
        volume.sides.iter().filter_map(move |side| {
            let [a, b] = side.map(flat);
            self.clipped(a, b)
        })
    }

    fn sweep(&self, positions: &[Vec3], volume: &ShadowVolume) -> Sweep {
        // What begins and ends in a corner; most edges go on through it.
        let mut balance = vec![[0_i32; 2]; positions.len()];
        let mut sweep = Sweep::default();
        for side in &volume.sides {
            let ends = side.map(|i| self.flat(positions[i as usize].as_dvec3()));
            let Some(clipped) = self.clipped(ends[0], ends[1]) else { continue };
            let [from, to] = clipped.map(|p| self.on_grid(p).x);
            let is_rise = from < to;
            for i in 0..2 {
                // Rises begin where the edge does, falls where it ends.
                let sign = if (i == 0) == is_rise { 1 } else { -1 };
                let by = if is_rise { [sign, 0] } else { [0, sign] };
                if clipped[i] == ends[i] {
                    let sum = &mut balance[side[i] as usize];
                    *sum = [sum[0] + by[0], sum[1] + by[1]];
                } else {
                    sweep.step([from, to][i], by);
                }
            }
        }
        for &corner in volume.sides.iter().flatten() {
            let by = std::mem::take(&mut balance[corner as usize]);
            if by != [0, 0] {
                sweep.step(self.on_grid(self.flat(positions[corner as usize].as_dvec3())).x, by);
            }
        }
        sweep.sort();
        sweep
    }

    fn add_edge(&self, columns: &mut Columns, a: Flat, b: Flat) {
        let size = columns.size as f64;
        let part_of_column = 1.0 / size;
        let [[column_a, row_a], [column_b, row_b]] = [a, b].map(|end| (self.on_grid(end) * size).to_array());
        let (left, right) = (column_a.min(column_b), column_a.max(column_b));
        // Whether the inner side, left of the edge, is above.
        let is_rise = column_a < column_b;
        let is_upright = right - left < UPRIGHT;
        // The row at which the edge crosses a line across the columns.
        let row_at = |column: f64| {
            let x = self.right_at(column * part_of_column);
            let (at_a, at_b) = (a.x - x * a.z, b.x - x * b.z);
            let part = at_a / (at_a - at_b);
            let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.5 };
            let row = self.on_grid(a + (b - a) * part).y * size;
            row.clamp(row_a.min(row_b), row_a.max(row_b))
        };
        let cell = |at: f64| at.clamp(0.0, size - 1.0) as usize;
        let (leftmost, rightmost) = if is_rise { (row_a, row_b) } else { (row_b, row_a) };
        // Above a row are the cells whose middles are.
        let above = |row: f64| (row + 0.5).clamp(0.0, size) as usize;
        let [lowest_above, highest_above] = [above(row_a.min(row_b)), above(row_a.max(row_b))];
        let [first_column, last_column] = [cell(left - WIDENED), cell(right + WIDENED)];
        if !columns.is_any_wanted(first_column, last_column) {
            return;
        }
        let enters = |from: f64| if is_upright || left >= from { leftmost } else { row_at(from) };
        let mut entered = None;
        for column in first_column..=last_column {
            if !columns.is_any_wanted(column, column) {
                entered = None;
                continue;
            }
            let (from, to) = (column as f64, column as f64 + 1.0);
            // Where the edge enters the column, and where it leaves it.
            let entered_at = entered.unwrap_or_else(|| enters(from));
            let left_at = if is_upright || right <= to { rightmost } else { row_at(to) };
            columns.touch(column, cell(entered_at.min(left_at) - WIDENED), cell(entered_at.max(left_at) + WIDENED));
            let middle = from + 0.5;
            if (column_a < middle) != (column_b < middle) {
                let first_above = if lowest_above == highest_above { lowest_above } else { above(row_at(middle)) };
                columns.step(column, first_above, if is_rise { 1 } else { -1 });
            }
            // An upright one may be anywhere between its ends as it passes from one column to the next.
            entered = (left < to && !is_upright).then_some(left_at);
        }
    }
}

/// Chains of `caster` that add up to `chain`, none of whose counts for `light` exceeds `most`; `chain` itself where that is enough.
///
/// All counts are at least 0, so a point is lit where each part's count is 0. A part's triangles are next to each other in distance from the
/// light: overlapping ones are at different distances. Each part costs one pass over the triangles and edges of the caster.
///
/// # Panics
///
/// If `most` is 0.
pub fn split_chain(caster: &Caster, chain: &Chain, light: LightPosition, most: u32) -> Vec<Chain> {
    assert!(most > 0, "no triangle casts less than once");
    let overlaps = |part: &Chain| most_overlaps(caster, &ShadowVolume::new(caster, part), light);
    if overlaps(chain) <= most {
        return vec![chain.clone()];
    }
    let mut by_distance: Vec<(f64, u32, i8)> = Vec::new();
    for (t, &times) in chain.coefficients().iter().enumerate() {
        let middle = caster.corners(t).into_iter().map(Vec3::as_dvec3).sum::<DVec3>() / 3.0;
        let to_light = light.offset_from(middle);
        let distance =
            if light.is_directional() { -light.homogeneous().truncate().dot(middle) } else { to_light.length() };
        by_distance.extend((0..times.unsigned_abs()).map(|_| (distance, t as u32, times.signum())));
    }
    by_distance.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let chain_of = |units: &[(f64, u32, i8)]| {
        let mut coefficients = vec![0; chain.coefficients().len()];
        for &(_, t, unit) in units {
            coefficients[t as usize] += unit;
        }
        Chain::from_coefficients(coefficients)
    };
    let mut parts = Vec::new();
    let mut left = vec![by_distance.as_slice()];
    while let Some(units) = left.pop() {
        let part = chain_of(units);
        let bound = overlaps(&part);
        if bound <= most {
            parts.push(part);
        } else {
            // As many pieces as there would be if all were to overlap alike. More than one, as there are more units than `most`.
            let pieces = (bound.div_ceil(most) as usize).min(units.len());
            left.extend(units.chunks(units.len().div_ceil(pieces)).rev());
        }
    }
    parts
}
