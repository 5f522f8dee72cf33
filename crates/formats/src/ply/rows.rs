//! The rows of a PLY file's elements, value by value, whatever their encoding.

use super::header::{Element, Encoding, Kind, Type};
use crate::error::{Problem, quoted};
use crate::text::{Lines, first_word, lossy, number};

/// What follows the header, read from front to back.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    encoding: Encoding,
    /// Ascii: the lines not yet begun. Else only their rest counts: the bytes not yet read.
    lines: Lines<'a>,
    /// What is left of the line (ascii) or of the file (binary).
    rest: &'a [u8],
    line: usize,
    /// Rows so far with more values than properties.
    overlong: usize,
    file_bytes: usize,
}

impl<'a> Rows<'a> {
    /// `lines` stands after the header of a file of `file_bytes`.
    pub(super) fn new(encoding: Encoding, lines: Lines<'a>, file_bytes: usize) -> Self {
        let rest = if encoding == Encoding::Ascii { &[] } else { lines.rest() };
        Self { encoding, rest, line: lines.number(), overlong: 0, lines, file_bytes }
    }

    /// Refuses an element of more rows than the bytes that are left can hold, before anyone believes its count.
    pub(super) fn check_count(&self, element: &Element) -> Result<(), Problem> {
        let left = self.bytes_left();
        // The last line may lack its end.
        let fitting = (left + 1).checked_div(element.least_row_bytes(self.encoding)).unwrap_or(usize::MAX);
        if element.count > fitting {
            return Err(self.problem(format!(
                "the header announces {} rows of {}, but only {left} bytes are left; the file was cut off or its header is wrong",
                element.count,
                quoted(&element.name),
            )));
        }
        Ok(())
    }

    /// Goes to the next row.
    pub(super) fn begin(&mut self, element: &Element, row: usize) -> Result<(), Problem> {
        if self.encoding != Encoding::Ascii {
            return Ok(());
        }
        self.overlong += usize::from(!self.rest.is_empty());
        for (number, line) in self.lines.by_ref() {
            self.line = number;
            self.rest = line.trim_ascii();
            if !self.rest.is_empty() {
                return Ok(());
            }
        }
        let Element { name, count, .. } = element;
        Err(self.problem(format!("the file ends after {row} of {count} rows of {}; it was cut off", quoted(name))))
    }

    pub(super) fn value(&mut self, kind: Type) -> Result<f64, Problem> {
        if self.encoding == Encoding::Ascii {
            return self.ascii_value();
        }
        Ok(match kind {
            Type::I8 => f64::from(i8::from_le_bytes(self.bytes()?)),
            Type::U8 => f64::from(u8::from_le_bytes(self.bytes()?)),
            Type::I16 => f64::from(i16::from_le_bytes(self.bytes()?)),
            Type::U16 => f64::from(u16::from_le_bytes(self.bytes()?)),
            Type::I32 => f64::from(i32::from_le_bytes(self.bytes()?)),
            Type::U32 => f64::from(u32::from_le_bytes(self.bytes()?)),
            Type::F32 => f64::from(f32::from_le_bytes(self.bytes()?)),
            Type::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    /// Fills `items` with the items of a list.
    pub(super) fn list(&mut self, count: Type, item: Type, items: &mut Vec<f64>) -> Result<(), Problem> {
        items.clear();
        let count = self.value(count)?;
        let least_bytes = if self.encoding == Encoding::Ascii { 1 } else { item.size() };
        if !(count >= 0.0 && count.fract() == 0.0 && count * least_bytes as f64 <= self.rest.len() as f64) {
            return Err(self.problem(format!("a list announces {count} items, but {} bytes are left", self.rest.len())));
        }
        for _ in 0..count as usize {
            items.push(self.value(item)?);
        }
        Ok(())
    }

    /// Reads past a whole element; gives the number of rows, without those of nothing.
    pub(super) fn skip(&mut self, element: &Element) -> Result<usize, Problem> {
        if element.properties.is_empty() {
            return Ok(0);
        }
        let mut items = Vec::new();
        for row in 0..element.count {
            self.begin(element, row)?;
            for property in &element.properties {
                match property.kind {
                    Kind::Scalar(kind) => self.value(kind).map(drop)?,
                    Kind::List(count, item) => self.list(count, item, &mut items)?,
                }
            }
        }
        Ok(element.count)
    }

    /// A problem with what was read last.
    pub(super) fn problem(&self, message: String) -> Problem {
        match self.encoding {
            Encoding::Ascii => Problem::at_line(self.line, message),
            _ => Problem::at_byte(self.file_bytes - self.rest.len(), message),
        }
    }

    /// Bytes after the current row.
    pub(super) fn bytes_left(&self) -> usize {
        match self.encoding {
            Encoding::Ascii => self.lines.rest().len(),
            _ => self.rest.len(),
        }
    }

    /// How many ascii rows had more values than properties.
    pub(super) fn overlong(&self) -> usize {
        self.overlong + usize::from(self.encoding == Encoding::Ascii && !self.rest.is_empty())
    }

    /// Whether nothing of meaning is left.
    pub(super) fn is_at_end(&self) -> bool {
        match self.encoding {
            Encoding::Ascii => self.lines.rest().trim_ascii().is_empty(),
            _ => self.rest.is_empty(),
        }
    }

    fn ascii_value(&mut self) -> Result<f64, Problem> {
        let (word, rest) = first_word(self.rest);
        if word.is_empty() {
            return Err(self.problem("the line ends before its last value".to_owned()));
        }
        self.rest = rest;
        number(word).ok_or_else(|| self.problem(format!("{} is not a number", quoted(&lossy(word)))))
    }

    /// The next bytes of a binary file, lowest first.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let Some((bytes, rest)) = self.rest.split_first_chunk() else {
            return Err(self.problem("the file ends in the middle of a row; it was cut off".to_owned()));
        };
        self.rest = rest;
        let mut bytes = *bytes;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}
