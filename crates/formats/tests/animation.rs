//! Real models at many moments, against a slow and plain computation on what the crate `gltf` reads.

mod shared_data;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4, Mat4, Vec3};
use gltf::animation::util::ReadOutputs;
use gltf::animation::{Interpolation, Property};
use umbrae_core::{Caster, Topology};
use umbrae_formats::{LoadOptions, Model, load};

/// Models that something moves, with what is played when nothing is asked for, and for how long.
const MODELS: [(&str, &[usize], f64); 8] = [
    ("gltf/AnimatedMorphCube.glb", &[0], 4.2),
    ("gltf/BoxAnimated.glb", &[0], 3.7083),
    ("gltf/CesiumMan.glb", &[0], 2.0),
    ("gltf/Fox.glb", &[0], 3.4167),
    ("gltf/InterpolationTest.glb", &[0, 1, 2, 3, 4, 5, 6, 7, 8], 1.7083),
    ("gltf/MorphStressTest.glb", &[0], 9.3667),
    ("gltf/RecursiveSkeletons.glb", &[0], 2.0),
    ("gltf/SimpleSkin/SimpleSkin.gltf", &[0], 5.5),
];

/// Parts of the duration; the last is after the end.
const MOMENTS: [f64; 6] = [0.0, 0.123, 0.5, 0.77, 1.0, 2.5];

fn ours(path: &Path) -> Model {
    load(path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether a triangle has three different corners where it was modelled; others may or may not be kept.
fn has_area_at_rest([a, b, c]: [Vec3; 3]) -> bool {
    a != b && b != c && c != a
}

/// Corner after corner of all triangles, object after object, in the model's own coordinates.
fn our_corners(model: &Model) -> Vec<Vec<DVec3>> {
    let corners = |object: &umbrae_core::Object| {
        let posed: Vec<DVec3> = object.positions().map(|p| p + model.scene.origin).collect();
        let rest = object.mesh.positions();
        let triangles = object.mesh.triangles().iter().filter(|t| has_area_at_rest(t.map(|i| rest[i as usize])));
        triangles.flatten().map(|&i| posed[i as usize]).collect()
    };
    model.scene.objects.iter().map(corners).collect()
}

/// A file as the crate `gltf` reads it.
struct Theirs {
    document: gltf::Document,
    buffers: Vec<Vec<u8>>,
}

/// The translation, rotation, scale and weights that animations give nodes.
#[derive(Default)]
struct Moved {
    translations: BTreeMap<usize, DVec3>,
    rotations: BTreeMap<usize, DQuat>,
    scales: BTreeMap<usize, DVec3>,
    weights: BTreeMap<usize, Vec<f64>>,
}

impl Theirs {
    fn read(path: &Path) -> Self {
        let gltf::Gltf { document, mut blob } =
            gltf::Gltf::from_slice(&fs::read(path).expect("it is there")).expect("it is good");
        let folder = path.parent().expect("it is in a folder");
        let content = |buffer: gltf::Buffer<'_>| match buffer.source() {
            gltf::buffer::Source::Bin => blob.take().expect("it has a chunk"),
            gltf::buffer::Source::Uri(uri) => fs::read(folder.join(uri)).expect("its buffer is there"),
        };
        let buffers = document.buffers().map(content).collect();
        Self { document, buffers }
    }

    fn buffer(&self, buffer: &gltf::Buffer<'_>) -> Option<&[u8]> {
        self.buffers.get(buffer.index()).map(Vec::as_slice)
    }

    fn moved(&self, animations: &[usize], time_s: f64) -> Moved {
        let mut moved = Moved::default();
        for animation in self.document.animations().filter(|animation| animations.contains(&animation.index())) {
            for channel in animation.channels() {
                let reader = channel.reader(|buffer| self.buffer(&buffer));
                let times: Vec<f64> = reader.read_inputs().expect("it has times").map(f64::from).collect();
                let node = channel.target().node().index();
                let interpolation = channel.sampler().interpolation();
                let at = |values: &[f64], width: usize| between(&times, values, width, interpolation, time_s);
                let flat =
                    |vectors: gltf::accessor::Iter<'_, [f32; 3]>| vectors.flatten().map(f64::from).collect::<Vec<_>>();
                match (channel.target().property(), reader.read_outputs().expect("it has values")) {
                    (Property::Translation, ReadOutputs::Translations(values)) => {
                        moved.translations.insert(node, DVec3::from_slice(&at(&flat(values), 3)));
                    }
                    (Property::Scale, ReadOutputs::Scales(values)) => {
                        moved.scales.insert(node, DVec3::from_slice(&at(&flat(values), 3)));
                    }
                    (Property::Rotation, ReadOutputs::Rotations(values)) => {
                        let values: Vec<f64> = values.into_f32().flatten().map(f64::from).collect();
                        moved.rotations.insert(node, rotation_between(&times, &values, interpolation, time_s));
                    }
                    (Property::MorphTargetWeights, ReadOutputs::MorphTargetWeights(values)) => {
                        let values: Vec<f64> = values.into_f32().map(f64::from).collect();
                        let mesh = channel.target().node().mesh().expect("it has weights");
                        let targets = mesh.primitives().next().expect("it has a primitive").morph_targets().len();
                        moved.weights.insert(node, at(&values, targets));
                    }
                    _ => panic!("a channel of one thing has values of another"),
                }
            }
        }
        moved
    }

    fn parent_from_node(node: &gltf::Node<'_>, moved: &Moved) -> DAffine3 {
        let index = node.index();
        let (translation, rotation, scale) = node.transform().decomposed();
        let vector =
            |given: Option<&DVec3>, rest: [f32; 3]| given.copied().unwrap_or_else(|| Vec3::from(rest).as_dvec3());
        let rest = DVec4::from_array(rotation.map(f64::from)).try_normalize().expect("it is a rotation");
        DAffine3::from_translation(vector(moved.translations.get(&index), translation))
            * DAffine3::from_quat(moved.rotations.get(&index).copied().unwrap_or(DQuat::from_vec4(rest)))
            * DAffine3::from_scale(vector(moved.scales.get(&index), scale))
    }

    /// Corner after corner of all triangles, node after node, z up.
    fn corners(&self, animations: &[usize], time_s: f64) -> Vec<Vec<DVec3>> {
        let moved = self.moved(animations, time_s);
        let scene = self.document.default_scene().or_else(|| self.document.scenes().next()).expect("it has a scene");
        let mut order = Vec::new();
        let mut world = BTreeMap::new();
        let mut waiting: Vec<_> = scene.nodes().map(|node| (node, DAffine3::IDENTITY)).collect();
        waiting.reverse();
        while let Some((node, world_from_parent)) = waiting.pop() {
            let world_from_node = world_from_parent * Self::parent_from_node(&node, &moved);
            world.insert(node.index(), world_from_node);
            let mut children: Vec<_> = node.children().map(|child| (child, world_from_node)).collect();
            children.reverse();
            waiting.extend(children);
            order.push(node);
        }
        let shown = order.iter().filter_map(|node| Some((node, node.mesh()?)));
        shown.map(|(node, mesh)| self.corners_of_node(node, &mesh, &world, &moved)).collect()
    }

    fn corners_of_node(
        &self,
        node: &gltf::Node<'_>,
        mesh: &gltf::Mesh<'_>,
        world: &BTreeMap<usize, DAffine3>,
        moved: &Moved,
    ) -> Vec<DVec3> {
        let at_rest = node.weights().or_else(|| mesh.weights()).unwrap_or_default();
        let at_rest: Vec<f64> = at_rest.iter().copied().map(f64::from).collect();
        let weights = moved.weights.get(&node.index()).unwrap_or(&at_rest);
        let joints: Vec<DMat4> = node.skin().map_or(Vec::new(), |skin| {
            let reader = skin.reader(|buffer| self.buffer(&buffer));
            let binds = reader.read_inverse_bind_matrices().expect("it has matrices");
            let bind = |bind: [[f32; 4]; 4]| Mat4::from_cols_array_2d(&bind).as_dmat4();
            skin.joints().zip(binds).map(|(joint, m)| DMat4::from(world[&joint.index()]) * bind(m)).collect()
        });
        let mut corners = Vec::new();
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|buffer| self.buffer(&buffer));
            let rest: Vec<Vec3> = reader.read_positions().expect("it has positions").map(Vec3::from).collect();
            let mut posed: Vec<DVec3> = rest.iter().map(|p| p.as_dvec3()).collect();
            for ((offsets, ..), weight) in reader.read_morph_targets().zip(weights) {
                for (p, offset) in posed.iter_mut().zip(offsets.into_iter().flatten()) {
                    *p += *weight * Vec3::from(offset).as_dvec3();
                }
            }
            if joints.is_empty() {
                posed.iter_mut().for_each(|p| *p = world[&node.index()].transform_point3(*p));
            } else {
                let of_vertex = reader.read_joints(0).expect("it has joints").into_u16();
                let weights = reader.read_weights(0).expect("it has weights").into_f32();
                for (p, (of_vertex, weights)) in posed.iter_mut().zip(of_vertex.zip(weights)) {
                    let weights = DVec4::from_array(weights.map(f64::from));
                    let weights = weights / weights.element_sum();
                    let blend = of_vertex.iter().zip(weights.to_array()).map(|(&j, w)| joints[usize::from(j)] * w);
                    *p = blend.fold(DMat4::ZERO, |sum, m| sum + m).transform_point3(*p);
                }
            }
            let indices: Vec<u32> = reader
                .read_indices()
                .map_or_else(|| (0..rest.len() as u32).collect(), |indices| indices.into_u32().collect());
            let triangles = indices.as_chunks().0.iter().copied();
            let triangles = triangles.filter(|t: &[u32; 3]| has_area_at_rest(t.map(|i| rest[i as usize])));
            corners.extend(triangles.flatten().map(|i| posed[i as usize]).map(|p| DVec3::new(p.x, -p.z, p.y)));
        }
        corners
    }
}

/// The keys around a time, the part of the way between them, and the time between them.
fn keys_around(times: &[f64], time_s: f64) -> (usize, usize, f64, f64) {
    let last = times.len() - 1;
    if time_s <= times[0] {
        return (0, 0, 0.0, 0.0);
    }
    if time_s >= times[last] {
        return (last, last, 0.0, 0.0);
    }
    let next = (0..=last).find(|&key| times[key] > time_s).expect("it is before the last");
    let duration = times[next] - times[next - 1];
    (next - 1, next, (time_s - times[next - 1]) / duration, duration)
}

/// As the specification says, number by number.
fn between(times: &[f64], values: &[f64], width: usize, interpolation: Interpolation, time_s: f64) -> Vec<f64> {
    let (k, l, t, duration) = keys_around(times, time_s);
    let number = |i: usize| match interpolation {
        Interpolation::Step => values[k * width + i],
        Interpolation::Linear => values[k * width + i] + t * (values[l * width + i] - values[k * width + i]),
        Interpolation::CubicSpline => {
            let [value, out, arrive, next] =
                [(k, 1), (k, 2), (l, 0), (l, 1)].map(|(key, part)| values[(3 * key + part) * width + i]);
            let (t2, t3) = (t * t, t * t * t);
            (2.0 * t3 - 3.0 * t2 + 1.0) * value
                + duration * (t3 - 2.0 * t2 + t) * out
                + (-2.0 * t3 + 3.0 * t2) * next
                + duration * (t3 - t2) * arrive
        }
    };
    (0..width).map(number).collect()
}

/// A line of rotations is a turn about one axis; here by axis and angle.
fn rotation_between(times: &[f64], values: &[f64], interpolation: Interpolation, time_s: f64) -> DQuat {
    let unit =
        |numbers: &[f64]| DQuat::from_vec4(DVec4::from_slice(numbers).try_normalize().expect("it is a rotation"));
    if interpolation != Interpolation::Linear {
        return unit(&between(times, values, 4, interpolation, time_s));
    }
    let (k, l, t, _) = keys_around(times, time_s);
    let [from, to] = [k, l].map(|key| unit(&values[4 * key..4 * key + 4]));
    let (axis, mut angle) = (from.inverse() * to).to_axis_angle();
    if angle > PI {
        angle -= 2.0 * PI;
    }
    from * DQuat::from_axis_angle(axis, t * angle)
}

#[test]
fn every_vertex_is_where_an_independent_computation_puts_it() {
    let Some(folder) = shared_data::folder() else { return };
    for (file, played, duration_s) in MODELS {
        let path = folder.join(file);
        let (mut model, theirs) = (ours(&path), Theirs::read(&path));
        let playing = model.animations.choose(None).expect("something is played");
        assert!((playing.duration_s() - duration_s).abs() < 1e-3, "{file} takes {} s", playing.duration_s());
        assert_eq!(playing.note().is_some(), played.len() < model.animations.iter().count(), "{file}");
        let at_rest = our_corners(&model);
        let mut has_moved = false;
        for part in MOMENTS {
            let time_s = part * duration_s;
            let warnings = model.animations.pose(&mut model.scene, &playing, time_s).expect("a good time");
            assert!(warnings.is_empty(), "{file} at {time_s} s: {warnings:?}");
            let (ours, theirs) = (our_corners(&model), theirs.corners(played, time_s));
            assert_eq!(ours.len(), theirs.len(), "{file}: objects");
            let radius = model.scene.bounds().radius();
            let mut furthest_m: f64 = 0.0;
            for (ours, theirs) in ours.iter().zip(&theirs) {
                assert_eq!(ours.len(), theirs.len(), "{file}: corners");
                furthest_m = ours.iter().zip(theirs).map(|(a, b)| a.distance(*b)).fold(furthest_m, f64::max);
            }
            // Weights of vertices are f32.
            assert!(furthest_m < 2e-7 * radius, "{file} at {time_s} s: {furthest_m} m in {radius} m");
            has_moved |= ours != at_rest;
        }
        assert!(has_moved, "{file} moves");
    }
}

/// Whether every edge has as many triangles one way as the other is decided once, for all moments.
#[test]
fn a_body_that_is_closed_where_it_was_modelled_is_closed_at_all_moments() {
    let Some(folder) = shared_data::folder() else { return };
    for (file, bodies) in
        [("CesiumMan", 1), ("Fox", 1), ("AnimatedMorphCube", 1), ("MorphStressTest", 2), ("RecursiveSkeletons", 1)]
    {
        let model = ours(&folder.join(format!("gltf/{file}.glb")));
        let counts = Topology::new(&model.scene.objects[0].mesh).counts();
        assert!(counts.is_closed(), "{file}: {counts:?}");
        assert_eq!(counts.other_components, 0, "{file}: {counts:?}");
        assert!(counts.closed_components >= bodies, "{file}: {counts:?}");
    }
}

#[test]
fn eighty_four_skeletons_share_one_mesh_and_one_deformer() {
    let Some(folder) = shared_data::folder() else { return };
    let model = ours(&folder.join("gltf/RecursiveSkeletons.glb"));
    let objects = &model.scene.objects;
    assert_eq!(objects.len(), 84);
    assert!(objects.iter().all(|object| Arc::ptr_eq(&object.mesh, &objects[0].mesh)));
    let deformer = |object: &umbrae_core::Object| object.pose.as_ref().expect("it is posed").deformer.clone();
    assert!(objects.iter().all(|object| Arc::ptr_eq(&deformer(object), &deformer(&objects[0]))));
    let casters = Caster::of_scene(&model.scene);
    assert!(casters.iter().all(|caster| Arc::ptr_eq(&caster.topology, &casters[0].topology)));
    let mut places = BTreeSet::new();
    places.extend(casters.iter().map(|caster| caster.bounds.center().to_array().map(f64::to_bits)));
    assert_eq!(places.len(), 84, "each in its own place");
}

#[test]
fn what_a_moment_looks_like_does_not_depend_on_what_was_shown_before() {
    let Some(folder) = shared_data::folder() else { return };
    let path = folder.join("gltf/Fox.glb");
    let mut fox = ours(&path);
    let walk = fox.animations.choose(Some("Walk")).expect("it can walk");
    for (animation, time_s) in [("Survey", 2.0), ("Run", 0.5), ("Run", 0.1), ("Survey", 3.0)] {
        let other = fox.animations.choose(Some(animation)).expect("it can do that too");
        fox.animations.pose(&mut fox.scene, &other, time_s).expect("a good time");
    }
    fox.animations.pose(&mut fox.scene, &walk, 0.3).expect("a good time");
    let mut fresh = ours(&path);
    fresh.play(Some("Walk"), 0.3).expect("a good time");
    assert!(our_corners(&fox) == our_corners(&fresh));
    assert!(our_corners(&fox) != our_corners(&ours(&path)));
}

#[test]
fn a_caster_that_is_posed_again_is_the_one_that_would_be_made() {
    let Some(folder) = shared_data::folder() else { return };
    let mut man = ours(&folder.join("gltf/CesiumMan.glb"));
    let mut casters = Caster::of_scene(&man.scene);
    man.play(None, 1.25).expect("a good time");
    casters[0].pose_to(&man.scene.objects[0]);
    let made = Caster::of_scene(&man.scene);
    assert_eq!((&casters[0].positions, casters[0].bounds), (&made[0].positions, made[0].bounds));
}

/// The inner box is lifted by 2.52 m within 1.25 s, stands on its head 1.25 s later, and is let down again.
#[test]
fn the_animated_box_is_lifted_and_turned() {
    let Some(folder) = shared_data::folder() else { return };
    let mut model = ours(&folder.join("gltf/BoxAnimated.glb"));
    let is_inner = |object: &&umbrae_core::Object| object.world_from_object != DAffine3::IDENTITY;
    let mut inner = |time_s: f64| {
        model.play(None, time_s).expect("a good time");
        let box_at = model.scene.objects.iter().rfind(is_inner).expect("there are two").world_from_object;
        (box_at.translation.z, box_at.matrix3 * DVec3::Y)
    };
    let near = |(height, up): (f64, DVec3), expected_height: f64, expected_up: DVec3| {
        assert!((height - expected_height).abs() < 1e-6, "{height} is not {expected_height}");
        assert!(up.distance(expected_up) < 1e-6, "{up} is not {expected_up}");
    };
    near(inner(0.0), 0.0, DVec3::Z);
    near(inner(0.625), 1.26, DVec3::Z);
    near(inner(1.875), 2.52, DVec3::NEG_Y);
    near(inner(2.5), 2.52, DVec3::NEG_Z);
    near(inner(99.0), 0.0, DVec3::NEG_Z);
}
