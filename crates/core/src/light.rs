//! Lights, in the homogeneous form that makes points and directions one case.
//!
//! Source: M. McGuire et al., "Fast, practical and robust shadows", 2003, section 4.

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
    /// The distance, in metres, at which the light has faded to nothing; infinite for `None`, and for any directional light.
    ///
    /// The fading is glTF's: inverse square times `1 - (distance / range)^4`.
    pub range_m: Option<f64>,
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
    /// A light that shines all around and without end.
    pub fn new(name: impl Into<String>, position: LightPosition, strength: Vec3) -> Self {
        Self { name: name.into(), position, strength, cone: None, range_m: None }
    }

    /// The distance at which a light without a range falls below what a display can show, when `exposure` takes strength to display units.
    ///
    /// With this as its range, the window changes what is seen by less than that too, because the window takes away
    /// `strength / distance^2 * (distance / range)^4`, which is at most `strength / range^2`.
    pub fn visible_range_m(&self, exposure: f32) -> f64 {
        (f64::from(self.strength.max_element() * exposure) / INVISIBLE).sqrt()
    }
}
