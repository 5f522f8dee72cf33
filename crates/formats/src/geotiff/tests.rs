use std::io::Cursor;

use glam::DVec3;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;
use umbrae_core::SurfaceKind;

use crate::{Crs, Format, LoadError, LoadOptions, Model, load_bytes};

/// What is in the tags of a grid.
#[derive(Clone)]
struct Tags {
    scale: Option<Vec<f64>>,
    tie: Option<Vec<f64>>,
    matrix: Option<Vec<f64>>,
    /// Rows of four.
    keys: Vec<u16>,
    no_data: Option<&'static str>,
}

impl Default for Tags {
    /// Half a metre in RD New, areas, the corner of the first at 92000, 437000.
    fn default() -> Self {
        Self {
            scale: Some(vec![0.5, 0.5, 0.0]),
            tie: Some(vec![0.0, 0.0, 0.0, 92_000.0, 437_000.0, 0.0]),
            matrix: None,
            keys: vec![1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 28992],
            no_data: None,
        }
    }
}

/// A file of `columns` by `rows` samples.
fn tiff<C: colortype::ColorType>(columns: u32, samples: &[C::Inner], tags: &Tags) -> Vec<u8>
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).expect("memory takes it");
    let mut image = encoder
        .new_image::<C>(columns, (samples.len() / C::BITS_PER_SAMPLE.len()) as u32 / columns)
        .expect("a good size");
    let directory = image.encoder();
    for (tag, numbers) in [
        (Tag::ModelPixelScaleTag, &tags.scale),
        (Tag::ModelTiepointTag, &tags.tie),
        (Tag::ModelTransformationTag, &tags.matrix),
    ] {
        if let Some(numbers) = numbers {
            directory.write_tag(tag, numbers.as_slice()).expect("memory takes it");
        }
    }
    let keys: Vec<u16> = [1, 1, 0, tags.keys.len() as u16 / 4].iter().chain(&tags.keys).copied().collect();
    directory.write_tag(Tag::GeoKeyDirectoryTag, keys.as_slice()).expect("memory takes it");
    if let Some(text) = tags.no_data {
        directory.write_tag(Tag::GdalNodata, text).expect("memory takes it");
    }
    image.write_data(samples).expect("memory takes it");
    bytes.into_inner()
}

fn floats(columns: u32, samples: &[f32], tags: &Tags) -> Vec<u8> {
    tiff::<colortype::Gray32Float>(columns, samples, tags)
}

fn load_with(bytes: &[u8], options: &LoadOptions) -> Result<Model, LoadError> {
    load_bytes(bytes, Format::GeoTiff, "dir/hill.tif", None, options)
}

fn load(bytes: &[u8]) -> Model {
    load_with(bytes, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn error(bytes: &[u8]) -> String {
    load_with(bytes, &LoadOptions::default()).expect_err("a bad file").to_string()
}

/// Where the samples that are used are, in the order of the file.
fn positions(model: &Model) -> Vec<DVec3> {
    let mut positions: Vec<DVec3> = model.scene.objects[0].positions().map(|p| p + model.scene.origin).collect();
    positions.sort_by(|a, b| b.y.total_cmp(&a.y).then(a.x.total_cmp(&b.x)));
    positions
}

const HILL: [f32; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.5];

#[test]
fn samples_of_areas_are_in_their_middles_and_rows_go_south() {
    let model = load(&floats(3, &HILL, &Tags::default()));
    assert_eq!(
        positions(&model),
        [
            DVec3::new(92_000.25, 436_999.75, 1.0),
            DVec3::new(92_000.75, 436_999.75, 2.0),
            DVec3::new(92_001.25, 436_999.75, 3.0),
            DVec3::new(92_000.25, 436_999.25, 4.0),
            DVec3::new(92_000.75, 436_999.25, 5.0),
            DVec3::new(92_001.25, 436_999.25, 6.5),
        ]
    );
    assert_eq!((model.scene.triangle_count(), model.scene.objects[0].name.as_str()), (4, "hill"));
    assert_eq!(model.scene.materials[0].surface, SurfaceKind::Terrain);
    assert_eq!(model.crs.as_ref().map(Crs::epsg), Some(28992));
}

fn faces_up(model: &Model) -> bool {
    let mesh = &model.scene.objects[0].mesh;
    let p = |v: u32| mesh.positions()[v as usize];
    mesh.triangles().iter().all(|&[a, b, c]| (p(b) - p(a)).cross(p(c) - p(a)).z > 0.0)
}

#[test]
fn points_matrices_and_mirrored_grids_are_placed_and_face_up() {
    let point = Tags { keys: vec![1025, 0, 1, 2, 3072, 0, 1, 28992], ..Tags::default() };
    let at_corner = load(&floats(3, &HILL, &point));
    assert_eq!(positions(&at_corner)[0], DVec3::new(92_000.0, 437_000.0, 1.0));
    let matrix = vec![0.5, 0.0, 0.0, 92_000.0, 0.0, -0.5, 0.0, 437_000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let by_matrix = Tags { scale: None, tie: None, matrix: Some(matrix.clone()), ..Tags::default() };
    assert_eq!(positions(&load(&floats(3, &HILL, &by_matrix))), positions(&load(&floats(3, &HILL, &Tags::default()))));
    // Rows to the north, and turned by a quarter.
    let mut north = matrix.clone();
    north[5] = 0.5;
    let mut turned = matrix;
    (turned[0], turned[1], turned[4], turned[5]) = (0.0, -0.5, -0.5, 0.0);
    for matrix in [north, turned] {
        let model = load(&floats(3, &HILL, &Tags { matrix: Some(matrix), ..by_matrix.clone() }));
        assert!(faces_up(&model) && model.scene.triangle_count() == 4);
    }
    assert!(faces_up(&at_corner));
}

#[test]
fn whole_numbers_and_doubles_are_heights_too() {
    let tags = Tags { no_data: Some("0"), ..Tags::default() };
    let heights = |bytes: Vec<u8>| positions(&load(&bytes)).iter().map(|p| p.z).collect::<Vec<_>>();
    assert_eq!(heights(tiff::<colortype::Gray8>(2, &[1, 2, 3, 255], &tags)), [1.0, 2.0, 3.0, 255.0]);
    assert_eq!(heights(tiff::<colortype::Gray16>(2, &[1, 2, 3, 9000], &tags)), [1.0, 2.0, 3.0, 9000.0]);
    assert_eq!(heights(tiff::<colortype::GrayI16>(2, &[-1, 2, 3, 4000], &tags)), [-1.0, 2.0, 3.0, 4000.0]);
    assert_eq!(heights(tiff::<colortype::GrayI32>(2, &[-1, 2, 3, 4000], &tags)), [-1.0, 2.0, 3.0, 4000.0]);
    assert_eq!(heights(tiff::<colortype::Gray64Float>(2, &[-1.5, 2.0, 3.0, 4000.0], &tags)), [-1.5, 2.0, 3.0, 4000.0]);
}

#[test]
fn samples_without_a_height_are_left_open() {
    let tags = Tags { no_data: Some("-32767"), ..Tags::default() };
    let count = |hole: usize, tags: &Tags, value: f32| {
        let mut samples = [1.0; 9];
        samples[hole] = value;
        load(&floats(3, &samples, tags)).scene.triangle_count()
    };
    // A corner is in one square, of which half is left; the middle is in four.
    assert_eq!([count(0, &tags, -32767.0), count(2, &tags, -32767.0), count(4, &tags, -32767.0)], [7, 7, 4]);
    assert_eq!(count(4, &Tags { no_data: Some("nan"), ..Tags::default() }, f32::NAN), 4);
    // As GDAL writes the least float.
    assert_eq!(count(4, &Tags { no_data: Some("-3.4028234663852886e+38"), ..Tags::default() }, f32::MIN), 4);
    let unsaid = load(&floats(3, &[1.0, 1.0, 1.0, 1.0, -9999.0, 1.0, 1.0, 1.0, 3e30], &Tags::default()));
    assert_eq!(
        unsaid.warnings[0].to_string(),
        "2 samples that can't be heights were left open, though the file does not say that they are none"
    );
    assert!(
        error(&floats(2, &[-32767.0; 4], &tags)).contains("no three neighbours of its 2 x 2 samples have a height")
    );
}

/// As GDAL writes a file of which some strips have no data: they have no bytes, and lie at 0.
#[test]
fn strips_that_are_not_in_the_file_are_left_open() {
    let samples = [1.0_f32; 3 * 4];
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).expect("memory takes it");
    let mut image = encoder.new_image::<colortype::Gray32Float>(3, 4).expect("a good size");
    image.rows_per_strip(2).expect("before any is written");
    image.encoder().write_tag(Tag::ModelPixelScaleTag, [0.5, 0.5, 0.0_f64].as_slice()).expect("memory takes it");
    image.encoder().write_tag(Tag::ModelTiepointTag, [0.0_f64; 6].as_slice()).expect("memory takes it");
    image.write_data(&samples).expect("memory takes it");
    let mut bytes = bytes.into_inner();
    assert_eq!(load(&bytes).scene.triangle_count(), 12);
    // The two byte counts are 24 and 24, one after the other.
    let counts = [24_u32.to_ne_bytes(), 24_u32.to_ne_bytes()].concat();
    let at = bytes.windows(8).position(|eight| eight == counts).expect("the byte counts");
    bytes[at + 4..at + 8].fill(0);
    assert_eq!(load(&bytes).scene.triangle_count(), 4);
}

#[test]
fn a_step_keeps_every_second_sample_and_too_many_are_refused() {
    let samples: Vec<f32> = (0..35).map(|i| i as f32).collect();
    let options = LoadOptions { terrain_step: Some(2), ..LoadOptions::default() };
    let model = load_with(&floats(7, &samples, &Tags::default()), &options).expect("good");
    let heights: Vec<f64> = positions(&model).iter().map(|p| p.z).collect();
    assert_eq!(heights, [0.0, 2.0, 4.0, 6.0, 14.0, 16.0, 18.0, 20.0, 28.0, 30.0, 32.0, 34.0]);
    assert_eq!(positions(&model)[1].x, 92_001.25);
    let large = tiff::<colortype::Gray8>(4000, &vec![1; 4000 * 4000], &Tags::default());
    assert!(error(&large).contains("its 4000 x 4000 samples are more than the 10000000 that can be shown; cut it, or read every 2th with --terrain-step 2"));
}

#[test]
fn degrees_become_metres_and_feet_too() {
    let degrees = Tags {
        scale: Some(vec![1e-4, 1e-4, 0.0]),
        tie: Some(vec![0.0, 0.0, 0.0, 16.37, 48.2, 0.0]),
        keys: vec![1024, 0, 1, 2, 2048, 0, 1, 4326],
        ..Tags::default()
    };
    let model = load(&floats(3, &HILL, &degrees));
    assert_eq!(
        (model.crs.as_ref().map(Crs::epsg), model.source_crs.as_ref().map(Crs::epsg)),
        (Some(32633), Some(4326))
    );
    let size = model.scene.bounds().size();
    assert!((size.x - 14.9).abs() < 0.5 && (size.y - 11.1).abs() < 0.5 && size.z == 5.5, "{size}");
    let feet = Tags { keys: vec![3072, 0, 1, 28992, 4099, 0, 1, 9002], ..Tags::default() };
    assert!((load(&floats(3, &HILL, &feet)).scene.bounds().size().z - 5.5 * 0.3048).abs() < 1e-6);
}

#[test]
fn files_that_are_no_terrain_say_why() {
    let nowhere = Tags { scale: None, tie: None, ..Tags::default() };
    assert!(error(&floats(3, &HILL, &nowhere)).contains("it does not say where it is"));
    let flat = Tags { scale: Some(vec![0.0, 0.5, 0.0]), ..Tags::default() };
    assert!(error(&floats(3, &HILL, &flat)).contains("no distance from each other"));
    let points = Tags { scale: None, tie: Some(vec![0.0; 18]), ..Tags::default() };
    assert!(error(&floats(3, &HILL, &points)).contains("placed by 3 points"));
    assert!(error(&tiff::<colortype::RGB8>(2, &[0; 12], &Tags::default())).contains("it is a picture, not heights"));
    assert!(error(&floats(3, &HILL[..3], &Tags::default())).contains("3 x 1 samples are no surface"));
    assert!(error(b"II*\0").contains("its TIFF can't be read"));
    let fathoms = Tags { keys: vec![3072, 0, 1, 28992, 4099, 0, 1, 9014], ..Tags::default() };
    assert!(error(&floats(3, &HILL, &fathoms)).contains("EPSG's unit 9014"));
}

#[test]
fn a_system_of_its_own_is_told_by_its_name() {
    let own = Tags { keys: vec![3072, 0, 1, 32767], ..Tags::default() };
    let model = load(&floats(3, &HILL, &own));
    assert!(model.crs.is_none());
    assert!(
        model.warnings[0].to_string().contains("\"user-defined\" names no coordinate reference system"),
        "{:?}",
        model.warnings
    );
    let given = LoadOptions { crs: Crs::from_epsg(28992).ok(), ..LoadOptions::default() };
    assert_eq!(load_with(&floats(3, &HILL, &own), &given).expect("good").crs, given.crs);
}
