//! The grid that is laid over what the light sees: what edges do to its cells, and the bound that follows.

use super::Poles;

/// What is known of the cells, column by column, each from below; as differences from one cell to the next.
#[derive(Debug)]
pub(super) struct Columns {
    pub(super) size: usize,
    /// How many columns before each are wanted; of others nothing is known.
    wanted_before: Vec<u32>,
    /// Of the winding number in the middle, and of the number of edges that touch.
    cells: Vec<[i32; 2]>,
}

impl Columns {
    /// For each column, whether it is wanted.
    pub(super) fn new(wanted: &[bool]) -> Self {
        let size = wanted.len();
        let mut wanted_before = vec![0];
        wanted_before.extend(wanted.iter().scan(0, |before, &is_wanted| {
            *before += u32::from(is_wanted);
            Some(*before)
        }));
        Self { size, wanted_before, cells: vec![[0; 2]; size * (size + 1)] }
    }

    /// Of the columns from the first to the last, both included.
    pub(super) fn is_any_wanted(&self, first: usize, last: usize) -> bool {
        self.wanted_before[first] < self.wanted_before[last + 1]
    }

    /// Adds to the winding number of the cells from a row upwards.
    pub(super) fn step(&mut self, column: usize, from_row: usize, by: i32) {
        self.cells[column * (self.size + 1) + from_row][0] += by;
    }

    /// Counts one more edge that touches the cells from row to row, both included.
    pub(super) fn touch(&mut self, column: usize, from_row: usize, to_row: usize) {
        let first = column * (self.size + 1);
        self.cells[first + from_row][1] += 1;
        self.cells[first + to_row + 1][1] -= 1;
    }

    /// A bound for each column that is wanted.
    pub(super) fn most(&self, poles: Poles) -> impl Iterator<Item = Option<i64>> + '_ {
        self.cells.chunks_exact(self.size + 1).enumerate().map(move |(number, column)| {
            if !self.is_any_wanted(number, number) {
                return None;
            }
            // The last one is beyond the grid.
            let (mut bound, mut most) = (poles.below, 0);
            for &[winding, touching] in &column[..self.size] {
                bound += i64::from(winding + touching);
                most = most.max(bound);
            }
            Some(most + poles.unsure)
        })
    }
}
