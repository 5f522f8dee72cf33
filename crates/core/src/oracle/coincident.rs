//! Surfaces so little behind the first that no depth buffer can tell them apart.
//!
//! Some models have faces twice, or fold a face over its neighbour in one plane. What is drawn there may be any of them: where they differ
//! in what the light gives them, nothing is decided. And an edge of any of them is an edge in what is seen: the volume that hangs on it may
//! come out in front there, though a ray that meets all of them at one depth reports another triangle as the first.

use glam::DVec3;

use super::cut_out::Presence;
use super::{Eye, INTERPOLATION, Oracle, Seen, Sight};
use crate::Hit;

impl Oracle {
    /// What the ray that sees `seen` first would see behind it, if it is within what a depth buffer can tell; in no particular order.
    pub(super) fn coincident(&self, eye: &Eye, direction: DVec3, seen: &Seen) -> Vec<Sight> {
        let mut others = Vec::new();
        self.for_each_coincident(eye, direction, seen, |hit| others.push(self.sight_of(eye, direction, hit)));
        others
    }

    /// Whether what is behind `seen`, as in [`Oracle::coincident`], is the triangles of `others`.
    pub(super) fn are_coincident(&self, eye: &Eye, direction: DVec3, seen: &Seen, others: &[Sight]) -> bool {
        let (mut count, mut are_known) = (0, true);
        self.for_each_coincident(eye, direction, seen, |hit| {
            count += 1;
            are_known &= others.iter().any(|other| other.surface() == Some((Some(hit.part), hit.triangle)));
        });
        are_known && count == others.len()
    }

    fn for_each_coincident(&self, eye: &Eye, direction: DVec3, seen: &Seen, mut visit: impl FnMut(Hit)) {
        let first = seen.hit;
        let blur = self.depth_blur(eye, &first);
        let most = INTERPOLATION * (first.t / eye.near).max(1.0) * self.scale.max(eye.position.abs().max_element());
        self.seen.for_each_hit(eye.position, direction, first.t, first.t + 2.0 * most, |hit| {
            let is_other = (hit.part, hit.triangle) != (first.part, first.triangle);
            if is_other
                && hit.t - first.t <= blur + self.depth_blur(eye, &hit)
                && self.presence(eye, direction, &hit) != Presence::Hole
            {
                visit(hit);
            }
        });
    }

    /// How far the depth that is drawn may be from where the ray hits: the corners' depths are sums of products as large as the corners' and
    /// the eye's coordinates, and are interpolated.
    fn depth_blur(&self, eye: &Eye, hit: &Hit) -> f64 {
        let corners = self.seen.corners(hit).map(|corner| corner.abs().max_element());
        self.blur(eye, hit) * corners.into_iter().fold(eye.position.abs().max_element(), f64::max)
    }
}
