//! Where on earth a model is: coordinate reference systems by their EPSG codes.
//!
//! ```text
//!   file's numbers --(unit)--> metres, x east, y north --(projection, datum)--> longitude, latitude on WGS 84
//! ```
//!
//! Definitions are those of the crate `crs-definitions`, the arithmetic is that of `proj4rs`, which follows PROJ 4.
//! Projections agree with PROJ to a micrometre. Datums are shifted by three or seven parameters, which is good to about a
//! metre for most national systems (decimetres for the Dutch, Swiss, French and Japanese ones, up to ten metres for the
//! oldest); a system whose definition has no shift at all (NAD27 among them, which takes a grid) is taken to lie on
//! WGS 84, and may be off by some hundred metres. The sun's direction changes by less than a thousandth of a degree over
//! a hundred metres. Heights are left as they are: vertical datums only name a zero.

mod identifier;
mod newer;

use std::fmt;
use std::sync::{Arc, LazyLock};

use glam::DVec2;
use proj4rs::Proj;
use proj4rs::transform::transform;

use crate::error::quoted;

/// A coordinate reference system.
///
/// Positions in it are here always metres with x east and y north, whatever unit its files are in (see [`Crs::unit_m`]);
/// but those of a geographic one are degrees, x the longitude and y the latitude.
///
/// ```
/// use glam::DVec2;
/// use umbrae_formats::Crs;
///
/// let rd_new = Crs::parse("urn:ogc:def:crs:EPSG::28992")?;
/// assert_eq!((rd_new.epsg(), rd_new.name()), (28992, "Amersfoort / RD New"));
///
/// let amersfoort = rd_new.lon_lat_of(DVec2::new(155_000.0, 463_000.0))?;
/// assert!((amersfoort - DVec2::new(5.387_204, 52.155_172)).length() < 1e-5);
/// # Ok::<(), umbrae_formats::CrsError>(())
/// ```
#[derive(Clone)]
pub struct Crs {
    epsg: u32,
    definition: crs_definitions::Def,
    projection: Arc<Proj>,
}

/// Why something has no place on earth.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrsError {
    /// The text names no system.
    #[error("{} names no coordinate reference system; write its EPSG code, like EPSG:28992", quoted(text))]
    NotAName {
        /// As given.
        text: String,
    },
    /// The code stands for nothing that we know.
    #[error("EPSG:{epsg} is no coordinate reference system that we know; name another one in which the model is")]
    Unknown {
        /// As given.
        epsg: u32,
    },
    /// The system is known, but nothing can be computed in it.
    #[error("EPSG:{epsg} ({name}) can't be used: {reason}; convert the model to another one")]
    Unusable {
        /// As given.
        epsg: u32,
        /// What it is called.
        name: &'static str,
        /// Why.
        reason: &'static str,
    },
    /// There is no such place in it.
    #[error("({x}, {y}) is not a place in EPSG:{epsg} ({name}); is the model in another system?")]
    Outside {
        /// The place, as it was given: metres, or degrees of longitude and latitude.
        x: f64,
        /// See `x`.
        y: f64,
        /// The system.
        epsg: u32,
        /// What it is called.
        name: &'static str,
    },
}

/// EPSG's code of longitude and latitude on WGS 84.
const WGS84: u32 = 4326;

static LON_LAT: LazyLock<Proj> =
    LazyLock::new(|| Proj::from_proj_string("+proj=longlat +datum=WGS84 +no_defs").expect("the simplest there is"));

/// Shifting a datum there and back is exact only to the first order of its rotations, which are seconds of arc: some
/// millimetres. Where a projection is not defined, it is off by metres and more.
const ROUND_TRIP_M: f64 = 0.05;

/// Metres in a degree of latitude, about.
const DEGREE_M: f64 = 111_320.0;

impl Crs {
    /// The system with this code. Of one that is compound, the horizontal part.
    ///
    /// # Errors
    ///
    /// [`CrsError::Unknown`]; [`CrsError::Unusable`] for one that counts from the earth's centre, whose axes point
    /// south or west, that is not in degrees though geographic, or whose projection we don't have.
    pub fn from_epsg(epsg: u32) -> Result<Self, CrsError> {
        let known = newer::known_code_of(epsg);
        let definition = u16::try_from(known).ok().and_then(crs_definitions::from_code);
        let definition = definition.ok_or(CrsError::Unknown { epsg })?;
        let name = name_in(definition.wkt);
        let unusable = |reason| CrsError::Unusable { epsg, name, reason };
        let text = definition.proj4;
        if text.contains("+proj=geocent") {
            return Err(unusable("its coordinates count from the earth's centre"));
        }
        if text.contains("+axis=") {
            return Err(unusable("its axes do not point east and north"));
        }
        if text.contains("+proj=longlat") && !definition.wkt.contains(r#"UNIT["degree""#) {
            return Err(unusable("its angles are not degrees"));
        }
        let projection = Proj::from_proj_string(text)
            .map_err(|_| unusable("its projection or the shift of its datum is missing here"))?;
        Ok(Self { epsg, definition, projection: Arc::new(projection) })
    }

    /// The system that `text` names: `28992`, `EPSG:28992`, `urn:ogc:def:crs:EPSG::28992`,
    /// `https://www.opengis.net/def/crs/EPSG/0/28992`, `urn:ogc:def:crs:OGC:1.3:CRS84`, also compound ones, of which the
    /// horizontal part counts.
    ///
    /// # Errors
    ///
    /// [`CrsError::NotAName`]; as [`Crs::from_epsg`].
    pub fn parse(text: &str) -> Result<Self, CrsError> {
        let epsg = identifier::epsg_of(text).ok_or_else(|| CrsError::NotAName { text: text.to_owned() })?;
        Self::from_epsg(epsg)
    }

    /// Longitude and latitude on WGS 84.
    pub fn wgs84() -> Self {
        Self::from_epsg(WGS84).expect("it is known")
    }

    /// The UTM zone (on WGS 84) at a longitude and latitude, in degrees; near a pole, the polar projection that belongs to
    /// UTM. On the border of two zones the eastern one; without the exceptions for Norway.
    ///
    /// # Errors
    ///
    /// [`CrsError::Outside`] if that is no place on earth.
    pub fn utm_of(lon_lat: DVec2) -> Result<Self, CrsError> {
        let lon_lat = on_earth(lon_lat).ok_or_else(|| Self::wgs84().outside(lon_lat))?;
        let zone = (((lon_lat.x + 180.0) / 6.0).floor() as u32).min(59) + 1;
        Self::from_epsg(match lon_lat.y {
            84.0.. => 32661,
            0.0.. => 32600 + zone,
            -80.0.. => 32700 + zone,
            _ => 32761,
        })
    }

    /// Its EPSG code, as it was given.
    pub fn epsg(&self) -> u32 {
        self.epsg
    }

    /// What EPSG calls it. For one that came after the definitions that we have, the name of that which it repeats.
    pub fn name(&self) -> &'static str {
        name_in(self.definition.wkt)
    }

    /// Its definition as Well-Known Text (version 1), as GIS programs read it.
    pub fn wkt(&self) -> &'static str {
        self.definition.wkt
    }

    /// Whether positions in it are longitudes and latitudes.
    pub fn is_geographic(&self) -> bool {
        self.projection.is_latlong()
    }

    /// How long a unit of x and y is in files, in metres; 1 for a geographic system, which has no length.
    pub fn unit_m(&self) -> f64 {
        if self.is_geographic() { 1.0 } else { self.projection.to_meter() }
    }

    /// How long a unit of height is in files, in metres: that of x and y, unless the system says another.
    pub fn vertical_unit_m(&self) -> f64 {
        if self.definition.proj4.contains("+vunits=") { self.projection.vto_meter() } else { self.unit_m() }
    }

    /// Whether positions in both are the same numbers: two codes of one projection, such as with and without a height.
    pub fn has_plane_of(&self, other: &Self) -> bool {
        fn plane(crs: &Crs) -> impl Iterator<Item = &'static str> {
            crs.definition.proj4.split(' ').filter(|word| !word.starts_with("+vunits="))
        }
        plane(self).eq(plane(other))
    }

    /// The longitude and latitude, in degrees on WGS 84, of a position.
    ///
    /// Computed there and back, so that a place where the projection is not defined is never given a number.
    ///
    /// # Errors
    ///
    /// [`CrsError::Outside`] if it is not a place of this system.
    pub fn lon_lat_of(&self, position: DVec2) -> Result<DVec2, CrsError> {
        let outside = || self.outside(position);
        let lon_lat = self.inverse(position).and_then(on_earth).ok_or_else(outside)?;
        let back = self.forward(lon_lat).ok_or_else(outside)?;
        let is_back = if self.is_geographic() {
            // Half a turn may lie between them.
            let apart = back - position;
            let apart = DVec2::new((apart.x + 180.0).rem_euclid(360.0) - 180.0, apart.y);
            apart.length() * DEGREE_M < ROUND_TRIP_M
        } else {
            back.distance(position) < ROUND_TRIP_M
        };
        if is_back { Ok(lon_lat) } else { Err(outside()) }
    }

    /// The position of a longitude and latitude, in degrees on WGS 84.
    ///
    /// # Errors
    ///
    /// [`CrsError::Outside`], about the longitude and latitude, if this system does not reach there.
    pub fn of_lon_lat(&self, lon_lat: DVec2) -> Result<DVec2, CrsError> {
        let outside = || self.outside(lon_lat);
        let on_earth = on_earth(lon_lat).ok_or_else(outside)?;
        let position = self.forward(on_earth).ok_or_else(outside)?;
        let back = self.inverse(position).ok_or_else(outside)?;
        let east = ((back.x - on_earth.x + 180.0).rem_euclid(360.0) - 180.0) * on_earth.y.to_radians().cos();
        let is_back = east.hypot(back.y - on_earth.y) * DEGREE_M < ROUND_TRIP_M;
        if is_back { Ok(position) } else { Err(outside()) }
    }

    /// Where a position of `self` is in `other`.
    ///
    /// # Errors
    ///
    /// [`CrsError::Outside`] if it is not a place of one of the two.
    pub fn position_in(&self, other: &Self, position: DVec2) -> Result<DVec2, CrsError> {
        if self.has_plane_of(other) { Ok(position) } else { other.of_lon_lat(self.lon_lat_of(position)?) }
    }

    /// The meridian convergence: the angle of grid north (this system's y axis) from true north at a position, in
    /// radians, clockwise positive. 0 for a geographic system.
    ///
    /// In the northern hemisphere that is positive east of a projection's central meridian. Found by going eleven metres
    /// north and south along the meridian; good to a millionth of a degree.
    ///
    /// # Errors
    ///
    /// [`CrsError::Outside`]; also within twelve metres of a pole, where no direction is north.
    pub fn convergence_rad(&self, at: DVec2) -> Result<f64, CrsError> {
        let [east, north] = self.north_step(at)?.to_array();
        Ok(if self.is_geographic() { 0.0 } else { -east.atan2(north) })
    }

    /// How much longer than on earth the way to the north is in this system at a position: 1 for a good map, 1.5 for web
    /// maps at a latitude of 48 degrees. 1 for a geographic system.
    ///
    /// # Errors
    ///
    /// As [`Crs::convergence_rad`].
    pub fn scale(&self, at: DVec2) -> Result<f64, CrsError> {
        if self.is_geographic() {
            return Ok(1.0);
        }
        let lat_rad = self.lon_lat_of(at)?.y.to_radians();
        // The radius of the meridian of WGS 84: a(1 - e²) / (1 - e² sin² lat)^1.5.
        let e2 = 0.006_694_379_990_14;
        let radius_m = 6_378_137.0 * (1.0 - e2) / (1.0 - e2 * lat_rad.sin().powi(2)).powf(1.5);
        Ok(self.north_step(at)?.length() / (2.0 * NORTH_STEP_DEG.to_radians() * radius_m))
    }

    /// The way in this system between [`NORTH_STEP_DEG`] south and north of a position.
    fn north_step(&self, at: DVec2) -> Result<DVec2, CrsError> {
        let lon_lat = self.lon_lat_of(at)?;
        let step = DVec2::new(0.0, NORTH_STEP_DEG);
        let outside = || self.outside(at);
        // Not `of_lon_lat`: its check would allow for more than is measured here.
        let end = |lon_lat| on_earth(lon_lat).and_then(|p| self.forward(p)).ok_or_else(outside);
        Ok(end(lon_lat + step)? - end(lon_lat - step)?)
    }

    fn inverse(&self, position: DVec2) -> Option<DVec2> {
        let start =
            if self.is_geographic() { on_earth(position)? * RAD } else { position / self.projection.to_meter() };
        let mut point = (start.x, start.y, 0.0);
        transform(&self.projection, &LON_LAT, &mut point).ok()?;
        Some(DVec2::new(point.0, point.1) / RAD).filter(|p| p.is_finite())
    }

    fn forward(&self, lon_lat: DVec2) -> Option<DVec2> {
        let mut point = (lon_lat.x * RAD, lon_lat.y * RAD, 0.0);
        transform(&LON_LAT, &self.projection, &mut point).ok()?;
        let end = DVec2::new(point.0, point.1);
        let end = if self.is_geographic() { end / RAD } else { end * self.projection.to_meter() };
        Some(end).filter(|p| p.is_finite())
    }

    fn outside(&self, at: DVec2) -> CrsError {
        CrsError::Outside { x: at.x, y: at.y, epsg: self.epsg, name: self.name() }
    }
}

/// Radians in a degree.
const RAD: f64 = std::f64::consts::PI / 180.0;

/// Eleven metres: the meridian bends by less than 1e-11 over that, and a micrometre's error in it turns it by 1e-7.
const NORTH_STEP_DEG: f64 = 1e-4;

/// `lon_lat` with a longitude within half a turn, if it is a place on earth. Longitudes may be given up to a whole turn.
fn on_earth(lon_lat: DVec2) -> Option<DVec2> {
    let is_place = lon_lat.is_finite() && lon_lat.x.abs() <= 360.0 && lon_lat.y.abs() <= 90.0;
    let x = if lon_lat.x.abs() <= 180.0 { lon_lat.x } else { (lon_lat.x + 180.0).rem_euclid(360.0) - 180.0 };
    is_place.then_some(DVec2::new(x, lon_lat.y))
}

/// The name at the beginning of a Well-Known Text; of a compound system that of the whole.
fn name_in(wkt: &'static str) -> &'static str {
    wkt.split('"').nth(1).unwrap_or_default()
}

impl PartialEq for Crs {
    fn eq(&self, other: &Self) -> bool {
        self.epsg == other.epsg
    }
}

impl Eq for Crs {}

impl fmt::Debug for Crs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Crs({self})")
    }
}

/// "EPSG:28992 (Amersfoort / RD New)".
impl fmt::Display for Crs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "EPSG:{} ({})", self.epsg, self.name())
    }
}

#[cfg(test)]
mod tests;
