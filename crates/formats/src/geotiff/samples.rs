//! The samples of a TIFF as heights.

use std::io::Cursor;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use crate::error::{Problem, cut_short};
use crate::warnings::Warnings;

/// Heights on a grid, row by row.
#[derive(Debug)]
pub(super) struct Grid {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// How many columns and rows of the file lie from one to the next.
    pub(super) step: u32,
    /// In the file's unit; NaN where there is none.
    pub(super) heights: Vec<f32>,
}

/// As many samples as become a scene: 20 million triangles, which take 1.8 GB to read.
pub(super) const MAX_SAMPLES: u64 = 10_000_000;

/// The largest strip or tile, which is decoded at once.
const MAX_CHUNK_BYTES: usize = 256 << 20;

/// From below the deepest trench to above the highest mountain, in feet: what is beyond stands for no height.
const HEIGHTS: std::ops::RangeInclusive<f64> = -37_000.0..=40_000.0;

/// What many write for no height, without saying so.
const USUAL_NO_DATA: f64 = -9999.0;

pub(super) fn problem(error: &tiff::TiffError) -> Problem {
    Problem::whole(format!("its TIFF can't be read: {}", cut_short(&error.to_string().replace('\n', " "), 200)))
}

/// Reads the beginning of a file.
pub(super) fn decoder(bytes: &[u8]) -> Result<Decoder<Cursor<&[u8]>>, Problem> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MAX_CHUNK_BYTES;
    limits.intermediate_buffer_size = MAX_CHUNK_BYTES;
    // A list of where strips are is as long as the file has strips.
    limits.ifd_value_size = bytes.len().max(1 << 20);
    Decoder::new(Cursor::new(bytes)).map(|decoder| decoder.with_limits(limits)).map_err(|error| problem(&error))
}

impl Grid {
    /// Every `step`th sample of every `step`th row.
    pub(super) fn read(
        decoder: &mut Decoder<Cursor<&[u8]>>,
        no_data: Option<f64>,
        step: u32,
        warnings: &mut Warnings,
    ) -> Result<Self, Problem> {
        let (width, height) = decoder.dimensions().map_err(|error| problem(&error))?;
        let step = step.max(1);
        let [columns, rows] = [width, height].map(|side| side.div_ceil(step));
        if u64::from(columns) * u64::from(rows) > MAX_SAMPLES {
            let needed = (f64::from(width) * f64::from(height) / MAX_SAMPLES as f64).sqrt().ceil();
            return Err(Problem::whole(format!(
                "its {width} x {height} samples are more than the {MAX_SAMPLES} that can be shown; cut it, or read every \
                 {needed}th with --terrain-step {needed}"
            )));
        }
        if columns < 2 || rows < 2 {
            return Err(Problem::whole(format!(
                "its {columns} x {rows} samples are no surface; it takes 2 x 2 at least"
            )));
        }
        match decoder.colortype().map_err(|error| problem(&error))? {
            ColorType::Gray(_) => {}
            color => {
                return Err(Problem::whole(format!(
                    "its samples are {color:?}, not single numbers; it is a picture, not heights"
                )));
            }
        }
        let mut grid = Self {
            columns: columns as usize,
            rows: rows as usize,
            step,
            heights: vec![f32::NAN; columns as usize * rows as usize],
        };
        let mut strange = 0;
        let (chunk_width, chunk_height) = decoder.chunk_dimensions();
        let across = width.div_ceil(chunk_width.max(1));
        let down = height.div_ceil(chunk_height.max(1));
        let is_written = written_chunks(decoder);
        for chunk in 0..across * down {
            if !is_written.get(chunk as usize).copied().unwrap_or(true) {
                continue;
            }
            let (left, top) = (chunk % across * chunk_width, chunk / across * chunk_height);
            // Chunks between the rows that are kept need not be decoded.
            let first_row = top.next_multiple_of(step);
            if first_row >= top.saturating_add(chunk_height) {
                continue;
            }
            let samples = decoder.read_chunk(chunk).map_err(|error| problem(&error))?;
            let (data_width, data_height) = decoder.chunk_data_dimensions(chunk);
            let samples = Samples::new(&samples, no_data)?;
            for row in (first_row..top + data_height).step_by(step as usize) {
                for column in (left.next_multiple_of(step)..left + data_width).step_by(step as usize) {
                    let index = (row - top) as usize * data_width as usize + (column - left) as usize;
                    let Some(sample) = samples.height(index) else { continue };
                    let is_strange = !HEIGHTS.contains(&sample) || (no_data.is_none() && sample == USUAL_NO_DATA);
                    strange += usize::from(is_strange);
                    if !is_strange {
                        grid.heights[(row / step) as usize * grid.columns + (column / step) as usize] = sample as f32;
                    }
                }
            }
        }
        warnings.add(
            strange,
            [
                "sample that can't be a height was left open, though the file does not say that it is none",
                "samples that can't be heights were left open, though the file does not say that they are none",
            ],
        );
        Ok(grid)
    }
}

/// For each strip or tile whether it is in the file: GDAL leaves out those without any data, and then they have no bytes.
fn written_chunks(decoder: &mut Decoder<Cursor<&[u8]>>) -> Vec<bool> {
    let mut counts = |tag| decoder.find_tag_unsigned_vec::<u64>(tag).ok().flatten();
    let counts = counts(Tag::TileByteCounts).or_else(|| counts(Tag::StripByteCounts)).unwrap_or_default();
    counts.into_iter().map(|bytes| bytes > 0).collect()
}

/// The samples of one strip or tile.
enum Samples<'a> {
    Float(&'a [f32], Option<f32>),
    Double(&'a [f64], Option<f64>),
    /// As wide as any whole number that heights are stored in.
    Whole(Box<dyn Fn(usize) -> Option<i64> + 'a>, Option<f64>),
}

impl<'a> Samples<'a> {
    fn new(samples: &'a DecodingResult, no_data: Option<f64>) -> Result<Self, Problem> {
        fn whole<'a, T: Copy + Into<i64>>(samples: &'a [T], no_data: Option<f64>) -> Samples<'a> {
            Samples::Whole(Box::new(|index| samples.get(index).map(|&sample| sample.into())), no_data)
        }
        Ok(match samples {
            // The text that says which is none has digits for a double.
            DecodingResult::F32(samples) => Self::Float(samples, no_data.map(|none| none as f32)),
            DecodingResult::F64(samples) => Self::Double(samples, no_data),
            DecodingResult::U8(samples) => whole(samples, no_data),
            DecodingResult::U16(samples) => whole(samples, no_data),
            DecodingResult::U32(samples) => whole(samples, no_data),
            DecodingResult::I8(samples) => whole(samples, no_data),
            DecodingResult::I16(samples) => whole(samples, no_data),
            DecodingResult::I32(samples) => whole(samples, no_data),
            DecodingResult::U64(_) | DecodingResult::I64(_) | DecodingResult::F16(_) => {
                return Err(Problem::whole(
                    "its samples are numbers of 64 bits or half ones; convert them to Float32, as with gdal_translate -ot",
                ));
            }
        })
    }

    /// `None` where there is no height.
    fn height(&self, index: usize) -> Option<f64> {
        let height = match self {
            Self::Float(samples, none) => {
                samples.get(index).filter(|&&sample| Some(sample) != *none).map(|&s| s.into())
            }
            Self::Double(samples, none) => samples.get(index).copied().filter(|&sample| Some(sample) != *none),
            Self::Whole(sample, none) => {
                sample(index).map(|sample| sample as f64).filter(|&sample| Some(sample) != *none)
            }
        };
        height.filter(|height| !height.is_nan())
    }
}
