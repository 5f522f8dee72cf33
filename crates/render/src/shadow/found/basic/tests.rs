//! What the passes find, read back.

use std::collections::BTreeMap;
use std::mem::offset_of;
use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3, Vec3};
use umbrae_core::{Camera, Caster, Chain, Counting, LightPosition, Mesh, Object, Role, Scene, Surface, shapes};

use super::parts::parts;
use super::pass::{
    Batch, FindPass, FoundInUniform, FoundLanesUniform, FoundLightsUniform, MOST_LIGHTS, lights_in_texel,
};
use super::tables::{Entry, PartTables, Table, Tables};
use crate::displacement::NOT_MOVED;
use crate::timing::PassTimer;
use crate::uniforms::tests::wgsl_layout;
use crate::{AdapterChoice, Gpu};
use random::Random;
use soup::soup;

#[path = "../../../../tests/random/mod.rs"]
mod random;
#[path = "../../../../tests/soup/mod.rs"]
mod soup;

fn gpu() -> Gpu {
    pollster::block_on(Gpu::new(&AdapterChoice::default())).expect("tests need a graphics driver: run scripts/setup.sh")
}

fn read(gpu: &Gpu, table: &Table) -> Vec<Entry> {
    let bytes = pollster::block_on(gpu.read(&table.texture)).expect("the device is there");
    bytemuck::pod_collect_to_vec(&bytes)
}

fn find(gpu: &Gpu, pass: &FindPass, tables: &Tables, camera: &Camera, lights: &[LightPosition]) -> Batch {
    let mut batch = pass.batch(gpu, tables).expect("small tables");
    batch.plan(tables, camera, lights.iter().copied());
    pass.make_lanes(gpu, tables, &mut batch, lights.len()).expect("small tables");
    batch.upload(gpu);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("find") });
    pass.draw(&mut encoder, tables, &batch, &mut PassTimer::off());
    gpu.queue.submit([encoder.finish()]);
    batch
}

/// What was found for one light, of all casters.
struct OfLight<'a> {
    tables: &'a Tables,
    light: usize,
    lane: usize,
    coefficients: &'a [Entry],
    multiplicities: &'a [Entry],
}

impl OfLight<'_> {
    fn coefficient(&self, t: u32) -> i32 {
        match self.coefficients[t as usize][self.light / 16] >> (2 * (self.light % 16)) & 3 {
            0 => 0,
            1 => 1,
            2 => -1,
            both => panic!("triangle {t} has {both}"),
        }
    }

    fn multiplicity(&self, e: u32) -> i32 {
        let bits = self.tables.lane_bits as usize;
        let bit = self.lane * bits;
        let lane = u64::from(self.multiplicities[e as usize][bit / 32]) >> (bit % 32) & ((1 << bits) - 1);
        (lane as i64 - (1 << (bits - 1))) as i32
    }
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
    let pass = FindPass::new(&gpu);
    let mut random = Random::new(3);
    let mut sides = 0;
    for (i, (name, casters)) in scenes(&mut random).into_iter().enumerate() {
        let may_sum = i % 2 == 1;
        let tables = Tables::new(&gpu, &casters, (None, vec![false; casters.len()]), may_sum).expect("small tables");
        let lights = lights(&mut random, &casters, MOST_LIGHTS);
        let found = find(&gpu, &pass, &tables, &camera(&mut random), &lights);
        let [coefficients, edges, triangles, incidences] =
            [&found.coefficients, &tables.edges, &tables.triangles, &tables.incidences].map(|table| read(&gpu, table));
        let multiplicities: Vec<Vec<Entry>> = found.lanes.iter().map(|l| read(&gpu, &l.multiplicities)).collect();
        for light in 0..MOST_LIGHTS {
            let lanes = lights_in_texel(&tables);
            let (coefficients, multiplicities) = (&coefficients, &multiplicities[light / lanes]);
            let lane = light % lanes;
            let found_of = OfLight { tables: &tables, light, lane, coefficients, multiplicities };
            for (c, ranges) in tables.casters.iter().enumerate() {
                for part in &ranges.parts {
                    let expected = boundary(part, &triangles, &found_of);
                    let mut leaving = BTreeMap::new();
                    let mut of_part = BTreeMap::new();
                    for run in &part.edges {
                        for e in run.edges.clone() {
                            let [low, high, first, middle] = edges[e as usize];
                            assert_eq!(middle + 1, ranges.positions.start);
                            let count = incidences[first as usize][0];
                            let m = found_of.multiplicity(e);
                            assert!(
                                m.unsigned_abs() <= run.most_copies(found.is_facing(&tables, c, light)),
                                "{name}, light {light}"
                            );
                            *leaving.entry(low).or_insert(0) += m;
                            *leaving.entry(high).or_insert(0) -= m;
                            assert_eq!(
                                of_part.insert((low, high), m),
                                None,
                                "{name}: one entry for each edge of a part"
                            );
                            let flat = |i: u32| incidences[(first + i / 4) as usize][i as usize % 4] >> 1;
                            assert!((1..=count).all(|i| part.triangles.contains(&flat(i))));
                            sides += usize::from(m != 0);
                        }
                    }
                    let wrong = of_part.iter().find(|&(ends, m)| expected.get(ends) != Some(m));
                    assert_eq!(wrong, None, "{name}, caster {c}, light {light}");
                    assert_eq!(of_part.len(), expected.len());
                    // A boundary has no boundary: as many sides leave each vertex as arrive.
                    assert!(leaving.values().all(|&sum| sum == 0), "{name}, light {light}");
                }
            }
        }
    }
    assert!(sides > 100_000, "{sides} sides");
}

/// For each edge of a part, from lower to higher corner, how often the chain's boundary runs along it: from the corners of triangles alone.
fn boundary(part: &PartTables, triangles: &[Entry], found: &OfLight<'_>) -> BTreeMap<(u32, u32), i32> {
    let mut boundary = BTreeMap::new();
    for t in part.triangles.clone() {
        let [a, b, c, _] = triangles[t as usize];
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let direction = if from < to { 1 } else { -1 };
            *boundary.entry((from.min(to), from.max(to))).or_insert(0) += direction * found.coefficient(t);
        }
    }
    boundary
}

/// How far, relative to the lengths that it is made of, `f32` may have a height wrong: a few roundings, of 2^-24 each.
const ROUNDING: f64 = 8.0 / (1 << 24) as f64;
/// `EDGE_ON` in chain.rs.
const EDGE_ON: f64 = 4e-7;

#[test]
fn coefficients_differ_from_the_cpus_only_where_a_triangle_is_edge_on_but_for_rounding() {
    let gpu = gpu();
    let pass = FindPass::new(&gpu);
    let mut random = Random::new(4);
    let (mut alike, mut differing) = (0, 0);
    for (name, casters) in scenes(&mut random) {
        let tables = Tables::new(&gpu, &casters, (None, vec![false; casters.len()]), false).expect("small tables");
        let lights = lights(&mut random, &casters, MOST_LIGHTS);
        let camera = camera(&mut random);
        let found = find(&gpu, &pass, &tables, &camera, &lights);
        let coefficients = read(&gpu, &found.coefficients);
        // Which triangle of the caster each of its entries is follows from the partition, which is the same every time.
        let order = |caster| parts(caster).into_iter().flat_map(|part| part.triangles).collect::<Vec<u32>>();
        let orders: Vec<Vec<u32>> = casters.iter().map(order).collect();
        let of_casters = || casters.iter().zip(&tables.casters).zip(&orders);
        for ((i, &light), ((caster, ranges), order)) in
            lights.iter().enumerate().flat_map(|light| of_casters().map(move |of_caster| (light, of_caster)))
        {
            let counting = counting(caster, &camera, light);
            let chain = Chain::new(caster, light, &counting);
            for (&t, entry) in order.iter().zip(ranges.parts[0].triangles.start..) {
                let t = t as usize;
                let expected = chain.coefficients()[t];
                let bits = coefficients[entry as usize][i / 16] >> (2 * (i % 16)) & 3;
                if bits == if expected < 0 { 2 } else { u32::from(expected.unsigned_abs()) } {
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

/// The sources of all modules as they are compiled, by name.
pub(super) fn sources() -> [(&'static str, String); 3] {
    let tables = include_str!("../../../shaders/found_tables.wgsl");
    let flat_normal = include_str!("../../../shaders/flat_normal.wgsl");
    let find = [tables, flat_normal, include_str!("../../../shaders/find_basic.wgsl")];
    let volume = [
        include_str!("../../../shaders/view.wgsl"),
        include_str!("../../../shaders/light.wgsl"),
        include_str!("../../../shaders/volume.wgsl"),
        tables,
        include_str!("../../../shaders/found_basic_volume.wgsl"),
    ];
    let displace = [tables, flat_normal, include_str!("../../../shaders/displace.wgsl"), NOT_MOVED];
    [("find_basic", find.concat()), ("found_basic_volume", volume.concat()), ("displace", displace.concat())]
}

#[test]
fn what_passes_are_told_has_the_same_bytes_in_rust_and_wgsl() {
    let [(_, find), (_, volume), _] = sources();
    let names = |source: &str, name: &str, size: usize| -> Vec<(String, usize)> {
        let (span, members) = wgsl_layout(source, name);
        assert_eq!(span, size, "size of {name}");
        members
    };
    let named = |members: &[(&str, usize)]| -> Vec<(String, usize)> {
        members.iter().map(|&(name, offset)| (name.to_owned(), offset)).collect()
    };
    assert_eq!(
        names(&find, "FoundLights", size_of::<FoundLightsUniform>()),
        named(&[
            ("positions_world", offset_of!(FoundLightsUniform, positions_world)),
            ("count", offset_of!(FoundLightsUniform, count)),
            ("triangle_count", offset_of!(FoundLightsUniform, triangle_count)),
            ("edge_count", offset_of!(FoundLightsUniform, edge_count)),
            ("lane_bits", offset_of!(FoundLightsUniform, lane_bits)),
        ])
    );
    assert_eq!(
        names(&find, "FoundLanes", size_of::<FoundLanesUniform>()),
        named(&[
            ("first_light", offset_of!(FoundLanesUniform, first_light)),
            ("unused_a", offset_of!(FoundLanesUniform, unused_a)),
            ("unused_b", offset_of!(FoundLanesUniform, unused_b)),
            ("unused_c", offset_of!(FoundLanesUniform, unused_c)),
        ])
    );
    assert_eq!(
        names(&volume, "FoundIn", size_of::<FoundInUniform>()),
        named(&[
            ("number", offset_of!(FoundInUniform, number)),
            ("lane", offset_of!(FoundInUniform, lane)),
            ("lane_bits", offset_of!(FoundInUniform, lane_bits)),
            ("unused", offset_of!(FoundInUniform, unused)),
        ])
    );
    assert!(size_of::<FoundLightsUniform>() <= 16 << 10, "WebGL2 has uniform buffers of 16 KiB");
}
