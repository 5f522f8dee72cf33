//! Where the bytes of a glTF file are: the chunks of a GLB, files beside it, data in its JSON.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use base64::Engine;
use base64::engine::general_purpose::GeneralPurpose;
use base64::engine::{DecodePaddingMode, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::document::{Buffer, Document};
use crate::error::{Problem, quoted};

/// The JSON of a `.gltf`, or the chunks of a `.glb`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Chunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

const HEADER_BYTES: usize = 12;

impl<'a> Chunks<'a> {
    pub(super) fn split(bytes: &'a [u8]) -> Result<Self, Problem> {
        if !bytes.starts_with(b"glTF") {
            return Ok(Self { json: bytes, binary: None });
        }
        let number = |at: usize| bytes.get(at..)?.first_chunk().map(|four| u32::from_le_bytes(*four) as usize);
        let (Some(version), Some(length)) = (number(4), number(8)) else {
            return Err(Problem::at_byte(4, format!("the file ends in its header, after {} bytes", bytes.len())));
        };
        if version != 2 {
            return Err(Problem::at_byte(4, format!("it is GLB version {version}; only 2 can be read, so convert it")));
        }
        if length > bytes.len() || length < HEADER_BYTES {
            let message =
                format!("the header announces {length} bytes, but there are {}; the file was cut off", bytes.len());
            return Err(Problem::at_byte(8, message));
        }
        let mut chunks = Self { json: &[], binary: None };
        let mut at = HEADER_BYTES;
        while let (Some(size), Some(kind)) = (number(at), bytes.get(at + 4..at + 8)) {
            let content = bytes[at + 8..].get(..size).ok_or_else(|| {
                let left = bytes.len() - at - 8;
                Problem::at_byte(
                    at,
                    format!("a chunk announces {size} bytes, but {left} are left; the file was cut off"),
                )
            })?;
            match kind {
                b"JSON" if at == HEADER_BYTES => chunks.json = content,
                _ if at == HEADER_BYTES => {
                    return Err(Problem::at_byte(at + 4, "the first chunk of a GLB must be its JSON"));
                }
                b"BIN\0" if chunks.binary.is_none() => chunks.binary = Some(content),
                // Chunks of other kinds are for others.
                _ => {}
            }
            at += 8 + size;
        }
        if at == HEADER_BYTES {
            return Err(Problem::at_byte(at, "the file ends before its JSON"));
        }
        Ok(chunks)
    }
}

/// The buffers of a file: one result for each, since one that nothing needs does no harm when it is missing.
#[derive(Debug)]
pub(super) struct Buffers<'a>(Vec<Result<Content<'a>, Problem>>);

#[derive(Debug, Clone)]
enum Content<'a> {
    Chunk(&'a [u8]),
    Inline(Cow<'a, [u8]>),
    /// Shared by all buffers that name the file.
    File(Rc<[u8]>),
}

/// What a file beside the model holds, or why that can't be had.
type FileContent = Result<Rc<[u8]>, String>;

impl<'a> Buffers<'a> {
    pub(super) fn load(document: &'a Document, binary: Option<&'a [u8]>, folder: Option<&Path>) -> Self {
        let mut files: BTreeMap<(&str, usize), FileContent> = BTreeMap::new();
        let content = |(index, buffer): (usize, &'a Buffer)| {
            let length = buffer.byte_length;
            let content = match &buffer.uri {
                // Only the first buffer can be the binary chunk.
                None if index == 0 => {
                    binary.map(Content::Chunk).ok_or_else(|| "it has neither a uri nor a binary chunk".to_owned())
                }
                None => Err("it has no uri".to_owned()),
                Some(uri) => match data_of_uri(uri) {
                    Some(data) => data.map(Content::Inline),
                    None => {
                        let file = files.entry((uri, length)).or_insert_with(|| read_file(uri, length, folder));
                        file.clone().map(Content::File)
                    }
                },
            };
            let content = content.and_then(|content| content.checked(length));
            content.map_err(|message| Problem::in_part("buffer", index, None, message))
        };
        Self(document.buffers.iter().enumerate().map(content).collect())
    }

    /// The bytes of all external files together.
    pub(super) fn external_bytes(&self) -> usize {
        self.0.iter().map(|content| if let Ok(Content::File(bytes)) = content { bytes.len() } else { 0 }).sum()
    }

    /// The content of one buffer.
    pub(super) fn get(&self, index: usize) -> Result<&[u8], String> {
        match self.0.get(index) {
            Some(Ok(Content::Chunk(bytes))) => Ok(bytes),
            Some(Ok(Content::Inline(bytes))) => Ok(bytes),
            Some(Ok(Content::File(bytes))) => Ok(bytes),
            Some(Err(problem)) => Err(problem.to_string()),
            None => Err(format!("there is no buffer {index}, only {}", self.0.len())),
        }
    }
}

impl Content<'_> {
    fn checked(self, announced: usize) -> Result<Self, String> {
        let length = match &self {
            Self::Chunk(bytes) => bytes.len(),
            Self::Inline(bytes) => bytes.len(),
            Self::File(bytes) => bytes.len(),
        };
        if length < announced { Err(cut_off(announced, length as u64)) } else { Ok(self) }
    }
}

fn cut_off(announced: usize, length: u64) -> String {
    format!("it announces {announced} bytes, but has {length}; it was cut off")
}

/// Not every writer pads, and not every one sets the unused bits to 0.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_allow_trailing_bits(true)
        .with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The bytes in a `data:` URI; `None` if it is another kind of URI.
pub(super) fn data_of_uri(uri: &str) -> Option<Result<Cow<'_, [u8]>, String>> {
    let data = uri.strip_prefix("data:")?;
    let Some((kind, data)) = data.split_once(',') else {
        return Some(Err("its data URI has no comma".to_owned()));
    };
    Some(if kind.ends_with(";base64") {
        BASE64.decode(data).map(Cow::Owned).map_err(|error| format!("its base64 data can't be read: {error}"))
    } else {
        Ok(percent_decode_str(data).into())
    })
}

/// Where the file is, if it is, that `uri` names.
pub(super) fn path_of_uri(uri: &str, folder: Option<&Path>) -> Result<PathBuf, String> {
    if uri.contains("://") {
        return Err(format!("it is at {}; download it and name the file in its place", quoted(uri)));
    }
    let name = percent_decode_str(uri).decode_utf8_lossy();
    let Some(folder) = folder else {
        return Err(format!("it is in the file {}, which can't be looked for", quoted(&name)));
    };
    Ok(folder.join(&*name))
}

/// The first `length` bytes of the file that `uri` names.
fn read_file(uri: &str, length: usize, folder: Option<&Path>) -> FileContent {
    let path = path_of_uri(uri, folder)?;
    let name = percent_decode_str(uri).decode_utf8_lossy();
    // Anything but an ordinary file may have no end.
    let size = match fs::metadata(&path) {
        Ok(metadata) if metadata.is_file() => metadata.len(),
        _ => return Err(format!("its file {} is missing; put it beside the model", quoted(&name))),
    };
    if size < length as u64 {
        return Err(cut_off(length, size));
    }
    let mut bytes = Vec::new();
    File::open(&path)
        .and_then(|file| file.take(length as u64).read_to_end(&mut bytes))
        .map_err(|error| format!("its file {} can't be read: {error}", quoted(&name)))?;
    Ok(bytes.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(version: u32, chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, content) in chunks {
            body.extend((content.len() as u32).to_le_bytes());
            body.extend(*kind);
            body.extend(*content);
        }
        let length = (HEADER_BYTES + body.len()) as u32;
        [b"glTF".as_slice(), &version.to_le_bytes(), &length.to_le_bytes(), &body].concat()
    }

    fn error(bytes: &[u8]) -> String {
        Chunks::split(bytes).expect_err("a bad container").to_string()
    }

    #[test]
    fn a_glb_has_json_and_perhaps_binary_data_and_other_chunks_are_passed_over() {
        let bytes = glb(2, &[(b"JSON", b"{}  "), (b"what", b"1234"), (b"BIN\0", b"abcd")]);
        assert_eq!(Chunks::split(&bytes), Ok(Chunks { json: b"{}  ", binary: Some(b"abcd") }));
        assert_eq!(Chunks::split(b"{}"), Ok(Chunks { json: b"{}", binary: None }));
    }

    #[test]
    fn a_damaged_glb_is_told_by_its_byte() {
        let good = glb(2, &[(b"JSON", b"{}  ")]);
        assert_eq!(error(&good[..6]), "byte 4: the file ends in its header, after 6 bytes");
        assert_eq!(
            error(&good[..good.len() - 1]),
            "byte 8: the header announces 24 bytes, but there are 23; the file was cut off"
        );
        assert_eq!(error(&glb(1, &[])), "byte 4: it is GLB version 1; only 2 can be read, so convert it");
        assert_eq!(error(&glb(2, &[])), "byte 12: the file ends before its JSON");
        assert_eq!(error(&glb(2, &[(b"BIN\0", b"")])), "byte 16: the first chunk of a GLB must be its JSON");
        let mut long = good;
        long[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(error(&long).starts_with("byte 12: a chunk announces 4294967295 bytes, but 4 are left"));
    }

    #[test]
    fn data_uris_are_base64_or_percent_encoded() {
        let data = |uri| data_of_uri(uri).map(|data| data.map(Cow::into_owned));
        for good in ["data:application/octet-stream;base64,AQL/", "data:;base64,AQL/", "data:,%01%02%FF"] {
            assert_eq!(data(good), Some(Ok(vec![1, 2, 255])), "{good}");
        }
        assert_eq!(data("data:;base64,AQI"), Some(Ok(vec![1, 2])), "padding may be missing");
        assert!(matches!(data("data:;base64,A*"), Some(Err(_))));
        assert!(matches!(data("data:;base64"), Some(Err(_))));
        assert_eq!(data("a.bin"), None);
    }
}
