//! A tower of 51 floors whose oval plan turns as it rises, inside a net of struts.
//!
//! Wallner 2007, figure 7, after a proposal of Hans Hollein's: one object for each structural component, so that each
//! can be let cast alone. The facade has no glass: spandrels, mullions and transoms, and the sun shines in between.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec2, Vec3};
use umbrae_core::{Scene, Surface, shapes};

use super::model::{Model, Parts, block};

const FLOORS: u32 = 51;
const FLOOR_HEIGHT: f64 = 3.7;
/// Height of the entrance hall, which has no facade.
const HALL: f64 = 7.0;
const TOP: f64 = 200.0;
/// Where leaning columns and struts begin, inside the podium.
const FOOT: f64 = 0.3;
/// Parts of the facade around a floor.
const BAYS: u32 = 72;
const COLUMNS: u32 = 24;
/// Struts that wind each way.
const STRANDS: u32 = 17;
const STRAND_PIECES: u32 = 44;

pub(super) fn scene() -> Scene {
    let mut model = Model::default();
    let concrete = model.paint("concrete", [0.43, 0.42, 0.40]);
    let slab = model.paint("slab", [0.56, 0.55, 0.53]);
    let glass = model.paint("blue panel", [0.12, 0.22, 0.34]);
    let aluminium = model.paint("aluminium", [0.50, 0.53, 0.56]);
    let steel = model.paint("warm steel", [0.62, 0.40, 0.16]);

    let mut structure = Parts::default();
    structure.add_all(concrete, core());
    structure.add(concrete, podium());
    structure.add_all(concrete, (0..COLUMNS).map(column));
    model.add("concrete", structure);

    let mut slabs = Parts::default();
    slabs.add_all(slab, (0..=FLOORS).map(floor_slab));
    model.add("slabs", slabs);

    let mut facade = Parts::default();
    for floor in 0..FLOORS {
        for bay in 0..BAYS {
            facade.add(
                glass,
                bay_block(floor, [f64::from(bay) + 0.03, f64::from(bay) + 0.97], [-0.12, 0.0], [-0.55, 0.9]),
            );
            facade.add(
                aluminium,
                bay_block(floor, [f64::from(bay) - 0.045, f64::from(bay) + 0.045], [-0.22, 0.28], [-0.5, 3.1]),
            );
            facade.add(
                aluminium,
                bay_block(floor, [f64::from(bay) + 0.02, f64::from(bay) + 0.98], [-0.18, 0.08], [2.6, 2.75]),
            );
        }
    }
    model.add("facade", facade);

    let mut diagrid = Parts::default();
    for strand in 0..STRANDS {
        diagrid.add(steel, winding_strut(strand, 0.62, 0.42));
        diagrid.add(steel, winding_strut(strand, -0.48, 0.38));
    }
    diagrid.add_all(steel, crown());
    model.add("diagrid", diagrid);
    model.into_scene()
}

/// Height of the walking surface of a floor above the ground.
fn floor_level(floor: u32) -> f64 {
    HALL + FLOOR_HEIGHT * f64::from(floor)
}

/// A point of the tower's skin, `turn` (0 to 1) of the way around and `out` metres outside.
///
/// The plan is an oval, two thirds longer than it is wide; it turns by a sixth of a circle, and swells a little
/// below the middle.
fn skin(turn: f64, z: f64, out: f64) -> DVec3 {
    let share = z / TOP;
    let size = 0.86 + 0.16 * (TAU * 0.5 * (0.12 + 0.88 * share)).sin() - 0.1 * share * share;
    let angle = TAU * turn;
    let oval = DVec2::new(25.0 * angle.cos(), 15.0 * angle.sin()) * size;
    let normal = DVec2::new(15.0 * angle.cos(), 25.0 * angle.sin()).normalize_or_zero();
    DVec2::from_angle(TAU / 6.0 * share).rotate(oval + out * normal).extend(z)
}

/// A box in the coordinates of the skin: from bay to bay, from inside to outside, from height to height over the floor.
fn bay_block(floor: u32, bays: [f64; 2], out: [f64; 2], above: [f64; 2]) -> Surface {
    let outline = |above: f64| {
        let at = |bay: f64, out: f64| skin(bay / f64::from(BAYS), floor_level(floor) + above, out);
        vec![at(bays[0], out[0]), at(bays[0], out[1]), at(bays[1], out[1]), at(bays[1], out[0])]
    };
    shapes::loft(&above.map(outline))
}

/// The slab on which floor `floor` stands, or the roof.
fn floor_slab(floor: u32) -> Surface {
    const THICKNESS: f64 = 0.32;
    let level = floor_level(floor);
    let outline = |z: f64| (0..BAYS).map(|i| skin(f64::from(i) / f64::from(BAYS), level, -0.05).with_z(z)).collect();
    shapes::loft(&[outline(level - THICKNESS), outline(level)])
}

/// The step on which everything stands.
fn podium() -> Surface {
    let outline = |z: f64| (0..BAYS).map(|i| skin(f64::from(i) / f64::from(BAYS), 0.0, 2.6).with_z(z)).collect();
    shapes::loft(&[outline(0.0), outline(0.45)])
}

/// Walls around the lifts, up to above the roof, with a plant room on top.
fn core() -> Vec<Surface> {
    let roof = floor_level(FLOORS) as f32;
    let size = |x: f32, y: f32, top: f32| Vec3::new(x, y, top);
    vec![
        block(Vec3::new(0.0, 0.0, 0.0), size(15.0, 9.0, roof + 3.4)),
        block(Vec3::new(-4.2, 0.0, 0.0), size(3.0, 11.4, roof + 2.2)),
        block(Vec3::new(4.2, 0.0, 0.0), size(3.0, 11.4, roof + 2.2)),
        shapes::prism(
            &[(-5.0, -3.0), (5.0, -3.0), (6.0, 0.0), (5.0, 3.0), (-5.0, 3.0), (-6.0, 0.0)].map(Vec2::from),
            roof - 1.0,
            roof + 5.2,
        ),
    ]
}

/// A round column that follows the skin, 2 m inside it, from the podium to under the roof.
fn column(index: u32) -> Surface {
    let turn = (f64::from(index) + 0.5) / f64::from(COLUMNS);
    let foot = skin(turn, FOOT, -2.0);
    let path: Vec<Vec3> = std::iter::once(foot)
        .chain((0..=FLOORS).map(|floor| skin(turn, floor_level(floor) - 0.1, -2.0)))
        .map(DVec3::as_vec3)
        .collect();
    shapes::tube(&path, 0.42, 6)
}

/// The ring that holds the heads of the winding struts, in two halves that end inside each other.
fn crown() -> [Surface; 2] {
    const PIECES: u32 = 36;
    [(0.0, 0.46), (0.5, 0.49)].map(|(start, radius)| {
        let path: Vec<Vec3> = (0..=PIECES + 1)
            .map(|i| skin(start + 0.5 * f64::from(i) / f64::from(PIECES), TOP, 1.5).as_vec3())
            .collect();
        shapes::tube(&path, radius, 6)
    })
}

/// A strut that winds around the tower, `turns` times on its way to the top.
fn winding_strut(strand: u32, turns: f64, radius: f32) -> Surface {
    let path: Vec<Vec3> = (0..=STRAND_PIECES)
        .map(|i| {
            let share = f64::from(i) / f64::from(STRAND_PIECES);
            skin(f64::from(strand) / f64::from(STRANDS) + turns * share, FOOT + (TOP - FOOT) * share, 1.5).as_vec3()
        })
        .collect();
    shapes::tube(&path, radius, 6)
}
