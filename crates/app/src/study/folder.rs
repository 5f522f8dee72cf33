//! A folder of results: all of them get their names at the end, or none does.

use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow, ensure};
use tempfile::NamedTempFile;

/// The folder that is asked for, made sure of before any work.
#[derive(Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    /// Files under names of their own, with the names that they will have.
    staged: Vec<(NamedTempFile, String)>,
    /// Held as long as this study writes.
    lock: Option<File>,
}

/// The file that a study at work has locked.
const LOCK: &str = ".umbrae-lock";
/// How the names of files begin and end that are not yet what they will be.
const PART: [&str; 2] = [".umbrae-", ".part"];

impl Folder {
    /// Makes sure that `path` is a folder that can be written, or can be made.
    ///
    /// # Errors
    ///
    /// When it is a file, or it or the folder that it is to be in can't be written.
    pub(super) fn make_sure(path: &Path) -> anyhow::Result<Self> {
        let cant = || format!("can't write to `{}`", path.display());
        let there = fs::metadata(path).ok();
        ensure!(
            there.as_ref().is_none_or(fs::Metadata::is_dir),
            "can't write to `{}`: it is a file; give a folder",
            path.display()
        );
        let nearest = if there.is_some() { path } else { nearest_folder(path).with_context(cant)? };
        tempfile::tempfile_in(nearest)
            .map_err(|error| anyhow!("the folder `{}` can't be written: {error}", nearest.display()))
            .with_context(cant)?;
        Ok(Self { path: path.to_owned(), staged: Vec::new(), lock: None })
    }

    /// Makes it, if it is not there, and makes sure that no other study writes to it; removes what a study that was killed has left half written.
    ///
    /// # Errors
    ///
    /// When it can't be made, or another study is at work in it.
    pub(super) fn create(&mut self) -> anyhow::Result<()> {
        fs::create_dir_all(&self.path).with_context(|| format!("can't make the folder `{}`", self.path.display()))?;
        let lock_path = self.path.join(LOCK);
        let lock = File::create(&lock_path).with_context(|| format!("can't write `{}`", lock_path.display()))?;
        // A system without locks has none to be in the way.
        let is_taken = matches!(lock.try_lock(), Err(fs::TryLockError::WouldBlock));
        ensure!(
            !is_taken,
            "another study is writing to `{}`; wait for it, or give another folder",
            self.path.display()
        );
        self.lock = Some(lock);
        for entry in fs::read_dir(&self.path).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if name.starts_with(PART[0]) && name.ends_with(PART[1]) {
                // If it can't be removed it is merely in the way of a tidy folder.
                let _ = fs::remove_file(entry.path());
            }
        }
        Ok(())
    }

    /// The names of the files that are staged, in order.
    pub(crate) fn names(&self) -> Vec<&str> {
        self.staged.iter().map(|(_, name)| name.as_str()).collect()
    }

    /// Writes a file that will be called `name`.
    ///
    /// # Errors
    ///
    /// When the disk is full or the folder has gone; then nothing is left.
    pub(crate) fn write(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let staged = || -> anyhow::Result<NamedTempFile> {
            let mut builder = tempfile::Builder::new();
            builder.prefix(PART[0]).suffix(PART[1]);
            // A temporary file is private; a finished one is as the user's other files are.
            #[cfg(unix)]
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            let file = builder.tempfile_in(&self.path)?;
            let mut writer = BufWriter::new(file.as_file().try_clone()?);
            write(&mut writer)?;
            writer.flush()?;
            Ok(file)
        };
        let staged = staged().with_context(|| format!("can't write `{}`", self.path.join(name).display()))?;
        self.staged.push((staged, name.to_owned()));
        Ok(())
    }

    /// What is in a file that is staged under `name`.
    ///
    /// # Errors
    ///
    /// When it can't be read, or there is none.
    pub(crate) fn read(&self, name: &str) -> anyhow::Result<Vec<u8>> {
        let staged = self.staged.iter().find(|(_, other)| other == name);
        let (file, _) = staged.with_context(|| format!("`{name}` was not written"))?;
        fs::read(file.path()).with_context(|| format!("can't read `{name}` again"))
    }

    /// Gives all files their names.
    ///
    /// # Errors
    ///
    /// When a name can't be given, as when there is a folder of that name.
    pub(super) fn publish(mut self) -> anyhow::Result<()> {
        for (file, name) in std::mem::take(&mut self.staged) {
            let target = self.path.join(name);
            file.persist(&target)
                .map_err(|e| e.error)
                .with_context(|| format!("can't write `{}`", target.display()))?;
        }
        Ok(())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if self.lock.take().is_some() {
            // Left behind it locks nobody out.
            let _ = fs::remove_file(self.path.join(LOCK));
        }
    }
}

/// The nearest folder above `path` that is there.
fn nearest_folder(path: &Path) -> anyhow::Result<&Path> {
    let mut above =
        path.ancestors().skip(1).map(|above| if above.as_os_str().is_empty() { Path::new(".") } else { above });
    let nearest = above.find(|above| above.exists()).context("there is no folder above it")?;
    ensure!(nearest.is_dir(), "`{}` is a file", nearest.display());
    Ok(nearest)
}
