//! Every finder finds what the chain's boundary is, and the two ways of doing many at once give the same bits.

mod saved;

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};

use super::faces::WORD;
use super::packets::{PLANES_AT_ONCE, Packet};
use super::simd::{self, CHILDREN};
use super::*;
use crate::{Caster, Counting, LightPosition, Mesh, Object, Surface, shapes};

/// `SplitMix64`.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// From -1 to 1.
    fn signed(&mut self) -> f64 {
        self.bits() as i64 as f64 / i64::MAX as f64
    }

    fn direction(&mut self) -> DVec3 {
        let v = DVec3::new(self.signed(), self.signed(), self.signed());
        v.normalize_or(DVec3::X)
    }
}

fn caster(surface: Surface) -> Caster {
    let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
    let topology = Arc::new(Topology::new(&mesh));
    Caster::new(&Object::new("it", mesh, DAffine3::IDENTITY), topology)
}

/// Triangles between shared vertices on a small lattice: fans, borders, folds, flat faces and wrong windings, all at once.
fn soup(random: &mut Random, triangles: usize) -> Option<Caster> {
    let vertices = 4 + triangles / 2;
    let positions = (0..vertices).map(|_| Vec3::from_array([(); 3].map(|()| random.below(5) as f32 - 2.0))).collect();
    let triangles = (0..triangles).map(|_| [(); 3].map(|()| random.below(vertices) as u32)).collect();
    let mesh = Arc::new(Mesh::new(Surface { positions, triangles, ..Surface::default() }).ok()?);
    let topology = Arc::new(Topology::new(&mesh));
    Some(Caster::new(&Object::new("soup", mesh, DAffine3::IDENTITY), topology))
}

/// A bumpy ball of `segments` times twice as many quads.
fn ball(segments: u32, bump: f32) -> Caster {
    let (rows, columns) = (segments, 2 * segments);
    let mut positions = vec![Vec3::Z, Vec3::NEG_Z];
    for row in 1..rows {
        for column in 0..columns {
            let (s, c) = (row as f32 / rows as f32 * std::f32::consts::PI).sin_cos();
            let (y, x) = (column as f32 / columns as f32 * std::f32::consts::TAU).sin_cos();
            let radius = 1.0 + bump * ((row * 7 + column * 13) % 5) as f32;
            positions.push(radius * Vec3::new(s * x, s * y, c));
        }
    }
    let at = |row: u32, column: u32| match row {
        0 => 0,
        row if row == rows => 1,
        row => 2 + (row - 1) * columns + column % columns,
    };
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [d, c] = [at(row + 1, column), at(row + 1, column + 1)];
            triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    caster(Surface { positions, triangles, ..Surface::default() })
}

/// Far and near, inside, in the planes of axis-parallel faces, and suns.
fn lights(random: &mut Random, count: usize) -> Vec<LightPosition> {
    (0..count)
        .map(|i| {
            let d = random.direction();
            match i % 6 {
                0 => LightPosition::directional(d).expect("not zero"),
                1 => LightPosition::directional(DVec3::AXES[i / 6 % 3]).expect("not zero"),
                2 => LightPosition::point(1e5 * d),
                3 => LightPosition::point(3.0 * d),
                4 => LightPosition::point((2.0 * d).round()),
                _ => LightPosition::point(0.5 * d),
            }
        })
        .collect()
}

fn sorted(sides: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let mut sides = sides.to_vec();
    sides.sort_unstable();
    sides
}

/// What the chain's boundary is, by the topology alone.
fn boundary(finder: &Finder, caster: &Caster, light: LightPosition, counting: &[Counting]) -> Vec<[u32; 2]> {
    let edges = silhouette(&caster.topology, &finder.chain(light, counting));
    let repeat = |e: &SilhouetteEdge| std::iter::repeat_n([e.start, e.end], e.multiplicity as usize);
    sorted(&edges.iter().flat_map(repeat).collect::<Vec<_>>())
}

/// Returns how many edges there were.
fn assert_all_find_the_boundary(caster: &Caster, lights: &[LightPosition]) -> usize {
    let outside = Counting::outside(caster);
    let finders = FinderKind::ALL.map(|kind| Finder::new(caster, kind));
    let mut founds = FinderKind::ALL.map(|_| Found::default());
    let mut edges = 0;
    for &light in lights {
        let expected = boundary(&finders[0], caster, light, &outside);
        edges += expected.len();
        for (finder, found) in finders.iter().zip(&mut founds) {
            finder.find(light, found);
            assert_eq!(sorted(&found.sides), expected, "{} under {light:?}", finder.kind().name());
        }
    }
    let mut together = vec![Found::default(); lights.len()];
    finders[1].find_all(lights, &mut together);
    for (&light, found) in lights.iter().zip(&together) {
        assert_eq!(sorted(&found.sides), boundary(&finders[1], caster, light, &outside), "in one pass, {light:?}");
    }
    edges
}

#[test]
fn every_finder_finds_the_boundary_of_the_chain_of_any_soup() {
    let mut random = Random(1);
    let mut edges = 0;
    for i in 0..300 {
        let triangles = 1 + random.below(if i % 10 == 0 { 400 } else { 30 });
        if let Some(soup) = soup(&mut random, triangles) {
            let lights = lights(&mut random, 24);
            edges += assert_all_find_the_boundary(&soup, &lights);
        }
    }
    assert!(edges > 100_000, "soups have silhouettes: {edges}");
}

#[test]
fn every_finder_finds_the_boundary_on_bodies_with_nodes_upon_nodes() {
    let mut random = Random(2);
    for bump in [0.0, 0.02] {
        let ball = ball(60, bump);
        assert!(assert_all_find_the_boundary(&ball, &lights(&mut random, 24)) > 0);
    }
}

#[test]
fn a_boundary_has_no_boundary_whatever_the_light() {
    let mut random = Random(3);
    let soup = soup(&mut random, 200).expect("a soup of 200 triangles has one with area");
    let finder = Finder::new(&soup, FinderKind::Dual);
    let mut found = Found::default();
    for light in lights(&mut random, 64) {
        finder.find(light, &mut found);
        let mut surplus = vec![0; soup.positions.len()];
        for &[start, end] in &found.sides {
            surplus[start as usize] += 1;
            surplus[end as usize] -= 1;
        }
        assert!(surplus.iter().all(|&s| s == 0), "as many edges leave each vertex as arrive, {light:?}");
    }
}

#[test]
fn a_light_that_moves_a_little_is_followed_and_one_that_jumps_is_found() {
    let ball = ball(40, 0.02);
    let [coherent, scan] = [FinderKind::Coherent, FinderKind::Scan].map(|kind| Finder::new(&ball, kind));
    let [mut followed, mut found] = [Found::default(), Found::default()];
    let mut random = Random(4);
    let mut least_tested = usize::MAX;
    for step in 0..400 {
        let (y, x) = (0.004 * f64::from(step)).sin_cos();
        let light = match step {
            0..200 => LightPosition::directional(DVec3::new(x, y, 0.5)).expect("not zero"),
            200..300 => LightPosition::point(1.5 * DVec3::new(x, y, 0.2)),
            _ => LightPosition::point(3.0 * random.direction()),
        };
        coherent.find(light, &mut followed);
        scan.find(light, &mut found);
        assert_eq!(sorted(&followed.sides), sorted(&found.sides), "step {step}");
        least_tested = least_tested.min(followed.tested);
    }
    assert!(least_tested < scan.edge_count() / 50, "small steps look at few edges: {least_tested}");
}

#[test]
fn what_was_found_for_one_caster_does_not_spoil_another() {
    let casters = [ball(10, 0.0), ball(10, 0.05)];
    let finders = casters.each_ref().map(|caster| Finder::new(caster, FinderKind::Coherent));
    let light = LightPosition::point(DVec3::new(2.0, 1.0, 3.0));
    let mut found = Found::default();
    for i in [0, 1, 0, 1] {
        finders[i].find(light, &mut found);
        let expected = boundary(&finders[i], &casters[i], light, &Counting::outside(&casters[i]));
        assert_eq!(sorted(&found.sides), expected);
    }
}

#[test]
fn however_components_count_the_sides_are_the_boundary_of_the_chain() {
    let mut random = Random(5);
    for _ in 0..100 {
        let Some(soup) = soup(&mut random, 60) else { continue };
        let components = soup.topology.components();
        let modes = [Counting::Facing, Counting::FacingAway, Counting::Every];
        let of = |is_closed, random: &mut Random| if is_closed { modes[random.below(3)] } else { Counting::Every };
        let counting: Vec<Counting> = components.iter().map(|c| of(c.is_closed, &mut random)).collect();
        for kind in FinderKind::ALL {
            let finder = Finder::new(&soup, kind);
            let mut found = Found::default();
            for light in lights(&mut random, 6) {
                finder.find_counted(light, &counting, &mut found);
                assert_eq!(sorted(&found.sides), boundary(&finder, &soup, light, &counting), "{}", kind.name());
            }
        }
    }
}

#[test]
fn a_box_has_six_faces_and_twelve_edges_whatever_its_diagonals() {
    let finder = Finder::new(&caster(shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 20.0, 30.0))), FinderKind::Scan);
    assert_eq!((finder.face_count(), finder.edge_count()), (6, 12));
}

#[test]
fn faces_that_are_bent_are_not_taken_for_flat_however_finely() {
    let fine = ball(200, 0.0);
    let finder = Finder::new(&fine, FinderKind::Scan);
    // Quads of a ball between two circles of latitude are flat, and those at the poles are so narrow that rounding hides their bend.
    let (faces, quads) = (finder.face_count(), 200 * 400);
    assert!(faces >= quads - 3 * 400, "{faces} faces of {quads} quads");
}

#[test]
fn coefficients_differ_from_those_of_exact_corners_only_for_faces_that_are_edge_on() {
    let mut random = Random(6);
    let ball = ball(50, 0.02);
    let finder = Finder::new(&ball, FinderKind::Scan);
    let outside = Counting::outside(&ball);
    for light in lights(&mut random, 64) {
        let chain = finder.chain(light, &outside);
        let exact = Chain::new(&ball, light, &outside);
        for (t, (c, e)) in chain.coefficients().iter().zip(exact.coefficients()).enumerate() {
            let [a, b, d] = ball.corners(t).map(Vec3::as_dvec3);
            let offset = light.offset_from(a);
            let cosine = (b - a).cross(d - a).normalize_or_zero().dot(offset.normalize_or_zero());
            assert!(c == e || cosine.abs() < 2e-6, "triangle {t} under {light:?} with cosine {cosine}");
        }
    }
}

#[test]
fn with_and_without_avx2_the_bits_are_the_same() {
    let mut random = Random(7);
    let mut some = |len: usize| (0..len).map(|_| (random.signed() as f32 * 4.0).round() / 4.0).collect::<Vec<f32>>();
    for edge_on in [None, Some(0.25)] {
        let planes = [(); 4].map(|()| some(4 * WORD));
        let planes = planes.each_ref().map(Vec::as_slice);
        let light = *some(4).first_chunk().expect("four were asked for");
        let mut both = [(); 2].map(|()| vec![0; 4 * WORD]);
        simd::coefficients(planes, light, edge_on, &mut both[0]);
        simd::plain::coefficients(planes, light, edge_on, &mut both[1]);
        assert_eq!(both[0], both[1]);
        assert!(both[0].contains(&1) && both[0].contains(&0) && both[0].contains(&-1) == edge_on.is_some());
    }
    for edge_on in [None, Some(0.25)] {
        let mut corners = || [(); 4].map(|()| *some(CHILDREN).first_chunk::<CHILDREN>().expect("as many"));
        let (lowest, highest) = (corners(), corners());
        let light = [0.5, -0.25, 1.0, -0.75];
        let both =
            [simd::sides, simd::plain::sides].map(|sides| sides(lowest.each_ref(), highest.each_ref(), light, edge_on));
        assert_eq!(both[0], both[1]);
        assert!(both[0].iter().all(|&mask| mask != 0 && mask != u16::MAX), "some are, some are not");
    }
}

#[test]
fn edges_of_a_wall_of_bricks_are_found_many_at_a_time() {
    let bricks = (0..40_u32).flat_map(|i| (0..40_u32).map(move |j| Vec3::new(2.0 * i as f32, 0.0, 2.0 * j as f32)));
    let mut wall = Surface::default();
    for corner in bricks {
        let brick = shapes::cuboid(corner, corner + Vec3::ONE);
        let first = wall.positions.len() as u32;
        wall.positions.extend(&brick.positions);
        wall.triangles.extend(brick.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let wall = caster(wall);
    let finder = Finder::new(&wall, FinderKind::Dual);
    let mut found = Found::default();
    let sun = LightPosition::directional(DVec3::new(0.3, -1.0, 0.7)).expect("not zero");
    finder.find(sun, &mut found);
    assert_eq!(found.sides.len(), 6 * 40 * 40, "each brick is seen from beside a corner");
    assert!(found.tested < finder.edge_count() / 8, "{} of {} edges tested", found.tested, finder.edge_count());
    assert_eq!(sorted(&found.sides), boundary(&finder, &wall, sun, &Counting::outside(&wall)));
}

#[test]
fn packets_of_any_filling_are_read_the_same_with_and_without_avx2() {
    let mut random = Random(8);
    for filling in [1, PLANES_AT_ONCE, WORD / 2, WORD] {
        let planes = (0..filling).map(|_| [(); 4].map(|()| random.signed() as f32)).collect::<Vec<_>>();
        let pairs = [(); WORD].map(|()| [(); 2].map(|()| random.below(filling) as u8));
        let packet = Packet::of_planes(&planes, &pairs);
        for threshold in [None, Some(0.2)] {
            let light = [(); 4].map(|()| random.signed() as f32);
            let hits = simd::hits(&packet, light, threshold);
            assert_eq!(hits, simd::plain::hits(&packet, light, threshold));
            assert!(filling < WORD || hits.silhouette != 0, "a full packet has silhouette edges");
        }
    }
}
