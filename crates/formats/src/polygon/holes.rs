//! A polygon with holes, cut into triangles along its own corners.
//!
//! With n corners on h + 1 rings that are n + 2h - 2 triangles (fewer where rings touch), whose outline are the rings: the outer one walked in its
//! own direction, the holes against it, whichever way they were given.

use glam::{DVec2, DVec3};

use super::{Cut, MAX_EARCUT_CORNERS, Triangulator, fan, flatten, put_back_dropped_corners};

/// How much area, of that of the outer ring, triangles may have too much or too little: rounding.
const AREA_TOLERANCE: f64 = 1e-9;

impl Triangulator {
    /// Calls `add` with each triangle of a polygon, as positions in `corners`; walked as the outer ring is.
    ///
    /// `corners` has the outer ring and then the holes; each of `hole_starts`, in order, is where a hole begins. A hole must
    /// have three corners or more.
    ///
    /// If the rings cross, or can't be cut, the triangles may cover something else too, but their outline is the same.
    pub(crate) fn triangulate_with_holes(
        &mut self,
        corners: &[DVec3],
        hole_starts: &[u32],
        mut add: impl FnMut([u32; 3]),
    ) -> Cut {
        let Some(&outer_end) = hole_starts.first() else { return self.triangulate(corners, add) };
        let outer = &corners[..outer_end as usize];
        if outer.len() >= 3 && corners.len() <= MAX_EARCUT_CORNERS && flatten(outer, corners, &mut self.flat) {
            let rings = Rings { flat: &self.flat, hole_starts };
            self.earcut.earcut(self.flat.iter().map(DVec2::to_array), hole_starts, &mut self.cut);
            let mut triangles: Vec<[u32; 3]> = self.cut.as_chunks().0.to_vec();
            // All of them go around the same way.
            if rings.area_of(&triangles) < 0.0 {
                triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            }
            put_back_dropped_corners(rings.sides(), &mut triangles);
            let cut = if rings.are_covered_by(&triangles) { Cut::Exact } else { Cut::Fan };
            triangles.into_iter().for_each(add);
            return cut;
        }
        let ends = hole_starts.iter().copied().chain([corners.len() as u32]);
        let starts = [0].into_iter().chain(hole_starts.iter().copied());
        for (start, end) in starts.zip(ends) {
            fan((end - start) as usize).for_each(|triangle| add(triangle.map(|i| start + i)));
        }
        Cut::Fan
    }
}

/// A polygon in the plane, its outer ring counter-clockwise.
#[derive(Clone, Copy)]
struct Rings<'a> {
    flat: &'a [DVec2],
    hole_starts: &'a [u32],
}

impl<'a> Rings<'a> {
    /// Each ring, and whether it is a hole.
    fn iter(self) -> impl Iterator<Item = (std::ops::Range<u32>, bool)> + 'a {
        let starts = [0].into_iter().chain(self.hole_starts.iter().copied());
        let ends = self.hole_starts.iter().copied().chain([self.flat.len() as u32]);
        starts.zip(ends).map(|(start, end)| (start..end, start > 0))
    }

    /// The sides as triangles that cover the polygon walk them.
    fn sides(self) -> impl Iterator<Item = (u32, u32)> + 'a {
        self.iter().flat_map(move |(ring, is_hole)| {
            let is_reversed = is_hole && signed_area(&self.flat[ring.start as usize..ring.end as usize]) > 0.0;
            let count = ring.end - ring.start;
            (0..count).map(move |i| {
                let side = (ring.start + i, ring.start + (i + 1) % count);
                if is_reversed { (side.1, side.0) } else { side }
            })
        })
    }

    fn area_of(self, triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|&t| self.area_of_one(t)).sum()
    }

    fn area_of_one(self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|i| self.flat[i as usize]);
        (b - a).perp_dot(c - a) / 2.0
    }

    fn are_covered_by(self, triangles: &[[u32; 3]]) -> bool {
        let ring_area =
            |ring: std::ops::Range<u32>| signed_area(&self.flat[ring.start as usize..ring.end as usize]).abs();
        let outer = ring_area(0..self.hole_starts[0]);
        let holes: f64 = self.iter().filter(|(_, is_hole)| *is_hole).map(|(ring, _)| ring_area(ring)).sum();
        let covered: f64 = triangles.iter().map(|&t| self.area_of_one(t).abs()).sum();
        (covered - (outer - holes)).abs() <= AREA_TOLERANCE * outer
    }
}

/// Positive if the ring goes around counter-clockwise.
fn signed_area(ring: &[DVec2]) -> f64 {
    let first = ring[0];
    ring.windows(2).map(|side| (side[0] - first).perp_dot(side[1] - first)).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// A slanted plane that faces down, so that no projection is trivial.
    fn slanted([x, y]: [f64; 2]) -> DVec3 {
        DVec3::new(x, -y, 0.5 * x - 2.0 * y)
    }

    fn square(x: f64, y: f64, side: f64) -> Vec<DVec3> {
        [[x, y], [x + side, y], [x + side, y + side], [x, y + side]].map(slanted).to_vec()
    }

    fn cut(rings: &[Vec<DVec3>]) -> (Vec<DVec3>, Vec<u32>, Vec<[u32; 3]>, Cut) {
        let starts = rings[1..].iter().scan(rings[0].len() as u32, |start, ring| {
            let this = *start;
            *start += ring.len() as u32;
            Some(this)
        });
        let starts: Vec<u32> = starts.collect();
        let corners = rings.concat();
        let mut triangles = Vec::new();
        let cut = Triangulator::new().triangulate_with_holes(&corners, &starts, |t| triangles.push(t));
        (corners, starts, triangles, cut)
    }

    /// How often each side is walked, back and forth cancelling.
    fn outline(triangles: &[[u32; 3]]) -> BTreeMap<(u32, u32), i32> {
        let mut sides = BTreeMap::new();
        for &[a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *sides.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
        sides.retain(|_, times: &mut i32| *times != 0);
        sides
    }

    fn area(corners: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            (b - a).cross(c - a).length() / 2.0
        };
        triangles.iter().map(area).sum::<f64>() / DVec3::new(0.5, -2.0, -1.0).length()
    }

    #[test]
    fn holes_stay_open_whichever_way_they_are_walked() {
        for flips in 0..4 {
            let mut rings = vec![square(0.0, 0.0, 10.0), square(1.0, 1.0, 2.0), square(5.0, 5.0, 3.0)];
            // A corner on a straight side of a hole, which ear cutting drops.
            rings[1].insert(1, slanted([2.0, 1.0]));
            (0..2).filter(|hole| flips >> hole & 1 == 1).for_each(|hole| rings[1 + hole].reverse());
            let (corners, _, triangles, cut) = cut(&rings);
            assert_eq!((triangles.len(), cut), (13 + 4 - 2, Cut::Exact));
            assert!((area(&corners, &triangles) - (100.0 - 4.0 - 9.0)).abs() < 1e-9);
            let outline = outline(&triangles);
            assert_eq!(outline.len(), 13, "each side of the three rings once: {outline:?}");
            assert_eq!(outline[&(0, 1)], 1, "walked as the outer ring is");
            for (hole, side) in [(0, (4, 5)), (1, (9, 10))] {
                let expected = if flips >> hole & 1 == 1 { 1 } else { -1 };
                assert_eq!(outline[&side], expected, "walked against the outer ring");
            }
        }
    }

    #[test]
    fn a_courtyard_that_leaves_its_house_is_told_and_the_outline_stays() {
        let (_, _, triangles, cut) = cut(&[square(0.0, 0.0, 4.0), square(2.0, 2.0, 4.0)]);
        assert_eq!(cut, Cut::Fan);
        let outline = outline(&triangles);
        assert_eq!((outline.len(), outline[&(0, 1)], outline[&(4, 5)]), (8, 1, -1));
    }

    #[test]
    fn what_has_no_area_or_no_numbers_is_cut_somehow() {
        let needle = || vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert_eq!(cut(&[needle(), needle()]).3, Cut::Fan);
        let nowhere = || vec![DVec3::NAN; 3];
        assert_eq!(cut(&[square(0.0, 0.0, 4.0), nowhere()]).3, Cut::Fan);
        assert_eq!(cut(&[nowhere(), square(0.0, 0.0, 4.0)]).3, Cut::Fan);
    }
}
