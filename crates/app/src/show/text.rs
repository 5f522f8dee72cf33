//! Text in pictures: Noto Sans Mono, from bitmaps, at sizes that are whole multiples or fractions of them.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// How tall and how heavy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TextStyle {
    size: TextSize,
    weight: FontWeight,
}

/// The height of a line of text: a bitmap, shrunk and enlarged by whole numbers so that it stays sharp.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct TextSize {
    bitmap: RasterHeight,
    shrink: i32,
    enlarge: i32,
}

/// Line heights in pixels that text can have, smallest first. At 8, letters are 4 pixels tall: only for pictures with no room for more.
pub(crate) const LINE_HEIGHTS_PX: [i32; 12] = [8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 96, 128];

/// A line of text is one such part of the picture's height.
const LINES_IN_A_PICTURE: i32 = 33;

impl TextStyle {
    /// Text in lines of `line_height_px`, one of [`LINE_HEIGHTS_PX`] (or else the next smaller).
    pub(crate) fn new(line_height_px: i32, is_bold: bool) -> Self {
        use RasterHeight::{Size16, Size20, Size24, Size32};
        let (bitmap, shrink, enlarge) = match line_height_px {
            ..10 => (Size16, 2, 1),
            10..12 => (Size20, 2, 1),
            12..16 => (Size24, 2, 1),
            16..20 => (Size16, 1, 1),
            20..24 => (Size20, 1, 1),
            24..32 => (Size24, 1, 1),
            32..40 => (Size32, 1, 1),
            40..48 => (Size20, 1, 2),
            48..64 => (Size24, 1, 2),
            64..96 => (Size32, 1, 2),
            96..128 => (Size32, 1, 3),
            _ => (Size32, 1, 4),
        };
        let weight = if is_bold { FontWeight::Bold } else { FontWeight::Regular };
        Self { size: TextSize { bitmap, shrink, enlarge }, weight }
    }

    /// The line height that reads well in a picture of `height_px`.
    pub(crate) fn line_height_for(height_px: i32) -> i32 {
        let wanted = height_px / LINES_IN_A_PICTURE;
        LINE_HEIGHTS_PX.into_iter().rev().find(|&height| height <= wanted).unwrap_or(LINE_HEIGHTS_PX[0])
    }

    /// From one line to the next, in pixels.
    pub(crate) fn line_height(self) -> i32 {
        self.size.bitmap.val() as i32 * self.size.enlarge / self.size.shrink
    }

    /// From one character to the next, in pixels.
    pub(crate) fn advance(self) -> i32 {
        let bitmap = get_raster_width(self.weight, self.size.bitmap) as i32;
        (bitmap * self.size.enlarge + self.size.shrink - 1) / self.size.shrink
    }

    /// How wide a line of `text` is, in pixels.
    pub(crate) fn width(self, text: &str) -> i32 {
        text.chars().count() as i32 * self.advance()
    }

    /// Calls `draw` with column, row and opacity for each pixel that `character` covers, from the top left of its box.
    ///
    /// Characters that the font lacks, and control characters, are shown as a question mark.
    pub(crate) fn for_each_pixel(self, character: char, mut draw: impl FnMut(i32, i32, f32)) {
        let TextSize { bitmap, shrink, enlarge } = self.size;
        let raster = |character| get_raster(character, self.weight, bitmap);
        let Some(raster) = raster(character).or_else(|| raster('?')) else { return };
        let [width, height] = [raster.width(), raster.height()].map(|side| side as i32);
        for row in 0..(height + shrink - 1) / shrink {
            for column in 0..(width + shrink - 1) / shrink {
                let block = (0..shrink).flat_map(|dy| (0..shrink).map(move |dx| (dx, dy)));
                let covered: i32 = block
                    .map(|(dx, dy)| raster.pixel((column * shrink + dx) as usize, (row * shrink + dy) as usize))
                    .map(|pixel| i32::from(pixel.unwrap_or(0)))
                    .sum();
                if covered == 0 {
                    continue;
                }
                let opacity = covered as f32 / (255 * shrink * shrink) as f32;
                for (dx, dy) in (0..enlarge).flat_map(|dy| (0..enlarge).map(move |dx| (dx, dy))) {
                    draw(column * enlarge + dx, row * enlarge + dy, opacity);
                }
            }
        }
    }
}

/// `text` in lines of at most `columns` characters, broken at spaces where there are any.
pub(crate) fn wrapped(text: &str, columns: usize) -> Vec<String> {
    let mut lines: Vec<Vec<char>> = Vec::new();
    for word in text.split_whitespace() {
        let word: Vec<char> = word.chars().collect();
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= columns => {
                line.push(' ');
                line.extend(word);
            }
            _ => lines.extend(word.chunks(columns.max(1)).map(<[char]>::to_vec)),
        }
    }
    lines.into_iter().map(String::from_iter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_height_is_what_it_says_and_letters_stay_in_their_box() {
        for height in LINE_HEIGHTS_PX {
            for is_bold in [false, true] {
                let style = TextStyle::new(height, is_bold);
                assert_eq!(style.line_height(), height);
                for character in ['M', 'g', 'Å', '@', '|'] {
                    let mut ink = 0.0;
                    style.for_each_pixel(character, |x, y, opacity| {
                        assert!(
                            (0..style.advance()).contains(&x) && (0..height).contains(&y),
                            "{character} at {x},{y}"
                        );
                        assert!((0.0..=1.0).contains(&opacity));
                        ink += opacity;
                    });
                    assert!(ink > 0.02 * (height * height) as f32, "{character} at {height} has {ink} of ink");
                }
            }
        }
    }

    #[test]
    fn text_grows_with_the_picture() {
        let of = TextStyle::line_height_for;
        assert_eq!([of(48), of(360), of(540), of(720), of(1080), of(2160)], [8, 10, 16, 20, 32, 64]);
    }

    #[test]
    fn a_name_that_the_font_lacks_still_shows_its_length() {
        let style = TextStyle::new(16, false);
        let ink = |character| {
            let mut pixels = Vec::new();
            style.for_each_pixel(character, |x, y, _| pixels.push((x, y)));
            pixels
        };
        assert_eq!(ink('❤'), ink('?'));
        assert_eq!(ink('\n'), ink('?'));
        assert_ne!(ink('ß'), ink('?'));
    }

    #[test]
    fn lines_break_at_spaces_and_long_words_anywhere() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("one twothreefour five", 5), ["one", "twoth", "reefo", "ur", "five"]);
        assert_eq!(wrapped("abc", 3), ["abc"]);
        assert_eq!(wrapped("", 3), [""; 0]);
        for columns in 1..20 {
            let text = "a wholly immoderate sentence of words";
            let lines = wrapped(text, columns);
            assert!(lines.iter().all(|line| line.chars().count() <= columns), "{columns}: {lines:?}");
            let letters = |text: &str| text.replace(' ', "");
            assert_eq!(letters(&lines.concat()), letters(text));
        }
    }
}
