//! Two ways to one shadow: outlines, from silhouettes, and receivers, from triangles.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{Affine3A, DAffine3, DVec2, DVec3, Vec3};
use umbrae_core::{Caster, Mesh, Object, Surface, SurfaceKind, Topology, shapes};
use umbrae_study::{Blockers, GroundGrid, LIFT_M, Outline, Packets, Projection, Receivers, Solids, Sun, Terrain};

fn caster(surface: Surface) -> Caster {
    let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
    let topology = Arc::new(Topology::new(&mesh));
    Caster::new(&Object::new("body", mesh, DAffine3::IDENTITY), topology)
}

/// A tower that stands in the ground, a turned house beside it, a bridge between posts, a tree and a wall.
fn quarter() -> Vec<Caster> {
    let cuboid = |min: [f32; 3], max: [f32; 3]| shapes::cuboid(min.into(), max.into());
    let house = shapes::transformed(cuboid([-6.0, -4.0, 0.0], [6.0, 4.0, 9.0]), Affine3A::from_rotation_z(0.5));
    [
        cuboid([10.0, 10.0, -4.0], [18.0, 19.0, 31.0]),
        house,
        shapes::joined([cuboid([-20.0, 12.0, 5.0], [4.0, 15.0, 5.5]), cuboid([-20.0, 13.0, 0.0], [-19.5, 14.0, 5.0])]),
        shapes::icosphere(Vec3::new(-14.0, -9.0, 4.0), 2.5, 2),
        shapes::sheet(Vec3::new(6.0, -12.0, 0.0), Vec3::new(8.0, 3.0, 0.0), 2.5 * Vec3::Z, [4, 1]),
    ]
    .map(caster)
    .to_vec()
}

#[test]
fn a_receiver_on_the_ground_is_in_shadow_exactly_where_the_outlines_say_so() {
    let casters = quarter();
    let spacing = 0.25;
    let [low, high] = [DVec2::splat(-30.0), DVec2::splat(50.0)];
    let grid = GroundGrid::covering(low, high, spacing, LIFT_M);
    let kinds: Vec<Vec<SurfaceKind>> =
        casters.iter().map(|caster| vec![SurfaceKind::Unknown; caster.mesh.triangles().len()]).collect();
    let mut receivers = Receivers::default();
    receivers.add_ground(grid, &Terrain::new(&casters, &kinds), &Solids::new(&casters, &kinds));
    let packets = Packets::new(&receivers);
    let blockers = Blockers::new(&casters);

    let ground = Projection::new(&casters, LIFT_M);
    let sections: Vec<Outline> = (0..casters.len()).map(|i| ground.section(i)).collect();
    let stands = Outline::union(&sections);
    let suns: Vec<DVec3> = [[2.0_f64, 0.5], [3.3, 0.9], [4.2, 0.6]]
        .map(|[azimuth_rad, altitude_rad]| Sun { azimuth_rad, altitude_rad }.direction(0.0))
        .to_vec();
    let some: Vec<Option<DVec3>> = suns.iter().copied().map(Some).collect();
    let exposure = blockers
        .expose(&receivers, &packets, 0..packets.len(), &some, &AtomicBool::new(false), || ())
        .expect("nobody stops it");

    for (step, &to_sun) in suns.iter().enumerate() {
        let outlines = ground.outlines(to_sun).expect("the sun is up");
        let outdoors = Outline::union(&outlines).minus(&stands).intersection(&Outline::rectangle(low, high));
        let mut dark_cells = 0;
        for packet in 0..packets.len() {
            for (lane, &receiver) in packets.members(packet).iter().enumerate() {
                let p = receivers.positions[receiver as usize].truncate();
                let is_dark = !exposure.is_lit(packet, lane, step);
                dark_cells += u32::from(is_dark);
                // What is nearer is not decided.
                if outdoors.distance_to_border_m(p) > blockers.margin_m() {
                    assert_eq!(outdoors.contains(p), is_dark, "{p}, the sun towards {to_sun}");
                }
            }
        }
        let by_cells_m2 = f64::from(dark_cells) * spacing * spacing;
        // A border has about one cell in two wrong by half a cell, to either side; the whole is far better than this.
        let resolution_m2 = border_m(&outdoors) * spacing / 2.0;
        assert!((by_cells_m2 - outdoors.area_m2()).abs() < resolution_m2, "{by_cells_m2} and {}", outdoors.area_m2());
        assert!(resolution_m2 < 0.1 * outdoors.area_m2(), "the test says something");
    }
}

fn border_m(outline: &Outline) -> f64 {
    let around =
        |ring: &[DVec2]| ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| a.distance(*b)).sum::<f64>();
    outline.rings().map(around).sum()
}
