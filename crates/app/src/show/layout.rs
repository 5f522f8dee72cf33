//! A legend in lines of one size of text, and where each is in the picture.

use super::canvas::{Area, Canvas, Rgb};
use super::legend::{Legend, Row, Swatch};
use super::text::{TextStyle, wrapped};

const PANEL: Rgb = [22, 24, 29];
/// The picture is seen through the panel a little, so that nothing seems to be cut away.
const PANEL_OPACITY: f32 = 0.86;
const INK: Rgb = [242, 242, 238];
const QUIET_INK: Rgb = [188, 190, 193];

/// Lines are at most this many characters long, for the eye's sake, and keep within this share of the picture…
const MOST_COLUMNS: i32 = 44;
const WIDTH_SHARE: f32 = 0.6;
/// …unless that is less than this.
const LEAST_COLUMNS: i32 = 22;
/// A word of fewer characters says nothing.
const LEAST_WORD: i32 = 6;
/// Room for a swatch, in characters.
const SWATCH_COLUMNS: i32 = 3;
/// The length of a scale, in characters.
const BAR_COLUMNS: i32 = 36;

/// A legend for one picture.
#[derive(Debug)]
pub(super) struct Layout {
    plain: TextStyle,
    bold: TextStyle,
    columns: i32,
    lines: Vec<Line>,
}

/// One text in its place.
#[derive(Debug)]
pub(super) struct Text<'a> {
    pub(super) area: Area,
    pub(super) text: &'a str,
    style: TextStyle,
    ink: Rgb,
}

#[derive(Debug)]
struct Line {
    /// Pixels of air above it.
    gap: i32,
    content: Content,
}

#[derive(Debug)]
enum Content {
    Title(String),
    Text(String),
    /// With its swatch where it is an entry's first line.
    Entry(Option<Swatch>, String),
    Bar(Vec<Rgb>),
    Ticks(Vec<(f32, String)>),
}

impl Layout {
    /// `legend` in lines of `line_height`, as wide as suits a picture of `picture_width`.
    pub(super) fn new(legend: &Legend, line_height: i32, picture_width: i32) -> Self {
        let (plain, bold) = (TextStyle::new(line_height, false), TextStyle::new(line_height, true));
        let mut layout = Self { plain, bold, columns: 0, lines: Vec::new() };
        let room = |width: i32| (width - 2 * (layout.margin() + layout.padding())) / plain.advance();
        let share = room((picture_width as f32 * WIDTH_SHARE) as i32).max(LEAST_COLUMNS);
        layout.columns = share.min(room(picture_width)).min(MOST_COLUMNS);
        let columns = layout.columns.max(1) as usize;
        let entry_columns = (layout.columns - SWATCH_COLUMNS).max(1) as usize;

        layout.add(wrapped(&legend.title, columns).into_iter().map(Content::Title));
        for row in &legend.rows {
            match row {
                Row::Text(text) => layout.add(wrapped(text, columns).into_iter().map(Content::Text)),
                Row::Entry(swatch, text) => {
                    let lines = wrapped(text, entry_columns).into_iter().enumerate();
                    layout.add(lines.map(|(i, line)| Content::Entry((i == 0).then_some(*swatch), line)));
                }
                Row::Scale(scale) => {
                    let bar = Content::Bar(scale.colors.clone());
                    layout.add([bar, Content::Ticks(scale.ticks.clone())].into_iter());
                }
            }
        }
        layout
    }

    /// Adds the lines of one row.
    fn add(&mut self, contents: impl Iterator<Item = Content>) {
        let between_rows = self.plain.line_height() / 4;
        for (i, content) in contents.enumerate() {
            let gap = if i == 0 && !self.lines.is_empty() { between_rows } else { 0 };
            self.lines.push(Line { gap, content });
        }
    }

    /// Around the panel.
    fn margin(&self) -> i32 {
        self.plain.line_height() / 2
    }

    /// Around what is on the panel.
    fn padding(&self) -> i32 {
        self.plain.line_height() / 2
    }

    /// Without the last lines, as many as would cover more than half of the picture; `None` where no word would be left.
    pub(super) fn cut_to(mut self, picture_px: [i32; 2]) -> Option<Self> {
        if self.columns < LEAST_WORD {
            return None;
        }
        let [width, height] = picture_px;
        let is_good = |panel: Area| panel.is_within(picture_px) && 2 * panel.width * panel.height <= width * height;
        while !self.lines.is_empty() && !is_good(self.panel()) {
            self.lines.pop();
            // A bar without its numbers says nothing.
            if matches!(self.lines.last(), Some(Line { content: Content::Bar(_), .. })) {
                self.lines.pop();
            }
        }
        (!self.lines.is_empty()).then_some(self)
    }

    /// The area that the legend covers.
    pub(super) fn panel(&self) -> Area {
        let width = self.lines.iter().map(|line| self.width_of(&line.content)).max().unwrap_or(0);
        let height: i32 = self.lines.iter().map(|line| line.gap + self.plain.line_height()).sum();
        let around = 2 * self.padding();
        Area::new(self.margin(), self.margin(), width + around, height + around)
    }

    fn width_of(&self, content: &Content) -> i32 {
        match content {
            Content::Title(text) => self.bold.width(text),
            Content::Text(text) => self.plain.width(text),
            Content::Entry(_, text) => self.text_indent() + self.plain.width(text),
            Content::Bar(_) | Content::Ticks(_) => self.bar_width(),
        }
    }

    fn text_indent(&self) -> i32 {
        SWATCH_COLUMNS * self.plain.advance()
    }

    fn bar_width(&self) -> i32 {
        BAR_COLUMNS.min(self.columns) * self.plain.advance()
    }

    /// Each line with the place of its top left corner.
    fn placed(&self) -> impl Iterator<Item = (i32, i32, &Content)> {
        let left = self.margin() + self.padding();
        let mut next = left;
        self.lines.iter().map(move |line| {
            let top = next + line.gap;
            next = top + self.plain.line_height();
            (left, top, &line.content)
        })
    }

    /// Each text, a scale's numbers one by one.
    pub(super) fn texts(&self) -> Vec<Text<'_>> {
        let mut texts = Vec::new();
        for (left, top, content) in self.placed() {
            let mut add = |x, text, style: TextStyle, ink| {
                texts.push(Text { area: Area::new(x, top, style.width(text), style.line_height()), text, style, ink });
            };
            match content {
                Content::Title(text) => add(left, text, self.bold, INK),
                Content::Text(text) => add(left, text, self.plain, QUIET_INK),
                Content::Entry(_, text) => add(left + self.text_indent(), text, self.plain, INK),
                Content::Bar(_) => {}
                Content::Ticks(ticks) => {
                    for (x, text) in self.readable_ticks(left, ticks) {
                        add(x, text, self.plain, INK);
                    }
                }
            }
        }
        texts
    }

    /// The ticks that stand apart, with their left ends: the first and the last, and between them each that has room.
    fn readable_ticks<'a>(&self, left: i32, ticks: &'a [(f32, String)]) -> Vec<(i32, &'a str)> {
        let air = self.plain.advance();
        let place = |(at, text): &'a (f32, String)| {
            let width = self.plain.width(text);
            let middle = left + (at * self.bar_width() as f32) as i32;
            let rightmost = (left + self.bar_width() - width).max(left);
            ((middle - width / 2).clamp(left, rightmost), text.as_str())
        };
        let end_of = |(x, text): (i32, &str)| x + self.plain.width(text) + air;
        let Some((last, others)) = ticks.split_last() else { return Vec::new() };
        let last = place(last);
        let mut kept: Vec<(i32, &str)> = Vec::new();
        for tick in others.iter().map(place) {
            let is_free = kept.last().is_none_or(|&before| end_of(before) <= tick.0);
            if is_free && end_of(tick) <= last.0 {
                kept.push(tick);
            }
        }
        kept.push(last);
        kept
    }

    pub(super) fn draw(&self, canvas: &mut Canvas<'_>) {
        canvas.fill(self.panel(), PANEL, PANEL_OPACITY);
        for (left, top, content) in self.placed() {
            match content {
                Content::Entry(Some(swatch), _) => self.draw_swatch(canvas, left, top, *swatch),
                Content::Bar(colors) => self.draw_bar(canvas, left, top, colors),
                _ => {}
            }
        }
        for Text { area, text, style, ink } in self.texts() {
            canvas.text(area.x, area.y, text, style, ink);
        }
    }

    fn draw_swatch(&self, canvas: &mut Canvas<'_>, left: i32, top: i32, swatch: Swatch) {
        let height = self.plain.line_height();
        let width = self.text_indent() - self.plain.advance();
        let block = Area::new(left, top + height / 6, width, height - 2 * (height / 6));
        let stroke = (height / 7).max(1);
        match swatch {
            Swatch::Area(color) => canvas.fill(block, color, 1.0),
            Swatch::Line(color) => {
                canvas.fill(Area::new(left, top + (height - stroke) / 2, width, stroke), color, 1.0);
            }
            Swatch::Frame(color) => canvas.frame(block, stroke, color, 1.0),
        }
    }

    fn draw_bar(&self, canvas: &mut Canvas<'_>, left: i32, top: i32, colors: &[Rgb]) {
        let (width, height) = (self.bar_width(), self.plain.line_height());
        for (i, &color) in colors.iter().enumerate() {
            let edge = |i: usize| left + (i * width as usize / colors.len()) as i32;
            canvas.fill(Area::new(edge(i), top, edge(i + 1) - edge(i), height - height / 6), color, 1.0);
        }
    }
}
