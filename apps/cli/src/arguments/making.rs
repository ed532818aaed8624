//! Arguments of the commands that write models.

use super::{IO, Reading, Talk, Watch};
use clap::{Args, ValueEnum};
use parbake::lod::layout::Layout;
use parbake::{BakeOptions, ImageOptions, LodOptions, RaycastOptions, WriteOptions};
use std::path::PathBuf;

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

    /// Do not compare the result with a ray-cast bake at the end, which saves seconds; `comparison` in JSON is then null
    #[arg(long, conflicts_with = "report", help_heading = IO)]
    pub no_comparison: bool,

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

    /// Do not compare the result with the original at the end, which saves seconds; `comparison` in JSON is then null
    #[arg(long, conflicts_with = "report", help_heading = IO)]
    pub no_comparison: bool,

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
    /// The picture: .png, .jpg, .webp, .ktx2, .tga, .bmp or .gif
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

/// What a coarser copy is chosen by.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClosestIn {
    /// Pictures with the model's own textures: for use as it is, and for most bakes
    Pictures,
    /// The surface alone: quicker, but textures may stretch or shift. To bake onto, where UVs have many seams
    Shape,
}

/// Arguments of `simplify`.
#[derive(Args, Debug)]
pub struct SimplifyCommand {
    /// The model: .obj, .gltf or .glb
    pub model: PathBuf,

    /// File to write: .glb or .obj
    #[arg(short, long, value_name = "FILE", help_heading = IO)]
    pub output: PathBuf,

    /// Number of triangles, 4 or more: at most so many; about so many with --closest-in shape, or where seams are in
    /// the way
    #[arg(short, long, value_name = "COUNT", default_value_t = 500)]
    pub triangles: usize,

    /// Subdivide instead: split each triangle into four, 1 to 6 times
    #[arg(long, value_name = "TIMES", value_parser = clap::value_parser!(u32).range(1..=6), conflicts_with_all = ["triangles", "closest_in"])]
    pub subdivide: Option<u32>,

    /// Whether pictures of the copy or its shape come closest to the model
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = ClosestIn::Pictures)]
    pub closest_in: ClosestIn,

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
