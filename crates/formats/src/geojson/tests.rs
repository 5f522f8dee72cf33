use glam::DVec3;
use umbrae_core::{Mesh, SurfaceKind, Topology};

use crate::{Crs, Format, LoadError, LoadOptions, Model, load_bytes};

/// About 70 by 111 m in Vienna.
const SQUARE: &str = "[[16.37,48.2],[16.371,48.2],[16.371,48.201],[16.37,48.201],[16.37,48.2]]";

/// A courtyard in it.
const COURT: &str = "[[16.3703,48.2003],[16.3707,48.2003],[16.3707,48.2007],[16.3703,48.2007],[16.3703,48.2003]]";

fn feature(properties: &str, rings: &str) -> String {
    format!(
        r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"Polygon","coordinates":[{rings}]}}}}"#
    )
}

fn collection(features: &[String]) -> String {
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
}

/// In the metres of RD New.
fn projected(features: &[String]) -> String {
    collection(features).replacen(
        "{",
        r#"{"crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::28992"}},"#,
        1,
    )
}

fn square_m(side: f64) -> String {
    let (x, y) = (92_000.0, 437_000.0);
    format!("[[{x},{y}],[{0},{y}],[{0},{1}],[{x},{1}],[{x},{y}]]", x + side, y + side)
}

fn load_with(json: &str, options: &LoadOptions) -> Result<Model, LoadError> {
    load_bytes(json.as_bytes(), Format::GeoJson, "town.geojson", None, options)
}

fn load(json: &str) -> Model {
    load_with(json, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn error(json: &str) -> String {
    load_with(json, &LoadOptions::default()).expect_err("a bad file").to_string()
}

fn warnings(model: &Model) -> String {
    model.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// Of a closed surface that faces out.
fn volume(mesh: &Mesh) -> f64 {
    let p = |v: u32| mesh.positions()[v as usize].as_dvec3();
    mesh.triangles().iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c))) / 6.0).sum()
}

/// Square metres of a kind of surface.
fn area(model: &Model, kind: SurfaceKind) -> f64 {
    let mesh = &model.scene.objects[0].mesh;
    let p = |v: u32| mesh.positions()[v as usize].as_dvec3();
    let of_kind = |t: &usize| model.scene.materials[mesh.triangle_materials()[*t] as usize].surface == kind;
    let area = |t: usize| {
        let [a, b, c] = mesh.triangles()[t];
        (p(b) - p(a)).cross(p(c) - p(a)).length() / 2.0
    };
    (0..mesh.triangles().len()).filter(of_kind).map(area).sum()
}

fn z_range(model: &Model) -> [f64; 2] {
    let bounds = model.scene.bounds();
    [bounds.min.z + model.scene.origin.z, bounds.max.z + model.scene.origin.z]
}

#[test]
fn a_footprint_becomes_a_closed_house_that_faces_out() {
    let model = load(&projected(&[feature(r#""height":12,"id":"h7""#, &square_m(10.0))]));
    let mesh = &model.scene.objects[0].mesh;
    assert_eq!((mesh.triangles().len(), Topology::new(mesh).counts().is_closed()), (12, true));
    assert!((volume(mesh) - 1200.0).abs() < 1e-2, "{}", volume(mesh));
    assert_eq!(
        [SurfaceKind::Roof, SurfaceKind::Base, SurfaceKind::Wall].map(|kind| area(&model, kind).round()),
        [100.0, 100.0, 480.0]
    );
    assert_eq!((model.scene.objects[0].name.as_str(), z_range(&model)), ("h7", [0.0, 12.0]));
    assert_eq!((model.crs.as_ref().map(Crs::epsg), model.source_crs), (Some(28992), None));
}

#[test]
fn a_courtyard_stays_open_whichever_way_its_ring_is_walked() {
    let inner = "[[92002,437002],[92006,437002],[92006,437006],[92002,437006],[92002,437002]]";
    let reversed = "[[92002,437002],[92002,437006],[92006,437006],[92006,437002],[92002,437002]]";
    for hole in [inner, reversed] {
        let model = load(&projected(&[feature(r#""height":5"#, &format!("{},{hole}", square_m(10.0)))]));
        let mesh = &model.scene.objects[0].mesh;
        assert!(Topology::new(mesh).counts().is_closed());
        assert!((volume(mesh) - 5.0 * 84.0).abs() < 1e-2, "{}", volume(mesh));
        assert!((area(&model, SurfaceKind::Wall) - 5.0 * 56.0).abs() < 1e-2);
    }
}

#[test]
fn longitudes_and_latitudes_become_metres_of_a_utm_zone() {
    let model = load(&collection(&[feature(r#""height":20"#, &format!("{SQUARE},{COURT}"))]));
    assert_eq!(
        (model.crs.as_ref().map(Crs::epsg), model.source_crs.as_ref().map(Crs::epsg)),
        (Some(32633), Some(4326))
    );
    let size = model.scene.bounds().size();
    assert!((size - DVec3::new(76.5, 112.5, 20.0)).abs().max_element() < 3.0, "{size}");
    assert!(model.warnings.is_empty(), "{}", warnings(&model));
    // And into what is there already.
    let into = Crs::from_epsg(31256).expect("it is known");
    let options = LoadOptions { into: Some(into.clone()), ..LoadOptions::default() };
    let vienna = load_with(&collection(&[feature(r#""height":20"#, SQUARE)]), &options).expect("it is there");
    assert_eq!(vienna.crs, Some(into));
    assert!((vienna.scene.origin.y - 340_000.0).abs() < 5_000.0, "{}", vienna.scene.origin);
}

/// A web map shows a metre of Vienna as one and a half.
#[test]
fn a_web_map_becomes_metres_of_the_ground() {
    let crs = Crs::from_epsg(3857).expect("it is known");
    let corner = crs.of_lon_lat(glam::DVec2::new(16.37, 48.2)).expect("a place");
    let ring: Vec<String> = [[0.0, 0.0], [30.0, 0.0], [30.0, 30.0], [0.0, 30.0]]
        .iter()
        .map(|[x, y]| format!("[{},{}]", corner.x + x, corner.y + y))
        .collect();
    let json = projected(&[feature(r#""height":20"#, &format!("[{}]", ring.join(",")))]).replace("28992", "3857");
    let model = load(&json);
    assert_eq!(
        (model.crs.as_ref().map(Crs::epsg), model.source_crs.as_ref().map(Crs::epsg)),
        (Some(32633), Some(3857))
    );
    let size = model.scene.bounds().size();
    assert!((size.x - 20.0).abs() < 0.6 && (size.y - 20.0).abs() < 0.6, "{size}");
    assert!(warnings(&model).contains("where a metre is shown as 1.5"), "{}", warnings(&model));
}

#[test]
fn a_single_feature_and_a_bare_geometry_are_files_too() {
    let one = feature(r#""height":20"#, SQUARE);
    assert_eq!(load(&one).scene.triangle_count(), 12);
    let bare = format!(r#"{{"type":"Polygon","coordinates":[{SQUARE}],"properties":{{"height":3}}}}"#);
    assert_eq!(load(&bare).scene.triangle_count(), 12);
    let multi = one.replace("\"Polygon\"", "\"MultiPolygon\"").replace("[[[", "[[[[").replace("]]]", "]]]]");
    assert_eq!(load(&multi).scene.triangle_count(), 12);
    let within = one
        .replace(r#""geometry":"#, r#""geometry":{"type":"GeometryCollection","geometries":["#)
        .replace("]]]}", "]]]}]}");
    assert_eq!(load(&within).scene.triangle_count(), 12);
}

#[test]
fn heights_are_found_under_the_names_that_people_use() {
    let top = |properties: &str| z_range(&load(&projected(&[feature(properties, &square_m(10.0))])))[1];
    for (properties, expected) in [
        (r#""HAUTEUR":9.2"#, 9.2),
        (r#""height":"12 m""#, 12.0),
        (r#""Height":12"#, 12.0),
        (r#""render_height":7"#, 7.0),
        (r#""building:height":"40 ft""#, 12.192),
        (r#""measuredHeight":3.5"#, 3.5),
        (r#""height":null,"building:levels":"4""#, 12.0),
        (r#""height":20,"min_height":5"#, 20.0),
        (r#""height":20,"base":100"#, 120.0),
    ] {
        assert!((top(properties) - expected).abs() < 1e-4, "{properties}: {}", top(properties));
    }
    let levels = load(&projected(&[feature(r#""levels":4"#, &square_m(10.0))]));
    assert!(warnings(&levels).contains("storeys instead of a height; each was taken for 3 m"));
}

#[test]
fn a_base_is_the_ground_or_where_a_part_begins() {
    let of = |properties: &str, base: Option<&str>| {
        let options = LoadOptions { base_field: base.map(str::to_owned), ..LoadOptions::default() };
        z_range(&load_with(&projected(&[feature(properties, &square_m(10.0))]), &options).expect("good"))
    };
    assert_eq!(of(r#""height":20,"min_height":5"#, None), [5.0, 20.0]);
    assert_eq!(of(r#""height":20,"ground":100"#, None), [100.0, 120.0]);
    assert_eq!(of(r#""height":20,"Z_MIN_SOL":200.5"#, Some("Z_MIN_SOL")), [200.5, 220.5]);
    assert_eq!(of(r#""height":20,"min_height":5"#, Some("min_height")), [5.0, 20.0]);
}

#[test]
fn the_named_height_field_counts_and_one_that_is_nowhere_is_an_error() {
    let json = projected(&[feature(r#""height":20,"eaves":6"#, &square_m(10.0))]);
    let named =
        |name: &str| load_with(&json, &LoadOptions { height_field: Some(name.to_owned()), ..LoadOptions::default() });
    assert_eq!(z_range(&named("eaves").expect("it is there")), [0.0, 6.0]);
    let message = named("ridge").expect_err("it is not there").to_string();
    assert!(
        message.contains("no feature has a property \"ridge\"; properties that are numbers")
            && message.contains("\"eaves\""),
        "{message}"
    );
}

#[test]
fn features_that_are_no_houses_are_skipped_and_counted() {
    let good = feature(r#""height":20"#, SQUARE);
    let of = |bad: &str| warnings(&load(&collection(&[good.clone(), bad.to_owned()])));
    assert!(
        of(&feature(r#""x":1"#, SQUARE))
            .contains("1 feature without a height was skipped (first: feature 1 \"town 1\")")
    );
    assert!(
        of(&feature(r#""height":0"#, SQUARE))
            .contains("not higher than its base was skipped (first: feature 1 \"town 1\": from 0 to 0 m)")
    );
    assert!(of(&feature(r#""height":-4"#, SQUARE)).contains("from 0 to -4 m"));
    assert!(
        of(r#"{"type":"Feature","geometry":{"type":"Point","coordinates":[16.3,48.2]}}"#).contains("it is a \"Point\"")
    );
    assert!(of(r#"{"type":"Feature","geometry":null}"#).contains("feature without a polygon"));
    assert!(of(&feature(r#""height":3"#, "[[16.37,48],[16.371,48],[16.37,48]]")).contains("without area was skipped"));
    assert!(of(&feature(r#""height":3"#, "[[16,48],[17]]")).contains("[17] is not a position"));
    assert!(of(&feature(r#""height":3"#, "")).contains("it has no ring"));
    assert!(
        error(&collection(&[feature(r#""eaves":3"#, SQUARE)]))
            .contains("of which --height-field names the height: \"eaves\"")
    );
}

#[test]
fn repeated_points_and_clockwise_rings_make_no_difference() {
    let plain = load(&projected(&[feature(r#""height":5"#, &square_m(10.0))]));
    let odd = "[[92000,437000],[92000,437000],[92000,437010],[92010,437010],[92010,437010],[92010,437000],[92000,437000],[92000,437000]]";
    let odd = load(&projected(&[feature(r#""height":5"#, odd)]));
    let volumes = [&plain, &odd].map(|model| volume(&model.scene.objects[0].mesh));
    assert!((volumes[0] - volumes[1]).abs() < 1e-3, "{volumes:?}");
    assert!(odd.warnings.is_empty());
}

/// Two triangles that meet where the ring crosses itself: each faces out.
#[test]
fn a_footprint_that_crosses_itself_is_resolved() {
    let bow = "[[92000,437000],[92010,437010],[92010,437000],[92000,437010],[92000,437000]]";
    let model = load(&projected(&[feature(r#""height":5"#, bow)]));
    assert!(warnings(&model).contains("1 footprint crosses itself"), "{}", warnings(&model));
    let mesh = &model.scene.objects[0].mesh;
    assert!((volume(mesh) - 250.0).abs() < 1e-2, "{}", volume(mesh));
    assert_eq!(Topology::new(mesh).counts().border_edges, 0);
}

#[test]
fn heights_in_coordinates_are_left_out_and_told() {
    let rings = square_m(10.0).replace("437000]", "437000,209.7]");
    let model = load(&projected(&[feature(r#""height":5"#, &rings)]));
    assert_eq!(z_range(&model), [0.0, 5.0]);
    assert!(warnings(&model).contains("1 feature has heights in its coordinates, which were left out"));
}

#[test]
fn coordinates_that_are_not_what_they_are_said_to_be_are_told() {
    let metres = collection(&[feature(r#""height":5"#, &square_m(10.0))]);
    let message = error(&metres);
    assert!(
        message.contains("such as 92000, 437000, are not longitudes and latitudes") && message.contains("--crs"),
        "{message}"
    );
    let rd = LoadOptions { crs: Crs::from_epsg(28992).ok(), ..LoadOptions::default() };
    assert_eq!(load_with(&metres, &rd).expect("good").crs, rd.crs);
    // Degrees, whatever the options say of other files; but not against what the file itself says.
    let degrees = collection(&[feature(r#""height":5"#, SQUARE)]);
    let model = load_with(&degrees, &rd).expect("good");
    assert!(warnings(&model).contains("longitudes and latitudes, as GeoJSON should"));
    assert_eq!(model.crs.as_ref().map(Crs::epsg), Some(32633));
    let wrong = projected(&[feature(r#""height":5"#, SQUARE)]);
    assert!(error(&wrong).contains("it says that it is in EPSG:28992"), "{}", error(&wrong));
    let swapped = collection(&[feature(r#""height":5"#, "[[35.5,139.7],[35.501,139.7],[35.501,139.701]]")]);
    assert!(error(&swapped).contains("name their system with --crs"), "{}", error(&swapped));
    // A system of metres near the zero of which somebody built.
    let local = collection(&[feature(r#""height":5"#, "[[0,0],[40,0],[40,30],[0,30]]")]);
    assert!(error(&local).contains("are not longitudes and latitudes of buildings"));
}

#[test]
fn houses_on_both_sides_of_the_date_line_are_neighbours() {
    let west = SQUARE.replace("16.37", "179.999").replace("48.2", "-16.5");
    let east = SQUARE.replace("16.371", "-179.998").replace("16.37", "-179.999").replace("48.2", "-16.5");
    let model = load(&collection(&[
        feature(r#""height":5"#, &west.replace("179.9991", "179.9995")),
        feature(r#""height":5"#, &east),
    ]));
    assert!(model.scene.bounds().size().x < 500.0, "{:?}", model.scene.bounds());
}

#[test]
fn a_house_of_three_kilometres_is_told() {
    let model = load(&collection(&[feature(r#""height":3000"#, SQUARE)]));
    assert!(warnings(&model).contains("is its height in another unit than metres? (first: \"town 0\": 3000 m)"));
}

#[test]
fn geojson_is_known_by_its_type_under_the_ending_json_too() {
    let json = collection(&[feature(r#""height":20"#, SQUARE)]);
    let model = load_bytes(json.as_bytes(), Format::CityJson, "town.json", None, &LoadOptions::default());
    assert_eq!(model.expect("it is GeoJSON").format, Format::GeoJson);
    assert!(error(r#"{"type":"Topology"}"#).contains("its type is \"Topology\", which is no GeoJSON"));
    assert!(error("{\"type\":\"Feature\",\n\"geometry\":7}").contains("line 2: its JSON can't be read at column 12"));
}
