//! Place and period of a study, from what was asked and what the models say.

use anyhow::{Context as _, ensure};
use glam::DVec3;
use umbrae_study::{ClockKind, Place, Refraction, Timetable};

use super::frame::Frame;
use super::scene::Models;
use super::site::Site;
use crate::cli::StudyArgs;

/// A place further than this from where the models are is a slip of the keyboard.
const SUSPICIOUS_DISTANCE_KM: f64 = 50.0;
/// What is nearer than this to the zero of a coordinate reference system is hardly ever in it, but about a zero of its own.
const SUSPICIOUS_ORIGIN_M: f64 = 1000.0;
/// Kilometres in a degree of latitude.
const DEGREE_KM: f64 = 111.2;

/// Where and when `args` and `models` have it; with what there is to warn of.
///
/// # Errors
///
/// When the place is not known, or the period is none.
pub(super) fn moments(
    args: &StudyArgs,
    models: &Models,
    frame: &Frame,
) -> anyhow::Result<(Site, Timetable, Vec<String>)> {
    let middle = models.bounds().center();
    let mut warnings = Vec::new();
    let (place, place_from) = match args.place.place()? {
        Some(place) => {
            warnings.extend(far_away(&place, frame, middle));
            (place, "--lat and --lon")
        }
        None => {
            let lon_lat = frame.to_lon_lat(middle).context(
                "where on Earth the models are is not known, as they have no coordinate reference system; give --lat and --lon, or --crs",
            )?;
            warnings.extend(at_origin(lon_lat, frame, middle));
            (Place::from_degrees(lon_lat[1], lon_lat[0])?, "the models' coordinate reference system")
        }
    };
    ensure!(
        !args.period.all_dates().is_empty(),
        "no date is given; write --date 2026-09-18, or --dates 2026-02-01..2026-03-21"
    );
    let period = args.period.period(args.place.zone(&place));
    let options = args.period.sun_options();
    let timetable = Timetable::new(&place, &period, &options)?;
    warnings.extend(period.notes());
    let zone = period.clock.zone.clone();
    let north_rad = args.north.map(f64::to_radians).or_else(|| frame.true_north_rad(middle)).unwrap_or(0.0);
    let mut clock = zone.name().to_owned();
    if period.clock.kind == ClockKind::Solar {
        clock = format!("true solar time, calendar of {clock}");
    } else if zone.is_derived() {
        clock += " by the place";
    }
    let sun = if options.refraction == Refraction::None {
        "geometric, without refraction"
    } else {
        "apparent, with standard refraction"
    };
    let site = Site { place, zone, options, place_from, clock, north_deg: north_rad.to_degrees(), sun };
    Ok((site, timetable, warnings))
}

/// A warning, if `place` is far from where the models' own system has them.
fn far_away(place: &Place, frame: &Frame, middle: DVec3) -> Option<String> {
    let [lon_deg, lat_deg] = frame.to_lon_lat(middle)?;
    let north = place.latitude_deg() - lat_deg;
    let east = (place.longitude_deg() - lon_deg + 180.0).rem_euclid(360.0) - 180.0;
    let distance_km = DEGREE_KM * north.hypot(east * lat_deg.to_radians().cos());
    (distance_km > SUSPICIOUS_DISTANCE_KM).then(|| {
        format!(
            "--lat and --lon are {distance_km:.0} km from where the models' coordinate reference system has them, at {lat_deg:.4},{lon_deg:.4}"
        )
    })
}

/// A warning, if the models are where their system, in which they are at this longitude and latitude, begins.
fn at_origin([lon_deg, lat_deg]: [f64; 2], frame: &Frame, middle: DVec3) -> Option<String> {
    let epsg = frame.crs.as_ref()?.epsg();
    (frame.to_model(middle).truncate().length() < SUSPICIOUS_ORIGIN_M).then(|| {
        format!(
            "the models are at the zero of EPSG:{epsg}, and so at {lat_deg:.4},{lon_deg:.4}; if their coordinates are only their own, give --lat and --lon"
        )
    })
}
