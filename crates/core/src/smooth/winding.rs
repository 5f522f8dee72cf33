//! How often a silhouette goes round a place, as the light sees it: how often what is far behind that place is counted.

use glam::{DVec2, DVec3};

use crate::{Bounds, Chart, LightPosition, ahead_of};

use super::volume::SmoothVolume;

/// Rows and columns of cells, at most. Else twice as many as there would be of sides, were they in rows and columns.
const MOST_ROWS: usize = 1024;

/// The sides of a silhouette on a plane before the light.
#[derive(Debug, Default, Clone)]
pub(super) struct Windings {
    /// What the light sees, on a plane before it.
    view: Option<Chart>,
    corner: DVec2,
    cells_per_unit: DVec2,
    /// Rows and columns of cells.
    width: usize,
    /// Row by row.
    cells: Buckets,
    /// How often the silhouette goes round the middle of each.
    at_middles: Vec<i32>,
}

/// Sides in the order of where they are, as often as they are there.
#[derive(Debug, Default, Clone)]
struct Buckets {
    /// Where each begins, and at last where the last one ends.
    starts: Vec<u32>,
    sides: Vec<Side>,
}

impl Buckets {
    /// Puts each side into all the buckets that are named with it; so many there are.
    fn fill(&mut self, count: usize, named: impl Iterator<Item = (usize, Side)> + Clone) {
        self.starts.clear();
        self.starts.resize(count + 1, 0);
        named.clone().for_each(|(bucket, _)| self.starts[bucket] += 1);
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.sides.clear();
        self.sides.resize(end as usize, [DVec2::ZERO; 2]);
        // From the end of each to its start.
        for (bucket, side) in named {
            self.starts[bucket] -= 1;
            self.sides[self.starts[bucket] as usize] = side;
        }
    }

    fn of(&self, bucket: usize) -> &[Side] {
        &self.sides[self.starts[bucket] as usize..self.starts[bucket + 1] as usize]
    }
}

/// From a place to another.
type Side = [DVec2; 2];

impl Windings {
    /// Takes the sides of `volume`, all of which is in `bounds`. Where `light` is in there too, it sees no plane, and nothing is known of any place.
    pub(super) fn wind(&mut self, volume: &SmoothVolume, bounds: &Bounds, light: LightPosition) {
        self.view = ahead_of(bounds, light).map(|ahead| {
            let right = ahead.any_orthonormal_vector();
            Chart::around(light, [right, right.cross(ahead), ahead], bounds)
        });
        let Some(view) = &self.view else { return };
        let places: Vec<DVec2> = volume.points.iter().map(|p| place(view, p.as_dvec3())).collect();
        let sides: Vec<Side> = volume.sides.iter().map(|side| side.map(|p| places[p as usize])).collect();
        let ends = || sides.iter().flatten();
        self.corner = ends().fold(DVec2::INFINITY, |min, &place| min.min(place));
        let size = ends().fold(DVec2::NEG_INFINITY, |max, &place| max.max(place)) - self.corner;
        self.width = (2 * (sides.len() as f64).sqrt() as usize).clamp(1, MOST_ROWS);
        self.cells_per_unit = self.width as f64 / size.max(DVec2::splat(f64::MIN_POSITIVE));
        let (mut cells, mut at_middles) = (std::mem::take(&mut self.cells), std::mem::take(&mut self.at_middles));
        let named = |side: &Side| {
            let (side, [a, b]) = (*side, *side);
            self.cells_of(a.min(b), a.max(b)).map(move |number| (number, side))
        };
        rayon::join(
            || cells.fill(self.width * self.width, sides.iter().flat_map(named)),
            || self.wind_middles(&sides, &mut at_middles),
        );
        (self.cells, self.at_middles) = (cells, at_middles);
    }

    /// The cells of a box.
    fn cells_of(&self, min: DVec2, max: DVec2) -> impl Iterator<Item = usize> + Clone + use<> {
        let (first, last, width) = (self.cell(min), self.cell(max), self.width);
        (first[1]..=last[1]).flat_map(move |y| (first[0]..=last[0]).map(move |x| y * width + x))
    }

    /// Whether `is_wanted` holds for any side whose box meets that from `min` to `max`; each is asked about once, until one is.
    #[inline]
    fn is_any_near(&self, [min, max]: [DVec2; 2], mut is_wanted: impl FnMut(Side) -> bool) -> bool {
        let (first, last) = (self.cell(min), self.cell(max));
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                for &[a, b] in self.cells.of(y * self.width + x) {
                    let (low, high) = (a.min(b), a.max(b));
                    if low.x > max.x || low.y > max.y || high.x < min.x || high.y < min.y {
                        continue;
                    }
                    // In the first cell that it shares with the box.
                    let own = self.cell(low);
                    if own[0].max(first[0]) == x && own[1].max(first[1]) == y && is_wanted([a, b]) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// How often the sides go round the middle of each cell.
    fn wind_middles(&self, sides: &[Side], at_middles: &mut Vec<i32>) {
        at_middles.clear();
        at_middles.resize(self.width * self.width, 0);
        for &[a, b] in sides {
            let (low, high, times) = if a.y < b.y { (a, b, 1) } else { (b, a, -1) };
            for y in self.cell(low)[1]..=self.cell(high)[1] {
                let height = self.middle([0, y]).y;
                if !(low.y <= height && height < high.y) {
                    continue;
                }
                // It is gone round so much oftener by what is to the left of the side, in the row; rounding is not to say otherwise later.
                let is_left = |x: usize| (high - low).perp_dot(self.middle([x, y]) - low) > 0.0;
                let across = low.lerp(high, (height - low.y) / (high.y - low.y));
                let mut x = self.cell(across)[0];
                while x < self.width && is_left(x) {
                    x += 1;
                }
                while x > 0 && !is_left(x - 1) {
                    x -= 1;
                }
                if x > 0 {
                    at_middles[y * self.width + x - 1] += times;
                }
            }
        }
        for row in at_middles.chunks_exact_mut(self.width) {
            let mut sum = 0;
            for at in row.iter_mut().rev() {
                sum += *at;
                *at = sum;
            }
        }
    }

    /// The middle of a cell.
    fn middle(&self, [x, y]: [usize; 2]) -> DVec2 {
        self.corner + (DVec2::new(x as f64, y as f64) + 0.5) / self.cells_per_unit
    }

    /// Column and row.
    #[inline]
    fn cell(&self, place: DVec2) -> [usize; 2] {
        let at = (place - self.corner) * self.cells_per_unit;
        at.max(DVec2::ZERO).to_array().map(|at| (at as usize).min(self.width - 1))
    }

    /// Whether the silhouette goes round each place in a triangle once or more, the way that a lit surface's border does.
    ///
    /// It does round its middle, and a straight way from there goes over sides from their left, where it is gone round once oftener than on their right, and
    /// from their right. So it does round each place if it does round the middle oftener than there are sides with the middle to their left, or if no part of these
    /// has a place to its right round which it does not. Where sides meet to the last digit, it may be said that it does not, never the reverse. The `corners` are
    /// walked counterclockwise, as the light sees them. Takes a fraction of a microsecond.
    pub(super) fn goes_round_all(&self, corners: [DVec3; 3]) -> bool {
        let Some(view) = &self.view else { return false };
        let [a, b, c] = corners.map(|corner| place(view, corner));
        let (middle, borders) = ((a + b + c) / 3.0, [[a, b], [b, c], [c, a]]);
        let around = [a.min(b).min(c), a.max(b).max(c)];
        let part_of = |side: Side| {
            let is_facing = (side[1] - side[0]).perp_dot(middle - side[0]) >= 0.0;
            if is_facing { part_within(side, borders) } else { None }
        };
        let times = self.at(middle, None);
        let mut left = times;
        // Each side may take one.
        let is_last = |side: Side| {
            left -= i32::from(part_of(side).is_some());
            left <= 0
        };
        times > 0
            && (!self.is_any_near(around, is_last)
                || !self.is_any_near(around, |side| part_of(side).is_some_and(|part| self.is_outer(side, part))))
    }

    /// Whether there is a place to the right of a part of `side` round which the silhouette does not go.
    fn is_outer(&self, side: Side, [start, end]: [f64; 2]) -> bool {
        let at = |t: f64| side[0].lerp(side[1], t);
        let (from, to) = (at(start), at(end));
        // Where others go over it, and how much oftener the silhouette goes round what is beyond. Neighbours only meet its ends.
        let mut meetings: Vec<(f64, i32)> = Vec::new();
        self.is_any_near([from.min(to), from.max(to)], |other| {
            meetings.extend(meeting(side, other).filter(|(t, _)| start < *t && *t < end));
            false
        });
        meetings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let first = meetings.first().map_or(end, |(t, _)| *t);
        let mut times = self.at(at(0.5 * (start + first)), Some(side));
        times <= 0
            || meetings.iter().any(|(_, gained)| {
                times += gained;
                times <= 0
            })
    }

    /// How often the silhouette goes round `place`: as often as round the middle of its cell, but for what is crossed on the way from there. It is to the right of
    /// `beside`, if that is a side through it.
    fn at(&self, place: DVec2, beside: Option<Side>) -> i32 {
        let (outside, cell) = (self.corner + self.width as f64 / self.cells_per_unit, self.cell(place));
        if place.cmplt(self.corner).any() || place.cmpgt(outside).any() {
            return 0;
        }
        let (number, middle) = (cell[1] * self.width + cell[0], self.middle(cell));
        let crossed = self.cells.of(number).iter().map(|&side| on_the_way(side, [middle, place], beside == Some(side)));
        self.at_middles[number] + crossed.sum::<i32>()
    }
}

/// Where the light sees `point` on its plane.
fn place(view: &Chart, point: DVec3) -> DVec2 {
    let flat = view.flat(point);
    flat.truncate() / flat.z
}

/// From where to where a side is to the left of each of the `borders`, not on them.
#[inline]
fn part_within([from, to]: Side, borders: [Side; 3]) -> Option<[f64; 2]> {
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    for [p, q] in borders {
        let [at_from, at_to] = [from, to].map(|place| (q - p).perp_dot(place - p));
        match (at_from > 0.0, at_to > 0.0) {
            (false, false) => return None,
            (true, false) => end = end.min(at_from / (at_from - at_to)),
            (false, true) => start = start.max(at_from / (at_from - at_to)),
            (true, true) => {}
        }
    }
    (start < end).then_some([start, end])
}

/// How much oftener a silhouette goes round the end of a way than round its start, for one of its sides; `is_end_right` if the end is on that side, and meant as
/// the place to the right of it.
#[inline]
fn on_the_way([a, b]: Side, [start, end]: [DVec2; 2], is_end_right: bool) -> i32 {
    let is_left = |place: DVec2| (b - a).perp_dot(place - a) > 0.0;
    let (from_left, to_left) = (is_left(start), is_left(end) && !is_end_right);
    let is_beside = |place: DVec2| (end - start).perp_dot(place - start) > 0.0;
    if from_left == to_left || is_beside(a) == is_beside(b) { 0 } else { i32::from(to_left) - i32::from(from_left) }
}

/// Where on a side another one goes over it, and how much oftener the silhouette goes round what is beyond that.
fn meeting([a, b]: Side, [c, d]: Side) -> Option<(f64, i32)> {
    let [at_c, at_d] = [c, d].map(|place| (b - a).perp_dot(place - a));
    let [at_a, at_b] = [a, b].map(|place| (d - c).perp_dot(place - c));
    if (at_c > 0.0) == (at_d > 0.0) || (at_a > 0.0) == (at_b > 0.0) {
        return None;
    }
    Some((at_a / (at_a - at_b), if at_b > 0.0 { 1 } else { -1 }))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// A closed walk through `corners` and what the sun above sees of it.
    fn wound(corners: &[[f64; 2]]) -> Windings {
        let n = corners.len() as u32;
        let points = corners.iter().map(|&[x, y]| Vec3::new(x as f32, y as f32, 0.0)).collect();
        let volume =
            SmoothVolume { points, sides: (0..n).map(|i| [i, (i + 1) % n]).collect(), ..SmoothVolume::default() };
        let mut windings = Windings::default();
        let bounds = Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) };
        windings.wind(&volume, &bounds, LightPosition::directional(DVec3::Z).expect("not zero"));
        windings
    }

    fn at(windings: &Windings, x: f64, y: f64) -> i32 {
        let view = windings.view.as_ref().expect("the sun is beyond the box");
        windings.at(place(view, DVec3::new(x, y, 0.0)), None)
    }

    #[test]
    fn a_walk_round_the_light_side_is_counted_once_and_one_backward_less() {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let backward: Vec<[f64; 2]> = square.into_iter().rev().collect();
        let (square, backward) = (wound(&square), wound(&backward));
        for (x, y, times) in [(0.0, 0.0, 1), (0.9, -0.9, 1), (1.1, 0.0, 0), (0.0, -1.1, 0), (-1.5, 1.5, 0)] {
            assert_eq!([at(&square, x, y), at(&backward, x, y)], [times, -times], "at {x}, {y}");
        }
    }

    #[test]
    fn it_goes_round_all_of_a_triangle_if_it_does_round_each_place() {
        let mut random = crate::smooth::tests::random();
        let mut random = || f64::from(random());
        let (mut crossed, mut round, mut same) = (0, 0, 0);
        for _ in 0..400 {
            let corners: Vec<[f64; 2]> = (0..12).map(|_| [random(), random()]).collect();
            let windings = wound(&corners);
            for _ in 0..20 {
                let middle = 0.5 * DVec3::new(random(), random(), 0.0);
                let [a, mut b, mut c] = [(); 3].map(|()| middle + 0.3 * DVec3::new(random(), random(), 0.0));
                if (b - a).cross(c - a).z < 0.0 {
                    (b, c) = (c, b);
                }
                let places = (0..40).flat_map(|i| (0..40 - i).map(move |j| (f64::from(i) + 0.3, f64::from(j) + 0.3)));
                let is_found =
                    places.map(|(u, v)| a + ((b - a) * u + (c - a) * v) / 40.0).all(|p| at(&windings, p.x, p.y) > 0);
                let is_said = windings.goes_round_all([a, b, c]);
                assert!(is_found || !is_said, "round {a}, {b}, {c}");
                let view = windings.view.as_ref().expect("the sun is beyond the box");
                let [p, q, r] = [a, b, c].map(|corner| place(view, corner));
                let around = [p.min(q).min(r), p.max(q).max(r)];
                let borders = [[p, q], [q, r], [r, p]];
                let is_crossed = windings.is_any_near(around, |side| part_within(side, borders).is_some());
                crossed += usize::from(is_crossed && is_found);
                round += usize::from(is_found);
                same += usize::from(is_found && is_said);
            }
        }
        // Where it is not said though it was found, a face is too small to have one of the places.
        assert!(crossed > 100 && 100 * same > 95 * round, "{crossed} crossed, {same} of {round} said");
    }

    #[test]
    fn sides_along_the_border_do_not_cross_a_triangle() {
        let corners = [[0.1, 0.2], [0.9, 0.3], [0.4, 0.8]];
        let triangle = corners.map(|[x, y]| DVec3::new(f64::from(x as f32), f64::from(y as f32), 0.0));
        assert!(wound(&corners).goes_round_all(triangle));
        assert!(!wound(&[corners[2], corners[1], corners[0]]).goes_round_all(triangle));
    }

    #[test]
    fn around_a_light_nothing_is_known() {
        let mut windings = wound(&[[-9.0, -9.0], [9.0, -9.0], [0.0, 9.0]]);
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert!(windings.goes_round_all(triangle));
        let bounds = Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) };
        windings.wind(&SmoothVolume::default(), &bounds, LightPosition::point(DVec3::ONE));
        assert!(!windings.goes_round_all(triangle));
    }
}
