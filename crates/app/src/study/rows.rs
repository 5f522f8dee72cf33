//! A study's bits in a file: for each receiver a row, with one bit for each step.
//!
//! In a file, because a year of a city has more bits than a machine has memory. Rows are in the order of the receivers, whatever the order in which they
//! were found, so that whoever reads them goes through the file once.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};

use umbrae_study::{Exposure, Packets};

/// Bits in a word of an [`Exposure`], and steps that are turned at once.
const SIDE: usize = 64;

/// How rows lie in their file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RowShape {
    /// How many bits a row has.
    pub(crate) step_count: usize,
}

impl RowShape {
    /// Bytes of a row.
    pub(crate) fn stride(self) -> usize {
        self.step_count.div_ceil(8)
    }
}

/// Whether bit `step` of `row` is set; the first is the lowest of the first byte.
pub(crate) fn bit(row: &[u8], step: usize) -> bool {
    row[step / 8] >> (step % 8) & 1 == 1
}

/// The rows of all receivers of `exposure`: receiver and row, by receiver.
pub(crate) fn rows_of(exposure: &Exposure, packets: &Packets) -> Vec<(usize, Vec<u8>)> {
    let stride = RowShape { step_count: exposure.step_count }.stride();
    let mut rows = Vec::new();
    for (i, packet) in exposure.packets.clone().enumerate() {
        let words = &exposure.lit[i * exposure.step_count..][..exposure.step_count];
        let first = rows.len();
        rows.extend(packets.members(packet).iter().map(|&receiver| (receiver as usize, vec![0; stride])));
        for (k, steps) in words.chunks(SIDE).enumerate() {
            let mut square = [0; SIDE];
            square[..steps.len()].copy_from_slice(steps);
            transpose(&mut square);
            for (word, (_, row)) in square.iter().zip(&mut rows[first..]) {
                let bytes = word.to_le_bytes();
                let at = k * SIDE / 8;
                let end = stride.min(at + bytes.len());
                row[at..end].copy_from_slice(&bytes[..end - at]);
            }
        }
    }
    rows.sort_unstable_by_key(|&(receiver, _)| receiver);
    rows
}

/// Turns a square of bits over its diagonal: bit `j` of word `i` becomes bit `i` of word `j`.
///
/// Source: H. S. Warren, "Hacker's Delight", 2003, section 7-3.
fn transpose(square: &mut [u64; SIDE]) {
    let mut width = SIDE / 2;
    let mut mask = u64::MAX >> width;
    while width > 0 {
        for i in (0..SIDE).filter(|i| i & width == 0) {
            let swapped = (square[i] >> width ^ square[i + width]) & mask;
            square[i] ^= swapped << width;
            square[i + width] ^= swapped;
        }
        width /= 2;
        mask ^= mask << width;
    }
}

/// Writes `rows`, each of one length and in order of receivers, to their places in `file`.
///
/// # Errors
///
/// The system's, as that the disk is full.
pub(crate) fn write_rows<R: AsRef<[u8]>>(file: &mut File, rows: &[(usize, R)]) -> std::io::Result<()> {
    let mut i = 0;
    while i < rows.len() {
        // Neighbours in the file go there together.
        let run = rows[i..].iter().zip(rows[i].0..).take_while(|((receiver, _), next)| receiver == next).count();
        let bytes: Vec<u8> = rows[i..i + run].iter().flat_map(|(_, row)| row.as_ref()).copied().collect();
        file.seek(SeekFrom::Start((rows[i].0 * rows[i].1.as_ref().len()) as u64))?;
        file.write_all(&bytes)?;
        i += run;
    }
    Ok(())
}

/// The row of one receiver; rows are `stride` bytes long.
///
/// # Errors
///
/// The system's.
pub(crate) fn read_row(mut file: &File, receiver: usize, stride: usize) -> std::io::Result<Vec<u8>> {
    let mut row = vec![0; stride];
    file.seek(SeekFrom::Start((receiver * stride) as u64))?;
    file.read_exact(&mut row)?;
    Ok(row)
}

/// Bytes that are read at once.
const CHUNK_BYTES: usize = 1 << 22;

/// Calls `visit` with the number and the row of each of `count` receivers, in order. Rows are `stride` bytes long.
///
/// # Errors
///
/// The system's, and the first of `visit`.
pub(crate) fn for_each_row(
    file: &File,
    count: usize,
    stride: usize,
    mut visit: impl FnMut(usize, &[u8]) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    if stride == 0 {
        return (0..count).try_for_each(|receiver| visit(receiver, &[]));
    }
    let mut file = file;
    file.seek(SeekFrom::Start(0))?;
    let rows_at_once = (CHUNK_BYTES / stride).max(1);
    let mut bytes = vec![0; rows_at_once * stride];
    for first in (0..count).step_by(rows_at_once) {
        let here = &mut bytes[..rows_at_once.min(count - first) * stride];
        file.read_exact(here)?;
        for (i, row) in here.chunks_exact(stride).enumerate() {
            visit(first + i, row)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_a_square_of_bits_swaps_its_indices() {
        // Odd enough that no symmetry hides a mistake.
        let before: [u64; SIDE] = std::array::from_fn(|i| (i as u64 + 3).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mut after = before;
        transpose(&mut after);
        for (i, word) in before.iter().enumerate() {
            for (j, turned) in after.iter().enumerate() {
                assert_eq!(word >> j & 1, turned >> i & 1, "{i} {j}");
            }
        }
    }

    #[test]
    fn rows_go_to_their_receivers_and_come_back_in_order() {
        let mut file = tempfile::tempfile().expect("a temporary file");
        file.set_len(3 * 7).expect("room");
        write_rows(&mut file, &[(0, [1, 2, 3]), (1, [4, 5, 6]), (6, [7, 8, 9])]).expect("written");
        write_rows(&mut file, &[(3, [1, 1, 1])]).expect("written");
        let mut read = Vec::new();
        let visit = |receiver: usize, row: &[u8]| {
            read.push((receiver, row.to_vec()));
            Ok(())
        };
        for_each_row(&file, 7, 3, visit).expect("read");
        let expected: [&[u8]; 7] = [&[1, 2, 3], &[4, 5, 6], &[0; 3], &[1; 3], &[0; 3], &[0; 3], &[7, 8, 9]];
        assert_eq!(read, expected.iter().map(|row| row.to_vec()).enumerate().collect::<Vec<_>>());
    }
}
