//! A study block by block, so that memory is bounded and what is finished is kept.
//!
//! ```text
//!    packets   |0 1 2 3|4 5 6 7|8 9 …|        a block at a time through the engine,
//!                  |                          its rows and sums into files at their receivers' places,
//!                  v                          and then, when they are safely there,
//!    DIR/.umbrae/  rows  sums  journal        a line into the journal; with the sun's disc also fractions
//! ```
//!
//! Rows and sums don't depend on the order of blocks nor on the number of threads, so a study that was killed and is resumed
//! ends with the same bytes as one that ran through.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use anyhow::{Context as _, ensure};
use glam::DVec3;
use sha2::{Digest as _, Sha256};
use umbrae_study::{Blockers, PACKET, Packets, PartialSun, Receivers, Refinement, Step};

use super::block::Block;
use super::inputs::hex;
use super::results::Disc;
use super::rows::{RowShape, for_each_row, read_row, write_rows};
use super::sums::{SUM_BYTES, Sum};

/// A block's words and its rows have this much memory together…
const BLOCK_BYTES: usize = 64 << 20;
/// …and there are so many blocks at the least, for a study may be stopped at any moment and keeps blocks that are finished.
const LEAST_BLOCKS: usize = 64;
/// Fewer packets are not worth a line in the journal.
const LEAST_PACKETS: usize = 16;

/// One state of the model, to be computed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Job<'a> {
    /// Which state: 0, and 1 where there are two.
    pub(super) state: usize,
    pub(super) blockers: &'a Blockers,
    pub(super) receivers: &'a Receivers,
    pub(super) packets: &'a Packets,
    pub(super) steps: &'a [Step],
    /// For each step the direction to the sun, scene space; `None` where it does not count.
    pub(super) suns: &'a [Option<DVec3>],
    /// With it hours are to the second; bits are still those of the steps.
    pub(super) refinement: Option<&'a Refinement>,
    /// With it hours are of the disc's visible share.
    pub(super) disc: Option<&'a Disc>,
}

/// What has come of a [`Job`].
#[derive(Debug)]
pub(crate) struct Computed {
    /// For each receiver; `None` inside of solids, and where the study was stopped before.
    pub(crate) sums: Vec<Option<Sum>>,
    /// For each receiver a row of bits; zeros where there is no sum.
    pub(crate) rows: File,
    /// For each receiver a row of shares of the disc, where the sun is one; zeros where there is no sum.
    pub(crate) fractions: Option<File>,
    /// Whether every packet was computed.
    pub(crate) is_whole: bool,
    /// What the engine took in this run.
    pub(crate) engine_s: f64,
}

/// The folder in which a study is kept while it is computed.
#[derive(Debug)]
pub(super) struct Workshop {
    folder: PathBuf,
    journal: File,
    /// The blocks that are finished, by state and first packet: what stands for their bytes.
    done: BTreeMap<(usize, usize), String>,
}

impl Workshop {
    /// Opens the folder for a study that `key` stands for in `output`, which is there; continues what is in it `if_there`.
    ///
    /// # Errors
    ///
    /// When it can't be written, or has another study that was to be resumed.
    pub(super) fn open(output: &Path, key: &str, if_there: bool) -> anyhow::Result<Self> {
        let folder = output.join(".umbrae");
        let key_file = folder.join("key");
        let cant = || format!("can't write to `{}`", folder.display());
        let is_resumed = if_there && key_file.is_file();
        if is_resumed {
            let old = fs::read_to_string(&key_file).with_context(|| format!("can't read `{}`", key_file.display()))?;
            ensure!(
                old == key,
                "can't resume the study in `{}`: models or options have changed since; run it without --resume to start anew",
                output.display()
            );
        } else {
            if folder.is_dir() {
                fs::remove_dir_all(&folder).with_context(cant)?;
            }
            fs::create_dir(&folder).with_context(cant)?;
            fs::write(&key_file, key).with_context(cant)?;
        }
        let journal_path = folder.join("journal");
        let text = if is_resumed { fs::read_to_string(&journal_path).unwrap_or_default() } else { String::new() };
        // The last line may be cut off: then its block is done again.
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let done = whole.lines().filter_map(|line| {
            let mut words = line.split(' ');
            let [state, packet, digest] = [words.next()?, words.next()?, words.next()?];
            Some(((state.parse().ok()?, packet.parse().ok()?), digest.to_owned()))
        });
        let done = done.collect();
        fs::write(&journal_path, whole).with_context(cant)?;
        let journal = OpenOptions::new().append(true).open(&journal_path).with_context(cant)?;
        Ok(Self { folder, journal, done })
    }

    /// Whether some of the study was there already.
    pub(super) fn has_finished_blocks(&self) -> bool {
        !self.done.is_empty()
    }

    /// Removes the folder: nothing is left to continue.
    pub(super) fn remove(self) -> anyhow::Result<()> {
        fs::remove_dir_all(&self.folder).with_context(|| format!("can't remove `{}`", self.folder.display()))
    }

    /// Computes what is not there yet of `job`, until `stop` is set. `packets_done` is called with how many packets more are finished, from
    /// any thread.
    ///
    /// # Errors
    ///
    /// When the folder can't be written.
    pub(super) fn compute(
        &mut self,
        job: Job<'_>,
        stop: &AtomicBool,
        packets_done: impl Fn(u64) + Sync,
    ) -> anyhow::Result<Computed> {
        let shape = RowShape { step_count: job.suns.len() };
        let mut rows = self.file("rows", job.state, job.receivers.len() * shape.stride())?;
        let mut sums = self.file("sums", job.state, job.receivers.len() * SUM_BYTES)?;
        let fractions = job.disc.map(|_| self.file("fractions", job.state, job.receivers.len() * shape.step_count));
        let mut fractions = fractions.transpose()?;
        let (mut engine_s, mut is_whole) = (0.0, true);
        let most_steps = job.refinement.map_or(shape, |fine| RowShape { step_count: fine.suns().len() });
        let block = block_packets(job.packets.len(), most_steps, job.disc.is_some());
        for first in (0..job.packets.len()).step_by(block) {
            let range = first..job.packets.len().min(first + block);
            let mut receivers: Vec<usize> =
                range.clone().flat_map(|packet| job.packets.members(packet)).map(|&r| r as usize).collect();
            receivers.sort_unstable();
            // What was damaged since is computed again.
            if let Some(digest) = self.done.get(&(job.state, first))
                && *digest == digest_of_files([&rows, &sums], fractions.as_ref(), &receivers, shape)?
            {
                packets_done(range.len() as u64);
                continue;
            }
            let Some(block) = Block::compute(&job, &range, stop, &mut engine_s) else {
                is_whole = false;
                break;
            };
            let digest = digest(block.rows.iter().zip(&block.sums).enumerate().map(|(i, ((_, row), (_, sum)))| {
                [&row[..], &sum[..], block.fractions.as_ref().map_or(&[], |fractions| &fractions[i].1)]
            }));
            let mut write = || -> std::io::Result<()> {
                write_rows(&mut rows, &block.rows)?;
                write_rows(&mut sums, &block.sums)?;
                if let (Some(file), Some(of_block)) = (&mut fractions, &block.fractions) {
                    write_rows(file, of_block)?;
                    file.sync_data()?;
                }
                rows.sync_data()?;
                sums.sync_data()?;
                writeln!(self.journal, "{} {first} {digest}", job.state)
            };
            let written = write();
            packets_done(range.len() as u64);
            written.with_context(|| format!("can't write to `{}`", self.folder.display()))?;
        }
        let mut all = Vec::with_capacity(job.receivers.len());
        for_each_row(&sums, job.receivers.len(), SUM_BYTES, |_, bytes| {
            all.push(Sum::from_bytes(bytes));
            Ok(())
        })?;
        Ok(Computed { sums: all, rows, fractions, is_whole, engine_s })
    }

    /// A file of so many bytes: zeros, where nothing was written yet.
    fn file(&self, name: &str, state: usize, bytes: usize) -> anyhow::Result<File> {
        let path = self.folder.join(format!("{name}-{state}"));
        let open = || -> std::io::Result<File> {
            let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path)?;
            file.set_len(bytes as u64)?;
            Ok(file)
        };
        open().with_context(|| format!("can't write `{}`", path.display()))
    }
}

/// Stands for the bytes of a block: a row, a sum and a row of shares (empty, if there is none) for each receiver, in their order.
fn digest<'a>(all: impl Iterator<Item = [&'a [u8]; 3]>) -> String {
    let mut hasher = Sha256::new();
    for bytes in all.flatten() {
        hasher.update(bytes);
    }
    hex(&hasher.finalize())
}

/// [`digest`] of what is in the files for `receivers`.
fn digest_of_files(
    [rows, sums]: [&File; 2],
    fractions: Option<&File>,
    receivers: &[usize],
    shape: RowShape,
) -> anyhow::Result<String> {
    let read = |&receiver: &usize| -> std::io::Result<[Vec<u8>; 3]> {
        let shares = fractions.map(|file| read_row(file, receiver, shape.step_count)).transpose()?;
        Ok([
            read_row(rows, receiver, shape.stride())?,
            read_row(sums, receiver, SUM_BYTES)?,
            shares.unwrap_or_default(),
        ])
    };
    let all: Vec<_> = receivers.iter().map(read).collect::<Result<_, _>>()?;
    Ok(digest(all.iter().map(|bytes| bytes.each_ref().map(Vec::as_slice))))
}

/// How many packets a block has; the same on every machine, as blocks are what is resumed.
fn block_packets(packet_count: usize, shape: RowShape, has_shares: bool) -> usize {
    // For each step of a packet eight bytes, and as much again as rows; as much for where all of a disc is seen, a byte for each receiver, and what it takes where
    // one in eight sees part.
    let step_bytes = if has_shares { 4 * 8 + PACKET + PACKET / 8 * size_of::<PartialSun>() } else { 2 * 8 };
    let in_memory = BLOCK_BYTES / (step_bytes * shape.step_count.max(1));
    let for_stopping = packet_count.div_ceil(LEAST_BLOCKS).max(LEAST_PACKETS);
    in_memory.min(for_stopping).max(1)
}
