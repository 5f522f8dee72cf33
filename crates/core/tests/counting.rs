//! The law that everything rests on: what the extruded chain counts is what a ray from the point to the light meets.
//!
//! Left side: the shadow volume (chain, silhouette, caps) and its signed crossings. Right side: the ray caster,
//! which knows nothing of chains. Over random soups with random windings, repeated faces, fans of ten on an edge, closed
//! bodies wound outwards and inwards, lights in triangle planes, eyes in shadow.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use umbrae_core::{
    Caster, Chain, Counting, LightPosition, Mesh, Object, RayCaster, ShadowVolume, Surface, Topology, Windings,
};

/// The number of soups that the law is tried on.
const SOUPS: u32 = 20_000;
/// Queries per soup and light.
const POINTS: usize = 4;

/// A recipe for a soup; kept simple so that failures shrink to something readable.
#[derive(Debug, Clone)]
struct Soup {
    /// On a small integer grid, so that collinear, coplanar and coincident things are common.
    grid_points: Vec<[i8; 3]>,
    triangles: Vec<[u8; 3]>,
    /// Triangles that are there again, possibly turned round.
    repeats: Vec<(u8, bool)>,
    /// Tetrahedra on four of the points, wound outwards or inwards as the points have it.
    tetrahedra: Vec<[u8; 4]>,
    /// Whether the first two points carry a fan of ten.
    has_fan: bool,
    light: LightKind,
    points: Vec<[f64; 3]>,
    eye: [f64; 3],
    direction: [f64; 3],
}

#[derive(Debug, Clone)]
enum LightKind {
    Point([f64; 3]),
    Directional([f64; 3]),
    /// In the plane of the first triangle, at these multiples of its edges.
    InPlane([f64; 2]),
    /// Parallel to the plane of the first triangle.
    AlongPlane([f64; 2]),
    /// In the first tetrahedron, if there is one, with these weights.
    InBody([f64; 4]),
}

fn soup() -> impl Strategy<Value = Soup> {
    let coordinate = || -8.0..8.0_f64;
    let xyz = move || [coordinate(), coordinate(), coordinate()];
    let light = prop_oneof![
        4 => xyz().prop_map(LightKind::Point),
        3 => xyz().prop_map(LightKind::Directional),
        1 => [-3.0..3.0_f64, -3.0..3.0].prop_map(LightKind::InPlane),
        1 => [-3.0..3.0_f64, -3.0..3.0].prop_map(LightKind::AlongPlane),
        2 => [0.1..1.0_f64, 0.1..1.0, 0.1..1.0, 0.1..1.0].prop_map(LightKind::InBody),
    ];
    (
        prop::collection::vec([-5..=5_i8, -5..=5, -5..=5], 4..14),
        prop::collection::vec(any::<[u8; 3]>(), 0..14),
        prop::collection::vec(any::<(u8, bool)>(), 0..4),
        prop::collection::vec(any::<[u8; 4]>(), 0..3),
        prop::bool::weighted(0.2),
        light,
        prop::collection::vec(xyz(), POINTS),
        xyz(),
        xyz(),
    )
        .prop_map(|(grid_points, triangles, repeats, tetrahedra, has_fan, light, points, eye, direction)| Soup {
            grid_points,
            triangles,
            repeats,
            tetrahedra,
            has_fan,
            light,
            points,
            eye,
            direction,
        })
}

/// `None` when no triangle is left.
fn caster(soup: &Soup) -> Option<Caster> {
    let n = soup.grid_points.len();
    let pick = |i: u8| u32::from(i) % n as u32;
    let mut triangles: Vec<[u32; 3]> = soup.triangles.iter().map(|t| t.map(pick)).collect();
    for &[a, b, c, d] in &soup.tetrahedra {
        let [a, b, c, d] = [a, b, c, d].map(pick);
        triangles.extend([[a, c, b], [a, b, d], [b, c, d], [c, a, d]]);
    }
    let mut positions: Vec<Vec3> = soup.grid_points.iter().map(|p| Vec3::from(p.map(f32::from))).collect();
    if soup.has_fan {
        for i in 0..10_u32 {
            let angle = i as f32 * 0.6;
            positions.push(Vec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), i as f32 - 5.0));
            triangles.push(if i % 3 == 0 { [0, 1, n as u32 + i] } else { [1, 0, n as u32 + i] });
        }
    }
    for &(i, is_turned) in &soup.repeats {
        if let Some(&[a, b, c]) = triangles.get(usize::from(i) % triangles.len().max(1)) {
            triangles.push(if is_turned { [a, c, b] } else { [a, b, c] });
        }
    }
    let mesh = Arc::new(Mesh::new(Surface { positions, triangles, ..Surface::default() }).ok()?);
    let topology = Arc::new(Topology::new(&mesh));
    let object = Object::new("", mesh, DAffine3::IDENTITY);
    Some(Caster::new(&object, topology))
}

fn light(soup: &Soup, caster: &Caster) -> Option<LightPosition> {
    let [a, b, c] = caster.corners(0).map(Vec3::as_dvec3);
    let in_plane = |[s, t]: [f64; 2]| (b - a) * s + (c - a) * t;
    match soup.light {
        LightKind::Point(p) => Some(LightPosition::point(p.into())),
        LightKind::Directional(d) => LightPosition::directional(d.into()),
        LightKind::InPlane(st) => Some(LightPosition::point(a + in_plane(st))),
        LightKind::AlongPlane(st) => LightPosition::directional(in_plane(st)),
        LightKind::InBody(weights) => {
            let corners = soup
                .tetrahedra
                .first()?
                .map(|i| DVec3::from(soup.grid_points[usize::from(i) % soup.grid_points.len()].map(f64::from)));
            let weighted: DVec3 = corners.iter().zip(weights).map(|(&corner, weight)| corner * weight).sum();
            Some(LightPosition::point(weighted / weights.iter().sum::<f64>()))
        }
    }
}

/// What the ray caster meets between `point` and the light: triangles counted as `counting` says, and all of them.
/// `None` where that changes within a hair of the point, or the light itself is on a triangle.
fn met(
    rays: &RayCaster,
    caster: &Caster,
    counting: &[Counting],
    light: LightPosition,
    point: DVec3,
) -> Option<(i32, i32)> {
    let at = |point: DVec3| {
        let direction = light.offset_from(point);
        let end = if light.is_directional() { f64::INFINITY } else { 1.0 + 1e-9 };
        let (mut counted, mut all, mut is_light_free) = (0, 0, true);
        rays.for_each_hit(point, direction, 0.0, end, |hit| {
            is_light_free &= light.is_directional() || hit.t < 1.0 - 1e-9;
            all += 1;
            let component = caster.topology.component_of_triangle()[hit.triangle as usize];
            counted += match counting[component as usize] {
                Counting::Every => 1,
                Counting::Facing => i32::from(rays.normal(&hit).dot(direction) > 0.0),
                Counting::FacingAway => i32::from(rays.normal(&hit).dot(direction) < 0.0),
            };
        });
        is_light_free.then_some((counted, all))
    };
    let here = at(point);
    let hair = 1e-7;
    let around = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis * hair, axis * -hair]);
    around.into_iter().all(|offset| at(point + offset) == here).then_some(here).flatten()
}

/// Decided queries and those in shadow among them.
#[derive(Default)]
struct Tally {
    soups: usize,
    decided: usize,
    shadowed: usize,
    eyes_in_shadow: usize,
    facing_away: usize,
}

fn check(soup: &Soup, tally: &mut Tally) -> Result<(), TestCaseError> {
    let Some(caster) = caster(soup) else { return Ok(()) };
    let Some(light) = light(soup, &caster) else { return Ok(()) };
    let rays = RayCaster::new([(caster.positions.as_slice(), caster.mesh.triangles())]);
    let counting = Counting::outside(&caster);
    let volume = ShadowVolume::new(&caster, &Chain::new(&caster, light, &counting));
    let every = vec![Counting::Every; counting.len()];
    let volume_of_every = ShadowVolume::new(&caster, &Chain::new(&caster, light, &every));
    let direction = DVec3::from(soup.direction);
    let eye = DVec3::from(soup.eye);
    let met_at_eye = met(&rays, &caster, &counting, light, eye);
    tally.soups += 1;

    for &point in &soup.points {
        let point = DVec3::from(point);
        let Some((counted, all)) = met(&rays, &caster, &counting, light, point) else { continue };
        if let Some(count) = volume.count_to_infinity(&caster.positions, light, point, direction) {
            prop_assert_eq!(count, counted, "z-fail count at {}", point);
            tally.decided += 1;
            tally.shadowed += usize::from(all > 0);
        }
        // The counting that is chosen for an eye at this point, inside or outside of bodies, calls it dark exactly where a ray
        // meets anything, however bodies are wound and wherever the light is.
        let chosen =
            Counting::choose(&caster, &Windings::of_point(&caster, point), &Windings::of_light(&caster, light));
        let volume_of_chosen = ShadowVolume::new(&caster, &Chain::new(&caster, light, &chosen));
        if let Some(count) = volume_of_chosen.count_to_infinity(&caster.positions, light, point, direction) {
            prop_assert_eq!(count > 0, all > 0, "z-fail count {} as chosen at {}, {} met", count, point, all);
            tally.facing_away += usize::from(chosen.contains(&Counting::FacingAway));
        }
        if let Some(count) = volume_of_every.count_to_infinity(&caster.positions, light, point, direction) {
            prop_assert_eq!(count, all, "z-fail count of every triangle at {}", point);
        }
        if let Some((counted_at_eye, _)) = met_at_eye
            && let Some(difference) = volume.count_from_eye(&caster.positions, light, eye, point)
        {
            prop_assert_eq!(difference, counted - counted_at_eye, "z-pass count from {} to {}", eye, point);
            tally.decided += 1;
            tally.eyes_in_shadow += usize::from(counted_at_eye > 0);
        }
    }
    Ok(())
}

#[test]
fn a_chain_counts_what_a_ray_to_the_light_meets() {
    let config = Config { cases: SOUPS, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let tally = std::cell::RefCell::new(Tally::default());
    TestRunner::new_with_rng(config, rng).run(&soup(), |soup| check(&soup, &mut tally.borrow_mut())).unwrap();
    let tally = tally.into_inner();
    let Tally { soups, decided, shadowed, eyes_in_shadow, facing_away } = tally;
    println!(
        "{soups} soups, {decided} decided queries, {shadowed} in shadow, {eyes_in_shadow} with the eye in shadow, {facing_away} with a light in a body"
    );
    // A law that is never tried holds too.
    assert!(soups >= 10_000 && decided > 100_000 && shadowed > 10_000 && eyes_in_shadow > 6_000 && facing_away > 100);
}

/// Each vertex of a boundary is left as often as it is reached, whatever the coefficients.
#[test]
fn the_boundary_of_any_chain_has_no_boundary() {
    let config = Config { cases: 1_000, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[9; 32]);
    TestRunner::new_with_rng(config, rng)
        .run(&(soup(), prop::collection::vec(-3..=3_i8, 200)), |(soup, coefficients)| {
            let Some(caster) = caster(&soup) else { return Ok(()) };
            let chain = Chain::from_coefficients(coefficients[..caster.mesh.triangles().len()].to_vec());
            let mut balance = vec![0_i64; caster.positions.len()];
            for edge in umbrae_core::silhouette(&caster.topology, &chain) {
                balance[edge.start as usize] += i64::from(edge.multiplicity);
                balance[edge.end as usize] -= i64::from(edge.multiplicity);
            }
            prop_assert!(balance.iter().all(|&b| b == 0));
            Ok(())
        })
        .unwrap();
}
