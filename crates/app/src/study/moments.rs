//! Place and period of a study, from what was asked and what the models say.

use anyhow::Context as _;
use umbrae_study::{Clock, Edge, Period, Place, SunOptions, Timetable, Zone, parse_date, parse_step};

use super::frame::Frame;
use super::scene::Models;
use super::site::Site;
use crate::cli::StudyArgs;

/// Where and when `args` and `models` have it; with what there is to say about it.
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
    let when = &args.when;
    let (place, place_from) = match (when.lat, when.lon) {
        (Some(lat), Some(lon)) => (Place::from_degrees(lat, lon)?, "--lat and --lon"),
        _ => {
            let lon_lat = frame.to_lon_lat(middle).context(
                "nobody says where on Earth the models are: they have no coordinate reference system; give --lat and --lon, or --crs",
            )?;
            (Place::from_degrees(lon_lat[1], lon_lat[0])?, "the models' coordinate reference system")
        }
    };
    let zone = match &when.tz {
        Some(name) => Zone::named(name)?,
        None => Zone::of_place(&place),
    };
    let north_rad = when.north.map(f64::to_radians).or_else(|| frame.true_north_rad(middle)).unwrap_or(0.0);
    let period = Period {
        clock: Clock::civil(zone),
        dates: when.dates.iter().map(|date| parse_date(date)).collect::<Result<_, _>>()?,
        from: when.from.as_deref().map_or(Ok(Edge::default()), Edge::parse_from)?,
        to: when.to.as_deref().map_or(Ok(Edge::default()), Edge::parse_to)?,
        step: parse_step(&when.step)?,
    };
    let options = SunOptions::default();
    let timetable = Timetable::new(&place, &period, &options)?;
    let site = Site {
        place,
        zone: period.clock.zone.clone(),
        options,
        place_from,
        clock: period.clock.zone.name().to_owned(),
        north_deg: north_rad.to_degrees(),
        sun: "apparent, with standard refraction",
    };
    Ok((site, timetable, period.notes()))
}
