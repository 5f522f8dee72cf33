//! What colours mean, beside a map.

use crate::show::canvas::{Area, Canvas, Rgb};
use crate::show::text::{TextStyle, wrapped};

/// One statement of a legend.
#[derive(Debug, Clone)]
pub(super) enum Item {
    /// A heading.
    Heading(String),
    /// A sentence.
    Text(String),
    /// What one colour means.
    Area(Rgb, String),
    /// What a line of one colour means.
    Line(Rgb, String),
    /// What a range of colours means: from left to right, with numbers at places from 0 to 1.
    Scale(Vec<Rgb>, Vec<(f64, String)>),
    /// Room.
    Gap,
}

const INK: Rgb = [30, 34, 40];
const SWATCH_PX: i32 = 30;
const BAR_PX: i32 = 26;

/// Draws `items` into `area` from its top, and returns the row below the last.
pub(super) fn draw(canvas: &mut Canvas<'_>, items: &[Item], area: Area, line_px: i32) -> i32 {
    let (text, bold) = (TextStyle::new(line_px, false), TextStyle::new(line_px, true));
    let mut y = area.y;
    for item in items {
        match item {
            Item::Heading(words) => y = lines(canvas, words, [area.x, y], area.width, bold),
            Item::Text(words) => y = lines(canvas, words, [area.x, y], area.width, text),
            Item::Gap => y += line_px / 2,
            Item::Area(color, words) => {
                let swatch = Area::new(area.x, y + 2, SWATCH_PX, line_px - 4);
                canvas.fill(swatch, *color, 1.0);
                canvas.frame(swatch, 1, INK, 0.5);
                y = beside_swatch(canvas, words, [area.x, y], area.width, text);
            }
            Item::Line(color, words) => {
                canvas.fill(Area::new(area.x, y + line_px / 2 - 1, SWATCH_PX, 3), *color, 1.0);
                y = beside_swatch(canvas, words, [area.x, y], area.width, text);
            }
            Item::Scale(colors, ticks) => y = scale(canvas, colors, ticks, Area { y, ..area }, text),
        }
    }
    y
}

fn beside_swatch(canvas: &mut Canvas<'_>, words: &str, [x, y]: [i32; 2], width: i32, style: TextStyle) -> i32 {
    let indent = SWATCH_PX + style.advance();
    lines(canvas, words, [x + indent, y], width - indent, style) + 4
}

/// Draws `words` in lines as wide as `width`, and returns the row below.
pub(super) fn lines(canvas: &mut Canvas<'_>, words: &str, [x, mut y]: [i32; 2], width: i32, style: TextStyle) -> i32 {
    for line in wrapped(words, (width / style.advance()).max(1) as usize) {
        canvas.text(x, y, &line, style, INK);
        y += style.line_height();
    }
    y
}

fn scale(canvas: &mut Canvas<'_>, colors: &[Rgb], ticks: &[(f64, String)], area: Area, style: TextStyle) -> i32 {
    // Numbers stand under their place, and those at the ends stay within.
    let bar = Area::new(area.x, area.y + 4, area.width, BAR_PX);
    for column in 0..bar.width {
        let step = (column as usize * colors.len() / bar.width as usize).min(colors.len() - 1);
        canvas.fill(Area::new(bar.x + column, bar.y, 1, bar.height), colors[step], 1.0);
    }
    canvas.frame(bar, 1, INK, 0.6);
    let mut free_from = i32::MIN;
    for (place, number) in ticks {
        let at = bar.x + (place * f64::from(bar.width - 1)).round() as i32;
        let width = style.width(number);
        let x = (at - width / 2).clamp(bar.x, (bar.x + bar.width - width).max(bar.x));
        if x < free_from {
            continue;
        }
        canvas.fill(Area::new(at, bar.y + bar.height, 1, 5), INK, 1.0);
        canvas.text(x, bar.y + bar.height + 6, number, style, INK);
        free_from = x + width + style.advance();
    }
    bar.y + bar.height + 6 + style.line_height() + 4
}

/// Round numbers from 0 to `most`, some five to eight, and `most` itself where it is not near one.
pub(super) fn ticks(most: f64) -> Vec<(f64, String)> {
    if most <= 0.0 {
        return vec![(0.0, "0".to_owned())];
    }
    let step = nice_step(most / 6.0);
    let digits = (-step.log10().floor()).max(0.0) as usize;
    let count = (most / step + 1e-9).floor() as usize;
    (0..=count).map(|i| i as f64 * step).map(|value| (value / most, format!("{value:.digits$}"))).collect()
}

/// The least of 1, 2, 5, 10, … and their tenths that is not below `least`.
pub(super) fn nice_step(least: f64) -> f64 {
    let decade = 10_f64.powf(least.log10().floor());
    let nice = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade).into_iter().find(|&step| step >= least * (1.0 - 1e-9));
    nice.unwrap_or(10.0 * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_on_a_scale_are_round_and_within_it() {
        let texts = |most: f64| ticks(most).into_iter().map(|(_, text)| text).collect::<Vec<_>>().join(" ");
        assert_eq!(texts(8.0), "0 2 4 6 8");
        assert_eq!(texts(12.3), "0 5 10");
        assert_eq!(texts(1.5), "0.0 0.5 1.0 1.5");
        assert_eq!(texts(3650.0), "0 1000 2000 3000");
        assert!(ticks(12.3).iter().all(|(place, _)| (0.0..=1.0).contains(place)));
    }
}
