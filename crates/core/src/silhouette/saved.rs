//! A finder as bytes, and back, so that what takes long on a large mesh is done once.
//!
//! ```text
//!   magic, version    which program wrote it
//!   kind              of the finder
//!   key               of the caster's positions and triangles
//!   planes, edges, trees
//!   checksum          of all before
//! ```
//!
//! What follows from these in a moment is not kept. The checksum tells damage; and numbers that lead somewhere are looked at too, so that
//! bytes with a good checksum that nobody wrote (which takes intent) may give a wrong silhouette, but never a panic or an endless search.

use borsh::BorshDeserialize;

use crate::Caster;

use super::coherent::Incidence;
use super::cones::Cone;
use super::dual::Ends;
use super::edges::Edges;
use super::faces::Faces;
use super::finder::{Finder, FinderKind, Method};
use super::hierarchy::{Bound, Trees};
use super::plain::PlanesInRows;

const MAGIC: [u8; 14] = *b"umbrae finder\n";
/// Another one whenever other bytes are written, or others would be found out for the same caster.
const VERSION: u32 = 1;
const HASH_BYTES: usize = blake3::OUT_LEN;

/// Why bytes are no finder for a caster. It can be built anew in any case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SavedError {
    /// They were not written by [`Finder::to_bytes`].
    #[error("it holds no finder of silhouettes")]
    NoFinder,
    /// Another version of this crate wrote them.
    #[error("it is of version {found}, and this is version {VERSION}")]
    OtherVersion {
        /// The version that wrote them.
        found: u32,
    },
    /// They are of another kind, or for other positions or triangles.
    #[error("it was made for another mesh or another way of finding")]
    OtherCaster,
    /// Bytes are missing or wrong.
    #[error("it is damaged")]
    Damaged,
}

impl Finder {
    /// A name for what a finder of this `kind` for `caster` is made from: the same for the same positions and triangles, and another for any others.
    ///
    /// About a nanosecond for each byte of positions and triangles.
    pub fn key(caster: &Caster, kind: FinderKind) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&MAGIC).update(kind.name().as_bytes());
        hasher.update(&(caster.positions.len() as u64).to_le_bytes());
        // In the order of bytes that every processor can tell, a part at a time.
        let mut part = Vec::new();
        let mut update = |part: &mut Vec<u8>, words: [u32; 3], is_last: bool| {
            part.extend(words.into_iter().flat_map(u32::to_le_bytes));
            if part.len() >= PART || is_last {
                hasher.update(part);
                part.clear();
            }
        };
        for p in &caster.positions {
            update(&mut part, p.to_array().map(f32::to_bits), false);
        }
        for &triangle in caster.mesh.triangles() {
            update(&mut part, triangle, false);
        }
        update(&mut part, [0; 3], true);
        *hasher.finalize().as_bytes()
    }

    /// This finder of `caster` as bytes, for [`Finder::from_bytes`]. `None` where it has a number that bytes can't hold.
    ///
    /// A few bytes more than [`Finder::bytes`].
    pub fn to_bytes(&self, caster: &Caster) -> Option<Vec<u8>> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(Self::key(caster, self.kind()));
        let (faces, edges, method) = self.parts();
        borsh::to_writer(&mut bytes, &(faces, edges)).ok()?;
        match method {
            Method::Dual(trees) => borsh::to_writer(&mut bytes, trees).ok()?,
            Method::Cones(trees) => borsh::to_writer(&mut bytes, trees).ok()?,
            // These follow from faces and edges.
            Method::Plain(_) | Method::Scan | Method::Coherent(_) => {}
        }
        let checksum = blake3::hash(&bytes);
        bytes.extend(checksum.as_bytes());
        Some(bytes)
    }

    /// The finder of `kind` that was made for `caster` and written by [`Finder::to_bytes`]: it finds the same, bit for bit.
    ///
    /// Whatever the bytes are, this does not panic and takes no more memory than a few times their length, and neither does what is returned when it finds.
    ///
    /// # Errors
    ///
    /// [`SavedError`], whenever there is any doubt.
    pub fn from_bytes(caster: &Caster, kind: FinderKind, bytes: &[u8]) -> Result<Self, SavedError> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(SavedError::NoFinder)?;
        let (version, rest) = rest.split_first_chunk().ok_or(SavedError::Damaged)?;
        let found = u32::from_le_bytes(*version);
        if found != VERSION {
            return Err(SavedError::OtherVersion { found });
        }
        let (key, rest) = rest.split_first_chunk::<HASH_BYTES>().ok_or(SavedError::Damaged)?;
        let (content, checksum) = rest.split_last_chunk::<HASH_BYTES>().ok_or(SavedError::Damaged)?;
        if blake3::hash(&bytes[..bytes.len() - HASH_BYTES]) != *checksum {
            return Err(SavedError::Damaged);
        }
        if *key != Self::key(caster, kind) {
            return Err(SavedError::OtherCaster);
        }
        read(caster, kind, content).ok_or(SavedError::Damaged)
    }
}

/// Bytes that are hashed together.
const PART: usize = 1 << 16;

/// The finder whose parts are `content`, to the last byte.
fn read(caster: &Caster, kind: FinderKind, mut content: &[u8]) -> Option<Finder> {
    let (mut faces, edges) = <(Faces, Edges)>::deserialize(&mut content).ok()?;
    let has_pairs = !matches!(kind, FinderKind::Dual | FinderKind::Cones);
    if !faces.are_whole(caster) || !edges.are_whole(&faces, caster, has_pairs) {
        return None;
    }
    faces.place_as(caster);
    let method = match kind {
        FinderKind::Plain => Method::Plain(PlanesInRows::new(&faces)),
        FinderKind::Scan => Method::Scan,
        FinderKind::Dual => Method::Dual(trees::<Ends>(caster, &mut content)?),
        FinderKind::Cones => Method::Cones(trees::<Cone>(caster, &mut content)?),
        FinderKind::Coherent => Method::Coherent(Incidence::new(&faces, &edges)),
    };
    content.is_empty().then(|| Finder::of_parts(caster, faces, edges, method))
}

fn trees<B: Bound>(caster: &Caster, content: &mut &[u8]) -> Option<Trees<B>> {
    Trees::deserialize(content).ok().filter(|trees| trees.are_whole(caster.positions.len()))
}
