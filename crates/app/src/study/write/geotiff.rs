//! Grids as GeoTIFF: one band of 32-bit floats, north up, with the reference system where it is known.
//!
//! Source: OGC 19-008r4, "OGC GeoTIFF Standard", version 1.1; GDAL's tags for the rest: 42112 (metadata as XML) and 42113 (the value that means
//! none).

use std::fs::File;
use std::io::BufWriter;

use glam::{DVec2, DVec3};
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, colortype::Gray32Float};
use tiff::tags::Tag;
use umbrae_formats::Crs;
use umbrae_study::GroundGrid;

use super::parameters::parameters;
use crate::study::folder::Folder;
use crate::study::results::{Results, State};

const GDAL_METADATA: Tag = Tag::Unknown(42112);
const GDAL_NODATA: Tag = Tag::Unknown(42113);
/// Bytes of a strip before it is compressed, about.
const STRIP_BYTES: usize = 1 << 16;

/// A band of a grid.
struct Band<'a> {
    grid: GroundGrid,
    /// One for each cell; NaN where there is none.
    values: &'a [f32],
    /// What they are.
    description: &'static str,
    unit: &'static str,
}

/// Writes the hours of sun on the ground in one state, if the ground was studied.
pub(super) fn write_hours(results: &Results, state: &State, folder: &mut Folder) -> anyhow::Result<()> {
    let Some((grid, range)) = results.ground() else { return Ok(()) };
    let values: Vec<f32> = range.map(|r| state.hours(r).map_or(f32::NAN, |hours| hours as f32)).collect();
    let band = Band { grid, values: &values, description: "hours of sun, in total over the period", unit: "h" };
    write(results, &state.file_name("hours", "tif"), &band, folder)
}

/// Writes the hours after less those before, if there are both.
pub(super) fn write_difference(results: &Results, folder: &mut Folder) -> anyhow::Result<()> {
    let (Some((grid, range)), [before, after]) = (results.ground(), results.states.as_slice()) else { return Ok(()) };
    let difference = |r: usize| before.hours(r).zip(after.hours(r)).map(|(before, after)| (after - before) as f32);
    let values: Vec<f32> = range.map(|r| difference(r).unwrap_or(f32::NAN)).collect();
    let description = "hours of sun after less before; negative is net new shadow";
    write(results, "difference.tif", &Band { grid, values: &values, description, unit: "h" }, folder)
}

/// Writes a file of one band.
fn write(results: &Results, name: &str, band: &Band<'_>, folder: &mut Folder) -> anyhow::Result<()> {
    folder.write(name, |file| encode(results, band, file))
}

fn encode(results: &Results, band: &Band<'_>, file: &mut BufWriter<File>) -> anyhow::Result<()> {
    let grid = band.grid;
    let mut encoder = TiffEncoder::new(file)?.with_compression(Compression::Deflate(DeflateLevel::Balanced));
    let mut image = encoder.new_image::<Gray32Float>(grid.columns as u32, grid.rows as u32)?;
    image.rows_per_strip((STRIP_BYTES / (4 * grid.columns)).clamp(1, grid.rows) as u32)?;

    let corner = grid.first + 0.5 * grid.spacing * DVec2::new(-1.0, 1.0);
    let corner = results.frame.to_model(DVec3::new(corner.x, corner.y, 0.0));
    let directory = image.encoder();
    directory.write_tag(Tag::ModelPixelScaleTag, &[grid.spacing, grid.spacing, 0.0][..])?;
    directory.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, corner.x, corner.y, 0.0][..])?;
    if let Some(keys) = results.frame.crs.as_ref().and_then(geo_keys) {
        directory.write_tag(Tag::GeoKeyDirectoryTag, &keys[..])?;
    }
    directory.write_tag(GDAL_NODATA, "nan")?;
    directory.write_tag(GDAL_METADATA, metadata(results, band).as_str())?;
    directory.write_tag(Tag::Software, concat!("umbrae ", env!("CARGO_PKG_VERSION")))?;

    // All at once: strips one by one are written as they are, whatever compression was asked for.
    Ok(image.write_data(band.values)?)
}

/// The directory of keys: version 1.1.0, then (key, 0, 1, value) each. A cell is an area, and values are its middle's. `None` for a system whose
/// code has no room.
fn geo_keys(crs: &Crs) -> Option<[u16; 16]> {
    const MODEL_TYPE: u16 = 1024;
    const RASTER_TYPE: u16 = 1025;
    const PROJECTED: u16 = 3072;
    let code = u16::try_from(crs.epsg()).ok()?;
    Some([1, 1, 0, 3, MODEL_TYPE, 0, 1, 1, RASTER_TYPE, 0, 1, 1, PROJECTED, 0, 1, code])
}

fn metadata(results: &Results, band: &Band<'_>) -> String {
    let of_band = |name: &str, role: &str, value: &str| {
        format!("  <Item name=\"{name}\" sample=\"0\" role=\"{role}\">{}</Item>\n", escaped(value))
    };
    let items: String = parameters(results)
        .iter()
        .map(|(name, value)| format!("  <Item name=\"{name}\">{}</Item>\n", escaped(value)))
        .collect();
    let (description, unit) =
        (of_band("DESCRIPTION", "description", band.description), of_band("UNITTYPE", "unittype", band.unit));
    format!("<GDALMetadata>\n{items}{description}{unit}</GDALMetadata>\n")
}

/// The tag is ASCII, so other characters are written as XML's numbers.
fn escaped(text: &str) -> String {
    let escape = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        ' '..='~' => c.to_string(),
        _ => format!("&#{};", u32::from(c)),
    };
    text.chars().map(escape).collect()
}
