//! An options file, overruled by what was typed.

use crate::failure::Failure;
use clap::ArgMatches;
use clap::parser::ValueSource;
use parbake::BakeOptions;
use serde_json::Value;
use std::path::Path;

/// The typed options, with the file's in the place of those that were not typed.
pub fn merged(typed: &BakeOptions, given: &ArgMatches, file: Option<&Path>) -> Result<BakeOptions, Failure> {
    let Some(path) = file else { return Ok(typed.clone()) };
    let wrong = |reason: String| Failure::Usage(format!("{}: {reason}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
    let mut json: Value = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
    if let Some(options) = json.get_mut("options") {
        json = options.take();
    }
    if !json.is_object() {
        return Err(wrong("options are an object, {\"texture_size\": 1024, …}".into()));
    }
    let from_file: BakeOptions = serde_json::from_value(json).map_err(|e| wrong(e.to_string()))?;
    let as_map = |options: &BakeOptions| match serde_json::to_value(options) {
        Ok(Value::Object(map)) => map,
        _ => serde_json::Map::new(),
    };
    let mut all = as_map(&from_file);
    for (name, value) in as_map(typed) {
        // Field names are clap's argument names: both come from the struct.
        if given.value_source(&name) == Some(ValueSource::CommandLine) {
            all.insert(name, value);
        }
    }
    serde_json::from_value(Value::Object(all)).map_err(|e| wrong(e.to_string()))
}
