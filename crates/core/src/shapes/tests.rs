use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{Vec2, Vec3};
use rustc_hash::FxHashMap;

use super::*;
use crate::Mesh;

/// Edges that are not walked exactly once in each direction.
fn open_edges(surface: &Surface) -> usize {
    let mut walks: FxHashMap<[u32; 2], [u32; 2]> = FxHashMap::default();
    for &[a, b, c] in &surface.triangles {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            walks.entry([p.min(q), p.max(q)]).or_default()[usize::from(p > q)] += 1;
        }
    }
    walks.values().filter(|&&walks| walks != [1, 1]).count()
}

fn corners(surface: &Surface) -> impl Iterator<Item = [DVec3; 3]> {
    surface.triangles.iter().map(|t| t.map(|i| surface.positions[i as usize].as_dvec3()))
}

fn volume(surface: &Surface) -> f64 {
    corners(surface).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Area of the shadow of a convex body on level ground.
fn shadow_area(surface: &Surface, to_sun: DVec3) -> f64 {
    corners(surface).map(|[a, b, c]| (0.5 * (b - a).cross(c - a)).dot(to_sun).max(0.0)).sum::<f64>() / to_sun.z
}

fn to_sun(azimuth_rad: f64, altitude_rad: f64) -> DVec3 {
    crate::LightPosition::sun(azimuth_rad, altitude_rad).homogeneous().truncate()
}

fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not near {expected}");
}

/// `f32` positions of bodies of a few metres.
const ROUNDING: f64 = 2e-6;

/// Closed, of this many triangles and this volume, and still all of them after welding.
fn assert_solid(surface: &Surface, triangles: usize, expected_volume: f64) {
    assert_eq!(open_edges(surface), 0, "every edge is walked once each way");
    assert_eq!(surface.triangles.len(), triangles);
    assert_near(volume(surface), expected_volume, ROUNDING);
    let mesh = Mesh::new(surface.clone()).expect("a shape is a mesh");
    assert_eq!(mesh.triangles().len(), triangles);
    assert_eq!(mesh.positions().len(), surface.positions.len(), "vertices are shared already");
}

/// Area of the regular polygon with `n` corners on the unit circle.
fn ngon_area(n: usize) -> f64 {
    0.5 * n as f64 * (TAU / n as f64).sin()
}

#[test]
fn a_box_is_closed_and_its_shadow_has_the_area_of_the_closed_form() {
    let surface = cuboid(Vec3::new(1.0, 2.0, 0.0), Vec3::new(5.0, 4.0, 10.0));
    assert_solid(&surface, 12, 80.0);
    for (azimuth, altitude) in [(0.3, 0.5_f64), (2.0, 1.2), (PI, 0.2), (5.5, 1.5)] {
        let expected = 4.0 * 2.0 + 10.0 * (4.0 * f64::cos(azimuth).abs() + 2.0 * azimuth.sin().abs()) / altitude.tan();
        assert_near(shadow_area(&surface, to_sun(azimuth, altitude)), expected, ROUNDING);
    }
}

#[test]
fn a_tetrahedron_faces_outwards_whichever_way_its_corners_are_listed() {
    let [a, b, c, d] = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::Y, 3.0 * Vec3::Z];
    assert_solid(&tetrahedron([a, b, c, d]), 4, 1.0);
    assert_solid(&tetrahedron([b, a, c, d]), 4, 1.0);
}

#[test]
fn a_cylinder_and_a_cone_have_the_volume_of_their_prism_and_pyramid() {
    let base = Vec3::new(3.0, -2.0, 0.0);
    for sides in [3, 4, 7, 64] {
        assert_solid(&cylinder(base, 1.5, 4.0, sides), 4 * sides - 4, 2.25 * 4.0 * ngon_area(sides));
        assert_solid(&cone(base, 1.5, 4.0, sides), 2 * sides - 2, 2.25 * 4.0 / 3.0 * ngon_area(sides));
    }
}

#[test]
fn a_fine_cylinder_s_shadow_is_a_disc_and_a_strip() {
    let altitude = 0.6_f64;
    let shadow = shadow_area(&cylinder(Vec3::ZERO, 1.5, 4.0, 512), to_sun(1.0, altitude));
    assert_near(shadow, PI * 1.5 * 1.5 + 2.0 * 1.5 * 4.0 / altitude.tan(), 1e-4);
}

#[test]
fn a_body_of_revolution_may_have_two_tips_and_a_waist() {
    let [low, high] = [Vec2::ZERO, Vec2::new(0.0, 6.0)];
    let profile = [low, Vec2::new(2.0, 1.0), Vec2::new(1.0, 3.0), Vec2::new(2.0, 5.0), high];
    // Frusta of heights 1, 2, 2, 1: the integral of the squared distance.
    let integral = 4.0 / 3.0 + 2.0 * 2.0 * (4.0 + 2.0 + 1.0) / 3.0 + 4.0 / 3.0;
    assert_solid(&revolution(Vec3::ZERO, &profile, 9), 9 * (1 + 2 + 2 + 1), integral * ngon_area(9));
}

#[test]
fn an_icosphere_tends_to_the_sphere_and_its_shadow_to_the_sphere_s() {
    let radius = 2.0_f64;
    let mut last_defect = f64::INFINITY;
    for subdivisions in 0..5 {
        let surface = icosphere(Vec3::new(1.0, 1.0, 5.0), 2.0, subdivisions);
        assert_eq!(open_edges(&surface), 0);
        assert_eq!(surface.triangles.len(), 20 << (2 * subdivisions));
        assert_eq!(surface.positions.len(), (10 << (2 * subdivisions)) + 2, "vertices - edges + faces = 2");
        let defect = 1.0 - volume(&surface) / (4.0 / 3.0 * PI * radius.powi(3));
        assert!(defect > 0.0 && defect < 0.4 * last_defect, "{defect} after {last_defect}");
        last_defect = defect;
        if subdivisions == 2 {
            assert!(defect < 0.046, "as documented: {defect}");
        }
    }
    let shadow = shadow_area(&icosphere(Vec3::ZERO, 2.0, 4), to_sun(0.7, 0.5));
    assert_near(shadow, PI * radius * radius / 0.5_f64.sin(), 3e-3);
}

#[test]
fn a_torus_has_the_volume_that_pappus_gives_its_polyhedron() {
    for (n, m) in [(3, 3), (12, 5), (48, 24)] {
        let expected = n as f64 * (TAU / n as f64).sin() * 3.0 * ngon_area(m) * 0.8 * 0.8;
        assert_solid(&torus(Vec3::new(0.0, 0.0, 2.0), 3.0, 0.8, n, m), 2 * n * m, expected);
    }
}

#[test]
fn a_sheet_has_a_border_and_faces_up() {
    let surface = sheet(Vec3::ZERO, 6.0 * Vec3::X, 2.0 * Vec3::Y, [3, 4]);
    assert_eq!(surface.triangles.len(), 24);
    assert_eq!(open_edges(&surface), 14);
    let area: DVec3 = corners(&surface).map(|[a, b, c]| 0.5 * (b - a).cross(c - a)).sum();
    assert!(area.distance(12.0 * DVec3::Z) < 1e-5, "{area}");
}

#[test]
fn a_prism_over_any_simple_polygon_is_closed_whichever_way_it_is_listed() {
    // A comb with a corner on a straight edge: reflex corners, and teeth that a careless ear would span.
    let teeth = |k: u8| {
        let x = 4.0 - 2.0 * f32::from(k);
        [(x + 1.0, 3.0), (x, 3.0), (x, 1.0), (x - 1.0, 1.0)].map(Vec2::from)
    };
    let base = [(0.0, 3.0), (0.0, 0.0), (2.5, 0.0), (5.0, 0.0)].map(Vec2::from);
    let mut comb = [&base[..], &teeth(0), &teeth(1), &[Vec2::new(1.0, 3.0)]].concat();
    assert_solid(&prism(&comb, -1.0, 1.0), 4 * comb.len() - 4, 22.0);
    comb.reverse();
    assert_solid(&prism(&comb, -1.0, 1.0), 4 * comb.len() - 4, 22.0);
}

#[test]
#[should_panic(expected = "crosses itself")]
fn a_prism_over_a_bow_tie_is_refused() {
    prism(&[Vec2::ZERO, Vec2::ONE, Vec2::X, 3.0 * Vec2::Y], 0.0, 1.0);
}

#[test]
fn a_strut_has_its_section_times_its_length_in_any_direction() {
    for direction in [Vec3::X, Vec3::Z, -Vec3::Z, Vec3::new(1.0, -2.0, 2.0) / 3.0, Vec3::new(0.001, 0.0, -1.0)] {
        let from = Vec3::new(0.5, 0.5, 1.0);
        let length = f64::from((7.0 * direction).length());
        for sides in [3, 4, 8] {
            let surface = strut(from, from + 7.0 * direction, 0.25, sides);
            assert_solid(&surface, 4 * sides - 4, ngon_area(sides) * 0.0625 * length);
        }
    }
}

#[test]
fn a_square_level_strut_stands_on_its_face() {
    let surface = strut(Vec3::ZERO, Vec3::new(3.0, 4.0, 0.0), 2_f32.sqrt(), 4);
    assert!(surface.positions.iter().all(|p| (p.z.abs() - 1.0).abs() < 1e-6), "{:?}", surface.positions);
}

#[test]
fn a_mitred_tube_has_its_section_times_the_length_of_its_path() {
    let path = [[0.0, 0.0, 0.0], [0.0, 0.0, 4.0], [3.0, 0.0, 4.0], [5.0, 2.0, 4.0], [5.0, 2.0, 1.0]].map(Vec3::from);
    let length = 4.0 + 3.0 + 8_f64.sqrt() + 3.0;
    assert_solid(&tube(&path, 0.3, 6), 2 * 6 * 4 + 2 * 4, ngon_area(6) * 0.09 * length);
}

#[test]
fn a_mirrored_body_still_faces_outwards() {
    let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let surface = transformed(cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)), mirror);
    assert_solid(&surface, 12, 6.0);
    let turned = transformed(surface, Affine3A::from_rotation_z(FRAC_PI_2 as f32));
    assert_near(volume(&turned), 6.0, ROUNDING);
    assert!(turned.positions.iter().all(|p| p.z >= 0.0));
}

#[test]
fn normals_stay_across_a_body_that_is_stretched_mirrored_and_joined() {
    let with_normals = |mut surface: Surface| {
        let normal = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|i| surface.positions[i as usize]);
            // Different ones, that corners can be told apart: nearly the triangle's.
            let across = (b - a).cross(c - a).normalize_or_zero();
            [across, across * 2.0, across * 3.0]
        };
        surface.corner_normals = surface.triangles.iter().map(normal).collect();
        surface
    };
    let tetrahedron = || tetrahedron([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]);
    let stretched = Affine3A::from_scale(Vec3::new(-3.0, 1.0, 0.5));
    let moved = transformed(with_normals(tetrahedron()), stretched);
    for (corners, normals) in moved.triangles.iter().zip(&moved.corner_normals) {
        let [a, b, c] = corners.map(|i| moved.positions[i as usize]);
        let across = (b - a).cross(c - a).normalize_or_zero();
        assert!(normals.iter().all(|n| n.normalize_or_zero().distance(across) < 1e-6), "{normals:?} on {across}");
        assert!((normals[1].length() / normals[0].length() - 3.0).abs() < 1e-5, "the last two corners are swapped");
    }
    let all = joined([tetrahedron(), moved, tetrahedron()]);
    let given = all.corner_normals.iter().map(|normals| normals[0] != Vec3::ZERO);
    assert_eq!(given.collect::<Vec<_>>(), [[false; 4], [true; 4], [false; 4]].concat());
}

#[test]
fn joining_completes_the_materials_that_only_one_part_has() {
    let plain = || tetrahedron([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]);
    let mut painted = plain();
    painted.triangle_materials = vec![3; 4];
    let all = joined([plain(), painted, plain()]);
    assert_eq!(all.triangle_materials, [[0; 4], [3; 4], [0; 4]].concat());
    assert!(all.vertex_colors.is_empty());
    assert_near(volume(&all), 0.5, ROUNDING);
}
