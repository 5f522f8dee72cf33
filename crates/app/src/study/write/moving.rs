//! `day.apng`: the shadows of one day, moving.

use png::{BitDepth, ColorType, Encoder, Filter};
use rustc_hash::FxHashMap;

use super::footprints::Footprint;
use super::legend::Item;
use super::maps::{NamedMap, SOLID, heading_lines, notes};
use super::sheet::{Map, Sheet, line, paint};
use crate::show::canvas::{Area, Canvas, Rgb};
use crate::show::text::TextStyle;
use crate::study::folder::Folder;
use crate::study::results::{Results, State};
use crate::study::rows::{bit, for_each_row};
use crate::study::site::on_clock;

const SUN: Rgb = [255, 243, 196];
const SHADE: Rgb = [72, 88, 122];
const BUILT: Rgb = [60, 62, 66];
const INK: Rgb = [30, 34, 40];
/// Smaller than a still: there are many.
const MAP_PX: usize = 800;
/// A film of more is skipped over.
const MOST_FRAMES: usize = 96;
/// Frames in a second.
const FRAMES_PER_S: u16 = 4;

/// Writes the first day that has sun, if the ground was studied; gives back the first frame.
pub(super) fn write(
    results: &Results,
    state: &State,
    footprints: &[Footprint],
    folder: &mut Folder,
) -> anyhow::Result<Option<NamedMap>> {
    let (Some((grid, range)), Some(steps)) = (results.ground(), frames(results)) else { return Ok(None) };
    let map = Map::new(grid, MAP_PX);
    let stride = results.row_shape().stride();
    let bytes_of_cell = steps.len().div_ceil(8);
    let mut lit = vec![0_u8; grid.len() * bytes_of_cell];
    for_each_row(&state.rows, range.end, stride, |receiver, row| {
        if let Some(cell) = receiver.checked_sub(range.start) {
            for (frame, &step) in steps.iter().enumerate() {
                lit[cell * bytes_of_cell + frame / 8] |= u8::from(bit(row, step)) << (frame % 8);
            }
        }
        Ok(())
    })?;
    let color = |frame: usize| {
        let lit = &lit;
        move |cells: &mut dyn Iterator<Item = usize>| match cells.next() {
            Some(cell) if state.sums[cell + range.start].is_none() => SOLID,
            Some(cell) if bit(&lit[cell * bytes_of_cell..], frame) => SUN,
            _ => SHADE,
        }
    };
    let over = |canvas: &mut Canvas<'_>, area: Area, frame: usize| {
        for edge in footprints.iter().flat_map(Footprint::edges) {
            line(canvas, area, edge.map(|p| map.place_px(p)), 1.5, BUILT);
        }
        label(canvas, area, &moment_text(results, steps[frame]));
    };

    let sheet = Sheet {
        title: "Sun and shadow through the day".to_owned(),
        lines: heading_lines(results),
        legend: vec![
            Item::Area(SUN, "in the sun".to_owned()),
            Item::Area(SHADE, "in shadow".to_owned()),
            Item::Area(SOLID, "inside of a building".to_owned()),
            Item::Line(BUILT, "buildings, from above".to_owned()),
        ],
        notes: notes(results),
        north_deg: results.site.north_deg,
    };
    let first = sheet.draw(&map, color(0), |canvas, area| over(canvas, area, 0));
    let area = first.map_area;
    let name = state.file_name("day", "apng");
    let mut palette = Palette::new();
    folder.write(&name, |file| {
        let [width, height] = first.size_px;
        let mut encoder = Encoder::new(file, width, height);
        encoder.set_color(ColorType::Indexed);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_palette(palette.colors.concat());
        encoder.set_filter(Filter::NoFilter);
        encoder.set_animated(steps.len() as u32, 0)?;
        encoder.set_frame_delay(1, FRAMES_PER_S)?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&palette.indices(&first.rgba))?;
        for frame in 1..steps.len() {
            let size = [area.width as u32, area.height as u32];
            let mut rgba = vec![255; 4 * (size[0] * size[1]) as usize];
            let mut canvas = Canvas::new(&mut rgba, size);
            let whole = Area::new(0, 0, area.width, area.height);
            paint(&mut canvas, &map, whole, &color(frame));
            over(&mut canvas, whole, frame);
            writer.set_frame_dimension(size[0], size[1])?;
            writer.set_frame_position(area.x as u32, area.y as u32)?;
            writer.write_image_data(&palette.indices(&rgba))?;
        }
        writer.finish()?;
        Ok(())
    })?;
    Ok(Some(NamedMap { name, title: sheet.title, picture: first }))
}

/// The steps to show: those of the first day with sun, or every few of them.
fn frames(results: &Results) -> Option<Vec<usize>> {
    let is_day = |&step: &usize| results.suns[step].is_some();
    let of_day = |day: usize| results.timetable.steps_of_day(day).filter(is_day).collect::<Vec<_>>();
    let steps = (0..results.timetable.days.len()).map(of_day).find(|steps| !steps.is_empty())?;
    let every = steps.len().div_ceil(MOST_FRAMES);
    Some(steps.into_iter().step_by(every).collect())
}

/// `18 September 2026  09:07 (UTC+02:00)  sun 131° at 33°`.
fn moment_text(results: &Results, step: usize) -> String {
    let step = &results.timetable.steps[step];
    let time = on_clock(step.middle(), step.utc_offset_s).strftime("%-d %B %Y  %H:%M").to_string();
    let [azimuth, altitude] = [step.sun.azimuth_rad, step.sun.altitude_rad].map(f64::to_degrees);
    format!("{time}   sun: azimuth {azimuth:.0}\u{b0}, altitude {altitude:.0}\u{b0}")
}

fn label(canvas: &mut Canvas<'_>, area: Area, text: &str) {
    let style = TextStyle::new(24, true);
    canvas.fill(Area::new(area.x, area.y, style.width(text) + 24, style.line_height() + 16), [255; 3], 0.9);
    canvas.text(area.x + 12, area.y + 8, text, style, INK);
}

/// The few colours of the film, so that it is small: the plain ones, and what smooth edges mix of them.
struct Palette {
    colors: Vec<Rgb>,
    nearest: FxHashMap<Rgb, u8>,
}

/// Mixtures of two colours.
const MIXTURES: u16 = 8;

impl Palette {
    fn new() -> Self {
        let mix = |from: Rgb, to: Rgb, share: u16| -> Rgb {
            let channel = |i: usize| (u16::from(from[i]) * (MIXTURES - share) + u16::from(to[i]) * share) / MIXTURES;
            std::array::from_fn(|i| channel(i) as u8)
        };
        let pairs = [(SUN, BUILT), (SHADE, BUILT), (SOLID, BUILT), ([255; 3], INK)];
        let colors = pairs.into_iter().flat_map(|(from, to)| (0..=MIXTURES).map(move |share| mix(from, to, share)));
        Self { colors: colors.collect(), nearest: FxHashMap::default() }
    }

    /// For each pixel the index of the colour that is nearest to its own.
    fn indices(&mut self, rgba: &[u8]) -> Vec<u8> {
        let Self { colors, nearest } = self;
        let distance = |a: Rgb, b: Rgb| -> u32 { (0..3).map(|i| u32::from(a[i].abs_diff(b[i])).pow(2)).sum() };
        let find = |color: Rgb| (0..colors.len()).min_by_key(|&i| distance(colors[i], color)).unwrap_or(0) as u8;
        let pixels = rgba.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]);
        pixels.map(|color| *nearest.entry(color).or_insert_with(|| find(color))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_colours_stay_what_they_are() {
        let mut palette = Palette::new();
        for color in [SUN, SHADE, SOLID, BUILT, INK, [255; 3]] {
            let [r, g, b] = color;
            let index = palette.indices(&[r, g, b, 255])[0];
            assert_eq!(palette.colors[usize::from(index)], color);
        }
    }
}
