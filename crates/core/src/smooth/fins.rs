//! What rises from the fold to the silhouette where a cut triangle's curve is straight, in as few faces as will do.
//!
//! ```text
//!    pa -------------- pc       Each triangle that the silhouette cuts has a fin, of two faces. Where the silhouette leaves
//!    |  '-_            |        out a point b, two fins become one, and a third face closes what is between their feet.
//!    |      '-_        |
//!    |          '-_    |
//!    qa ------ qb ---- qc
//! ```

use super::straight::{MANY, NONE, link};
use super::volume::SmoothVolume;

/// Straight fins, of which each goes from a crossing to another.
#[derive(Debug, Default, Clone)]
pub(super) struct Fins {
    list: Vec<[u32; 2]>,
    /// Of each crossing the one that a fin comes from, and the one that a fin goes to.
    beside: Vec<[u32; 2]>,
}

/// The points of the volume at a crossing: on the silhouette, and the fin's foot.
pub(super) fn points_of(crossing: u32) -> [u32; 2] {
    [2 * crossing, 2 * crossing + 1]
}

impl Fins {
    pub(super) fn clear(&mut self) {
        self.list.clear();
    }

    pub(super) fn extend(&mut self, list: &[[u32; 2]]) {
        self.list.extend(list);
    }

    /// To be done once all fins are there: finds those that go on from each other, between so many crossings.
    pub(super) fn link(&mut self, crossings: usize) {
        link(&mut self.beside, crossings, &self.list);
    }

    /// Makes one of the fins from point `a` of a silhouette to `b` and from there to `c`, and returns the face between their feet; `None` if there are
    /// none, or others too.
    pub(super) fn merge(&mut self, [a, b, c]: [u32; 3]) -> Option<[u32; 3]> {
        let crossing_at = |p: u32| ((p as usize) < 2 * self.beside.len() && p.is_multiple_of(2)).then_some(p / 2);
        let [a, b, c] = [crossing_at(a)?, crossing_at(b)?, crossing_at(c)?];
        let beside = &mut self.beside;
        let are_alone = beside[a as usize][1] == b && beside[b as usize] == [a, c] && beside[c as usize][0] == b;
        are_alone.then(|| {
            (beside[a as usize][1], beside[c as usize][0]) = (c, a);
            beside[b as usize] = [NONE; 2];
            let [foot, between, end] = [a, b, c].map(|crossing| points_of(crossing)[1]);
            [foot, end, between]
        })
    }

    /// Adds them to `volume`.
    pub(super) fn add_to(&self, volume: &mut SmoothVolume) {
        for &[a, b] in &self.list {
            let last = match self.beside[a as usize][1] {
                // It has become part of another.
                NONE => continue,
                MANY => b,
                next => next,
            };
            let ([from, foot], [to, end]) = (points_of(a), points_of(last));
            volume.faces.extend([[foot, from, to], [foot, to, end]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// What is left of the borders of what closes a silhouette through the crossings 0, 1 and 2, and of its `sides`.
    fn open_borders(faces: &[[u32; 3]], sides: &[[u32; 2]]) -> Vec<([u32; 2], i32)> {
        let of_faces = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let of_sides = sides.iter().map(|&[a, b]| [b, a]);
        let mut times = BTreeMap::<[u32; 2], i32>::new();
        for [a, b] in of_faces.chain(of_sides) {
            *times.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
        times.into_iter().filter(|(_, times)| *times != 0).collect()
    }

    #[test]
    fn where_a_point_is_left_out_two_fins_become_one_with_the_same_border() {
        let fins = |merged: bool| {
            let (mut fins, mut volume) = (Fins::default(), SmoothVolume::default());
            fins.extend(&[[1, 2], [0, 1]]);
            fins.link(3);
            if merged {
                volume.faces.push(fins.merge([0, 2, 4]).expect("they go on from each other"));
            }
            fins.add_to(&mut volume);
            volume.faces
        };
        let (two, one) = (fins(false), fins(true));
        assert_eq!([two.len(), one.len()], [4, 3]);
        assert_eq!(open_borders(&two, &[[0, 2], [2, 4]]), open_borders(&one, &[[0, 4]]));
    }

    #[test]
    fn fins_that_meet_others_stay() {
        let mut fins = Fins::default();
        fins.extend(&[[0, 1], [1, 2], [3, 1]]);
        fins.link(4);
        assert_eq!([fins.merge([0, 2, 4]), fins.merge([0, 3, 4]), fins.merge([8, 2, 4])], [None; 3]);
        let mut volume = SmoothVolume::default();
        fins.add_to(&mut volume);
        assert_eq!(volume.faces.len(), 6);
    }
}
