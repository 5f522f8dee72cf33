//! The lights on the command line, in the order in which they stand there: an option about a lamp follows its lamp.

use std::fmt;

use anyhow::ensure;
use clap::{ArgMatches, Args, Command, FromArgMatches};
use glam::{DVec3, Vec3};

use crate::extent::ExtentChoice;
use crate::lights::{LampChoice, LampPlace};
use crate::parse::{SpotPlace, azimuth_altitude_deg, candela, cone_deg, linear_color, metres, spot, width_height, xyz};

/// Everything that was said about lamps.
#[derive(Debug, Clone, Default)]
pub struct LightArgs {
    /// In the order of the command line.
    words: Vec<Word>,
}

/// One option as it was typed, and what it means.
#[derive(Debug, Clone)]
struct Word {
    typed: String,
    meaning: Meaning,
}

#[derive(Debug, Clone, Copy)]
enum Meaning {
    Lamp(LampPlace),
    Color(Vec3),
    Intensity(f32),
    Range(f64),
    Inner(f64),
    Extent(ExtentChoice),
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.typed)
    }
}

/// As the library that parses needs it: each option a list of its own.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
struct Options {
    /// The sun: degrees clockwise from north, and degrees above the horizon; without --sun, --point and --spot, the model's own lights
    /// shine (default: 238,40 if it has none)
    #[arg(long, value_name = "AZIMUTH,ALTITUDE", value_parser = azimuth_altitude_deg, allow_hyphen_values = true)]
    sun: Option<[f64; 2]>,

    /// A lamp at this point; may be given several times
    #[arg(long, value_name = "X,Y,Z", value_parser = xyz, allow_hyphen_values = true)]
    point: Vec<DVec3>,

    /// A lamp that shines only into a cone: where it is, the direction in which it shines, and the degrees from there to the cone's edge
    /// (0.1 to 90); may be given several times
    #[arg(long, value_name = "X,Y,Z:DX,DY,DZ:DEGREES", value_parser = spot, allow_hyphen_values = true)]
    spot: Vec<SpotPlace>,

    /// Colour of the lamp before it: R,G,B from 0 to 1 in linear light, or #rrggbb, or a name of CSS such as orange (default: a warm white)
    #[arg(long, value_name = "COLOR", value_parser = linear_color, allow_hyphen_values = true)]
    light_color: Vec<Vec3>,

    /// Strength of the lamp before it: of a lamp in candela, which is its illuminance in lux 1 m away; of the sun in lux. Only ratios
    /// between lights are seen, since the brightest sets the exposure (default: as much as suits the model's size)
    #[arg(long, value_name = "CANDELA", value_parser = candela, allow_hyphen_values = true)]
    light_intensity: Vec<f32>,

    /// Metres at which the lamp before it has faded to nothing, as glTF's `range` (default: where a display can't show it any more)
    #[arg(long, value_name = "METRES", value_parser = metres, allow_hyphen_values = true)]
    light_range: Vec<f64>,

    /// Degrees from the middle of the --spot before it within which it has its full strength (default: four fifths of the cone's)
    #[arg(long, value_name = "DEGREES", value_parser = cone_deg, allow_hyphen_values = true)]
    light_inner: Vec<f64>,

    /// Metres from the middle to the edge of the lamp before it, or, before any, of all lamps: a ball, with soft shadows
    #[arg(long, value_name = "METRES", value_parser = metres, allow_hyphen_values = true)]
    light_radius: Vec<f64>,

    /// Width and height in metres of the lamp before it, or, before any, of all lamps: a rectangle that faces the model, or where the --spot
    /// does, with soft shadows
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = width_height, allow_hyphen_values = true)]
    light_size: Vec<[f64; 2]>,
}

impl LightArgs {
    /// The lamps, each with what was said about it.
    ///
    /// # Errors
    ///
    /// When something is said before there is a lamp, twice, or about a lamp that has no such thing.
    pub fn lamps(&self) -> anyhow::Result<Vec<LampChoice>> {
        let mut lamps: Vec<(&Word, LampChoice, Vec<&Word>)> = Vec::new();
        for word in &self.words {
            if let Meaning::Lamp(place) = word.meaning {
                lamps.push((word, LampChoice::new(place), Vec::new()));
                continue;
            }
            let Some((lamp, choice, said)) = lamps.last_mut() else {
                if matches!(word.meaning, Meaning::Extent(_)) {
                    continue;
                }
                anyhow::bail!(
                    "{word} stands before any lamp; put it after the --point, --spot or --sun that it is about"
                );
            };
            let same = |other: &&&Word| std::mem::discriminant(&other.meaning) == std::mem::discriminant(&word.meaning);
            if let Some(other) = said.iter().find(same) {
                anyhow::bail!("{other} and {word} are both about {lamp}; leave one out");
            }
            said.push(word);
            match word.meaning {
                Meaning::Color(color) => choice.color = Some(color),
                Meaning::Intensity(intensity) => choice.intensity = Some(intensity),
                Meaning::Range(range_m) => {
                    let has_end = !matches!(choice.place, LampPlace::Sun { .. });
                    ensure!(
                        has_end,
                        "{word} is about {lamp}, which shines without end; put it after a --point or --spot"
                    );
                    choice.range_m = Some(range_m);
                }
                Meaning::Inner(degrees) => {
                    let LampPlace::Spot(SpotPlace { outer_deg, .. }) = choice.place else {
                        anyhow::bail!("{word} is about {lamp}, which has no cone; put it after a --spot");
                    };
                    ensure!(
                        degrees < outer_deg,
                        "{word} is not inside the cone of {lamp}; give less than {outer_deg} degrees"
                    );
                    choice.inner_deg = Some(degrees);
                }
                Meaning::Extent(extent) => {
                    let is_lamp = !matches!(choice.place, LampPlace::Sun { .. });
                    ensure!(is_lamp, "{word} is about {lamp}, which is no lamp; --sun-disc gives the sun its size");
                    choice.extent = Some(extent);
                }
                Meaning::Lamp(_) => {}
            }
        }
        Ok(lamps.into_iter().map(|(_, choice, _)| choice).collect())
    }

    /// What was said, before any lamp, about how large all lamps are.
    ///
    /// # Errors
    ///
    /// When it was said twice.
    pub fn extent_of_all(&self) -> anyhow::Result<Option<ExtentChoice>> {
        let before = self.words.iter().take_while(|word| !matches!(word.meaning, Meaning::Lamp(_)));
        let extent = |word: &Word| if let Meaning::Extent(extent) = word.meaning { Some(extent) } else { None };
        let said: Vec<(&Word, ExtentChoice)> = before.filter_map(|word| Some((word, extent(word)?))).collect();
        if let [(first, _), (second, _), ..] = said.as_slice() {
            anyhow::bail!("{first} and {second} are both about all lamps; leave one out");
        }
        Ok(said.first().map(|&(_, extent)| extent))
    }
}

impl Args for LightArgs {
    fn augment_args(command: Command) -> Command {
        Options::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Options::augment_args_for_update(command)
    }
}

impl FromArgMatches for LightArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let Options {
            sun,
            point,
            spot,
            light_color,
            light_intensity,
            light_range,
            light_inner,
            light_radius,
            light_size,
        } = Options::from_arg_matches(matches)?;
        let sun = sun.map(|[azimuth_deg, altitude_deg]| LampPlace::Sun { azimuth_deg, altitude_deg });
        let lamps = |places: Vec<LampPlace>| places.into_iter().map(Meaning::Lamp).collect();
        let radii = light_radius.into_iter().map(ExtentChoice::Radius);
        let sizes = light_size.into_iter().map(ExtentChoice::Size);
        let lists: [(&str, &str, Vec<Meaning>); 9] = [
            ("sun", "--sun", lamps(sun.into_iter().collect())),
            ("point", "--point", lamps(point.into_iter().map(LampPlace::Point).collect())),
            ("spot", "--spot", lamps(spot.into_iter().map(LampPlace::Spot).collect())),
            ("light_color", "--light-color", light_color.into_iter().map(Meaning::Color).collect()),
            ("light_intensity", "--light-intensity", light_intensity.into_iter().map(Meaning::Intensity).collect()),
            ("light_range", "--light-range", light_range.into_iter().map(Meaning::Range).collect()),
            ("light_inner", "--light-inner", light_inner.into_iter().map(Meaning::Inner).collect()),
            ("light_radius", "--light-radius", radii.map(Meaning::Extent).collect()),
            ("light_size", "--light-size", sizes.map(Meaning::Extent).collect()),
        ];
        let mut words = Vec::new();
        for (id, option, meanings) in lists {
            let places = matches.indices_of(id).into_iter().flatten();
            let values = matches.get_raw(id).into_iter().flatten();
            for ((place, value), meaning) in places.zip(values).zip(meanings) {
                words.push((place, Word { typed: format!("{option} {}", value.to_string_lossy()), meaning }));
            }
        }
        words.sort_by_key(|&(place, _)| place);
        Ok(Self { words: words.into_iter().map(|(_, word)| word).collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        light: LightArgs,
    }

    fn lamps(line: &str) -> anyhow::Result<Vec<LampChoice>> {
        let words = std::iter::once("umbrae").chain(line.split_whitespace());
        Line::try_parse_from(words).expect(line).light.lamps()
    }

    #[test]
    fn an_option_is_about_the_lamp_before_it_whatever_the_lamp_is() {
        let line = "--point 1,2,3 --light-range 9 --sun 90,45 --light-color 0,1,0 --spot 0,0,4:0,0,-1:30 --light-inner 10 \
                    --point -1,0,2 --light-intensity 50 --light-range=7";
        let lamps = lamps(line).expect("it is a good line");
        let said: Vec<_> = lamps.iter().map(|l| (l.range_m, l.color, l.inner_deg, l.intensity)).collect();
        assert_eq!(
            said,
            [
                (Some(9.0), None, None, None),
                (None, Some(Vec3::Y), None, None),
                (None, None, Some(10.0), None),
                (Some(7.0), None, None, Some(50.0)),
            ]
        );
        assert!(matches!(lamps[1].place, LampPlace::Sun { azimuth_deg: 90.0, altitude_deg: 45.0 }));
        assert!(matches!(lamps[3].place, LampPlace::Point(point) if point == DVec3::new(-1.0, 0.0, 2.0)));
    }

    #[test]
    fn a_size_is_about_the_lamp_before_it_or_about_all() {
        let line = "--light-radius 0.5 --point 1,2,3 --spot 0,0,4:0,0,-1:30 --light-size 2x1";
        let of = lamps(line).expect("it is a good line");
        assert_eq!(of.iter().map(|lamp| lamp.extent).collect::<Vec<_>>(), [None, Some(ExtentChoice::Size([2.0, 1.0]))]);
        let words = |line: &str| {
            let words = std::iter::once("umbrae").chain(line.split_whitespace());
            Line::try_parse_from(words).expect(line).light.extent_of_all()
        };
        assert_eq!(words(line).expect("once"), Some(ExtentChoice::Radius(0.5)));
        let twice = words("--light-radius 0.5 --light-size 2x1").expect_err("twice").to_string();
        assert!(twice.contains("--light-radius 0.5") && twice.contains("--light-size 2x1"), "{twice}");
        let sun = lamps("--sun 90,45 --light-radius 1").expect_err("the sun is no lamp").to_string();
        assert!(sun.contains("--sun-disc"), "{sun}");
        let both = lamps("--point 1,2,3 --light-radius 1 --light-size 2x1").expect_err("one of both").to_string();
        assert!(both.contains("leave one out"), "{both}");
    }

    #[test]
    fn nothing_said_is_no_lamp() {
        assert_eq!(lamps("").expect("nothing is wrong with it").len(), 0);
    }
}
