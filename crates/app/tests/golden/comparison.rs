//! Two pictures, and how many of their pixels differ.

use anyhow::ensure;
use image::{GenericImage as _, Rgb, RgbImage};
use libtest_mimic::Trial;

/// What is different between two pictures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Comparison {
    /// Nothing can be said of pixels.
    Sizes { expected: (u32, u32), actual: (u32, u32) },
    /// In pictures of one size.
    Pixels {
        /// Pixels of which some channel differs by more than `channel`.
        count: usize,
        /// The tolerance, in levels of 255.
        channel: u8,
        /// The largest difference of any channel of any pixel.
        worst: u8,
    },
}

impl Comparison {
    /// Compares pixel by pixel; a channel may differ by `channel` levels of 255.
    pub(crate) fn new(expected: &RgbImage, actual: &RgbImage, channel: u8) -> Self {
        if expected.dimensions() != actual.dimensions() {
            return Self::Sizes { expected: expected.dimensions(), actual: actual.dimensions() };
        }
        let differences = || expected.pixels().zip(actual.pixels()).map(|(&e, &a)| difference(e, a));
        Self::Pixels {
            count: differences().filter(|&d| d > channel).count(),
            channel,
            worst: differences().max().unwrap_or(0),
        }
    }

    /// Whether at most `outliers` pixels differ.
    pub(crate) fn is_within(&self, outliers: usize) -> bool {
        matches!(self, Self::Pixels { count, .. } if *count <= outliers)
    }

    /// What is different, where `outliers` pixels are allowed.
    pub(crate) fn text(&self, outliers: usize) -> String {
        match self {
            Self::Sizes { expected, actual } => {
                format!("the picture is {}x{}, not {}x{}", actual.0, actual.1, expected.0, expected.1)
            }
            Self::Pixels { count, channel, worst } => {
                format!("{count} pixels differ by more than {channel} ({outliers} allowed), worst by {worst}")
            }
        }
    }
}

/// Of the channel that differs most.
fn difference(a: Rgb<u8>, b: Rgb<u8>) -> u8 {
    a.0.into_iter().zip(b.0).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0)
}

/// Expected, difference, actual, from left to right; the worst difference is white. Where the sizes differ, there is no difference.
pub(crate) fn side_by_side(expected: &RgbImage, actual: &RgbImage) -> RgbImage {
    let mut parts = vec![expected.clone(), actual.clone()];
    if expected.dimensions() == actual.dimensions() {
        let mut between = RgbImage::new(expected.width(), expected.height());
        let pairs = || expected.pixels().zip(actual.pixels());
        let worst = pairs().map(|(&e, &a)| difference(e, a)).max().unwrap_or(0).max(1);
        for (to, (&e, &a)) in between.pixels_mut().zip(pairs()) {
            *to = Rgb([(u16::from(difference(e, a)) * 255 / u16::from(worst)) as u8; 3]);
        }
        parts.insert(1, between);
    }
    let height = parts.iter().map(RgbImage::height).max().unwrap_or(0);
    let mut all = RgbImage::new(parts.iter().map(RgbImage::width).sum(), height);
    let mut x = 0;
    for part in &parts {
        all.copy_from(part, x, 0).expect("the sum of the widths and the largest height hold every part");
        x += part.width();
    }
    all
}

/// What a comparison must find, and what it must let pass.
pub(crate) fn trials() -> Vec<Trial> {
    let trial = |name: &str, check: fn() -> anyhow::Result<()>| {
        Trial::test(name, move || check().map_err(|error| error.to_string().into()))
    };
    vec![
        trial("equal_pictures_do_not_differ", || {
            let found = Comparison::new(&grey(100), &grey(100), 0);
            ensure!(found == Comparison::Pixels { count: 0, channel: 0, worst: 0 } && found.is_within(0), "{found:?}");
            Ok(())
        }),
        trial("one_changed_channel_of_one_pixel_is_found", || {
            for channel in 0..3 {
                let mut changed = grey(100);
                changed.get_pixel_mut(5, 3).0[channel] = 60;
                for found in [Comparison::new(&grey(100), &changed, 2), Comparison::new(&changed, &grey(100), 2)] {
                    ensure!(found == Comparison::Pixels { count: 1, channel: 2, worst: 40 }, "{found:?}");
                    ensure!(!found.is_within(0) && found.is_within(1), "{found:?}");
                }
            }
            Ok(())
        }),
        trial("a_difference_of_the_tolerance_passes_and_one_more_does_not", || {
            ensure!(Comparison::new(&grey(100), &grey(102), 2).is_within(0), "2 of 2 levels were found too much");
            let found = Comparison::new(&grey(100), &grey(103), 2);
            ensure!(found == Comparison::Pixels { count: 48, channel: 2, worst: 3 }, "{found:?}");
            Ok(())
        }),
        trial("a_picture_of_another_size_never_passes", || {
            let found = Comparison::new(&grey(100), &RgbImage::new(6, 8), 255);
            ensure!(!found.is_within(usize::MAX), "{found:?}");
            ensure!(found.text(0) == "the picture is 6x8, not 8x6", "{}", found.text(0));
            ensure!(side_by_side(&grey(100), &RgbImage::new(6, 8)).dimensions() == (14, 8), "parts are cut off");
            Ok(())
        }),
        trial("the_difference_stands_between_the_pictures", || {
            let mut changed = grey(100);
            changed.put_pixel(5, 3, Rgb([100, 90, 100]));
            let all = side_by_side(&grey(100), &changed);
            ensure!(all.dimensions() == (24, 6), "{:?}", all.dimensions());
            let at = |x: u32| all.get_pixel(x, 3).0;
            ensure!((at(5), at(13), at(21)) == ([100; 3], [255; 3], [100, 90, 100]), "{:?}", (at(5), at(13), at(21)));
            ensure!(at(12) == [0; 3], "{:?}", at(12));
            Ok(())
        }),
    ]
}

fn grey(level: u8) -> RgbImage {
    RgbImage::from_pixel(8, 6, Rgb([level; 3]))
}
