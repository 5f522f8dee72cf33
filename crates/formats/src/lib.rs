//! Model files into [`umbrae_core::Scene`]s: glTF 2.0 and GLB, OBJ, PLY (also gzipped), STL; and cities, which have a place on
//! earth ([`Crs`]): `CityJSON` and `CityJSONSeq`, `GeoJSON` footprints with heights, `GeoTIFF` terrain.
//!
//! [`load()`] reads a file, [`load_bytes`] bytes that are already here. Both resolve every difficulty of the
//! format (axes, origin, polygons, instances, missing and broken parts), so that nothing downstream knows which
//! format it was. What is left out is a [`Warning`] with a count; what can't be used at all is a [`LoadError`]
//! that names the place in the file.
//!
//! What a file says moves (glTF's nodes, skins and morph targets) is at rest until [`Model::play`] shows another moment of it.
//!
//! Promises, for any bytes whatever: no panic, no endless loop, and no more memory than a small multiple of the
//! file (see `gltf/budget.rs` for the one format in which a file can repeat itself), with a fixed amount for pictures on
//! top (see `picture.rs`), and for terrain, which may be compressed to next to nothing (see `geotiff/samples.rs`).
//!
//! Conventions: metres; x east, y north, z up, whatever the file had (see [`UpAxis`]); positions are parsed in
//! `f64` and become `f32` about the scene's origin, which is 0 unless the model is far from it.
//!
//! ```
//! use umbrae_formats::{Format, LoadOptions, load_bytes};
//!
//! let obj = b"v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4\nl 1 2\n";
//! let model = load_bytes(obj, Format::Obj, "wall.obj", None, &LoadOptions::default())?;
//! assert_eq!(model.scene.triangle_count(), 2);
//! assert_eq!(model.warnings[0].to_string(), "1 line primitive was skipped (first: line 6)");
//! # Ok::<(), umbrae_formats::LoadError>(())
//! ```

mod animation;
mod cityjson;
mod crs;
mod error;
mod geojson;
mod georeference;
mod geotiff;
mod gltf;
mod json;
mod load;
mod look;
mod model;
mod obj;
mod picture;
mod place;
mod ply;
mod polygon;
mod sanity;
mod stl;
mod text;
mod warnings;

pub use animation::{Animation, AnimationError, Animations, Playing};
pub use crs::{Crs, CrsError};
pub use error::{LoadError, Place, Problem};
pub use load::{LoadOptions, load, load_bytes};
pub use model::{Format, Model, UpAxis};
pub use warnings::Warning;
