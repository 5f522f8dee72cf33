//! The sun's path over the sky, as SVG.
//!
//! The sky from above with north up, in stereographic projection: the zenith in the middle, the horizon around, and any circle on the sky, such as the sun's
//! way of a day, is a circle here but for the change of the season and the refraction of the air. Dates have letters as well as colours.

use std::fmt::Write as _;

use jiff::civil::Date;
use jiff::{SignedDuration, Timestamp, ToSpan as _};
use umbrae_study::{ClockKind, LocalTime, Sun, SunPath, TimeError, equinoxes_and_solstices};

use super::almanac::{Almanac, Day, Seen};
use super::diagram_legend::legend;

pub(super) const WIDTH: f64 = 1240.0;
pub(super) const HEIGHT: f64 = 900.0;
/// Of the zenith.
const MIDDLE: [f64; 2] = [410.0, 470.0];
/// From the zenith to the horizon.
const HORIZON_PX: f64 = 350.0;
/// Okabe and Ito's, which the colour-blind can tell apart; their yellow is too faint for a line.
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
/// For the June solstice, the equinoxes and the December solstice.
const DASHES: [&str; 3] = ["12 4", "6 3 1.5 3", "2 3"];
/// From the middle of a letter to the line that it stands on, of its size: not every viewer can centre text.
const HALF_LETTER: f64 = 0.36;
/// From the end of an hour's line to its name.
const HOUR_NAME_PX: f64 = 14.0;
/// Points of a way are so far apart.
const APART: SignedDuration = SignedDuration::from_mins(3);
/// Points of an hour's line are so many days apart; the last comes back to the first.
const DAYS_APART: i32 = 4;

/// The way of one day.
pub(super) struct Way {
    pub(super) day: Day,
    /// What it is called in the legend.
    pub(super) name: String,
    pub(super) style: Style,
}

/// How a way is drawn.
pub(super) enum Style {
    /// A date that was asked for: its colour and its letter.
    Asked(&'static str, char),
    /// A solstice or an equinox: its dashes.
    Season(&'static str),
}

impl Style {
    /// The attributes of its stroke.
    pub(super) fn stroke(&self) -> String {
        match self {
            Self::Asked(color, _) => format!("stroke=\"{color}\" stroke-width=\"2.5\""),
            Self::Season(dashes) => format!("stroke=\"#404040\" stroke-width=\"1.4\" stroke-dasharray=\"{dashes}\""),
        }
    }
}

/// The diagram of the days of `almanac`, and of the solstices and equinoxes of the first one's year.
pub(super) fn svg(almanac: &Almanac) -> Result<String, TimeError> {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n"
    );
    let ways: Vec<Way> = seasons(almanac)?.into_iter().chain(asked(almanac)?).collect();
    sky(almanac, &mut svg);
    hours(almanac, &mut svg)?;
    for way in &ways {
        draw_way(almanac, way, &mut svg)?;
    }
    // Letters over all lines.
    for way in &ways {
        draw_letter(almanac, way, &mut svg)?;
    }
    legend(almanac, &ways, &mut svg)?;
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// Where in the picture the sun is.
fn at(sun: Sun) -> [f64; 2] {
    let radius = HORIZON_PX * (std::f64::consts::FRAC_PI_4 - sun.altitude_rad / 2.0).tan();
    let (sin, cos) = sun.azimuth_rad.sin_cos();
    [MIDDLE[0] + radius * sin, MIDDLE[1] - radius * cos]
}

fn at_deg(azimuth: f64, altitude: f64) -> [f64; 2] {
    at(Sun { azimuth_rad: azimuth.to_radians(), altitude_rad: altitude.to_radians() })
}

/// Rings of altitude, rays of azimuth, and what they are called.
fn sky(almanac: &Almanac, svg: &mut String) {
    let [x, y] = MIDDLE;
    // Writing to a string does not fail.
    let _ = writeln!(
        svg,
        "<circle cx=\"{x}\" cy=\"{y}\" r=\"{HORIZON_PX}\" fill=\"#fbfbf7\" stroke=\"#202020\" stroke-width=\"1.5\"/>"
    );
    for azimuth in (0..360).step_by(10) {
        let azimuth = f64::from(azimuth);
        let [from, to] = [at_deg(azimuth, if azimuth % 30.0 == 0.0 { 80.0 } else { 1.0 }), at_deg(azimuth, 0.0)];
        let _ =
            writeln!(svg, "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#d8d8d0\"/>", from[0], from[1], to[0], to[1]);
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let name = match azimuth as i32 {
            0 => "N".to_owned(),
            90 => "E".to_owned(),
            180 => "S".to_owned(),
            270 => "W".to_owned(),
            degrees => format!("{degrees}°"),
        };
        let size = if azimuth % 90.0 == 0.0 {
            "font-size=\"20\" font-weight=\"bold\""
        } else {
            "font-size=\"12\" fill=\"#404040\""
        };
        let away = HORIZON_PX + 20.0;
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" {size}>{name}</text>",
            x + away * sin,
            y - away * cos + HALF_LETTER * if azimuth % 90.0 == 0.0 { 20.0 } else { 12.0 }
        );
    }
    // On the side where the sun is at midnight, out of the way of its lines.
    let side_deg = if almanac.place.latitude_deg() < 0.0 { 180.0 } else { 0.0 };
    for altitude in (10..90).step_by(10) {
        let altitude = f64::from(altitude);
        let label = at_deg(side_deg, altitude);
        let radius = (label[1] - y).abs();
        let _ = writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius:.1}\" fill=\"none\" stroke=\"#d8d8d0\"/>");
        text(svg, label, &format!("{altitude}°"), "font-size=\"11\" fill=\"#606060\"");
    }
    let least = almanac.options.min_altitude_rad.to_degrees();
    if least > 0.0 {
        let radius = (at_deg(side_deg, least)[1] - y).abs();
        let _ = writeln!(
            svg,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius:.1}\" fill=\"none\" stroke=\"#a00000\" stroke-width=\"1.5\" stroke-dasharray=\"8 5\"/>"
        );
    }
}

/// A text about `at` that can be read over lines.
fn text(svg: &mut String, at: [f64; 2], words: &str, style: &str) {
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\" {style}>{words}</text>",
        at[0],
        at[1] + HALF_LETTER * 12.0
    );
}

/// Where the sun is at each full hour of the clock over the year: figures of eight, or, by a sundial, single lines.
fn hours(almanac: &Almanac, svg: &mut String) -> Result<(), TimeError> {
    let Some(first) = almanac.days.first() else { return Ok(()) };
    let new_year = Date::new(first.local.date.year(), 1, 1).unwrap_or(first.local.date);
    let dates = (0..=365 / DAYS_APART).map(|i| new_year.saturating_add((i * DAYS_APART).days()));
    let dates: Vec<Date> = dates.chain([new_year]).collect();
    let south = almanac.place.latitude_deg() < 0.0;
    let [equinox, summer] =
        [new_year.saturating_add(79.days()), new_year.saturating_add(if south { 354 } else { 171 }.days())];
    for hour in 0..24 {
        let sun = |date: Date| Sun::at(&almanac.place, moment(almanac, first, date, hour)?, &almanac.options);
        let suns: Vec<Sun> = dates.iter().map(|&date| sun(date)).collect::<Result<_, TimeError>>()?;
        for piece in suns.split(|sun| sun.altitude_rad <= 0.0) {
            let points: Vec<[f64; 2]> = piece.iter().copied().map(at).collect();
            draw_line(svg, &points, "stroke=\"#b0b0a8\" stroke-width=\"1\"");
        }
        // The name is beyond the end that the line has in summer.
        let end = sun(summer)?;
        if end.altitude_rad > 0.0 {
            let ([x, y], [from_x, from_y]) = (at(end), at(sun(equinox)?));
            let away = HOUR_NAME_PX / (x - from_x).hypot(y - from_y).max(1.0);
            let name_at = [x + (x - from_x) * away, y + (y - from_y) * away];
            text(svg, name_at, &hour.to_string(), "font-size=\"12\" fill=\"#505050\"");
        }
    }
    Ok(())
}

/// When `hour` is on `date`: by the sundial, or by a clock that is set as on the `first` day's noon.
fn moment(almanac: &Almanac, first: &Day, date: Date, hour: i8) -> Result<Timestamp, TimeError> {
    let time = format!("{hour:02}:00").parse::<LocalTime>()?;
    if almanac.clock.kind == ClockKind::Solar {
        return almanac.clock.moment(&almanac.place, date, time);
    }
    let offset = almanac.clock.zone.offset_at(noon(first));
    let shown = date.at(hour, 0, 0, 0);
    offset.to_timestamp(shown).map_err(|_| TimeError::NoSun { time: first.local.start })
}

/// The middle of a day.
pub(super) fn noon(day: &Day) -> Timestamp {
    day.local.start + day.local.duration() / 2
}

/// The days that were asked for; of many, some from the first to the last.
fn asked(almanac: &Almanac) -> Result<Vec<Way>, TimeError> {
    let (count, most) = (almanac.days.len(), COLORS.len());
    let shown: Vec<usize> =
        if count <= most { (0..count).collect() } else { (0..most).map(|i| i * (count - 1) / (most - 1)).collect() };
    let way = |(i, index): (usize, usize)| {
        let date = almanac.days[index].local.date;
        let style = Style::Asked(COLORS[i], char::from(b'A' + i as u8));
        Ok(Way { day: almanac.day(date)?, name: date.to_string(), style })
    };
    shown.into_iter().enumerate().map(way).collect()
}

/// The solstices and the equinoxes of the first date's year, by the clock's calendar. The equinoxes have one way.
fn seasons(almanac: &Almanac) -> Result<Vec<Way>, TimeError> {
    let Some(first) = almanac.days.first() else { return Ok(Vec::new()) };
    let zone = almanac.clock.zone.time_zone();
    let dates = equinoxes_and_solstices(first.local.date.year())?.map(|moment| zone.to_datetime(moment).date());
    let [march, june, september, december] = dates;
    let short = |date: Date| date.strftime("%-d %B").to_string();
    let ways = [
        (june, format!("{} (solstice)", short(june))),
        (march, format!("{} and {} (equinoxes)", short(march), short(september))),
        (december, format!("{} (solstice)", short(december))),
    ];
    let way = |((date, name), dashes)| Ok(Way { day: almanac.day(date)?, name, style: Style::Season(dashes) });
    ways.into_iter().zip(DASHES).map(way).collect()
}

fn draw_way(almanac: &Almanac, way: &Way, svg: &mut String) -> Result<(), TimeError> {
    let path = SunPath::new(&almanac.place, way.day.local.start, way.day.local.end, &almanac.options)?;
    for [from, to] in way.day.sun.up() {
        let mut points = Vec::new();
        let mut time = from;
        while time < to {
            points.push(path.at(time));
            time = time.saturating_add(APART).unwrap_or(to);
        }
        points.push(path.at(to));
        let points: Vec<[f64; 2]> = points.into_iter().filter(|sun| sun.altitude_rad >= 0.0).map(at).collect();
        draw_line(svg, &points, &way.style.stroke());
    }
    let Style::Asked(color, _) = way.style else { return Ok(()) };
    for hour in whole_hours(almanac, &way.day)? {
        if hour.sun.altitude_rad > 0.0 {
            let [x, y] = at(hour.sun);
            let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>");
        }
    }
    Ok(())
}

/// The sun whenever the clock shows a full hour on `day`.
fn whole_hours(almanac: &Almanac, day: &Day) -> Result<Vec<Seen>, TimeError> {
    let mut hours = Vec::new();
    for hour in 1..24 {
        let time = format!("{hour:02}:00").parse::<LocalTime>()?;
        // An hour that clocks skip is not shown.
        match almanac.clock.moment(&almanac.place, day.local.date, time) {
            Ok(moment) => hours.push(almanac.seen(moment)?),
            Err(TimeError::Gap { .. }) => {}
            Err(other) => return Err(other),
        }
    }
    Ok(hours)
}

/// The letter of a way, on its afternoon; of each way at another time, so that those of neighbouring dates are apart.
fn draw_letter(almanac: &Almanac, way: &Way, svg: &mut String) -> Result<(), TimeError> {
    let Style::Asked(color, letter) = way.style else { return Ok(()) };
    let Some([from, to]) = way.day.sun.up().into_iter().max_by_key(|[from, to]| to.duration_since(*from)) else {
        return Ok(());
    };
    let share = 0.88 - 0.06 * f64::from(letter as u8 - b'A');
    let seconds = to.duration_since(from).as_secs_f64() * share;
    let seen = almanac.seen(from + SignedDuration::from_secs(seconds as i64))?;
    if seen.sun.altitude_rad > 0.0 {
        badge(svg, at(seen.sun), color, letter);
    }
    Ok(())
}

/// A letter in a disc.
pub(super) fn badge(svg: &mut String, [x, y]: [f64; 2], color: &str, letter: char) {
    let _ = writeln!(
        svg,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"10\" fill=\"#ffffff\" stroke=\"{color}\" stroke-width=\"2\"/>"
    );
    let _ = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"13\" font-weight=\"bold\">{letter}</text>",
        y + HALF_LETTER * 13.0
    );
}

fn draw_line(svg: &mut String, points: &[[f64; 2]], stroke: &str) {
    if points.len() < 2 {
        return;
    }
    let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
    let _ = writeln!(svg, "<path d=\"M{}\" fill=\"none\" {stroke}/>", points.join("L"));
}
