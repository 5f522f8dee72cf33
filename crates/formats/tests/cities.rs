//! Every city beside the project loads, with as many triangles as others made of it, or a known other number.

mod counts;
mod shared_data;

use umbrae_core::SurfaceKind;
use umbrae_formats::{Crs, Format, LoadOptions, Model, load};

/// A file, its objects, its triangles, its system, and how many triangles SOURCES.md measured with the reason why there
/// may be others.
type City = (&'static str, usize, usize, Option<u32>, usize, &'static str);

/// Another program left out what is no triangle; we keep corners on straight sides, because neighbours use them.
const NO_AREA: &str = "triangles without area were left out";

const CITIES: [City; 14] = [
    ("3-20-DELFSHAVEN.city.json", 853, 37_536, Some(28992), 37_517, NO_AREA),
    ("AC20-FZK-Haus.city.json", 107, 24_154, None, 23_698, NO_AREA),
    ("building_with_innerring.city.json", 1, 374, Some(2056), 374, ""),
    ("delft.json", 570, 36_271, Some(7415), 36_267, NO_AREA),
    ("euromast.json", 3, 2_158, Some(28992), 2_041, "one polygon with ten holes that touch could not be cut"),
    ("geometry_template_lod3.json", 15, 15 * 232, None, 0, "instances of templates were not shown"),
    ("japanese.city.json", 4, 406, Some(6677), 406, ""),
    ("multi_lod.json", 10, 348, None, 348, ""),
    ("paris_tower.city.jsonl", 1, 1_540, Some(2154), 1_555, "the footprint of a building was shown beside its part"),
    ("twobuildings.city.json", 2, 462, None, 462, ""),
    ("zurich_subset_lod2.json", 161, 5_142, Some(2056), 5_142, ""),
    ("bd_demo_kawasaki.geojson", 1_374, 50_740, Some(32654), 0, "footprints were counted"),
    ("buildings_lyon1_first600.geojson", 600, 23_240, Some(3946), 0, "footprints were counted"),
    ("rvt_synthetic_dem15_0.50.tif", 1, 2 * 1204 * 481, Some(32615), 0, "samples were counted: 1205 rows of 482"),
];

fn city(folder: &std::path::Path, file: &str) -> Model {
    load(&folder.join("city").join(file), &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_city_has_its_objects_and_its_triangles() {
    let Some(folder) = shared_data::folder() else { return };
    let sources = std::fs::read_to_string(folder.join("SOURCES.md")).expect("the list of models");
    for (file, objects, triangles, epsg, measured, why) in CITIES {
        let model = city(&folder, file);
        let read: usize = model.scene.objects.iter().map(|object| object.mesh.counts().triangles_read).sum();
        assert_eq!((model.scene.objects.len(), read), (objects, triangles), "{file}");
        assert_eq!(model.crs.as_ref().map(Crs::epsg), epsg, "{file}");
        let row = sources.lines().find(|line| line.contains(&format!("| city/{file} |"))).expect("it is in the list");
        assert!(measured == 0 || row.contains(&format!(" {measured} tri ")), "{file}: {row}");
        assert_eq!(read == measured, why.is_empty(), "{file}: {why}");
    }
}

/// Edges of the whole city welded together, as in SOURCES.md, where every triangle is the same.
#[test]
fn cities_that_others_cut_alike_have_the_same_edges() {
    let Some(folder) = shared_data::folder() else { return };
    for (file, border, non_manifold, inconsistent) in [
        ("building_with_innerring.city.json", 6, 0, 0),
        ("japanese.city.json", 0, 2, 0),
        ("multi_lod.json", 0, 0, 0),
        ("twobuildings.city.json", 76, 0, 0),
        // SOURCES.md has 2269 and 9: there another diagonal of one polygon meets the border of none.
        ("zurich_subset_lod2.json", 2_268, 10, 2),
    ] {
        let counts = counts::of_model(&city(&folder, file));
        assert_eq!(
            (counts.border, counts.non_manifold, counts.inconsistent),
            (border, non_manifold, inconsistent),
            "{file}"
        );
    }
}

#[test]
fn every_footprint_becomes_a_closed_solid() {
    let Some(folder) = shared_data::folder() else { return };
    for file in ["bd_demo_kawasaki.geojson", "buildings_lyon1_first600.geojson"] {
        let model = city(&folder, file);
        assert_eq!(model.format, Format::GeoJson);
        for object in &model.scene.objects {
            let counts = umbrae_core::Topology::new(&object.mesh).counts();
            assert_eq!((counts.border_edges, counts.inconsistent_edges), (0, 0), "{file}: {}", object.name);
        }
    }
}

#[test]
fn surfaces_know_what_they_are() {
    let Some(folder) = shared_data::folder() else { return };
    let kinds = |file: &str| {
        let model = city(&folder, file);
        let of = |m: &u32| model.scene.materials[*m as usize].surface;
        let all: Vec<SurfaceKind> =
            model.scene.objects.iter().flat_map(|object| object.mesh.triangle_materials().iter().map(of)).collect();
        [SurfaceKind::Roof, SurfaceKind::Wall, SurfaceKind::Base, SurfaceKind::Terrain, SurfaceKind::Unknown]
            .map(|kind| all.iter().filter(|&&other| other == kind).count())
    };
    assert_eq!(kinds("3-20-DELFSHAVEN.city.json").map(|count| count > 0), [true, true, true, false, false]);
    assert_eq!(kinds("zurich_subset_lod2.json").map(|count| count > 0), [true, true, true, false, false]);
    // Its buildings do not say; its roads, plants, land and water are the ground.
    assert_eq!(kinds("delft.json").map(|count| count > 0), [false, false, false, true, true]);
    assert_eq!(kinds("rvt_synthetic_dem15_0.50.tif")[3], 2 * 1204 * 481);
}

/// By rasterio: the bounds of its pixels are 500000 to 500241 and 5099397.5 to 5100000, of 0.5 m each.
#[test]
fn the_terrain_is_where_gdal_says() {
    let Some(folder) = shared_data::folder() else { return };
    let model = city(&folder, "rvt_synthetic_dem15_0.50.tif");
    let (bounds, origin) = (model.scene.bounds(), model.scene.origin);
    assert_eq!((bounds.min + origin).to_array(), [500_000.25, 5_099_397.75, -0.5]);
    assert_eq!((bounds.max + origin).to_array(), [500_240.75, 5_099_999.75, 0.5]);
}

/// Kawasaki's own file says so of each building: x and y of its middle.
#[test]
fn a_city_in_degrees_is_where_it_was() {
    let Some(folder) = shared_data::folder() else { return };
    let model = city(&folder, "bd_demo_kawasaki.geojson");
    let crs = model.crs.as_ref().expect("it has one");
    let middle = (model.scene.objects[0].bounds().center() + model.scene.origin).truncate();
    let lon_lat = crs.lon_lat_of(middle).expect("a place");
    assert!((lon_lat - glam::DVec2::new(139.698_695, 35.533_906)).length() < 1e-5, "{lon_lat}");
    assert_eq!(model.scene.objects[0].bounds().size().z, 42.0);
}
