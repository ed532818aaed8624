//! What can be typed.

use crate::rules::{NOT_IN_COMPRESS, WITH_MORE_THAN_COLOUR};
use clap::{Args, Command as Clap, CommandFactory, Parser, Subcommand, ValueEnum};
use parbake::lod::layout::Layout;
use parbake::{
    BakeOptions, EvaluateOptions, ImageOptions, LodOptions, RaycastOptions, StatsOptions, WriteOptions,
    parse_texels,
};
use parbake_batch::BatchOptions;
use parbake_report::TurntableOptions;
use parbake_reproduce::ReproduceOptions;
use parbake_reproduce::variants::VariantsOptions;
use std::path::PathBuf;

/// Heading of files and messages in `--help`.
const IO: &str = "Input and output";

/// Heading of those options of `compress` that act on some models alone.
const MORE_THAN_COLOUR: &str = "Models with more than colour";

/// Options whose defaults in `compress` are not those of a bake.
const HELP_IN_COMPRESS: [(&str, &str); 7] = [
    (
        "time_budget",
        "Seconds after which the best texture so far is written, 0 to 1e9, reading of files included. \
Below 8 UVs are only repaired [default: no limit]",
    ),
    ("shading", "What of the materials is fitted; pbr is the whole metallic-roughness material"),
    ("uv", "UV mode: how the model's texture coordinates are treated"),
    ("method", "UV optimiser; textures are solved the same way"),
    (
        "gutter",
        "Padding between charts (UV islands) in texels, 0 to 64 [default: texture size / 256, at least 1, at most 8]",
    ),
    (
        "uv_steps",
        "Steps of the UV optimiser, 0 to 10000 [default: by preset 80, 240, 480; with --method paper 800]",
    ),
    (
        "robust_scale",
        "Scale of the robust (Cauchy) loss of the texture solve on models with a normal map, in display units, \
0.01 to 1000. Lower it if surfaces look mottled; 1000 is least squares [default: 1, with --method paper 1000]",
    ),
];

/// Options of files whose help speaks of parallax maps, for commands that write none.
const HELP_WITHOUT_PARALLAX: [(&str, &str); 2] = [
    ("texture_format", "Image format of the textures in a GLB file"),
    (
        "texture_quality",
        "Quality of JPEG, WebP and ETC1S, 1 to 100; in JPEG, normal maps and data maps have at least 95. UASTC files \
have about the same size at any quality; from 96 on it is encoded with more care",
    ),
];

/// Commands that write models without parallax maps.
const WITHOUT_PARALLAX: [&str; 3] = ["compress", "lod", "raycast"];

/// A command whose options have other help texts where `texts` has some.
fn with_help(command: Clap, texts: &'static [(&'static str, &'static str)]) -> Clap {
    command.mut_args(|argument| match texts.iter().find(|(own, _)| argument.get_id() == *own) {
        Some((_, help)) => argument.help(*help).long_help(*help),
        None => argument,
    })
}

/// The command with its subcommands. `compress` takes the options of a bake, so that options files serve
/// both, and shows those that act there; `rules` refuses the others.
pub fn command() -> Clap {
    let whole = WITHOUT_PARALLAX.into_iter().fold(Arguments::command(), |whole, name| {
        whole.mut_subcommand(name, |own| with_help(own, &HELP_WITHOUT_PARALLAX))
    });
    whole.mut_subcommand("compress", |compress| {
        with_help(compress, &HELP_IN_COMPRESS).mut_args(|argument| {
            let name = argument.get_id().to_string();
            if NOT_IN_COMPRESS.contains(&name.as_str()) {
                argument.hide(true)
            } else if name == "more_triangles" {
                argument.hide(false)
            } else if WITH_MORE_THAN_COLOUR.contains(&name.as_str()) {
                argument.help_heading(MORE_THAN_COLOUR)
            } else {
                argument
            }
        })
    })
}

/// Bakes a high-poly's appearance onto a low-poly by differentiable rendering
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
    /// Bake a high-poly's appearance onto a low-poly
    Bake(BakeCommand),
    /// Make levels of detail of a single model
    Lod(LodCommand),
    /// Bake by rays alone: materials, normals, occlusion, curvature, …
    Raycast(RaycastCommand),
    /// Shrink a model's texture
    Compress(CompressCommand),
    /// Make a plane that shows a picture with a smaller texture
    Image(ImageCommand),
    /// Make a high-poly and a low-poly, bake, and write a report
    Demo(DemoCommand),
    /// Compare two models view by view: PSNR, MS-SSIM, FLIP
    Eval(EvalCommand),
    /// Compare kinds of parallax maps on a pair of models
    Variants(VariantsCommand),
    /// Show a model in the browser, beside its high-poly if one is given
    View(ViewCommand),
    /// Film models side by side while they turn: an animated PNG or a GIF
    Turntable(TurntableCommand),
    /// Run the paper's experiments on a folder of data
    Reproduce(ReproduceCommand),
    /// Prove that UVs neither flip nor overlap, or say what is wrong
    Check(CheckCommand),
    /// Write a coarser copy of a model, which keeps its UVs
    Simplify(SimplifyCommand),
    /// Print a model's figures: topology, UVs, textures, draw calls; and its distance to another model
    Stats(StatsCommand),
    /// Run many jobs, from a file or on a folder of models, and go on where it was stopped
    Batch(BatchCommand),
    /// Take a small picture of a model, for the page of a batch
    #[command(hide = true)]
    Thumbnail(ThumbnailCommand),
}

/// What is told while running.
#[derive(Args, Debug, Clone, Copy)]
pub struct Talk {
    /// Print what each stage took
    #[arg(short, long)]
    pub verbose: bool,

    /// Print only errors and requested output
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
}

/// What models may make the command read.
#[derive(Args, Debug, Clone, Copy)]
pub struct Reading {
    /// Read no file outside a model's own folder, whatever it names: for models from strangers
    #[arg(long)]
    pub confine: bool,
}

/// Whether and where a running bake is shown.
#[derive(Args, Debug, Clone, Copy)]
pub struct Watch {
    /// Show the running bake in the browser: its look, its UVs, the time left and the error of each stage
    #[arg(long)]
    pub watch: bool,

    /// Port of that page, 0 to 65535; 0 is any that is free
    #[arg(long, value_name = "PORT", default_value_t = 0, requires = "watch")]
    pub port: u16,

    /// Print the page's address without opening a browser
    #[arg(long, requires = "watch")]
    pub no_open: bool,
}

/// Arguments of `bake`.
#[derive(Args, Debug)]
pub struct BakeCommand {
    /// The high-poly: .obj, .gltf or .glb
    pub high: PathBuf,

    /// The low-poly: .obj, .gltf or .glb; missing UVs are made. Left out with --triangles
    #[arg(required_unless_present = "triangles")]
    pub low: Option<PathBuf>,

    /// Make the low-poly, of at most so many triangles, 4 or more
    #[arg(short, long, value_name = "COUNT", conflicts_with = "low", value_parser = clap::value_parser!(u32).range(4..), help_heading = IO)]
    pub triangles: Option<u32>,

    /// File to write: .glb, or .obj with .mtl and .png beside it
    #[arg(short, long, value_name = "FILE", default_value = "baked.glb", help_heading = IO)]
    pub output: PathBuf,

    /// Options from a JSON file, or from a JSON report; the command line wins over it
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub options: Option<PathBuf>,

    /// Write the figures of the run as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// Write a report with pictures to this .html file
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub report: Option<PathBuf>,

    /// Fail if a texture or material that a model names is missing, instead of warning
    #[arg(long, help_heading = IO)]
    pub strict: bool,

    /// Where to watch
    #[command(flatten, next_help_heading = IO)]
    pub watch: Watch,

    /// How to bake
    #[command(flatten)]
    pub bake: BakeOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `lod`.
#[derive(Args, Debug)]
#[command(
    after_help = "Each level is written as soon as it is finished. Ctrl-C keeps those that are. lods.json says for each level \
how many triangles, texels and bytes it has, what it looks like at its size, and below which size on screen it cannot \
be told from the one before. With --target-psnr the exit code is 4 where a level cannot reach it; the closest is written."
)]
pub struct LodCommand {
    /// The model: .obj, .gltf or .glb
    pub model: PathBuf,

    /// Folder to write the levels, a file with all of them, and lods.json to
    #[arg(short, long, value_name = "FOLDER", default_value = "lods", help_heading = IO)]
    pub output: PathBuf,

    /// Engine whose names and helper files are written
    #[arg(long, value_enum, default_value_t = Layout::Files, help_heading = IO)]
    pub layout: Layout,

    /// Write a report in HTML: pictures and figures of all levels, and how they were found
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub report: Option<PathBuf>,

    /// How to make them
    #[command(flatten)]
    pub lod: LodOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `raycast`.
#[derive(Args, Debug)]
#[command(
    after_help = "The classical bake: rays from the low-poly to the high-poly, nothing is fitted. Base colour, normals and all \
other maps of the materials go into the output; maps of shape are files beside it (docs/raycast.md)."
)]
pub struct RaycastCommand {
    /// The high-poly: .obj, .gltf or .glb
    pub high: PathBuf,

    /// The low-poly: .obj, .gltf or .glb; missing UVs are made
    pub low: PathBuf,

    /// File to write: .glb, or .obj with .mtl and .png beside it
    #[arg(short, long, value_name = "FILE", default_value = "baked.glb", help_heading = IO)]
    pub output: PathBuf,

    /// Write the figures of the run as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// Fail if a texture or material that a model names is missing, instead of warning
    #[arg(long, help_heading = IO)]
    pub strict: bool,

    /// How to bake
    #[command(flatten)]
    pub raycast: RaycastOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `compress`.
#[derive(Args, Debug)]
#[command(
    after_help = "The surface stays. Options under \"Models with more than colour\" act on models whose materials have more than that \
(a normal map, metal, roughness, occlusion, emission, opacity): they are baked as a pair is."
)]
pub struct CompressCommand {
    /// The model with its texture: .obj, .gltf or .glb
    pub model: PathBuf,

    /// File to write: .glb, or .obj with .mtl and .png beside it
    #[arg(short, long, value_name = "FILE", default_value = "compressed.glb", help_heading = IO)]
    pub output: PathBuf,

    /// Options from a JSON file, or from a JSON report; the command line wins over it
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub options: Option<PathBuf>,

    /// Write the figures of the run as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// Write a report with pictures to this .html file
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub report: Option<PathBuf>,

    /// Fail if a texture or material that a model names is missing, instead of warning
    #[arg(long, help_heading = IO)]
    pub strict: bool,

    /// How to do it
    #[command(flatten)]
    pub bake: BakeOptions,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `image`.
#[derive(Args, Debug)]
pub struct ImageCommand {
    /// The picture: .png, .jpg or .webp
    pub picture: PathBuf,

    /// File to write: .glb, or .obj with .mtl and .png beside it
    #[arg(short, long, value_name = "FILE", default_value = "image.glb", help_heading = IO)]
    pub output: PathBuf,

    /// Write the figures of the run as JSON to this .json file, or to standard output for "-"
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub json: Option<PathBuf>,

    /// Write an animation of the moving UVs to this .gif file
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub animation: Option<PathBuf>,

    /// How to do it
    #[command(flatten)]
    pub options: ImageOptions,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}

/// Arguments of `demo`.
#[derive(Args, Debug)]
pub struct DemoCommand {
    /// Folder to write demo.glb, demo.html, demo.json and the two models to
    #[arg(short, long, value_name = "FOLDER", default_value = "out", help_heading = IO)]
    pub output: PathBuf,

    /// Also render high-poly, ray-cast bake, bake, and bake with parallax maps side by side into
    /// demo.webp in this folder
    #[arg(long, value_name = "FOLDER", help_heading = IO)]
    pub pictures: Option<PathBuf>,

    /// Models to make
    #[arg(long, value_enum, default_value_t = DemoScene::Jar)]
    pub scene: DemoScene,

    /// How to bake
    #[command(flatten)]
    pub bake: BakeOptions,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
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

/// Arguments of `reproduce`.
#[derive(Args, Debug)]
#[command(
    after_help = "The folder holds pairs/NAME/high with a textured model and pairs/NAME/low_simplygon, \
low_simplygon100, low_simplygon50 (or lod1, lod2, lod3) with coarse ones, images2d with pictures, and pbr/NAME with \
models of whole materials for Figure 14; folders of your own are run as well. Outcomes are kept in the output folder under the content of their files, options and the program: \
a run that was stopped goes on where it was. With --record the exit code is 4 where a gain fell by more than 0.2 dB."
)]
pub struct ReproduceCommand {
    /// The folder of data [default: what PARBAKE_DATA names]
    pub data: Option<PathBuf>,

    /// Folder for report.html, tables.md, gains.json and what is kept
    #[arg(short, long, value_name = "FOLDER", default_value = "reproduced", help_heading = IO)]
    pub output: PathBuf,

    /// Compare gains with those on record in this JSON file
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub record: Option<PathBuf>,

    /// Write the gains to the record instead of comparing them
    #[arg(long, requires = "record")]
    pub update_record: bool,

    /// What to run
    #[command(flatten, next_help_heading = "What to run")]
    pub options: ReproduceOptions,

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

/// Arguments of `simplify`.
#[derive(Args, Debug)]
pub struct SimplifyCommand {
    /// The model: .obj, .gltf or .glb
    pub model: PathBuf,

    /// File to write: .glb or .obj
    #[arg(short, long, value_name = "FILE", help_heading = IO)]
    pub output: PathBuf,

    /// Number of triangles to aim at, 4 or more
    #[arg(short, long, value_name = "COUNT", default_value_t = 500)]
    pub triangles: usize,

    /// Subdivide instead: split each triangle into four, 1 to 6 times
    #[arg(long, value_name = "TIMES", conflicts_with = "triangles")]
    pub subdivide: Option<u32>,

    /// What to read
    #[command(flatten, next_help_heading = IO)]
    pub reading: Reading,

    /// How the file is written
    #[command(flatten)]
    pub formats: WriteOptions,

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

/// Arguments of `batch`.
#[derive(Args, Debug)]
#[command(
    after_help = "A jobs file has [[job]] entries with command, inputs, and options or arguments; docs/batch.md describes it. For a \
folder, options of the command come after --: parbake batch models --command compress -- --preset fast. Each job is a process \
of its own with a folder of its own in the output folder. Run the same command again to go on after a stop; what is \
finished and has not changed is kept. The exit code is 1 if a job failed."
)]
pub struct BatchCommand {
    /// The jobs file (.toml), or a folder of models
    pub jobs: PathBuf,

    /// The command to run on each model of a folder: compress, simplify, stats, …
    #[arg(long, value_name = "COMMAND")]
    pub command: Option<String>,

    /// Options of that command, after --
    #[arg(last = true, value_name = "OPTIONS")]
    pub arguments: Vec<String>,

    /// Folder for results and batch.html [default: what the jobs file says, else batch]
    #[arg(short, long, value_name = "FOLDER", help_heading = IO)]
    pub output: Option<PathBuf>,

    /// Run nothing, but write a job template of Open Job Description for a render farm to this .json file
    #[arg(long, value_name = "FILE", help_heading = IO)]
    pub openjd: Option<PathBuf>,

    /// How to run
    #[command(flatten)]
    pub batch: BatchOptions,

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
