//! How many of some triangles are behind each other, at most: for those few of a volume's faces that are turned away from the light.
//!
//! A grid before the light, and for each cell how many triangles' boxes touch it. Coarse, but those triangles are small.

use glam::DVec3;

use super::{Chart, WIDENED, ahead_of};
use crate::{Bounds, LightPosition};

/// Rows and columns, powers of two: so many for each row and column of triangles, if they were in rows and columns.
const CELLS_PER_ROW: f64 = 4.0;
const CELLS: [usize; 2] = [128, 512];
/// So few are not worth a grid.
const FEW: usize = 8;

/// No ray from `light` meets more of `triangles` than this. Takes some 20 ns for each.
pub(crate) fn most_stacked(triangles: &[[DVec3; 3]], light: LightPosition) -> u32 {
    let bounds = Bounds::of_points(triangles.iter().flatten().copied());
    let ahead = if triangles.len() <= FEW { None } else { ahead_of(&bounds, light) };
    let Some(ahead) = ahead else { return triangles.len() as u32 };
    let right = ahead.any_orthonormal_vector();
    let chart = Chart::around(light, [right, right.cross(ahead), ahead], &bounds);
    let cells = (CELLS_PER_ROW * (triangles.len() as f64).sqrt()) as usize;
    let cells = cells.next_power_of_two().clamp(CELLS[0], CELLS[1]);
    // What begins in a cell less what has ended before it, in both directions.
    let mut steps = vec![0_i32; (cells + 1) * (cells + 1)];
    let cell = |at: f64| at.clamp(0.0, cells as f64 - 1.0) as usize;
    for triangle in triangles {
        let corners = triangle.map(|p| chart.on_grid(chart.flat(p)).map(|at| at * cells as f64));
        let span = |i: usize| {
            let [a, b, c] = corners.map(|corner| corner[i]);
            [cell(a.min(b).min(c) - WIDENED), cell(a.max(b).max(c) + WIDENED) + 1]
        };
        let ([left, right], [below, above]) = (span(0), span(1));
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
    use super::*;

    fn sun() -> LightPosition {
        LightPosition::directional(DVec3::new(0.1, 0.2, 1.0)).expect("not zero")
    }

    fn tile(x: f64, z: f64) -> [DVec3; 3] {
        let at = DVec3::new(x, 0.0, z);
        [at, at + DVec3::X * 0.5, at + DVec3::Y * 0.5]
    }

    #[test]
    fn a_stack_is_as_high_as_it_is_and_a_row_is_low() {
        let stack: Vec<_> = (0..40).map(|i| tile(0.0, 0.001 * f64::from(i))).collect();
        assert_eq!(most_stacked(&stack, sun()), 40);
        let row: Vec<_> = (0..40).map(|i| tile(f64::from(i), 0.0)).collect();
        assert_eq!(most_stacked(&row, sun()), 1);
        let both: Vec<_> = row.iter().chain(&stack).copied().collect();
        assert_eq!(most_stacked(&both, LightPosition::point(DVec3::new(3.0, 3.0, 9.0))), 41);
    }

    #[test]
    fn around_a_light_all_may_be_behind_each_other() {
        let row: Vec<_> = (0..40).map(|i| tile(f64::from(i), 0.0)).collect();
        assert_eq!(most_stacked(&row, LightPosition::point(DVec3::new(3.0, 0.1, 0.0))), 40);
    }
}
