//! Lines, words and numbers of files that are text, read as bytes: names may be in any encoding.

/// The lines of a text, numbered from 1, without their ends (`\n` or `\r\n`).
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    rest: Option<&'a [u8]>,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(text: &'a [u8]) -> Self {
        Self { rest: Some(text), number: 0 }
    }

    /// The number of the last line that was read, 0 before the first.
    pub(crate) fn number(&self) -> usize {
        self.number
    }

    /// What has not been read yet.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest.unwrap_or_default()
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.rest?;
        let line = match rest.iter().position(|&byte| byte == b'\n') {
            Some(end) => {
                self.rest = Some(&rest[end + 1..]);
                &rest[..end]
            }
            None => {
                self.rest = None;
                rest
            }
        };
        self.number += 1;
        Some((self.number, line.strip_suffix(b"\r").unwrap_or(line)))
    }
}

/// The words of a line: what stands between spaces and tabs.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// The first word of a line, and what follows it without space around.
pub(crate) fn first_word(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii_start())
}

/// A decimal number, also `inf` or `nan`.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A decimal whole number. The usual case is worth a loop of its own: an OBJ file is half indices.
pub(crate) fn integer(word: &[u8]) -> Option<i64> {
    let (digits, is_negative) = match word {
        [b'-', digits @ ..] => (digits, true),
        [b'+', digits @ ..] | digits => (digits, false),
    };
    // Eighteen digits can't overflow.
    if digits.is_empty() || digits.len() > 18 || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let magnitude = digits.iter().fold(0, |value, digit| value * 10 + i64::from(digit - b'0'));
    Some(if is_negative { -magnitude } else { magnitude })
}

/// Text of unknown encoding, for names and messages.
pub(crate) fn lossy(text: &[u8]) -> String {
    String::from_utf8_lossy(text.trim_ascii()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_either_way_and_the_last_needs_no_end() {
        let lines: Vec<_> = Lines::new(b"a\r\n\nb").collect();
        assert_eq!(lines, [(1, &b"a"[..]), (2, b""), (3, b"b")]);
    }

    #[test]
    fn integers_are_whole_numbers_with_at_most_one_sign() {
        assert_eq!([&b"12"[..], b"-3", b"+4", b"0"].map(integer), [Some(12), Some(-3), Some(4), Some(0)]);
        for bad in ["", "-", "+-1", "1.0", "9999999999999999999", "1e3", "x"] {
            assert_eq!(integer(bad.as_bytes()), None, "{bad}");
        }
    }
}
