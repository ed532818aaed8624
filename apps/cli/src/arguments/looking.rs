//! Arguments of the commands that show, measure and compare models.

use super::{IO, Reading, Talk};
use clap::Args;
use parbake::{EvaluateOptions, StatsOptions, parse_texels};
use parbake_report::TurntableOptions;
use parbake_reproduce::variants::VariantsOptions;
use std::path::PathBuf;

/// Arguments of `eval`.
#[derive(Args, Debug)]
pub struct EvalCommand {
    /// The high-poly: .obj, .gltf or .glb
    pub high: PathBuf,

    /// The model to compare with it: .obj, .gltf or .glb
    pub low: PathBuf,

    /// Write the figures as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// Write a page with pictures of the views that differ most, and all figures, to this .html file
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub report: Option<PathBuf>,

    /// Print the figures of each view
    #[arg(long, help_heading = IO)]
    pub per_view: bool,

    /// Number of threads, 0 to 256; 0 is one a core
    #[arg(long, value_name = "COUNT", default_value_t = 0, help_heading = "Comparison")]
    pub threads: usize,

    /// How to compare
    #[command(flatten, next_help_heading = "Comparison")]
    pub evaluate: EvaluateOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `variants`.
#[derive(Args, Debug)]
#[command(after_help = "Vertices and texture coordinates stay as they are, so that only the maps differ. \
Only coefficient maps can be written to files, by bake --parallax tangent or sh. \
For the brick wall: parbake demo --scene wall, then its demo_high.glb and demo_low.glb.")]
pub struct VariantsCommand {
    /// The high-poly: .obj, .gltf or .glb
    pub high: PathBuf,

    /// The low-poly, with UVs: .obj, .gltf or .glb
    pub low: PathBuf,

    /// Page with pictures to write: .html
    #[arg(short, long, value_name = "FILE", default_value = "variants.html", help_heading = IO)]
    pub output: PathBuf,

    /// Write the figures as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// How to fit
    #[command(flatten, next_help_heading = "Comparison")]
    pub variants: VariantsOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `view`.
#[derive(Args, Debug)]
#[command(
    after_help = "The page is served to this machine alone, under an address that is drawn anew each time and \
printed on standard output; it loads nothing from any network. Ctrl-C ends it. \
Levels of detail are several files, the finest first, or one GLB file with MSFT_lod."
)]
pub struct ViewCommand {
    /// The model: .glb, .gltf or .obj; several files are its levels of detail, the finest first
    #[arg(required = true)]
    pub models: Vec<PathBuf>,

    /// Compare it with this model, usually the high-poly
    #[arg(long, value_name = "FILE")]
    pub compare: Option<PathBuf>,

    /// Port to listen on, 0 to 65535; 0 is any that is free
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,

    /// Print the page's address without opening a browser
    #[arg(long)]
    pub no_open: bool,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `turntable`.
#[derive(Args, Debug)]
#[command(after_help = "All models are shown as they stand in the high-poly's frame, lit from the \
camera, or by the built-in light where the high-poly's materials have more than colour, normals and emission. The film plays again and again. Ctrl-C ends without a file.")]
pub struct TurntableCommand {
    /// The high-poly: .obj, .gltf or .glb
    pub high: PathBuf,

    /// The models to show beside it, in this order
    #[arg(required = true)]
    pub low: Vec<PathBuf>,

    /// File to write: .png or .apng for all colours, .gif for smaller files with 256
    #[arg(short, long, value_name = "FILE", default_value = "turntable.png", help_heading = IO)]
    pub output: PathBuf,

    /// How to film
    #[command(flatten, next_help_heading = "Film")]
    pub turntable: TurntableOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `check`.
#[derive(Args, Debug)]
#[command(
    after_help = "Triangles of each base colour picture are checked by themselves; different pictures \
may use the same coordinates. A layout is sound if every triangle has an area and its orientation, \
none lies on another one, and all lie within the picture; then the exit code is 0, else 3."
)]
pub struct CheckCommand {
    /// The model: .obj, .gltf or .glb
    pub model: PathBuf,

    /// Texture size in which lengths are measured, 1 to 65536 texels [default: the shorter side of each
    /// base colour texture, 512 where there is none]
    #[arg(long, value_name = "TEXELS", value_parser = parse_texels)]
    pub texture_size: Option<usize>,

    /// Least padding between charts in texels, 0 or more; 0 checks none
    #[arg(long, value_name = "TEXELS", default_value_t = 0.0)]
    pub gutter: f64,

    /// Write the figures as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// Number of threads, 0 to 256; 0 is one a core
    #[arg(long, value_name = "COUNT", default_value_t = 0)]
    pub threads: usize,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `stats`.
#[derive(Args, Debug)]
#[command(
    after_help = "Topology is that of the surface welded by position. Distances are measured from points on each surface to \
the other surface, both in the unit of the files and as a share of the first model's bounding box diagonal: Chamfer is the mean \
of both ways' mean distance, Hausdorff the greatest of both ways."
)]
pub struct StatsCommand {
    /// The model: .obj, .gltf or .glb
    pub model: PathBuf,

    /// Another model: its figures beside the first one's, and the distance between both
    #[arg(long, value_name = "OTHER")]
    pub against: Option<PathBuf>,

    /// Write the figures as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// How to measure
    #[command(flatten)]
    pub stats: StatsOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `thumbnail`.
#[derive(Args, Debug)]
pub struct ThumbnailCommand {
    /// The model
    pub model: PathBuf,

    /// The picture to write: .png
    pub picture: PathBuf,

    /// What to tell
    #[command(flatten)]
    pub talk: Talk,
}
