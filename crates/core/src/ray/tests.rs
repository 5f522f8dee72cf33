//! The ray caster against exact arithmetic, a plain loop, and rays that aim at trouble.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, I64Vec3, Vec3Swizzles};

use super::*;

type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// S. Vigna's splitmix64.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.bits() % end
    }

    /// In -1..1.
    fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// In a cube with edge length 2 about the origin.
    fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Loose triangles in the cube, corners up to `size` from a common point.
    fn soup(&mut self, count: u32, size: f64) -> Triangles {
        let positions = (0..count).flat_map(|_| {
            let center = self.point();
            [(); 3].map(|()| (center + size * self.point()).as_vec3())
        });
        (positions.collect(), (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
    }

    /// A mesh seen through a random linear map: no coordinate stays round, convex stays convex.
    fn skewed(&mut self, (positions, triangles): Triangles) -> Triangles {
        let turn = DQuat::from_axis_angle(self.point().normalize_or(DVec3::X), TAU * self.signed());
        let map = DMat3::from_quat(turn) * DMat3::from_diagonal(DVec3::new(1.3, 0.7, 1.1));
        (positions.into_iter().map(|p| (map * p.as_dvec3()).as_vec3()).collect(), triangles)
    }
}

/// A closed ball with radius 1 about the origin.
fn ball(rings: u32, segments: u32) -> Triangles {
    let mut positions = vec![Vec3::Z, Vec3::NEG_Z];
    for ring in 1..rings {
        let polar = TAU / 2.0 * f64::from(ring) / f64::from(rings);
        for segment in 0..segments {
            let around = TAU * f64::from(segment) / f64::from(segments);
            let p = DVec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos());
            positions.push(p.as_vec3());
        }
    }
    let at = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
    let mut triangles = Vec::new();
    for s in 0..segments {
        triangles.extend([[0, at(1, s), at(1, s + 1)], [1, at(rings - 1, s + 1), at(rings - 1, s)]]);
        for r in 1..rings - 1 {
            triangles.extend([[at(r, s), at(r + 1, s), at(r + 1, s + 1)], [at(r, s), at(r + 1, s + 1), at(r, s + 1)]]);
        }
    }
    (positions, triangles)
}

/// The closed cube -1..1.
fn cube() -> Triangles {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

fn caster((positions, triangles): &Triangles) -> RayCaster {
    RayCaster::new([(&positions[..], &triangles[..])])
}

fn hits(caster: &RayCaster, origin: DVec3, direction: DVec3) -> Vec<Hit> {
    let mut hits = Vec::new();
    caster.for_each_hit(origin, direction, 0.0, f64::INFINITY, |hit| hits.push(hit));
    hits
}

/// Compares all searches with a plain loop over all triangles.
fn compare_with_brute_force(parts: &[Triangles], origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> usize {
    let caster = RayCaster::new(parts.iter().map(|(p, t)| (&p[..], &t[..])));
    let ray = Ray::new(origin, direction).expect("a good ray");
    let mut expected = Vec::new();
    for (part, (positions, triangles)) in parts.iter().enumerate() {
        for (triangle, corners) in triangles.iter().enumerate() {
            let corners = corners.map(|i| positions[i as usize].to_array());
            if let Some(t) = ray.meets(&corners).filter(|t| has_area(&corners) && (t_min..=t_max).contains(t)) {
                expected.push(Hit { t, part: part as u32, triangle: triangle as u32 });
            }
        }
    }
    let first = expected.iter().copied().reduce(|a, b| if b.t < a.t { b } else { a });
    assert_eq!(caster.first_hit(origin, direction, t_min, t_max), first);
    let is_hit = expected.iter().any(|hit| t_min < hit.t && hit.t < t_max);
    assert_eq!(caster.is_hit(origin, direction, t_min, t_max), is_hit);
    let is_odd = |hit: &Hit| hit.triangle % 2 == 1;
    let first_odd = expected.iter().copied().filter(is_odd).reduce(|a, b| if b.t < a.t { b } else { a });
    assert_eq!(caster.first_hit_where(origin, direction, t_min, t_max, is_odd), first_odd);
    let any_odd = caster.any_hit_where(origin, direction, t_min, t_max, None, is_odd);
    assert!(
        any_odd.is_none_or(|hit| is_odd(&hit) && expected.contains(&hit)) && any_odd.is_some() == first_odd.is_some()
    );
    // Wanted or not, a guess changes nothing but what is found first.
    for guess in expected.first().into_iter().chain(&first_odd) {
        assert_eq!(caster.hit_on(guess, origin, direction), Some(*guess));
        let found = caster.any_hit_where(origin, direction, t_min, t_max, Some(guess), is_odd);
        assert!(if is_odd(guess) { found == Some(*guess) } else { found == any_odd });
    }
    let mut found = Vec::new();
    caster.for_each_hit(origin, direction, t_min, t_max, |hit| found.push(hit));
    found.sort_by_key(|hit| (hit.part, hit.triangle));
    assert_eq!(found, expected);
    expected.len()
}

#[test]
fn the_tree_finds_just_what_a_plain_loop_finds() {
    let mut random = Random(1);
    let mut hit_count = 0;
    for round in 0..400 {
        let size = [0.02, 0.3, 2.0][round % 3];
        let parts: Vec<_> = (0..random.below(4))
            .map(|_| {
                let count = [0, 1, 9, 500][random.below(4) as usize];
                random.soup(count, size)
            })
            .collect();
        for _ in 0..20 {
            let (origin, target) = (2.0 * random.point(), random.point());
            let t_min = [0.0, f64::NEG_INFINITY, random.signed()][random.below(3) as usize];
            let t_max = [f64::INFINITY, 1.0, random.signed()][random.below(3) as usize];
            hit_count += compare_with_brute_force(&parts, origin, target - origin, t_min, t_max);
        }
    }
    assert!(hit_count > 10_000, "only {hit_count} hits");
}

#[test]
fn huge_and_tiny_triangles_and_steep_rays_lose_no_hit_in_the_tree() {
    let mut random = Random(2);
    let parts = [1e-30, 1e-6, 1e-3, 1.0, 1e3, 1e9, 1e17].map(|scale| {
        let (mut positions, triangles) = random.soup(60, 1.0);
        for p in &mut positions {
            *p *= scale as f32;
        }
        (positions, triangles)
    });
    let mut hit_count = 0;
    for _ in 0..3000 {
        // Every component with its own magnitude, so that most rays are almost along an axis or a plane.
        let mut steep =
            || random.point() * DVec3::from_array([(); 3].map(|()| 10.0_f64.powi(random.below(40) as i32 - 30)));
        let (origin, direction): (DVec3, DVec3) = (steep(), steep());
        hit_count += compare_with_brute_force(&parts, origin, direction, f64::NEG_INFINITY, f64::INFINITY);
    }
    assert!(hit_count > 10_000, "only {hit_count} hits");
}

#[test]
fn a_ray_aimed_at_a_corner_of_a_box_misses_neither_the_box_nor_the_triangle_in_it() {
    // Right-angled triangles across an axis: all three intervals of their flat boxes shrink to one point there.
    let mut random = Random(10);
    for _ in 0..3000 {
        let (a, turn) = (random.point(), random.below(3) as usize);
        let positions = [a, a + random.signed() * DVec3::AXES[turn], a + random.signed() * DVec3::AXES[(turn + 1) % 3]]
            .map(DVec3::as_vec3);
        let mesh = (positions.to_vec(), vec![[0, 1, 2]]);
        for corner in positions {
            let distance = 10.0_f64.powi(random.below(9) as i32);
            let origin = corner.as_dvec3() + distance * random.point();
            let direction = corner.as_dvec3() - origin;
            let hit_count =
                compare_with_brute_force(std::slice::from_ref(&mesh), origin, direction, 0.0, f64::INFINITY);
            assert_eq!(hit_count, 1, "from {origin}");
        }
    }
}

#[test]
fn a_triangle_seen_edge_on_is_hit_within_its_own_box_or_not_at_all() {
    let mut random = Random(11);
    let mut hit_count = 0;
    for _ in 0..100_000 {
        let corners = [(); 3].map(|()| random.point().as_vec3());
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let in_plane = |u: f64, v: f64| a + (b - a) * u + (c - a) * v;
        let (origin, target) = (in_plane(3.0 * random.signed(), 5.0), in_plane(0.3, 0.3));
        let ray = Ray::new(origin, target - origin).expect("a good ray");
        if let Some(t) = ray.meets(&corners.map(|corner| corner.to_array())) {
            let p = origin + (target - origin) * t;
            let (min, max) = (a.min(b).min(c) - 1e-13, a.max(b).max(c) + 1e-13);
            assert!(min.cmple(p).all() && p.cmple(max).all(), "{p} is not in the box of {a}, {b}, {c}");
            hit_count += 1;
        }
    }
    assert!(hit_count > 10_000, "only {hit_count} hits");
}

#[test]
fn whole_number_rays_hit_just_the_triangles_that_exact_arithmetic_says() {
    // So many meet in so few places that every third ray goes through edges and corners or along faces.
    let mut random = Random(3);
    let mut whole = |end: u64| {
        let mut next = || random.below(2 * end + 1) as i64 - end as i64;
        I64Vec3::new(next(), next(), next())
    };
    let (mut hit_count, mut edge_count) = (0, 0);
    for _ in 0..60 {
        let corners: Vec<[I64Vec3; 3]> = (0..200).map(|_| [(); 3].map(|()| whole(4))).collect();
        let positions = corners.iter().flatten().map(|c| c.as_vec3()).collect();
        let caster = caster(&(positions, (0..200).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()));
        for _ in 0..100 {
            let (origin, direction) = (whole(6), whole(3));
            let mut found = hits(&caster, origin.as_dvec3(), direction.as_dvec3());
            found.sort_by_key(|hit| hit.triangle);
            let mut found = found.into_iter();
            for (triangle, &corners) in corners.iter().enumerate() {
                let [a, b, c] = corners.map(|corner| corner - origin);
                let normal = (b - a).cross(c - a);
                let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|n| n.dot(direction).signum());
                let (slope, height) = (normal.dot(direction), normal.dot(a));
                if slope == 0 || slope.signum() * height < 0 || volumes.contains(&-slope.signum()) {
                    continue;
                }
                let hit = found.next().expect("a hit is missing");
                assert_eq!(hit.triangle as usize, triangle);
                assert!((hit.t - height as f64 / slope as f64).abs() < 1e-12);
                hit_count += 1;
                edge_count += usize::from(volumes.contains(&0));
            }
            assert_eq!(found.next(), None, "a hit too many");
        }
    }
    assert!(hit_count > 5_000 && edge_count > 1_000, "only {hit_count} hits, {edge_count} on edges");
}

#[test]
fn no_ray_from_inside_slips_out_between_triangles() {
    let mut random = Random(4);
    for mesh in [cube(), ball(3, 4), ball(24, 40), ball(5, 300)] {
        let mesh = random.skewed(mesh);
        let caster = caster(&mesh);
        for _ in 0..20 {
            // A float's coordinates make projections that cancel exactly, others make ones that don't.
            let origin = 0.3 * random.point();
            for origin in [origin, origin.as_vec3().as_dvec3(), DVec3::ZERO] {
                for corners in &mesh.1 {
                    let [a, b, _] = corners.map(|i| mesh.0[i as usize].as_dvec3());
                    for target in [a, 0.5 * (a + b), a.lerp(b, 0.5 + 0.5 * random.signed())] {
                        let direction = target - origin;
                        let hit = caster.first_hit(origin, direction, 0.0, f64::INFINITY).expect("a leak");
                        assert!((hit.t - 1.0).abs() < 1e-9, "the first hit is at {}", hit.t);
                        assert!(caster.is_hit(origin, direction, 0.5, 1.5));
                        assert!(caster.is_hit(origin, -direction, 0.0, f64::INFINITY), "a leak behind");
                    }
                }
            }
        }
    }
}

#[test]
fn a_ray_aimed_at_a_corner_hits_it_from_however_far() {
    let mut random = Random(5);
    let mesh = random.skewed(ball(12, 20));
    let caster = caster(&mesh);
    for distance in [2.0, 1e3, 1e6, 1e9, 1e12] {
        for &corner in &mesh.0 {
            let origin = corner.as_dvec3() + distance * random.point().normalize_or(DVec3::X);
            let direction = corner.as_dvec3() - origin;
            assert!(caster.is_hit(origin, direction, 0.0, 1.0 + 1e-9), "missed from {distance} away");
        }
    }
}

#[test]
fn from_a_million_metres_away_a_hit_is_still_where_it_should_be() {
    let mut random = Random(6);
    let caster = caster(&cube());
    for _ in 0..1000 {
        let target = DVec3::new(0.9 * random.signed(), 0.9 * random.signed(), 1.0);
        let origin = target + 1e6 * DVec3::new(random.signed(), random.signed(), 1.5);
        let hit = caster.first_hit(origin, target - origin, 0.0, 2.0).expect("the top is seen");
        assert!((hit.t - 1.0).abs() < 1e-15, "off by {} m", (hit.t - 1.0) * 1e6);
    }
}

#[test]
fn a_generic_ray_crosses_a_closed_surface_oddly_often_from_inside_and_evenly_from_outside() {
    let mut random = Random(7);
    let mesh = random.skewed(ball(16, 24));
    let caster = caster(&mesh);
    for _ in 0..20_000 {
        assert_eq!(hits(&caster, 0.3 * random.point(), random.point()).len() % 2, 1);
        assert_eq!(hits(&caster, 5.0 * random.point().normalize_or(DVec3::X), random.point()).len() % 2, 0);
    }
}

#[test]
fn rays_along_an_axis_hit_a_sheet_at_all_its_corners_and_edges() {
    const SIZE: u32 = 16;
    let positions = (0..=SIZE).flat_map(|y| (0..=SIZE).map(move |x| Vec3::new(x as f32, y as f32, 0.0))).collect();
    let quad = |x: u32, y: u32| [0, 1, SIZE + 2, SIZE + 1].map(|corner| y * (SIZE + 1) + x + corner);
    let triangles = (0..SIZE).flat_map(|y| {
        (0..SIZE).flat_map(move |x| {
            let [a, b, c, d] = quad(x, y);
            [[a, b, c], [a, c, d]]
        })
    });
    let (positions, triangles): Triangles = (positions, triangles.collect());
    // The sheet across each axis in turn, seen from both sides, with zeros of both signs in the direction.
    for turn in 0..3 {
        let turned = |p: DVec3| DVec3::from_array([0, 1, 2].map(|i| p[(i + turn) % 3]));
        let positions = positions.iter().map(|p: &Vec3| turned(p.as_dvec3()).as_vec3()).collect();
        let caster = caster(&(positions, triangles.clone()));
        for (x, y) in (0..=2 * SIZE).flat_map(|y| (0..=2 * SIZE).map(move |x| (x, y))) {
            let above = DVec3::new(0.5 * f64::from(x), 0.5 * f64::from(y), 7.0);
            for (origin, direction) in [
                (above, DVec3::new(0.0, 0.0, -2.0)),
                (above, DVec3::new(-0.0, -0.0, -2.0)),
                (above.with_z(-7.0), DVec3::new(0.0, -0.0, 2.0)),
            ] {
                let hit = caster.first_hit(turned(origin), turned(direction), 0.0, f64::INFINITY);
                assert_eq!(hit.expect("the sheet has no holes").t, 3.5);
            }
        }
    }
}

#[test]
fn a_ray_in_a_face_of_a_box_or_along_its_edge_hits_the_sides_at_its_ends() {
    let caster = caster(&cube());
    for (y, z) in [(1.0, 0.25), (1.0, -0.0), (0.3, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        for turn in 0..3 {
            let turned = |p: DVec3| DVec3::from_array([0, 1, 2].map(|i| p[(i + turn) % 3]));
            let ray = |x, direction| (turned(DVec3::new(x, y, z)), turned(direction));
            let (origin, direction) = ray(-4.0, DVec3::X);
            assert_eq!(caster.first_hit(origin, direction, 0.0, 9.0).expect("it starts outside").t, 3.0);
            let (origin, direction) = ray(0.0, DVec3::NEG_X);
            assert_eq!(caster.first_hit(origin, direction, 0.0, 9.0).expect("it starts in the face").t, 1.0);
        }
    }
}

#[test]
fn no_axis_of_space_is_special_and_a_longer_direction_only_rescales() {
    let mut random = Random(8);
    let (positions, triangles) = random.soup(300, 0.5);
    let turned = positions.iter().map(|p| Vec3::new(p.y, p.z, p.x)).collect();
    let [caster, turned] = [(positions, triangles.clone()), (turned, triangles)].map(|mesh| caster(&mesh));
    for _ in 0..1000 {
        let (o, d) = (random.point(), random.point());
        let hit = caster.first_hit(o, d, 0.0, f64::INFINITY);
        assert_eq!(hit, turned.first_hit(o.yzx(), d.yzx(), 0.0, f64::INFINITY));
        let rescaled = caster.first_hit(o, 1024.0 * d, 0.0, f64::INFINITY);
        assert_eq!(hit, rescaled.map(|hit| Hit { t: 1024.0 * hit.t, ..hit }));
    }
}

#[test]
fn of_triangles_in_the_same_place_the_first_one_is_hit() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let triangles = vec![[0, 1, 2]; 50_000];
    let none: &[[u32; 3]] = &[];
    let caster = RayCaster::new([none, &triangles, none, &triangles].map(|t| (&positions[..], t)));
    let (origin, direction) = (DVec3::new(0.25, 0.25, 1.0), DVec3::NEG_Z);
    let first = caster.first_hit(origin, direction, 0.0, 2.0);
    assert_eq!(first, Some(Hit { t: 1.0, part: 1, triangle: 0 }));
    assert_eq!(hits(&caster, origin, direction).len(), 100_000);
}

#[test]
fn limits_are_met_by_first_hit_and_not_by_is_hit() {
    let caster = caster(&cube());
    let (origin, direction) = (DVec3::new(0.25, 0.5, 3.0), DVec3::NEG_Z);
    assert_eq!(caster.first_hit(origin, direction, 2.0, 2.0).map(|hit| hit.t), Some(2.0));
    assert_eq!(caster.first_hit(origin, direction, 2.5, 4.0).map(|hit| hit.t), Some(4.0));
    assert!(!caster.is_hit(origin, direction, 2.0, 4.0));
    assert!(caster.is_hit(origin, direction, 1.5, 4.0));
    assert!(caster.is_hit(origin, -direction, -5.0, -3.0), "limits may be negative");
}

#[test]
fn a_hit_tells_its_triangle_with_corners_in_order() {
    let (positions, triangles) = cube();
    let caster = caster(&(positions.clone(), triangles.clone()));
    let hit = caster.first_hit(DVec3::new(0.25, 0.5, 3.0), DVec3::NEG_Z, 0.0, 9.0).expect("the top");
    let expected = triangles[hit.triangle as usize].map(|i| positions[i as usize].as_dvec3());
    assert_eq!(caster.corners(&hit), expected);
    assert_eq!(caster.normal(&hit), DVec3::new(0.0, 0.0, 4.0));
}

#[test]
fn triangles_without_area_are_dropped_and_slivers_are_not() {
    let flat = [[0.1, 0.2, 0.3], [0.2, 0.4, 0.6], [0.4, 0.8, 1.2]]; // exact doubles, so exactly on a line
    let next = |x: f32| f32::from_bits(x.to_bits() + 1);
    let sliver = [flat[0], [flat[1][0], next(flat[1][1]), flat[1][2]], flat[2]];
    assert!(!has_area(&flat) && has_area(&sliver));
    // Collinear corners 2^-149 to 2^127 apart: far more than the bits of a double.
    assert!(!has_area(&[[f32::MIN_POSITIVE; 3], [0.0; 3], [f32::MAX; 3]]));
    assert!(has_area(&[[f32::from_bits(1), 0.0, 0.0], [0.0; 3], [f32::MAX; 3]]));
    assert!(!has_area(&[[f32::NAN, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0]]));
    assert!(!has_area(&[[f32::INFINITY, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0]]));

    let positions: Vec<Vec3> = flat.iter().chain(&sliver).map(|&p| p.into()).collect();
    let caster = RayCaster::new([(&positions[..], &[[0, 1, 2], [3, 4, 5]][..])]);
    assert_eq!(caster.triangle_count(), 1);
    let center = (positions[3].as_dvec3() + positions[4].as_dvec3() + positions[5].as_dvec3()) / 3.0;
    assert_eq!(hits(&caster, center + DVec3::Z, DVec3::NEG_Z).len(), 1);
}

#[test]
fn edge_functions_have_the_right_sign_where_both_products_round_to_the_same() {
    let (one, ulp) = (1.0, f64::EPSILON);
    let (a, b) = ([one + ulp, one + 2.0 * ulp], [one, one + ulp]);
    assert_eq!(edge(a, b), 0.0, "(1 + u)^2 and 1 + 2 u round to the same");
    assert_eq!(exact_edge(a, b), ulp * ulp);
    assert_eq!(exact_edge(b, a), -ulp * ulp);
    assert_eq!(exact_edge(a, a), 0.0);
}

#[test]
fn a_sliver_whose_edge_functions_all_round_to_0_is_not_lost() {
    let u = f64::EPSILON;
    let [a, b, c] = [[1.0, 1.0 - u], [1.0 + 2.0 * u, 1.0 + u], [-1.0 - u, -1.0]];
    assert_eq!([edge(b, c), edge(c, a), edge(a, b)], [0.0; 3]);
    assert_eq!(weights_at_origin([a, b, c]), Some([u * u, u * u, 2.0 * u * u]));
    assert_eq!(weights_at_origin([a, c, b]), Some([-u * u, -2.0 * u * u, -u * u]));
    assert_eq!(weights_at_origin([a, a, c]), None, "it is flat");
}

#[test]
fn nothing_is_hit_where_there_is_nothing_or_no_ray() {
    let cube = caster(&cube());
    let empty = [RayCaster::new([]), caster(&(vec![], vec![])), caster(&(vec![Vec3::ZERO], vec![[0, 0, 0]]))];
    for caster in &empty {
        assert!(!caster.is_hit(DVec3::ZERO, DVec3::X, 0.0, f64::INFINITY));
        assert_eq!(caster.triangle_count(), 0);
    }
    for (origin, direction) in [
        (DVec3::ZERO, DVec3::ZERO),
        (DVec3::ZERO, DVec3::NAN),
        (DVec3::ZERO, DVec3::INFINITY),
        (DVec3::NAN, DVec3::X),
        (DVec3::NEG_INFINITY, DVec3::X),
    ] {
        assert_eq!(cube.first_hit(origin, direction, 0.0, f64::INFINITY), None);
    }
    assert!(!cube.is_hit(DVec3::ZERO, DVec3::X, f64::NAN, f64::NAN));
}

#[test]
fn a_triangle_takes_less_than_100_bytes() {
    let mut random = Random(9);
    for mesh in [ball(300, 300), random.soup(100_000, 0.01)] {
        let caster = caster(&mesh);
        let count = caster.triangle_count();
        let bytes = caster.tree.byte_count()
            + size_of_val(&caster.corners[..])
            + size_of_val(&caster.numbers[..])
            + size_of_val(&caster.places[..]);
        assert!(bytes < 100 * count, "{} bytes each", bytes / count);
    }
}
