//! A handful of things without memory of their own.

use std::ops::Deref;

/// A vector of at most `N` things in place; more take memory, as they do in a [`Vec`].
///
/// What is asked for each caster and light in each frame needs a few planes and corners, and asking for memory would take longer than the
/// answer.
#[derive(Debug, Clone)]
pub(crate) struct Few<T, const N: usize> {
    in_place: [T; N],
    len: usize,
    /// All of them, once they are too many.
    all: Vec<T>,
}

impl<T: Copy + Default, const N: usize> Few<T, N> {
    pub(crate) fn push(&mut self, item: T) {
        if self.len < N && self.all.is_empty() {
            self.in_place[self.len] = item;
            self.len += 1;
            return;
        }
        if self.all.is_empty() {
            self.all.extend(self.in_place);
        }
        self.all.push(item);
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
        self.all.clear();
    }
}

impl<T: Copy + Default, const N: usize> Default for Few<T, N> {
    fn default() -> Self {
        Self { in_place: [T::default(); N], len: 0, all: Vec::new() }
    }
}

impl<T: Copy + Default, const N: usize> Extend<T> for Few<T, N> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
        items.into_iter().for_each(|item| self.push(item));
    }
}

impl<T, const N: usize> Deref for Few<T, N> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        if self.all.is_empty() { &self.in_place[..self.len] } else { &self.all }
    }
}

impl<T: PartialEq, const N: usize> PartialEq for Few<T, N> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_holds_what_was_pushed_in_order_few_or_many() {
        let mut few: Few<u32, 3> = Few::default();
        for count in [0, 1, 3, 4, 9, 2] {
            few.clear();
            few.extend(0..count);
            assert_eq!(*few, *(0..count).collect::<Vec<_>>());
            let mut same = Few::default();
            same.extend(0..count);
            assert_eq!(few, same);
        }
    }
}
