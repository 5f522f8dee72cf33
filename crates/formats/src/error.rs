//! Why a file can't be loaded, and where in it the reason is.

use std::borrow::Cow;
use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::Format;

/// Why a file can't be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// There is nothing at the path.
    #[error("there is no file {}", path.display())]
    NotFound {
        /// As it was given.
        path: PathBuf,
    },
    /// The path is not that of an ordinary file.
    #[error("{} is not a file; name a model file", path.display())]
    NotAFile {
        /// As it was given.
        path: PathBuf,
    },
    /// The operating system can't read the file.
    #[error("can't read {}", path.display())]
    Read {
        /// As it was given.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The name's ending belongs to no format that we read.
    #[error("{}: can't tell the format from the name; its ending must be one of {}", path.display(), Format::ENDINGS)]
    UnknownFormat {
        /// As it was given.
        path: PathBuf,
    },
    /// The name's ending is that of `CityGML`.
    #[error("{}: CityGML can't be read; convert it to CityJSON, as with citygml-tools to-cityjson", path.display())]
    CityGml {
        /// As it was given.
        path: PathBuf,
    },
    /// The content can't be used.
    #[error("{file}: {problem}")]
    Content {
        /// The name that [`crate::load_bytes`] was given, or the path.
        file: String,
        /// What is wrong, and where.
        problem: Problem,
    },
}

/// What is wrong with the content of a file, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Where.
    pub place: Place,
    /// What is wrong there: the offending value, and the way out if we know one.
    pub message: String,
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// No place in particular.
    File,
    /// A line, from 1.
    Line(usize),
    /// An offset in bytes, from 0.
    Byte(usize),
    /// A numbered part, such as a mesh or a node, from 0.
    Part {
        /// What it is.
        what: &'static str,
        /// Its number.
        index: usize,
        /// Its name, if it has one.
        name: Option<String>,
    },
}

impl Problem {
    pub(crate) fn whole(message: impl Into<String>) -> Self {
        Self { place: Place::File, message: message.into() }
    }

    pub(crate) fn at_line(line: usize, message: impl Into<String>) -> Self {
        Self { place: Place::Line(line), message: message.into() }
    }

    pub(crate) fn at_byte(byte: usize, message: impl Into<String>) -> Self {
        Self { place: Place::Byte(byte), message: message.into() }
    }

    pub(crate) fn in_part(what: &'static str, index: usize, name: Option<&str>, message: impl Into<String>) -> Self {
        Self { place: Place::Part { what, index, name: name.map(str::to_owned) }, message: message.into() }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::File => {}
            Place::Line(line) => write!(f, "line {line}: ")?,
            Place::Byte(byte) => write!(f, "byte {byte}: ")?,
            Place::Part { what, index, name: None } => write!(f, "{what} {index}: ")?,
            Place::Part { what, index, name: Some(name) } => write!(f, "{what} {index} {}: ", quoted(name))?,
        }
        f.write_str(&self.message)
    }
}

/// As much of a file's own text as belongs in a message.
const QUOTE_CHARS: usize = 60;

/// `text` in quotation marks, on one line, cut short if it is long.
pub(crate) fn quoted(text: &str) -> String {
    format!("{:?}", cut_short(text, QUOTE_CHARS))
}

/// The beginning of `text`, and a mark if that is not all.
pub(crate) fn cut_short(text: &str, chars: usize) -> Cow<'_, str> {
    match text.char_indices().nth(chars) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_says_where_it_is_and_then_what_it_is() {
        assert_eq!(Problem::at_line(3, "no").to_string(), "line 3: no");
        assert_eq!(Problem::in_part("node", 3, Some("a\nb"), "no").to_string(), "node 3 \"a\\nb\": no");
        assert_eq!(Problem::whole("no").to_string(), "no");
    }

    #[test]
    fn long_text_is_cut_between_characters() {
        let quote = quoted(&"é".repeat(1000));
        assert_eq!(quote.chars().count(), QUOTE_CHARS + 3);
    }
}
