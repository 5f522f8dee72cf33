//! What the colours of a picture mean, written into the picture.

use super::canvas::{Canvas, Rgb};
use super::layout::Layout;
use super::text::{LINE_HEIGHTS_PX, TextStyle};

/// A title, and what each colour means.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Legend {
    pub(crate) title: String,
    pub(crate) rows: Vec<Row>,
}

/// One statement of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Row {
    /// A sentence without a colour.
    Text(String),
    /// What one colour means.
    Entry(Swatch, String),
    /// What a range of colours means.
    Scale(Scale),
}

/// A sample of how something is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Swatch {
    /// An area of one colour.
    Area(Rgb),
    /// A line.
    Line(Rgb),
    /// A frame.
    Frame(Rgb),
}

/// A bar of colours with numbers under it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scale {
    /// From left to right: steps of equal width, as many as there are colours.
    pub(crate) colors: Vec<Rgb>,
    /// Where along the bar (0 to 1) each number stands, ascending. Numbers that would touch the one before are left out.
    pub(crate) ticks: Vec<(f32, String)>,
}

impl Legend {
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), rows: Vec::new() }
    }

    pub(crate) fn text(mut self, text: impl Into<String>) -> Self {
        self.rows.push(Row::Text(text.into()));
        self
    }

    pub(crate) fn entry(mut self, swatch: Swatch, meaning: impl Into<String>) -> Self {
        self.rows.push(Row::Entry(swatch, meaning.into()));
        self
    }

    pub(crate) fn scale(mut self, scale: Scale) -> Self {
        self.rows.push(Row::Scale(scale));
        self
    }

    /// What it says, line by line, without colours.
    pub(crate) fn sentences(&self) -> Vec<String> {
        let of_row = |row: &Row| match row {
            Row::Text(text) | Row::Entry(_, text) => text.clone(),
            Row::Scale(scale) => scale.ticks.iter().map(|(_, tick)| tick.as_str()).collect::<Vec<_>>().join(" "),
        };
        std::iter::once(self.title.clone()).chain(self.rows.iter().map(of_row)).collect()
    }

    /// Draws the legend into the top left corner: as large as reads well, smaller where it would cover more than two fifths of the picture, and in a
    /// picture too small for all of it, as many lines as leave half of it free.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>) {
        if let Some(layout) = self.layout([canvas.width(), canvas.height()]) {
            layout.draw(canvas);
        }
    }

    /// `None` where not even a word has room.
    pub(super) fn layout(&self, picture_px: [i32; 2]) -> Option<Layout> {
        let [width, height] = picture_px;
        let wanted = TextStyle::line_height_for(height.min(width));
        let mut smallest = None;
        for size in LINE_HEIGHTS_PX.into_iter().rev().filter(|&size| size <= wanted) {
            let layout = Layout::new(self, size, width);
            let panel = layout.panel();
            if 5 * panel.width * panel.height <= 2 * width * height && panel.is_within(picture_px) {
                return Some(layout);
            }
            smallest = Some(layout);
        }
        smallest?.cut_to(picture_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::canvas::Area;

    fn legend() -> Legend {
        Legend::new("Cases of 12 casters under the sun")
            .text("McGuire's three cases decide which faces of a shadow volume are drawn")
            .entry(Swatch::Area([70, 130, 220]), "1: sides only (7)")
            .entry(Swatch::Line([220, 70, 70]), "a line")
            .scale(Scale {
                colors: vec![[0; 3], [90; 3], [200; 3]],
                ticks: vec![(0.0, "0".into()), (0.5, "middling".into()), (0.52, "left out".into()), (1.0, "2".into())],
            })
    }

    #[test]
    fn the_legend_is_inside_the_picture_at_every_size() {
        for size in [[64, 48], [100, 400], [160, 90], [320, 180], [960, 540], [1280, 720], [3840, 2160], [400, 100]] {
            let layout = legend().layout(size).unwrap_or_else(|| panic!("{size:?} has room for a word"));
            assert!(layout.panel().is_within(size), "{:?} in {size:?}", layout.panel());
            for text in layout.texts() {
                assert!(text.area.is_within(size), "{text:?} in {size:?}");
                assert!(!text.text.is_empty());
            }
        }
    }

    #[test]
    fn all_of_it_is_said_in_pictures_of_usual_size() {
        for size in [[640, 360], [960, 540], [1280, 720], [720, 1280], [3840, 2160]] {
            let layout = legend().layout(size).expect("there is room");
            let said: Vec<&str> = layout.texts().iter().map(|text| text.text).collect();
            let said = said.join(" ");
            for word in ["Cases", "sun", "drawn", "sides", "(7)", "a line", "0", "middling", "2"] {
                assert!(said.contains(word), "{word} in {size:?}: {said}");
            }
            assert!(!said.contains("left out"), "numbers don't run into each other: {said}");
        }
    }

    #[test]
    fn texts_of_a_legend_do_not_lie_on_each_other() {
        for size in [[160, 90], [1280, 720]] {
            let layout = legend().layout(size).expect("there is room");
            let texts = layout.texts();
            let meet = |a: &Area, b: &Area| {
                a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height
            };
            for (i, first) in texts.iter().enumerate() {
                for second in &texts[i + 1..] {
                    assert!(!meet(&first.area, &second.area), "{first:?} and {second:?} in {size:?}");
                }
            }
        }
    }

    #[test]
    fn a_picture_without_room_for_a_word_is_left_alone() {
        let mut rgba = vec![7; 4 * 10 * 10];
        legend().draw(&mut Canvas::new(&mut rgba, [10, 10]));
        assert!(rgba.iter().all(|&byte| byte == 7));
    }

    #[test]
    fn the_colours_of_swatches_are_those_of_the_picture() {
        let [width, height] = [960, 540];
        let mut rgba = vec![250; 4 * width * height];
        legend().draw(&mut Canvas::new(&mut rgba, [width as u32, height as u32]));
        for color in [[70, 130, 220], [220, 70, 70], [90, 90, 90], [200, 200, 200]] {
            let pixels = rgba.chunks_exact(4).filter(|pixel| pixel[..3] == color).count();
            assert!(pixels > 20, "{pixels} pixels of {color:?}");
        }
    }
}
