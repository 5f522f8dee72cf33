//! A polygon in space, cut into triangles along its own corners.
//!
//! ```text
//!      3 _________ 2         a fan from corner 0 where all its triangles face
//!       |\        |          one way; else ear cutting in the polygon's plane,
//!       |  \ _____| 1        which is right for concave polygons too. Corners
//!      4|___\0               on a straight side are kept: a neighbour may use them.
//! ```
//!
//! An n-gon always becomes n - 2 triangles, and their outline is the polygon's, each side walked once in its own
//! direction. So a closed surface stays closed whatever its polygons look like.

mod holes;

use std::collections::BTreeMap;

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// Ear cutting may take time that grows with the square of the number of corners; beyond this many, a crafted file
/// of a few megabytes could keep it busy for minutes.
const MAX_EARCUT_CORNERS: usize = 16_384;

/// Cuts polygons; keeps its working memory from one to the next.
pub(crate) struct Triangulator {
    earcut: Earcut<f64>,
    flat: Vec<DVec2>,
    cut: Vec<u32>,
}

/// How well a polygon could be cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// The triangles cover the polygon and nothing else.
    Exact,
    /// It crosses itself, has no area, or is too large: it became a fan, which may cover something else.
    Fan,
}

impl Triangulator {
    pub(crate) fn new() -> Self {
        Self { earcut: Earcut::new(), flat: Vec::new(), cut: Vec::new() }
    }

    /// Calls `add` with each triangle of `ring`, as positions in it; walked the same way around.
    ///
    /// A ring of fewer than three corners has no triangle.
    pub(crate) fn triangulate(&mut self, ring: &[DVec3], mut add: impl FnMut([u32; 3])) -> Cut {
        if ring.len() <= 3 {
            fan(ring.len()).for_each(add);
            return Cut::Exact;
        }
        if !flatten(ring, ring, &mut self.flat) {
            fan(ring.len()).for_each(add);
            return Cut::Fan;
        }
        let is_good = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| self.flat[i as usize]);
            (b - a).perp_dot(c - a) >= 0.0
        };
        if fan(ring.len()).all(is_good) {
            fan(ring.len()).for_each(add);
            return Cut::Exact;
        }
        match self.cut_ears() {
            Some(triangles) => {
                triangles.into_iter().for_each(&mut add);
                Cut::Exact
            }
            None => {
                fan(ring.len()).for_each(add);
                Cut::Fan
            }
        }
    }

    fn cut_ears(&mut self) -> Option<Vec<[u32; 3]>> {
        let corners = self.flat.len();
        if corners > MAX_EARCUT_CORNERS {
            return None;
        }
        self.earcut.earcut(self.flat.iter().map(DVec2::to_array), &[], &mut self.cut);
        // Among a simple polygon's corners, those of a triangle in rising order go around the polygon's way.
        let walked_as_ring = |t: &[u32; 3]| {
            let mut sorted = *t;
            sorted.sort_unstable();
            sorted
        };
        let mut triangles: Vec<[u32; 3]> = self.cut.as_chunks().0.iter().map(walked_as_ring).collect();
        let sides = (0..corners as u32).map(|i| (i, (i + 1) % corners as u32));
        put_back_dropped_corners(sides, &mut triangles);
        (triangles.len() == corners - 2).then_some(triangles)
    }
}

fn fan(corners: usize) -> impl Iterator<Item = [u32; 3]> {
    (2..corners as u32).map(|i| [0, i - 1, i])
}

/// `corners` as seen along the axis that `ring`, the first of them, faces most, so that it is counter-clockwise; false if it faces nowhere.
///
/// Coordinates are only picked, not turned, so that corners in line stay exactly in line.
fn flatten(ring: &[DVec3], corners: &[DVec3], flat: &mut Vec<DVec2>) -> bool {
    let first = ring[0];
    let normal: DVec3 = ring.windows(2).map(|side| (side[0] - first).cross(side[1] - first)).sum();
    let size = normal.abs();
    if !(size.max_element() > 0.0 && normal.is_finite()) {
        return false;
    }
    let axis = if size.z >= size.x.max(size.y) {
        2
    } else if size.y >= size.x {
        1
    } else {
        0
    };
    let (mut across, mut up) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (across, up) = (up, across);
    }
    flat.clear();
    flat.extend(corners.iter().map(|&p| p - first).map(|p| DVec2::new(p[across], p[up])));
    true
}

/// Adds triangles without area where `triangles` leave out corners that lie on a straight line (or on one another), as
/// ear cutting does. `sides` are those of the polygon, walked as the triangles walk them.
///
/// Each side of a triangle should meet one of the polygon's own or a triangle that walks it the other way. What is left
/// over are loops, flat as a line; each is filled with a fan.
fn put_back_dropped_corners(sides: impl Iterator<Item = (u32, u32)>, triangles: &mut Vec<[u32; 3]>) {
    let mut uncovered: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    let mut count = |from: u32, to: u32, times: i32| {
        let sign = if from < to { times } else { -times };
        *uncovered.entry((from.min(to), from.max(to))).or_default() += sign;
    };
    for (from, to) in sides {
        count(from, to, 1);
    }
    for &[a, b, c] in triangles.iter() {
        count(a, b, -1);
        count(b, c, -1);
        count(c, a, -1);
    }
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for ((low, high), times) in uncovered {
        let (from, to) = if times > 0 { (low, high) } else { (high, low) };
        for _ in 0..times.unsigned_abs() {
            next.entry(from).or_default().push(to);
        }
    }
    while let Some((&start, _)) = next.first_key_value() {
        let mut previous = start;
        while let Some(corner) = take_side(&mut next, previous) {
            if corner == start {
                break;
            }
            if previous != start {
                triangles.push([start, previous, corner]);
            }
            previous = corner;
        }
    }
}

/// Removes a side that starts at `from`, and says where it ends.
fn take_side(next: &mut BTreeMap<u32, Vec<u32>>, from: u32) -> Option<u32> {
    let ends = next.get_mut(&from)?;
    let to = ends.pop();
    if ends.is_empty() {
        next.remove(&from);
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(ring: &[DVec3]) -> (Vec<[u32; 3]>, Cut) {
        let mut triangles = Vec::new();
        let cut = Triangulator::new().triangulate(ring, |t| triangles.push(t));
        (triangles, cut)
    }

    fn ring(corners: &[[f64; 2]]) -> Vec<DVec3> {
        // A slanted plane that faces down, so that no projection is trivial.
        corners.iter().map(|&[x, y]| DVec3::new(x, -y, 0.5 * x - 2.0 * y)).collect()
    }

    fn area(ring: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let corner = |i: u32| ring[i as usize];
        triangles.iter().map(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length() / 2.0).sum()
    }

    fn area_of_outline(ring: &[DVec3]) -> f64 {
        ring.windows(2).map(|s| (s[0] - ring[0]).cross(s[1] - ring[0])).sum::<DVec3>().length() / 2.0
    }

    /// The boundary of the triangles is the ring: every other side is walked as often forward as back.
    fn assert_outline_is_the_ring(corners: u32, triangles: &[[u32; 3]]) {
        let mut sides = BTreeMap::<(u32, u32), i32>::new();
        for &[a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *sides.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
        sides.retain(|_, times| *times != 0);
        let expected: BTreeMap<_, _> =
            (0..corners).map(|i| if i + 1 < corners { ((i, i + 1), 1) } else { ((0, i), -1) }).collect();
        assert_eq!(sides, expected);
    }

    #[test]
    fn a_convex_polygon_is_a_fan() {
        let square = ring(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 3.0], [0.0, 2.0]]);
        assert_eq!(triangles(&square), (vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]], Cut::Exact));
    }

    #[test]
    fn a_concave_polygon_is_covered_once_and_nothing_else_is() {
        let arrow = ring(&[[0.0, 0.0], [4.0, -2.0], [1.0, 0.0], [4.0, 2.0]]);
        let comb = ring(&[
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 0.0],
            [3.0, 0.0],
            [3.0, 2.0],
            [4.0, 2.0],
            [4.0, 0.0],
            [5.0, 0.0],
            [5.0, 3.0],
        ]);
        for polygon in [arrow, comb] {
            let (triangles, cut) = triangles(&polygon);
            assert_eq!((triangles.len(), cut), (polygon.len() - 2, Cut::Exact));
            assert!((area(&polygon, &triangles) - area_of_outline(&polygon)).abs() < 1e-12);
            assert_outline_is_the_ring(polygon.len() as u32, &triangles);
        }
    }

    #[test]
    fn corners_on_a_straight_side_and_doubled_corners_are_kept() {
        // An L whose long sides have corners in their middles, one of them twice.
        let l = ring(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [4.0, 0.0],
            [4.0, 1.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [1.0, 4.0],
            [0.0, 4.0],
            [0.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ]);
        for start in 0..l.len() {
            let mut turned = l.clone();
            turned.rotate_left(start);
            let (triangles, cut) = triangles(&turned);
            assert_eq!((triangles.len(), cut), (l.len() - 2, Cut::Exact), "from corner {start}");
            assert!((area(&turned, &triangles) - area_of_outline(&turned)).abs() < 1e-12);
            assert_outline_is_the_ring(l.len() as u32, &triangles);
        }
    }

    #[test]
    fn a_wall_with_a_window_joined_by_a_cut_is_covered_once() {
        let wall = ring(&[
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
        ]);
        let (triangles, cut) = triangles(&wall);
        assert_eq!((triangles.len(), cut), (8, Cut::Exact));
        assert!((area(&wall, &triangles) - area_of_outline(&wall)).abs() < 1e-12);
        assert_outline_is_the_ring(10, &triangles);
    }

    #[test]
    fn polygons_that_can_not_be_cut_are_fans() {
        let nowhere = vec![DVec3::NAN; 5];
        assert_eq!(triangles(&nowhere), (vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]], Cut::Fan));
        let needle = [0.0, 1.0, 2.0, 3.0].map(|x| DVec3::X * x);
        assert_eq!(triangles(&needle).1, Cut::Fan);
    }

    #[test]
    fn fewer_than_three_corners_have_no_triangle() {
        for corners in 0..3 {
            assert!(triangles(&vec![DVec3::ONE; corners]).0.is_empty());
        }
    }
}
