//! What the passes find, read back.

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3, Vec3};
use umbrae_core::{
    Camera, Caster, Chain, Counting, LightPosition, Mesh, Object, Role, Scene, Surface, shapes, silhouette,
};

use super::finder::{Finder, Found, MOST_LIGHTS};
use super::tables::{Entry, Table, Tables};
use crate::timing::PassTimer;
use crate::{AdapterChoice, Gpu};
use random::{Random, soup};

#[path = "../../../../tests/soup/mod.rs"]
mod random;

fn gpu() -> Gpu {
    pollster::block_on(Gpu::new(&AdapterChoice::default())).expect("tests need a graphics driver: run scripts/setup.sh")
}

fn read(gpu: &Gpu, table: &Table) -> Vec<Entry> {
    let bytes = pollster::block_on(gpu.read(&table.texture)).expect("the device is there");
    bytemuck::pod_collect_to_vec(&bytes)
}

fn find(gpu: &Gpu, finder: &Finder, tables: &Tables, camera: &Camera, lights: &[LightPosition]) -> Found {
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("find") });
    let found = finder.draw(gpu, &mut encoder, tables, (camera, lights), &mut PassTimer::off()).expect("small tables");
    gpu.queue.submit([encoder.finish()]);
    found
}

/// Everything that was found for one light: by caster, the coefficients of its triangles and the multiplicities of its edges, in their order.
fn of_light(
    (tables, casters): (&Tables, &[Caster]),
    light: usize,
    [coefficients, multiplicities, edges]: [&[Entry]; 3],
    lane: usize,
) -> Vec<(Vec<i8>, Vec<i32>)> {
    let coefficient = |t: u32| match coefficients[t as usize][light / 16] >> (2 * (light % 16)) & 3 {
        0 => 0,
        1 => 1,
        2 => -1,
        both => panic!("triangle {t} has {both}"),
    };
    let bits = tables.lane_bits as usize;
    let multiplicity = |e: usize| {
        let lane = u64::from(multiplicities[e][lane * bits / 32]) >> (lane * bits % 32) & ((1 << bits) - 1);
        (lane as i64 - (1 << (bits - 1))) as i32
    };
    let of_caster = |(caster, ranges): (&Caster, &super::tables::CasterTables)| {
        let mut of_edges = vec![i32::MAX; caster.topology.edges().len()];
        for e in ranges.edges.iter().flat_map(|run| run.edges.clone()) {
            let [low, high] = [edges[e as usize][0], edges[e as usize][1]].map(|i| i - ranges.positions.start);
            let found = caster.topology.edges().binary_search_by_key(&(low, high), |edge| (edge.low, edge.high));
            of_edges[found.expect("the edge is the caster's")] = multiplicity(e as usize);
        }
        (ranges.triangles.clone().map(coefficient).collect(), of_edges)
    };
    casters.iter().zip(&tables.casters).map(of_caster).collect()
}

fn casters_of(surfaces: impl IntoIterator<Item = Surface>) -> Vec<Caster> {
    let object = |surface| Object::new("", Arc::new(Mesh::new(surface).expect("a good mesh")), DAffine3::IDENTITY);
    let scene = Scene { objects: surfaces.into_iter().map(object).collect(), ..Scene::default() };
    Caster::of_scene(&scene)
}

/// As many triangles on one edge as asked for, wound at random.
fn fan(random: &mut Random, triangles: u32) -> Surface {
    let positions: Vec<Vec3> = (0..triangles + 2).map(|_| random.point(2.0).as_vec3()).collect();
    let triangles = (2..triangles + 2).map(|i| if random.below(2) == 0 { [0, 1, i] } else { [1, 0, i] }).collect();
    Surface { positions, triangles, ..Surface::default() }
}

/// Casters by name: soups, closed bodies, sheets, fans, and one that can be seen through.
fn scenes(random: &mut Random) -> Vec<(String, Vec<Caster>)> {
    let mut scenes: Vec<_> = (0..8).map(|i| (format!("soup {i}"), Caster::of_scene(&soup(random)))).collect();
    let turned = |surface, by: f32| shapes::transformed(surface, Affine3A::from_rotation_x(by));
    let cube = || turned(shapes::cuboid(Vec3::splat(-1.0), Vec3::ONE), 0.3);
    let ball = || shapes::icosphere(Vec3::new(2.5, 0.5, 0.1), 1.2, 3);
    let sheet = || shapes::sheet(Vec3::new(-3.0, -3.0, -1.5), Vec3::X * 6.0, Vec3::Y * 6.0, [20, 30]);
    scenes.push(("bodies and a sheet".to_owned(), casters_of([cube(), ball(), sheet()])));
    scenes.push(("one mesh".to_owned(), casters_of([shapes::joined([cube(), ball(), sheet()])])));
    let mut glass = casters_of([ball(), cube()]);
    glass[0].role = Role { is_glass: true, ..Role::default() };
    scenes.push(("glass".to_owned(), glass));
    for triangles in [7, 8, 127, 128, 40_000] {
        scenes.push((format!("fan of {triangles}"), casters_of([fan(random, triangles), cube()])));
    }
    scenes
}

/// Points around and inside, points in planes of triangles, and directions.
fn lights(random: &mut Random, casters: &[Caster], count: usize) -> Vec<LightPosition> {
    let light = |i: usize, random: &mut Random| match i % 4 {
        0 => LightPosition::point(random.point(6.0)),
        1 => LightPosition::point(random.point(2.0)),
        2 => {
            let corners = casters[0].corners(i % casters[0].mesh.triangles().len()).map(Vec3::as_dvec3);
            LightPosition::point(corners[0] * 3.0 - corners[1] - corners[2])
        }
        _ => LightPosition::directional(random.point(1.0)).expect("not exactly 0"),
    };
    (0..count).map(|i| light(i, random).rounded_to_f32()).collect()
}

fn camera(random: &mut Random) -> Camera {
    Camera::new(random.point(5.0), DVec3::ZERO, 1.2, 0.05, [16, 12]).expect("a good camera")
}

#[test]
fn multiplicities_are_exactly_the_boundary_of_the_coefficients_for_64_lights_at_once() {
    let gpu = gpu();
    let finder = Finder::new(&gpu);
    let mut random = Random(3);
    let mut sides = 0;
    for (name, casters) in scenes(&mut random) {
        let tables = Tables::new(&gpu, &casters).expect("small tables");
        let lights = lights(&mut random, &casters, MOST_LIGHTS);
        let found = find(&gpu, &finder, &tables, &camera(&mut random), &lights);
        let (coefficients, edges) = (read(&gpu, &found.coefficients), read(&gpu, &tables.edges));
        let multiplicities: Vec<Vec<Entry>> = found.multiplicities.iter().map(|table| read(&gpu, table)).collect();
        for i in 0..MOST_LIGHTS {
            let (table, lane) = found.multiplicities_of(i);
            let table = found.multiplicities.iter().position(|t| std::ptr::eq(t, table)).expect("one of them");
            let entries = [coefficients.as_slice(), &multiplicities[table], &edges];
            let of_casters = of_light((&tables, &casters), i, entries, lane);
            for ((caster, (coefficients, multiplicities)), c) in casters.iter().zip(of_casters).zip(0..) {
                let chain = Chain::from_coefficients(coefficients);
                let mut expected = vec![0; multiplicities.len()];
                for side in silhouette(&caster.topology, &chain) {
                    let ends = (side.start.min(side.end), side.start.max(side.end));
                    let e = caster.topology.edges().binary_search_by_key(&ends, |edge| (edge.low, edge.high));
                    let sign = if side.start < side.end { 1 } else { -1 };
                    expected[e.expect("an edge")] = sign * side.multiplicity as i32;
                }
                let wrong = (0..expected.len()).find(|&e| multiplicities[e] != expected[e]);
                assert_eq!(wrong.map(|e| (e, multiplicities[e], expected[e])), None, "{name}, caster {c}, light {i}");
                assert_closed(caster, &multiplicities);
                assert_copies(&found, &tables, (c, i), &edges, caster, &multiplicities);
                sides += multiplicities.iter().filter(|&&m| m != 0).count();
            }
        }
    }
    assert!(sides > 100_000, "{sides} sides");
}

/// A boundary has no boundary: as many sides leave each vertex as arrive.
fn assert_closed(caster: &Caster, multiplicities: &[i32]) {
    let mut leaving = vec![0; caster.positions.len()];
    for (edge, &m) in caster.topology.edges().iter().zip(multiplicities) {
        leaving[edge.low as usize] += m;
        leaving[edge.high as usize] -= m;
    }
    assert!(leaving.iter().all(|&sum| sum == 0));
}

/// No edge is a side more often than it is drawn.
fn assert_copies(
    found: &Found,
    tables: &Tables,
    (c, light): (usize, usize),
    edges: &[Entry],
    caster: &Caster,
    multiplicities: &[i32],
) {
    let ranges = &tables.casters[c];
    for run in &ranges.edges {
        let most = run.most_copies(found.facing[light][c]);
        for e in run.edges.clone() {
            let [low, high] = [edges[e as usize][0], edges[e as usize][1]].map(|i| i - ranges.positions.start);
            let at = caster.topology.edges().binary_search_by_key(&(low, high), |edge| (edge.low, edge.high));
            assert!(multiplicities[at.expect("an edge")].unsigned_abs() <= most);
        }
    }
}

/// How far, relative to the lengths that it is made of, `f32` may have a height wrong: a few roundings, of 2^-24 each.
const ROUNDING: f64 = 8.0 / (1 << 24) as f64;
/// `EDGE_ON` in chain.rs.
const EDGE_ON: f64 = 4e-7;

#[test]
fn coefficients_differ_from_the_cpus_only_where_a_triangle_is_edge_on_but_for_rounding() {
    let gpu = gpu();
    let finder = Finder::new(&gpu);
    let mut random = Random(4);
    let (mut alike, mut differing) = (0, 0);
    for (name, casters) in scenes(&mut random) {
        let tables = Tables::new(&gpu, &casters).expect("small tables");
        let lights = lights(&mut random, &casters, MOST_LIGHTS);
        let camera = camera(&mut random);
        let found = find(&gpu, &finder, &tables, &camera, &lights);
        let coefficients = read(&gpu, &found.coefficients);
        for ((i, &light), (caster, ranges)) in
            lights.iter().enumerate().flat_map(|light| casters.iter().zip(&tables.casters).map(move |c| (light, c)))
        {
            let counting = counting(caster, &camera, light);
            let chain = Chain::new(caster, light, &counting);
            for (t, &expected) in chain.coefficients().iter().enumerate() {
                let bits = coefficients[ranges.triangles.start as usize + t][i / 16] >> (2 * (i % 16)) & 3;
                if bits == [0, 1, 2][usize::from(expected.unsigned_abs()) * if expected < 0 { 2 } else { 1 }] {
                    alike += 1;
                    continue;
                }
                differing += 1;
                let counts_every = counting[caster.topology.component_of_triangle()[t] as usize] == Counting::Every;
                let excess = excess(caster, t, light, counts_every);
                assert!(excess <= 0.0, "{name}, light {i}, triangle {t}: {expected} or {bits}, off by {excess}");
            }
        }
    }
    println!("{alike} coefficients alike, {differing} of edge-on triangles not");
    assert!(alike > 1_000_000 && differing * 1000 < alike);
}

fn counting(caster: &Caster, camera: &Camera, light: LightPosition) -> Vec<Counting> {
    let components = caster.topology.components();
    let mut bounds = vec![umbrae_core::Bounds::EMPTY; components.len()];
    for (t, &component) in caster.topology.component_of_triangle().iter().enumerate() {
        for corner in caster.corners(t) {
            bounds[component as usize] = bounds[component as usize].including(corner.as_dvec3());
        }
    }
    let is_opaque = !caster.role.is_see_through();
    let of = |is_closed: bool, bounds| match is_closed && is_opaque {
        true => Counting::of_box(bounds, &caster.bounds, camera, light),
        false => Counting::Every,
    };
    components.iter().zip(&bounds).map(|(component, bounds)| of(component.is_closed, bounds)).collect()
}

/// How much more than rounding lies between the light and where the coefficient of triangle `t` changes.
fn excess(caster: &Caster, t: usize, light: LightPosition, counts_every: bool) -> f64 {
    let [a, b, c] = caster.corners(t).map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    let to_light = light.offset_from(a);
    let height = normal.dot(to_light).abs();
    let reach = |p: DVec3| p.abs().max_element();
    let bounds = caster.bounds;
    let size = reach(bounds.min).max(reach(bounds.max)).max(reach(light.homogeneous().truncate()));
    let edge_on = EDGE_ON * if light.is_directional() { 1.0 } else { size };
    let rounding = ROUNDING * (b - a).length() * (c - a).length() * (to_light.length() + edge_on);
    let border = if counts_every { edge_on * normal.length() } else { 0.0 };
    (height - border).abs() - rounding
}

#[test]
fn a_table_with_more_rows_than_the_device_allows_is_refused_with_both_sizes() {
    let gpu = gpu();
    let rows = gpu.device.limits().max_texture_dimension_2d as usize;
    assert!(Table::new(&gpu, "as large as can be", 1).is_ok());
    let error = Table::new(&gpu, "too large", rows * 2048 + 1).expect_err("one row too many");
    let text = error.to_string();
    assert!(text.contains(&((rows + 1) * 2048 * 16).to_string()), "{text}");
    assert!(text.contains(&(rows * 2048 * 16).to_string()), "{text}");
}
