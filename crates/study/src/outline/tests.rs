//! Outlines against closed forms, against the union of all triangles, and against rays.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3, Quat, Vec2, Vec3};
use proptest::prelude::*;
use umbrae_core::{Caster, LightPosition, Mesh, Object, RayCaster, Surface, Topology, shapes};

use super::*;

fn caster(surface: Surface) -> Caster {
    let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
    let topology = Arc::new(Topology::new(&mesh));
    Caster::new(&Object::new("body", mesh, DAffine3::IDENTITY), topology)
}

fn cuboid(min: [f32; 3], max: [f32; 3]) -> Surface {
    shapes::cuboid(min.into(), max.into())
}

fn to_sun(azimuth_rad: f64, altitude_rad: f64) -> DVec3 {
    LightPosition::sun(azimuth_rad, altitude_rad).homogeneous().truncate()
}

/// The shadow on z = 0 of one body.
fn shadow(surface: Surface, to_sun: DVec3) -> Outline {
    Projection::new(&[caster(surface)], 0.0).outline(0, to_sun).expect("the sun is up")
}

fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not near {expected}");
}

/// Every promise that [`Outline`] makes about its form.
fn assert_well_formed(outline: &Outline) {
    for polygon in &outline.polygons {
        assert!(signed_area_m2(&polygon.exterior) > 0.0, "exteriors are counter-clockwise");
        assert!(polygon.holes.iter().all(|hole| signed_area_m2(hole) < 0.0), "holes are clockwise");
        for ring in polygon.rings() {
            assert!(ring.len() >= 3, "{ring:?}");
            let mut points: Vec<[u64; 2]> = ring.iter().map(|p| [p.x, p.y].map(f64::to_bits)).collect();
            points.sort_unstable();
            points.dedup();
            assert_eq!(points.len(), ring.len(), "no ring touches itself: {ring:?}");
        }
    }
    let edges: Vec<[DVec2; 2]> = outline.rings().flat_map(ring_edges).collect();
    let side = |[a, b]: [DVec2; 2], p: DVec2| (b - a).perp_dot(p - a);
    for (i, &e) in edges.iter().enumerate() {
        for &f in &edges[i + 1..] {
            let crosses = side(e, f[0]) * side(e, f[1]) < 0.0 && side(f, e[0]) * side(f, e[1]) < 0.0;
            assert!(!crosses, "{e:?} crosses {f:?}");
        }
    }
}

/// The slow way, which shares no idea with silhouettes: each triangle cut at the plane, projected, and all united.
fn union_of_triangles(caster: &Caster, plane_z_m: f64, to_sun: DVec3) -> Outline {
    let shadows: Vec<Outline> = (0..caster.mesh.triangles().len())
        .map(|t| {
            let corners = caster.corners(t).map(Vec3::as_dvec3);
            let mut above = Vec::new();
            for (i, &p) in corners.iter().enumerate() {
                let q = corners[(i + 1) % 3];
                let [over_p, over_q] = [p, q].map(|corner| corner.z - plane_z_m);
                if over_p > 0.0 {
                    above.push(p);
                }
                if (over_p > 0.0) != (over_q > 0.0) {
                    above.push(p.lerp(q, over_p / (over_p - over_q)));
                }
            }
            let down = |p: DVec3| (p - (p.z - plane_z_m) / to_sun.z * to_sun).truncate();
            boolean::filled(&[above.into_iter().map(down).collect()])
        })
        .collect();
    Outline::union(&shadows)
}

/// Points around an outline, each inside exactly where a ray towards the sun is stopped; those nearer to its border than a micrometre aside.
fn assert_agrees_with_rays(outline: &Outline, caster: &Caster, plane_z_m: f64, to_sun: DVec3, per_side: u32) {
    let rays = RayCaster::new([(caster.positions.as_slice(), caster.mesh.triangles())]);
    let [low, high] = outline.bounds().unwrap_or([DVec2::ZERO, DVec2::ONE]);
    let margin = 0.1 * (high - low);
    let mut counts = [0; 2];
    for i in 0..per_side * per_side {
        // An irrational step, so that no row of points is on a line of the model.
        let along =
            DVec2::new(f64::from(i % per_side) + 0.5, (f64::from(i) * 0.618_033_988_75).fract() * f64::from(per_side));
        let p = low - margin + along / f64::from(per_side) * (high - low + 2.0 * margin);
        if outline.distance_to_border_m(p) > 1e-6 {
            // What lies in the plane does not stop a ray from it.
            let is_dark = rays.is_hit(p.extend(plane_z_m), to_sun, 1e-7, f64::INFINITY);
            assert_eq!(outline.contains(p), is_dark, "at {p}, the sun towards {to_sun}");
            counts[usize::from(is_dark)] += 1;
        }
    }
    assert!(outline.is_empty() || (counts[0] > 0 && counts[1] > 0), "some points are in and some out: {counts:?}");
}

fn assert_right(surface: Surface, plane_z_m: f64, to_sun: DVec3) -> f64 {
    let casters = [caster(surface)];
    let outline = Projection::new(&casters, plane_z_m).outline(0, to_sun).expect("the sun is up");
    assert_well_formed(&outline);
    let slow = union_of_triangles(&casters[0], plane_z_m, to_sun);
    assert_near(outline.area_m2(), slow.area_m2(), 1e-9);
    assert_agrees_with_rays(&outline, &casters[0], plane_z_m, to_sun, 40);
    outline.area_m2()
}

const SUNS: [[f64; 2]; 6] = [[0.3, 0.9], [1.0, 0.2], [PI, 0.5], [2.5, 0.05], [4.4, 1.4], [5.5, 0.6]];

#[test]
fn a_box_covers_its_base_and_what_its_height_sweeps() {
    for [azimuth, altitude] in SUNS {
        let area = assert_right(cuboid([2.0, -3.0, 0.0], [14.0, 5.0, 30.0]), 0.0, to_sun(azimuth, altitude));
        let swept = 30.0 / altitude.tan() * (12.0 * azimuth.cos().abs() + 8.0 * azimuth.sin().abs());
        assert_near(area, 12.0 * 8.0 + swept, 1e-8);
    }
}

#[test]
fn a_box_far_from_the_origin_and_one_of_a_decimetre_are_as_exact() {
    for (size, at) in [(0.125, 0.0), (0.125, 512.0), (8.0, 60_000.0)] {
        let (azimuth, altitude) = (0.7_f64, 0.4_f64);
        let area = shadow(cuboid([at, at, 0.0], [at + size, at + size, size]), to_sun(azimuth, altitude)).area_m2();
        let side = f64::from(size);
        let expected = side * side * (1.0 + (azimuth.cos() + azimuth.sin()) / altitude.tan());
        assert_near(area, expected, 1e-6);
    }
}

#[test]
fn a_turned_box_casts_as_the_box_under_the_sun_turned_back() {
    let turn = 0.5_f32;
    // Turning about z by the angle is an azimuth less by it, as azimuths are clockwise.
    let turned = shapes::transformed(cuboid([-6.0, -4.0, 0.0], [6.0, 4.0, 20.0]), Affine3A::from_rotation_z(turn));
    let (azimuth, altitude) = (2.2, 0.45_f64);
    let area = assert_right(turned, 0.0, to_sun(azimuth, altitude));
    let seen_by_box = azimuth + f64::from(turn);
    let swept = 20.0 / altitude.tan() * (12.0 * seen_by_box.cos().abs() + 8.0 * seen_by_box.sin().abs());
    assert_near(area, 96.0 + swept, 1e-6);
}

#[test]
fn boxes_that_overlap_count_once_whether_they_are_one_object_or_two() {
    let parts = || [cuboid([0.0, 0.0, 0.0], [10.0, 10.0, 20.0]), cuboid([5.0, 5.0, 0.0], [15.0, 15.0, 20.0])];
    let noon_at_45 = DVec3::new(0.0, -1.0, 1.0);
    // From 5 to 10 east they cover 0 to 35 north together, and elsewhere 30 each.
    let expected = 5.0 * 30.0 + 5.0 * 35.0 + 5.0 * 30.0;
    assert_near(assert_right(shapes::joined(parts()), 0.0, noon_at_45), expected, 1e-9);
    let casters = parts().map(caster);
    let each = Projection::new(&casters, 0.0).outlines(noon_at_45).expect("the sun is up");
    assert_near(Outline::union(&each).area_m2(), expected, 1e-9);
    assert_near(each[0].intersection(&each[1]).area_m2(), 5.0 * 25.0, 1e-9);
}

/// A square ring of buildings, 40 m outside and 20 m inside, as one closed body.
fn courtyard(height: f32) -> Surface {
    let outer = [[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0]];
    let inner = [[-10.0, -10.0], [10.0, -10.0], [10.0, 10.0], [-10.0, 10.0]];
    let mut surface = Surface::default();
    for z in [0.0, height] {
        surface.positions.extend(outer.iter().chain(&inner).map(|&[x, y]| Vec3::new(x, y, z)));
    }
    for i in 0..4_u32 {
        let j = (i + 1) % 4;
        // The eight corners of a quarter: outer and inner, below and above.
        let [o, p, a, b] = [i, j, i + 4, j + 4];
        let quads = [[o, p, p + 8, o + 8], [b, a, a + 8, b + 8], [o + 8, p + 8, b + 8, a + 8], [p, o, a, b]];
        surface.triangles.extend(quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]));
    }
    surface
}

#[test]
fn a_courtyard_keeps_a_lit_patch_in_its_middle_while_the_sun_is_high() {
    let sun = DVec3::new(0.0, -1.0, 2.0);
    let outline = shadow(courtyard(10.0), sun);
    assert_eq!((outline.polygons.len(), outline.polygons[0].holes.len()), (1, 1));
    // The south wing reaches 5 m into a yard of 20.
    assert_near(-signed_area_m2(&outline.polygons[0].holes[0]), 20.0 * 15.0, 1e-9);
    assert_near(assert_right(courtyard(10.0), 0.0, sun), 40.0 * 45.0 - 20.0 * 15.0, 1e-9);
    assert!(!outline.contains(DVec2::ZERO) && outline.contains(DVec2::new(0.0, -8.0)));

    let low = shadow(courtyard(10.0), DVec3::new(0.0, -1.0, 0.4));
    assert!(low.polygons[0].holes.is_empty(), "a low sun does not reach the yard");
    let stands = Projection::new(&[caster(courtyard(10.0))], 0.0).section(0);
    assert_eq!(stands.area_m2(), 1200.0, "the yard is not a part of the building");
    // What is beside the building of its shadow: the yard's strip, and that to the north.
    assert_near(outline.minus(&stands).area_m2(), 20.0 * 5.0 + 40.0 * 5.0, 1e-9);
}

#[test]
fn a_floating_slab_s_shadow_has_the_slab_s_form_and_leaves_the_ground_below_it_lit() {
    let slab = || cuboid([0.0, 0.0, 20.0], [8.0, 4.0, 20.25]);
    let sun = DVec3::new(0.0, -1.0, 1.0);
    assert_near(assert_right(slab(), 0.0, sun), 8.0 * 4.25, 1e-9);
    let outline = shadow(slab(), sun);
    assert_eq!(outline.bounds(), Some([DVec2::new(0.0, 20.0), DVec2::new(8.0, 24.25)]));
    let casters = [caster(slab())];
    let ground = Projection::new(&casters, 0.0);
    assert!(ground.section(0).is_empty());
    assert_eq!(ground.plan(0).area_m2(), 32.0);
}

#[test]
fn an_open_sheet_casts_from_both_sides_and_a_sheet_in_the_sun_s_plane_not_at_all() {
    let wall = |cells| shapes::sheet(Vec3::ZERO, 10.0 * Vec3::X, 6.0 * Vec3::Z, cells);
    for [azimuth, altitude] in SUNS {
        let area = assert_right(wall([3, 2]), 0.0, to_sun(azimuth, altitude));
        assert_near(area, 60.0 * azimuth.cos().abs() / altitude.tan(), 1e-6);
    }
    assert!(shadow(wall([3, 2]), DVec3::new(1.0, 0.0, 1.0)).is_empty());
    let flat = shapes::sheet(Vec3::new(0.0, 0.0, 5.0), 10.0 * Vec3::X, 6.0 * Vec3::Y, [2, 2]);
    assert_near(assert_right(flat.clone(), 0.0, to_sun(2.0, 0.3)), 60.0, 1e-9);
    assert_eq!(shadow(flat, DVec3::Z).bounds(), Some([DVec2::ZERO, DVec2::new(10.0, 6.0)]));
}

#[test]
fn what_lies_in_the_plane_casts_nothing() {
    let ground = shapes::sheet(Vec3::ZERO, 100.0 * Vec3::X, 100.0 * Vec3::Y, [4, 4]);
    assert!(shadow(ground.clone(), to_sun(1.0, 0.5)).is_empty());
    let with_house = shapes::joined([ground, cuboid([10.0, 10.0, 0.0], [20.0, 20.0, 10.0])]);
    let alone = shadow(cuboid([10.0, 10.0, 0.0], [20.0, 20.0, 10.0]), to_sun(1.0, 0.5));
    assert_near(assert_right(with_house, 0.0, to_sun(1.0, 0.5)), alone.area_m2(), 1e-9);
    assert!(shadow(cuboid([0.0, 0.0, -9.0], [5.0, 5.0, 0.0]), to_sun(1.0, 0.5)).is_empty(), "a cellar");
}

#[test]
fn a_post_s_shadow_is_as_long_as_the_cotangent_says_even_from_a_sun_on_the_horizon() {
    for altitude_rad in [0.8_f64, 0.1, 0.01, 1e-4, 1e-5] {
        let sun = to_sun(PI, altitude_rad);
        let area = shadow(cuboid([0.0, 0.0, 0.0], [0.125, 0.125, 4.0]), sun).area_m2();
        assert_near(area, 0.125 * (0.125 + 4.0 / altitude_rad.tan()), 1e-6);
    }
    let post = [caster(cuboid([0.0, 0.0, 0.0], [0.125, 0.125, 4.0]))];
    let ground = Projection::new(&post, 0.0);
    for night in [to_sun(1.0, 0.0), to_sun(1.0, -0.2), to_sun(1.0, 1e-9), DVec3::ZERO, DVec3::NAN] {
        assert_eq!(ground.outline(0, night), None, "{night}");
    }
}

#[test]
fn a_prism_of_64_sides_casts_its_section_swept_over_its_width() {
    let corners = |i: u8| Vec2::from_angle(TAU as f32 * f32::from(i) / 64.0) * 5.0;
    let section: Vec<Vec2> = (0..64).map(corners).collect();
    let altitude = 0.5_f64;
    let sun = to_sun(0.7, altitude);
    let area = assert_right(shapes::prism(&section, 0.0, 12.0), 0.0, sun);
    let across = sun.truncate().perp() / sun.truncate().length();
    let offsets = || section.iter().map(|corner| corner.as_dvec2().dot(across));
    let width = offsets().fold(f64::MIN, f64::max) - offsets().fold(f64::MAX, f64::min);
    let corners: Vec<DVec2> = section.iter().map(|corner| corner.as_dvec2()).collect();
    assert_near(area, signed_area_m2(&corners) + width * 12.0 / altitude.tan(), 1e-8);
}

#[test]
fn what_reaches_below_the_plane_is_cut_there() {
    for plane in [-1.0, 0.0, 2.0, 7.5, 10.0] {
        let high = cuboid([0.0, 0.0, -3.0], [4.0, 6.0, 10.0]);
        let area = assert_right(high.clone(), plane, DVec3::new(0.0, -1.0, 1.0));
        assert_eq!(area, if plane < 10.0 { 4.0 * (6.0 + 10.0 - plane) } else { 0.0 }, "at {plane}");
        let section = Projection::new(&[caster(high)], plane).section(0).area_m2();
        assert_eq!(section, if plane < 10.0 { 24.0 } else { 0.0 }, "at {plane}");
    }
}

#[test]
fn bodies_turned_inside_out_cast_as_others_do_standing_floating_and_sunk() {
    for base in [-3.0, 0.0, 2.0] {
        let mut body = cuboid([0.0, 0.0, base], [4.0, 6.0, base + 10.0]);
        let right = assert_right(body.clone(), 0.0, to_sun(0.4, 0.3));
        body.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        assert_near(assert_right(body, 0.0, to_sun(0.4, 0.3)), right, 1e-9);
    }
}

#[test]
fn rings_balls_and_bars_in_any_attitude_agree_with_rays() {
    let turn = Affine3A::from_rotation_translation(Quat::from_euler(glam::EulerRot::XYZ, 0.4, 0.9, 0.2), Vec3::Z * 4.0);
    let bodies = [
        shapes::torus(Vec3::ZERO, 3.0, 0.75, 24, 12),
        shapes::icosphere(Vec3::ZERO, 3.0, 2),
        shapes::joined((0..6_u8).map(|i| {
            let a = f32::from(i);
            shapes::strut(Vec3::new(a, a.sin(), -4.0), Vec3::new(-a, a.cos() * 3.0, 5.0), 0.2, 4)
        })),
    ];
    for body in bodies {
        for [azimuth, altitude] in SUNS {
            // Once above the plane, once cut by it.
            assert_right(shapes::transformed(body.clone(), turn), -9.0, to_sun(azimuth, altitude));
            assert_right(shapes::transformed(body.clone(), turn), 4.25, to_sun(azimuth, altitude));
        }
    }
}

#[test]
fn many_bodies_in_one_object_keep_the_holes_of_each() {
    // Each hole's border is a loop of its own, which alone would be filled.
    let pair = |i: u8| {
        let at = Vec3::new(50.0 * f32::from(i % 6), 50.0 * f32::from(i / 6), 0.0);
        let corner = at + Vec3::new(20.0, 20.0, 10.0);
        let ring = shapes::transformed(courtyard(10.0), Affine3A::from_translation(at));
        shapes::joined([ring, shapes::cuboid(corner, corner + 2.0)])
    };
    let many = caster(shapes::joined((0..36).map(pair)));
    let sun = DVec3::new(0.0, -1.0, 2.0);
    let outline = Projection::new(std::slice::from_ref(&many), 0.0).outline(0, sun).expect("the sun is up");
    assert_well_formed(&outline);
    assert_eq!(outline.polygons.iter().map(|polygon| polygon.holes.len()).sum::<usize>(), 36);
    assert_near(outline.area_m2(), union_of_triangles(&many, 0.0, sun).area_m2(), 1e-9);
    assert_agrees_with_rays(&outline, &many, 0.0, sun, 100);
}

#[test]
fn net_new_shadow_is_what_only_the_proposal_casts() {
    let sun = DVec3::new(0.0, -1.0, 1.0);
    let existing = shadow(cuboid([0.0, 0.0, 0.0], [10.0, 10.0, 10.0]), sun);
    let proposed = shadow(cuboid([0.0, 0.0, 0.0], [10.0, 10.0, 25.0]), sun);
    let new = proposed.minus(&existing);
    assert_eq!(new.bounds(), Some([DVec2::new(0.0, 20.0), DVec2::new(10.0, 35.0)]));
    assert_eq!(new.area_m2(), 150.0);
    assert!(existing.minus(&proposed).is_empty());
    assert!(proposed.minus(&proposed).is_empty());
}

#[test]
fn slivers_between_neighbours_that_should_touch_are_not_reported() {
    let gap = 1e-7;
    let left =
        boolean::filled(&[vec![DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::new(10.0, 10.0), DVec2::new(0.0, 10.0)]]);
    let shape = |inset: f64| {
        let far = [DVec2::new(20.0, 0.0), DVec2::new(20.0, 10.0), DVec2::new(10.0, 10.0)];
        let notch =
            [DVec2::new(10.0, 8.0), DVec2::new(10.0 + inset, 5.0), DVec2::new(10.0, 2.0), DVec2::new(10.0, 0.0)];
        boolean::filled(&[[&far[..], &notch[..]].concat()])
    };
    let together = Outline::union([&left, &shape(gap)]);
    assert_eq!((together.polygons.len(), together.polygons[0].holes.len()), (1, 0));
    let with_gap = Outline::union([&left, &shape(1e-3)]);
    assert_eq!(with_gap.polygons[0].holes.len(), 1, "a millimetre is no rounding");
    assert!(shape(1e-3).minus(&shape(gap)).is_empty());
    assert!(!left.minus(&Outline::rectangle(DVec2::ZERO, DVec2::new(10.0, 9.999))).is_empty());
}

#[test]
fn a_hole_that_touches_the_outside_in_a_corner_is_a_hole() {
    // Nine cells without that in the middle and one in a corner.
    let cells = (0..9_u8).filter(|&i| i != 4 && i != 8).map(|i| {
        let low = DVec2::new(f64::from(i % 3), f64::from(i / 3));
        Outline::rectangle(low, low + 1.0)
    });
    let outline = Outline::union(&cells.collect::<Vec<_>>());
    assert_well_formed(&outline);
    assert_eq!((outline.polygons.len(), outline.polygons[0].holes.len(), outline.area_m2()), (1, 1, 7.0));
}

#[test]
fn an_island_in_a_hole_that_is_a_sliver_is_not_counted_twice() {
    let ring = |corners: &[[f64; 2]]| -> Vec<DVec2> { corners.iter().map(|&p| DVec2::from(p)).collect() };
    let ground = ring(&[[-1.0, -1.0], [11.0, -1.0], [11.0, 1.0], [-1.0, 1.0]]);
    // Ten metres long and a ten-thousandth of a millimetre wide, with a widening of a millimetre in which the island is.
    let hole = ring(&[[0.0, 0.0], [5.0, 1e-7], [5.0, 1e-3], [5.001, 1e-3], [5.001, 1e-7], [10.0, 0.0]]);
    let island = ring(&[[5.0002, 2e-4], [5.0008, 2e-4], [5.0008, 8e-4], [5.0002, 8e-4]]);
    let outline = boolean::filled(&[ground, hole, island]);
    assert_eq!(outline, Outline::rectangle(DVec2::new(-1.0, -1.0), DVec2::new(11.0, 1.0)));
}

#[test]
fn on_a_grid_all_corners_are_whole_multiples_and_the_outline_stays_well_formed() {
    let surface = shapes::torus(Vec3::new(0.0, 0.0, 5.0), 3.0, 0.75, 24, 12);
    let fine = shadow(surface, to_sun(0.3, 0.5));
    let grid_m = 0.0625;
    let coarse = fine.on_grid(grid_m);
    assert_well_formed(&coarse);
    assert!(coarse.rings().flatten().all(|p| (*p / grid_m).fract() == DVec2::ZERO));
    assert_near(coarse.area_m2(), fine.area_m2(), 0.02);
    assert_eq!(fine.on_grid(1e-12), fine, "what is on the finest grid stays");
}

fn soup() -> impl Strategy<Value = Surface> {
    let positions = prop::collection::vec([-4.0_f32..4.0, -4.0_f32..4.0, -2.0_f32..6.0].prop_map(Vec3::from), 12);
    let triangles = prop::collection::vec([0_u32..12, 0_u32..12, 0_u32..12], 1..24);
    (positions, triangles).prop_map(|(positions, triangles)| Surface { positions, triangles, ..Surface::default() })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Shared vertices with any windings, fans and borders, above, below and through the plane.
    #[test]
    fn any_soup_of_triangles_casts_what_rays_say(surface in soup(), azimuth in 0.0..TAU, altitude in 0.1_f64..1.5) {
        prop_assume!(Mesh::new(surface.clone()).is_ok());
        assert_right(surface.clone(), 0.0, to_sun(azimuth, altitude));
        assert_right(surface, -2.5, to_sun(azimuth, altitude));
    }

    /// Wherever a point is, it is covered by the union, the difference and the intersection as by the two it is of.
    #[test]
    fn operations_on_outlines_are_those_on_sets(a in soup(), b in soup(), points in prop::collection::vec([-9.0..9.0, -9.0..9.0], 64)) {
        prop_assume!(Mesh::new(a.clone()).is_ok() && Mesh::new(b.clone()).is_ok());
        let [a, b] = [a, b].map(|surface| shadow(surface, to_sun(1.0, 0.8)));
        let (either, only_a, both) = (Outline::union([&a, &b]), a.minus(&b), a.intersection(&b));
        for outline in [&either, &only_a, &both] {
            assert_well_formed(outline);
        }
        for p in points.into_iter().map(DVec2::from) {
            if a.distance_to_border_m(p).min(b.distance_to_border_m(p)) > 1e-6 {
                let [in_a, in_b] = [&a, &b].map(|outline| outline.contains(p));
                prop_assert_eq!(either.contains(p), in_a || in_b);
                prop_assert_eq!(only_a.contains(p), in_a && !in_b);
                prop_assert_eq!(both.contains(p), in_a && in_b);
            }
        }
        prop_assert!((either.area_m2() + both.area_m2() - a.area_m2() - b.area_m2()).abs() < 1e-6 * either.area_m2().max(1.0));
    }
}
