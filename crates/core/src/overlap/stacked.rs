//! How many of some triangles are behind each other, at most: for those few of a volume's faces that are turned away from the light.
//!
//! A grid before the light, and for each cell how many triangles' boxes touch it. Coarse, but those triangles are small.

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use super::{Chart, WIDENED, ahead_of};
use crate::{Bounds, LightPosition};

/// Rows and columns of a grid that is soon looked over, and of one that takes milliseconds.
const ROUGH: usize = 256;
const CLOSE: usize = 1024;

/// From where to where on the grid, from 0 to 1 across it and up it.
type Box = [DVec2; 2];

/// Triangles as a light sees them.
#[derive(Debug)]
pub(crate) struct Stack {
    count: u32,
    /// `None` around the light, where there is no plane before it.
    boxes: Option<Vec<Box>>,
}

impl Stack {
    /// Of `triangles`, all of them in `bounds`. Takes some 20 ns for each.
    pub(crate) fn new(
        triangles: impl ParallelIterator<Item = [Vec3; 3]>,
        bounds: &Bounds,
        light: LightPosition,
    ) -> Self {
        let Some(ahead) = ahead_of(bounds, light) else { return Self { count: triangles.count() as u32, boxes: None } };
        let right = ahead.any_orthonormal_vector();
        let chart = Chart::around(light, [right, right.cross(ahead), ahead], bounds);
        let boxes: Vec<Box> = triangles
            .map(|triangle| {
                let [a, b, c] = triangle.map(|p| chart.on_grid(chart.flat(p.as_dvec3())));
                [a.min(b).min(c), a.max(b).max(c)]
            })
            .collect();
        Self { count: boxes.len() as u32, boxes: Some(boxes) }
    }

    /// No ray from the light meets more of them than this.
    pub(crate) fn most_roughly(&self) -> u32 {
        self.boxes.as_ref().map_or(self.count, |boxes| most_on_grid(boxes, ROUGH))
    }

    /// The same, nearer to how many it does meet.
    pub(crate) fn most_closely(&self) -> u32 {
        self.boxes.as_ref().map_or(self.count, |boxes| most_on_grid(boxes, CLOSE))
    }
}

/// How many of `boxes` touch one of so many rows and columns of `cells`.
fn most_on_grid(boxes: &[Box], cells: usize) -> u32 {
    // What begins in a cell less what has ended before it, in both directions.
    let mut steps = vec![0_i32; (cells + 1) * (cells + 1)];
    let cell = |at: DVec2| at.clamp(DVec2::ZERO, DVec2::splat(cells as f64 - 1.0)).to_array().map(|at| at as usize);
    for [min, max] in boxes {
        let [left, below] = cell(min * cells as f64 - WIDENED);
        let [right, above] = cell(max * cells as f64 + WIDENED).map(|last| last + 1);
        let row = |y: usize| y * (cells + 1);
        steps[row(below) + left] += 1;
        steps[row(below) + right] -= 1;
        steps[row(above) + left] -= 1;
        steps[row(above) + right] += 1;
    }
    let mut column = vec![0; cells + 1];
    let mut most = 0;
    for row in steps.chunks_exact(cells + 1) {
        let mut count = 0;
        for (sum, step) in column.iter_mut().zip(row) {
            *sum += step;
            count += *sum;
            most = most.max(count);
        }
    }
    most as u32
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn sun() -> LightPosition {
        LightPosition::directional(DVec3::new(0.1, 0.2, 1.0)).expect("not zero")
    }

    fn tile(x: f32, z: f32) -> [Vec3; 3] {
        let at = Vec3::new(x, 0.0, z);
        [at, at + Vec3::X * 0.5, at + Vec3::Y * 0.5]
    }

    /// Roughly and closely.
    fn most(triangles: &[[Vec3; 3]], light: LightPosition) -> [u32; 2] {
        let bounds = Bounds::of_points(triangles.iter().flatten().map(|p| p.as_dvec3()));
        let stack = Stack::new(triangles.par_iter().copied(), &bounds, light);
        [stack.most_roughly(), stack.most_closely()]
    }

    #[test]
    fn a_stack_is_as_high_as_it_is_and_a_row_is_low() {
        let stack: Vec<_> = (0..40).map(|i| tile(0.0, 0.001 * i as f32)).collect();
        assert_eq!(most(&stack, sun()), [40; 2]);
        let row: Vec<_> = (0..40).map(|i| tile(i as f32, 0.0)).collect();
        assert_eq!(most(&row, sun()), [1; 2]);
        let both: Vec<_> = row.iter().chain(&stack).copied().collect();
        assert_eq!(most(&both, LightPosition::point(DVec3::new(3.0, 3.0, 9.0))), [41; 2]);
    }

    #[test]
    fn a_closer_look_tells_more_of_a_row_that_is_crowded() {
        let flat = Vec3::new(1.0, 0.1, 1.0);
        let row: Vec<_> = (0..4000).map(|i| tile(0.01 * i as f32, 0.0).map(|p| p * flat)).collect();
        let [roughly, closely] = most(&row, sun());
        // A tile is as wide as fifty steps.
        assert!((50..70).contains(&closely) && (closely..90).contains(&roughly), "{closely} and {roughly}");
    }

    #[test]
    fn around_a_light_all_may_be_behind_each_other() {
        let row: Vec<_> = (0..40).map(|i| tile(i as f32, 0.0)).collect();
        assert_eq!(most(&row, LightPosition::point(DVec3::new(3.0, 0.1, 0.0))), [40; 2]);
    }
}
