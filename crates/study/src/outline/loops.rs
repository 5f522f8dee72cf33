//! Directed edges, in any order, into closed loops.
//!
//! The boundary of a chain arrives at each of its corners as often as it leaves, so whoever follows it, taking each edge once, gets stuck only
//! where the walk began. Which way is taken where several go on changes the loops, but not how often they wind around a point.

use glam::DVec2;

/// A corner of a shadow's boundary: a vertex twice, or the two ends of an edge that goes through the plane.
pub(super) type Corner = [u32; 2];

/// The closed loops of `sides`, as corners; every side is in one of them.
///
/// Takes n log n for n sides.
pub(super) fn loops(mut sides: Vec<[Corner; 2]>, place: impl Fn(Corner) -> DVec2) -> Vec<Vec<DVec2>> {
    sides.sort_unstable();
    let first_from = |corner: Corner| sides.partition_point(|&[start, _]| start < corner);
    // How many are taken of the sides that start where this one does; counted at the first of them.
    let mut taken = vec![0; sides.len()];
    let mut loops = Vec::new();
    let mut first = 0;
    while first < sides.len() {
        let mut walk = Vec::new();
        let mut at = first;
        while let Some(&[start, end]) = sides.get(at + taken[at]).filter(|&&[start, _]| start == sides[at][0]) {
            taken[at] += 1;
            walk.push(place(start));
            at = first_from(end);
            assert!(at < sides.len(), "a boundary goes on from each of its corners");
        }
        if walk.is_empty() {
            first += taken[first];
        } else {
            loops.push(walk);
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_side_is_walked_once_and_every_walk_comes_home() {
        // A figure of eight through corner 1, a triangle walked twice.
        let edges = [[0, 1], [1, 2], [2, 0], [1, 3], [3, 4], [4, 1], [5, 6], [6, 7], [7, 5], [5, 6], [6, 7], [7, 5]];
        let sides: Vec<_> = edges.map(|[a, b]| [[a, a], [b, b]]).to_vec();
        let found = loops(sides, |[v, _]| DVec2::splat(f64::from(v)));
        let mut walked: Vec<[u32; 2]> = Vec::new();
        for ring in &found {
            walked.extend(super::super::ring_edges(ring).map(|edge| edge.map(|p| p.x as u32)));
        }
        walked.sort_unstable();
        let mut expected = edges;
        expected.sort_unstable();
        assert_eq!(walked, expected);
    }
}
