//! How much a glTF file may make of itself.
//!
//! Any number of meshes may name the same accessor, and an accessor without a buffer is as many zeros as it says. So
//! what is read from accessors is charged against the size of the file, before it is read.

use std::cell::Cell;

/// Numbers that may be read for each byte of the file. Real files stay far below: one that shows 98 spheres in 98
/// materials with the same accessors reads 16.
const NUMBERS_PER_BYTE: usize = 64;

/// On top, so that small files may share freely; a megabyte as `f32`.
const FREE_NUMBERS: usize = 1 << 18;

/// What may still be read.
#[derive(Debug)]
pub(super) struct Budget(Cell<usize>);

impl Budget {
    /// That of a file of `file_bytes`, its external buffers included.
    pub(super) fn new(file_bytes: usize) -> Self {
        Self(Cell::new(file_bytes.saturating_mul(NUMBERS_PER_BYTE).saturating_add(FREE_NUMBERS)))
    }

    /// Charges for `count` elements of `width` numbers each.
    pub(super) fn charge(&self, count: usize, width: usize) -> Result<(), String> {
        let left = count.checked_mul(width).and_then(|numbers| self.0.get().checked_sub(numbers));
        self.0.set(left.ok_or_else(|| {
            format!(
                "its {count} elements bring what the file reads to more than {NUMBERS_PER_BYTE} numbers for each of its \
                 bytes; its counts are wrong, or it repeats itself too often"
            )
        })?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_may_be_a_multiple_of_the_file_but_not_anything() {
        let budget = Budget::new(1_000_000);
        assert!(budget.charge(10_000_000, 3).is_ok());
        assert!(budget.charge(10_000_000, 3).is_ok());
        assert!(budget.charge(10_000_000, 3).is_err());
        assert!(budget.charge(1, 1).is_ok(), "a refused charge costs nothing");
        assert!(budget.charge(usize::MAX, 16).is_err());
    }
}
