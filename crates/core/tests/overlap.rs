//! The bound on overlapping volumes holds everywhere, is near the truth, and a split chain counts the same.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use umbrae_core::{
    Caster, Chain, Counting, LightPosition, Mesh, Object, ShadowVolume, Surface, Topology, most_overlaps, shapes,
    split_chain,
};

fn caster(surface: Surface) -> Caster {
    let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
    let topology = Arc::new(Topology::new(&mesh));
    Caster::new(&Object::new("", mesh, DAffine3::IDENTITY), topology)
}

fn chain_and_volume(caster: &Caster, light: LightPosition) -> (Chain, ShadowVolume) {
    let chain = Chain::new(caster, light, &Counting::outside(caster));
    let volume = ShadowVolume::new(caster, &chain);
    (chain, volume)
}

fn bound(caster: &Caster, light: LightPosition) -> u32 {
    most_overlaps(caster, &chain_and_volume(caster, light).1, light)
}

/// Lights all around the origin, from near to infinitely far.
fn lights() -> Vec<LightPosition> {
    let directions = [[1.0, 0.2, 0.3], [-0.4, 1.0, 0.1], [0.1, 0.2, 1.0], [0.3, -0.2, -1.0], [1.0, 1.0, 1.0]];
    let directional = directions.iter().filter_map(|&d| LightPosition::directional(d.into()));
    let points = directions.iter().flat_map(|&d| [12.0, 100.0].map(|r| LightPosition::point(DVec3::from(d) * r)));
    directional.chain(points).collect()
}

#[test]
fn nested_spheres_overlap_as_often_as_there_are_spheres() {
    for k in [2, 10, 200] {
        let spheres = (0..k).map(|i| shapes::icosphere(Vec3::ZERO, 1.0 + 4.0 * i as f32 / k as f32, 2));
        let caster = caster(shapes::joined(spheres));
        for light in lights() {
            let bound = bound(&caster, light);
            assert!((k..=k + k / 5 + 1).contains(&bound), "{bound} for {k} spheres under {light:?}");
        }
    }
}

#[test]
fn nested_spheres_around_the_light_overlap_as_often_as_there_are_spheres() {
    for k in [2, 10, 200] {
        let spheres = (0..k).map(|i| shapes::icosphere(Vec3::ZERO, 1.0 + 4.0 * i as f32 / k as f32, 2));
        let caster = caster(shapes::joined(spheres));
        let light = LightPosition::point(DVec3::new(0.1, 0.2, -0.3));
        // Counted from within, as a lamp's shades are.
        let every = vec![Counting::Every; k as usize];
        let volume = ShadowVolume::new(&caster, &Chain::new(&caster, light, &every));
        assert_eq!(most_overlaps(&caster, &volume, light), k);
    }
}

#[test]
fn stacked_sheets_overlap_as_often_as_there_are_sheets() {
    for k in [10, 300] {
        let sheet =
            |i: u32| shapes::sheet(Vec3::new(-2.0, -2.0, i as f32 * 0.01), Vec3::X * 4.0, Vec3::Y * 4.0, [3, 3]);
        let caster = caster(shapes::joined((0..k).map(sheet)));
        for light in [
            LightPosition::directional(DVec3::new(0.1, 0.2, 1.0)).expect("a direction"),
            LightPosition::point(DVec3::new(0.3, 0.4, 30.0)),
            LightPosition::point(DVec3::new(0.3, 0.4, 3.7)),
            LightPosition::point(DVec3::new(9.0, 0.4, 9.0)),
        ] {
            let bound = bound(&caster, light);
            assert!((k..=k + k / 3 + 2).contains(&bound), "{bound} for {k} sheets under {light:?}");
        }
    }
}

#[test]
fn a_thousand_separate_cubes_overlap_a_few_times_only() {
    // As the light is high above a plane of cubes, no two shade the same place.
    let cube = |i: u32| {
        let at = Vec3::new((i % 32) as f32 * 3.0, (i / 32) as f32 * 3.0, 0.0);
        shapes::cuboid(at, at + Vec3::ONE)
    };
    let caster = caster(shapes::joined((0..1024).map(cube)));
    let high = bound(&caster, LightPosition::point(DVec3::new(48.0, 48.0, 300.0)));
    let overhead = bound(&caster, LightPosition::directional(DVec3::new(0.01, 0.02, 1.0)).expect("a direction"));
    println!("cubes: {high} under a lamp, {overhead} under a sun");
    assert!(high <= 12 && overhead <= 12, "{high}, {overhead}");
}

#[test]
fn of_roofs_on_a_lattice_the_bound_is_at_least_what_one_can_count_and_hardly_more() {
    const SIZE: u32 = 24;
    let sun = LightPosition::directional(DVec3::Z).expect("a direction");
    let mut rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    for roofs in [20, 100, 400] {
        let mut counts = [[0_u32; SIZE as usize]; SIZE as usize];
        let roof = |height: u32| {
            let mut span = || {
                let [a, b] = [rng.random_range(0..SIZE), rng.random_range(0..SIZE)];
                [a.min(b), a.max(b) + 1]
            };
            let [[west, east], [south, north]] = [span(), span()];
            let squares = counts[west as usize..east as usize].iter_mut();
            squares.flat_map(|column| &mut column[south as usize..north as usize]).for_each(|count| *count += 1);
            let corner = Vec3::new(west as f32, south as f32, height as f32);
            shapes::sheet(corner, Vec3::X * (east - west) as f32, Vec3::Y * (north - south) as f32, [1, 1])
        };
        let caster = caster(shapes::joined((0..roofs).map(roof)));
        let most = counts.iter().flatten().copied().max().expect("there are squares");
        let bound = bound(&caster, sun);
        println!("{roofs} roofs: {bound} for {most}");
        assert!((most..=most + most / 3 + 8).contains(&bound), "{bound} for {most} of {roofs}");
    }
}

/// Steps going down along +x, each a box of its own, lit from above the top: along a ray close over the steps, each is shaded by all before.
fn stairs(steps: u32) -> Surface {
    shapes::joined((0..steps).map(|i| {
        let at = Vec3::new(i as f32 * 0.3, 0.0, i as f32 * -0.17);
        shapes::cuboid(at, at + Vec3::new(0.3, 2.0, 0.16))
    }))
}

#[test]
fn a_staircase_of_300_steps_splits_into_few_parts_that_fit_seven_bits() {
    let caster = caster(stairs(300));
    for (light, parts_wanted) in [
        (LightPosition::directional(DVec3::new(-0.3, 0.0, 0.17)).expect("a direction"), 3),
        (LightPosition::point(DVec3::new(-3.0, 1.0, 2.0)), 3),
        (LightPosition::point(DVec3::new(1.0, 1.0, 1.0)), 3),
    ] {
        let (chain, volume) = chain_and_volume(&caster, light);
        let bound = most_overlaps(&caster, &volume, light);
        let parts = split_chain(&caster, &chain, light, 127);
        let each: Vec<u32> =
            parts.iter().map(|part| most_overlaps(&caster, &ShadowVolume::new(&caster, part), light)).collect();
        println!("stairs: {bound} as a whole, parts of {each:?}; {} sides whole", volume.sides.len());
        assert!(each.iter().all(|&n| n <= 127));
        assert!(parts.len() <= parts_wanted, "{each:?}");
    }
}

#[test]
fn stacked_sheets_split_into_about_as_few_parts_as_can_be() {
    let sheet = |i: u32| shapes::sheet(Vec3::new(-2.0, -2.0, i as f32 * 0.01), Vec3::X * 4.0, Vec3::Y * 4.0, [3, 3]);
    let caster = caster(shapes::joined((0..300).map(sheet)));
    let light = LightPosition::point(DVec3::new(0.3, 0.4, 30.0));
    let (chain, _) = chain_and_volume(&caster, light);
    let parts = split_chain(&caster, &chain, light, 127);
    println!("sheets: {} parts", parts.len());
    assert!((3..=4).contains(&parts.len()));
    assert_eq!(split_chain(&caster, &chain, light, 1_000), vec![chain]);
}

#[derive(Debug, Clone)]
struct Soup {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u8; 3]>,
    light: LightPosition,
    /// For each query a triangle, weights of its corners, and a distance behind it.
    queries: Vec<(u8, [f64; 3], f64)>,
    direction: [f64; 3],
    most: u32,
}

fn soup() -> impl Strategy<Value = Soup> {
    let xyz = |size: f64| [-size..size, -size..size, -size..size];
    let light = prop_oneof![
        3 => xyz(3.0).prop_map(|p| LightPosition::point(p.into())),
        2 => xyz(12.0).prop_map(|p| LightPosition::point(p.into())),
        // On a grid, where edges pass through the axis and triangles through the light.
        1 => [-3..=3_i8, -3..=3, -3..=3].prop_map(|p| LightPosition::point(DVec3::from(p.map(f64::from)))),
        2 => xyz(1.0).prop_filter_map("no direction", |d| LightPosition::directional(d.into())),
    ];
    let weights = [0.05..1.0, 0.05..1.0, 0.05..1.0_f64];
    let positions = prop_oneof![
        prop::collection::vec(xyz(4.0), 6..40),
        prop::collection::vec([-3..=3_i8, -3..=3, -3..=3].prop_map(|p| p.map(f64::from)), 6..40),
    ];
    let triangles = prop::collection::vec(any::<[u8; 3]>(), 17..90);
    let queries = prop::collection::vec((any::<u8>(), weights, 0.01..6.0_f64), 30);
    (positions, triangles, light, queries, xyz(1.0), 1..12_u32).prop_map(
        |(positions, triangles, light, queries, direction, most)| Soup {
            positions,
            triangles,
            light,
            queries,
            direction,
            most,
        },
    )
}

impl Soup {
    fn caster(&self) -> Option<Caster> {
        let n = self.positions.len() as u32;
        let surface = Surface {
            positions: self.positions.iter().map(|p| DVec3::from(*p).as_vec3()).collect(),
            triangles: self.triangles.iter().map(|t| t.map(|i| u32::from(i) % n)).collect(),
            ..Surface::default()
        };
        let mesh = Arc::new(Mesh::new(surface).ok()?);
        let topology = Arc::new(Topology::new(&mesh));
        Some(Caster::new(&Object::new("", mesh, DAffine3::IDENTITY), topology))
    }

    fn points(&self, caster: &Caster) -> Vec<DVec3> {
        let count = caster.mesh.triangles().len();
        let point = |&(t, weights, behind): &(u8, [f64; 3], f64)| {
            let corners = caster.corners(usize::from(t) % count).map(Vec3::as_dvec3);
            let p = (corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2])
                / weights.iter().sum::<f64>();
            p - self.light.offset_from(p) * behind.exp2()
        };
        self.queries.iter().map(point).collect()
    }
}

fn for_each_soup(cases: u32, check: impl Fn(&Soup) -> Result<(), TestCaseError>) {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]);
    TestRunner::new_with_rng(config, rng).run(&soup(), |soup| check(&soup)).expect("it holds for every soup");
}

#[test]
fn no_point_of_any_soup_is_in_more_volumes_than_the_bound() {
    let sums = std::cell::Cell::new([0_u64; 4]);
    for_each_soup(2_000, |soup| {
        let Some(caster) = soup.caster() else { return Ok(()) };
        let (_, volume) = chain_and_volume(&caster, soup.light);
        let bound = most_overlaps(&caster, &volume, soup.light);
        prop_assert!(bound as usize <= volume.light_cap.len());
        let mut n = sums.get();
        let mut most = 0;
        for point in soup.points(&caster) {
            if let Some(count) = volume.count_to_infinity(&caster.positions, soup.light, point, soup.direction.into()) {
                prop_assert!(count <= bound as i32, "{count} at {point}, but a bound of {bound}");
                most = most.max(count);
                n[0] += 1;
            }
        }
        n[1] += most as u64;
        n[2] += u64::from(bound);
        n[3] += volume.light_cap.len() as u64;
        sums.set(n);
        Ok(())
    });
    let [points, most, bound, triangles] = sums.get();
    println!("{points} points; bounds of {bound} where samples found {most}, of {triangles} triangles");
    assert!(points > 20_000);
}

#[test]
fn the_parts_of_a_chain_count_together_what_it_counts() {
    let splits = std::cell::Cell::new(0);
    for_each_soup(400, |soup| {
        let Some(caster) = soup.caster() else { return Ok(()) };
        let (chain, volume) = chain_and_volume(&caster, soup.light);
        let parts = split_chain(&caster, &chain, soup.light, soup.most);
        let mut sum = vec![0; chain.coefficients().len()];
        for part in &parts {
            sum.iter_mut().zip(part.coefficients()).for_each(|(sum, c)| *sum += c);
        }
        prop_assert_eq!(&sum, chain.coefficients());
        let volumes: Vec<ShadowVolume> = parts.iter().map(|part| ShadowVolume::new(&caster, part)).collect();
        splits.set(splits.get() + usize::from(parts.len() > 1));
        for point in soup.points(&caster) {
            let count =
                |v: &ShadowVolume| v.count_to_infinity(&caster.positions, soup.light, point, soup.direction.into());
            let each: Option<Vec<i32>> = volumes.iter().map(count).collect();
            if let (Some(whole), Some(each)) = (count(&volume), each) {
                prop_assert_eq!(whole, each.iter().sum::<i32>());
                prop_assert!(each.iter().all(|&n| (0..=soup.most as i32).contains(&n)), "{each:?}");
            }
        }
        Ok(())
    });
    assert!(splits.get() > 100);
}
