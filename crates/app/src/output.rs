//! Files that are written whole or not at all, and standard output.

use std::fs::{self, Metadata, OpenOptions, Permissions};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow, ensure};
use tempfile::NamedTempFile;

/// A file to be written, made sure of before any work. Nothing is there until [`Staged::publish`].
#[derive(Debug)]
pub struct Output {
    /// As given, for messages.
    path: PathBuf,
    /// Without symbolic links, so that a link stays one and two names for a file are found out.
    target: PathBuf,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    /// Permissions of the file that is there, if one is.
    File(Option<Permissions>),
    /// A device or a pipe, which can't be replaced, only written to.
    Stream,
}

/// A file that is written whole under a name of its own and only waits for its final one.
///
/// Dropped unpublished, it leaves nothing behind.
#[derive(Debug)]
pub struct Staged {
    path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    File(NamedTempFile, PathBuf),
    Stream(Vec<u8>),
}

impl Output {
    /// Makes sure now, before long work, that `path` can be written.
    ///
    /// # Errors
    ///
    /// When `path` is a folder or write-protected, or its folder is missing or can't be written.
    pub fn create(path: &Path) -> anyhow::Result<Self> {
        Self::of_path(path).with_context(|| format!("can't write `{}`", path.display()))
    }

    /// As [`Output::create`], for a picture.
    ///
    /// # Errors
    ///
    /// Also when the name of an ordinary file does not end in `.png`, which is all that we write.
    pub fn create_png(path: &Path) -> anyhow::Result<Self> {
        let output = Self::create(path)?;
        let is_png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        let is_good = is_png || output.is_stream();
        ensure!(is_good, "can't write `{}`: pictures are PNG files; give a name that ends in .png", path.display());
        Ok(output)
    }

    fn of_path(path: &Path) -> anyhow::Result<Self> {
        const FOLDER: &str = "it is a folder; give a file name in it";
        let name = path.file_name().ok_or_else(|| anyhow!(FOLDER))?;
        // The name of `folder/` is `folder` to the library, and a folder to whoever typed it.
        ensure!(!path.as_os_str().as_encoded_bytes().ends_with(std::path::MAIN_SEPARATOR_STR.as_bytes()), FOLDER);
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        ensure!(folder.is_dir(), "there is no folder `{}`", folder.display());
        let (target, kind) = match fs::metadata(path) {
            Ok(there) if there.is_dir() => return Err(anyhow!(FOLDER)),
            Ok(there) if !there.is_file() => {
                return Ok(Self { path: path.to_owned(), target: path.to_owned(), kind: Kind::Stream });
            }
            Ok(there) => (fs::canonicalize(path)?, Kind::File(Some(permissions_of(&there)?))),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                (fs::canonicalize(folder)?.join(name), Kind::File(None))
            }
            Err(error) => return Err(error.into()),
        };
        // A nameless file, so that nothing is left if the program is stopped during its work.
        tempfile::tempfile_in(folder_of(&target)).map_err(|error| unwritable(&error, folder))?;
        Ok(Self { path: path.to_owned(), target, kind })
    }

    /// Whether this is the file at `path`, by whatever name. Never for a device or a pipe.
    pub fn is_file_at(&self, path: &Path) -> bool {
        !self.is_stream() && fs::canonicalize(path).is_ok_and(|path| path == self.target)
    }

    /// Whether both would write the same file. Never for a device or a pipe.
    pub fn is_same_file_as(&self, other: &Self) -> bool {
        !self.is_stream() && self.target == other.target
    }

    /// Whether it is a device or a pipe.
    pub fn is_stream(&self) -> bool {
        matches!(self.kind, Kind::Stream)
    }

    /// As given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes `bytes` beside the final name.
    ///
    /// # Errors
    ///
    /// When the disk is full or the folder has gone; then nothing is left.
    pub fn stage(self, bytes: Vec<u8>) -> anyhow::Result<Staged> {
        let Self { path, target, kind } = self;
        let content = match kind {
            Kind::Stream => Content::Stream(bytes),
            Kind::File(permissions) => {
                let cant = || format!("can't write `{}`", path.display());
                Content::File(temporary_file(&target, permissions, &bytes).with_context(cant)?, target)
            }
        };
        Ok(Staged { path, content })
    }

    /// [`Output::stage`] and [`Staged::publish`].
    ///
    /// # Errors
    ///
    /// As theirs.
    pub fn finish(self, bytes: Vec<u8>) -> anyhow::Result<()> {
        self.stage(bytes)?.publish()
    }
}

impl Staged {
    /// Gives the file its name.
    ///
    /// # Errors
    ///
    /// When the name can't be given; then nothing is left.
    pub fn publish(self) -> anyhow::Result<()> {
        let written = match self.content {
            Content::File(file, target) => file.persist(target).map(|_| ()).map_err(|e| e.error),
            Content::Stream(bytes) => {
                OpenOptions::new().write(true).open(&self.path).and_then(|mut f| f.write_all(&bytes))
            }
        };
        written.with_context(|| format!("can't write `{}`", self.path.display()))
    }
}

fn permissions_of(there: &Metadata) -> anyhow::Result<Permissions> {
    let permissions = there.permissions();
    // Renaming would replace it all the same: the right to do so is the folder's.
    ensure!(!permissions.readonly(), "it is write-protected; allow writing it, or give another name");
    Ok(permissions)
}

fn unwritable(error: &io::Error, folder: &Path) -> anyhow::Error {
    match error.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            anyhow!("the folder `{}` is write-protected", folder.display())
        }
        _ => anyhow!("the folder `{}` can't be written: {error}", folder.display()),
    }
}

fn temporary_file(target: &Path, permissions: Option<Permissions>, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".umbrae-").suffix(".part");
    // A temporary file is private; a finished one is as the user's other files are.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder_of(target))?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.write_all(bytes)?;
    Ok(file)
}

/// The folder of a path that has one.
fn folder_of(target: &Path) -> &Path {
    target.parent().unwrap_or(Path::new("/"))
}

/// Writes `bytes` to standard output. A reader that has seen enough and left is no error.
///
/// # Errors
///
/// When standard output can't be written.
pub fn write_to_stdout(bytes: &[u8]) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("can't write to standard output"),
        _ => Ok(()),
    }
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
