//! Text and JSON that commands hand out: on standard output, or JSON as a file.

use crate::failure::Failure;
use crate::outputs::is_stdout;
use parbake::write_file;
use std::io::Write;
use std::path::Path;

/// Writes any report as JSON, to standard output for "-".
pub fn write_json(path: &Path, report: &impl serde::Serialize) -> Result<(), Failure> {
    let json =
        serde_json::to_string_pretty(report).map_err(|e| Failure::Output(format!("no JSON report: {e}")))?;
    if is_stdout(path) {
        return print(&json);
    }
    Ok(write_file(path, json.as_bytes())?)
}

/// Prints to standard output; a reader that has seen enough is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    match writeln!(std::io::stdout().lock(), "{text}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Output(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}
