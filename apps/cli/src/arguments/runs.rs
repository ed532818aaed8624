//! Arguments of the commands that run many bakes.

use super::{IO, Talk};
use clap::Args;
use parbake_batch::BatchOptions;
use parbake_reproduce::ReproduceOptions;
use std::path::PathBuf;

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
    #[arg(long)]
    pub update_record: bool,

    /// What to run
    #[command(flatten, next_help_heading = "What to run")]
    pub options: ReproduceOptions,

    /// What to tell
    #[command(flatten, next_help_heading = IO)]
    pub talk: Talk,
}
