//! What is known about models that their files do not say.

use clap::Args;
use umbrae_formats::{Crs, CrsError, LoadOptions};

use super::Up;

/// How models are read; the same for every command that reads some.
#[derive(Debug, Clone, Default, Args)]
pub struct LoadArgs {
    /// The axis that is up in files that do not say (default: y in OBJ and PLY, z in STL)
    #[arg(long, value_name = "AXIS")]
    pub up: Option<Up>,

    /// The coordinate reference system of models that name none, such as EPSG:28992
    #[arg(long, value_name = "EPSG", value_parser = crs, help_heading = CITY)]
    pub crs: Option<Crs>,

    /// The level of detail to show of CityJSON models, such as 1.3 (default: the highest of each object)
    #[arg(long, value_name = "LOD", help_heading = CITY)]
    pub lod: Option<String>,

    /// The property of GeoJSON features that is their height above their base (default: the first of height, HAUTEUR, measuredHeight and
    /// others like them)
    #[arg(long, value_name = "NAME", help_heading = CITY)]
    pub height_field: Option<String>,

    /// The property of GeoJSON features that is the height of their base (default: the first of base, `min_height` and others like them, else 0)
    #[arg(long, value_name = "NAME", help_heading = CITY)]
    pub base_field: Option<String>,

    /// Read only every Nth sample of terrain, in rows and columns
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=10_000),
        allow_hyphen_values = true,
        help_heading = CITY
    )]
    pub terrain_step: Option<u32>,
}

/// Where these options stand in the help.
const CITY: &str = "City models";

fn crs(text: &str) -> Result<Crs, CrsError> {
    Crs::parse(text)
}

impl LoadArgs {
    /// The same for the loader of the first model; those that follow are read [`into`](LoadOptions::into) its system.
    pub fn options(&self) -> LoadOptions {
        LoadOptions {
            up: self.up.map(Into::into),
            crs: self.crs.clone(),
            into: None,
            lod: self.lod.clone(),
            height_field: self.height_field.clone(),
            base_field: self.base_field.clone(),
            terrain_step: self.terrain_step,
            normals: false,
        }
    }
}
