//! Pictures on surfaces.

/// Four bytes a texel, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texture {
    /// As in the file; empty when it had none.
    pub name: String,
    /// Texels across and down, each at least 1.
    pub size_px: [u32; 2],
    /// sRGB red, green and blue; linear alpha.
    pub rgba: Vec<u8>,
    /// What is beyond the picture, across and down.
    pub wrap: [Wrap; 2],
    /// Shows texels as squares when seen from near, instead of blending them.
    pub is_nearest: bool,
}

/// What is beyond a picture's border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored.
    Mirror,
    /// Its border.
    Clamp,
}
