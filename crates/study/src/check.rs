//! A second way to the same answer: rays in double precision, one for each verdict, through a structure that shares nothing with the engine's.

use std::f64::consts::FRAC_PI_4;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::random::Random;
use crate::{Blockers, Exposure, Packets, Receivers, SunDisc};

/// What a check has found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Check {
    /// Receivers that were asked.
    pub receivers: usize,
    /// Verdicts that were compared: receivers times the steps by day.
    pub verdicts: usize,
    /// Verdicts that differ.
    pub disagreements: usize,
    /// Of those that differ, how many are within [`Blockers::margin_m`] of an edge of a shadow.
    pub undecided: usize,
}

impl Check {
    /// Both together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            receivers: self.receivers + other.receivers,
            verdicts: self.verdicts + other.verdicts,
            disagreements: self.disagreements + other.disagreements,
            undecided: self.undecided + other.undecided,
        }
    }
}

impl Blockers {
    /// Casts a ray for every step that is not `None` in `suns`, from every `every`th receiver of the packets in `exposure`, and compares.
    ///
    /// Which receivers depends on their place in the packets alone. About a microsecond for each verdict, on all threads.
    ///
    /// # Panics
    ///
    /// If there are not as many suns as steps in `exposure`, or `every` is 0.
    pub fn check(
        &self,
        receivers: &Receivers,
        packets: &Packets,
        exposure: &Exposure,
        suns: &[Option<DVec3>],
        every: usize,
    ) -> Check {
        assert_eq!(suns.len(), exposure.step_count, "a sun for each step");
        let sampled = exposure.packets.clone().into_par_iter().flat_map_iter(|packet| {
            let first = packet * crate::PACKET;
            (0..packets.members(packet).len())
                .filter(move |lane| (first + lane).is_multiple_of(every))
                .map(move |lane| (packet, lane))
        });
        let check_one = |(packet, lane): (usize, usize)| {
            let r = packets.members(packet)[lane];
            let (position, normal) = (receivers.positions[r as usize], receivers.normals[r as usize]);
            let mut check = Check { receivers: 1, ..Check::default() };
            for (step, to_sun) in suns.iter().enumerate().filter_map(|(step, sun)| Some((step, (*sun)?))) {
                check.verdicts += 1;
                if self.sees(position, normal, to_sun) != exposure.is_lit(packet, lane, step) {
                    check.disagreements += 1;
                    check.undecided += usize::from(exposure.undecided.binary_search(&(r, step as u32)).is_ok());
                }
            }
            check
        };
        sampled.map(check_one).reduce(Check::default, Check::plus)
    }

    /// The share of the sun's disc that `side` times `side` rays find unhidden, one to a random place in each of as many equal parts of the disc: an estimate of
    /// [`Blockers::visible_share`] that shares nothing with it. The same on every run. About a microsecond a ray.
    ///
    /// A ray errs only where its part is cut by the edge of something: by one straight edge about a thousandth of the disc (one standard deviation) with 64 times 64
    /// rays, and by whatever there is at most 0.5 / `side`.
    pub fn visible_share_by_rays(&self, position: DVec3, normal: Vec3, to_sun: DVec3, side: u32) -> f64 {
        let disc = SunDisc::new(to_sun);
        let bits = [position.x, position.y, position.z, to_sun.x, to_sun.y, to_sun.z].map(f64::to_bits);
        let mut random = Random(bits.iter().fold(0, |seed, &bits| seed ^ bits).wrapping_mul(0x2545_f491_4f6c_dd1d));
        let mut seen = 0_u32;
        for part in 0..side * side {
            let [x, y] =
                [part % side, part / side].map(|i| 2.0 * (f64::from(i) + random.unit()) / f64::from(side) - 1.0);
            let direction = disc.direction(in_disc(DVec2::new(x, y)));
            seen += u32::from(direction.z > 0.0 && self.sees(position, normal, direction));
        }
        f64::from(seen) / f64::from((side * side).max(1))
    }
}

/// A place of the square around the disc, on the disc: equal areas stay equal.
///
/// Source: P. Shirley and K. Chiu, "A low distortion map between disk and square", Journal of Graphics Tools 2(3), 1997.
fn in_disc(place: DVec2) -> DVec2 {
    if place == DVec2::ZERO {
        return place;
    }
    let (radius, angle) = if place.x.abs() > place.y.abs() {
        (place.x, FRAC_PI_4 * place.y / place.x)
    } else {
        (place.y, FRAC_PI_4 * (2.0 - place.x / place.y))
    };
    radius * DVec2::from_angle(angle)
}
