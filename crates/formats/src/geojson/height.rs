//! How high a building is: there are many names for it, and two ways to count.
//!
//! ```text
//!     ________ top      `height` above the ground (OpenStreetMap) or above the base (all others):
//!    |        |          the same unless there is a `min_height`
//!    |________| bottom  `min_height`, where a part of a building begins to be there
//!   ...........ground   `ground`, `base`: the zero of both
//! ```

use std::ops::Range;

use super::document::{Feature, Properties, Scalar};
use crate::LoadOptions;
use crate::error::{Problem, quoted};
use crate::warnings::Warnings;

/// Names of heights above the ground, best first; case does not matter.
const HEIGHTS: [&str; 12] = [
    "height",
    "building:height",
    "render_height",
    "hauteur",
    "measuredheight",
    "measured_height",
    "building_height",
    "height_m",
    "heightroof_m",
    "hoehe",
    "altura",
    "altezza",
];

/// Names of numbers of storeys.
const LEVELS: [&str; 9] = [
    "building:levels",
    "levels",
    "building_levels",
    "num_floors",
    "numfloors",
    "floors",
    "storeys",
    "stories",
    "nb_etages",
];

/// Names of the height of the ground at the building.
const GROUNDS: [&str; 6] = ["base", "base_height", "ground", "ground_height", "ground_elevation", "base_elevation"];

/// Names of the height above the ground at which the building begins.
const BOTTOMS: [&str; 3] = ["min_height", "building:min_height", "render_min_height"];

/// From floor to floor, as most buildings have it.
const STOREY_M: f64 = 3.0;

/// Which properties are looked at.
#[derive(Debug)]
pub(super) struct Fields<'a> {
    height: Option<&'a str>,
    base: Option<&'a str>,
}

impl<'a> Fields<'a> {
    /// Those that the options name, which some feature must have.
    pub(super) fn new(options: &'a LoadOptions, features: &[Feature]) -> Result<Self, Problem> {
        let fields = Self { height: options.height_field.as_deref(), base: options.base_field.as_deref() };
        for name in [fields.height, fields.base].into_iter().flatten() {
            let has = |feature: &Feature| feature.properties.as_ref().is_some_and(|all| all.get(name).is_some());
            if !features.iter().any(has) {
                let hint = fields.hint(features);
                return Err(Problem::whole(format!("no feature has a property {}{hint}", quoted(name))));
            }
        }
        Ok(fields)
    }

    /// From the bottom to the top of a building, in metres; `None`, with a warning about `place`, if there is no telling.
    pub(super) fn span_of(
        &self,
        feature: &Feature,
        place: impl Fn() -> String,
        warnings: &mut Warnings,
    ) -> Option<Range<f64>> {
        let none = Properties::default();
        let properties = feature.properties.as_ref().unwrap_or(&none);
        let Some(height_m) = self.height_m(properties, &place, warnings) else {
            let words = ["feature without a height was skipped", "features without a height were skipped"];
            let given = self.height.and_then(|name| Some((name, properties.get(name)?.text()?)));
            let what = given.map_or_else(String::new, |(name, text)| format!(", whose {name} is {}", quoted(&text)));
            warnings.add_one(words, || format!("{}{what}", place()));
            return None;
        };
        let is_bottom = |name: &str| BOTTOMS.iter().any(|bottom| bottom.eq_ignore_ascii_case(name));
        let (ground_m, bottom_m) = match self.base {
            Some(name) if is_bottom(name) => (None, length_m(properties, name)),
            Some(name) => (length_m(properties, name), None),
            None => (first_of(properties, &GROUNDS), first_of(properties, &BOTTOMS)),
        };
        let ground_m = ground_m.unwrap_or(0.0);
        let span = ground_m + bottom_m.unwrap_or(0.0)..ground_m + height_m;
        if span.is_empty() {
            let words = [
                "feature that is not higher than its base was skipped",
                "features that are not higher than their base were skipped",
            ];
            warnings.add_one(words, || format!("{}: from {} to {} m", place(), span.start, span.end));
            return None;
        }
        Some(span)
    }

    fn height_m(&self, properties: &Properties, place: impl Fn() -> String, warnings: &mut Warnings) -> Option<f64> {
        if let Some(name) = self.height {
            return length_m(properties, name);
        }
        first_of(properties, &HEIGHTS).or_else(|| {
            let levels = first_of(properties, &LEVELS).filter(|&levels| levels > 0.0)?;
            let words = [
                "feature has storeys instead of a height; each was taken for 3 m",
                "features have storeys instead of a height; each was taken for 3 m",
            ];
            warnings.add_one(words, || format!("{}: {levels} storeys", place()));
            Some(levels * STOREY_M)
        })
    }

    /// Which properties could be a height, for the end of a message.
    pub(super) fn hint(&self, features: &[Feature]) -> String {
        let mut names: Vec<&str> = Vec::new();
        for (name, value) in features.iter().filter_map(|feature| feature.properties.as_ref()).flat_map(|all| &all.0) {
            let is_length =
                matches!(value, Scalar::Number(_)) || value.text().is_some_and(|text| metres(&text).is_some());
            if names.len() < HINTED && is_length && !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        if names.is_empty() {
            return String::new();
        }
        let names: Vec<String> = names.into_iter().map(quoted).collect();
        format!("; properties that are numbers, of which --height-field names the height: {}", names.join(", "))
    }
}

/// As many as belong in a message.
const HINTED: usize = 16;

fn first_of(properties: &Properties, names: &[&str]) -> Option<f64> {
    names.iter().find_map(|name| length_m(properties, name))
}

fn length_m(properties: &Properties, name: &str) -> Option<f64> {
    match properties.get(name)? {
        Scalar::Number(number) => Some(*number).filter(|number| number.is_finite()),
        Scalar::Text(text) => metres(text),
        Scalar::Other => None,
    }
}

const FOOT_M: f64 = 0.3048;

/// "12", "12.5 m", "12,5m", "40 ft", "40'", "40'6\"" in metres.
fn metres(text: &str) -> Option<f64> {
    let text = text.trim();
    let end = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '+'))).unwrap_or(text.len());
    let (digits, unit) = text.split_at(end);
    // A comma before thousands would make a house of 1,200 m one of 1.2 m: nobody writes that.
    let number: f64 = digits.replace(',', ".").parse().ok()?;
    let unit_m = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "m" | "metre" | "metres" | "meter" | "meters" | "mètres" => 1.0,
        "cm" => 0.01,
        "mm" => 0.001,
        "ft" | "feet" | "foot" | "'" => FOOT_M,
        feet => {
            let inches: f64 = feet.strip_prefix('\'')?.strip_suffix('"')?.trim().parse().ok()?;
            return Some((number + inches / 12.0) * FOOT_M).filter(|_| (0.0..12.0).contains(&inches));
        }
    };
    Some(number * unit_m).filter(|length| length.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_in_the_units_that_people_write() {
        for (text, expected) in [
            ("12", 12.0),
            (" 12.5 m ", 12.5),
            ("12,5m", 12.5),
            ("-3", -3.0),
            ("40 ft", 12.192),
            ("40'", 12.192),
            ("40'6\"", 12.3444),
            ("1250 cm", 12.5),
            ("7 metres", 7.0),
        ] {
            let found = metres(text).unwrap_or(f64::NAN);
            assert!((found - expected).abs() < 1e-9, "{text}: {found}");
        }
        for text in ["", "m", "high", "12 storeys", "12;14", "1.2.3", "12-14", "1e3", "40'13\"", "40'x\"", "é"] {
            assert_eq!(metres(text), None, "{text}");
        }
    }
}
