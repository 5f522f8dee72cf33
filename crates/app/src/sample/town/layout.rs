//! Where things stand: streets, blocks, plots and courts.

use glam::Vec2;

use crate::random::Random;

/// The street crossings, row by row from the south, each from the west; the town's corners are cut off.
const CROSSINGS: [[Vec2; 5]; 5] = [
    [v(-134.0, -104.0), v(-72.0, -110.0), v(-6.0, -114.0), v(66.0, -108.0), v(136.0, -102.0)],
    [v(-138.0, -50.0), v(-68.0, -56.0), v(-10.0, -52.0), v(62.0, -58.0), v(140.0, -52.0)],
    [v(-141.0, 8.0), v(-72.0, 4.0), v(-6.0, 8.0), v(68.0, 2.0), v(139.0, 6.0)],
    [v(-136.0, 62.0), v(-66.0, 58.0), v(-12.0, 64.0), v(64.0, 58.0), v(137.0, 60.0)],
    [v(-134.0, 104.0), v(-70.0, 110.0), v(-8.0, 113.0), v(68.0, 109.0), v(134.0, 104.0)],
];

/// The cells with houses, as (column, row) of their south-western crossing.
const BUILT: [(usize, usize); 10] = [(1, 0), (2, 0), (0, 1), (1, 1), (3, 1), (0, 2), (1, 2), (3, 2), (1, 3), (2, 3)];

/// Half the width of the streets along the rows of crossings, and along the columns.
const HALF_STREET_OF_ROW: [f32; 5] = [1.0, 3.2, 6.6, 3.4, 1.0];
const HALF_STREET_OF_COLUMN: [f32; 5] = [1.0, 3.4, 4.6, 3.2, 1.0];

/// From the edge of a street to the posts of its lamps.
const LAMP_FROM_EDGE: f32 = 1.2;

/// How deep houses are, from the street to the court.
const DEPTH: f32 = 11.2;

const fn v(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

/// A convex quadrilateral between streets, counter-clockwise from its south-western corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block([Vec2; 4]);

/// Where one house of a row goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plot {
    pub(super) center: Vec2,
    /// From east to the direction of the street, with the street on the right.
    pub(super) angle: f32,
    pub(super) width: f32,
    pub(super) depth: f32,
    /// Whether its left side, seen from the street, is on a street too.
    pub(super) is_corner: bool,
}

/// The blocks with houses, row by row.
pub(super) fn blocks() -> impl Iterator<Item = Block> {
    BUILT.into_iter().map(|(i, j)| {
        let cell = [CROSSINGS[j][i], CROSSINGS[j][i + 1], CROSSINGS[j + 1][i + 1], CROSSINGS[j + 1][i]];
        Block(cell).inset([
            HALF_STREET_OF_ROW[j],
            HALF_STREET_OF_COLUMN[i + 1],
            HALF_STREET_OF_ROW[j + 1],
            HALF_STREET_OF_COLUMN[i],
        ])
    })
}

/// Where trees stand along the street from the western to the eastern gate, but for the market's side.
pub(super) fn avenue() -> impl Iterator<Item = Vec2> {
    const SPACING: f32 = 12.5;
    let row = CROSSINGS[2];
    [0, 1, 3].into_iter().flat_map(move |i| {
        let (from, to) = (row[i], row[i + 1]);
        let side = (to - from).perp().normalize_or_zero() * 3.5;
        let count = ((to - from).length() / SPACING).floor() as u8;
        (0..count).flat_map(move |k| {
            let at = from.lerp(to, (f32::from(k) + 0.5) / f32::from(count));
            [at - side, at + side]
        })
    })
}

/// A place for a lamp at the edge of the street along a row of crossings, and the direction from it to the middle of the street.
///
/// It is `share` of the way from crossing `column` to the next one east, on the north (`side` 1) or south (-1).
pub(super) fn beside_row(row: usize, column: usize, share: f32, side: f32) -> (Vec2, Vec2) {
    beside([CROSSINGS[row][column], CROSSINGS[row][column + 1]], HALF_STREET_OF_ROW[row], share, side)
}

/// As [`beside_row`], along a column, from crossing `row` to the next one north, on the west (`side` 1) or east (-1).
pub(super) fn beside_column(column: usize, row: usize, share: f32, side: f32) -> (Vec2, Vec2) {
    beside([CROSSINGS[row][column], CROSSINGS[row + 1][column]], HALF_STREET_OF_COLUMN[column], share, side)
}

fn beside([from, to]: [Vec2; 2], half_street: f32, share: f32, side: f32) -> (Vec2, Vec2) {
    let across = (to - from).perp().normalize_or_zero() * side;
    (from.lerp(to, share) + across * (half_street - LAMP_FROM_EDGE), -across)
}

impl Block {
    fn side(&self, i: usize) -> (Vec2, Vec2) {
        (self.0[i], self.0[(i + 1) % 4])
    }

    /// The block with each side, the southern first, moved inwards by its distance.
    fn inset(&self, distances: [f32; 4]) -> Self {
        let lines: [(Vec2, Vec2); 4] = std::array::from_fn(|i| {
            let (from, to) = self.side(i);
            let along = (to - from).normalize_or_zero();
            (from + along.perp() * distances[i], along)
        });
        Self(std::array::from_fn(|i| {
            let ((p, along_p), (q, along_q)) = (lines[(i + 3) % 4], lines[i]);
            p + along_p * ((q - p).perp_dot(along_q) / along_p.perp_dot(along_q))
        }))
    }

    /// What is left behind the houses.
    pub(super) fn court(&self) -> Self {
        self.inset([DEPTH + 3.2; 4])
    }

    /// A point by its shares of the way east and north.
    pub(super) fn point(&self, east: f32, north: f32) -> Vec2 {
        let [a, b, c, d] = self.0;
        a.lerp(b, east).lerp(d.lerp(c, east), north)
    }

    /// The direction of the southern side.
    pub(super) fn angle(&self) -> f32 {
        (self.0[1] - self.0[0]).to_angle()
    }

    /// A row of houses along every side. Each row has the corner at which its side begins, and stops short of the
    /// row around the next corner.
    pub(super) fn plots(&self, random: &mut Random) -> Vec<Plot> {
        const MEAN_WIDTH: f32 = 15.4;
        let mut plots = Vec::new();
        for i in 0..4 {
            let (from, to) = self.side(i);
            let along = (to - from).normalize_or_zero();
            let length = (to - from).length() - DEPTH - 0.2;
            let count = (length / MEAN_WIDTH).round().max(1.0) as usize;
            let weights: Vec<f32> = (0..count).map(|_| random.between(0.75, 1.25)).collect();
            let total: f32 = weights.iter().sum();
            let mut start = 0.0;
            for (k, weight) in weights.into_iter().enumerate() {
                let width = length * weight / total;
                let depth = DEPTH + random.between(-1.4, 0.9);
                let setback = random.between(0.0, 0.55);
                let is_corner = k == 0;
                // Here and there a gap, for the way into the court.
                if is_corner || !random.chance(0.07) {
                    let center = from + along * (start + 0.5 * width) + along.perp() * (setback + 0.5 * depth);
                    plots.push(Plot { center, angle: along.to_angle(), width, depth, is_corner });
                }
                start += width;
            }
        }
        plots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_block_shrinks_by_the_width_of_its_streets() {
        let block = Block([v(0.0, 0.0), v(60.0, 0.0), v(60.0, 50.0), v(0.0, 50.0)]);
        let inset = block.inset([1.0, 2.0, 3.0, 4.0]);
        assert_eq!(inset.0, [v(4.0, 1.0), v(58.0, 1.0), v(58.0, 47.0), v(4.0, 47.0)]);
    }

    #[test]
    fn houses_stay_inside_their_block_and_out_of_its_court() {
        for block in blocks() {
            let court = block.inset([DEPTH + 1.5; 4]);
            for plot in block.plots(&mut Random::new(3)) {
                let depth_inside = |b: &Block, p: Vec2| {
                    let distance = |i| {
                        let (from, to) = b.side(i);
                        (to - from).normalize_or_zero().perp_dot(p - from)
                    };
                    (0..4).map(distance).fold(f32::INFINITY, f32::min)
                };
                assert!(depth_inside(&block, plot.center) > 3.0, "{plot:?}");
                assert!(depth_inside(&court, plot.center) < -3.0, "{plot:?}");
            }
        }
    }
}
