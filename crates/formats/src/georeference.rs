//! From a file's coordinates to metres with x east and y north.
//!
//! ```text
//!   the file's system        what the scene is in
//!   metres                   the same, number for number
//!   feet                     the same system in metres
//!   degrees, web maps        the UTM zone of the middle
//!   any                      that of the models before it, where there are some
//!   none                     whatever it is, in metres; beside others what those are in
//! ```

use glam::{DVec2, DVec3};

use crate::error::{Problem, quoted};
use crate::warnings::Warnings;
use crate::{Crs, CrsError, LoadOptions, Model};

/// How far from 1 the scale of a good map may be. UTM has 0.9996 to 1.001, national grids have less, maps of continents up
/// to a hundredth.
const MAX_SCALE_ERROR: f64 = 0.02;

/// What is done with a file's coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Georeference {
    /// What positions are in afterwards.
    pub(crate) crs: Option<Crs>,
    /// What they were in, if they are computed anew.
    pub(crate) source_crs: Option<Crs>,
    /// The file's units in metres: x and y, height.
    units_m: [f64; 2],
}

/// What a file says about its system.
#[derive(Debug, Clone, Default)]
pub(crate) enum Said {
    /// Nothing.
    #[default]
    Nothing,
    /// This.
    Crs(Crs),
    /// Something that we do not understand.
    Unknown(CrsError),
}

impl Said {
    /// What the text of a file says.
    pub(crate) fn by(text: Option<&str>) -> Self {
        match text.map(str::trim).filter(|text| !text.is_empty()) {
            None => Self::Nothing,
            Some(text) => Crs::parse(text).map_or_else(Self::Unknown, Self::Crs),
        }
    }

    /// What counts, of what the file and the user say.
    ///
    /// A file whose system we do not know is in what the user says, else its coordinates are taken as metres of
    /// nowhere; that it is nowhere is a warning.
    pub(crate) fn or_given(self, given: Option<&Crs>, warnings: &mut Warnings) -> Option<Crs> {
        match (self, given) {
            (Self::Crs(file), Some(given)) if !file.has_plane_of(given) => {
                let words = [
                    "file says what its coordinates are in, and not what the options say; it was believed",
                    "files say what their coordinates are in, and not what the options say; they were believed",
                ];
                warnings.add_one(words, || format!("{file}, not {given}"));
                Some(file)
            }
            (Self::Crs(file), _) => Some(file),
            (Self::Nothing, given) => given.cloned(),
            (Self::Unknown(error), given) => {
                let words = [
                    "coordinate reference system of a file is not understood",
                    "coordinate reference systems of files are not understood",
                ];
                warnings.add_one(words, || error.to_string());
                given.cloned()
            }
        }
    }
}

impl Georeference {
    /// For a file in `file`, of which `middle` is a place, in its own coordinates.
    pub(crate) fn new(
        file: Option<Crs>,
        middle: DVec2,
        options: &LoadOptions,
        warnings: &mut Warnings,
    ) -> Result<Self, Problem> {
        let Some(file) = file else {
            return Ok(Self { crs: options.into.clone(), source_crs: None, units_m: [1.0; 2] });
        };
        let units_m = [file.unit_m(), file.vertical_unit_m()];
        if units_m != [1.0; 2] {
            let words = [
                "system of coordinates has units other than metres; they became metres",
                "systems of coordinates have units other than metres; they became metres",
            ];
            warnings.add_one(words, || format!("{file}, 1 unit is {:.6} m, of height {:.6} m", units_m[0], units_m[1]));
        }
        let at = middle * units_m[0];
        let own = |file: Crs| Self { crs: Some(file), source_crs: None, units_m };
        if options.into.as_ref().is_some_and(|into| file.has_plane_of(into)) {
            return Ok(own(file));
        }
        let lon_lat = file.lon_lat_of(at).map_err(|error| Problem::whole(error.to_string()))?;
        let into = match &options.into {
            Some(into) => into.clone(),
            None if !file.is_geographic() => {
                let scale = file.scale(at).map_err(|error| Problem::whole(error.to_string()))?;
                if (scale - 1.0).abs() <= MAX_SCALE_ERROR {
                    return Ok(own(file));
                }
                let words = [
                    "map is not in metres of the ground and was computed anew",
                    "maps are not in metres of the ground and were computed anew",
                ];
                warnings.add_one(words, || format!("{file}, where a metre is shown as {scale:.3}"));
                utm(lon_lat)?
            }
            None => utm(lon_lat)?,
        };
        Ok(Self { crs: Some(into), source_crs: Some(file), units_m })
    }

    /// Where a point of the file is.
    pub(crate) fn point(&self, p: DVec3) -> Result<DVec3, CrsError> {
        let [unit_m, vertical_unit_m] = self.units_m;
        let (xy, z) = (p.truncate() * unit_m, p.z * vertical_unit_m);
        let xy = match (&self.source_crs, &self.crs) {
            (Some(source), Some(crs)) => source.position_in(crs, xy)?,
            _ => xy,
        };
        Ok(xy.extend(z))
    }

    /// The file's units in metres: of x and y, and of heights. Degrees count as metres.
    pub(crate) fn units_m(&self) -> [f64; 2] {
        self.units_m
    }
}

fn utm(lon_lat: DVec2) -> Result<Crs, Problem> {
    Crs::utm_of(lon_lat).map_err(|error| Problem::whole(error.to_string()))
}

/// Says of a model of a format that knows no systems what the user says, if it is metres as the model is.
pub(crate) fn place_mesh_file(model: &mut Model, options: &LoadOptions) -> Result<(), Problem> {
    let Some(crs) = &options.crs else { return Ok(()) };
    let cant = |reason: &str| Problem::whole(format!("its coordinates are metres and can't be in {crs}: {reason}"));
    if crs.is_geographic() {
        return Err(cant("those are degrees; name a projected system"));
    }
    if let Some(into) = options.into.as_ref().filter(|into| !into.has_plane_of(crs)) {
        let name = quoted(into.name());
        return Err(cant(&format!("the models before it are in EPSG:{} {name}; export it in that", into.epsg())));
    }
    model.crs = Some(crs.clone());
    Ok(())
}
