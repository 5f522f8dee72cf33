//! How finely a curve must be cut so that its shadow looks smooth.

use glam::DVec3;

use crate::{Bounds, Camera, LightPosition};

/// A horizontal receiver stretches a shadow by one over the sine of the light's altitude; below this sine no more is allowed for.
const LEAST_SINE: f64 = 0.05;

/// How far the pieces of a smooth silhouette may be from the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Precision {
    /// In the world, metres; more than 0. The epsilon of O. Mattausch et al. 2012, section 3.3.
    pub epsilon_m: f64,
    /// And where the curve's shadow is seen, if that is known; both hold.
    pub on_screen: Option<OnScreen>,
}

/// What is known about where shadows are seen, to bound the error in pixels of the shadow.
///
/// The paper's authors say that this would be the ideal but that the size of the projection is not known. Its bound is: a point's shadow is on its ray from the
/// light, in the box of all that may receive it, and seen no larger than from the nearest place on that part of the ray.
#[derive(Debug, Clone, PartialEq)]
pub struct OnScreen {
    /// How far a shadow may be off, pixels.
    pub epsilon_px: f64,
    /// Who sees it, scene space.
    pub eye: DVec3,
    /// The width of a pixel at view depth 1.
    pub pixel_at_1: f64,
    /// All that may receive a shadow is in there.
    pub receivers: Bounds,
}

impl OnScreen {
    /// So many pixels, more than 0, as `camera` sees shadows within `receivers`.
    pub fn of_camera(camera: &Camera, receivers: Bounds, epsilon_px: f64) -> Self {
        let pixel_at_1 = 2.0 * camera.half_extent().y / f64::from(camera.size_px()[1]);
        Self { epsilon_px, eye: camera.eye(), pixel_at_1, receivers }
    }

    /// How far a curve may be off at `point`; `None` where its shadow falls outside of all receivers.
    fn epsilon_m(&self, point: DVec3, light: LightPosition) -> Option<f64> {
        let away = -light.offset_from(point);
        let [near, far] = within(&self.receivers, point, away)?;
        let nearest = ((self.eye - point).dot(away) / away.length_squared()).clamp(near, far);
        let on_ray = |t: f64| {
            let enlarged = if light.is_directional() { 1.0 } else { 1.0 + t };
            self.pixel_at_1 * (point + away * t).distance(self.eye) / enlarged
        };
        let pixel_m = on_ray(near).min(on_ray(far)).min(on_ray(nearest));
        let sine = (away.z.abs() / away.length()).max(LEAST_SINE);
        Some(self.epsilon_px * pixel_m * sine)
    }
}

impl Precision {
    /// `epsilon_m` in the world alone.
    pub fn in_world(epsilon_m: f64) -> Self {
        Self { epsilon_m, on_screen: None }
    }

    /// How far a chord may be off its curve at `point`, under `light`: half of what is allowed, which leaves the other half to the curve.
    pub(super) fn chord_m(&self, point: DVec3, light: LightPosition) -> f64 {
        let on_screen = self.on_screen.as_ref().and_then(|on_screen| on_screen.epsilon_m(point, light));
        0.5 * on_screen.map_or(self.epsilon_m, |epsilon_m| epsilon_m.min(self.epsilon_m))
    }
}

/// Where the ray from `origin` is in `bounds`, in lengths of `direction`.
fn within(bounds: &Bounds, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let at = |side: f64| (side - origin[axis]) / direction[axis];
        if direction[axis] == 0.0 {
            if origin[axis] < bounds.min[axis] || origin[axis] > bounds.max[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = (at(bounds.min[axis]), at(bounds.max[axis]));
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    (near <= far && far.is_finite()).then_some([near, far])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ground() -> Bounds {
        Bounds { min: DVec3::new(-50.0, -50.0, -1.0), max: DVec3::new(50.0, 50.0, 0.0) }
    }

    fn above(height_m: f64) -> Camera {
        Camera::new(DVec3::new(0.0, -0.01, height_m), DVec3::ZERO, 60_f64.to_radians(), 0.1, [800, 600]).expect("good")
    }

    #[test]
    fn a_shadow_that_is_enlarged_eight_times_needs_an_eighth_of_the_error() {
        let precision = Precision { epsilon_m: 1.0, on_screen: Some(OnScreen::of_camera(&above(40.0), ground(), 0.5)) };
        let lamp = LightPosition::point(DVec3::new(0.0, 0.0, 8.0));
        let [high, low] = [7.0, 1.0].map(|z| precision.chord_m(DVec3::new(0.0, 0.0, z), lamp));
        assert!((low / high - 7.0).abs() < 0.3, "{low} and {high}: enlarged 8/7 and 8 times, 9 at the ground's bottom");
    }

    #[test]
    fn without_a_receiver_the_world_alone_counts() {
        let precision =
            Precision { epsilon_m: 0.25, on_screen: Some(OnScreen::of_camera(&above(40.0), ground(), 0.5)) };
        let from_below = LightPosition::directional(DVec3::NEG_Z).expect("not zero");
        assert_eq!(precision.chord_m(DVec3::Z, from_below).to_bits(), 0.125_f64.to_bits());
    }

    #[test]
    fn a_low_sun_stretches_shadows_and_makes_them_finer() {
        let precision = Precision { epsilon_m: 1.0, on_screen: Some(OnScreen::of_camera(&above(40.0), ground(), 0.5)) };
        let at = |altitude_deg: f64| {
            let sun = LightPosition::sun(1.0, altitude_deg.to_radians());
            precision.chord_m(DVec3::new(0.0, 0.0, 1.0), sun)
        };
        assert!(at(6.0) < 0.2 * at(60.0));
    }
}
