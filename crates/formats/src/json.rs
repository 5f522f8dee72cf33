//! JSON that may be anything.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

use crate::error::{Problem, cut_short};

/// `text` without the mark that some programs put before UTF-8.
pub(crate) fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

/// The library's own words, which may quote the file at length; the place is said apart.
pub(crate) fn json_problem(error: &serde_json::Error) -> Problem {
    let text = error.to_string();
    let what = text.split(" at line ").next().unwrap_or(&text);
    let message = format!("its JSON can't be read at column {}: {}", error.column(), cut_short(what, 200));
    Problem::at_line(error.line(), message)
}

/// What the `type` of the JSON in `text` says, of the first if there are several.
pub(crate) fn kind_of(text: &[u8]) -> Option<String> {
    #[derive(serde::Deserialize)]
    struct Kind {
        #[serde(rename = "type")]
        kind: String,
    }
    // What is wrong is for the reader to say.
    let first = serde_json::Deserializer::from_slice(without_mark(text)).into_iter::<Kind>().next()?;
    first.ok().map(|first| first.kind)
}

/// Lists in lists, of numbers: coordinates and indices, nested as deep as the kind of geometry wants.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) enum Nested {
    #[default]
    Null,
    Number(f64),
    List(Vec<Nested>),
}

impl Nested {
    /// What is in the list, if it is one.
    pub(crate) fn list(&self) -> Option<&[Self]> {
        match self {
            Self::List(items) => Some(items),
            _ => None,
        }
    }

    /// The number, if it is one.
    pub(crate) fn number(&self) -> Option<f64> {
        match *self {
            Self::Number(number) => Some(number),
            _ => None,
        }
    }

    /// The whole number that is 0 or more, if it is one.
    pub(crate) fn index(&self) -> Option<usize> {
        // Beyond, not every whole number is an f64, nor is there a list so long.
        self.number().filter(|n| n.fract() == 0.0 && (0.0..=9e15).contains(n)).map(|n| n as usize)
    }
}

/// At most this much of a value is in a message.
const SHOWN_CHARS: usize = 40;

/// As in JSON, cut short.
impl fmt::Display for Nested {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fn write(nested: &Nested, text: &mut String) {
            match nested {
                _ if text.len() > SHOWN_CHARS => {}
                Nested::Null => text.push_str("null"),
                Nested::Number(number) => text.push_str(&number.to_string()),
                Nested::List(items) => {
                    text.push('[');
                    for (i, item) in items.iter().take(SHOWN_CHARS).enumerate() {
                        text.push_str(if i > 0 { "," } else { "" });
                        write(item, text);
                    }
                    text.push(']');
                }
            }
        }
        let mut text = String::new();
        write(self, &mut text);
        f.write_str(&cut_short(&text, SHOWN_CHARS))
    }
}

impl<'de> Deserialize<'de> for Nested {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NestedVisitor;

        impl<'de> Visitor<'de> for NestedVisitor {
            type Value = Nested;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a list of lists of numbers")
            }

            fn visit_unit<E: Error>(self) -> Result<Nested, E> {
                Ok(Nested::Null)
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Nested, E> {
                Ok(Nested::Number(number as f64))
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<Nested, E> {
                Ok(Nested::Number(number as f64))
            }

            fn visit_f64<E: Error>(self, number: f64) -> Result<Nested, E> {
                Ok(Nested::Number(number))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Nested, A::Error> {
                let mut items = Vec::new();
                while let Some(item) = seq.next_element()? {
                    items.push(item);
                }
                items.shrink_to_fit();
                Ok(Nested::List(items))
            }
        }

        deserializer.deserialize_any(NestedVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_any_depth_are_read_and_shown() {
        let nested: Nested = serde_json::from_str("[[0, 1.5, null], [], -2]").expect("good JSON");
        assert_eq!(nested.to_string(), "[[0,1.5,null],[],-2]");
        let items = nested.list().expect("a list");
        assert_eq!(
            items[0].list().map(|items| items.iter().map(Nested::index).collect()),
            Some(vec![Some(0), None, None])
        );
        assert_eq!((items[2].number(), items[2].index(), items[1].list()), (Some(-2.0), None, Some(&[][..])));
        assert!(Nested::List(vec![nested; 1000]).to_string().chars().count() <= SHOWN_CHARS + 1);
    }

    #[test]
    fn text_and_objects_are_no_numbers_and_depth_has_an_end() {
        for bad in ["\"1\"", "[{}]", "[true]"] {
            let error = serde_json::from_str::<Nested>(bad).expect_err(bad);
            assert!(error.to_string().contains("expected a number, or a list"), "{error}");
        }
        assert!(serde_json::from_str::<Nested>(&"[".repeat(100_000)).is_err());
    }
}
