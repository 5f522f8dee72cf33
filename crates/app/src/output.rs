//! Files that are written whole or not at all.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use tempfile::NamedTempFile;

/// A file to be written: a temporary one beside its final name until [`Output::finish`].
///
/// Dropped unfinished, it leaves nothing behind.
#[derive(Debug)]
pub struct Output {
    file: NamedTempFile,
    path: PathBuf,
}

impl Output {
    /// Makes sure now, before long work, that `path` can be written.
    ///
    /// # Errors
    ///
    /// When `path` is a folder, or its folder is missing or can't be written.
    pub fn create(path: &Path) -> anyhow::Result<Self> {
        let cant = || format!("can't write `{}`", path.display());
        if path.is_dir() {
            return Err(anyhow::anyhow!("it is a folder; give a file name in it")).with_context(cant);
        }
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        if path.file_name().is_none() {
            return Err(anyhow::anyhow!("it has no file name")).with_context(cant);
        }
        if !folder.is_dir() {
            return Err(anyhow::anyhow!("there is no folder `{}`", folder.display())).with_context(cant);
        }
        let file = tempfile::Builder::new()
            .prefix(".umbrae-")
            .suffix(".part")
            .permissions(readable_by_all())
            .tempfile_in(folder)
            .or_else(|_| tempfile::Builder::new().prefix(".umbrae-").suffix(".part").tempfile_in(folder))
            .with_context(cant)?;
        Ok(Self { file, path: path.to_owned() })
    }

    /// Writes `bytes` and gives the file its name.
    ///
    /// # Errors
    ///
    /// When the disk is full or the name can't be given; then nothing is left.
    pub fn finish(self, bytes: &[u8]) -> anyhow::Result<()> {
        let Self { mut file, path } = self;
        let cant = || format!("can't write `{}`", path.display());
        file.write_all(bytes).with_context(cant)?;
        file.persist(&path).map_err(|e| e.error).with_context(cant)?;
        Ok(())
    }
}

/// A temporary file is private; a finished one is as the user's other files are.
#[cfg(unix)]
fn readable_by_all() -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt as _;
    std::fs::Permissions::from_mode(0o666)
}

#[cfg(not(unix))]
fn readable_by_all() -> std::fs::Permissions {
    std::fs::metadata(".").expect("the current folder exists").permissions()
}

/// The bytes of a PNG of `size_px` pixels; `color` says what `pixels` are.
///
/// # Errors
///
/// Never for pixels of the right length; the encoder's own words otherwise.
pub fn png(pixels: &[u8], size_px: [u32; 2], color: image::ExtendedColorType) -> anyhow::Result<Vec<u8>> {
    use image::ImageEncoder as _;
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes).write_image(pixels, size_px[0], size_px[1], color)?;
    Ok(bytes)
}
