//! Flat drawing on a finished picture: areas, frames, discs and text, clipped to the picture.

use super::text::TextStyle;

/// Red, green, blue as sRGB bytes.
pub(crate) type Rgb = [u8; 3];

/// Pixels from the top left corner: the first column and row, and how many of each. May reach beyond the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    pub(crate) x: i32,
    pub(crate) y: i32,
    pub(crate) width: i32,
    pub(crate) height: i32,
}

impl Area {
    pub(crate) fn new(x: i32, y: i32, width: i32, height: i32) -> Self {
        Self { x, y, width, height }
    }

    /// Whether all of it is in a picture of so many pixels across and down.
    pub(crate) fn is_within(self, [width, height]: [i32; 2]) -> bool {
        self.x >= 0 && self.y >= 0 && self.x + self.width <= width && self.y + self.height <= height
    }
}

/// A picture of sRGB bytes, four a pixel, row by row from the top.
#[derive(Debug)]
pub(crate) struct Canvas<'a> {
    rgba: &'a mut [u8],
    width: i32,
    height: i32,
}

impl<'a> Canvas<'a> {
    /// Over `rgba`, which has four bytes for each pixel of a picture of `size_px`.
    pub(crate) fn new(rgba: &'a mut [u8], size_px: [u32; 2]) -> Self {
        let [width, height] = size_px.map(|side| side as i32);
        Self { rgba, width, height }
    }

    pub(crate) fn width(&self) -> i32 {
        self.width
    }

    pub(crate) fn height(&self) -> i32 {
        self.height
    }

    /// Mixes `color` into the pixel at column `x`, row `y`, by `opacity` from 0 to 1; beyond the picture, nothing happens.
    pub(crate) fn mix(&mut self, x: i32, y: i32, color: Rgb, opacity: f32) {
        if !(0..self.width).contains(&x) || !(0..self.height).contains(&y) {
            return;
        }
        let at = 4 * (y as usize * self.width as usize + x as usize);
        for (old, new) in self.rgba[at..at + 3].iter_mut().zip(color) {
            let mixed = f32::from(*old) + (f32::from(new) - f32::from(*old)) * opacity;
            *old = mixed.round() as u8;
        }
    }

    /// The colour of a pixel that is in the picture.
    pub(crate) fn pixel(&self, x: i32, y: i32) -> Rgb {
        let at = 4 * (y as usize * self.width as usize + x as usize);
        [self.rgba[at], self.rgba[at + 1], self.rgba[at + 2]]
    }

    /// Mixes `color` into all of `area`.
    pub(crate) fn fill(&mut self, area: Area, color: Rgb, opacity: f32) {
        for y in area.y.max(0)..(area.y + area.height).min(self.height) {
            for x in area.x.max(0)..(area.x + area.width).min(self.width) {
                self.mix(x, y, color, opacity);
            }
        }
    }

    /// A frame of `thickness` pixels along the inside of `area`.
    pub(crate) fn frame(&mut self, area: Area, thickness: i32, color: Rgb, opacity: f32) {
        let thickness = thickness.min((area.width + 1) / 2).min((area.height + 1) / 2);
        let between = area.height - 2 * thickness;
        self.fill(Area { height: thickness, ..area }, color, opacity);
        self.fill(Area { y: area.y + area.height - thickness, height: thickness, ..area }, color, opacity);
        let left = Area::new(area.x, area.y + thickness, thickness, between);
        self.fill(left, color, opacity);
        self.fill(Area { x: area.x + area.width - thickness, ..left }, color, opacity);
    }

    /// A disc about `(x, y)`, in pixels from the picture's corner, with a smooth edge.
    pub(crate) fn disc(&mut self, [x, y]: [f32; 2], radius: f32, color: Rgb) {
        let reach = radius.ceil() as i32 + 1;
        let (middle_x, middle_y) = (x.floor() as i32, y.floor() as i32);
        for py in middle_y - reach..=middle_y + reach {
            for px in middle_x - reach..=middle_x + reach {
                let distance = (px as f32 + 0.5 - x).hypot(py as f32 + 0.5 - y);
                self.mix(px, py, color, (radius + 0.5 - distance).clamp(0.0, 1.0));
            }
        }
    }

    /// One line of text whose box begins at column `x`, row `y`; it is [`TextStyle::width`] wide.
    pub(crate) fn text(&mut self, x: i32, y: i32, text: &str, style: TextStyle, color: Rgb) {
        for (i, character) in text.chars().enumerate() {
            let left = x + i as i32 * style.advance();
            style.for_each_pixel(character, |dx, dy, opacity| self.mix(left + dx, y + dy, color, opacity));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_reaches_beyond_the_picture_is_cut_off() {
        let mut rgba = vec![0; 4 * 5 * 4];
        let mut canvas = Canvas::new(&mut rgba, [5, 4]);
        canvas.fill(Area::new(-3, 2, 100, 100), [10, 20, 30], 1.0);
        canvas.disc([-50.0, 2.0], 3.0, [255; 3]);
        canvas.frame(Area::new(-2, -2, 90, 90), 1, [255; 3], 1.0);
        assert_eq!(canvas.pixel(4, 1), [0; 3]);
        assert_eq!(canvas.pixel(4, 3), [10, 20, 30]);
    }

    #[test]
    fn opacity_is_how_much_of_the_new_colour_there_is() {
        let mut rgba = vec![100; 4];
        Canvas::new(&mut rgba, [1, 1]).fill(Area::new(0, 0, 1, 1), [200, 0, 100], 0.25);
        assert_eq!(rgba, [125, 75, 100, 100]);
    }

    #[test]
    fn a_frame_has_no_pixel_twice_and_leaves_its_middle() {
        let mut rgba = vec![0; 4 * 6 * 6];
        let mut canvas = Canvas::new(&mut rgba, [6, 6]);
        canvas.frame(Area::new(0, 0, 6, 5), 2, [200; 3], 0.5);
        let drawn: Vec<u8> = (0..36).map(|i| canvas.pixel(i % 6, i / 6)[0]).collect();
        assert_eq!(drawn.iter().filter(|&&value| value == 100).count(), 28);
        assert_eq!(drawn.iter().filter(|&&value| value == 0).count(), 8, "2 in the middle, 6 in the last row");
    }
}
