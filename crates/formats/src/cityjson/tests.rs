use glam::Vec3;
use umbrae_core::{SurfaceKind, Topology};

use crate::{Crs, Format, LoadError, LoadOptions, Model, load_bytes};

/// A box of 4 by 3 by 2 m with its vertices in millimetres, in Rotterdam.
fn city(objects: &str) -> String {
    format!(
        r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[0.001,0.001,0.001],"translate":[92000,437000,0]}},
        "metadata":{{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/7415"}},
        "vertices":[[0,0,0],[4000,0,0],[4000,3000,0],[0,3000,0],[0,0,2000],[4000,0,2000],[4000,3000,2000],[0,3000,2000]],
        "CityObjects":{{{objects}}}}}"#
    )
}

/// The shell of that box: base, roof, four walls.
const SHELL: &str = "[[[3,2,1,0]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]";

const SEMANTICS: &str = r#""semantics":{"surfaces":[{"type":"GroundSurface"},{"type":"RoofSurface"},{"type":"WallSurface"}],
    "values":[[0,1,2,2,2,2]]}"#;

fn house(id: &str, more: &str) -> String {
    format!(
        r#""{id}":{{"type":"Building"{more},"geometry":[{{"type":"Solid","lod":"2.2","boundaries":[{SHELL}],{SEMANTICS}}}]}}"#
    )
}

fn load_with(json: &str, options: &LoadOptions) -> Result<Model, LoadError> {
    load_bytes(json.as_bytes(), Format::CityJson, "town.city.json", None, options)
}

fn load(json: &str) -> Model {
    load_with(json, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn error(json: &str) -> String {
    load_with(json, &LoadOptions::default()).expect_err("a bad file").to_string()
}

fn warnings(model: &Model) -> Vec<String> {
    model.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn a_solid_is_closed_and_knows_its_roof_its_walls_and_its_base() {
    let model = load(&city(&house("a", "")));
    let mesh = &model.scene.objects[0].mesh;
    assert_eq!((mesh.triangles().len(), Topology::new(mesh).counts().is_closed()), (12, true));
    let kinds: Vec<SurfaceKind> =
        mesh.triangle_materials().iter().map(|&m| model.scene.materials[m as usize].surface).collect();
    let count = |kind| kinds.iter().filter(|&&k| k == kind).count();
    assert_eq!([SurfaceKind::Base, SurfaceKind::Roof, SurfaceKind::Wall].map(count), [2, 2, 8]);
    assert_eq!(model.scene.objects[0].name, "a");
    assert_eq!(model.crs, Some(Crs::from_epsg(7415).expect("it is known")));
    assert!(model.source_crs.is_none() && model.warnings.is_empty());
}

#[test]
fn vertices_keep_their_millimetres_far_from_zero() {
    let json = city(&house("a", "")).replace("[4000,0,0]", "[4001,0,0]").replace("[4000,0,2000]", "[4001,0,2000]");
    let model = load(&json);
    assert_eq!(model.scene.origin.truncate(), glam::DVec2::new(92_002.0, 437_001.0));
    let highest_x = model.scene.objects[0].mesh.positions().iter().map(|p| p.x).fold(f32::MIN, f32::max);
    assert_eq!(highest_x, 2.001, "f32 at 92 km would be off by up to 4 mm");
}

#[test]
fn every_kind_of_solid_and_surface_has_its_triangles() {
    let of = |kind: &str, boundaries: &str| {
        let object =
            format!(r#""a":{{"type":"Bridge","geometry":[{{"type":"{kind}","lod":1,"boundaries":{boundaries}}}]}}"#);
        load(&city(&object)).scene.triangle_count()
    };
    assert_eq!([of("MultiSurface", SHELL), of("CompositeSurface", SHELL)], [12, 12]);
    let shell = format!("[{SHELL}]");
    assert_eq!([of("Solid", &shell), of("MultiSolid", &format!("[{shell}]"))], [12, 12]);
    assert_eq!(of("CompositeSolid", &format!("[{shell},{shell}]")), 24);
    // A cavity in it, which is another shell.
    assert_eq!(of("Solid", &format!("[{SHELL},{SHELL}]")), 24);
}

#[test]
fn a_hole_stays_open() {
    let json = city(
        r#""a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2,3],[8,9,10]]]}]}"#,
    )
    .replace("[0,3000,2000]]", "[0,3000,2000],[1000,1000,0],[2000,1000,0],[2000,2000,0]]");
    let mesh = &load(&json).scene.objects[0].mesh;
    let corner = |v: u32| mesh.positions()[v as usize];
    let area: f32 = mesh
        .triangles()
        .iter()
        .map(|t| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).length() / 2.0)
        .sum();
    assert!((area - 11.5).abs() < 1e-5, "{area}");
}

fn two_levels() -> String {
    let surface = |lod: &str, ring: &str| format!(r#"{{"type":"MultiSurface","lod":{lod},"boundaries":[[{ring}]]}}"#);
    city(&format!(
        r#""a":{{"type":"Building","geometry":[{},{},{}]}},"b":{{"type":"Building","geometry":[{}]}}"#,
        surface("\"1.3\"", "[0,1,2,3]"),
        surface("\"2.2\"", "[4,5,6]"),
        surface("\"1.2\"", "[4,5,6]"),
        surface("1", "[0,1,2,3]"),
    ))
}

#[test]
fn the_highest_level_of_detail_of_each_object_is_shown_or_the_one_that_is_named() {
    assert_eq!(load(&two_levels()).scene.objects.iter().map(|o| o.mesh.triangles().len()).collect::<Vec<_>>(), [1, 2]);
    let named =
        |lod: &str| load_with(&two_levels(), &LoadOptions { lod: Some(lod.to_owned()), ..LoadOptions::default() });
    let model = named("1.3").expect("a has it");
    assert_eq!((model.scene.objects.len(), model.scene.triangle_count()), (1, 2));
    assert_eq!(
        warnings(&model),
        ["1 city object has no geometry of the level of detail that was asked for and was left out (first: \"b\")"]
    );
    assert_eq!(named("1.0").expect("b has it").scene.objects[0].name, "b", "1 is 1.0");
    assert_eq!(
        named("3").expect_err("nothing has it").to_string(),
        "town.city.json: it has no level of detail \"3\"; it has \"1\", \"1.2\", \"1.3\", \"2.2\""
    );
}

#[test]
fn a_part_is_named_after_its_building_and_shown_instead_of_its_footprint() {
    let whole = r#""b":{"type":"Building","children":["p"],"geometry":[{"type":"MultiSurface","lod":"0","boundaries":[[[0,1,2,3]]]}]}"#;
    let part = house("p", r#","parents":["b"]"#).replace("\"Building\"", "\"BuildingPart\"");
    let model = load(&city(&format!("{whole},{part}")));
    let names: Vec<&str> = model.scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["b/p"]);
    assert!(warnings(&model)[0].starts_with("1 geometry of a building was left out because its parts"));
    // Parents that go in circles end.
    let circle = house("a", r#","parents":["b"]"#) + "," + &house("b", r#","parents":["a"]"#);
    let names: Vec<String> = load(&city(&circle)).scene.objects.iter().map(|o| o.name.clone()).collect();
    assert_eq!(names, ["b/a", "a/b"]);
}

#[test]
fn a_footprint_alone_is_told() {
    let model = load(&city(
        r#""a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":0,"boundaries":[[[0,1,2,3]]]}]}"#,
    ));
    assert!(warnings(&model)[0].contains("is a footprint (level of detail 0)"), "{:?}", model.warnings);
}

/// Two trees of one template, the second twice as large and turned by a quarter.
#[test]
fn templates_are_shown_where_their_instances_are() {
    let instance = |vertex: u32, matrix: &str| {
        format!(
            r#"{{"type":"GeometryInstance","template":0,"boundaries":[{vertex}],"transformationMatrix":[{matrix}]}}"#
        )
    };
    let tree =
        |id: &str, instance: &str| format!(r#""{id}":{{"type":"SolitaryVegetationObject","geometry":[{instance}]}}"#);
    let json = |second: &str| {
        city(&format!(
            "{},{}",
            tree("a", &instance(0, "1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1")),
            tree("b", &instance(6, second))
        ))
        .replacen(
            "\"vertices\"",
            r#""geometry-templates":{"templates":[{"type":"MultiSurface","lod":"3","boundaries":[[[0,1,2]]]}],
                "vertices-templates":[[0,0,0],[1,0,0],[0,0,1]]},"vertices""#,
            1,
        )
    };
    let model = load(&json("0,-2,0,0,2,0,0,0,0,0,2,10,0,0,0,1"));
    let objects = &model.scene.objects;
    assert!(std::sync::Arc::ptr_eq(&objects[0].mesh, &objects[1].mesh));
    let bounds = objects[1].bounds();
    let at = |p: [f64; 3]| glam::DVec3::from(p) - model.scene.origin;
    assert!((bounds.min - at([92_004.0, 437_003.0, 12.0])).length() < 1e-6, "{bounds:?}");
    assert!((bounds.max - at([92_004.0, 437_005.0, 14.0])).length() < 1e-6, "{bounds:?}");
    let bad = |matrix: &str| warnings(&load(&json(matrix))).join("; ");
    assert!(bad("1,2").contains("city object \"b\": its transformationMatrix has 2 numbers, not 16"));
    assert!(bad("1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2").contains("ends with [0.0, 0.0, 0.0, 2.0]"));
    assert!(bad("0,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1").contains("flattens what it moves"));
}

#[test]
fn a_sequence_moves_every_feature_like_its_first_line() {
    let whole = city(&house("a", ""));
    let head =
        whole.replace(&format!("\"CityObjects\":{{{}}}", house("a", "")), "\"CityObjects\":{}").replace('\n', " ");
    let start = head.find("\"vertices\"").expect("it has some");
    let end = start + head[start..].find("]],").expect("they end");
    let vertices = &head[start..end + 2];
    let feature = |id: &str| {
        format!(r#"{{"type":"CityJSONFeature","id":"{id}","CityObjects":{{{}}},{vertices}}}"#, house(id, ""))
            .replace('\n', " ")
    };
    let head = head.replace(vertices, "\"vertices\":[]");
    let model = load(&format!("{head}\n{}\n{}\n", feature("a"), feature("b")));
    assert_eq!((model.scene.objects.len(), model.scene.triangle_count()), (2, 24));
    assert_eq!(model.scene.bounds().size(), load(&whole).scene.bounds().size());
    assert!(error(&feature("a")).contains("begins with a CityJSONFeature"));
    let cut = format!("{head}\n{}", &feature("a")[..100]);
    assert!(error(&cut).contains("line 2: its JSON can't be read"), "{}", error(&cut));
}

#[test]
fn degrees_become_metres_of_a_utm_zone() {
    let json = city(&house("a", ""))
        .replace("EPSG/0/7415", "EPSG/0/4979")
        .replace("[0.001,0.001,0.001]", "[1e-8,1e-8,0.001]")
        .replace("92000,437000,0", "4.47,51.9,0");
    let model = load(&json);
    assert_eq!(model.crs.as_ref().map(Crs::epsg), Some(32631));
    assert_eq!(model.source_crs.as_ref().map(Crs::epsg), Some(4979));
    let size = model.scene.bounds().size();
    // 4e-5 degrees of longitude and 3e-5 of latitude.
    assert!((size.x - 2.75).abs() < 0.1 && (size.y - 3.34).abs() < 0.1 && size.z == 2.0, "{size}");
    // Beyond 90 there is no doubt which is which.
    let swapped = json.replace("4.47,51.9,0", "35.5,139.7,0");
    let japan = load(&swapped);
    assert_eq!(japan.crs.as_ref().map(Crs::epsg), Some(32654));
    assert_eq!(warnings(&japan), ["1 list of vertices has latitudes first"]);
}

#[test]
fn a_second_model_comes_to_where_the_first_is() {
    let rd = load(&city(&house("a", "")));
    let utm = Crs::from_epsg(32631).expect("it is known");
    let options = LoadOptions { into: Some(utm.clone()), ..LoadOptions::default() };
    let moved = load_with(&city(&house("a", "")), &options).expect("it is a good file");
    assert_eq!((moved.crs.as_ref(), moved.source_crs.as_ref()), (Some(&utm), rd.crs.as_ref()));
    let middle = |model: &Model| {
        let at = model.scene.origin + model.scene.bounds().center();
        model.crs.as_ref().expect("it has one").lon_lat_of(at.truncate()).expect("a place")
    };
    assert!((middle(&rd) - middle(&moved)).length() < 1e-8, "a millimetre");
    // The same plane under another code: nothing is computed.
    let options = LoadOptions { into: Some(Crs::from_epsg(28992).expect("it is known")), ..LoadOptions::default() };
    assert!(load_with(&city(&house("a", "")), &options).expect("it is a good file").source_crs.is_none());
}

#[test]
fn feet_become_metres() {
    let json = city(&house("a", "")).replace("EPSG/0/7415", "EPSG/0/2263").replace("92000,437000,0", "987000,200000,0");
    let model = load(&json);
    let foot = 1200.0 / 3937.0;
    assert!((model.scene.bounds().size() - glam::DVec3::new(4.0, 3.0, 2.0) * foot).length() < 1e-5);
    assert!((model.scene.origin.x - 987_002.0 * foot).abs() < 2.0);
    assert!(warnings(&model)[0].contains("1 unit is 0.304801 m, of height 0.304801 m"), "{:?}", model.warnings);
}

#[test]
fn who_says_where_the_model_is_is_told_apart() {
    let silent = city(&house("a", "")).replace("\"referenceSystem\"", "\"x\"");
    assert!(load(&silent).crs.is_none());
    let given =
        |json: &str, epsg| load_with(json, &LoadOptions { crs: Crs::from_epsg(epsg).ok(), ..LoadOptions::default() });
    assert_eq!(given(&silent, 28992).expect("good").crs.as_ref().map(Crs::epsg), Some(28992));
    assert!(given(&city(&house("a", "")), 28992).expect("good").warnings.is_empty(), "the same plane");
    let other = given(&city(&house("a", "")), 25832).expect("good");
    assert_eq!(other.crs.as_ref().map(Crs::epsg), Some(7415));
    assert!(warnings(&other)[0].contains("it was believed (first: EPSG:7415"), "{:?}", other.warnings);
    let strange = city(&house("a", "")).replace("https://www.opengis.net/def/crs/EPSG/0/7415", "Rijksdriehoek");
    assert!(warnings(&load(&strange))[0].contains("\"Rijksdriehoek\" names no coordinate reference system"));
    let nowhere = city(&house("a", "")).replace("92000,437000,0", "1e12,0,0");
    assert!(error(&nowhere).contains("is not a place in EPSG:7415"), "{}", error(&nowhere));
}

#[test]
fn broken_parts_are_skipped_and_named_and_the_rest_is_shown() {
    let of = |geometry: &str| {
        let bad = format!(r#""bad":{{"type":"Building","geometry":[{geometry}]}}"#);
        warnings(&load(&city(&format!("{},{bad}", house("good", ""))))).join("; ")
    };
    let surface = |boundaries: &str| of(&format!(r#"{{"type":"MultiSurface","lod":2,"boundaries":{boundaries}}}"#));
    assert!(
        surface("[[[0,1,99]]]").contains("vertices that do not exist")
            || surface("[[[0,1,99]]]")
                .contains("a vertex that does not exist (first: city object \"bad\": vertex 99, of 8)")
    );
    assert!(surface("[[[0,1,-1]]]").contains("vertex -1, of 8"));
    assert!(
        surface("[[[0,1,1,0]]]")
            .contains("fewer than three corners was skipped (first: city object \"bad\": 2 of them in ring 0)")
    );
    assert!(surface("[[[0,1,2],[3]]]").contains("hole of fewer than three corners was skipped"));
    assert!(surface("[[]]").contains("surface without a ring was skipped"));
    assert!(
        surface("[7]")
            .contains("badly nested (first: city object \"bad\": 7 is not a list as a MultiSurface needs there)")
    );
    assert!(of(r#"{"type":"MultiPoint","lod":2,"boundaries":[0]}"#).contains("city object \"bad\": \"MultiPoint\""));
    assert!(
        of(r#"{"type":"GeometryInstance","template":3,"boundaries":[0]}"#)
            .contains("shows template 3, but there are 0")
    );
}

#[test]
fn files_that_can_not_be_used_say_why() {
    assert!(error(&city("")).contains("there is no usable surface in it; city objects: 0"));
    assert!(error(&city(&house("a", "")).replace("\"2.0\"", "\"0.9\"")).contains("CityJSON version \"0.9\""));
    assert!(error(r#"{"type":"CityJSON"}"#).contains("it says no version"));
    let typo = city(&house("a", "")).replace("\"lod\":\"2.2\"", "\"lod\":[]");
    assert!(error(&typo).contains("city object \"a\": "), "{}", error(&typo));
    let huge =
        city(&house("a", "")).replace("[4000,3000,2000]", "[4e22,3000,2000]").replace("\"referenceSystem\"", "\"x\"");
    assert!(error(&huge).contains("city object \"a\": vertex"), "{}", error(&huge));
}

#[test]
fn a_house_of_three_kilometres_is_told() {
    let json = city(&house("a", "")).replace("2000]", "3000000]");
    assert!(warnings(&load(&json))[0].contains("is its height in another unit than metres? (first: \"a\": 3000 m)"));
}

#[test]
fn a_byte_order_mark_does_no_harm() {
    assert_eq!(load(&format!("\u{feff}{}", city(&house("a", "")))).scene.triangle_count(), 12);
}

#[test]
fn colours_are_the_same_for_the_same_kind() {
    let model = load(&city(&(house("a", "") + "," + &house("b", ""))));
    assert_eq!(model.scene.materials.len(), 3);
    assert!(model.scene.materials.iter().all(|m| m.base_color.min_element() > 0.0 && m.base_color != Vec3::ONE));
}
