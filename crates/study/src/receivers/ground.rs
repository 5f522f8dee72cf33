//! A grid of points on the ground.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Terrain;

/// Square cells, in rows from north to south, each from west to east: the order of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundGrid {
    /// The middle of the first cell, the north-western one, scene space.
    pub first: DVec2,
    /// Metres between middles.
    pub spacing: f64,
    /// Cells from west to east.
    pub columns: usize,
    /// Cells from north to south.
    pub rows: usize,
    /// Height of the ground where there is no terrain, scene space.
    pub level: f64,
}

impl GroundGrid {
    /// The cells of `spacing` metres that cover the rectangle from `min` to `max`, at `level`; at least one.
    ///
    /// Their edges are at multiples of the spacing from `min`, and the rectangle is in the middle of what is left over.
    pub fn covering(min: DVec2, max: DVec2, spacing: f64, level: f64) -> Self {
        let cells = ((max - min) / spacing).ceil().max(DVec2::ONE);
        let left_over = cells * spacing - (max - min);
        let north_west = DVec2::new(min.x, max.y) + 0.5 * DVec2::new(-left_over.x, left_over.y);
        Self {
            first: north_west + 0.5 * spacing * DVec2::new(1.0, -1.0),
            spacing,
            columns: cells.x as usize,
            rows: cells.y as usize,
            level,
        }
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The middle of a cell seen from above, scene space.
    pub fn middle(&self, column: usize, row: usize) -> DVec2 {
        self.first + self.spacing * DVec2::new(column as f64, -(row as f64))
    }

    /// The middles, on `terrain` where there is some.
    pub(super) fn points(&self, terrain: &Terrain) -> Vec<DVec3> {
        (0..self.len())
            .into_par_iter()
            .map(|i| {
                let middle = self.middle(i % self.columns, i / self.columns);
                terrain.above(middle).unwrap_or(middle.extend(self.level))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_covers_its_rectangle_from_the_north_west() {
        let grid = GroundGrid::covering(DVec2::new(0.0, 10.0), DVec2::new(5.0, 14.0), 2.0, 0.0);
        assert_eq!([grid.columns, grid.rows], [3, 2]);
        assert_eq!(grid.middle(0, 0), DVec2::new(0.5, 13.0));
        assert_eq!(grid.middle(2, 1), DVec2::new(4.5, 11.0));
    }
}
