//! From a path or bytes to a [`Model`].

use std::fs;
use std::io;
use std::path::Path;

use crate::error::Problem;
use crate::{
    Crs, Format, LoadError, Model, UpAxis, cityjson, geojson, georeference, geotiff, gltf, json, obj, ply, stl,
};

/// What a file does not say about itself, and what of it is wanted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LoadOptions {
    /// The file's up axis, where its format leaves it open; `None` is what is usual for the format: z for STL,
    /// y for OBJ and PLY. glTF says that y is up, so there this is ignored, with a warning.
    pub up: Option<UpAxis>,
    /// What the file's coordinates are in, where it says nothing. A file that does say is believed, with a warning if
    /// that is something else.
    pub crs: Option<Crs>,
    /// What the scene is to be in, which must be projected: that of a model that is already there. `None` is what the file
    /// is in, or the UTM zone of its middle where that is no plane in metres (degrees, web maps).
    pub into: Option<Crs>,
    /// The level of detail of a CityJSON file, as it is named there ("1.3"); `None` is the highest of each object.
    pub lod: Option<String>,
    /// The property of GeoJSON features that is their height above their base; `None` is the first that is usual.
    pub height_field: Option<String>,
    /// The property of GeoJSON features that is the height of their base; `None` is the first that is usual, else 0.
    pub base_field: Option<String>,
    /// How many samples of a terrain in a row and column become one, at least 1; `None` is 1.
    pub terrain_step: Option<u32>,
    /// Whether to read the normals of vertices into [`umbrae_core::Mesh::corner_normals`], from glTF, OBJ and PLY (those of STL are flat by
    /// nature). Only smooth shading and smooth silhouettes need them, and they take more memory than the rest of a mesh.
    pub normals: bool,
}

/// What every reader is given besides the bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    /// What an object is called that the file gives no name: the file's name without its ending.
    pub(crate) stem: &'a str,
    /// Where files lie that this one names; `None` when it came from nowhere.
    pub(crate) folder: Option<&'a Path>,
    /// What the user knows about the file.
    pub(crate) options: &'a LoadOptions,
}

/// Loads the model in the file at `path`, whose name's ending says the format.
///
/// Reads the file into memory whole, and for OBJ and glTF the files it names beside it, pictures
/// included.
///
/// # Errors
///
/// [`LoadError`] names the file, the place in it and the offending value. A broken part among good ones is a
/// warning, not an error; a file without any usable triangle is an error.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Model, LoadError> {
    let read_error = |source: io::Error| match source.kind() {
        io::ErrorKind::NotFound => LoadError::NotFound { path: path.to_owned() },
        _ => LoadError::Read { path: path.to_owned(), source },
    };
    // Anything but an ordinary file (a device, a pipe) may have no end.
    if !fs::metadata(path).map_err(read_error)?.is_file() {
        return Err(LoadError::NotAFile { path: path.to_owned() });
    }
    let format = Format::of_path(path).ok_or_else(|| unknown_format(path))?;
    let bytes = fs::read(path).map_err(read_error)?;
    load_bytes(&bytes, format, &path.display().to_string(), path.parent(), options)
}

/// Why there is no format for the name of a file.
fn unknown_format(path: &Path) -> LoadError {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("gml" | "citygml" | "xml") => LoadError::CityGml { path: path.to_owned() },
        _ => LoadError::UnknownFormat { path: path.to_owned() },
    }
}

/// Loads the model in `bytes`, the content of a file of this `format`.
///
/// `name` is what errors call the file, and without folder and ending names objects that have no name of their
/// own. `folder` is where files are looked for that the model names (glTF buffers, OBJ materials); without one,
/// those count as missing.
///
/// # Errors
///
/// [`LoadError::Content`]; as for [`load`].
pub fn load_bytes(
    bytes: &[u8],
    format: Format,
    name: &str,
    folder: Option<&Path>,
    options: &LoadOptions,
) -> Result<Model, LoadError> {
    let context = Context { stem: stem_of(name), folder, options };
    let read = || match (other_format(bytes, format), format) {
        (Some(other), _) => Err(Problem::whole(other)),
        (_, Format::CityJson | Format::GeoJson) => match json::kind_of(bytes) {
            Some(kind) if kind.starts_with("CityJSON") => cityjson::read(bytes, context),
            Some(kind) if geojson::is_kind(&kind) => geojson::read(bytes, context),
            _ if format == Format::GeoJson => geojson::read(bytes, context),
            _ => cityjson::read(bytes, context),
        },
        (_, Format::GeoTiff) => geotiff::read(bytes, context),
        (_, Format::Gltf) => gltf::read(bytes, context),
        (_, Format::Obj) => obj::read(bytes, context),
        (_, Format::Ply) => ply::read(bytes, context),
        (_, Format::Stl) => stl::read(bytes, context),
    };
    let placed = read().and_then(|mut model| {
        if !format.is_of_cities() {
            georeference::place_mesh_file(&mut model, options)?;
        }
        Ok(model)
    });
    placed.map_err(|problem| LoadError::Content { file: name.to_owned(), problem })
}

/// Why `bytes` can't be of this `format`, if their first ones are those of something else.
fn other_format(bytes: &[u8], format: Format) -> Option<String> {
    if bytes.is_empty() {
        return Some("the file is empty (0 bytes)".to_owned());
    }
    let magics: [(&[u8], &str, Option<Format>); 9] = [
        (b"II*\0", "a .tif file", Some(Format::GeoTiff)),
        (b"MM\0*", "a .tif file", Some(Format::GeoTiff)),
        (b"II+\0", "a .tif file", Some(Format::GeoTiff)),
        (b"glTF", "a .glb file", Some(Format::Gltf)),
        (b"ply\n", "a .ply file", Some(Format::Ply)),
        (b"ply\r", "a .ply file", Some(Format::Ply)),
        (b"\x1f\x8b", "a gzip archive", Some(Format::Ply)),
        (b"PK\x03\x04", "a zip archive", None),
        (b"\x89PNG", "a picture", None),
    ];
    let (_, what, _) = magics.iter().find(|(magic, _, of)| bytes.starts_with(magic) && *of != Some(format))?;
    Some(format!("this is {what} under another name; give it its own ending, unpack it or convert it"))
}

/// `houses/tower.ply.gz` is about a `tower`.
fn stem_of(name: &str) -> &str {
    let file_name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let unzipped = file_name.strip_suffix(".gz").unwrap_or(file_name);
    match unzipped.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => unzipped,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stem_is_the_name_without_folders_and_ending() {
        assert_eq!(stem_of("a/b.c/tower.v2.ply.gz"), "tower.v2");
        assert_eq!(stem_of("tower"), "tower");
        assert_eq!(stem_of(".obj"), ".obj");
    }

    #[test]
    fn a_folder_and_a_missing_file_and_an_unknown_ending_are_told_apart() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let options = LoadOptions::default();
        let model = folder.path().join("model.obj");
        assert!(matches!(load(&model, &options), Err(LoadError::NotFound { .. })));
        fs::create_dir(&model).expect("a folder in it");
        assert!(matches!(load(&model, &options), Err(LoadError::NotAFile { .. })));
        let drawing = folder.path().join("model.dwg");
        fs::write(&drawing, "AC1032").expect("a file in it");
        let error = load(&drawing, &options).expect_err("we don't read drawings");
        let city = folder.path().join("city.gml");
        fs::write(&city, "<CityModel/>").expect("a file in it");
        let no_xml = load(&city, &options).expect_err("we don't read XML").to_string();
        assert!(
            no_xml.ends_with(
                "city.gml: CityGML can't be read; convert it to CityJSON, as with citygml-tools to-cityjson"
            ),
            "{no_xml}"
        );
        assert!(error.to_string().ends_with(".city.json, .city.jsonl, .json, .geojson, .tif or .tiff"), "{error}");
    }

    #[test]
    fn a_mesh_is_in_the_system_that_the_user_names_if_that_is_in_metres() {
        let obj = b"v 92000 437000 0\nv 92004 437000 0\nv 92004 437003 0\nf 1 2 3\n";
        let load = |crs, into| {
            let [crs, into] =
                [crs, into].map(|epsg: Option<u32>| epsg.map(|epsg| Crs::from_epsg(epsg).expect("known")));
            let options = LoadOptions { up: Some(UpAxis::Z), crs, into, ..LoadOptions::default() };
            load_bytes(obj, Format::Obj, "house.obj", None, &options)
        };
        assert!(load(None, Some(28992)).expect("good").crs.is_none(), "nobody says so");
        assert_eq!(load(Some(28992), Some(7415)).expect("good").crs.map(|crs| crs.epsg()), Some(28992));
        let error = |crs, into| load(crs, into).expect_err("it can't be there").to_string();
        assert!(error(Some(4326), None).contains("those are degrees; name a projected system"));
        assert!(error(Some(28992), Some(25832)).contains("the models before it are in EPSG:25832"));
    }
}
