//! Where the sun is, and which way that is in a scene.
//!
//! NREL's solar position algorithm, by the crate `solar-positioning`: within 0.0003 degrees in the years -2000 to 6000 of a clock that keeps
//! terrestrial time. How far the Earth's rotation lags behind that is estimated by polynomials: to tenths of a second for 1970 to today, a few
//! seconds by 2050, minutes before 1600; each second moves the sun by 0.00001 degrees along the ecliptic. What the air does
//! near the horizon is not known better than to a tenth of a degree.
//!
//! Source: I. Reda and A. Andreas, "Solar position algorithm for solar radiation applications", NREL/TP-560-34302, 2003, revised 2008.

use std::f64::consts::TAU;

use glam::DVec3;
use jiff::Timestamp;
use solar_positioning::{RefractionCorrection, SolarPositions};
use umbrae_core::SUN_DIAMETER_RAD;

use crate::julian::julian;
use crate::{Place, TimeError};

/// The sun as seen from one place at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Clockwise from true north, in radians, 0 <= azimuth < 2π.
    pub azimuth_rad: f64,
    /// Above the horizon, in radians; negative at night.
    pub altitude_rad: f64,
}

/// How the sun is seen, and when it counts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SunOptions {
    /// What the air does to its light. By default as in a standard atmosphere, so that the sun is where it is seen.
    pub refraction: Refraction,
    /// Lower than this the sun does not count: 0 to π/2. 0 by default; a sun on the horizon never counts.
    pub min_altitude_rad: f64,
    /// What terrestrial time is ahead of universal time, in seconds. By default an estimate for the moment.
    pub delta_t_s: Option<f64>,
}

/// How the air bends the light of the sun: upwards, by half a degree on the horizon.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Refraction {
    /// 1013.25 hPa and 15 °C.
    #[default]
    Standard,
    /// No air: the sun where geometry has it.
    None,
    /// Some other air.
    Air {
        /// Of the place itself, not reduced to sea level; above 0, up to 2000.
        pressure_hpa: f64,
        /// Above -273, up to 100.
        temperature_c: f64,
    },
}

impl Sun {
    /// The middle of the sun's disc at `time`.
    ///
    /// Takes some 10 microseconds; [`crate::SunPath`] is fifty times as fast where many moments of few days are asked for. At a pole
    /// azimuths are what they are on the meridian of the place's longitude.
    ///
    /// # Errors
    ///
    /// [`TimeError::NoSun`] outside the years -500 to 3000, or [`TimeError::Air`].
    ///
    /// # Example
    ///
    /// ```
    /// use umbrae_study::{Place, Sun, SunOptions};
    ///
    /// let vienna = Place::from_degrees(48.21, 16.37)?;
    /// let noon = "2026-06-21T10:56:00Z".parse().expect("a moment");
    /// let sun = Sun::at(&vienna, noon, &SunOptions::default())?;
    /// assert!((sun.altitude_rad.to_degrees() - 65.2).abs() < 0.1);
    /// # Ok::<(), umbrae_study::TimeError>(())
    /// ```
    pub fn at(place: &Place, time: Timestamp, options: &SunOptions) -> Result<Self, TimeError> {
        let air = options.refraction.correction()?;
        let no_sun = |_| TimeError::NoSun { time };
        let moment = julian(time, options.delta_t_s)?;
        let seen =
            SolarPositions::new().at_from_julian(moment, place.location(), place.elevation_m(), air).map_err(no_sun)?;
        let azimuth_rad = seen.azimuth().to_radians();
        // 359.99... degrees may round up to all of 2π.
        let azimuth_rad = if azimuth_rad >= TAU { 0.0 } else { azimuth_rad };
        Ok(Self { azimuth_rad, altitude_rad: seen.elevation_angle().to_radians() })
    }

    /// Whether it is high enough to count: above the horizon, and not below the least altitude of `options`.
    pub fn counts(&self, options: &SunOptions) -> bool {
        self.altitude_rad > 0.0 && self.altitude_rad >= options.min_altitude_rad
    }

    /// The same for the sun as a disc: whether some of it is above the horizon, and its middle not below the least altitude of `options`.
    ///
    /// Without a least altitude that is from the moment in which the disc's upper edge rises; what is still below the horizon then is hidden
    /// ([`crate::SunDisc::share_above_horizon`]). A least altitude is one of the middle, as rules have it: from there on all of the disc counts.
    pub fn counts_as_disc(&self, options: &SunOptions) -> bool {
        let least = if options.min_altitude_rad > 0.0 { options.min_altitude_rad } else { -0.5 * SUN_DIAMETER_RAD };
        self.altitude_rad > -0.5 * SUN_DIAMETER_RAD && self.altitude_rad >= least
    }

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

impl Refraction {
    /// As the algorithm takes it.
    pub(crate) fn correction(self) -> Result<Option<RefractionCorrection>, TimeError> {
        match self {
            Self::Standard => Ok(Some(RefractionCorrection::standard())),
            Self::None => Ok(None),
            Self::Air { pressure_hpa, temperature_c } => RefractionCorrection::new(pressure_hpa, temperature_c)
                .map(Some)
                .map_err(|_| TimeError::Air { pressure_hpa, temperature_c }),
        }
    }
}
