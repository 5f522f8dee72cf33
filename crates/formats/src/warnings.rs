//! What was left out of a model, counted.

use std::fmt;

/// Something that was left out or changed, and how often.
///
/// Displayed as "3 line primitives were skipped".
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// What happened, as the words after the count.
    pub message: String,
    /// How often.
    pub count: usize,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.count, self.message)
    }
}

/// The words after a count of one and after any other count.
pub(crate) type Words = [&'static str; 2];

/// Collects warnings: one for each kind, in the order in which kinds first came up.
#[derive(Debug, Default)]
pub(crate) struct Warnings(Vec<Entry>);

#[derive(Debug)]
struct Entry {
    words: Words,
    count: usize,
    first: Option<String>,
}

impl Warnings {
    /// `count` more of this kind; nothing happens if it is 0.
    pub(crate) fn add(&mut self, count: usize, words: Words) {
        if count > 0 {
            self.entry(words).count += count;
        }
    }

    /// One more of this kind; `first` describes it, and is asked only the first time.
    pub(crate) fn add_one(&mut self, words: Words, first: impl FnOnce() -> String) {
        self.add_some(1, words, first);
    }

    /// `count` more of this kind, with a description as for [`Warnings::add_one`].
    pub(crate) fn add_some(&mut self, count: usize, words: Words, first: impl FnOnce() -> String) {
        if count > 0 {
            let entry = self.entry(words);
            entry.count += count;
            entry.first.get_or_insert_with(first);
        }
    }

    pub(crate) fn finish(self) -> Vec<Warning> {
        let warning = |Entry { words, count, first }: Entry| {
            let words = words[usize::from(count != 1)];
            let message = first.map_or_else(|| words.to_owned(), |first| format!("{words} (first: {first})"));
            Warning { message, count }
        };
        self.0.into_iter().map(warning).collect()
    }

    fn entry(&mut self, words: Words) -> &mut Entry {
        let index = self.0.iter().position(|entry| entry.words == words).unwrap_or_else(|| {
            self.0.push(Entry { words, count: 0, first: None });
            self.0.len() - 1
        });
        &mut self.0[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_of_a_kind_are_counted_and_the_first_is_described() {
        let mut warnings = Warnings::default();
        let words = ["cat was skipped", "cats were skipped"];
        for name in ["Tom", "Kit"] {
            warnings.add_one(words, || name.to_owned());
        }
        warnings.add(1, ["dog was skipped", "dogs were skipped"]);
        warnings.add(0, ["cow was skipped", "cows were skipped"]);
        let texts: Vec<String> = warnings.finish().iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["2 cats were skipped (first: Tom)", "1 dog was skipped"]);
    }
}
