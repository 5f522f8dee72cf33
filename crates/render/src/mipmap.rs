//! A picture and its smaller copies, for textures.
//!
//! Made on the CPU: a device of the lowest tier may have no other way, and every device gets the same texels. Each copy is half as large, rounded
//! down, and each of its texels is the mean of the area that it covers, colours in linear light.

use umbrae_core::Texture;

/// The texels of one size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Level {
    pub(crate) size_px: [u32; 2],
    /// As [`Texture::rgba`].
    pub(crate) rgba: Vec<u8>,
}

/// The picture of `texture` and its copies down to one texel, without those that have more than `most_px` texels a side.
///
/// Takes a third more memory than the picture, and about 20 ns a texel.
pub(crate) fn levels(texture: &Texture, most_px: u32) -> Vec<Level> {
    let curves = Curves::new();
    let mut levels = vec![Level { size_px: texture.size_px, rgba: texture.rgba.clone() }];
    while let Some(last) = levels.last().filter(|last| last.size_px != [1, 1]) {
        levels.push(halved(last, &curves));
    }
    levels.retain(|level| level.size_px.iter().all(|&side| side <= most_px));
    levels
}

fn halved(level: &Level, curves: &Curves) -> Level {
    let size_px = level.size_px.map(|side| (side / 2).max(1));
    let [columns, rows] = [0, 1].map(|axis| shares(level.size_px[axis], size_px[axis]));
    let width = level.size_px[0] as usize;
    let mut rgba = Vec::with_capacity(size_px[0] as usize * size_px[1] as usize * 4);
    for row in &rows {
        for column in &columns {
            let mut sums = [0.0; 4];
            for (y, tall) in row.texels() {
                for (x, wide) in column.texels() {
                    let [red, green, blue, alpha] =
                        [0, 1, 2, 3].map(|channel| level.rgba[(y * width + x) * 4 + channel]);
                    let linear = [curves.linear(red), curves.linear(green), curves.linear(blue), f32::from(alpha)];
                    for (sum, value) in sums.iter_mut().zip(linear) {
                        *sum += value * tall * wide;
                    }
                }
            }
            let [red, green, blue, alpha] = sums;
            rgba.extend([curves.srgb(red), curves.srgb(green), curves.srgb(blue), alpha.round() as u8]);
        }
    }
    Level { size_px, rgba }
}

/// What a texel covers of a row or column of the larger picture: up to three texels, with their shares.
struct Share {
    first: usize,
    shares: [f32; 3],
}

impl Share {
    fn texels(&self) -> impl Iterator<Item = (usize, f32)> {
        (self.first..).zip(self.shares).filter(|(_, share)| *share > 0.0)
    }
}

fn shares(from: u32, to: u32) -> Vec<Share> {
    let per_texel = f64::from(from) / f64::from(to);
    let share = |i: u32| {
        let (start, end) = (f64::from(i) * per_texel, f64::from(i + 1) * per_texel);
        let first = start.floor();
        let covered = |j: usize| {
            let texel = first + j as f64;
            // What rounding leaves of the next texel is nothing.
            let covered = (end.min(texel + 1.0) - start.max(texel)) / per_texel;
            if covered > 1e-6 { covered as f32 } else { 0.0 }
        };
        Share { first: first as usize, shares: std::array::from_fn(covered) }
    };
    (0..to).map(share).collect()
}

/// sRGB to linear and back, by table.
struct Curves {
    linear: [f32; 256],
    srgb: Vec<u8>,
}

/// Fine enough for the steepest part of the curve, near black: a fifth of a step of the result.
const SRGB_STEPS: usize = 1 << 14;

impl Curves {
    fn new() -> Self {
        let linear = |i: usize| {
            let c = i as f32 / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        let srgb = |i: usize| crate::gpu_scene::srgb_byte(i as f32 / SRGB_STEPS as f32);
        Self { linear: std::array::from_fn(linear), srgb: (0..=SRGB_STEPS).map(srgb).collect() }
    }

    fn linear(&self, srgb: u8) -> f32 {
        self.linear[usize::from(srgb)]
    }

    fn srgb(&self, linear: f32) -> u8 {
        self.srgb[(linear.clamp(0.0, 1.0) * SRGB_STEPS as f32).round() as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(size_px: [u32; 2], texel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
        let rgba = (0..size_px[1]).flat_map(|y| (0..size_px[0]).map(move |x| (x, y)));
        let rgba = rgba.flat_map(|(x, y)| texel(x, y)).collect();
        Texture { name: String::new(), size_px, rgba, wrap: Default::default(), is_nearest: false }
    }

    #[test]
    fn copies_halve_down_to_one_texel_whatever_the_size() {
        let sizes =
            |size_px| levels(&texture(size_px, |_, _| [9; 4]), 8192).iter().map(|l| l.size_px).collect::<Vec<_>>();
        assert_eq!(sizes([8, 2]), [[8, 2], [4, 1], [2, 1], [1, 1]]);
        assert_eq!(sizes([5, 7]), [[5, 7], [2, 3], [1, 1]]);
        assert_eq!(sizes([1, 1]), [[1, 1]]);
    }

    #[test]
    fn every_copy_of_one_colour_has_that_colour() {
        for value in 0..=255 {
            let picture = texture([7, 3], |_, _| [value; 4]);
            assert!(levels(&picture, 8192).iter().all(|level| level.rgba.iter().all(|&byte| byte == value)), "{value}");
        }
    }

    #[test]
    fn black_and_white_mix_to_half_the_light_and_not_to_half_the_number() {
        let checks = texture([2, 2], |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0; 4] });
        assert_eq!(levels(&checks, 8192)[1].rgba, [188, 188, 188, 128], "alpha is linear as it is");
    }

    #[test]
    fn each_of_three_columns_has_its_third() {
        let bars = texture([3, 1], |x, _| [0, 0, 0, [30, 60, 120][x as usize]]);
        assert_eq!(levels(&bars, 8192)[1].rgba[3], 70);
    }

    #[test]
    fn what_the_device_can_not_hold_is_left_out() {
        let levels = levels(&texture([64, 16], |_, _| [9; 4]), 16);
        assert_eq!(levels[0].size_px, [16, 4]);
    }
}
