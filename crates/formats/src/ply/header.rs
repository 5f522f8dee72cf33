//! The header of a PLY file: what its elements are and how they are written.

use crate::error::{Problem, quoted};
use crate::text::{Lines, first_word, lossy, words};

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

/// How values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A table of `count` rows.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// A column of such a table.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Type),
    /// A count of the first type, then that many items of the second.
    List(Type, Type),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn of_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in the binary encodings.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Element {
    /// The fewest bytes that a row can take.
    pub(super) fn least_row_bytes(&self, encoding: Encoding) -> usize {
        let least = |property: &Property| match (encoding, property.kind) {
            // A digit and what separates it from the next.
            (Encoding::Ascii, _) => 2,
            (_, Kind::Scalar(kind) | Kind::List(kind, _)) => kind.size(),
        };
        self.properties.iter().map(least).sum()
    }

    /// The number of the property with one of these names.
    pub(super) fn column(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| names.contains(&property.name.as_str()))
    }
}

impl Header {
    /// Reads the header; `lines` then stands at the first byte after it.
    pub(super) fn read(lines: &mut Lines<'_>) -> Result<Self, Problem> {
        match lines.next() {
            Some((_, magic)) if magic.trim_ascii_end() == b"ply" => {}
            Some((_, other)) => {
                let start = quoted(&lossy(&other[..other.len().min(16)]));
                return Err(Problem::at_line(1, format!("a PLY file begins with a line \"ply\", not {start}")));
            }
            None => return Err(Problem::whole("the file is empty")),
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut last_line = 1;
        for (number, line) in lines.by_ref() {
            last_line = number;
            let bad =
                |expected: &str| Err(Problem::at_line(number, format!("{} is not {expected}", quoted(&lossy(line)))));
            let (keyword, rest) = first_word(line);
            match keyword {
                b"" | b"comment" | b"obj_info" => {}
                b"format" => {
                    encoding = Some(match words(rest).next() {
                        Some(b"ascii") => Encoding::Ascii,
                        Some(b"binary_little_endian") => Encoding::LittleEndian,
                        Some(b"binary_big_endian") => Encoding::BigEndian,
                        _ => return bad("a format: ascii, binary_little_endian or binary_big_endian"),
                    });
                }
                b"element" => {
                    let (name, count) = first_word(rest);
                    let Some(count) = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok()) else {
                        return bad("an element with a name and a count");
                    };
                    elements.push(Element { name: lossy(name), count, properties: Vec::new() });
                }
                b"property" => match (elements.last_mut(), property(rest)) {
                    (Some(element), Some(property)) => element.properties.push(property),
                    (None, Some(_)) => return bad("under an element"),
                    (_, None) => return bad("a property with a type we know and a name"),
                },
                b"end_header" => {
                    let encoding = encoding.ok_or_else(|| Problem::at_line(number, "the header has no format line"))?;
                    return Ok(Self { encoding, elements });
                }
                _ => return bad("a line of a PLY header"),
            }
        }
        Err(Problem::at_line(last_line, "the file ends in its header, without a line \"end_header\""))
    }
}

/// `TYPE NAME` or `list TYPE TYPE NAME`.
fn property(text: &[u8]) -> Option<Property> {
    let mut words = words(text);
    let first = words.next()?;
    let kind = if first == b"list" {
        Kind::List(Type::of_name(words.next()?)?, Type::of_name(words.next()?)?)
    } else {
        Kind::Scalar(Type::of_name(first)?)
    };
    Some(Property { name: lossy(words.next()?), kind })
}
