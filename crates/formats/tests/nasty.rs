//! Every nasty file beside the project does what this table says: it loads with the counts of SOURCES.md, or it
//! fails with a reason. A file that is not in the table fails the test.

mod counts;
mod shared_data;

use std::fs;
use std::path::Path;

use counts::Counts;
use umbrae_formats::{LoadOptions, load};

#[derive(Debug)]
enum Outcome {
    /// It loads, with these counts and with warnings of these words, one after another.
    Loads(Counts, &'static [&'static str]),
    /// It fails, for a reason with these words in it.
    Fails(&'static str),
}

use Outcome::Fails;

fn loads(shown: usize, border: usize, non_manifold: usize, inconsistent: usize) -> Outcome {
    but(shown, border, non_manifold, inconsistent, &[])
}

fn but(
    shown: usize,
    border: usize,
    non_manifold: usize,
    inconsistent: usize,
    warnings: &'static [&'static str],
) -> Outcome {
    Outcome::Loads(Counts { shown, border, non_manifold, inconsistent }, warnings)
}

const NO_LIBRARY: &str = "1 material library is missing; its colours are left out";
const NO_FORMAT: &str = "can't tell the format from the name; its ending must be one of .glb, .gltf, .obj, .ply,";

/// For each file its triangles, border edges, non-manifold edges and inconsistently wound edges, or its fault.
#[rustfmt::skip]
fn outcomes() -> Vec<(&'static str, Outcome)> {
    vec![
        ("BoxBadNormals.glb", loads(12, 0, 0, 0)),
        ("BoxTextured.gltf", Fails("mesh 0 \"Mesh\": primitive 0: POSITION: accessor 2: buffer 0: its file \"BoxTextured0.bin\" is missing")),
        ("BoxWithInfinites.glb", Fails("mesh 0 \"Mesh\": vertex 0 is at (-inf, -0.5, 0.5); coordinates must be finite and below 1e18")),
        ("IndexOutOfRange.bin", Fails(NO_FORMAT)),
        ("IndexOutOfRange.gltf", Fails("mesh 0 \"Mesh\": primitive 0: index 0 of accessor 0 is vertex 255, but there are 24")),
        ("NoScene.gltf", Fails("there is no mesh in it")),
        ("RecursiveNodes.gltf", Fails("node 1: its child is node 0, which already has a place; nodes must form a tree, without cycles")),
        ("assimp_empty.ply", Fails("the file is empty (0 bytes)")),
        ("boxNotManifold.obj", loads(12, 4, 0, 0)),
        ("box_longline.obj", loads(944, 0, 5, 0)),
        ("box_without_lineending.obj", loads(12, 0, 0, 0)),
        ("busted.STL", loads(3878, 0, 0, 0)),
        ("comments.off", Fails(NO_FORMAT)),
        // SOURCES.md has 63 border and 2 non-manifold edges, which a fan makes of this ring. It has 66 corners, and
        // goes to its hole and back along one side: 64 sides border on nothing.
        ("concave_polygon.obj", but(64, 64, 0, 0, &[NO_LIBRARY])),
        ("cube_binary_header_with_RN_newline.ply", loads(12, 0, 0, 0)),
        ("cube_compressed.obj", loads(12, 0, 0, 0)),
        ("cube_quads.ply", loads(12, 0, 0, 0)),
        ("deg_faces.obj", loads(4, 5, 0, 0)),
        ("empty.obj", Fails("there is no usable face in it; vertices: 0")),
        ("empty.ply", Fails("there is no usable face in it; vertices: 0")),
        ("empty.stl", Fails("there is no triangle in it")),
        ("empty_nodes.glb", Fails("there is no mesh in it")),
        ("eof_test.obj", loads(1, 3, 0, 0)),
        ("extra_vertex.obj", loads(3, 9, 0, 0)),
        ("face_in_group_name.obj", Fails("there is no usable face in it; vertices: 1")),
        ("inf_nan.obj", Fails("line 1: vertex 1 is \"v inf nan +inf\"; it takes three finite numbers below 1e18")),
        ("integer-out-of-bounds.gltf", Fails("line 34: its JSON can't be read at column 25: invalid type: floating point `1e+300`, expected usize")),
        ("invalid-buffer-view-index.gltf", Fails("no node of its scene shows a mesh (nodes: 0, meshes: 1)")),
        ("invalid.off", Fails(NO_FORMAT)),
        ("jacked.obj", but(12, 0, 0, 0, &[NO_LIBRARY])),
        ("joined_tetrahedra.obj", loads(8, 0, 3, 0)),
        ("large_block.STL", loads(12, 0, 0, 0)),
        ("lyon_ensemble_de_batiments_2.obj", loads(485, 11, 0, 47)),
        ("lyon_extrait_2_terrain_lyon_5.obj", loads(2043, 565, 0, 12)),
        ("lyon_tour_part_dieu.obj", loads(1124, 120, 0, 223)),
        ("malformed.obj", but(9, 10, 0, 1, &["3 triangles were skipped because they name vertices that do not exist (first: line 23, corner 2 of 4)"])),
        ("mirror.ply", loads(286, 0, 0, 0)),
        ("multi.ply", loads(2, 4, 0, 0)),
        ("multibody.stl", loads(32, 0, 0, 12)),
        ("multiple_isolated_triangles.obj", loads(5, 15, 0, 0)),
        ("nancolor.obj", but(12, 0, 0, 0, &["1 vertex colour is not a number and became white"])),
        ("negative_indices.obj", loads(12, 0, 0, 0)),
        ("non_manifold_wrap.obj", loads(12, 8, 1, 0)),
        ("not_convex.obj", loads(96, 0, 12, 0)),
        ("notenoughindices.obj", but(1, 3, 0, 0, &["1 face of fewer than three corners was skipped (first: line 9)", NO_LIBRARY])),
        ("number_formats.obj", but(1, 3, 0, 0, &["6 vertex positions are not three numbers (first: line 11: \"1e+2 2.e+1 3.1+e2\")"])),
        ("openscad-nonmanifold-crash.obj", loads(1442, 0, 18, 0)),
        ("ply_empty_header.ply", Fails("there is no usable face in it; vertices: 0")),
        ("points_emptyface.ply", Fails("there is no usable face in it; vertices: 1024")),
        ("polygonfaces.obj", but(3, 5, 0, 0, &[NO_LIBRARY])),
        ("sceneWrongType.gltf", Fails("line 6: its JSON can't be read at column 20: invalid type: string \"hello\", expected usize")),
        ("self_intersectA.obj", loads(17160, 0, 0, 0)),
        ("simpleTriangle.bin", Fails(NO_FORMAT)),
        ("soup.stl", loads(100, 300, 0, 0)),
        ("sphereWithHole.stl", loads(285, 9, 0, 0)),
        ("test_nm.obj", loads(170, 30, 0, 0)),
        ("testmixed.obj", but(12, 0, 0, 0, &["6 line primitives were skipped (first: line 15)", "6 point primitives were skipped (first: line 23)"])),
        ("triangle_with_two_solids.stl", loads(2, 6, 0, 0)),
        ("two_objects.obj", loads(16, 0, 3, 0)),
        ("wallhole.obj", but(66, 0, 1, 0, &[NO_LIBRARY])),
    ]
}

/// The names of the files in `folder`, in order.
fn files_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder that can be read");
    let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("an entry that can be read").file_name();
    let mut names: Vec<String> = entries.map(|entry| name(entry).into_string().expect("names are UTF-8")).collect();
    names.sort();
    names
}

#[test]
fn every_nasty_file_does_what_the_table_says() {
    let Some(folder) = shared_data::folder() else { return };
    let folder = folder.join("nasty");
    let outcomes = outcomes();
    let listed: Vec<String> = outcomes.iter().map(|(file, _)| (*file).to_owned()).collect();
    assert_eq!(files_in(&folder), listed, "each file in the folder has a row in the table");
    for (file, outcome) in outcomes {
        match (load(&folder.join(file), &LoadOptions::default()), outcome) {
            (Ok(model), Outcome::Loads(expected, warnings)) => {
                assert_eq!(counts::of_model(&model), expected, "{file}");
                assert_eq!(model.warnings.len(), warnings.len(), "{file}: {:?}", model.warnings);
                for (warning, words) in model.warnings.iter().zip(warnings) {
                    assert!(warning.to_string().contains(words), "{file}: {warning}");
                }
            }
            (Err(error), Fails(words)) => {
                let error = error.to_string();
                assert!(error.contains(words) && error.contains(file), "{file}: {error}");
                assert!(!error.contains('\n') && !error.ends_with('.'), "one sentence without a full stop: {error}");
            }
            (Ok(_), Fails(_)) => panic!("{file} should fail"),
            (Err(error), Outcome::Loads(..)) => panic!("{error}"),
        }
    }
}
