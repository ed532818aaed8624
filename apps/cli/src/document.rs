//! What the JSON outputs of `bake`, `raycast`, `compress`, `image`, `demo`, `eval`, `stats` and `check` have in common: which
//! command it was, of which files, and how long it took; the command's own figures follow as fields beside these.
//!
//! Contract: `docs/report.schema.json` describes them, and a test holds them to it. [`VERSION`] grows when a
//! field is renamed, goes, or changes its meaning; new fields leave it.

use crate::failure::Failure;
use crate::printed::write_json;
use crate::progress::Console;
use parbake::{BakeReport, UsedValues};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The schema's name, as its `$id` has it.
const SCHEMA: &str = "parbake/report.schema.json";
/// Of the JSON outputs.
const VERSION: u32 = 3;

/// A command's JSON output.
#[derive(Serialize)]
pub struct Document<'a, T> {
    schema: &'static str,
    version: u32,
    command: &'static str,
    /// What was read, by its name on the command line.
    inputs: BTreeMap<&'static str, String>,
    /// What was written; none where the figures are all that comes of it.
    output: Option<String>,
    /// From the command's start to the writing of this.
    total_seconds: f64,
    #[serde(flatten)]
    report: &'a T,
}

/// A bake's figures, with the values that it made of its options.
#[derive(Serialize)]
struct Figures<'a> {
    #[serde(flatten)]
    report: &'a BakeReport,
    used: UsedValues,
}

/// Writes a bake's figures as JSON, as [`write_document`] does.
pub fn write_report_document(
    path: &Path,
    about: (&'static str, &[(&'static str, &Path)], Option<&Path>),
    report: &BakeReport,
    console: &Console,
) -> Result<(), Failure> {
    write_document(path, about, &Figures { report, used: report.used() }, console)
}

/// Writes a command's figures as JSON, to standard output for "-".
pub fn write_document(
    path: &Path,
    (command, inputs, output): (&'static str, &[(&'static str, &Path)], Option<&Path>),
    report: &impl Serialize,
    console: &Console,
) -> Result<(), Failure> {
    let shown = |path: &Path| path.display().to_string();
    let document = Document {
        schema: SCHEMA,
        version: VERSION,
        command,
        inputs: inputs.iter().map(|(name, path)| (*name, shown(path))).collect(),
        output: output.map(shown),
        total_seconds: console.seconds(),
        report,
    };
    write_json(path, &document)
}
