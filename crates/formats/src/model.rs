//! What loading gives, and the two things a format has: a name's ending and an axis that is up.

use std::path::Path;

use umbrae_core::Scene;

use crate::warnings::Warnings;
use crate::{Animations, Crs, Warning};

/// A loaded file.
///
/// [`Model::play`] shows it as it is at another moment.
#[derive(Debug, Clone)]
pub struct Model {
    /// At least one object; metres, z up, about [`Scene::origin`].
    pub scene: Scene,
    /// How the file was read.
    pub format: Format,
    /// The axis that the file was taken to have up: `Y` means that its (x, y, z) is the scene's (x, -z, y).
    pub up: UpAxis,
    /// What [`Scene::origin`] plus a position of the scene is in, always projected; `None` if neither the file nor the user
    /// says so.
    pub crs: Option<Crs>,
    /// What the file itself is in, if its coordinates were computed anew for `crs`.
    pub source_crs: Option<Crs>,
    /// What was left out or changed, each kind once.
    pub warnings: Vec<Warning>,
    /// What the file says moves; `scene` is at rest until it is played.
    pub animations: Animations,
}

impl Model {
    /// A model that says nothing of where it is, and in which nothing moves.
    pub(crate) fn of_mesh_file(scene: Scene, format: Format, up: UpAxis, warnings: Warnings) -> Self {
        Self {
            scene,
            format,
            up,
            crs: None,
            source_crs: None,
            warnings: warnings.finish(),
            animations: Animations::default(),
        }
    }
}

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// CityJSON 1.0 to 2.0 (`.city.json`, `.json`), or a `CityJSONSeq` (`.city.jsonl`, `.jsonl`); z is up.
    CityJson,
    /// GeoJSON (`.geojson`, `.json`): footprints of buildings with their heights; z is up.
    GeoJson,
    /// GeoTIFF (`.tif`, `.tiff`): the heights of terrain; z is up.
    GeoTiff,
    /// glTF 2.0, as JSON (`.gltf`) or in one binary file (`.glb`); y is up.
    Gltf,
    /// Wavefront OBJ; does not say what is up, usually y.
    Obj,
    /// PLY, ascii or binary, also gzipped (`.ply.gz`); does not say what is up, usually y.
    Ply,
    /// STL, ascii or binary; does not say what is up, usually z.
    Stl,
}

impl Format {
    /// The endings that [`Format::of_path`] knows.
    pub const ENDINGS: &str =
        ".glb, .gltf, .obj, .ply, .ply.gz, .stl, .city.json, .city.jsonl, .json, .geojson, .tif or .tiff";

    /// The format that the ending of `path` stands for, upper case or lower; `None` if we read no such format.
    ///
    /// ```
    /// use std::path::Path;
    /// use umbrae_formats::Format;
    ///
    /// assert_eq!(Format::of_path(Path::new("dragon.PLY.gz")), Some(Format::Ply));
    /// assert_eq!(Format::of_path(Path::new("tower.dwg")), None);
    /// ```
    pub fn of_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let endings = [
            (".json", Self::CityJson),
            (".jsonl", Self::CityJson),
            (".geojson", Self::GeoJson),
            (".tif", Self::GeoTiff),
            (".tiff", Self::GeoTiff),
            (".glb", Self::Gltf),
            (".gltf", Self::Gltf),
            (".obj", Self::Obj),
            (".ply", Self::Ply),
            (".stl", Self::Stl),
        ];
        let (stem, zipped) = name.strip_suffix(".gz").map_or((name.as_str(), false), |stem| (stem, true));
        let (_, format) = endings.into_iter().find(|(ending, _)| stem.ends_with(ending))?;
        (!zipped || format == Self::Ply).then_some(format)
    }

    /// What is up in a file of this format, unless the user knows better.
    pub fn usual_up(self) -> UpAxis {
        match self {
            Self::Gltf | Self::Obj | Self::Ply => UpAxis::Y,
            Self::CityJson | Self::GeoJson | Self::GeoTiff | Self::Stl => UpAxis::Z,
        }
    }

    /// Whether its files have a place on earth.
    pub(crate) fn is_of_cities(self) -> bool {
        matches!(self, Self::CityJson | Self::GeoJson | Self::GeoTiff)
    }
}

/// Which axis of a file points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// y up, x right, z towards the viewer: the file's (x, y, z) becomes the scene's (x, -z, y).
    Y,
    /// z up, as in the scene: nothing changes.
    Z,
}
