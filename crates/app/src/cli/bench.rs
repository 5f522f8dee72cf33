//! What can be measured.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{LoadArgs, MomentArgs};
use crate::parse::{crease_deg, metres, picture_size};

/// What to measure.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// How long each way of finding silhouettes takes
    Silhouettes(SilhouettesArgs),
    /// What smooth silhouettes cost in a frame
    Smooth(SmoothArgs),
}

/// What smooth silhouettes cost in a frame
///
/// Frames of a model on the ground under a sun that goes on by 0.7 degrees each time, with the silhouettes of its triangles (discrete), those of its normals on the mesh
/// (accurate) and those of the smooth surface (smooth), in turns: by the clock, until the GPU has finished, medians. Each frame is drawn twice: once with silhouettes
/// found for its sun, and once more with these kept. Ratios are medians over pairs of frames under the same sun.
#[derive(Debug, Args)]
pub struct SmoothArgs {
    /// Models, each measured alone: .glb .gltf .obj .ply .ply.gz .stl
    #[arg(required = true, value_name = "MODEL")]
    pub models: Vec<PathBuf>,

    /// Print JSON: one object, or with several models an array of them; each `{"model", "adapter", "triangles", "size_px", "epsilon_m", "prepare_ms", "kinds":
    /// [{"name", "frame_ms", "kept_ms", "cpu_ms", "pieces", "frame_ratio", "kept_ratio"}]}`
    #[arg(long)]
    pub json: bool,

    /// How many frames of each kind
    #[arg(
        long,
        value_name = "COUNT",
        default_value = "15",
        value_parser = clap::value_parser!(u32).range(1..=10_000),
        allow_hyphen_values = true
    )]
    pub frames: u32,

    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1024x768", value_parser = picture_size)]
    pub size: [u32; 2],

    /// How far a smooth silhouette may be from its curve, in metres
    #[arg(long, value_name = "M", default_value = "0.01", value_parser = metres, allow_hyphen_values = true)]
    pub epsilon: f64,

    /// Edges that bend by more than this stay sharp, in degrees
    #[arg(long, value_name = "DEG", default_value = "40", value_parser = crease_deg, allow_hyphen_values = true)]
    pub crease: f64,

    /// When models are shown.
    #[command(flatten)]
    pub moment: MomentArgs,

    /// How models are read.
    #[command(flatten)]
    pub load: LoadArgs,
}

/// How long each way of finding silhouettes takes
///
/// All ways find the silhouettes of the same models (all objects of a file together) under the same lights: suns and lamps far away, lamps near by,
/// inside, and in the planes of faces. On the CPU, `plain` is a loop over the edges, `scan` the same with facing bits, `dual` and
/// `cones` are trees, and `coherent` looks at what has changed since the last light; all on one thread, in turns, each light five times. On the GPU, `gpu`
/// has compute shaders and `gpu-basic` what WebGL2 has; they find all lights at once, and are left out where there is no adapter for them.
///
/// Times are microseconds for each light, by the clock of the processor or the GPU. What `coherent` takes depends on how far lights are apart: in the table it has
/// two rows, one for the same lights as the others, and one for the sun of a midsummer day at 48 degrees north, minute by minute.
#[derive(Debug, Args)]
pub struct SilhouettesArgs {
    /// Models, each measured alone: .glb .gltf .obj .ply .ply.gz .stl .city.json .city.jsonl .geojson .tif
    #[arg(required = true, value_name = "MODEL")]
    pub models: Vec<PathBuf>,

    /// How many lights; the same ones on every run
    #[arg(
        long,
        value_name = "COUNT",
        default_value = "64",
        value_parser = clap::value_parser!(u32).range(1..=MAX_LIGHTS),
        allow_hyphen_values = true
    )]
    pub lights: u32,

    /// Print JSON: one object, or with several models an array of them; each `{"model", "triangles", "edges", "finders": [{"name", "build_ms", "bytes",
    /// "median_us", "p95_us", "edges_tested", "edges_found", "equal"}]}`. Edges are means over the lights, and `equal` is whether every light's
    /// silhouette is the scan's (of a GPU: but for triangles that rounding may take for edge-on). Times and edges tested of `coherent` are those of the
    /// sun's minutes
    #[arg(long)]
    pub json: bool,

    /// Keep in this folder what the finders on the CPU have prepared; where it is there already, build ms is what reading it takes
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,

    /// Instead, make one model finer and finer, from ten thousand to a million triangles, and draw how the times of the finders on the CPU grow (SVG)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["json", "cache"])]
    pub grow: Option<PathBuf>,

    /// How models are read.
    #[command(flatten)]
    pub load: LoadArgs,
}

/// Of each light, what five ways find is compared.
const MAX_LIGHTS: i64 = 100_000;
