//! Finders of silhouettes that were prepared before, in a folder: what takes long on a large mesh is done once.
//!
//! A file's name follows from the positions and triangles that it was made of and from the way of finding; so a model that is changed, moved or posed otherwise has
//! files of its own, and no old one is ever taken for a new one. Files may be deleted at any time.

use std::fmt::Write as _;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use umbrae_core::{Caster, Finder, FinderKind};

use crate::output::Output;
use crate::talk::Talk;

/// A folder with finders.
#[derive(Debug, Clone)]
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// The cache in `folder`, which is made if it is not there.
    ///
    /// # Errors
    ///
    /// When there is no such folder and none can be made.
    pub fn new(folder: &Path) -> anyhow::Result<Self> {
        fs::create_dir_all(folder).with_context(|| format!("can't make the folder `{}`", folder.display()))?;
        Ok(Self { folder: folder.to_owned() })
    }

    /// The finder of `kind` for `caster`, as it was written, or made and written. Where what is there can't be used, or nothing can be written, that is said,
    /// and the finder is made all the same.
    pub fn finder(&self, caster: &Caster, kind: FinderKind, talk: &Talk) -> Finder {
        let path = self.path(caster, kind);
        match read(&path, caster, kind) {
            Ok(Some(finder)) => return finder,
            Ok(None) => {}
            Err(error) => {
                let text = format!("can't use `{}` of the cache: {error:#}; it is made anew", path.display());
                talk.warning(&text);
            }
        }
        let finder = Finder::new(caster, kind);
        if let Some(bytes) = finder.to_bytes(caster)
            && let Err(error) = Output::create(&path).and_then(|output| output.finish(bytes))
        {
            talk.warning(&format!("{error:#}"));
        }
        finder
    }

    fn path(&self, caster: &Caster, kind: FinderKind) -> PathBuf {
        let mut name = format!("{}-", kind.name());
        for byte in Finder::key(caster, kind) {
            // Writing to a string does not fail.
            let _ = write!(name, "{byte:02x}");
        }
        self.folder.join(name).with_extension("finder")
    }
}

/// `None` where there is no file.
fn read(path: &Path, caster: &Caster, kind: FinderKind) -> anyhow::Result<Option<Finder>> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(Finder::from_bytes(caster, kind, &bytes)?)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error.into()),
    }
}
