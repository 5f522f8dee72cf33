//! A sheet of paper with a map on it, as it is handed in.
//!
//! ```text
//!   Title                                   +--------+
//!   what, where, when, by which clock       |        |
//!   +-----------------------------+  legend
//!   |                             |  true north, scale bar
//!   |   map: whole pixels a cell  |  error bound, method,
//!   |                             |  software and version
//!   +-----------------------------+
//! ```

use glam::DVec2;
use umbrae_study::GroundGrid;

use super::legend::{self, Item, lines, nice_step};
use crate::show::canvas::{Area, Canvas, Rgb};
use crate::show::text::TextStyle;

const PAPER: Rgb = [255, 255, 255];
const INK: Rgb = [30, 34, 40];
const MARGIN_PX: i32 = 36;
const PANEL_PX: i32 = 440;
const LINE_PX: i32 = 24;
const TITLE_PX: i32 = 48;
/// A map is so wide or high at the least…
const LEAST_MAP_PX: usize = 1200;
/// …and at the most.
const MOST_MAP_PX: usize = 3600;
/// The panel beside the map needs this.
const LEAST_HEIGHT_PX: i32 = 820;

/// How a grid is shown: a cell is many pixels, or a pixel many cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Map {
    pub(super) grid: GroundGrid,
    /// Pixels for a cell…
    enlarge: usize,
    /// …or cells for a pixel; one of the two is 1.
    shrink: usize,
}

/// What stands around a map.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    pub(super) title: String,
    /// What, where, when.
    pub(super) lines: Vec<String>,
    pub(super) legend: Vec<Item>,
    pub(super) notes: Vec<String>,
    /// Where true north is: clockwise from up, degrees.
    pub(super) north_deg: f64,
}

/// A finished picture.
#[derive(Debug, Clone)]
pub(super) struct Picture {
    pub(super) rgba: Vec<u8>,
    pub(super) size_px: [u32; 2],
    /// Where the map is in it.
    pub(super) map_area: Area,
}

impl Map {
    /// Shows `grid` with a longer side of about `wanted_px` pixels or somewhat more.
    pub(super) fn new(grid: GroundGrid, wanted_px: usize) -> Self {
        let longer = grid.columns.max(grid.rows).max(1);
        let enlarge = (wanted_px.min(MOST_MAP_PX)).div_ceil(longer).min((MOST_MAP_PX / longer).max(1)).max(1);
        Self { grid, enlarge, shrink: longer.div_ceil(MOST_MAP_PX) }
    }

    pub(super) fn usual(grid: GroundGrid) -> Self {
        Self::new(grid, LEAST_MAP_PX)
    }

    /// Pixels across and down.
    pub(super) fn size_px(&self) -> [i32; 2] {
        [self.grid.columns, self.grid.rows].map(|cells| (cells * self.enlarge).div_ceil(self.shrink) as i32)
    }

    /// The cells under a pixel of the map.
    pub(super) fn cells(&self, x: i32, y: i32) -> impl Iterator<Item = usize> + '_ {
        let of = |pixel: i32, cells: usize| {
            let first = pixel as usize * self.shrink / self.enlarge;
            first..(first + self.shrink).min(cells)
        };
        let columns = of(x, self.grid.columns);
        of(y, self.grid.rows).flat_map(move |row| columns.clone().map(move |column| row * self.grid.columns + column))
    }

    /// Metres for a pixel.
    fn metres_for_px(&self) -> f64 {
        self.grid.spacing * self.shrink as f64 / self.enlarge as f64
    }

    /// Where a point of the scene is, in pixels from the map's upper left corner.
    pub(super) fn place_px(&self, point: DVec2) -> DVec2 {
        let corner = self.grid.first + 0.5 * self.grid.spacing * DVec2::new(-1.0, 1.0);
        (point - corner) * DVec2::new(1.0, -1.0) / self.metres_for_px()
    }
}

impl Sheet {
    /// Draws the sheet with the map on it: `color` tells that of the cells of a pixel, and `over` draws on the map.
    pub(super) fn draw(
        &self,
        map: &Map,
        color: impl Fn(&mut dyn Iterator<Item = usize>) -> Rgb,
        over: impl FnOnce(&mut Canvas<'_>, Area),
    ) -> Picture {
        let [map_width, map_height] = map.size_px();
        let width = 3 * MARGIN_PX + map_width + PANEL_PX;
        let text = TextStyle::new(LINE_PX, false);
        let columns = ((width - 2 * MARGIN_PX) / text.advance()) as usize;
        let head: i32 = self.lines.iter().map(|line| crate::show::text::wrapped(line, columns).len() as i32).sum();
        let top = MARGIN_PX + TITLE_PX + 8 + head * LINE_PX + MARGIN_PX / 2;
        let height = top + map_height.max(LEAST_HEIGHT_PX) + MARGIN_PX;

        let mut rgba = vec![255; 4 * (width * height) as usize];
        let mut canvas = Canvas::new(&mut rgba, [width as u32, height as u32]);
        canvas.fill(Area::new(0, 0, width, height), PAPER, 1.0);
        canvas.text(MARGIN_PX, MARGIN_PX, &self.title, TextStyle::new(TITLE_PX, true), INK);
        let mut y = MARGIN_PX + TITLE_PX + 8;
        for line in &self.lines {
            y = lines(&mut canvas, line, [MARGIN_PX, y], width - 2 * MARGIN_PX, text);
        }
        let area = Area::new(MARGIN_PX, top, map_width, map_height);
        paint(&mut canvas, map, area, &color);
        over(&mut canvas, area);
        canvas.frame(Area::new(area.x - 2, area.y - 2, map_width + 4, map_height + 4), 2, INK, 1.0);

        let panel = Area::new(area.x + map_width + MARGIN_PX, top, PANEL_PX, height - top - MARGIN_PX);
        let below = legend::draw(&mut canvas, &self.legend, panel, LINE_PX);
        let below = north_arrow(&mut canvas, [panel.x, below + LINE_PX], self.north_deg);
        let below = scale_bar(&mut canvas, map, Area { y: below + LINE_PX, ..panel });
        let notes: Vec<Item> = self.notes.iter().flat_map(|note| [Item::Text(note.clone()), Item::Gap]).collect();
        legend::draw(&mut canvas, &notes, Area { y: below + LINE_PX, ..panel }, 20);
        Picture { rgba, size_px: [width as u32, height as u32], map_area: area }
    }
}

/// Paints every pixel of the map.
pub(super) fn paint(
    canvas: &mut Canvas<'_>,
    map: &Map,
    area: Area,
    color: &impl Fn(&mut dyn Iterator<Item = usize>) -> Rgb,
) {
    for y in 0..area.height {
        let mut last: Option<([usize; 2], Rgb)> = None;
        for x in 0..area.width {
            let cell = [x as usize / map.enlarge, y as usize / map.enlarge];
            let color = match last {
                Some((same, color)) if same == cell && map.enlarge > 1 => color,
                _ => color(&mut map.cells(x, y)),
            };
            last = Some((cell, color));
            canvas.mix(area.x + x, area.y + y, color, 1.0);
        }
    }
}

/// A line between two points in pixels from the corner of `area`, clipped to it, `width` pixels wide with smooth borders.
pub(super) fn line(canvas: &mut Canvas<'_>, area: Area, [a, b]: [DVec2; 2], width: f64, color: Rgb) {
    let reach = 0.5 * width + 1.0;
    let size = DVec2::new(f64::from(area.width), f64::from(area.height));
    // Only the part along which the line is in the area.
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let way = b - a;
    for (start, way, end) in [(a.x, way.x, size.x), (a.y, way.y, size.y)] {
        if way == 0.0 {
            if !(-reach..=end + reach).contains(&start) {
                return;
            }
            continue;
        }
        let [t, u] = [(-reach - start) / way, (end + reach - start) / way];
        enter = enter.max(t.min(u));
        leave = leave.min(t.max(u));
    }
    if enter > leave {
        return;
    }
    let (a, b) = (a + way * enter, a + way * leave);
    let way = b - a;
    let length = way.length();
    let along = if length > 0.0 { way / length } else { DVec2::ZERO };
    // Column by column, or row by row where it is steep: so long lines take no more than they are long.
    let is_steep = way.y.abs() > way.x.abs();
    let (from, to) = if is_steep { (a.y.min(b.y), a.y.max(b.y)) } else { (a.x.min(b.x), a.x.max(b.x)) };
    for i in (from - reach).floor() as i32..=(to + reach).ceil() as i32 {
        let middle = f64::from(i) + 0.5;
        let t = if is_steep { (middle - a.y) / way.y } else { (middle - a.x) / way.x };
        let center = if length > 0.0 { a + way * t.clamp(0.0, 1.0) } else { a };
        let across = if is_steep { center.x } else { center.y };
        let half = (1.5 * reach).ceil() as i32 + 1;
        for j in across.floor() as i32 - half..=across.floor() as i32 + half {
            let (x, y) = if is_steep { (j, i) } else { (i, j) };
            if !(0..area.width).contains(&x) || !(0..area.height).contains(&y) {
                continue;
            }
            let pixel = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) - a;
            let nearest = along * pixel.dot(along).clamp(0.0, length);
            let opacity = (0.5 * width + 0.5 - pixel.distance(nearest)).clamp(0.0, 1.0);
            canvas.mix(area.x + x, area.y + y, color, opacity as f32);
        }
    }
}

/// Fills a polygon given by rings in pixels from the corner of `area`, by the even-odd rule, with smooth borders.
pub(super) fn fill(canvas: &mut Canvas<'_>, area: Area, rings: &[Vec<DVec2>], color: Rgb, opacity: f32) {
    /// Lines of samples for a row of pixels.
    const SAMPLES: i32 = 4;
    let points = || rings.iter().flatten();
    let top = points().map(|p| p.y).fold(f64::INFINITY, f64::min).max(0.0).floor() as i32;
    let bottom = points().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max).min(f64::from(area.height)).ceil() as i32;
    let mut covered = vec![0.0_f32; area.width.max(0) as usize];
    for y in top..bottom.min(area.height) {
        covered.fill(0.0);
        for sample in 0..SAMPLES {
            let height = f64::from(y) + (f64::from(sample) + 0.5) / f64::from(SAMPLES);
            let mut crossings: Vec<f64> = Vec::new();
            for ring in rings {
                for i in 0..ring.len() {
                    let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                    if (a.y <= height) != (b.y <= height) {
                        crossings.push(a.x + (height - a.y) / (b.y - a.y) * (b.x - a.x));
                    }
                }
            }
            crossings.sort_by(f64::total_cmp);
            for span in crossings.chunks_exact(2) {
                let (from, to) = (span[0].max(0.0), span[1].min(f64::from(area.width)));
                for x in from.floor().max(0.0) as i32..to.ceil() as i32 {
                    let part = (to.min(f64::from(x) + 1.0) - from.max(f64::from(x))).clamp(0.0, 1.0);
                    covered[x as usize] += part as f32 / SAMPLES as f32;
                }
            }
        }
        for (x, &share) in covered.iter().enumerate().filter(|&(_, &share)| share > 0.0) {
            canvas.mix(area.x + x as i32, area.y + y, color, share * opacity);
        }
    }
}

/// An arrow to true north with its name; returns the row below.
fn north_arrow(canvas: &mut Canvas<'_>, [x, y]: [i32; 2], north_deg: f64) -> i32 {
    const SIZE_PX: i32 = 110;
    let middle = DVec2::splat(0.5 * f64::from(SIZE_PX));
    let (sin, cos) = north_deg.to_radians().sin_cos();
    let turned = |right: f64, up: f64| middle + DVec2::new(right * cos + up * sin, right * sin - up * cos);
    let area = Area::new(x, y, SIZE_PX, SIZE_PX);
    // Half of it dark, as on a compass.
    let (tip, tail) = (turned(0.0, 48.0), turned(0.0, -22.0));
    fill(canvas, area, &[vec![tip, turned(22.0, -40.0), tail]], INK, 1.0);
    for edge in [[tip, turned(-22.0, -40.0)], [turned(-22.0, -40.0), tail], [tail, tip]] {
        line(canvas, area, edge, 2.0, INK);
    }
    let style = TextStyle::new(LINE_PX, true);
    canvas.text(x + SIZE_PX + 8, y + SIZE_PX / 2 - LINE_PX, "N", TextStyle::new(40, true), INK);
    canvas.text(x + SIZE_PX + 40, y + SIZE_PX / 2 - LINE_PX / 2, "true north", style, INK);
    y + SIZE_PX
}

/// A bar of a round number of metres; returns the row below.
fn scale_bar(canvas: &mut Canvas<'_>, map: &Map, area: Area) -> i32 {
    let metres_for_px = map.metres_for_px();
    let longest = 0.8 * f64::from(area.width.min(map.size_px()[0].max(100))) * metres_for_px;
    let length = if nice_step(longest) > longest * (1.0 + 1e-9) { nice_step(longest / 2.5) } else { longest };
    let px = (length / metres_for_px).round() as i32;
    let bar = Area::new(area.x, area.y, px, 10);
    canvas.fill(Area { width: px / 2, ..bar }, INK, 1.0);
    canvas.frame(bar, 2, INK, 1.0);
    let style = TextStyle::new(LINE_PX, false);
    let text = |metres: f64| format!("{metres}");
    canvas.text(bar.x, bar.y + 14, "0", style, INK);
    let half = text(length / 2.0);
    canvas.text(bar.x + px / 2 - style.width(&half) / 2, bar.y + 14, &half, style, INK);
    let whole = format!("{} m", text(length));
    let end = (bar.x + px - style.advance()).min(area.x + area.width - style.width(&whole));
    canvas.text(end, bar.y + 14, &whole, style, INK);
    bar.y + 14 + LINE_PX
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(columns: usize, rows: usize) -> GroundGrid {
        GroundGrid { first: DVec2::new(0.5, 9.5), spacing: 1.0, columns, rows, level: 0.0 }
    }

    #[test]
    fn a_map_is_large_enough_to_hand_in_and_not_larger_than_a_wall() {
        for (columns, rows) in [(1, 1), (30, 20), (400, 300), (1199, 5), (9000, 4000), (3000, 100_000)] {
            let [width, height] = Map::usual(grid(columns, rows)).size_px();
            let longer = width.max(height) as usize;
            assert!((LEAST_MAP_PX..=MOST_MAP_PX).contains(&longer), "{columns} x {rows}: {width} x {height}");
        }
    }

    #[test]
    fn every_cell_has_pixels_and_points_of_the_scene_lie_on_their_cells() {
        let map = Map::new(grid(7, 10), 30);
        let [width, height] = map.size_px();
        let mut seen = vec![0; 70];
        for y in 0..height {
            for x in 0..width {
                map.cells(x, y).for_each(|cell| seen[cell] += 1);
            }
        }
        assert!(seen.iter().all(|&pixels| pixels == 9), "{seen:?}");
        let middle = map.place_px(map.grid.middle(3, 2));
        assert_eq!(map.cells(middle.x as i32, middle.y as i32).collect::<Vec<_>>(), [2 * 7 + 3]);
    }

    #[test]
    fn a_filled_square_has_its_area_and_a_hole_stays_free() {
        let square = |a: f64, b: f64| vec![DVec2::new(a, a), DVec2::new(b, a), DVec2::new(b, b), DVec2::new(a, b)];
        let mut rgba = vec![0; 4 * 20 * 20];
        let mut canvas = Canvas::new(&mut rgba, [20, 20]);
        fill(&mut canvas, Area::new(0, 0, 20, 20), &[square(2.5, 12.5), square(5.0, 8.0)], [200; 3], 1.0);
        let sum: f64 = (0..400).map(|i| f64::from(canvas.pixel(i % 20, i / 20)[0]) / 200.0).sum();
        assert!((sum - (100.0 - 9.0)).abs() < 1.0, "{sum}");
        assert_eq!((canvas.pixel(6, 6)[0], canvas.pixel(3, 3)[0]), (0, 200));
    }

    #[test]
    fn a_line_is_as_wide_as_it_is_said_and_stays_in_its_area() {
        for [a, b] in [
            [DVec2::new(3.0, 10.0), DVec2::new(17.0, 10.0)],
            [DVec2::new(10.0, 3.0), DVec2::new(10.0, 17.0)],
            [DVec2::new(5.05, 5.05), DVec2::new(14.95, 14.95)],
        ] {
            let mut rgba = vec![0; 4 * 20 * 20];
            let mut canvas = Canvas::new(&mut rgba, [20, 20]);
            line(&mut canvas, Area::new(0, 0, 20, 20), [a, b], 2.0, [100; 3]);
            let sum: f64 = (0..400).map(|i| f64::from(canvas.pixel(i % 20, i / 20)[0]) / 100.0).sum();
            assert!((sum - 2.0 * 14.0).abs() < 5.0, "{a} {b}: {sum}");
        }
        let mut rgba = vec![0; 4 * 20 * 20];
        let mut canvas = Canvas::new(&mut rgba, [20, 20]);
        let far = [DVec2::new(-1e7, 5.0), DVec2::new(1e7, 5.0)];
        line(&mut canvas, Area::new(5, 5, 10, 10), far, 1.0, [100; 3]);
        assert_eq!((canvas.pixel(4, 10)[0], canvas.pixel(15, 10)[0]), (0, 0));
        assert!(canvas.pixel(10, 10)[0] > 30);
    }
}
