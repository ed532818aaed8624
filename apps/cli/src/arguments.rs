//! What can be typed.

use clap::{Args, Parser, Subcommand, ValueEnum};
use parbake::{BakeOptions, EvaluateOptions, ImageOptions};
use parbake_report::TurntableOptions;
use parbake_reproduce::ReproduceOptions;
use parbake_reproduce::variants::VariantsOptions;
use std::path::PathBuf;

/// Makes a small 3D model look like a big one
#[derive(Parser, Debug)]
#[command(name = "parbake", version, propagate_version = true)]
#[command(after_help = "Exit codes: 0 done, 1 bad input or failed output, 2 wrong usage, \
3 check found problems, 4 reproduce found gains that fell, 130 interrupted (the best state so far was written).")]
pub struct Arguments {
    /// What to do
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Bake a detailed model's look onto a coarse one
    Bake(BakeCommand),
    /// Give a model a smaller texture that looks the same
    Compress(CompressCommand),
    /// Make a plane that shows a picture with a smaller texture
    Image(ImageCommand),
    /// Make a detailed model and a coarse one, bake, and write a report
    Demo(DemoCommand),
    /// Compare two models picture by picture: PSNR, MS-SSIM, FLIP
    Eval(EvalCommand),
    /// Fit each kind of parallax map to a pair of models and show them side by side
    Variants(VariantsCommand),
    /// Film a detailed model and coarse ones beside it while they turn: an animated PNG or a GIF
    Turntable(TurntableCommand),
    /// Run the paper's experiments on a folder of data and draw its tables and figures
    Reproduce(ReproduceCommand),
    /// Prove that a model's texture coordinates are sound, or say what is wrong with them
    Check(CheckCommand),
    /// Write a coarser copy of a model, which keeps its texture coordinates
    Simplify(SimplifyCommand),
}

/// What is told while running.
#[derive(Args, Debug, Clone, Copy)]
pub struct Talk {
    /// Tell what each stage took
    #[arg(short, long)]
    pub verbose: bool,

    /// Tell nothing but errors and what was asked for
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
}

/// Arguments of `bake`.
#[derive(Args, Debug)]
pub struct BakeCommand {
    /// The detailed model: .obj, .gltf or .glb
    pub high: PathBuf,

    /// The coarse model: .obj, .gltf or .glb; texture coordinates that it lacks are made
    pub low: PathBuf,

    /// Where the result goes: .glb, or .obj with .mtl and .png beside it
    #[arg(short, long, value_name = "FILE", default_value = "baked.glb")]
    pub output: PathBuf,

    /// A JSON file of options, or a JSON report whose options are taken; the command line wins
    /// over it
    #[arg(long, value_name = "FILE")]
    pub options: Option<PathBuf>,

    /// Write figures of the run as JSON to this file, or to standard output for "-"
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,

    /// How to bake
    #[command(flatten, next_help_heading = "Baking")]
    pub bake: BakeOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// Arguments of `compress`.
#[derive(Args, Debug)]
#[command(
    after_help = "The surface stays: options of vertices, parallax maps and cutouts have no effect, and those \
                        of views have one on models with a normal map alone."
)]
pub struct CompressCommand {
    /// The model with its texture: .obj, .gltf or .glb
    pub model: PathBuf,

    /// Where the result goes: .glb, or .obj with .mtl and .png beside it
    #[arg(short, long, value_name = "FILE", default_value = "compressed.glb")]
    pub output: PathBuf,

    /// A JSON file of options, or a JSON report whose options are taken; the command line wins
    /// over it
    #[arg(long, value_name = "FILE")]
    pub options: Option<PathBuf>,

    /// Write figures of the run as JSON to this file, or to standard output for "-"
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,

    /// How to do it
    #[command(flatten, next_help_heading = "Baking")]
    pub bake: BakeOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// Arguments of `image`.
#[derive(Args, Debug)]
pub struct ImageCommand {
    /// The picture: .png, .jpg or .webp
    pub picture: PathBuf,

    /// Where the plane goes: .glb, or .obj with .mtl and .png beside it
    #[arg(short, long, value_name = "FILE", default_value = "image.glb")]
    pub output: PathBuf,

    /// Write figures of the run as JSON to this file, or to standard output for "-"
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Write how the texture coordinates moved as a GIF
    #[arg(long, value_name = "FILE")]
    pub animation: Option<PathBuf>,

    /// How to do it
    #[command(flatten, next_help_heading = "Texture")]
    pub options: ImageOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// Arguments of `demo`.
#[derive(Args, Debug)]
pub struct DemoCommand {
    /// Folder for demo.glb, demo.html, demo.json and the two models
    #[arg(short, long, value_name = "FOLDER", default_value = "out")]
    pub output: PathBuf,

    /// Which models to make
    #[arg(long, value_enum, default_value_t = DemoScene::Jar)]
    pub scene: DemoScene,

    /// How to bake
    #[command(flatten, next_help_heading = "Baking")]
    pub bake: BakeOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// The built-in pairs.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum DemoScene {
    /// An ornate jar
    Jar,
    /// A cube of brick walls, and the plain cube
    Wall,
}

/// Arguments of `variants`.
#[derive(Args, Debug)]
#[command(after_help = "Vertices and texture coordinates stay as they are, so that only the maps differ. \
Only maps of spherical harmonics can be written to files, by bake --parallax sh. \
For the brick wall: parbake demo --scene wall, then its demo_high.glb and demo_low.glb.")]
pub struct VariantsCommand {
    /// The detailed model
    pub high: PathBuf,

    /// The coarse model with texture coordinates
    pub low: PathBuf,

    /// Where the page with pictures goes
    #[arg(short, long, value_name = "FILE", default_value = "variants.html")]
    pub output: PathBuf,

    /// Write the figures as JSON to this file, or to standard output for "-"
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// How to fit
    #[command(flatten, next_help_heading = "Comparison")]
    pub variants: VariantsOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// Arguments of `eval`.
#[derive(Args, Debug)]
pub struct EvalCommand {
    /// The detailed model
    pub high: PathBuf,

    /// The model to compare with it
    pub low: PathBuf,

    /// Write the figures as JSON to this file, or to standard output for "-"
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Show each view's figures
    #[arg(long)]
    pub per_view: bool,

    /// Threads to work with, 0 to 256, 0 for one a core
    #[arg(long, value_name = "COUNT", default_value_t = 0)]
    pub threads: usize,

    /// How to compare
    #[command(flatten, next_help_heading = "Comparison")]
    pub evaluate: EvaluateOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// Arguments of `turntable`.
#[derive(Args, Debug)]
#[command(after_help = "All models are shown as they stand in the high-poly's frame, by a light at the \
camera. The film plays again and again. Ctrl-C ends without a file.")]
pub struct TurntableCommand {
    /// The detailed model
    pub high: PathBuf,

    /// The models to show beside it, in this order
    #[arg(required = true)]
    pub low: Vec<PathBuf>,

    /// Where the film goes: .png or .apng for all colours, .gif for smaller files with 256
    #[arg(short, long, value_name = "FILE", default_value = "turntable.png")]
    pub output: PathBuf,

    /// How to film
    #[command(flatten, next_help_heading = "Film")]
    pub turntable: TurntableOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// Arguments of `reproduce`.
#[derive(Args, Debug)]
#[command(
    after_help = "The folder holds pairs/NAME/high with a textured model and pairs/NAME/low_simplygon, \
low_simplygon100, low_simplygon50 (or lod1, lod2, lod3) with coarse ones, and images2d with pictures; folders of your \
own are run as well. Outcomes are kept in the output folder under the content of their files, options and the program: \
a run that was stopped goes on where it was. With --record the exit code is 4 where a gain fell by more than 0.2 dB."
)]
pub struct ReproduceCommand {
    /// The folder of data [default: what PARBAKE_DATA names]
    pub data: Option<PathBuf>,

    /// Folder for report.html, tables.md, gains.json and what is kept
    #[arg(short, long, value_name = "FOLDER", default_value = "reproduced")]
    pub output: PathBuf,

    /// Compare gains with those on record in this JSON file
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,

    /// Write the gains to the record instead of comparing them
    #[arg(long, requires = "record")]
    pub update_record: bool,

    /// What to run
    #[command(flatten, next_help_heading = "What to run")]
    pub options: ReproduceOptions,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
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

    /// Texels along a side for lengths, 1 to 65536; by default those of the shorter side of each
    /// base colour picture, or as of a bake where there is none
    #[arg(long, value_name = "TEXELS")]
    pub texture_size: Option<usize>,

    /// The smallest gutter between two charts that will do, 0 or more; 0 to ask for none
    #[arg(long, value_name = "TEXELS", default_value_t = 0.0)]
    pub gutter: f64,

    /// Write the figures as JSON to this file, or to standard output for "-"
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Threads to work with, 0 to 256, 0 for one a core
    #[arg(long, value_name = "COUNT", default_value_t = 0)]
    pub threads: usize,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}

/// Arguments of `simplify`.
#[derive(Args, Debug)]
pub struct SimplifyCommand {
    /// The model: .obj, .gltf or .glb
    pub model: PathBuf,

    /// Where the copy goes: .glb or .obj
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Triangles to aim at, 4 or more
    #[arg(short, long, value_name = "COUNT", default_value_t = 500)]
    pub triangles: usize,

    /// Instead make it finer: split each triangle into four, so many times, 1 to 6
    #[arg(long, value_name = "TIMES", conflicts_with = "triangles")]
    pub subdivide: Option<u32>,

    /// What to tell
    #[command(flatten, next_help_heading = "Messages")]
    pub talk: Talk,
}
