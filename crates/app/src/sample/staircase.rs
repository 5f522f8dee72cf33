//! A flight of three hundred steps, with a lamp at the top that shines down along it.
//!
//! ```text
//!                                 * lamp       The lamp hangs between the line through the noses of the
//!                             . ' |            steps and the line through their inner corners. So does the whole
//!                   nose  . ' ____|___         way from the lamp to any point of any step: it cuts every step
//!                     ._'_|          |         in between. The n-th step from the top lies in the shadow
//!               ._ ' _|   corner     |         volumes of n - 1 others, and a count of 8 bits wraps to
//!         ._ ' _|                    |         "lit" at the 257th.
//! ```
//!
//! The flight climbs towards the north. Its top is at 51 m; everything is made of closed bodies.

use glam::{DVec3, Vec2, Vec3};
use umbrae_core::{Light, LightPosition, Scene, Surface, shapes};

use super::model::{Model, Parts, block, profile};

const STEPS: u32 = 300;
const GOING: f32 = 0.3;
const RISE: f32 = 0.17;
/// Rise over going.
const SLOPE: f32 = RISE / GOING;
const HALF_WIDTH: f32 = 2.0;
/// Thickness of the flight below the inner corners of the steps, measured upright.
const THICKNESS: f32 = 0.6;
const LANDING_DEPTH: f32 = 6.0;

/// Where the last step begins, and how high it is.
const TOP: Vec2 = Vec2::new((STEPS - 1) as f32 * GOING, STEPS as f32 * RISE);

pub(super) fn scene() -> Scene {
    let mut model = Model::default();
    let stone = model.paint("limestone", [0.55, 0.51, 0.44]);
    let plaster = model.paint("white plaster", [0.72, 0.69, 0.63]);
    let concrete = model.paint("concrete", [0.40, 0.39, 0.37]);
    let iron = model.paint("iron", [0.07, 0.07, 0.08]);

    let mut steps = Parts::default();
    steps.add(stone, flight());
    model.add("steps", steps);

    let mut walls = Parts::default();
    for side in [-1.0, 1.0] {
        let (inner, outer) = (side * (HALF_WIDTH - 0.08), side * (HALF_WIDTH + 0.3));
        walls.add(plaster, profile(&parapet(), inner.min(outer), inner.max(outer)));
    }
    model.add("walls", walls);

    let mut piers = Parts::default();
    for pier in 0..7 {
        let y = 10.0 + 12.0 * pier as f32;
        // The tops end inside the flight, which is 0.6 m thick and rises 0.45 m over the depth of a pier.
        let height = SLOPE * y - 0.3;
        piers.add_all(concrete, [-1.2, 1.2].map(|x| block(Vec3::new(x, y, 0.0), Vec3::new(0.6, 0.8, height))));
    }
    let landing = block(Vec3::new(0.0, TOP.x + 3.2, 0.0), Vec3::new(3.4, 4.4, TOP.y - 0.3));
    piers.add(concrete, landing);
    model.add("piers", piers);

    let lamp = lamp_position();
    let mut post = Parts::default();
    let foot = lamp.with_z(TOP.y - 0.1);
    post.add(iron, shapes::cylinder(foot, 0.05, lamp.z - 0.06 - foot.z, 12));
    post.add(iron, shapes::cone(foot, 0.18, 0.4, 12));
    model.add("lamp", post);
    let strength = Vec3::new(300.0, 256.0, 192.0);
    model.add_light(Light::new("top", LightPosition::point(lamp.as_dvec3()), strength));
    // Onto the lowest hundred steps, the 256th from the top among them.
    model.add_camera("low steps", DVec3::new(7.0, -5.0, 16.0), DVec3::new(0.0, 13.0, 7.0), 50.0);
    model.into_scene()
}

/// 3 m behind the last nose, a third of a step below the line through the noses.
fn lamp_position() -> Vec3 {
    const BACK: f32 = 3.0;
    Vec3::new(0.0, TOP.x + BACK, TOP.y + SLOPE * BACK - RISE / 3.0)
}

/// The steps and the soffit under them, as one folded body: 12 triangles a step.
///
/// Every step is a column whose corners are those of its neighbours, so that no vertex lies within an edge.
fn flight() -> Surface {
    let soffit = |y: f32| (SLOPE * y.min(TOP.x) - THICKNESS).max(0.0);
    // Across the flight, west then east, at one place of the profile.
    let mut surface = Surface::default();
    let mut pair = |y: f32, z: f32| {
        surface.positions.extend([Vec3::new(-HALF_WIDTH, y, z), Vec3::new(HALF_WIDTH, y, z)]);
        surface.positions.len() as u32 - 2
    };
    // At every riser: the soffit below it, its foot, its nose.
    let risers: Vec<[u32; 3]> = (0..STEPS)
        .map(|i| {
            let (y, foot) = (i as f32 * GOING, i as f32 * RISE);
            [pair(y, soffit(y)), pair(y, foot), pair(y, foot + RISE)]
        })
        .collect();
    let end_y = TOP.x + LANDING_DEPTH;
    let end = [pair(end_y, soffit(end_y)), pair(end_y, TOP.y)];

    for (i, &[low, foot, nose]) in risers.iter().enumerate() {
        let (next_low, next_foot) = risers.get(i + 1).map_or((end[0], end[1]), |next| (next[0], next[1]));
        let mut quad = |a: u32, b: u32, c: u32, d: u32| surface.triangles.extend([[a, b, c], [a, c, d]]);
        quad(foot, foot + 1, nose + 1, nose);
        quad(nose, nose + 1, next_foot + 1, next_foot);
        quad(next_low, next_low + 1, low + 1, low);
        // The east side as a fan from the far lower corner, and the west side as its mirror image.
        let fan = [[next_low, next_foot, nose], [next_low, nose, foot], [next_low, foot, low]];
        // The first riser stands on the ground: its foot is the soffit's start.
        let fan = if i == 0 { &fan[..2] } else { &fan[..] };
        for &[a, b, c] in fan {
            surface.triangles.extend([[a + 1, b + 1, c + 1], [a, c, b]]);
        }
    }
    surface.triangles.extend([[end[0] + 1, end[0], end[1]], [end[0] + 1, end[1], end[1] + 1]]);
    surface
}

/// The side wall seen from the east: from below the soffit to a metre above the noses.
fn parapet() -> Vec<Vec2> {
    const BELOW: f32 = THICKNESS + 0.2;
    const ABOVE: f32 = 1.0;
    const START: f32 = -0.6;
    let (end, bottom) = (TOP.x + LANDING_DEPTH + 0.2, TOP.y - BELOW - 0.1);
    vec![
        Vec2::new(START, 0.0),
        Vec2::new(BELOW / SLOPE, 0.0),
        Vec2::new((bottom + BELOW) / SLOPE, bottom),
        Vec2::new(end, bottom),
        Vec2::new(end, TOP.y + ABOVE),
        Vec2::new(TOP.x, TOP.y + ABOVE),
        Vec2::new(START, SLOPE * START + RISE + ABOVE),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_from_the_lamp_to_the_lowest_step_cuts_every_other_step() {
        let lamp = lamp_position().as_dvec3();
        let foot = DVec3::new(0.0, 0.5 * f64::from(GOING), f64::from(RISE));
        // A tread is cut where the way passes its height above it, in front of the next riser.
        let cuts = (2..=STEPS).filter(|&step| {
            let (nose_y, z) = (f64::from((step - 1) as f32 * GOING), f64::from(step as f32 * RISE));
            let y = foot.y + (lamp.y - foot.y) * (z - foot.z) / (lamp.z - foot.z);
            let depth = if step == STEPS { LANDING_DEPTH } else { GOING };
            nose_y < y && y < nose_y + f64::from(depth)
        });
        assert_eq!(cuts.count() as u32, STEPS - 1);
    }
}
