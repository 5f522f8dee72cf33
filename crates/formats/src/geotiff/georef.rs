//! What the tags of GeoTIFF say: where samples are, in what system, and which of them are none.
//!
//! Source: OGC 19-008r4, "OGC GeoTIFF Standard", version 1.1; for the value without data, GDAL.

use std::io::Cursor;

use glam::{DMat2, DVec2};
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use crate::error::Problem;
use crate::georeference::Said;
use crate::{Crs, CrsError};

/// The tags of one picture.
#[derive(Debug)]
pub(super) struct GeoTags {
    /// Model coordinates from column and row of raster space, whose zero is the corner of the first pixel.
    linear: DMat2,
    translation: DVec2,
    /// Where in its pixel a sample is: the middle for areas, the corner for points.
    sample: DVec2,
    pub(super) said: Said,
    /// The unit of heights, if it is said.
    pub(super) height_unit_m: Option<f64>,
    pub(super) no_data: Option<f64>,
}

/// Keys of the directory.
const RASTER_TYPE: u16 = 1025;
const CITATION: u16 = 1026;
const GEOGRAPHIC_TYPE: u16 = 2048;
const PROJECTED_TYPE: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const VERTICAL_UNITS: u16 = 4099;

/// The value of [`RASTER_TYPE`] for samples at corners.
const IS_POINT: u16 = 2;
/// A code for what has none.
const USER_DEFINED: u16 = 32767;

impl GeoTags {
    pub(super) fn read(decoder: &mut Decoder<Cursor<&[u8]>>) -> Result<Self, Problem> {
        let (linear, translation) = placement(decoder)?;
        let keys = Keys {
            directory: decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default(),
            text: decoder.get_tag_ascii_string(Tag::GeoAsciiParamsTag).unwrap_or_default(),
        };
        let height_unit_m = match keys.number(VERTICAL_UNITS) {
            None | Some(USER_DEFINED) => None,
            Some(9001) => Some(1.0),
            Some(9002) => Some(0.3048),
            Some(9003) => Some(1200.0 / 3937.0),
            Some(unit) => {
                return Err(Problem::whole(format!(
                    "its heights are in EPSG's unit {unit}; convert them to metres (9001)"
                )));
            }
        };
        let no_data = decoder.get_tag_ascii_string(Tag::GdalNodata).ok();
        Ok(Self {
            linear,
            translation,
            sample: DVec2::splat(if keys.number(RASTER_TYPE) == Some(IS_POINT) { 0.0 } else { 0.5 }),
            said: keys.system(),
            height_unit_m,
            no_data: no_data.and_then(|text| text.trim_matches(['\0', ' ', '\n']).parse().ok()),
        })
    }

    /// Where the sample of a column and row is.
    pub(super) fn position(&self, column_row: DVec2) -> DVec2 {
        self.linear * (column_row + self.sample) + self.translation
    }

    /// Whether rows go up where columns go right; usually they go down.
    pub(super) fn is_mirrored(&self) -> bool {
        self.linear.determinant() > 0.0
    }
}

/// Model coordinates from raster space: a matrix, or a scale and one point of both.
fn placement(decoder: &mut Decoder<Cursor<&[u8]>>) -> Result<(DMat2, DVec2), Problem> {
    let mut numbers = |tag| decoder.get_tag_f64_vec(tag).unwrap_or_default();
    let (matrix, scale, tie) =
        (numbers(Tag::ModelTransformationTag), numbers(Tag::ModelPixelScaleTag), numbers(Tag::ModelTiepointTag));
    let (linear, translation) = match (matrix.as_slice(), scale.as_slice(), tie.as_slice()) {
        ([a, b, _, x, c, d, _, y, ..], _, _) => {
            (DMat2::from_cols(DVec2::new(*a, *c), DVec2::new(*b, *d)), DVec2::new(*x, *y))
        }
        ([], [across, down, ..], [column, row, _, x, y, _]) => {
            let linear = DMat2::from_diagonal(DVec2::new(*across, -down));
            (linear, DVec2::new(*x, *y) - linear * DVec2::new(*column, *row))
        }
        ([], _, [_, _, _, _, _, _, _, ..]) => {
            let points = tie.len() / 6;
            return Err(Problem::whole(format!(
                "it is placed by {points} points, which is no even grid; warp it first, as with gdalwarp"
            )));
        }
        _ => {
            return Err(Problem::whole(
                "it does not say where it is: it has no tags of GeoTIFF; add them, as with gdal_translate -a_srs -a_ullr",
            ));
        }
    };
    let is_good = linear.is_finite() && translation.is_finite() && linear.determinant() != 0.0;
    if is_good {
        Ok((linear, translation))
    } else {
        Err(Problem::whole("its samples have no distance from each other"))
    }
}

/// The directory of keys, and the text that some of them mean.
struct Keys {
    directory: Vec<u16>,
    text: String,
}

impl Keys {
    /// Key, where its value is, how long it is, value or place.
    fn entry(&self, key: u16) -> Option<[u16; 4]> {
        self.directory.as_chunks::<4>().0.iter().skip(1).find(|entry| entry[0] == key).copied()
    }

    fn number(&self, key: u16) -> Option<u16> {
        self.entry(key).filter(|entry| entry[1] == 0).map(|entry| entry[3])
    }

    fn citation(&self, key: u16) -> Option<&str> {
        let [_, _, length, start] = self.entry(key)?.map(usize::from);
        let text = self.text.get(start..(start + length).min(self.text.len()))?;
        Some(text.trim_end_matches(['|', '\0', ' '])).filter(|text| !text.is_empty())
    }

    fn system(&self) -> Said {
        let code = self.number(PROJECTED_TYPE).or_else(|| self.number(GEOGRAPHIC_TYPE));
        match code {
            None | Some(0) => Said::Nothing,
            Some(USER_DEFINED) => {
                let text = self.citation(PROJECTED_CITATION).or_else(|| self.citation(CITATION));
                Said::Unknown(CrsError::NotAName { text: text.unwrap_or("user-defined").to_owned() })
            }
            Some(code) => Crs::from_epsg(code.into()).map_or_else(Said::Unknown, Said::Crs),
        }
    }
}
