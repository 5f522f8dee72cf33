//! `bits.npz`: every verdict of the study, so that hours of any window can be summed without computing again.
//!
//! ```text
//! bits           uint8    (receivers, ceil(steps / 8))   bit `step % 8`, from the lowest, of byte `step / 8`: in the sun
//! steps_utc_s    int64    (steps)      when each step begins, seconds since 1970 UTC
//! durations_s    float64  (steps)      how long each is; a step stands for its middle
//! utc_offset_s   int32    (steps)      what the study's clock is ahead of UTC
//! azimuth_deg    float64  (steps)      of the sun at the middle, clockwise from true north
//! altitude_deg   float64  (steps)
//! positions      float64  (receivers, 3)   in the model's own coordinates
//! inside         uint8    (receivers)      1 inside of solids, where the bits are zeros
//! ```
//!
//! With `--sun-disc` there is `fractions.npz` too, with the same arrays but for the first:
//!
//! ```text
//! fractions      uint8    (receivers, steps)   how much of the sun's disc is seen, in 255ths: 0 is nothing and 255 all of it, else off by 1/255 at most
//! ```
//!
//! and `bits.npz` has the verdicts of the disc's middle. In Python, the hours between two moments:
//!
//! ```text
//! z = numpy.load("bits.npz")
//! lit = numpy.unpackbits(z["bits"], axis=1, count=len(z["steps_utc_s"]), bitorder="little")
//! window = (z["steps_utc_s"] >= start) & (z["steps_utc_s"] < end)
//! hours = (lit[:, window] * z["durations_s"][window]).sum(axis=1) / 3600
//! ```

use std::fs::File;
use std::io::{BufWriter, Write as _};

use npyz::{AutoSerialize, WriteOptions, WriterBuilder as _};
use umbrae_study::Step;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::study::folder::Folder;
use crate::study::results::{Results, State};
use crate::study::rows::for_each_row;

/// Writes the shares of the sun's disc in `state`, if it is one: `fractions.npz`, with `fractions` in place of `bits`, a byte for each receiver and step.
pub(super) fn write_fractions(results: &Results, state: &State, folder: &mut Folder) -> anyhow::Result<()> {
    let Some(fractions) = &state.fractions else { return Ok(()) };
    folder.write(&state.file_name("fractions", "npz"), |file| {
        let mut archive = ZipWriter::new(file);
        let (count, steps) = (results.receivers.len(), results.suns.len());
        let mut bytes = begin::<u8>(&mut archive, "fractions", &[count as u64, steps as u64])?;
        for_each_row(fractions, count, steps, |_, row| Ok(bytes.extend(row.iter().copied())?))?;
        bytes.finish()?;
        write_rest(results, state, &mut archive)?;
        archive.finish()?.flush()?;
        Ok(())
    })
}

type Archive<'a> = ZipWriter<&'a mut BufWriter<File>>;

/// Writes the verdicts of `state`.
pub(super) fn write(results: &Results, state: &State, folder: &mut Folder) -> anyhow::Result<()> {
    folder.write(&state.file_name("bits", "npz"), |file| {
        let mut archive = ZipWriter::new(file);
        let (count, stride) = (results.receivers.len(), results.row_shape().stride());
        let mut bits = begin::<u8>(&mut archive, "bits", &[count as u64, stride as u64])?;
        for_each_row(&state.rows, count, stride, |_, row| Ok(bits.extend(row.iter().copied())?))?;
        bits.finish()?;
        write_rest(results, state, &mut archive)?;
        archive.finish()?.flush()?;
        Ok(())
    })
}

/// When, where the sun is, and where receivers are.
fn write_rest(results: &Results, state: &State, archive: &mut Archive<'_>) -> anyhow::Result<()> {
    let steps = &results.timetable.steps;
    column(archive, "steps_utc_s", steps.iter().map(|step| step.start.as_second()))?;
    column(archive, "durations_s", steps.iter().map(Step::duration_s))?;
    column(archive, "utc_offset_s", steps.iter().map(|step| step.utc_offset_s))?;
    column(archive, "azimuth_deg", steps.iter().map(|step| step.sun.azimuth_rad.to_degrees()))?;
    column(archive, "altitude_deg", steps.iter().map(|step| step.sun.altitude_rad.to_degrees()))?;

    let mut positions = begin::<f64>(archive, "positions", &[results.receivers.len() as u64, 3])?;
    for &position in &results.receivers.positions {
        positions.extend(results.frame.to_model(position).to_array())?;
    }
    positions.finish()?;
    column(archive, "inside", state.is_inside.iter().map(|&inside| u8::from(inside)))
}

fn column<T: AutoSerialize>(
    archive: &mut Archive<'_>,
    name: &str,
    values: impl ExactSizeIterator<Item = T>,
) -> anyhow::Result<()> {
    let mut array = begin::<T>(archive, name, &[values.len() as u64])?;
    array.extend(values)?;
    Ok(array.finish()?)
}

/// An array in an archive, of which the shape is known and the values follow.
fn begin<'w, 'f, T: AutoSerialize>(
    archive: &'w mut Archive<'f>,
    name: &str,
    shape: &[u64],
) -> anyhow::Result<npyz::NpyWriter<T, &'w mut Archive<'f>>> {
    // The same study gives the same bytes, whenever it is done; and an array may have more than 4 GiB.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .large_file(true);
    archive.start_file(npyz::npz::file_name_from_array_name(name), options)?;
    Ok(WriteOptions::<T>::new().default_dtype().shape(shape).writer(archive).begin_nd()?)
}
