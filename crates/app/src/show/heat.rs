//! Numbers per pixel as colours: stencil counts, and fragments rasterised.

use super::canvas::{Canvas, Rgb};
use super::legend::{Legend, Scale, Swatch};
use super::numbers::grouped;

/// Up to so many different counts, each has a colour of its own with its number beside it.
const MOST_SINGLE_COUNTS: i32 = 8;
/// Counts below 0 are errors of z-pass where the eye is in shadow: nothing else has this colour.
const NEGATIVE: Rgb = [225, 30, 90];
/// A pixel that no volume touched, in the legend; in the picture the scene is seen there in such greys.
const UNTOUCHED: Rgb = [84, 84, 84];
const UNSHADED: Rgb = [214, 214, 214];

/// Colours every pixel by its stencil count; where it is 0, the scene is left in light greys.
///
/// `counts` has one entry for each pixel, row by row from the top.
pub(crate) fn draw_counts(canvas: &mut Canvas<'_>, counts: &[i32], light: &str) -> Legend {
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    for_each_pixel(canvas, |canvas, x, y, pixel| match counts[pixel] {
        0 => set_grey(canvas, x, y, 0.42, 0.50),
        count if count < 0 => canvas.mix(x, y, NEGATIVE, 1.0),
        count => canvas.mix(x, y, count_color(count, most), 1.0),
    });
    let of_pixels = |is_such: &dyn Fn(i32) -> bool| {
        share_of_picture(counts.iter().filter(|&&count| is_such(count)).count(), counts.len())
    };
    let mut legend = Legend::new(format!("Stencil count: shadow volumes around what is seen, {light}"))
        .entry(Swatch::Area(UNSHADED), format!("0, not in shadow: {}", of_pixels(&|count| count == 0)));
    if most <= MOST_SINGLE_COUNTS {
        for count in 1..=most {
            let share = of_pixels(&|c| c == count);
            legend = legend.entry(Swatch::Area(count_color(count, most)), format!("{count}: {share}"));
        }
    } else {
        let steps = 64.min(most);
        let colors = (0..steps).map(|i| count_color(1 + i * (most - 1) / (steps - 1), most)).collect();
        let at = |count: i32| (count - 1) as f32 / (most - 1) as f32;
        let ticks = nice_steps(1.0, f64::from(most)).into_iter().map(|value| value as i32);
        let mut ticks: Vec<(f32, String)> = ticks.map(|count| (at(count), count.to_string())).collect();
        ticks.push((1.0, most.to_string()));
        legend = legend.text("In shadow, by the number of volumes:").scale(Scale { colors, ticks });
    }
    if counts.iter().any(|&count| count < 0) {
        let share = of_pixels(&|count| count < 0);
        legend = legend.entry(Swatch::Area(NEGATIVE), format!("below 0, which is wrong: {share}"));
    }
    legend
}

/// `50.0 % of the picture`.
fn share_of_picture(pixels: usize, all: usize) -> String {
    let percent = 100.0 * pixels as f64 / all.max(1) as f64;
    let amount = if pixels > 0 && percent < 0.05 { "under 0.1".to_owned() } else { format!("{percent:.1}") };
    format!("{amount} % of the picture")
}

/// Viridis, from 1 to `most`.
fn count_color(count: i32, most: i32) -> Rgb {
    let t = if most > 1 { f64::from(count - 1) / f64::from(most - 1) } else { 0.0 };
    // Its lightest yellows are left to mean many; its darkest violet still differs from black.
    colorous::VIRIDIS.eval_continuous(0.04 + 0.96 * t).as_array()
}

/// How numbers of fragments become places on a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FillScale {
    most: f64,
    is_logarithmic: bool,
}

/// Above so many fragments in one pixel, equal steps of colour are equal factors.
const LINEAR_UP_TO: f64 = 24.0;
const FILL_STEPS: usize = 96;

impl FillScale {
    fn new(fill: &[u32]) -> Self {
        let most = f64::from(fill.iter().copied().max().unwrap_or(0).max(1));
        Self { most, is_logarithmic: most > LINEAR_UP_TO }
    }

    /// From 0 for no fragment to 1 for the most.
    fn place(self, fragments: f64) -> f64 {
        if self.is_logarithmic { fragments.ln_1p() / self.most.ln_1p() } else { fragments / self.most }
    }

    /// Inferno, without its black.
    fn color_at(place: f64) -> Rgb {
        colorous::INFERNO.eval_continuous(0.12 + 0.88 * place.clamp(0.0, 1.0)).as_array()
    }

    fn ticks(self) -> Vec<(f32, String)> {
        let values = if self.is_logarithmic {
            let decades = (0..12).map(|decade| 10_f64.powi(decade));
            let values = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|step| step * decade));
            std::iter::once(0.0).chain(values).take_while(|&value| value < self.most).collect()
        } else {
            nice_steps(0.0, self.most)
        };
        let tick = |value: f64| (self.place(value) as f32, grouped(value.round() as u64));
        values.into_iter().chain([self.most]).map(tick).collect()
    }
}

/// Colours every pixel by how many fragments of volumes were rasterised there; where there was none, the scene is left in dark greys.
///
/// `fill` has one entry for each pixel, row by row from the top.
pub(crate) fn draw_fill(canvas: &mut Canvas<'_>, fill: &[u32], light: &str) -> Legend {
    let scale = FillScale::new(fill);
    for_each_pixel(canvas, |canvas, x, y, pixel| {
        if fill[pixel] > 0 {
            canvas.mix(x, y, FillScale::color_at(scale.place(fill[pixel].into())), 1.0);
        } else {
            set_grey(canvas, x, y, 0.16, 0.34);
        }
    });
    let total: u64 = fill.iter().map(|&fragments| u64::from(fragments)).sum();
    let untouched = fill.iter().filter(|&&fragments| fragments == 0).count();
    let pixels = fill.len().max(1) as f64;
    let colors = (0..FILL_STEPS).map(|i| FillScale::color_at(i as f64 / (FILL_STEPS - 1) as f64)).collect();
    Legend::new(format!("Fill: fragments rasterised into the stencil per pixel, {light}"))
        .scale(Scale { colors, ticks: scale.ticks() })
        .entry(Swatch::Area(UNTOUCHED), format!("none: {}", share_of_picture(untouched, fill.len())))
        .text(format!(
            "{} fragments in all, {:.2} a pixel on average{}",
            grouped(total),
            total as f64 / pixels,
            if scale.is_logarithmic { "; logarithmic scale" } else { "" }
        ))
}

/// Calls `draw` with the column, the row and the index of each pixel.
fn for_each_pixel(canvas: &mut Canvas<'_>, mut draw: impl FnMut(&mut Canvas<'_>, i32, i32, usize)) {
    for y in 0..canvas.height() {
        for x in 0..canvas.width() {
            let pixel = y as usize * canvas.width() as usize + x as usize;
            draw(canvas, x, y, pixel);
        }
    }
}

/// Takes a pixel's colour away: its brightness goes from `darkest` to `darkest + range`, of 1.
fn set_grey(canvas: &mut Canvas<'_>, x: i32, y: i32, darkest: f32, range: f32) {
    let [r, g, b] = canvas.pixel(x, y).map(f32::from);
    let brightness = (0.299 * r + 0.587 * g + 0.114 * b) / 255.0;
    let grey = (255.0 * (darkest + range * brightness)).round() as u8;
    canvas.mix(x, y, [grey; 3], 1.0);
}

/// Whole numbers from `from` on and below `to`, in steps of 1, 2 or 5 times a power of ten, about six of them.
fn nice_steps(from: f64, to: f64) -> Vec<f64> {
    let rough = ((to - from) / 6.0).max(1.0);
    let decade = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * decade).into_iter().find(|&s| s >= rough).unwrap_or(10.0 * decade);
    let first = (from / step).floor() * step;
    let steps = (1..).map(|i| first + f64::from(i) * step).take_while(|&value| value < to);
    std::iter::once(from).chain(steps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::legend::Row;

    fn on_grey<T>(pixels: usize, draw: impl FnOnce(&mut Canvas<'_>) -> T) -> (Vec<Rgb>, T) {
        let mut rgba = vec![128; 4 * pixels];
        let drawn = draw(&mut Canvas::new(&mut rgba, [pixels as u32, 1]));
        (rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect(), drawn)
    }

    fn is_grey([r, g, b]: Rgb) -> bool {
        r == g && g == b
    }

    #[test]
    fn equal_counts_have_the_colour_that_the_legend_gives_them() {
        let counts = [0, 1, 2, 3, 3, 0, -1];
        let (pixels, legend) = on_grey(counts.len(), |canvas| draw_counts(canvas, &counts, "sun"));
        let color_of = |start: &str| {
            let found = legend.rows.iter().find_map(|row| match row {
                Row::Entry(Swatch::Area(color), text) if text.starts_with(start) => Some(*color),
                _ => None,
            });
            found.unwrap_or_else(|| panic!("no entry starts with {start}: {legend:?}"))
        };
        assert!(is_grey(pixels[0]) && pixels[0] == pixels[5]);
        assert_eq!(pixels[1], color_of("1:"));
        assert_eq!(pixels[2], color_of("2:"));
        assert_eq!([pixels[3], pixels[4]], [color_of("3:"); 2]);
        assert_eq!(pixels[6], color_of("below 0"));
        let said = legend.sentences().join("\n");
        assert!(said.contains("0, not in shadow: 28.6 %") && said.contains("3: 28.6 %"), "{said}");
    }

    #[test]
    fn many_counts_share_a_scale_whose_ends_are_1_and_the_largest() {
        let counts: Vec<i32> = (0..=301).collect();
        let (pixels, legend) = on_grey(counts.len(), |canvas| draw_counts(canvas, &counts, "sun"));
        let scale = legend.rows.iter().find_map(|row| if let Row::Scale(scale) = row { Some(scale) } else { None });
        let scale = scale.expect("301 counts need a scale");
        assert_eq!((scale.colors.first(), scale.colors.last()), (Some(&pixels[1]), Some(&pixels[301])));
        assert_eq!(scale.ticks.first(), Some(&(0.0, "1".to_owned())));
        assert_eq!(scale.ticks.last(), Some(&(1.0, "301".to_owned())));
        for (at, text) in &scale.ticks {
            let count: f32 = text.parse().expect("a number");
            assert!((at - (count - 1.0) / 300.0).abs() < 1e-6, "{count} stands at {at}");
            let color = scale.colors[((at * 63.0).round() as usize).min(63)];
            let apart = pixels[count as usize].iter().zip(color).map(|(a, b)| a.abs_diff(b)).max();
            assert!(apart <= Some(4), "{count}: {color:?} on the scale, {:?} drawn", pixels[count as usize]);
        }
    }

    #[test]
    fn a_logarithmic_scale_has_equal_steps_for_equal_factors() {
        let fill = [0, 1, 3, 7, 15, 31, 63];
        let scale = FillScale::new(&fill);
        assert!(scale.is_logarithmic);
        let places: Vec<f64> = fill.iter().map(|&f| scale.place(f.into())).collect();
        for (i, place) in places.iter().enumerate() {
            assert!((place - i as f64 / 6.0).abs() < 1e-6, "1 + fill doubles six times: {places:?}");
        }
        let ticks: Vec<String> = scale.ticks().into_iter().map(|(_, text)| text).collect();
        assert_eq!(ticks, ["0", "1", "2", "5", "10", "20", "50", "63"]);
    }

    #[test]
    fn a_few_fragments_have_a_scale_of_equal_steps() {
        let scale = FillScale::new(&[0, 3, 10]);
        assert_eq!((scale.place(0.0), scale.place(2.5), scale.place(10.0)), (0.0, 0.25, 1.0));
        assert_eq!(scale.ticks().first(), Some(&(0.0, "0".to_owned())));
        assert_eq!(scale.ticks().last(), Some(&(1.0, "10".to_owned())));
    }

    #[test]
    fn fill_says_total_and_mean_and_leaves_untouched_pixels_grey() {
        let fill = [0, 4, 8, 0];
        let (pixels, legend) = on_grey(4, |canvas| draw_fill(canvas, &fill, "sun"));
        assert!(is_grey(pixels[0]) && is_grey(pixels[3]));
        assert_eq!(pixels[2], FillScale::color_at(1.0));
        assert_eq!(pixels[1], FillScale::color_at(0.5));
        let said = legend.sentences().join("\n");
        assert!(said.contains("12 fragments in all, 3.00 a pixel on average"), "{said}");
        assert!(said.contains("none: 50.0 %"), "{said}");
    }

    #[test]
    fn a_picture_without_any_shadow_has_a_legend_too() {
        let (_, legend) = on_grey(3, |canvas| draw_counts(canvas, &[0; 3], "sun"));
        assert!(legend.sentences().join("\n").contains("0, not in shadow: 100.0 %"));
        let (_, legend) = on_grey(3, |canvas| draw_fill(canvas, &[0; 3], "sun"));
        assert!(legend.sentences().join("\n").contains("0 fragments in all"));
    }

    #[test]
    fn a_few_pixels_are_more_than_none() {
        assert_eq!(share_of_picture(0, 1_000_000), "0.0 % of the picture");
        assert_eq!(share_of_picture(3, 1_000_000), "under 0.1 % of the picture");
        assert_eq!(share_of_picture(1_000, 1_000_000), "0.1 % of the picture");
    }

    #[test]
    fn steps_are_round_numbers() {
        assert_eq!(nice_steps(0.0, 10.0), [0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!(nice_steps(1.0, 301.0), [1.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0]);
        assert_eq!(nice_steps(0.0, 1.0), [0.0]);
    }
}
