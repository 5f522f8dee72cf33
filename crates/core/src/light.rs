//! Lights, in the homogeneous form that makes points and directions one case.
//!
//! Source: M. McGuire et al., "Fast, practical and robust shadows", 2003, section 4.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec3, DVec4, Vec3};

/// Below this, light can't be seen: half a step of an 8-bit display.
const INVISIBLE: f64 = 1.0 / 512.0;

/// Where a light is: `(x, y, z, 1)` for a point, `(x, y, z, 0)` for the direction *towards* a light at infinity.
///
/// Scene space (metres about the scene origin). Never `(0, 0, 0, 0)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightPosition(DVec4);

impl LightPosition {
    /// A light at `position`, shining in every direction.
    pub fn point(position: DVec3) -> Self {
        Self(position.extend(1.0))
    }

    /// A light infinitely far away in the direction `towards_light`, which need not be of unit length.
    ///
    /// `None` when the direction is zero or not finite.
    pub fn directional(towards_light: DVec3) -> Option<Self> {
        towards_light.try_normalize().map(|d| Self(d.extend(0.0)))
    }

    /// The sun at `azimuth_rad` clockwise from north and `altitude_rad` above the horizon.
    pub fn sun(azimuth_rad: f64, altitude_rad: f64) -> Self {
        let (sin_azimuth, cos_azimuth) = azimuth_rad.sin_cos();
        let (sin_altitude, cos_altitude) = altitude_rad.sin_cos();
        Self(DVec4::new(sin_azimuth * cos_altitude, cos_azimuth * cos_altitude, sin_altitude, 0.0))
    }

    /// The four coordinates; `w` is 0 or 1.
    pub fn homogeneous(self) -> DVec4 {
        self.0
    }

    /// The same light after rounding to what a GPU is told, so that both reason about one light.
    pub fn rounded_to_f32(self) -> Self {
        Self(self.0.as_vec4().as_dvec4())
    }

    /// The same light seen from an origin that is `-offset` away; directions stay.
    pub fn moved_by(self, offset: DVec3) -> Self {
        Self(self.0 + (offset * self.0.w).extend(0.0))
    }

    /// Whether the light is infinitely far away.
    pub fn is_directional(self) -> bool {
        self.0.w == 0.0
    }

    /// From `point` to the light: the exact offset for a point light, the unit direction for a directional one.
    pub fn offset_from(self, point: DVec3) -> DVec3 {
        self.0.truncate() - point * self.0.w
    }
}

/// A light and what it gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// What reports and pictures call it.
    pub name: String,
    /// Where it is.
    pub position: LightPosition,
    /// Linear colour times strength: irradiance for a directional light, intensity (irradiance at 1 m) for a point.
    pub strength: Vec3,
    /// Where a spot light shines; `None` shines all around. Without meaning for a directional light.
    pub cone: Option<Cone>,
    /// The distance, in metres, at which the light has faded to nothing; infinite for `None`, and for any directional
    /// light.
    ///
    /// The fading is glTF's: inverse square times `1 - (distance / range)^4`.
    pub range_m: Option<f64>,
    /// How large it is about its position: only soft shadows look at that, everything else takes it for a point or a direction.
    pub extent: Extent,
}

/// How large a light is, evenly bright from every side that it is seen from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Extent {
    /// A point or a direction: its shadows are hard.
    #[default]
    Point,
    /// A ball about a point light. From everywhere it is seen as a disc of this radius that faces the seen point.
    Sphere {
        /// Above 0, in metres.
        radius_m: f64,
    },
    /// A rectangle about a point light, `position +- half_right +- half_up`, at a right angle to each other. It shines to the side from which
    /// right, up and the way to it are a right-handed system: `half_right x half_up` points there.
    Rectangle {
        /// From its middle to the middle of its right side, in metres.
        half_right: DVec3,
        /// From its middle to the middle of its upper side, in metres.
        half_up: DVec3,
    },
    /// A disc about the direction to a directional light, as the sun's is.
    Disc {
        /// Above 0 and below pi / 2.
        radius_rad: f64,
    },
}

impl Extent {
    /// The radius, in metres, of a ball about the light's position that holds all of it; 0 for a point, and for what is at infinity.
    pub fn radius_m(&self) -> f64 {
        match *self {
            Self::Point | Self::Disc { .. } => 0.0,
            Self::Sphere { radius_m } => radius_m,
            Self::Rectangle { half_right, half_up } => half_right.length().hypot(half_up.length()),
        }
    }

    fn rounded_to_f32(self) -> Self {
        let round = |v: DVec3| v.as_vec3().as_dvec3();
        match self {
            Self::Point => Self::Point,
            Self::Sphere { radius_m } => Self::Sphere { radius_m: f64::from(radius_m as f32) },
            Self::Rectangle { half_right, half_up } => {
                Self::Rectangle { half_right: round(half_right), half_up: round(half_up) }
            }
            Self::Disc { radius_rad } => Self::Disc { radius_rad: f64::from(radius_rad as f32) },
        }
    }
}

/// The cone of a spot light: full strength within the inner angle, nothing beyond the outer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// The unit direction in which the light shines.
    pub axis: DVec3,
    /// From the axis; 0 <= inner < outer.
    pub inner_rad: f64,
    /// From the axis; at most pi / 2.
    pub outer_rad: f64,
}

impl Light {
    /// A point that shines all around and without end, or a direction.
    pub fn new(name: impl Into<String>, position: LightPosition, strength: Vec3) -> Self {
        Self { name: name.into(), position, strength, cone: None, range_m: None, extent: Extent::Point }
    }

    /// The same light after rounding to what a GPU is told (position, axis, angles, range and extent), so that both reason
    /// about one light.
    pub fn rounded_to_f32(&self) -> Self {
        let round = |number: f64| f64::from(number as f32);
        // The nearest f32 to a right angle is above it.
        let round_angle = |angle_rad: f64| round(angle_rad).min(FRAC_PI_2);
        Self {
            position: self.position.rounded_to_f32(),
            cone: self.cone.map(|cone| Cone {
                axis: cone.axis.as_vec3().as_dvec3(),
                inner_rad: round_angle(cone.inner_rad),
                outer_rad: round_angle(cone.outer_rad),
            }),
            range_m: self.range_m.map(round),
            extent: self.extent.rounded_to_f32(),
            ..self.clone()
        }
    }

    /// The distance at which a light without a range falls below what a display can show, when `exposure` takes
    /// strength to display units.
    ///
    /// With this as its range, the window changes what is seen by less than that too, because the window takes away
    /// `strength / distance^2 * (distance / range)^4`, which is at most `strength / range^2`.
    pub fn visible_range_m(&self, exposure: f32) -> f64 {
        (f64::from(self.strength.max_element() * exposure) / INVISIBLE).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_a_light_twice_is_rounding_it_once() {
        let axis = DVec3::new(0.3, -0.2, -0.9).normalize_or_zero();
        let cone = Some(Cone { axis, inner_rad: 0.1, outer_rad: FRAC_PI_2 });
        let position = LightPosition::point(DVec3::new(0.1, 0.2, 0.3));
        let extent = Extent::Rectangle { half_right: DVec3::new(0.1, 0.2, 0.3), half_up: DVec3::Z * 0.7 };
        let light = Light { cone, range_m: Some(7.7), extent, ..Light::new("spot", position, Vec3::ONE) };
        let rounded = light.rounded_to_f32();
        assert_eq!(rounded.rounded_to_f32(), rounded);
        assert_eq!(rounded.range_m, Some(f64::from(7.7_f32)));
        assert_eq!(rounded.cone.map(|c| c.outer_rad), Some(FRAC_PI_2), "never beyond a right angle");
    }
}
