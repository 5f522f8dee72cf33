//! Where a light ends: its range, and the cone of a spot.

use glam::DVec3;

use crate::Light;

/// What a device makes of a distance and an angle in `f32` is good to this, relative to the distance: an offset, a
/// length or a dot product, a cosine, a product and a difference, each of a rounding or two (2^-24 each).
const BLUR: f64 = 8e-7;

/// Whether `light` gives anything, if nothing is between, to a point from which it is `to_light` away; `None` on its
/// border, as far as a device can tell that knows the point to within `point_blur_m`.
///
/// Nothing at its range and beyond, nothing at the outer angle and beyond.
pub(super) fn reaches(light: &Light, to_light: DVec3, point_blur_m: f64) -> Option<bool> {
    if light.position.is_directional() {
        return Some(true);
    }
    let distance = to_light.length();
    let blur = point_blur_m + BLUR * (distance + light.position.homogeneous().truncate().abs().max_element());
    // How far inside each border the point is.
    let in_range = light.range_m.map_or(f64::INFINITY, |range| range - distance);
    let in_cone = light.cone.map_or(f64::INFINITY, |cone| {
        let along = -cone.axis.dot(to_light);
        let across = (-to_light - cone.axis * along).length();
        let (sin, cos) = cone.outer_rad.sin_cos();
        along * sin - across * cos
    });
    let inside = in_range.min(in_cone);
    if inside < -blur {
        Some(false)
    } else if inside > blur {
        Some(true)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cone, LightPosition};

    /// Shines down from (0, 0, 5), 30 degrees around, 10 m far.
    fn spot() -> Light {
        let cone = Cone { axis: DVec3::NEG_Z, inner_rad: 0.0, outer_rad: 30_f64.to_radians() };
        let position = LightPosition::point(DVec3::new(0.0, 0.0, 5.0));
        Light { cone: Some(cone), range_m: Some(10.0), ..Light::new("spot", position, glam::Vec3::ONE) }
    }

    fn at(x: f64, z: f64) -> Option<bool> {
        let spot = spot();
        reaches(&spot, spot.position.offset_from(DVec3::new(x, 0.0, z)), 1e-6)
    }

    #[test]
    fn a_spot_gives_nothing_outside_its_cone_and_nothing_behind_it() {
        let radius = 5.0 * 30_f64.to_radians().tan();
        assert_eq!(at(0.0, 0.0), Some(true));
        assert_eq!(at(radius - 1e-4, 0.0), Some(true));
        assert_eq!(at(radius, 0.0), None, "on the border");
        assert_eq!(at(radius + 1e-4, 0.0), Some(false));
        assert_eq!(at(0.0, 6.0), Some(false), "behind");
        assert_eq!(at(0.0, 5.0), None, "at the light itself");
    }

    #[test]
    fn beyond_its_range_a_light_gives_nothing() {
        assert_eq!(at(0.0, -4.9999), Some(true));
        assert_eq!(at(0.0, -5.0), None);
        assert_eq!(at(0.0, -5.0001), Some(false));
        assert_eq!(at(10.0, -5.0), Some(false), "neither in the cone nor in range");
    }

    #[test]
    fn half_of_space_is_a_cone_too() {
        let mut spot = spot();
        spot.cone = spot.cone.map(|cone| Cone { outer_rad: std::f64::consts::FRAC_PI_2, ..cone });
        let reaches = |z: f64| reaches(&spot, spot.position.offset_from(DVec3::new(3.0, 0.0, z)), 1e-6);
        assert_eq!([4.999, 5.0, 5.001].map(reaches), [Some(true), None, Some(false)]);
    }

    #[test]
    fn a_directional_light_has_no_end() {
        let sun = Light { position: LightPosition::sun(1.0, 0.5), ..spot() };
        assert_eq!(reaches(&sun, sun.position.offset_from(DVec3::splat(1e6)), 1e-6), Some(true));
    }
}
