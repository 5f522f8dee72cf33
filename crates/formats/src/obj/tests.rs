use glam::Vec3;
use umbrae_core::Topology;

use crate::{Format, LoadError, LoadOptions, Model, UpAxis, load, load_bytes};

fn read(text: &str) -> Result<Model, LoadError> {
    let options = LoadOptions { up: Some(UpAxis::Z), ..LoadOptions::default() };
    load_bytes(text.as_bytes(), Format::Obj, "model.obj", None, &options)
}

fn model(text: &str) -> Model {
    read(text).expect("a good file")
}

fn error(text: &str) -> String {
    read(text).expect_err("a bad file").to_string()
}

fn names(model: &Model) -> Vec<&str> {
    model.scene.objects.iter().map(|object| object.name.as_str()).collect()
}

fn warnings(model: &Model) -> Vec<String> {
    model.warnings.iter().map(ToString::to_string).collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn y_is_up_unless_the_user_says_otherwise() {
    let text = b"v 0 0 0\nv 1 2 3\nv 1 0 0\nf 1 2 3\n";
    let model = load_bytes(text, Format::Obj, "a/model.obj", None, &LoadOptions::default()).expect("a triangle");
    assert_eq!((model.up, model.scene.objects[0].mesh.positions()[1]), (UpAxis::Y, Vec3::new(1.0, -3.0, 2.0)));
    assert_eq!(names(&model), ["model"], "without a name of its own it is named for the file");
}

#[test]
fn indices_count_forward_from_1_and_back_from_the_last_vertex_so_far() {
    let forward = model(&format!("{SQUARE}f 1 2 3\n"));
    let back = model(&format!("{SQUARE}f -4/7/-1 -3//2 -2\nv 9 9 9\n"));
    let ahead = model(&format!("f 1 2 3\n{SQUARE}"));
    for other in [back, ahead] {
        assert_eq!(other.scene.objects[0].mesh.positions(), forward.scene.objects[0].mesh.positions());
    }
}

#[test]
fn a_line_goes_on_after_a_backslash_and_ends_in_any_way() {
    let model = model("v 0 0 \\\r\n 0\r\n v\t1 0 0 # a comment\nv 1 \\\n1 \\\n0\nf 1 2 \\\n3");
    assert_eq!(model.scene.triangle_count(), 1);
    assert_eq!(model.scene.objects[0].mesh.positions()[2], Vec3::new(1.0, 1.0, 0.0));
    assert!(model.warnings.is_empty());
}

#[test]
fn a_concave_polygon_becomes_two_triangles_fewer_than_it_has_corners_and_keeps_its_area() {
    let model = model("v 0 0 0\nv 4 -2 0\nv 1 0 0\nv 4 2 0\nf 1 2 3 4\n");
    let mesh = &model.scene.objects[0].mesh;
    let area: f32 = mesh
        .triangles()
        .iter()
        .map(|t| t.map(|i| mesh.positions()[i as usize]))
        .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
        .sum();
    assert_eq!((mesh.triangles().len(), area), (2, 2.0));
}

#[test]
fn a_polygon_that_crosses_itself_is_cut_anyhow_with_a_warning() {
    let bow_tie = model("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n");
    assert_eq!(bow_tie.scene.triangle_count(), 2);
    assert_eq!(warnings(&bow_tie), ["1 polygon that crosses itself or has no area was cut as a fan (first: line 5)"]);
}

#[test]
fn objects_and_groups_with_faces_are_named_objects() {
    let model = model(&format!(
        "{SQUARE}f 1 2 3\no house\nf 1 2 3\ng roof\nf 1 2 4\ng\nf 1 3 4\ng roof\nf 2 3 4\ng nothing here\no house\nf 1 2 3\n"
    ));
    assert_eq!(names(&model), ["model", "house", "house/roof", "house"]);
    let triangles: Vec<usize> = model.scene.objects.iter().map(|o| o.mesh.triangles().len()).collect();
    assert_eq!(triangles, [1, 2, 2, 1], "a group that is taken up again goes on; an object does not");
    assert_eq!(model.scene.objects[0].mesh.counts().vertices_read, 3, "each object holds its own vertices only");
}

#[test]
fn materials_are_read_from_the_library_beside_the_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("model.obj");
    std::fs::write(folder.path().join("its.mtl"), "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n").expect("a library");
    let text =
        format!("mtllib its.mtl\n{SQUARE}f 1 2 3\nusemtl blue\nf 1 2 4\nusemtl grey\nf 2 3 4\nusemtl blue\nf 1 3 4\n");
    std::fs::write(&path, &text).expect("a model");
    let loaded = load(&path, &LoadOptions::default()).expect("a good file");
    assert_eq!(loaded.scene.objects[0].mesh.triangle_materials(), [0, 1, 2, 1]);
    let materials: Vec<(&str, Vec3)> = loaded.scene.materials.iter().map(|m| (m.name.as_str(), m.base_color)).collect();
    let plain = umbrae_core::Material::default().base_color;
    assert_eq!(materials, [("", plain), ("blue", Vec3::Z), ("grey", plain)]);
    let missing = model(&text);
    assert_eq!(warnings(&missing), ["1 material library is missing; its colours are left out (first: \"its.mtl\")"]);
}

#[test]
fn colours_after_positions_are_srgb_as_numbers_to_1_or_to_255() {
    for text in [
        "v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0\nv 0 1 0 nan 0 0\nf 1 2 3\n",
        "v 0 0 0 255 0 127.5\nv 1 0 0 0 255 0\nv 0 1 0 0 0 inf\nf 1 2 3\n",
    ] {
        let model = model(text);
        let [[red, green, white]] = model.scene.objects[0].mesh.corner_colors() else { panic!("one triangle") };
        assert_eq!((*green, *white), (Vec3::Y, Vec3::ONE));
        assert!((*red - Vec3::new(1.0, 0.0, 0.214)).length() < 1e-3, "{red}");
        assert_eq!(warnings(&model), ["1 vertex colour is not a number and became white"]);
    }
}

#[test]
fn a_fourth_coordinate_is_a_weight_and_means_nothing() {
    let model = model("v 0 0 0 2\nv 1 0 0 2\nv 0 1 0 2\nf 1 2 3\n");
    assert_eq!(model.scene.objects[0].mesh.positions()[1], Vec3::X);
    assert!(model.scene.objects[0].mesh.corner_colors().is_empty());
}

#[test]
fn bad_faces_among_good_ones_are_skipped_and_counted_with_the_first_line() {
    let model =
        model(&format!("{SQUARE}f 1 2 3\nf 1 2\nf 1 x 3\nf 1 2 3 9\nf 0 1 2\nf 1 2.5 3\ncall other.obj\nl 1 2\np 1\n"));
    assert_eq!(model.scene.triangle_count(), 2, "(1 2 3), and again from the polygon without its fourth corner");
    assert_eq!(
        warnings(&model),
        [
            "1 face of fewer than three corners was skipped (first: line 6)",
            "2 faces can't be read and were skipped (first: line 7: \"1 x 3\")",
            "1 unknown statement was skipped (first: line 11: \"call other.obj\")",
            "1 line primitive was skipped (first: line 12)",
            "1 point primitive was skipped (first: line 13)",
            "2 triangles were skipped because they name vertices that do not exist (first: line 8, corner 4 of 4)",
        ]
    );
}

#[test]
fn without_any_good_face_the_file_is_refused_and_says_why() {
    assert_eq!(
        error("v 0 0 0\nf 1 2\n"),
        "model.obj: there is no usable face in it (1 face of fewer than three corners was skipped (first: line 2)); \
         vertices: 1"
    );
    assert_eq!(error("f 99999999999 1 -9223372036854775808\n").matches("line 1").count(), 1);
    assert!(error("glTF\x02").contains("this is a .glb file under another name"));
}

#[test]
fn a_used_vertex_that_is_no_position_is_told_by_its_line_also_after_continuations() {
    assert_eq!(
        error("# two lines\n\\\n\nv 0 0 \\\n0\nvn 1 1 1\nv 1,5 0 0\nv 0 1 0\nf 1 2 3\n"),
        "model.obj: line 7: vertex 2 is \"v 1,5 0 0\"; it takes three finite numbers below 1e18"
    );
    let two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e300\no good\nf 1 2 3\no bad\nf 1 2 4\n";
    assert_eq!(
        warnings(&model(two)),
        ["1 object was skipped (first: line 4: vertex 4 is \"v 0 0 1e300\"; it takes three finite numbers below 1e18)"]
    );
}

#[test]
fn national_coordinates_lose_nothing() {
    let model = model(
        "v 2500000.125 1200000.25 400.5\nv 2500001.125 1200000.25 400.5\nv 2500000.125 1200001.25 400.5\nf 1 2 3\n",
    );
    let mesh = &model.scene.objects[0].mesh;
    let p = model.scene.origin + mesh.positions()[0].as_dvec3();
    assert_eq!(p, glam::DVec3::new(2_500_000.125, 1_200_000.25, 400.5));
}

#[test]
fn a_cube_of_quads_is_closed() {
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
        f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let counts = Topology::new(&model(cube).scene.objects[0].mesh).counts();
    assert_eq!((counts.edges, counts.border_edges, counts.closed_components), (18, 0, 1));
}

#[test]
fn textures_are_read_beside_the_library_and_v_points_up() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("look")).expect("a folder");
    let library = "newmtl brick\nmap_Kd brick.png\nnewmtl wood\nKd 0.5 0.5 0.5\nmap_Kd no wood.png\nnewmtl wall\n\
        map_Kd brick.png\n";
    std::fs::write(folder.path().join("look/its.mtl"), library).expect("a library");
    image::GrayImage::new(4, 2).save(folder.path().join("look/brick.png")).expect("a picture");
    // A concave polygon: the two coordinates are a quarter of the position's.
    let text = "mtllib look/its.mtl\nv 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 0.25 0.25\nvt 0 1\n\
        usemtl brick\nf 1/1 2/2 3/3 4/4\nusemtl wood\nf 1/-4/1 2//1 3\nusemtl wall\nf 1 2 3\n";
    let options = LoadOptions { up: Some(UpAxis::Z), ..LoadOptions::default() };
    let model = load_bytes(text.as_bytes(), Format::Obj, "wall.obj", Some(folder.path()), &options).expect("good");
    let [texture] = model.scene.textures.as_slice() else { panic!("one texture: {:?}", model.scene.textures) };
    assert_eq!((texture.name.as_str(), texture.size_px), ("brick.png", [4, 2]));
    let materials: Vec<_> = model.scene.materials.iter().map(|m| (m.base_color.x, m.base_color_texture)).collect();
    assert_eq!(materials, [(1.0, Some(0)), (0.5, None), (1.0, Some(0))]);
    let mesh = &model.scene.objects[0].mesh;
    for t in 0..2 {
        for (corner, uv) in mesh.triangles()[t].iter().zip(mesh.corner_uvs()[t]) {
            let position = mesh.positions()[*corner as usize];
            assert_eq!((uv.x, uv.y), (position.x / 4.0, 1.0 - position.y / 4.0));
        }
    }
    assert_eq!(mesh.corner_uvs()[2], [glam::Vec2::new(0.0, 1.0), glam::Vec2::ZERO, glam::Vec2::ZERO]);
    let expected = ["1 base colour texture was left out (first: \"no wood.png\": its file is missing)"];
    assert_eq!(warnings(&model), expected);
}

fn with_normals(text: &str) -> Model {
    let options = LoadOptions { up: Some(UpAxis::Z), normals: true, ..LoadOptions::default() };
    load_bytes(text.as_bytes(), Format::Obj, "model.obj", None, &options).expect("a good file")
}

#[test]
fn normals_go_with_corners_whatever_stands_between_the_slashes() {
    let normals = "vn 1 0 0\nvn 0 2 0\nvn 0 0 3\nvt 0 0\n";
    for face in ["f 1//1 2//2 3//3\n", "f 1/1/1 2/1/-2 3/9/3\n", "f -4//-3 -3//2 -2//-1\n"] {
        let model = with_normals(&format!("{SQUARE}{normals}{face}"));
        assert_eq!(model.scene.objects[0].mesh.corner_normals(), [[Vec3::X, Vec3::Y, Vec3::Z]], "{face}");
        assert!(model.warnings.is_empty(), "{face}: {:?}", model.warnings);
    }
    let text = format!("{SQUARE}{normals}f 1//1 2//2 3//3\n");
    assert!(model(&text).scene.objects[0].mesh.corner_normals().is_empty(), "nobody asked for them");
    let up =
        load_bytes(text.as_bytes(), Format::Obj, "a.obj", None, &LoadOptions { normals: true, ..Default::default() });
    let up = up.expect("the same file with y up");
    assert_eq!(up.scene.objects[0].mesh.corner_normals(), [[Vec3::X, Vec3::Z, Vec3::NEG_Y]]);
}

#[test]
fn corners_of_one_vertex_keep_normals_of_their_own_in_every_object() {
    let text = "v 0 0 0\nv 4 -2 0\nv 1 0 0\nv 4 2 0\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\nvn -1 0 0\n\
        o first\nf 1 2 3\no concave\nf 1//1 2//2 3//3 4//4\no turned\nf 3//1 2//2 1//4\n";
    let model = with_normals(text);
    let [first, concave, turned] = model.scene.objects.as_slice() else { panic!("three objects") };
    assert!(first.mesh.corner_normals().is_empty(), "its corners name none");
    let by_position = [(Vec3::ZERO, Vec3::X), (Vec3::new(4.0, -2.0, 0.0), Vec3::Y), (Vec3::X, Vec3::Z)];
    let by_position = [by_position.as_slice(), &[(Vec3::new(4.0, 2.0, 0.0), Vec3::NEG_X)]].concat();
    let corners = concave.mesh.triangles().iter().zip(concave.mesh.corner_normals());
    let corners: Vec<_> = corners.flat_map(|(t, normals)| t.iter().zip(normals)).collect();
    assert_eq!(corners.len(), 6);
    for (corner, normal) in corners {
        assert!(by_position.contains(&(concave.mesh.positions()[*corner as usize], *normal)), "{corner}: {normal}");
    }
    assert_eq!(turned.mesh.corner_normals(), [[Vec3::X, Vec3::Y, Vec3::NEG_X]]);
}

#[test]
fn a_normal_that_is_missing_or_broken_leaves_its_corner_without_one() {
    let text = format!(
        "{SQUARE}vn 0 0 1\nvn 0 x 1\nvn 1 0\nvn inf 0 0\nf 1 2 3 4\nf 1//1 2//2 3//9\nf 1//3 2//1 3//x\nf 1//4 2//0 3//1\n"
    );
    let model = with_normals(&text);
    let none = Vec3::ZERO;
    assert_eq!(
        model.scene.objects[0].mesh.corner_normals(),
        [[none; 3], [none; 3], [Vec3::Z, none, none], [none, Vec3::Z, none], [none, none, Vec3::Z]]
    );
    assert_eq!(warnings(&model), ["3 normals can't be read and were left out (first: line 6: \"0 x 1\")"]);
}
