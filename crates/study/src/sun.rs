//! Where the sun is, and which way that is in a scene.

use glam::DVec3;

/// The sun as seen from one place at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Clockwise from true north, in radians, 0 <= azimuth < 2π.
    pub azimuth_rad: f64,
    /// Above the horizon, in radians; negative at night.
    pub altitude_rad: f64,
}

impl Sun {
    /// Unit vector from the scene to the sun; x east, y north, z up.
    ///
    /// `north_rad` is where true north is in the scene: clockwise from the y axis. With a map projection it is minus the
    /// meridian convergence (grid north as seen from true north, clockwise positive).
    pub fn direction(&self, north_rad: f64) -> DVec3 {
        let (sin_azimuth, cos_azimuth) = (self.azimuth_rad + north_rad).sin_cos();
        let (sin_altitude, cos_altitude) = self.altitude_rad.sin_cos();
        DVec3::new(cos_altitude * sin_azimuth, cos_altitude * cos_azimuth, sin_altitude)
    }
}
