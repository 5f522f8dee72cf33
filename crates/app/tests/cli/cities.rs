//! Cities from outside: what is told of where they are, and what is asked for where they do not say.

use serde_json::Value;

use crate::files::Place;

/// A box of 4 by 3 by 2 m; SAID is what it says of where it is.
const CITY: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[92000,437000,0]},SAID
    "vertices":[[0,0,0],[4000,0,0],[4000,3000,0],[0,3000,0],[0,0,2000],[4000,0,2000],[4000,3000,2000],[0,3000,2000]],
    "CityObjects":{"house":{"type":"Building","geometry":[{"type":"Solid","lod":"2.2","boundaries":[[[[3,2,1,0]],[[4,5,6,7]],
    [[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]]}]}}}"#;

const SAID: &str = r#""metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/28992"},"#;

const FOOTPRINT: &str = r#"{"type":"Feature","id":"hall","properties":{"height":12,"eaves":7},"geometry":{"type":"Polygon","coordinates":
    [[[16.37,48.2],[16.371,48.2],[16.371,48.201],[16.37,48.201],[16.37,48.2]]]}}"#;

fn inspected(place: &Place, args: &[&str]) -> Value {
    let assert = place.umbrae(&[&["inspect", "--json"], args].concat()).success();
    serde_json::from_slice(&assert.get_output().stdout).expect("it is JSON")
}

#[test]
fn a_city_tells_what_its_coordinates_are_in() {
    let place = Place::new();
    let city = place.file("town.city.json", CITY.replace("SAID", SAID));
    let json = inspected(&place, &[&city]);
    assert_eq!((&json["format"], &json["closed"], &json["triangles"]), (&"cityjson".into(), &true.into(), &12.into()));
    assert_eq!((&json["crs"]["epsg"], &json["source_crs"]), (&28992.into(), &Value::Null));
    assert_eq!(json["bounds"]["min"], serde_json::json!([92000.0, 437000.0, 0.0]));
    let text = place.umbrae(&["inspect", &city]).success();
    let text = String::from_utf8(text.get_output().stdout.clone()).expect("it is text");
    assert!(text.contains("coordinates in         EPSG:28992 (Amersfoort / RD New)"), "{text}");
}

#[test]
fn degrees_become_metres_and_heights_are_those_that_are_asked_for() {
    let place = Place::new();
    let hall = place.file("hall.geojson", FOOTPRINT);
    let json = inspected(&place, &[&hall]);
    assert_eq!((&json["crs"]["epsg"], &json["source_crs"]["epsg"]), (&32633.into(), &4326.into()));
    assert_eq!((&json["bounds"]["max"][2], &json["objects"][0]["name"]), (&12.0.into(), &"hall".into()));
    let eaves = inspected(&place, &[&hall, "--height-field", "eaves"]);
    assert_eq!(eaves["bounds"]["max"][2], 7.0);
}

#[test]
fn what_the_user_says_counts_where_the_file_is_silent() {
    let place = Place::new();
    let silent = place.file("silent.json", CITY.replace("SAID", ""));
    assert_eq!(inspected(&place, &[&silent])["crs"], Value::Null);
    assert_eq!(inspected(&place, &[&silent, "--crs", "EPSG:25832"])["crs"]["epsg"], 25832);
}

#[test]
fn cities_that_can_not_be_shown_are_refused_in_one_sentence() {
    let place = Place::new();
    let city = place.file("town.city.json", CITY.replace("SAID", SAID));
    place.refuses(&["inspect", &city, "--lod", "3"], &["no level of detail \"3\"; it has \"2.2\""]);
    place.refuses(&["inspect", &city, "--crs", "RD New"], &["names no coordinate reference system", "EPSG:28992"]);
    place.refuses(&["inspect", &city, "--crs", "EPSG:1"], &["EPSG:1 is no coordinate reference system that we know"]);
    let hall = place.file("hall.geojson", FOOTPRINT);
    place
        .refuses(&["inspect", &hall, "--height-field", "ridge"], &["no feature has a property \"ridge\"", "\"eaves\""]);
    let metres = place.file("metres.geojson", FOOTPRINT.replace("16.37", "92000").replace("48.2", "437000"));
    place.refuses(&["inspect", &metres], &["are not longitudes and latitudes of buildings", "--crs"]);
    let gml = place.file("town.gml", "<CityModel/>");
    place.refuses(&["inspect", &gml], &["CityGML can't be read", "citygml-tools"]);
    place.refuses(&["render", &city, &hall, "-o", &place.out("x.png")], &["can't join", "apart"]);
}
