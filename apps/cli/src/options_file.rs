//! An options file, overruled by what was typed.
//!
//! It is a JSON object of options, or a JSON report whose `options` are taken. Names are those of the
//! command line with `_` for `-`.
//!
//! Contract: whatever is wrong with the file becomes one sentence with the file, line, column and what was
//! expected there.

use crate::failure::Failure;
use crate::rules::is_typed;
use clap::{ArgMatches, Args};
use parbake::BakeOptions;
use serde_json::{Map, Value};
use std::path::Path;

/// What a file may hold.
const EXAMPLE: &str = r#"expected a JSON object of options such as {"texture_size": 1024, "preset": "fast"}"#;

/// The typed options, with the file's in the place of those that were not typed.
pub fn merged(typed: &BakeOptions, given: &ArgMatches, file: Option<&Path>) -> Result<BakeOptions, Failure> {
    let Some(path) = file else { return Ok(typed.clone()) };
    let wrong = |reason: String| Failure::Usage(format!("{}: {reason}", path.display()));
    if path.as_os_str() == "-" {
        return Err(Failure::Usage(
            "--options: reading from standard input is not supported; give a file".into(),
        ));
    }
    let bytes = std::fs::read(path).map_err(|e| wrong(format!("cannot be read: {e}")))?;
    let text = String::from_utf8(bytes).map_err(|_| wrong(format!("this is not a text file; {EXAMPLE}")))?;
    let mut all = options_in(&text).map_err(wrong)?;
    for (name, value) in as_map(typed) {
        // Field names are clap's argument names: both come from the struct.
        if is_typed(given, &name) {
            all.insert(name, value);
        }
    }
    serde_json::from_value(Value::Object(all)).map_err(|e| wrong(e.to_string()))
}

fn as_map(options: &BakeOptions) -> Map<String, Value> {
    match serde_json::to_value(options) {
        Ok(Value::Object(map)) => map,
        _ => Map::new(),
    }
}

/// All options as the file has them, the rest by default; else a sentence.
fn options_in(text: &str) -> Result<Map<String, Value>, String> {
    if text.trim().is_empty() {
        return Err(format!("the file is empty; {EXAMPLE}"));
    }
    let mut json: Value = serde_json::from_str(text)
        .map_err(|e| format!("line {}, column {}: this is not JSON; {EXAMPLE}", e.line(), e.column()))?;
    if let Some(options) = json.get_mut("options") {
        json = options.take();
    }
    let Value::Object(map) = json else {
        return Err(format!("line 1, column 1: this is JSON, but no object; {EXAMPLE}"));
    };
    let default = as_map(&BakeOptions::default());
    let mut all = default.clone();
    for (name, value) in map {
        let at = position(text, &name);
        let Some(own) = default.get(&name) else {
            return Err(format!(
                "{at}: there is no option {name:?}; names are those of bake --help with _ for -"
            ));
        };
        let mut alone = Map::new();
        alone.insert(name.clone(), value.clone());
        if serde_json::from_value::<BakeOptions>(Value::Object(alone)).is_err() {
            return Err(format!("{at}: {name:?} cannot be {value}; expected {}", expected(&name, own)));
        }
        all.insert(name, value);
    }
    // What was read may be written otherwise, as 1 for 1.0.
    let options: BakeOptions = serde_json::from_value(Value::Object(all)).map_err(|e| e.to_string())?;
    Ok(as_map(&options))
}

/// Where a name stands in the text, counted from 1; the last place wins, as it does in JSON.
fn position(text: &str, name: &str) -> String {
    let before = text.rfind(&format!("{name:?}")).and_then(|at| text.get(..at)).unwrap_or("");
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    format!("line {}, column {column}", before.matches('\n').count() + 1)
}

/// Options that count texels along a side.
const TEXELS: [&str; 4] = ["texture_size", "parallax_size", "cutout_size", "fallback_size"];

/// What an option may be, by its default.
fn expected(name: &str, default: &Value) -> String {
    match default {
        Value::Bool(_) => "true or false".into(),
        Value::Number(number) if number.is_f64() => "a number".into(),
        Value::Number(_) if TEXELS.contains(&name) => {
            r#"a whole number of texels, or a text such as "1k""#.into()
        }
        Value::Number(_) => "a whole number that is not negative".into(),
        Value::Null => "a number, whole where it counts something, or null for the default".into(),
        _ => {
            let command = BakeOptions::augment_args(clap::Command::new(""));
            let argument = command.get_arguments().find(|argument| argument.get_id() == name);
            let values = argument.map(clap::Arg::get_possible_values).unwrap_or_default();
            let names: Vec<String> = values
                .iter()
                .filter(|value| !value.is_hide_set())
                .map(|value| format!("\"{}\"", value.get_name()))
                .collect();
            format!("one of {}", names.join(", "))
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::options_in;

    /// Protects whoever writes options by hand: each mistake has its place and what was expected.
    #[test]
    fn mistakes_have_a_place() {
        for (text, words) in [
            ("texture_size = 4", "line 1, column 2: this is not JSON"),
            (" \n", "the file is empty; expected a JSON object"),
            ("[1]", "no object"),
            ("{\n  \"texture_sise\": 64}", "line 2, column 3: there is no option \"texture_sise\""),
            ("{\"preset\": \"quick\"}", "expected one of \"fast\", \"balanced\", \"best\""),
            ("{\"texture_size\": \"big\"}", "expected a whole number of texels"),
            ("{\"parallax_order\": \"1k\"}", "expected a whole number that is not negative"),
            ("{\"keep_normals\": 1}", "expected true or false"),
            (
                "{\"texture_format\": \"bmp\"}",
                "expected one of \"png\", \"jpeg\", \"webp\", \"webp-lossless\"",
            ),
            ("{\"gutter\": []}", "line 1, column 2"),
        ] {
            let said = options_in(text).unwrap_err();
            assert!(said.contains(words), "{text}: {said}");
        }
        let options = options_in(r#"{"work": "bake", "options": {"gutter": 2}}"#).unwrap();
        assert_eq!(options["gutter"], 2.0);
        assert_eq!(options_in(r#"{"texture_size": "1k"}"#).unwrap()["texture_size"], 1024);
    }
}
