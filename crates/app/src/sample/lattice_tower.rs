//! An iron tower of struts, 300 m high, after the one in Paris.
//!
//! ```text
//!            |        spire
//!           _|_   276 m
//!           |X|
//!           |X|       one shaft of four chords
//!           |X|
//!          /XXX\  190 m: the legs have merged
//!        _/X/ \X\_    115 m
//!       _/X/   \X\_    57 m
//!      /X/ .'-'. \X\      each leg has four chords, braced on four faces
//!     /X/ /arch \ \X\
//! ```
//!
//! Heights and widths are Eiffel's; the number of triangles is that of Wallner 2007, figure 6.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use umbrae_core::{Scene, Surface, shapes};

use super::model::{Model, Parts, block};

/// The legs stand on piers of this height.
const FOOT: f32 = 4.0;
/// Where the legs end, and one shaft goes on.
const MERGE: f32 = 190.0;
/// Where the inner chords of the legs would meet: a little higher, or bars of two legs would coincide.
const MEET: f32 = 196.0;
/// Under the top platform.
const NECK: f32 = 274.0;
const LEG_PANELS: usize = 13;
const SHAFT_PANELS: usize = 11;

/// The four corners of a square, as signs.
const CORNERS: [Vec2; 4] = [Vec2::new(1.0, 1.0), Vec2::new(-1.0, 1.0), Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0)];

/// Where a chord of the leg in the positive quarter is at a height.
type Chord = fn(f32) -> Vec2;

pub(super) fn scene() -> Scene {
    let mut model = Model::default();
    let iron = model.paint("brown iron", [0.16, 0.105, 0.07]);
    let dark_iron = model.paint("dark iron", [0.115, 0.075, 0.052]);
    let stone = model.paint("stone", [0.46, 0.42, 0.35]);
    let deck = model.paint("deck", [0.25, 0.19, 0.14]);

    let levels = levels();
    let (leg_levels, shaft_levels) = (&levels[..=LEG_PANELS], &levels[LEG_PANELS..]);
    let mut legs = Parts::default();
    let mut bracing = Parts::default();
    for sign in CORNERS {
        legs.add(iron, chord(&levels, |z| (sign * outer(z)).extend(z)));
        let inner_chords: [Chord; 3] =
            [|z| Vec2::new(outer(z), inner(z)), |z| Vec2::new(inner(z), outer(z)), |z| Vec2::splat(inner(z))];
        for at in inner_chords {
            legs.add(iron, chord(leg_levels, |z| (sign * at(z)).extend(z)));
        }
        for inward in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
            let at = |z: f32| sign * (Vec2::splat(outer(z)) - inward * (outer(z) - inner(z)));
            legs.add(stone, block((at(0.0)).extend(0.0), Vec3::new(7.0, 7.0, FOOT + 0.5)));
        }
        // The four faces of a leg, each between two of its chords.
        let faces: [[Chord; 2]; 4] = [
            [|z| Vec2::splat(outer(z)), inner_chords[0]],
            [|z| Vec2::splat(outer(z)), inner_chords[1]],
            [inner_chords[0], inner_chords[2]],
            [inner_chords[1], inner_chords[2]],
        ];
        for [left, right] in faces {
            bracing.add_all(
                dark_iron,
                braces(leg_levels, |z| (sign * left(z)).extend(z), |z| (sign * right(z)).extend(z)),
            );
        }
    }
    for (a, b) in neighbours() {
        let [left, right] = [a, b].map(|sign| move |z: f32| (sign * outer(z)).extend(z));
        bracing.add_all(dark_iron, braces(shaft_levels, left, right));
    }
    model.add("legs", legs);
    model.add("bracing", bracing);

    let mut platforms = Parts::default();
    for (height, depth, overhang) in [(57.0, 3.4, 3.2), (115.0, 2.6, 2.2)] {
        let (half, hole) = (outer(height) + overhang, inner(height) * 0.62);
        platforms.add(deck, square_ring(half, hole, height, height + 0.9));
        platforms.add(iron, square_ring(half - 0.6, half - 1.3, height - depth, height + 0.4));
        platforms.add(iron, square_ring(half - 0.15, half - 0.3, height + 0.5, height + 2.1));
    }
    // A landing where the legs end.
    platforms.add(deck, square_ring(outer(MERGE) + 1.2, 1.6, MERGE - 0.4, MERGE + 0.5));
    platforms.add(iron, square_ring(outer(MERGE) + 1.1, outer(MERGE) + 0.95, MERGE + 0.3, MERGE + 1.7));
    platforms.add_all(dark_iron, girders());
    platforms.add(deck, block(Vec3::new(0.0, 0.0, NECK), Vec3::new(15.0, 15.0, 1.2)));
    platforms.add(iron, square_ring(7.4, 7.2, NECK + 0.8, NECK + 2.6));
    model.add("platforms", platforms);

    let mut arches = Parts::default();
    for (a, b) in neighbours() {
        arches.add_all(iron, arch(a, b));
    }
    model.add("arches", arches);

    let mut spire = Parts::default();
    let cabin =
        [(5.2, 0.0), (5.2, 5.0), (5.8, 5.2), (5.8, 5.6), (4.0, 8.4), (2.2, 9.8), (2.2, 13.0), (2.6, 13.2), (0.0, 16.0)];
    spire.add(iron, shapes::revolution(Vec3::new(0.0, 0.0, NECK + 0.6), &cabin.map(Vec2::from), 12));
    spire.add(dark_iron, shapes::cone(Vec3::new(0.0, 0.0, NECK + 14.0), 0.8, 300.0 - NECK - 14.0, 8));
    model.add("spire", spire);
    model.into_scene()
}

/// Half the width of the tower, measured along an axis.
fn outer(z: f32) -> f32 {
    62.5 * (-z / 103.0).exp()
}

/// Distance of the legs' inner chords from the axes: the legs grow into one another.
fn inner(z: f32) -> f32 {
    let share = 0.4 + 0.6 * (z / MEET).powf(1.5);
    outer(z) * (1.0 - share).max(0.0)
}

/// The heights of the joints, panels being as high in proportion to the width of what they brace all the way up.
fn levels() -> Vec<f32> {
    let spread = |from: f32, to: f32, panels: usize, ratio: f32| {
        let total = (ratio.powi(panels as i32) - 1.0) / (ratio - 1.0);
        (0..=panels).map(move |i| from + (to - from) * ((ratio.powi(i as i32) - 1.0) / (ratio - 1.0)) / total)
    };
    let legs = spread(FOOT, MERGE, LEG_PANELS, 0.94);
    legs.chain(spread(MERGE, NECK, SHAFT_PANELS, 0.93).skip(1)).collect()
}

/// Pairs of corners that share a side of the tower.
fn neighbours() -> impl Iterator<Item = (Vec2, Vec2)> {
    (0..4).map(|i| (CORNERS[i], CORNERS[(i + 1) % 4]))
}

fn chord(levels: &[f32], at: impl Fn(f32) -> Vec3) -> Surface {
    let path: Vec<Vec3> = levels.iter().map(|&z| at(z)).collect();
    shapes::tube(&path, 0.85, 4)
}

/// Crosses and horizontals between two chords. The three kinds differ in thickness, so that no two faces coincide
/// where they cross.
fn braces(levels: &[f32], left: impl Fn(f32) -> Vec3, right: impl Fn(f32) -> Vec3) -> Vec<Surface> {
    let mut bars = Vec::new();
    for pair in levels.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        bars.push(shapes::strut(left(low), right(high), 0.46, 3));
        bars.push(shapes::strut(right(low), left(high), 0.42, 3));
        // At the top the inner chords meet, and there is nothing left to join.
        if left(high).distance(right(high)) > 1.0 {
            bars.push(shapes::strut(left(high), right(high), 0.50, 3));
        }
    }
    bars
}

/// A level square frame with a square hole: 32 triangles.
fn square_ring(half: f32, hole: f32, bottom: f32, top: f32) -> Surface {
    let mut ring = Surface::default();
    for (i, sign) in (0_u32..).zip(CORNERS) {
        let section = [(hole, bottom), (half, bottom), (half, top), (hole, top)];
        ring.positions.extend(section.map(|(at, z)| (sign * at).extend(z)));
        for j in 0..4 {
            let corner = |i: u32, j: u32| i % 4 * 4 + j % 4;
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            ring.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    ring
}

/// The lattice girders that join the legs under the first platform.
fn girders() -> Vec<Surface> {
    const PANELS: u8 = 8;
    const LOW: f32 = 47.6;
    const HIGH: f32 = 54.6;
    let mut bars = Vec::new();
    for (a, b) in neighbours() {
        let at = |share: f32, z: f32| {
            let half = 0.5 * (a - b) * inner(z) * (1.0 - 2.0 * share) + 0.5 * (a + b) * (outer(z) - 0.4);
            half.extend(z)
        };
        bars.extend([LOW, HIGH].map(|z| shapes::strut(at(0.0, z), at(1.0, z), 0.5, 4)));
        for panel in 0..PANELS {
            let [from, to] = [panel, panel + 1].map(|i| f32::from(i) / f32::from(PANELS));
            bars.push(shapes::strut(at(from, LOW), at(to, HIGH), 0.26, 3));
            bars.push(shapes::strut(at(from, HIGH), at(to, LOW), 0.23, 3));
        }
    }
    bars
}

/// The arch between two legs: two bands in the sloping side of the tower, and a zigzag between them.
fn arch(a: Vec2, b: Vec2) -> Vec<Surface> {
    const PIECES: u8 = 16;
    const SPRING: f32 = 9.0;
    let at = |share: f32, half_span: f32, height: f32| {
        let angle = PI * share;
        let z = SPRING + height * angle.sin();
        let along = 0.5 * (a - b) * half_span * angle.cos();
        (along + 0.5 * (a + b) * (outer(z) - 0.9)).extend(z)
    };
    let outer_band = |i: u8| at(f32::from(i) / f32::from(PIECES), inner(SPRING) + 0.4, 38.0);
    let inner_band = |i: u8| at(f32::from(i) / f32::from(PIECES), inner(SPRING) - 3.6, 34.2);
    let path = |band: &dyn Fn(u8) -> Vec3| (0..=PIECES).map(band).collect::<Vec<_>>();
    let mut parts = vec![shapes::tube(&path(&outer_band), 0.62, 4), shapes::tube(&path(&inner_band), 0.55, 4)];
    for i in 0..PIECES {
        parts.push(shapes::strut(outer_band(i), inner_band(i + 1), 0.3, 3));
        parts.push(shapes::strut(inner_band(i), outer_band(i + 1), 0.27, 3));
    }
    parts
}
