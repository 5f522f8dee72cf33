//! PNG and JPEG files into texels, within limits.
//!
//! A few kilobytes can announce gigabytes of picture. So each is charged before it is decoded, against an amount that all models have
//! free and that grows with what is read; and the decoders are told to allocate no more than the largest picture needs.

use std::collections::BTreeSet;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use umbrae_core::{Texture, Wrap};

use crate::warnings::Words;

/// What is said of a texture that can't be had.
pub(crate) const TEXTURE_SKIPPED: Words = ["base colour texture was left out", "base colour textures were left out"];

/// Texels a side; every desktop device can hold as much.
const MAX_SIDE: u32 = 8192;
/// Texels that any model may have: one picture of the largest size, 256 MiB.
const FREE_TEXELS: u64 = 1 << 26;
/// Texels on top for each byte that was read. A JPEG of an even surface has 20.
const TEXELS_PER_BYTE: u64 = 32;
/// More than this, 2 GiB, no model may have.
const MAX_TEXELS: u64 = 1 << 29;
/// While a picture is decoded, a texel takes up to 8 bytes as it is stored, and 4 as it is kept.
const MAX_BYTES_WHILE_DECODING: u64 = MAX_SIDE as u64 * MAX_SIDE as u64 * 12;

/// Decodes the pictures of one model, and keeps account.
#[derive(Debug)]
pub(crate) struct Pictures {
    texels_allowed: u64,
    texels_taken: u64,
    /// Files beside the model whose size has been added to what is allowed.
    files: BTreeSet<PathBuf>,
}

/// How a texture shows its picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(crate) struct Sampling {
    /// As [`Texture::wrap`].
    pub(crate) wrap: [Wrap; 2],
    /// As [`Texture::is_nearest`].
    pub(crate) is_nearest: bool,
}

impl Sampling {
    /// Different for different ways of sampling.
    pub(crate) fn key(self) -> [u8; 3] {
        [self.wrap[0] as u8, self.wrap[1] as u8, u8::from(self.is_nearest)]
    }
}

impl Pictures {
    /// For a model of `model_bytes`, with pictures embedded or not.
    pub(crate) fn new(model_bytes: usize) -> Self {
        let mut pictures = Self { texels_allowed: FREE_TEXELS, texels_taken: 0, files: BTreeSet::new() };
        pictures.allow(model_bytes);
        pictures
    }

    fn allow(&mut self, bytes: usize) {
        let more = TEXELS_PER_BYTE.saturating_mul(bytes as u64);
        self.texels_allowed = self.texels_allowed.saturating_add(more).min(MAX_TEXELS);
    }

    /// The picture in the file at `path`. What is wrong is said in words that fit after "texture: ".
    pub(crate) fn texture_of_file(&mut self, path: &Path, name: String, sampling: Sampling) -> Result<Texture, String> {
        // Anything but an ordinary file may have no end.
        if !path.is_file() {
            return Err("its file is missing".to_owned());
        }
        let bytes = fs::read(path).map_err(|error| format!("its file can't be read: {error}"))?;
        // Under whatever name it goes, a file counts once.
        if self.files.insert(path.canonicalize().unwrap_or_else(|_| path.to_owned())) {
            self.allow(bytes.len());
        }
        self.texture(&bytes, name, sampling)
    }

    /// The picture in `bytes`, which are part of the model. Errors as for [`Pictures::texture_of_file`].
    pub(crate) fn texture(&mut self, bytes: &[u8], name: String, sampling: Sampling) -> Result<Texture, String> {
        let format = match image::guess_format(bytes) {
            Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
            other => {
                let what = other.map_or("something else".to_owned(), |format| format!("{format:?}"));
                return Err(format!("its picture is {what}; only PNG and JPEG can be read, so convert it"));
            }
        };
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(MAX_BYTES_WHILE_DECODING);
        reader.limits(limits);
        let broken = |error: image::ImageError| format!("its picture can't be read: {error}");
        let decoder = reader.into_decoder().map_err(broken)?;
        let (width, height) = decoder.dimensions();
        if width.max(height) > MAX_SIDE {
            return Err(format!("its picture has {width}x{height} texels; scale it down to at most {MAX_SIDE} a side"));
        }
        if width.min(height) == 0 {
            return Err(format!("its picture has {width}x{height} texels"));
        }
        // What turns out to be broken is charged too, for the time it took.
        self.texels_taken += u64::from(width) * u64::from(height);
        if self.texels_taken > self.texels_allowed {
            self.texels_taken -= u64::from(width) * u64::from(height);
            let allowed = self.texels_allowed >> 20;
            return Err(format!(
                "with its {width}x{height} texels, the model's pictures would have more than {allowed} million texels; \
                 scale them down"
            ));
        }
        let rgba = DynamicImage::from_decoder(decoder).map_err(broken)?.into_rgba8().into_raw();
        Ok(Texture { name, size_px: [width, height], rgba, wrap: sampling.wrap, is_nearest: sampling.is_nearest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(width: u32, height: u32, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(width, height, |x, y| image::Rgb([x as u8, y as u8, 200]));
        picture.write_to(&mut bytes, format).expect("memory takes it");
        bytes.into_inner()
    }

    fn texture(bytes: &[u8]) -> Result<Texture, String> {
        Pictures::new(bytes.len()).texture(bytes, String::new(), Sampling::default())
    }

    #[test]
    fn a_picture_becomes_its_texels_row_by_row_from_the_top() {
        let png = texture(&encoded(3, 2, ImageFormat::Png)).expect("a good picture");
        assert_eq!((png.size_px, png.rgba.len()), ([3, 2], 24));
        assert_eq!(png.rgba[..8], [0, 0, 200, 255, 1, 0, 200, 255]);
        assert_eq!(png.rgba[12..16], [0, 1, 200, 255]);
        let jpeg = texture(&encoded(16, 8, ImageFormat::Jpeg)).expect("a good picture");
        assert_eq!(jpeg.size_px, [16, 8]);
        assert!(jpeg.rgba[2].abs_diff(200) < 8, "JPEG keeps colours nearly: {}", jpeg.rgba[2]);
    }

    #[test]
    fn a_picture_with_too_many_texels_is_refused_before_it_is_decoded() {
        let mut png = encoded(1, 1, ImageFormat::Png);
        // The width is in bytes 16 to 19; the checksum after the header is then wrong, so the reader may notice that first.
        png[16..20].copy_from_slice(&60_000_u32.to_be_bytes());
        assert!(texture(&png).is_err());
        let wide = encoded(MAX_SIDE + 1, 1, ImageFormat::Png);
        let error = texture(&wide).expect_err("a picture that is too wide");
        assert_eq!(error, "its picture has 8193x1 texels; scale it down to at most 8192 a side");
    }

    #[test]
    fn pictures_are_refused_once_there_are_too_many_texels_together() {
        let png = encoded(4096, 4096, ImageFormat::Png);
        let mut pictures = Pictures::new(0);
        for _ in 0..4 {
            assert!(pictures.texture(&png, String::new(), Sampling::default()).is_ok());
        }
        let error = pictures.texture(&png, String::new(), Sampling::default()).expect_err("the fifth");
        assert!(error.contains("more than 64 million texels; scale them down"), "{error}");
        let small = encoded(1, 1, ImageFormat::Png);
        assert!(pictures.texture(&small, String::new(), Sampling::default()).is_err(), "nothing is left");
        pictures.allow(1_000_000);
        assert!(pictures.texture(&small, String::new(), Sampling::default()).is_ok(), "a larger model may have more");
    }

    #[test]
    fn what_is_no_picture_says_what_it_is() {
        let error = texture(b"RIFF\x04\0\0\0WEBPVP8 ").expect_err("another format");
        assert_eq!(error, "its picture is WebP; only PNG and JPEG can be read, so convert it");
        assert!(texture(b"").expect_err("nothing").starts_with("its picture is something else"));
        let png = encoded(30, 20, ImageFormat::Png);
        for length in 8..png.len() / 2 {
            assert!(texture(&png[..length]).is_err(), "cut off after {length} bytes");
        }
    }
}
