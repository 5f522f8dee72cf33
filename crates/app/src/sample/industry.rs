//! A works: halls under saw-tooth and vaulted roofs, tanks, silos, chimneys, cooling towers, and pipes on racks.
//!
//! After Wallner 2007, figure 5, with as many triangles. One object for each kind of thing.
//!
//! ```text
//!   office       vault        silos          cooling towers
//!                             conveyor          O      O
//!   rack ======================================================
//!   saw-tooth hall   chimneys   ||   tanks  o o o
//!                    gabled     ||          o o o     spheres
//! ```

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Affine3A, Vec2, Vec3};
use umbrae_core::{Scene, Surface, shapes};

use super::model::{Model, Parts, block, profile};

/// Level of the two layers of pipes on the racks.
const LAYERS: [f32; 2] = [5.6, 7.9];
/// Where the long rack ends, on the x axis, and the short one, on the y axis at `SHORT_RACK_X`.
const RACK: [f32; 2] = [-43.0, 108.0];
const SHORT_RACK: [f32; 2] = [-66.0, -5.0];
const SHORT_RACK_X: f32 = 18.0;

pub(super) fn scene() -> Scene {
    let mut model = Model::default();
    halls(&mut model);
    tanks(&mut model);
    silos(&mut model);
    towers(&mut model);
    pipes(&mut model);
    model.into_scene()
}

fn halls(model: &mut Model) {
    let brick = model.paint("brick", [0.38, 0.16, 0.10]);
    let plaster = model.paint("plaster", [0.58, 0.53, 0.44]);
    let sheet = model.paint("roof sheet", [0.33, 0.36, 0.38]);
    let tiles = model.paint("roof tiles", [0.42, 0.17, 0.09]);
    let glass = model.paint("glass", [0.10, 0.16, 0.22]);
    let mut walls = Parts::default();
    let mut roofs = Parts::default();

    // The saw-tooth hall: seven roofs that look north through upright glass.
    const TEETH: u8 = 7;
    let (west, east, south, eaves, rise) = (-105.0, -45.0, -66.0, 8.0, 3.6);
    let tooth_y = |k: u8| south + 7.2 * f32::from(k);
    let mut outline = vec![Vec2::new(south, eaves), Vec2::new(south, 0.0), Vec2::new(tooth_y(TEETH), 0.0)];
    for k in (0..TEETH).rev() {
        outline.push(Vec2::new(tooth_y(k + 1), eaves + rise));
        // The last valley is the eaves, already there.
        if k > 0 {
            outline.push(Vec2::new(tooth_y(k), eaves));
        }
        let (low, high) = (Vec2::new(tooth_y(k), eaves), Vec2::new(tooth_y(k + 1), eaves + rise));
        let (start, end) = (low + Vec2::new(0.25, 0.0), high + Vec2::new(0.5, 0.12));
        let up = Vec2::new(0.0, 0.25);
        roofs.add(sheet, profile(&[start, end, end + up, start + up], west - 0.4, east + 0.4));
        for pane in 0..4 {
            let x = west + 7.7 + 14.85 * pane as f32;
            roofs.add(glass, block(Vec3::new(x, high.x, eaves + 0.7), Vec3::new(14.0, 0.24, rise - 1.2)));
        }
    }
    walls.add(brick, profile(&outline, west, east));
    for k in 0..=10 {
        let x = west + 1.0 + 5.8 * k as f32;
        walls.add(brick, block(Vec3::new(x, south, 0.0), Vec3::new(0.8, 0.7, eaves - 0.4)));
        walls.add(glass, block(Vec3::new(x + 2.9, south, 2.4), Vec3::new(3.2, 0.2, 3.6)));
    }
    for k in 0..TEETH {
        let middle = tooth_y(k) + 3.6;
        walls.add_all(glass, [west, east].map(|x| block(Vec3::new(x, middle, 2.0), Vec3::new(0.2, 3.6, 4.2))));
    }

    // The vaulted hall.
    let (middle_y, half_span, springing, sagitta) = (30.0, 15.0, 9.0, 6.0);
    let arc = |out: f32| {
        move |i: u8| {
            let angle = PI * f32::from(i) / 14.0;
            Vec2::new(middle_y + (half_span + out) * angle.cos(), springing + (sagitta + out) * angle.sin())
        }
    };
    let base = [Vec2::new(middle_y - half_span, 0.0), Vec2::new(middle_y + half_span, 0.0)];
    let body: Vec<Vec2> = base.into_iter().chain((0..=14).map(arc(0.0))).collect();
    walls.add(plaster, profile(&body, -105.0, -55.0));
    let shell: Vec<Vec2> = (0..=14).map(arc(0.45)).chain((0..=14).rev().map(arc(-0.2))).collect();
    roofs.add(sheet, profile(&shell, -105.6, -54.4));
    for k in 0..7 {
        let x = -101.5 + 6.9 * k as f32;
        for y in [middle_y - half_span, middle_y + half_span] {
            walls.add(glass, block(Vec3::new(x, y, 3.0), Vec3::new(4.4, 0.24, 4.4)));
            walls.add(plaster, block(Vec3::new(x + 3.45, y, 0.0), Vec3::new(0.7, 1.1, springing - 0.5)));
        }
    }

    // The gabled hall, with a lantern along its ridge.
    let gable = |half: f32, foot: f32, eaves: f32, ridge: f32, y: f32| {
        [(-half, foot), (half, foot), (half, eaves), (0.0, ridge), (-half, eaves)].map(|(a, z)| Vec2::new(y + a, z))
    };
    walls.add(brick, profile(&gable(13.0, 0.0, 10.0, 15.2, -52.0), -36.0, 4.0));
    roofs.add(tiles, profile(&chevron(14.0, 15.3, 0.4, 0.35, -52.0), -36.7, 4.7));
    walls.add(glass, profile(&gable(2.4, 13.0, 17.0, 18.0, -52.0), -33.0, 1.0));
    roofs.add(tiles, profile(&chevron(3.0, 18.05, 0.4, 0.25, -52.0), -33.5, 1.5));
    for k in 0..7 {
        let x = -33.0 + 5.6 * k as f32;
        walls.add_all(glass, [-65.0, -39.0].map(|y| block(Vec3::new(x, y, 3.0), Vec3::new(2.6, 0.22, 4.6))));
    }
    walls.add(sheet, block(Vec3::new(4.0, -52.0, 0.0), Vec3::new(0.3, 6.0, 6.0)));

    // The office, with bands of windows.
    walls.add(plaster, block(Vec3::new(-88.0, 61.0, 0.0), Vec3::new(34.0, 12.0, 14.0)));
    roofs.add(sheet, block(Vec3::new(-88.0, 61.0, 13.8), Vec3::new(34.8, 12.8, 0.6)));
    roofs.add(plaster, block(Vec3::new(-80.0, 61.0, 14.0), Vec3::new(5.0, 5.0, 3.6)));
    for floor in 0..4 {
        for k in 0..6 {
            let base = Vec3::new(-102.0 + 5.6 * k as f32, 55.0, 1.0 + 3.3 * floor as f32);
            walls.add(glass, block(base, Vec3::new(4.4, 0.16, 1.6)));
        }
    }
    model.add("halls", walls);
    model.add("roofs", roofs);
}

/// The section of a roof of two slopes: half its width, height of its ridge, slope and thickness.
fn chevron(half: f32, ridge: f32, slope: f32, thickness: f32, middle: f32) -> [Vec2; 6] {
    let at = |y: f32, up: f32| Vec2::new(middle + y, ridge - slope * y.abs() + up);
    [at(-half, 0.0), at(0.0, 0.0), at(half, 0.0), at(half, thickness), at(0.0, thickness), at(-half, thickness)]
}

fn tanks(model: &mut Model) {
    let white = model.paint("white steel", [0.66, 0.66, 0.63]);
    let steel = model.paint("steel", [0.30, 0.31, 0.32]);
    let mut parts = Parts::default();
    for (x, y) in tank_places() {
        let base = Vec3::new(x, y, 0.0);
        let section = [(8.6, 0.0), (8.6, 0.5), (8.0, 0.6), (8.0, 11.0), (8.15, 11.05), (8.15, 11.3), (0.0, 12.6)];
        parts.add(white, shapes::revolution(base, &section.map(Vec2::from), 18));
        parts.add(steel, shapes::torus(base.with_z(12.2), 7.7, 0.06, 14, 3));
        for post in 0..4 {
            let at = base + (7.7 * Vec2::from_angle(TAU * post as f32 / 4.0)).extend(11.0);
            parts.add(steel, shapes::strut(at, at.with_z(12.2), 0.05, 3));
        }
        parts.add_all(steel, ladder(base + Vec3::new(0.0, 8.25, 0.5), 11.4));
    }
    for y in [-52.0, -28.0] {
        let center = Vec3::new(94.0, y, 11.5);
        parts.add(white, shapes::icosphere(center, 8.2, 2));
        for leg in 0..8 {
            let foot = center.truncate() + 7.9 * Vec2::from_angle(TAU * leg as f32 / 8.0);
            parts.add(steel, shapes::cylinder(foot.extend(0.0), 0.35, 11.8, 6));
        }
    }
    model.add("tanks", parts);
}

fn tank_places() -> impl Iterator<Item = (f32, f32)> {
    [32.0, 52.0, 72.0].into_iter().flat_map(|x| [(x, -54.0), (x, -30.0)])
}

/// Two rails and their rungs, on the north of `foot`.
fn ladder(foot: Vec3, height: f32) -> Vec<Surface> {
    let mut bars: Vec<Surface> = [-0.3, 0.3]
        .map(|x| foot + Vec3::new(x, 0.0, 0.0))
        .map(|rail| shapes::strut(rail, rail + height * Vec3::Z, 0.05, 4))
        .into();
    bars.extend((1..6).map(|i| {
        let rung = foot + Vec3::new(0.0, 0.0, height * i as f32 / 6.0);
        shapes::strut(rung - 0.3 * Vec3::X, rung + 0.3 * Vec3::X, 0.03, 3)
    }));
    bars
}

fn silos(model: &mut Model) {
    let concrete = model.paint("concrete", [0.45, 0.44, 0.41]);
    let steel = model.paint("dark steel", [0.16, 0.18, 0.20]);
    let yellow = model.paint("yellow steel", [0.62, 0.42, 0.08]);
    let mut parts = Parts::default();
    let rows = [27.0, 35.5];
    for x in 0..4 {
        for y in rows {
            let base = Vec3::new(-38.0 + 8.5 * x as f32, y, 0.0);
            let section = [(0.5, 1.2), (4.0, 5.0), (4.0, 22.0), (3.7, 22.3), (0.0, 23.0)];
            parts.add(concrete, shapes::revolution(base, &section.map(Vec2::from), 16));
            for (dx, dy) in [(-2.6, -2.6), (2.6, -2.6), (2.6, 2.6), (-2.6, 2.6)] {
                parts.add(concrete, block(base + Vec3::new(dx, dy, 0.0), Vec3::new(0.7, 0.7, 5.4)));
            }
        }
    }
    // The gallery over the silos.
    parts.add(steel, block(Vec3::new(-23.25, 31.25, 22.6), Vec3::new(38.0, 7.0, 4.2)));
    model.add("silos", parts);

    let mut conveyor = Parts::default();
    let (low, high) = (Vec3::new(42.0, 31.25, 2.4), Vec3::new(-4.0, 31.25, 24.9));
    let at = |share: f32| low.lerp(high, share);
    conveyor.add(yellow, shapes::strut(low, high, 1.9, 4));
    conveyor.add(concrete, block(Vec3::new(43.0, 31.25, 0.0), Vec3::new(6.0, 6.0, 4.4)));
    for (from, to) in (0..12).map(|i| (i as f32 / 12.0, (i + 1) as f32 / 12.0)) {
        // A lattice on either side of the belt's box.
        for side in [-1.75, 1.75] {
            let [from, to] = [from, to].map(|share| at(share) + side * Vec3::Y);
            conveyor.add(steel, shapes::strut(from - 1.5 * Vec3::Z, to + 1.2 * Vec3::Z, 0.1, 3));
            conveyor.add(steel, shapes::strut(to + 1.2 * Vec3::Z, to - 1.5 * Vec3::Z, 0.12, 3));
        }
    }
    for share in [0.28, 0.52, 0.76] {
        let top = at(share) - 0.9 * Vec3::Z;
        for side in [-1.0, 1.0] {
            let foot = Vec3::new(top.x, top.y + 3.2 * side, 0.1);
            conveyor.add(steel, shapes::strut(foot, top + 1.2 * side * Vec3::Y, 0.35, 4));
            let across = |share: f32| foot.lerp(top + 1.2 * side * Vec3::Y, share);
            let mirrored = |share: f32| across(share) * Vec3::new(1.0, -1.0, 1.0) + 2.0 * top.y * Vec3::Y;
            conveyor.add(steel, shapes::strut(across(0.15), mirrored(0.75), 0.14 + 0.01 * side, 4));
        }
    }
    model.add("conveyor", conveyor);
}

fn towers(model: &mut Model) {
    let brick = model.paint("chimney brick", [0.44, 0.20, 0.13]);
    let concrete = model.paint("pale concrete", [0.56, 0.55, 0.52]);
    let mut chimneys = Parts::default();
    for (x, y, height) in [(-34.0, -20.0, 62.0), (-22.0, -20.0, 62.0), (6.0, -20.0, 44.0)] {
        let base = Vec3::new(x, y, 0.0);
        chimneys.add(brick, block(base, Vec3::new(7.0, 7.0, 5.0)));
        let section = [
            (2.7, 4.0),
            (1.9, height - 3.0),
            (2.3, height - 2.2),
            (2.3, height - 1.0),
            (2.0, height - 0.6),
            (2.0, height),
            (1.5, height),
            (1.5, height - 7.0),
            (0.0, height - 7.5),
        ];
        chimneys.add(brick, shapes::revolution(base, &section.map(Vec2::from), 16));
    }
    model.add("chimneys", chimneys);

    let mut cooling = Parts::default();
    for (x, y) in [(60.0, 52.0), (98.0, 46.0)] {
        const SIDES: usize = 20;
        let base = Vec3::new(x, y, 0.0);
        // A hyperboloid, narrowest at three quarters of its height; hollow down to the level of the packing.
        let radius = |z: f32| 9.4 * (1.0 + ((z - 34.0) / 26.0).powi(2)).sqrt();
        let heights = (0..=8).map(|i| 5.0 + 41.0 * i as f32 / 8.0);
        let outside = heights.clone().map(|z| Vec2::new(radius(z), z));
        let inside = heights.rev().take(8).map(|z| Vec2::new(radius(z) - 0.5, z));
        let section: Vec<Vec2> = outside.chain(inside).chain([Vec2::new(0.0, 9.0)]).collect();
        cooling.add(concrete, shapes::revolution(base, &section, SIDES));
        for leg in 0..SIDES / 2 {
            let at =
                |step: usize, r: f32, z: f32| base + (r * Vec2::from_angle(TAU * step as f32 / SIDES as f32)).extend(z);
            let (left, top, right) = (2 * leg, 2 * leg + 1, 2 * leg + 2);
            let head = at(top, radius(5.0) - 0.6, 5.2);
            cooling.add(concrete, shapes::strut(at(left, radius(0.0), 0.0).with_z(0.4), head, 0.4, 4));
            cooling.add(concrete, shapes::strut(at(right, radius(0.0), 0.0).with_z(0.4), head, 0.38, 4));
        }
        cooling.add(concrete, shapes::cylinder(base, radius(0.0) + 1.2, 0.8, SIDES));
    }
    model.add("cooling towers", cooling);
}

fn pipes(model: &mut Model) {
    let steel = model.paint("rack steel", [0.22, 0.26, 0.30]);
    let silver = model.paint("lagging", [0.55, 0.56, 0.57]);
    let rust = model.paint("red pipe", [0.40, 0.10, 0.06]);
    let green = model.paint("green pipe", [0.10, 0.28, 0.16]);

    let mut racks = Parts::default();
    let frames =
        |from: f32, to: f32, step: f32| (0..).map(move |i| from + step * i as f32).take_while(move |&x| x <= to);
    let long = frames(RACK[0], RACK[1], 10.4).map(|x| Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)));
    let short = frames(SHORT_RACK[0], SHORT_RACK[1], 10.0)
        .map(|y| Affine3A::from_translation(Vec3::new(SHORT_RACK_X, y, 0.0)) * Affine3A::from_rotation_z(FRAC_PI_2));
    for to_frame in long.chain(short) {
        let mut frame = Parts::default();
        frame.add_all(steel, [-3.4, 3.4].map(|y| block(Vec3::new(0.0, y, 0.0), Vec3::new(0.4, 0.4, 9.0))));
        frame.add_all(steel, LAYERS.map(|z| block(Vec3::new(0.0, 0.0, z - 0.9), Vec3::new(0.3, 7.4, 0.45))));
        frame.add(steel, shapes::strut(Vec3::new(0.0, -3.4, 0.6), Vec3::new(0.0, 3.4, 4.6), 0.12, 4));
        racks.add_moved(frame, to_frame);
    }
    for side in [-3.4, 3.4] {
        for z in LAYERS.map(|z| z - 1.15) {
            let length = RACK[1] - RACK[0] - 1.0;
            racks.add(steel, block(Vec3::new(0.5 * (RACK[0] + RACK[1]), side, z), Vec3::new(length, 0.26, 0.4)));
            let length = SHORT_RACK[1] - SHORT_RACK[0] + 1.0;
            let middle = 0.5 * (SHORT_RACK[0] + SHORT_RACK[1]);
            racks.add(steel, block(Vec3::new(SHORT_RACK_X + side, middle, z), Vec3::new(0.26, length, 0.38)));
        }
    }
    model.add("racks", racks);

    let mut parts = Parts::default();
    // From the saw-tooth hall along the rack and down to a tank or a sphere.
    let ends = tank_places().chain([(94.0, -28.0), (94.0, -52.0)]);
    for (k, (x, y)) in ends.enumerate() {
        let lane = -2.8 + 0.75 * k as f32;
        let level = LAYERS[k % 2];
        let paint = [silver, rust, silver, green][k % 4];
        let (leave, level_out) = (x - 4.0 + 0.7 * (k % 2) as f32, level + 1.4);
        let mut path = vec![
            Vec3::new(-46.0, -24.0 - 2.0 * k as f32, level - 2.2),
            Vec3::new(-41.0 + lane, -24.0 - 2.0 * k as f32, level - 2.2),
            Vec3::new(-41.0 + lane, -8.0, level - 2.2),
            Vec3::new(-41.0 + lane, -8.0, level),
            Vec3::new(-41.0 + lane, lane, level),
            Vec3::new(leave, lane, level),
            Vec3::new(leave, lane, level_out),
            Vec3::new(leave, y + 14.0, level_out),
        ];
        path.extend([Vec3::new(leave, y + 14.0, 2.0), Vec3::new(leave, y + 4.0, 2.0)]);
        parts.add(paint, shapes::tube(&cut_corners(&path, 0.9), 0.28, 6));
    }
    // Straight lines along both racks, and the large main to the cooling towers.
    for (k, lane) in [-1.6_f32, -0.4, 0.9, 2.1].into_iter().enumerate() {
        let radius = 0.22 + 0.05 * k as f32;
        let x = SHORT_RACK_X + lane;
        let path = [
            Vec3::new(x, SHORT_RACK[0] - 2.0, 1.0),
            Vec3::new(x, SHORT_RACK[0] - 2.0, LAYERS[1] + 0.1),
            Vec3::new(x, 5.0 + lane, LAYERS[1] + 0.1),
            Vec3::new(x, 5.0 + lane, LAYERS[0] - 2.6),
            Vec3::new(-50.0, 5.0 + lane, LAYERS[0] - 2.6),
            Vec3::new(-50.0, 17.0, LAYERS[0] - 2.6),
        ];
        parts.add([rust, silver][k % 2], shapes::tube(&cut_corners(&path, 1.0), radius, 6));
    }
    for (k, (x, y)) in [(60.0, 52.0), (98.0, 46.0)].into_iter().enumerate() {
        let lane = 9.5 + 6.0 * k as f32;
        let there = [(40.0, lane, 1.6), (x - 6.0, lane, 1.6), (x - 6.0, y, 1.6)].map(Vec3::from);
        parts.add(green, shapes::tube(&cut_corners(&there, 2.5), 0.9, 8));
        let back = [(x + 5.0, y, 1.7), (x + 5.0, lane + 3.0, 1.7), (36.0, lane + 3.0, 1.7)].map(Vec3::from);
        parts.add(silver, shapes::tube(&cut_corners(&back, 2.5), 0.85, 8));
    }
    model.add("pipes", parts);
}

/// `path` with its corners cut off `reach` before and behind them.
fn cut_corners(path: &[Vec3], reach: f32) -> Vec<Vec3> {
    let mut round = vec![path[0]];
    for corner in path.windows(3) {
        let toward = |end: Vec3| corner[1] + (end - corner[1]).normalize_or_zero() * reach;
        let (start, end) = (toward(corner[0]), toward(corner[2]));
        round.extend([start, end]);
    }
    round.push(path[path.len() - 1]);
    round
}
