//! What is left of the sun's disc behind faces: their union taken off, and its area in closed form.
//!
//! ```text
//!    .--------.      A face hides the places that are inside of all its edges: of as many half-planes as it has edges, each bounded by the plane
//!    |  ______|__    through the receiver and the edge. What is left of the square around the disc is kept as convex pieces; each face cuts
//!    | |   f  |  |   each piece along its edges, and what is inside of all goes. Nothing is counted twice, however faces overlap, and the
//!    '-|------'  |   areas of the disc in the pieces add up.
//!      '---------'
//! ```
//!
//! A piece that is cut keeps its area to the last digits, so the share is known to about 1e-12, and there is no grid. What hides most is taken off first, so that
//! little is left to cut however many faces there are: of the thousands before a sun on the horizon a few hide it all. Where that does not help (a crown of leaves)
//! pieces become many: with more than [`MANY`] the outlines of all faces are united by [`united`] instead, whose grid of 2^-49 of the disc's radius moves the share by
//! less than 1e-12 as well.
//!
//! The half-planes are the planes by which penumbra wedges are bounded (U. Assarsson and T. Akenine-Möller 2003), seen from a point instead of from
//! the light; there is no wedge here, as all edges that matter are looked at together.

use glam::{DVec2, DVec3};
use umbrae_core::disc_share;

use crate::outline::united;
use crate::sun_disc::{HalfPlane, ON_LINE, SQUARE, SunDisc, split};

/// Of so many pieces at most each face cuts each.
const MANY: usize = 400;

/// A face in whose plane a receiver lies, so near as can be told, hides nothing; in metres.
const IN_PLANE_M: f64 = 1e-9;

/// The places that a convex face hides: those in all of its half-planes.
#[derive(Debug, Clone, Copy)]
struct Hidden {
    half_planes: [HalfPlane; 4],
    count: usize,
}

impl Hidden {
    fn half_planes(&self) -> &[HalfPlane] {
        &self.half_planes[..self.count]
    }

    /// How far inside of it the middle of the disc is: what hides most is asked first.
    fn depth(&self) -> f64 {
        self.half_planes().iter().map(|half_plane| half_plane.offset).fold(f64::INFINITY, f64::min)
    }
}

/// Convex polygons, one after the other.
#[derive(Debug, Clone, Default)]
struct Pieces {
    corners: Vec<DVec2>,
    ends: Vec<usize>,
}

impl Pieces {
    fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    /// Adds a piece, unless all of the disc is beyond one of its edges.
    fn add(&mut self, piece: &[DVec2]) {
        let edges = || piece.iter().zip(piece.iter().cycle().skip(1));
        let is_beside = |(&a, &b): (&DVec2, &DVec2)| a.perp_dot(b) <= -a.distance(b);
        if piece.len() > 2 && !edges().any(is_beside) {
            self.corners.extend_from_slice(piece);
            self.ends.push(self.corners.len());
        }
    }

    fn iter(&self) -> impl Iterator<Item = &[DVec2]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(&start, &end)| &self.corners[start..end])
    }
}

/// What one receiver sees of the sun. Made once and used for many, as it keeps its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Remainder {
    hidden: Vec<Hidden>,
    /// Whether one of the faces hides all.
    is_dark: bool,
    pieces: Pieces,
    next: Pieces,
    rest: [Vec<DVec2>; 3],
}

impl Remainder {
    /// Begins anew, with all of the disc.
    pub(super) fn clear(&mut self) {
        self.hidden.clear();
        self.is_dark = false;
    }

    /// Takes off what is not on the side of `normal` of the plane through the receiver.
    pub(super) fn keep(&mut self, disc: &SunDisc, normal: DVec3) {
        let kept = disc.half_plane(normal);
        self.take_off(Hidden { half_planes: [kept.flipped(); 4], count: 1 });
    }

    /// Takes off what a face hides with its corners at `corners` seen from the receiver, in order around it; of a triangle the last stands twice. One that is not
    /// two-sided hides only if its corners go round counter-clockwise seen from the sun's side: the sun's rays leave a closed surface through such faces.
    pub(super) fn hide(&mut self, disc: &SunDisc, corners: &[DVec3; 4], is_two_sided: bool) {
        let [a, b, c, d] = *corners;
        if c == d {
            self.hide_convex(disc, &[a, b, c], is_two_sided);
            return;
        }
        // The two triangles meet in the edge from b to d. Seen edge-on by a receiver, four corners that are not quite in one plane need not be convex.
        let turns = [turn(a, b, c), turn(b, c, d), turn(c, d, a), turn(d, a, b)];
        if turns.iter().all(|&turn| turn > 0.0) || turns.iter().all(|&turn| turn < 0.0) {
            self.hide_convex(disc, corners, is_two_sided);
        } else {
            self.hide_convex(disc, &[a, b, d], is_two_sided);
            self.hide_convex(disc, &[b, c, d], is_two_sided);
        }
    }

    fn hide_convex(&mut self, disc: &SunDisc, corners: &[DVec3], is_two_sided: bool) {
        let [a, b, c] = [corners[0], corners[1], corners[2]];
        let normal = (b - a).cross(c - a);
        // Times the length of the normal, as is what it is compared with.
        let distance = normal.dot(a);
        if distance.abs() <= IN_PLANE_M * normal.length() || (distance < 0.0 && !is_two_sided) {
            return;
        }
        let mut hidden = Hidden { half_planes: [disc.half_plane(DVec3::ZERO); 4], count: corners.len() };
        for (i, half_plane) in hidden.half_planes[..corners.len()].iter_mut().enumerate() {
            let (from, to) = (corners[i], corners[(i + 1) % corners.len()]);
            // The plane through the receiver and the edge.
            let plane = from.cross(to - from);
            *half_plane = disc.half_plane(if distance < 0.0 { -plane } else { plane });
        }
        self.take_off(hidden);
    }

    fn take_off(&mut self, hidden: Hidden) {
        if hidden.half_planes().iter().any(HalfPlane::misses_disc) {
            return;
        }
        self.is_dark |= hidden.half_planes().iter().all(HalfPlane::holds_disc);
        self.hidden.push(hidden);
    }

    /// The share of the disc that is left, 0 to 1.
    pub(super) fn share(&mut self) -> f64 {
        if self.is_dark {
            return 0.0;
        }
        if self.hidden.is_empty() {
            return 1.0;
        }
        let share = self.share_of_pieces(MANY).unwrap_or_else(|| self.share_beside_union());
        // What rounding leaves of nothing is nothing.
        if share < ON_LINE { 0.0 } else { share.min(1.0) }
    }

    /// `None` where there are more than `most` pieces.
    fn share_of_pieces(&mut self, most: usize) -> Option<f64> {
        self.hidden.sort_by(|a, b| b.depth().total_cmp(&a.depth()));
        self.pieces.clear();
        self.pieces.add(&SQUARE);
        for hidden in &self.hidden {
            self.next.clear();
            for piece in self.pieces.iter() {
                cut(piece, hidden.half_planes(), &mut self.next, &mut self.rest);
            }
            std::mem::swap(&mut self.pieces, &mut self.next);
            if self.pieces.ends.is_empty() {
                return Some(0.0);
            }
            if self.pieces.ends.len() > most {
                return None;
            }
        }
        Some(disc_share(self.pieces.iter()))
    }

    fn share_beside_union(&mut self) -> f64 {
        let outlines: Vec<Vec<DVec2>> = self.hidden.iter().map(outline).filter(|ring| ring.len() > 2).collect();
        1.0 - disc_share(united(&outlines).iter().map(Vec::as_slice))
    }
}

/// Twice the signed volume of (0, a, b, c), times three: positive where they turn counter-clockwise seen from behind.
fn turn(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    a.dot((b - a).cross(c - a))
}

/// Adds to `left` what `piece` has outside of some of `half_planes`, in convex pieces.
fn cut(piece: &[DVec2], half_planes: &[HalfPlane], left: &mut Pieces, rest: &mut [Vec<DVec2>; 3]) {
    let is_beside = |half_plane: &HalfPlane| piece.iter().all(|&p| half_plane.depth(p) <= ON_LINE);
    if half_planes.iter().any(is_beside) {
        left.add(piece);
        return;
    }
    let [rest, inside, outside] = rest;
    rest.clear();
    rest.extend_from_slice(piece);
    for half_plane in half_planes {
        if rest.iter().all(|&p| half_plane.depth(p) >= -ON_LINE) {
            continue;
        }
        inside.clear();
        outside.clear();
        split(rest, half_plane, inside, outside);
        left.add(outside);
        std::mem::swap(rest, inside);
        if rest.len() < 3 {
            break;
        }
    }
}

/// What is hidden of the square around the disc, counter-clockwise.
fn outline(hidden: &Hidden) -> Vec<DVec2> {
    let mut ring = SQUARE.to_vec();
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    for half_plane in hidden.half_planes() {
        inside.clear();
        outside.clear();
        split(&ring, half_plane, &mut inside, &mut outside);
        std::mem::swap(&mut ring, &mut inside);
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// A triangle that a receiver sees before the disc, about so many radii large.
    fn triangle(disc: &SunDisc, random: &mut Random, size: f64) -> [DVec3; 4] {
        let mut place = || 2.0 * DVec2::new(random.unit(), random.unit()) - 1.0;
        let (middle, offsets) = (place(), [place(), place(), place()]);
        let mut corner = |offset: DVec2| disc.direction(middle + size * offset) * (10.0 + 20.0 * random.unit());
        let [a, b, c] = offsets.map(&mut corner);
        [a, b, c, c]
    }

    #[test]
    fn pieces_and_the_united_outlines_leave_the_same() {
        let disc = SunDisc::new(DVec3::new(0.48, -0.6, 0.64));
        let (mut remainder, mut random) = (Remainder::default(), Random(1));
        let mut partial = 0;
        for round in 0..400 {
            remainder.clear();
            for _ in 0..round % 40 + 1 {
                remainder.hide(&disc, &triangle(&disc, &mut random, 0.3 + 0.05 * f64::from(round % 7)), true);
            }
            let pieces = remainder.share_of_pieces(usize::MAX).expect("as many as there are");
            let union = remainder.share_beside_union();
            assert!((pieces - union).abs() < 1e-11, "round {round}: {pieces} and {union}");
            partial += usize::from(pieces > 0.01 && pieces < 0.99);
        }
        assert!(partial > 200, "{partial} show something");
    }

    #[test]
    fn two_faces_one_behind_the_other_hide_what_the_larger_does() {
        let disc = SunDisc::new(DVec3::Z);
        let square = |half: f64, distance: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|at| disc.direction(half * DVec2::from(at)) * distance)
        };
        let mut remainder = Remainder::default();
        for faces in [vec![(0.5, 3.0)], vec![(0.5, 3.0), (0.25, 7.0)], vec![(0.25, 2.0), (0.5, 9.0)]] {
            remainder.clear();
            faces.iter().for_each(|&(half, distance)| remainder.hide(&disc, &square(half, distance), true));
            let share = remainder.share();
            assert!((share - (1.0 - 1.0 / std::f64::consts::PI)).abs() < 1e-12, "{faces:?}: {share}");
        }
    }

    #[test]
    fn a_face_behind_the_receiver_hides_nothing_and_one_through_its_level_only_what_is_before_it() {
        let disc = SunDisc::new(DVec3::Z);
        let mut remainder = Remainder::default();
        let (near, far) = (-5.0, 5.0);
        remainder.hide(
            &disc,
            &[[0.0, near, -1.0], [9.0, near, -1.0], [9.0, far, -1.0], [0.0, far, -1.0]].map(DVec3::from),
            true,
        );
        assert_eq!(remainder.share(), 1.0);
        // A wall through x = 0, from below to far above: it is seen edge-on, and the roof on it hides one half.
        remainder.hide(
            &disc,
            &[[0.0, near, -9.0], [0.0, far, -9.0], [0.0, far, 9.0], [0.0, near, 9.0]].map(DVec3::from),
            true,
        );
        assert_eq!(remainder.share(), 1.0);
        // Leaning over the receiver from behind it: all from x = 0 to 4 above, at any height.
        remainder.hide(
            &disc,
            &[[0.0, near, 1.0], [4.0, near, -3.0], [4.0, far, -3.0], [0.0, far, 1.0]].map(DVec3::from),
            true,
        );
        assert!((remainder.share() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn one_sided_faces_hide_only_where_rays_leave_through_them() {
        let disc = SunDisc::new(DVec3::Z);
        let up = [[-1.0, -1.0, 5.0], [1.0, -1.0, 5.0], [1.0, 1.0, 5.0], [-1.0, 1.0, 5.0]].map(DVec3::from);
        let down = [up[0], up[3], up[2], up[1]];
        let share = |corners: &[DVec3; 4], is_two_sided| {
            let mut remainder = Remainder::default();
            remainder.hide(&disc, corners, is_two_sided);
            remainder.share()
        };
        assert_eq!([share(&up, false), share(&down, false), share(&down, true)], [0.0, 1.0, 0.0]);
    }
}
