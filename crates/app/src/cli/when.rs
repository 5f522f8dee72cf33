//! Where and when, on the command line: the same words for every command that asks for the sun.

use clap::Args;
use jiff::SignedDuration;
use jiff::civil::Date;
use umbrae_study::{
    Clock, ClockKind, Edge, Period, Place, Refraction, SunOptions, TimeError, Zone, parse_date, parse_dates, parse_step,
};

/// Where the model stands, and whose clocks are meant.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Place")]
pub struct PlaceArgs {
    /// Degrees north of the equator (south is negative)
    #[arg(
        long,
        value_name = "DEGREES",
        value_parser = latitude,
        allow_hyphen_values = true,
        requires = "lon"
    )]
    pub lat: Option<f64>,

    /// Degrees east of Greenwich (west is negative)
    #[arg(
        long,
        value_name = "DEGREES",
        value_parser = longitude,
        allow_hyphen_values = true,
        requires = "lat"
    )]
    pub lon: Option<f64>,

    /// Whose clocks and calendar are meant: a name of the IANA database such as Europe/Vienna, or an offset such as +01:00 that never
    /// changes (default: that of the place, by the borders of OpenStreetMap and its contributors)
    #[arg(long, value_name = "ZONE", value_parser = Zone::named, allow_hyphen_values = true)]
    pub tz: Option<Zone>,
}

/// Which dates, which part of the day, and how finely.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Time")]
pub struct PeriodArgs {
    /// A date; may be given several times
    #[arg(long = "date", value_name = "YYYY-MM-DD", value_parser = parse_date)]
    pub date: Vec<Date>,

    /// All dates from the first to the last, both included; may be given several times, and beside --date
    #[arg(long = "dates", value_name = "FIRST..LAST", value_parser = range)]
    pub dates: Vec<DateRange>,

    /// When the part of the day begins: a time of the clock such as 09:00, or sunrise, sunrise+1h (default: sunrise). Where clocks are put back, 02:30
    /// is the first, and 02:30+01:00 says which
    #[arg(long, value_name = "TIME", value_parser = Edge::parse_from)]
    pub from: Option<Edge>,

    /// When it ends, itself no longer part of it: a time such as 17:00 or 24:00, or sunset, sunset-1h (default: sunset)
    #[arg(long, value_name = "TIME", value_parser = Edge::parse_to)]
    pub to: Option<Edge>,

    /// How long a step is: 15min, 1h, 90s, PT15M. Steps follow each other from the beginning, each stands for its middle, and the last one is
    /// shorter where they do not fill the day's part
    #[arg(long, value_name = "DURATION", default_value = "15min", value_parser = parse_step, allow_hyphen_values = true)]
    pub step: SignedDuration,

    /// Times of the day are true solar time, as a sundial shows it: the sun is highest at 12:00
    #[arg(long)]
    pub solar_time: bool,

    /// The sun where geometry has it; without this, where it is seen through a standard atmosphere (1013.25 hPa, 15 °C)
    #[arg(long)]
    pub geometric: bool,

    /// A sun lower than this does not count
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = min_altitude, allow_hyphen_values = true)]
    pub min_altitude: f64,
}

/// What `--dates` means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DateRange(pub Vec<Date>);

impl PlaceArgs {
    /// The place; `None` if none was given.
    ///
    /// # Errors
    ///
    /// Never for what was parsed.
    pub fn place(&self) -> Result<Option<Place>, TimeError> {
        let (Some(lat), Some(lon)) = (self.lat, self.lon) else { return Ok(None) };
        Place::from_degrees(lat, lon).map(Some)
    }

    /// The zone that was given, else that of `place`.
    pub fn zone(&self, place: &Place) -> Zone {
        self.tz.clone().unwrap_or_else(|| Zone::of_place(place))
    }
}

impl PeriodArgs {
    /// All dates that were given, in the order of the command line, `--date` before `--dates`.
    pub fn all_dates(&self) -> Vec<Date> {
        self.date.iter().copied().chain(self.dates.iter().flat_map(|range| range.0.iter().copied())).collect()
    }

    /// The period by the clock of `zone`, or by a sundial under its calendar. Without dates it has none, which
    /// [`umbrae_study::Timetable::new`] refuses.
    pub fn period(&self, zone: Zone) -> Period {
        Period {
            clock: self.clock(zone),
            dates: self.all_dates(),
            from: self.from.unwrap_or_default(),
            to: self.to.unwrap_or_default(),
            step: self.step,
        }
    }

    /// The clock by which times are meant.
    pub fn clock(&self, zone: Zone) -> Clock {
        Clock { kind: if self.solar_time { ClockKind::Solar } else { ClockKind::Civil }, zone }
    }

    /// How the sun is seen.
    pub fn sun_options(&self) -> SunOptions {
        SunOptions {
            refraction: if self.geometric { Refraction::None } else { Refraction::Standard },
            min_altitude_rad: self.min_altitude.to_radians(),
            ..SunOptions::default()
        }
    }
}

fn latitude(text: &str) -> Result<f64, String> {
    let degrees = number(text)?;
    Place::from_degrees(degrees, 0.0).map(|_| degrees).map_err(|error| error.to_string())
}

fn longitude(text: &str) -> Result<f64, String> {
    let degrees = number(text)?;
    Place::from_degrees(0.0, degrees).map(|_| degrees).map_err(|error| error.to_string())
}

fn min_altitude(text: &str) -> Result<f64, String> {
    let degrees = number(text)?;
    let is_altitude = (0.0..=90.0).contains(&degrees);
    if is_altitude { Ok(degrees) } else { Err(TimeError::MinAltitude { degrees }.to_string()) }
}

/// Degrees as a decimal number; 48°12' is not one.
fn number(text: &str) -> Result<f64, String> {
    let wrong = || format!("`{text}` is no number of degrees; write it with decimals, such as 48.2");
    text.trim().parse().map_err(|_| wrong())
}

fn range(text: &str) -> Result<DateRange, TimeError> {
    parse_dates(text).map(DateRange)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        place: PlaceArgs,
        #[command(flatten)]
        period: PeriodArgs,
    }

    fn parsed(line: &str) -> Result<Line, clap::Error> {
        Line::try_parse_from(line.split(' '))
    }

    #[test]
    fn what_is_typed_is_what_is_studied() {
        let line = parsed(
            "umbrae --lat -33.87 --lon 151.2 --date 2026-06-21 --dates 2026-06-23..2026-06-24 --from 09:00 --to 15:00 --step 1h",
        );
        let line = line.expect("all of it is right");
        let place = line.place.place().expect("it was checked").expect("it was given");
        let period = line.period.period(line.place.zone(&place));
        assert_eq!(period.clock.zone.name(), "Australia/Sydney");
        assert!(period.clock.zone.is_derived());
        assert_eq!(period.to_string(), "2026-06-21, 2026-06-23, 2026-06-24, 09:00 to 15:00, every 1h");
    }

    #[test]
    fn without_times_it_is_the_day_from_sunrise_to_sunset_in_quarters_of_an_hour() {
        let line = parsed("umbrae --date 2026-09-18").expect("a place is not always needed");
        assert_eq!(line.place.place(), Ok(None));
        let period = line.period.period(Zone::named("UTC").expect("it is a zone"));
        assert_eq!(period.to_string(), "2026-09-18, sunrise to sunset, every 15min");
    }

    #[test]
    fn each_mistake_is_one_sentence_that_says_how_it_is_written() {
        let cases = [
            ("--lat 95 --lon 0", "a latitude of 95.0 is not on Earth"),
            ("--lat nan --lon 0", "a latitude of NaN is not on Earth"),
            ("--lat 0 --lon -181", "a longitude of -181.0 is not on Earth"),
            ("--lat 48°12' --lon 16", "write it with decimals"),
            ("--lat 48", "--lon <DEGREES>"),
            ("--tz Europe/Viena", "did you mean `Europe/Vienna`"),
            ("--date 2026-02-30", "February 2026 has days 01 to 28"),
            ("--date 18.9.2026", "such as 2026-09-18"),
            ("--dates 2026-03-02..2026-03-01", "write the earlier one first"),
            ("--from 9", "no time of day"),
            ("--to 24:01", "no time of day"),
            ("--to sunrise", "or sunrise or sunset"),
            ("--step 15", "write a number and its unit"),
            ("--step 0s", "from 1 s to 24 h"),
            ("--step -15min", "no length of time"),
            ("--step 25h", "from 1 s to 24 h"),
            ("--min-altitude 91", "from 0 up to 90"),
            ("--min-altitude -1", "from 0 up to 90"),
        ];
        for (line, words) in cases {
            let error = parsed(&format!("umbrae {line}")).expect_err(line).to_string();
            assert!(error.contains(words), "{line}: {error}");
        }
    }
}
