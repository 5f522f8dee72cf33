//! A place on Earth.

use std::f64::consts::PI;

use solar_positioning::Location;

use crate::TimeError;

/// Between the shore of the Dead Sea and the summit of Mount Everest, with room to spare.
const ELEVATIONS_M: std::ops::RangeInclusive<f64> = -500.0..=10_000.0;

/// A place on Earth (WGS 84), checked.
///
/// ```
/// use umbrae_study::Place;
///
/// let vienna = Place::from_degrees(48.21, 16.37)?;
/// assert!((vienna.latitude_deg() - 48.21).abs() < 1e-12);
/// assert!(Place::from_degrees(95.0, 16.37).is_err());
/// # Ok::<(), umbrae_study::TimeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    latitude_rad: f64,
    longitude_rad: f64,
    elevation_m: f64,
}

impl Place {
    /// At sea level; north and east are positive.
    ///
    /// A longitude may be from -180 to 180 or, as some maps count, eastwards to 360: 190 is -170. Nothing else is put back into
    /// range, for it is more likely a mistake than a way around the Earth.
    ///
    /// # Errors
    ///
    /// [`TimeError::Latitude`] and [`TimeError::Longitude`] for anything else, NaN included.
    pub fn from_degrees(latitude_deg: f64, longitude_deg: f64) -> Result<Self, TimeError> {
        if !(-90.0..=90.0).contains(&latitude_deg) {
            return Err(TimeError::Latitude { degrees: latitude_deg });
        }
        if !(-180.0..=360.0).contains(&longitude_deg) {
            return Err(TimeError::Longitude { degrees: longitude_deg });
        }
        let longitude_deg = if longitude_deg > 180.0 { longitude_deg - 360.0 } else { longitude_deg };
        Ok(Self {
            latitude_rad: latitude_deg.to_radians(),
            longitude_rad: longitude_deg.to_radians(),
            elevation_m: 0.0,
        })
    }

    /// The same, `elevation_m` metres above the sea: the sun's parallax changes by a hundred-thousandth of a second of arc for each, and
    /// the horizon is not lowered.
    ///
    /// # Errors
    ///
    /// [`TimeError::Elevation`] if that is not from -500 to 10000.
    pub fn with_elevation(self, elevation_m: f64) -> Result<Self, TimeError> {
        if ELEVATIONS_M.contains(&elevation_m) {
            Ok(Self { elevation_m, ..self })
        } else {
            Err(TimeError::Elevation { metres: elevation_m })
        }
    }

    /// North is positive, -π/2 to π/2.
    pub fn latitude_rad(&self) -> f64 {
        self.latitude_rad
    }

    /// East is positive, -π to π.
    pub fn longitude_rad(&self) -> f64 {
        self.longitude_rad
    }

    /// Above the sea.
    pub fn elevation_m(&self) -> f64 {
        self.elevation_m
    }

    /// North is positive, -90 to 90.
    pub fn latitude_deg(&self) -> f64 {
        self.latitude_rad.to_degrees()
    }

    /// East is positive, -180 to 180.
    pub fn longitude_deg(&self) -> f64 {
        self.longitude_rad.to_degrees()
    }

    /// What mean solar time is ahead of UTC here, in seconds, -12 h to 12 h.
    pub(crate) fn mean_solar_offset_s(&self) -> f64 {
        self.longitude_rad / PI * 43_200.0
    }

    /// As the sun's algorithms take it. Degrees to radians and back may end a rounding beyond the last degree.
    pub(crate) fn location(&self) -> Location {
        Location {
            latitude: self.latitude_deg().clamp(-90.0, 90.0),
            longitude: self.longitude_deg().clamp(-180.0, 180.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_on_earth_is_no_place() {
        for (latitude, longitude) in [(95.0, 0.0), (-90.1, 0.0), (f64::NAN, 0.0), (f64::INFINITY, 0.0)] {
            let refused = Place::from_degrees(latitude, longitude);
            assert!(matches!(refused, Err(TimeError::Latitude { .. })), "{latitude}");
        }
        for longitude in [-180.1, 360.1, f64::NAN, f64::NEG_INFINITY] {
            let refused = Place::from_degrees(0.0, longitude);
            assert!(matches!(refused, Err(TimeError::Longitude { .. })), "{longitude}");
        }
        let sentence = Place::from_degrees(95.0, 0.0).expect_err("it is beyond the pole").to_string();
        assert_eq!(sentence, "a latitude of 95.0 is not on Earth; write degrees from -90 (south) to 90 (north)");
    }

    #[test]
    fn poles_and_the_date_line_are_places_and_190_east_is_170_west() {
        for (latitude, longitude) in [(90.0, 180.0), (-90.0, -180.0)] {
            let place = Place::from_degrees(latitude, longitude).expect("it is on Earth");
            assert_eq!((place.location().latitude, place.location().longitude), (latitude, longitude));
        }
        let tonga = Place::from_degrees(-21.1, 184.8).expect("it is on Earth");
        assert!((tonga.longitude_deg() - -175.2).abs() < 1e-9);
    }

    #[test]
    fn an_elevation_in_feet_of_a_satellite_is_refused() {
        let place = Place::from_degrees(0.0, 0.0).expect("it is on Earth");
        assert!(place.with_elevation(8848.0).is_ok());
        assert!(place.with_elevation(1.3e6).is_err() && place.with_elevation(f64::NAN).is_err());
    }
}
