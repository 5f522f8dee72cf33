//! The bound that needs no grid: how many edges a line across the plane meets, as it is swept over it.

use super::Poles;

/// While the line is swept, corners nearer to each other than this part of its way may come in either order.
const TOGETHER: f64 = 1e-6;

/// A line across the plane, swept over it from the left: where it meets more or fewer edges that have the inner side above (rises), or below (falls).
#[derive(Debug, Default)]
pub(super) struct Sweep(Vec<Step>);

/// Where on the line's way there is one edge more or less, and which, in one number: where it is, then what; so that sorting is quick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Step(u64);

/// One more, one less. What there is more of comes first.
const RISES: [u64; 2] = [0, 3];
const FALLS: [u64; 2] = [1, 2];

impl Step {
    /// Of the line's way, far finer than [`TOGETHER`].
    const UNITS: f64 = (1_u64 << 50) as f64;

    fn new(at: f64, kind: u64) -> Self {
        Self(((((at + 1.0) * Self::UNITS) as u64) << 2) | kind)
    }

    fn at(self) -> f64 {
        (self.0 >> 2) as f64 / Self::UNITS - 1.0
    }

    /// How many more rises and falls there are.
    fn by(self) -> [i64; 2] {
        [[1, 0], [0, 1], [0, -1], [-1, 0]][(self.0 & 3) as usize]
    }
}

impl Sweep {
    /// Adds so many rises and falls, `at` a place of the line's way from 0 to 1, or a little outside; a negative number takes away.
    pub(super) fn step(&mut self, at: f64, by: [i32; 2]) {
        for (by, kinds) in by.into_iter().zip([RISES, FALLS]) {
            let widened = at - f64::from(by.signum()) * TOGETHER;
            let step = Step::new(widened, kinds[usize::from(by < 0)]);
            self.0.extend((0..by.unsigned_abs()).map(|_| step));
        }
    }

    /// To be done once all steps are there, before it is asked for bounds.
    pub(super) fn sort(&mut self) {
        self.0.sort_unstable();
    }

    /// A bound for each of `size` columns.
    pub(super) fn most(&self, poles: Poles, size: usize) -> Vec<i64> {
        let mut of_columns = vec![0; size];
        let (mut rises, mut falls, mut column) = (0, 0, 0);
        let bound = |rises: i64, falls: i64| (poles.below + rises).min(poles.above + falls) + poles.unsure;
        of_columns[0] = bound(0, 0);
        for step in &self.0 {
            let reached = (step.at() * size as f64).clamp(0.0, size as f64 - 1.0) as usize;
            if column < reached {
                of_columns[column + 1..=reached].fill(bound(rises, falls));
            }
            column = reached;
            let [more_rises, more_falls] = step.by();
            rises += more_rises;
            falls += more_falls;
            of_columns[column] = of_columns[column].max(bound(rises, falls));
        }
        of_columns[column + 1..].fill(bound(rises, falls));
        of_columns
    }
}
