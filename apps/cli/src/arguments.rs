//! What can be typed: the command with its subcommands. Their arguments are in the files below.

mod looking;
mod making;
mod runs;

use crate::rules::{IDLE_IN_DEMO, WITH_MORE_THAN_COLOUR};
use clap::{Args, Command as Clap, CommandFactory, Parser, Subcommand};
pub use looking::{
    CheckCommand, EvalCommand, StatsCommand, ThumbnailCommand, TurntableCommand, VariantsCommand, ViewCommand,
};
pub use making::{
    BakeCommand, ClosestIn, CompressCommand, DemoCommand, DemoScene, ImageCommand, LodCommand,
    RaycastCommand, SimplifyCommand,
};
use parbake::IDLE_IN_COMPRESS;
pub use runs::{BatchCommand, ReproduceCommand};

/// Heading of files and messages in `--help`.
const IO: &str = "Input and output";

/// Heading of those options of `compress` that act on some models alone.
const MORE_THAN_COLOUR: &str = "Models with more than colour";

/// Options of a bake whose help is another one in `compress`.
const HELP_IN_COMPRESS: [(&str, &str); 7] = [
    (
        "time_budget",
        "Seconds after which the best texture so far is written, 0 to 1e9, reading of files included. \
Below 8 (34 at 2048², 135 at 4096²) UVs are only repaired [default: no limit]",
    ),
    (
        "shading",
        "What of the materials is fitted: auto fits whole materials where one has more than colour, normals and emission; \
lambert colours, normals and emission; pbr the whole metallic-roughness material",
    ),
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

/// The same for `simplify`, which leaves textures alone.
const HELP_OF_SIMPLIFY: [(&str, &str); 1] = [(
    "texture_format",
    "Image format of the textures in a GLB file. Without this option, JPEGs and 16-bit PNGs are copied unchanged",
)];

/// Commands that write models without parallax maps.
const WITHOUT_PARALLAX: [&str; 4] = ["compress", "lod", "raycast", "simplify"];

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
    let whole = whole.mut_subcommand("simplify", |own| with_help(own, &HELP_OF_SIMPLIFY));
    let whole = whole.mut_subcommands(|own| {
        own.mut_args(|argument| match argument.get_action().takes_values() {
            // The option's own check says more about a negative number than the parser could.
            true => argument.allow_negative_numbers(true),
            false => argument,
        })
    });
    let whole = whole.mut_subcommand("demo", |demo| {
        demo.mut_args(|argument| match IDLE_IN_DEMO.contains(&argument.get_id().as_str()) {
            true => argument.hide(true),
            false => argument,
        })
    });
    whole.mut_subcommand("compress", |compress| {
        with_help(compress, &HELP_IN_COMPRESS).mut_args(|argument| {
            let name = argument.get_id().to_string();
            if IDLE_IN_COMPRESS.contains(&name.as_str()) {
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
#[command(name = "parbake", bin_name = "parbake", version, propagate_version = true)]
#[command(after_help = "Exit codes: 0 done, 1 bad input or failed output, 2 wrong usage, \
3 check found problems, 4 reproduce found gains that fell or lod cannot reach its --target-psnr, 130 interrupted (the best state so far was written).")]
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
    /// Write a coarser copy of a model, which uses the model's own textures
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
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,

    /// Print the page's address without opening a browser
    #[arg(long)]
    pub no_open: bool,
}
