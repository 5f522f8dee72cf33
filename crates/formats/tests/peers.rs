//! On good files we read what other crates read: the same corners, in the same order, bit for bit.
//!
//! Those crates don't serve for loading (the top of each reader says why), but they are independent of ours.

mod shared_data;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat4, DVec3, Mat4, Vec3};
use ply_rs_bw::ply::{DefaultElement, Property};
use umbrae_core::Bounds;
use umbrae_formats::{LoadOptions, Model, UpAxis, load};

/// The files of the data's `folder` whose names end in one of `endings`.
fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let Some(root) = shared_data::folder() else { return Vec::new() };
    let entries = fs::read_dir(root.join(folder)).expect("a folder that can be read");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry that can be read").path()).collect();
    paths.retain(|path| endings.iter().any(|ending| path.to_string_lossy().to_lowercase().ends_with(ending)));
    paths.sort();
    paths
}

/// As the file has it: z up, so that nothing is turned.
fn ours(path: &Path) -> Model {
    load(path, &LoadOptions { up: Some(UpAxis::Z), ..LoadOptions::default() }).unwrap_or_else(|error| panic!("{error}"))
}

/// Corner after corner of all triangles, in the model's own coordinates.
fn corners(model: &Model) -> Vec<Vec3> {
    assert_eq!(model.scene.origin, DVec3::ZERO);
    let of_object = |object: &umbrae_core::Object| {
        let positions = object.mesh.positions().to_vec();
        object.mesh.triangles().iter().flatten().map(|&i| positions[i as usize]).collect::<Vec<_>>()
    };
    model.scene.objects.iter().flat_map(of_object).collect()
}

fn assert_same(path: &Path, ours: &[Vec3], theirs: &[Vec3]) {
    assert_eq!(ours.len(), theirs.len(), "{}", path.display());
    let differing = ours.iter().zip(theirs).position(|(a, b)| a != b);
    assert_eq!(differing, None, "the first corner of {} that differs", path.display());
}

#[test]
fn stl_io_reads_the_same_triangles() {
    for path in files("mesh", &[".stl"]) {
        let stl = stl_io::read_stl(&mut fs::File::open(&path).expect("it is there")).expect("it is good");
        let corner = |&i: &usize| Vec3::from(stl.vertices[i].0);
        let theirs: Vec<Vec3> = stl.faces.iter().flat_map(|face| &face.vertices).map(corner).collect();
        assert_same(&path, &corners(&ours(&path)), &theirs);
    }
}

#[test]
fn tobj_reads_the_same_triangles() {
    for path in files("mesh", &[".obj"]) {
        let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
        let (models, _) = tobj::load_obj(&path, &options).expect("it is good");
        let of_model = |model: &tobj::Model| {
            let position = |&i: &u32| DVec3::from_slice(&model.mesh.positions[3 * i as usize..]).as_vec3();
            model.mesh.indices.iter().map(position).collect::<Vec<_>>()
        };
        let theirs: Vec<Vec3> = models.iter().flat_map(of_model).collect();
        let ours = corners(&ours(&path));
        if path.ends_with("spot_control_mesh.obj") {
            // Some of its quads are concave: a fan, as tobj cuts them, would cover too much.
            let bits =
                |corners: &[Vec3]| corners.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<BTreeSet<_>>();
            assert_eq!((ours.len(), bits(&ours)), (theirs.len(), bits(&theirs)));
        } else {
            assert_same(&path, &ours, &theirs);
        }
    }
}

#[test]
fn ply_rs_reads_the_same_triangles() {
    let mut paths = files("mesh", &[".ply"]);
    paths.extend(files("nasty", &["mirror.ply", "newline.ply"]));
    for path in paths {
        let parser = ply_rs_bw::parser::Parser::<DefaultElement>::new();
        let ply = parser.read_ply(&mut fs::File::open(&path).expect("it is there")).expect("it is good");
        let number = |vertex: &DefaultElement, name: &str| match vertex[name] {
            Property::Float(value) => value,
            ref other => panic!("{name} is {other:?}"),
        };
        let vertices: Vec<Vec3> =
            ply.payload["vertex"].iter().map(|v| Vec3::new(number(v, "x"), number(v, "y"), number(v, "z"))).collect();
        let indices = |face: &DefaultElement| match &face["vertex_indices"] {
            Property::ListInt(list) => list.iter().map(|&i| i as usize).collect::<Vec<_>>(),
            other => panic!("vertex_indices are {other:?}"),
        };
        let theirs: Vec<Vec3> = ply.payload["face"].iter().flat_map(indices).map(|i| vertices[i]).collect();
        assert_same(&path, &corners(&ours(&path)), &theirs);
    }
}

/// What the crate `gltf` says that a file shows, where nothing is posed or instanced.
struct Gltf {
    /// The bits of all positions that triangles use, each in its mesh's own space.
    positions: BTreeSet<[u32; 3]>,
    bounds: Bounds,
}

fn gltf_of(path: &Path) -> Option<Gltf> {
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&fs::read(path).expect("it is there")).ok()?;
    let blob = blob?;
    let is_posed = document.skins().len() > 0 || document.meshes().any(|mesh| mesh.weights().is_some());
    if is_posed || document.extensions_used().any(|extension| extension == "EXT_mesh_gpu_instancing") {
        return None;
    }
    let mut read = Gltf { positions: BTreeSet::new(), bounds: Bounds::EMPTY };
    let scene = document.default_scene().or_else(|| document.scenes().next())?;
    let mut waiting: Vec<_> = scene.nodes().map(|node| (node, DAffine3::IDENTITY)).collect();
    while let Some((node, world_from_parent)) = waiting.pop() {
        let parent_from_node = Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        let world_from_node = world_from_parent * DAffine3::from_mat4(parent_from_node);
        waiting.extend(node.children().map(|child| (child, world_from_node)));
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            let reader = primitive.reader(|_| Some(&blob));
            let positions: Vec<[f32; 3]> = reader.read_positions().expect("it has positions").collect();
            let indices: Vec<u32> = reader
                .read_indices()
                .map_or_else(|| (0..positions.len() as u32).collect(), |indices| indices.into_u32().collect());
            let used = |t: &&[u32; 3]| {
                let [a, b, c] = t.map(|i| Vec3::from(positions[i as usize]));
                a != b && b != c && c != a
            };
            for &index in indices.as_chunks::<3>().0.iter().filter(used).flatten() {
                let position = Vec3::from(positions[index as usize]) + Vec3::ZERO;
                read.positions.insert(position.to_array().map(f32::to_bits));
                read.bounds = read.bounds.including(world_from_node.transform_point3(position.as_dvec3()));
            }
        }
    }
    Some(read)
}

#[test]
fn gltf_reads_the_same_positions_and_puts_them_in_the_same_place() {
    let mut compared = 0;
    for path in files("gltf", &[".glb"]).into_iter().chain(files("city", &[".glb"])) {
        let Some(theirs) = gltf_of(&path) else { continue };
        let model = load(&path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let ours: BTreeSet<[u32; 3]> = model
            .scene
            .objects
            .iter()
            .flat_map(|object| object.mesh.positions())
            .map(|position| position.to_array().map(f32::to_bits))
            .collect();
        assert!(ours == theirs.positions, "{}: positions differ", path.display());

        let file_from_scene =
            DMat4::from_cols_array(&[1., 0., 0., 0., 0., 0., -1., 0., 0., 1., 0., 0., 0., 0., 0., 1.]);
        let place = |object: &umbrae_core::Object| {
            let to_file =
                |p: &Vec3| file_from_scene.transform_point3(object.world_from_object.transform_point3(p.as_dvec3()));
            Bounds::of_points(object.mesh.positions().iter().map(to_file))
        };
        let bounds = model.scene.objects.iter().map(place).fold(Bounds::EMPTY, Bounds::union);
        // The other crate's transforms are rounded to f32.
        let tolerance = 1e-5 * theirs.bounds.radius();
        let difference = (bounds.min - theirs.bounds.min).abs().max((bounds.max - theirs.bounds.max).abs());
        assert!(difference.max_element() <= tolerance, "{}: {bounds:?} is not {:?}", path.display(), theirs.bounds);
        compared += 1;
    }
    assert!(compared == 0 || compared >= 15, "only {compared} files could be compared");
}
