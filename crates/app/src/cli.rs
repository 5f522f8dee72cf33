//! What can be asked for. Parsing does nothing but parse.

use std::io;
use std::path::PathBuf;

use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum};
use glam::DVec3;

use crate::parse::{azimuth_altitude_deg, picture_size, xyz};
use crate::sample::Sample;

/// Exact shadows of real models
///
/// Reads glTF, OBJ, PLY and STL. Data goes to standard output, talk to standard error. Exit code 0: all well; 1: --verify found wrong pixels; 2: the
/// input can't be used, and nothing was written.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 110)]
pub struct Cli {
    /// What to do
    #[command(subcommand)]
    pub command: Command,

    /// Say nothing but errors
    #[arg(long, short, global = true)]
    pub quiet: bool,

    /// Colour what is said on standard error
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub color: ColorWhen,
}

/// When to use colour; every message makes sense without.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColorWhen {
    /// On a terminal, unless NO_COLOR is set
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw models with exact shadows
    Render(RenderArgs),
    /// Tell what a model is made of and how it will cast; needs no graphics driver
    Inspect(InspectArgs),
    /// Write one of the built-in scenes
    Sample(SampleArgs),
    /// List the graphics adapters of this machine and say what is missing
    Doctor,
    /// Print completions for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// Which axis of a file points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Up {
    /// The file's y is up
    Y,
    /// The file's z is up
    Z,
}

/// How volumes are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// z-pass where it is safe, z-fail where it is needed: always right
    Auto,
    /// z-pass for all: fast, and wrong where the eye is in shadow
    Zpass,
    /// z-fail for all: always right
    Zfail,
}

/// Draw models with exact shadows
///
/// Without options: a three-quarter view that frames the model, an afternoon sun (or the model's own lights), and a ground plane just
/// under it. Coordinates are the model's own, in metres, with x east, y north, z up.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Models to draw together: .glb .gltf .obj .ply .ply.gz .stl
    #[arg(required = true, value_name = "MODEL")]
    pub models: Vec<PathBuf>,

    /// Picture to write (PNG)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,

    /// Pixels across and down
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = picture_size)]
    pub size: [u32; 2],

    /// Samples a pixel; shadow edges are smooth with 4
    #[arg(long, default_value = "4", value_parser = ["1", "4"])]
    pub samples: String,

    /// Where the eye is
    #[arg(long, value_name = "X,Y,Z", value_parser = xyz, allow_hyphen_values = true)]
    pub eye: Option<DVec3>,

    /// What it looks at (default: the model's middle)
    #[arg(long, value_name = "X,Y,Z", value_parser = xyz, allow_hyphen_values = true)]
    pub target: Option<DVec3>,

    /// Vertical field of view in degrees (default: 35)
    #[arg(long, value_name = "DEGREES", conflicts_with = "camera")]
    pub fov: Option<f64>,

    /// A camera of the model, by name
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "target"])]
    pub camera: Option<String>,

    /// The sun: degrees clockwise from north, and degrees above the horizon
    #[arg(long, value_name = "AZIMUTH_DEG,ALTITUDE_DEG", value_parser = azimuth_altitude_deg, allow_hyphen_values = true)]
    pub sun: Option<[f64; 2]>,

    /// A lamp at this point; may be given several times
    #[arg(long, value_name = "X,Y,Z", value_parser = xyz, allow_hyphen_values = true)]
    pub point: Vec<DVec3>,

    /// How shadow volumes are counted
    #[arg(long, default_value = "auto")]
    pub method: Method,

    /// Draw no ground plane
    #[arg(long)]
    pub no_ground: bool,

    /// Also write the first light's verdicts: 8-bit grey PNG, 255 lit, 0 in shadow or facing away, 128 no surface
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,

    /// Also write what was drawn and how long it took (JSON; - for standard output)
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Check every pixel and light against rays cast in double precision; exit with 1 if any is wrong
    #[arg(long)]
    pub verify: bool,

    /// The axis that is up in files that do not say (default: y in OBJ and PLY, z in STL)
    #[arg(long, value_name = "AXIS")]
    pub up: Option<Up>,

    /// Use the graphics adapter whose line in `umbrae doctor` contains NAME
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,

    /// Use a software adapter
    #[arg(long)]
    pub software: bool,
}

/// Tell what a model is made of and how it will cast; needs no graphics driver
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// Model: .glb .gltf .obj .ply .ply.gz .stl
    pub model: PathBuf,

    /// Print JSON
    #[arg(long)]
    pub json: bool,

    /// The axis that is up in files that do not say
    #[arg(long, value_name = "AXIS")]
    pub up: Option<Up>,
}

/// Write one of the built-in scenes
#[derive(Debug, Args)]
pub struct SampleArgs {
    /// Which scene
    pub name: Sample,

    /// File to write (GLB)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
}

impl From<Up> for umbrae_formats::UpAxis {
    fn from(up: Up) -> Self {
        match up {
            Up::Y => Self::Y,
            Up::Z => Self::Z,
        }
    }
}

impl From<Method> for umbrae_render::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Auto => Self::Auto,
            Method::Zpass => Self::ZPass,
            Method::Zfail => Self::ZFail,
        }
    }
}

/// Prints completions for `shell` to standard output.
///
/// # Errors
///
/// When standard output can't be written.
pub fn write_completions(shell: clap_complete::Shell) -> anyhow::Result<()> {
    clap_complete::generate(shell, &mut Cli::command(), "umbrae", &mut io::stdout());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
