//! How often a silhouette goes round a place, as the light sees it: how often what is far behind that place is counted.

use glam::{DVec2, DVec3};

use crate::{Bounds, LightPosition, ahead_of};

use super::volume::SmoothVolume;

/// There is a row for so many sides, each of which is in several.
const SIDES_PER_ROW: usize = 6;
const MOST_ROWS: usize = 2048;

/// The sides of a silhouette on a plane before the light, row by row.
#[derive(Debug, Default, Clone)]
pub(super) struct Windings {
    view: Option<View>,
    bottom: f64,
    rows_per_unit: f64,
    /// Where the sides of each row begin in `sides`, and at last where they end.
    starts: Vec<u32>,
    sides: Vec<Side>,
}

/// From a place to another.
type Side = [DVec2; 2];

/// What the light sees, on a plane before it.
#[derive(Debug, Clone, Copy)]
struct View {
    light: LightPosition,
    right: DVec3,
    up: DVec3,
    ahead: DVec3,
}

impl View {
    fn place(&self, point: DVec3) -> DVec2 {
        if self.light.is_directional() {
            return DVec2::new(self.right.dot(point), self.up.dot(point));
        }
        let from_light = -self.light.offset_from(point);
        DVec2::new(self.right.dot(from_light), self.up.dot(from_light)) / self.ahead.dot(from_light)
    }
}

impl Windings {
    /// Takes the sides of `volume`, all of which is in `bounds`. Where `light` is in there too, it sees no plane, and nothing is known of any place.
    pub(super) fn wind(&mut self, volume: &SmoothVolume, bounds: &Bounds, light: LightPosition) {
        self.view = ahead_of(bounds, light).map(|ahead| {
            let right = ahead.any_orthonormal_vector();
            View { light, right, up: right.cross(ahead), ahead }
        });
        let Some(view) = self.view else { return };
        let places: Vec<DVec2> = volume.points.iter().map(|p| view.place(p.as_dvec3())).collect();
        let heights = || volume.sides.iter().flatten().map(|&p| places[p as usize].y);
        self.bottom = heights().fold(f64::INFINITY, f64::min);
        let height = heights().fold(f64::NEG_INFINITY, f64::max) - self.bottom;
        let rows = (volume.sides.len() / SIDES_PER_ROW).clamp(1, MOST_ROWS);
        self.rows_per_unit = rows as f64 / height.max(f64::MIN_POSITIVE);
        self.starts.clear();
        self.starts.resize(rows + 1, 0);
        // Counted, then put where they belong.
        let spans: Vec<[usize; 2]> = volume
            .sides
            .iter()
            .map(|side| {
                let [a, b] = side.map(|p| self.row(places[p as usize].y));
                [a.min(b), a.max(b)]
            })
            .collect();
        for &[first, last] in &spans {
            (first..=last).for_each(|row| self.starts[row + 1] += 1);
        }
        for row in 0..rows {
            self.starts[row + 1] += self.starts[row];
        }
        let mut next = self.starts.clone();
        self.sides.clear();
        self.sides.resize(self.starts[rows] as usize, [DVec2::ZERO; 2]);
        for (side, &[first, last]) in volume.sides.iter().zip(&spans) {
            for next in &mut next[first..=last] {
                self.sides[*next as usize] = side.map(|p| places[p as usize]);
                *next += 1;
            }
        }
    }

    /// How often the silhouette goes round that place in a triangle round which it goes least, the way that a lit surface's border does.
    ///
    /// Sides that meet to the last digit may make it less than it is, never more. The `corners` are walked counterclockwise, as the light sees them. `None` where
    /// nothing is known. Takes a microsecond, and more where many sides cross the triangle.
    pub(super) fn least(&self, corners: [DVec3; 3]) -> Option<i32> {
        let view = self.view?;
        let corners = corners.map(|corner| view.place(corner));
        let crossing = self.crossing(corners);
        if crossing.is_empty() {
            let [a, b, c] = corners;
            return Some(self.at((a + b + c) / 3.0, None));
        }
        // Sides cut the triangle into faces; each face has a part of a side on its border that no other cuts, and to the right of a side there is less.
        let mut least = i32::MAX;
        let mut cuts = Vec::new();
        for &(side, [start, end]) in &crossing {
            let [from, to] = side;
            cuts.clear();
            cuts.extend([start, end]);
            cuts.extend(
                crossing.iter().filter_map(|(other, _)| meeting(side, *other)).filter(|t| start < *t && *t < end),
            );
            cuts.sort_unstable_by(f64::total_cmp);
            for part in cuts.windows(2) {
                least = least.min(self.at(from.lerp(to, 0.5 * (part[0] + part[1])), Some(side)));
            }
        }
        Some(least)
    }

    /// How often the silhouette goes round `place`; to the right of `beside`, if that is a side through it.
    fn at(&self, place: DVec2, beside: Option<Side>) -> i32 {
        let times = |side: &Side| {
            let [a, b] = *side;
            let (is_a_below, is_b_below) = (a.y <= place.y, b.y <= place.y);
            if is_a_below == is_b_below {
                return 0;
            }
            let is_left = (b - a).perp_dot(place - a) > 0.0 && beside != Some(*side);
            i32::from(is_a_below && is_left) - i32::from(is_b_below && !is_left)
        };
        self.in_row(self.row(place.y)).iter().map(times).sum()
    }

    /// The sides that are within a triangle, and from where to where; not those along its border.
    fn crossing(&self, corners: [DVec2; 3]) -> Vec<(Side, [f64; 2])> {
        let [a, b, c] = corners;
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        let within = |&[from, to]: &Side| {
            if from.min(to).cmpgt(max).any() || from.max(to).cmplt(min).any() {
                return None;
            }
            // The part of the side that is to the left of each of the triangle's.
            let (mut start, mut end) = (0.0_f64, 1.0_f64);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let [at_from, at_to] = [from, to].map(|place| (q - p).perp_dot(place - p));
                let crossed = at_from / (at_from - at_to);
                match (at_from > 0.0, at_to > 0.0) {
                    (false, false) => return None,
                    (true, false) => end = end.min(crossed),
                    (false, true) => start = start.max(crossed),
                    (true, true) => {}
                }
            }
            (start < end).then_some(([from, to], [start, end]))
        };
        let first_row = self.row(min.y);
        let mut crossing = Vec::new();
        for row in first_row..=self.row(max.y) {
            // Each in the first row that it shares with the triangle.
            let is_first = |side: &&Side| self.row(side[0].y.min(side[1].y)).max(first_row) == row;
            crossing.extend(self.in_row(row).iter().filter(is_first).filter_map(within));
        }
        crossing
    }

    fn row(&self, height: f64) -> usize {
        let rows = self.starts.len() - 1;
        (((height - self.bottom) * self.rows_per_unit).max(0.0) as usize).min(rows - 1)
    }

    fn in_row(&self, row: usize) -> &[Side] {
        &self.sides[self.starts[row] as usize..self.starts[row + 1] as usize]
    }
}

/// Where on `side` it meets the line through `other`, if that has its ends on both sides of it.
fn meeting([a, b]: Side, [c, d]: Side) -> Option<f64> {
    let [at_c, at_d] = [c, d].map(|place| (b - a).perp_dot(place - a));
    let [at_a, at_b] = [a, b].map(|place| (d - c).perp_dot(place - c));
    let t = at_a / (at_a - at_b);
    ((at_c > 0.0) != (at_d > 0.0) && t.is_finite()).then_some(t)
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
        let view = windings.view.expect("the sun is beyond the box");
        windings.at(view.place(DVec3::new(x, y, 0.0)), None)
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
    fn the_least_in_a_triangle_is_what_is_found_in_its_places() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1_u32 << 23) - 1.0
        };
        let (mut crossed, mut same) = (0, 0);
        for _ in 0..40 {
            let corners: Vec<[f64; 2]> = (0..30).map(|_| [random(), random()]).collect();
            let windings = wound(&corners);
            for _ in 0..20 {
                let [a, mut b, mut c] = [(); 3].map(|()| DVec3::new(random(), random(), 0.0));
                if (b - a).cross(c - a).z < 0.0 {
                    (b, c) = (c, b);
                }
                let least = windings.least([a, b, c]).expect("the sun is beyond the box");
                let places = (0..100).flat_map(|i| (0..100 - i).map(move |j| (f64::from(i) + 0.3, f64::from(j) + 0.3)));
                let found = places.map(|(u, v)| {
                    let place = a + ((b - a) * u + (c - a) * v) / 100.0;
                    at(&windings, place.x, place.y)
                });
                let found = found.min().expect("there are places");
                assert!(least <= found, "{least} above {found}");
                let view = windings.view.expect("the sun is beyond the box");
                crossed += usize::from(!windings.crossing([a, b, c].map(|p| view.place(p))).is_empty());
                same += usize::from(least == found);
            }
        }
        // Of faces that are too small to have one of the places, some are missed by these.
        assert!(crossed > 700 && same > 700, "{crossed} triangles are crossed, in {same} of 800 it is the same");
    }

    #[test]
    fn sides_along_the_border_do_not_cross_a_triangle() {
        let corners = [[0.1, 0.2], [0.9, 0.3], [0.4, 0.8]];
        let windings = wound(&corners);
        let triangle = corners.map(|[x, y]| DVec3::new(f64::from(x as f32), f64::from(y as f32), 0.0));
        assert_eq!(windings.least(triangle), Some(1));
    }

    #[test]
    fn around_a_light_nothing_is_known() {
        let mut windings = wound(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        let bounds = Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) };
        windings.wind(&SmoothVolume::default(), &bounds, LightPosition::point(DVec3::ONE));
        assert_eq!(windings.least([DVec3::ZERO, DVec3::X, DVec3::Y]), None);
    }
}
