//! What can be asked for. Parsing does nothing but parse.

mod bench;
mod light;
mod load;
mod moment;
mod shadow;
mod study;
mod sun;
mod when;

use std::ffi::OsString;
use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use anstream::AutoStream;
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum};
use glam::DVec3;

use crate::output::write_to_stdout;
use crate::parse::{fov_deg, metres, picture_size, sphere, xyz};
use crate::sample::Sample;
use crate::show::Mode;

pub use self::bench::{BenchCommand, SilhouettesArgs, SmoothArgs};
pub use self::light::LightArgs;
pub use self::load::LoadArgs;
pub use self::moment::MomentArgs;
pub use self::shadow::{LightMark, Method, ShadowArgs, Silhouette, SmoothKind};
pub use self::study::{On, StudyArgs};
pub use self::sun::SunArgs;
pub use self::when::{DateRange, PeriodArgs, PlaceArgs};

/// Exact shadows of real models
///
/// Reads glTF, OBJ, PLY, STL, and cities as CityJSON, GeoJSON and GeoTIFF. Data goes to standard output, talk to standard error.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 110, after_long_help = AFTER_HELP)]
pub struct Cli {
    /// What to do
    #[command(subcommand)]
    pub command: Command,

    /// Say nothing but errors
    #[arg(long, short, global = true, help_heading = TALK)]
    pub quiet: bool,

    /// Colour what is said on standard error
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", help_heading = TALK)]
    pub color: ColorWhen,
}

/// Options of every command stand together and last.
const TALK: &str = "What is said";

const AFTER_HELP: &str = "\
Try this:
  umbrae sample town -o town.glb
  umbrae render town.glb -o town.png --sun 200,25 --verify
  umbrae inspect town.glb
  umbrae study town.glb --lat 48.2 --lon 16.37 --date 2026-09-18 -o town-sun

Exit codes:
  0  all went well
  1  --verify found wrong pixels, or --check wrong verdicts
  2  the input or the machine can't be used, and nothing was written
  130  stopped by Ctrl-C; what was finished is written";

/// When to use colour; every message makes sense without.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColorWhen {
    /// On a terminal, unless `NO_COLOR` is set
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
    Render(Box<RenderArgs>),
    /// Tell what a model is made of and how it will cast; needs no graphics driver
    Inspect(InspectArgs),
    /// Find where the sun reaches over a period: hours, shadow profiles, verdicts; needs no graphics driver
    Study(Box<StudyArgs>),
    /// Write one of the built-in scenes
    Sample(SampleArgs),
    /// Tell where the sun is on a day, and draw its path; needs no model
    Sun(SunArgs),
    /// Measure on models of one's own how fast the parts of this program are
    Bench {
        /// What to measure
        #[command(subcommand)]
        what: BenchCommand,
    },
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

/// Where vertices are moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Posing {
    /// In double precision, and uploaded
    Cpu,
    /// By compute shaders
    Gpu,
}

impl Posing {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }
}

/// Draw models with exact shadows
///
/// Without options: a three-quarter view that frames the model, an afternoon sun (or the model's own lights), and a ground plane just
/// under it. Coordinates are the model's own, in metres, with x east, y north, z up.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Models to draw together: .glb .gltf .obj .ply .ply.gz .stl .city.json .city.jsonl .geojson .tif
    #[arg(required = true, value_name = "MODEL")]
    pub models: Vec<PathBuf>,

    /// How models are read.
    #[command(flatten)]
    pub load: LoadArgs,

    /// When they are shown.
    #[command(flatten)]
    pub moment: MomentArgs,

    /// Picture to write (PNG; default: the first model's name with .png, in the current folder)
    #[arg(long, short, value_name = "FILE", help_heading = "Files to write")]
    pub output: Option<PathBuf>,

    /// Also write the first light's verdicts: 8-bit grey PNG, 255 lit, 0 in shadow or facing away, 128 no surface
    #[arg(long, value_name = "FILE", help_heading = "Files to write")]
    pub mask: Option<PathBuf>,

    /// Also write what was drawn and how long it took (JSON; - for standard output)
    #[arg(long, value_name = "FILE", help_heading = "Files to write")]
    pub json: Option<PathBuf>,

    /// Check every pixel and light against rays cast in double precision; if any is wrong, exit with 1 and show where in a picture beside
    /// the output, named `…-errors.png`
    #[arg(long, help_heading = "Files to write")]
    pub verify: bool,

    /// Pixels across and down
    #[arg(
        long,
        value_name = "WIDTHxHEIGHT",
        default_value = "1280x720",
        value_parser = picture_size,
        allow_hyphen_values = true,
        help_heading = "View"
    )]
    pub size: [u32; 2],

    /// Samples a pixel; shadow edges are smooth with 4
    #[arg(long, value_name = "COUNT", default_value = "4", value_parser = sample_count(), help_heading = "View")]
    pub samples: u32,

    /// Where the eye is (default: to the south-east and above, as near as shows the whole model)
    #[arg(long, value_name = "X,Y,Z", value_parser = xyz, allow_hyphen_values = true, help_heading = "View")]
    pub eye: Option<DVec3>,

    /// What it looks at (default: the model's middle)
    #[arg(long, value_name = "X,Y,Z", value_parser = xyz, allow_hyphen_values = true, help_heading = "View")]
    pub target: Option<DVec3>,

    /// Vertical field of view, 1 to 170 (default: 35)
    #[arg(
        long,
        value_name = "DEGREES",
        value_parser = fov_deg,
        allow_hyphen_values = true,
        conflicts_with = "camera",
        help_heading = "View"
    )]
    pub fov: Option<f64>,

    /// A camera of the model, by the name that `umbrae inspect` shows
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "target"], help_heading = "View")]
    pub camera: Option<String>,

    /// Add a ball that is round at any distance, given by its centre and radius in the model's coordinates; may be repeated
    #[arg(
        long = "sphere",
        value_name = "X,Y,Z:RADIUS",
        value_parser = sphere,
        allow_hyphen_values = true,
        help_heading = "View"
    )]
    pub spheres: Vec<(DVec3, f64)>,

    /// Show how the shadows were determined, with a legend
    #[arg(long, value_name = "WHAT", help_heading = "View")]
    pub show: Option<Mode>,

    /// The light about which --show is, by the name that the report gives (default: the first; of volumes and silhouettes, the first four)
    #[arg(long, value_name = "NAME", requires = "show", help_heading = "View")]
    pub show_light: Option<String>,

    /// Draw no ground plane
    #[arg(long, help_heading = "View")]
    pub no_ground: bool,

    /// The lamps, in the order of the command line.
    #[command(flatten)]
    pub light: LightArgs,

    /// Draw lights that have a size with soft shadows; --sun-disc, --light-radius and --light-size ask for that too
    #[arg(long, help_heading = "Light")]
    pub soft: bool,

    /// Give the sun its size, 0.533 degrees across, with soft shadows
    #[arg(long, help_heading = "Light")]
    pub sun_disc: bool,

    /// Give every lamp a size: draw it as COUNT lamps that share its strength, for soft shadows; takes COUNT times as long
    #[arg(
        long,
        value_name = "COUNT",
        value_parser = area_sample_count(),
        allow_hyphen_values = true,
        conflicts_with_all = ["light_radius", "light_size"],
        help_heading = "Light"
    )]
    pub area_samples: Option<u32>,

    /// Metres from a lamp's middle to its edge: a ball, or for a --spot a disc (default: a fiftieth of the model's radius, or of the lamp's
    /// range where that is less)
    #[arg(
        long,
        value_name = "METRES",
        value_parser = metres,
        allow_hyphen_values = true,
        requires = "area_samples",
        help_heading = "Light"
    )]
    pub area_radius: Option<f64>,

    /// How shadows are determined.
    #[command(flatten)]
    pub shadows: ShadowArgs,

    /// Where the vertices of animated models are moved; makes no difference that is seen (default: gpu where that can and something moves)
    #[arg(long, value_name = "WHERE", help_heading = "Machine")]
    pub posing: Option<Posing>,

    /// Keep in this folder what silhouettes are found with, for as long as models stay as they are: preparing takes long where they are large
    #[arg(long, value_name = "DIR", help_heading = "Machine")]
    pub cache: Option<PathBuf>,

    /// Use the graphics adapter whose line in `umbrae doctor` contains NAME
    #[arg(long, value_name = "NAME", help_heading = "Machine")]
    pub adapter: Option<String>,

    /// Use a software adapter even where there is hardware
    #[arg(long, help_heading = "Machine")]
    pub software: bool,
}

fn sample_count() -> impl clap::builder::TypedValueParser<Value = u32> {
    PossibleValuesParser::new(["1", "4"]).try_map(|count| count.parse::<u32>())
}

fn area_sample_count() -> impl clap::builder::TypedValueParser<Value = u32> {
    clap::value_parser!(u32).range(1..=MAX_AREA_SAMPLES)
}

/// Each is a lamp of its own, and a lamp takes hundredths of a second at the least.
const MAX_AREA_SAMPLES: i64 = 4096;

/// Tell what a model is made of and how it will cast; needs no graphics driver
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// Model: .glb .gltf .obj .ply .ply.gz .stl .city.json .city.jsonl .geojson .tif
    pub model: PathBuf,

    /// Print JSON, warnings included
    #[arg(long)]
    pub json: bool,

    /// How models are read.
    #[command(flatten)]
    pub load: LoadArgs,
}

/// Write one of the built-in scenes
#[derive(Debug, Args)]
pub struct SampleArgs {
    /// Which scene
    pub name: Sample,

    /// File to write (GLB)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,

    /// The town under 20 street lamps instead of the sun
    #[arg(long)]
    pub night: bool,
}

impl RenderArgs {
    /// Where the picture goes.
    pub fn picture_path(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let model = self.models.first().and_then(|model| model.file_name()).unwrap_or_default();
            PathBuf::from(model).with_extension("png")
        })
    }
}

impl From<Up> for umbrae_formats::UpAxis {
    fn from(up: Up) -> Self {
        match up {
            Up::Y => Self::Y,
            Up::Z => Self::Z,
        }
    }
}

/// Prints completions for `shell` to standard output.
///
/// # Errors
///
/// When standard output can't be written.
pub fn write_completions(shell: clap_complete::Shell) -> anyhow::Result<()> {
    // Not to standard output at once: the generator panics where that is full.
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "umbrae", &mut text);
    write_to_stdout(&text)
}

/// Says why there is no [`Cli`]: what was asked for is help or the version, or can't be understood. Returns the exit code.
pub fn explain(said: &clap::Error) -> ExitCode {
    // `--color` is not known from a command line that failed, so it is looked for.
    let color = requested_color(std::env::args_os()).into();
    let text = said.render().ansi().to_string();
    // If nobody listens there is nobody left to tell.
    let _ = if said.use_stderr() {
        AutoStream::new(io::stderr(), color).write_all(text.as_bytes())
    } else {
        AutoStream::new(io::stdout(), color).write_all(text.as_bytes())
    };
    u8::try_from(said.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from)
}

/// The last good value of `--color`.
fn requested_color(args: impl Iterator<Item = OsString>) -> ColorWhen {
    let args: Vec<String> = args.map(|arg| arg.to_string_lossy().into_owned()).collect();
    let value = |(i, arg): (usize, &String)| match arg.strip_prefix("--color")? {
        "" => args.get(i + 1).cloned(),
        rest => rest.strip_prefix('=').map(str::to_owned),
    };
    let parse = |value: String| ColorWhen::from_str(&value, false).ok();
    args.iter().enumerate().filter_map(value).filter_map(parse).next_back().unwrap_or(ColorWhen::Auto)
}

impl From<ColorWhen> for anstream::ColorChoice {
    fn from(when: ColorWhen) -> Self {
        match when {
            ColorWhen::Auto => Self::Auto,
            ColorWhen::Always => Self::Always,
            ColorWhen::Never => Self::Never,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_wish_for_colour_is_found_in_a_command_line_that_is_wrong() {
        let of = |line: &str| requested_color(line.split(' ').map(OsString::from));
        assert_eq!(of("umbrae --color never bogus"), ColorWhen::Never);
        assert_eq!(of("umbrae bogus --color=always"), ColorWhen::Always);
        for line in ["umbrae bogus", "umbrae --color", "umbrae --color pink", "umbrae --colors=never"] {
            assert_eq!(of(line), ColorWhen::Auto, "{line}");
        }
    }

    #[test]
    fn the_help_tells_the_defaults_as_they_are() {
        let mut command = Cli::command();
        command.build();
        let help = command.find_subcommand_mut("render").expect("it is a command").render_long_help().to_string();
        let [azimuth, altitude] = crate::lights::DEFAULT_SUN_DEG;
        assert!(help.contains(&format!("default: {azimuth},{altitude} if")), "{help}");
        assert!(help.contains(&format!("default: {})", crate::view::DEFAULT_FOV_DEG)), "{help}");
    }
}
