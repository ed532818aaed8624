//! What was typed wrong, in one sentence each that says what to do next.
//!
//! Contract: clap's words stand where nothing better is known, which is also how it prints help and version.

use clap::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::error::Error as _;
use std::num::{IntErrorKind, ParseFloatError, ParseIntError};

/// Prints what is wrong, and ends.
pub fn end(error: &Error) -> ! {
    match sentence(error) {
        Some(sentence) => {
            eprintln!("error: {sentence}");
            std::process::exit(2)
        }
        None => error.exit(),
    }
}

/// What is wrong, if there is a sentence for it.
pub fn sentence(error: &Error) -> Option<String> {
    match error.kind() {
        ErrorKind::MissingRequiredArgument => missing(error),
        ErrorKind::ArgumentConflict => conflict(error),
        ErrorKind::UnknownArgument => unknown(error),
        ErrorKind::InvalidSubcommand => {
            let name = text(error, ContextKind::InvalidSubcommand)?;
            let meant = strings(error, ContextKind::SuggestedSubcommand);
            Some(format!(
                "there is no command {name}; {}",
                meant_or(&meant, "parbake --help lists the commands")
            ))
        }
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => value(error),
        ErrorKind::TooManyValues => {
            let name = as_written(&text(error, ContextKind::InvalidArg)?);
            Some(format!("{name} takes no value; give it alone"))
        }
        _ => None,
    }
}

fn missing(error: &Error) -> Option<String> {
    let names: Vec<String> =
        strings(error, ContextKind::InvalidArg).iter().map(|name| as_written(name)).collect();
    let command = command_of(error)?;
    Some(match (command.as_str(), &names[..]) {
        ("bake", [only]) if only == "LOW" => {
            "there is no low-poly to bake onto: give LOW, or --triangles COUNT, which makes one of HIGH".into()
        }
        ("bake", [first, second]) if first == "HIGH" && second == "LOW" => {
            "bake needs HIGH, the detailed model, and LOW, the coarse one, or --triangles COUNT instead of LOW".into()
        }
        _ => format!("{command} needs {}; parbake {command} --help says more", listed(&names, "and")),
    })
}

fn conflict(error: &Error) -> Option<String> {
    let own = as_written(&text(error, ContextKind::InvalidArg)?);
    let others = strings(error, ContextKind::PriorArg);
    match &others.iter().map(|other| as_written(other)).collect::<Vec<_>>()[..] {
        [] => None,
        [other] if *other == own => Some(format!("{} is given twice; leave one out", name_of(&own))),
        others => {
            let all: Vec<String> = others.iter().chain([&own]).cloned().collect();
            Some(format!("{} do not go together; give one of them", listed(&all, "and")))
        }
    }
}

/// The option that is there twice, or that does not go with one that is.
pub fn conflicting(error: &Error) -> Option<String> {
    let is_conflict = error.kind() == ErrorKind::ArgumentConflict;
    let argument = text(error, ContextKind::InvalidArg).filter(|_| is_conflict)?;
    Some(name_of(&as_written(&argument)).to_string())
}

fn unknown(error: &Error) -> Option<String> {
    let (typed, command) = (text(error, ContextKind::InvalidArg)?, command_of(error));
    let help =
        command.as_ref().map_or("parbake --help".into(), |command| format!("parbake {command} --help"));
    if !typed.starts_with('-') {
        let of = command.map_or(String::new(), |command| format!(" for {command}"));
        return Some(format!("{typed} is one argument too many{of}; see {help}"));
    }
    let meant = strings(error, ContextKind::SuggestedArg);
    Some(match command.as_deref() {
        Some("batch") if meant.is_empty() => {
            format!("batch has no option {typed}; options of the command that it runs come after --")
        }
        Some(command) => {
            let help = format!("{help} lists them all");
            format!("{command} has no option {typed}; {}", meant_or(&meant, &help))
        }
        None => match command_with(&typed) {
            Some(command) => {
                format!(
                    "{typed} is an option of a command and comes after it, as in parbake {command} {typed}"
                )
            }
            None => {
                format!(
                    "there is no option {typed}; {}",
                    meant_or(&meant, "parbake --help lists the commands")
                )
            }
        },
    })
}

/// The first command with this option.
fn command_with(typed: &str) -> Option<String> {
    let name = typed.trim_start_matches('-');
    let is_meant = |argument: &clap::Arg| match typed.starts_with("--") {
        true => argument.get_long() == Some(name),
        false => argument.get_short().is_some_and(|short| name.starts_with(short)),
    };
    let whole = crate::arguments::command();
    let mut commands = whole.get_subcommands();
    commands.find(|own| own.get_arguments().any(is_meant)).map(|own| own.get_name().to_string())
}

fn value(error: &Error) -> Option<String> {
    let argument = as_written(&text(error, ContextKind::InvalidArg)?);
    let name = name_of(&argument);
    let typed = text(error, ContextKind::InvalidValue)?;
    let possible = strings(error, ContextKind::ValidValue);
    Some(match (typed.is_empty(), &possible[..]) {
        (true, []) => format!("{argument} needs a value"),
        (true, possible) => format!("{name} needs a value: {}", listed(possible, "or")),
        (false, []) => match wanted(error, &typed)? {
            // Some say themselves what they are of.
            said if said.starts_with(&format!("{typed:?} ")) => format!("{name}: {said}"),
            said => format!("{name} cannot be {typed}: {said}"),
        },
        (false, possible) => format!("{name} cannot be {typed}: it may be {}", listed(possible, "or")),
    })
}

/// What a value may be. Of what is no number the standard library says how its parser failed; people are told what to type.
fn wanted(error: &Error, typed: &str) -> Option<String> {
    let source = error.source()?;
    if source.is::<ParseFloatError>() {
        return Some("give a number, such as 0.5".into());
    }
    if let Some(error) = source.downcast_ref::<ParseIntError>() {
        let is_large = *error.kind() == IntErrorKind::PosOverflow;
        let is_negative = typed.starts_with('-');
        return Some(match (is_large, is_negative) {
            (true, _) => "give a smaller number".into(),
            (_, true) => "give 0 or more".into(),
            _ => "give a whole number, such as 8".into(),
        });
    }
    let said = source.to_string();
    let Some((_, range)) = said.split_once(" is not in ") else { return Some(said) };
    let (least, most) = range.split_once("..")?;
    let is_below = typed.starts_with('-') || typed.parse::<u64>().ok() < least.parse().ok();
    Some(match most.trim_start_matches('=') {
        // Some ranges end only where the parser's type does.
        most if is_below && (most.is_empty() || most == u32::MAX.to_string()) => {
            format!("it may be {least} or more")
        }
        most => format!("it may be {least} to {most}"),
    })
}

/// The subcommand that the error is of.
fn command_of(error: &Error) -> Option<String> {
    let usage = text(error, ContextKind::Usage)?;
    let command = usage.split_whitespace().nth(2)?;
    command.starts_with(|c: char| c.is_ascii_lowercase()).then(|| command.to_string())
}

/// An argument as people write it: `--output FILE`, `LOW`.
fn as_written(argument: &str) -> String {
    argument.chars().filter(|c| !"<>[]".contains(*c)).collect::<String>().trim_end_matches("...").to_string()
}

/// An option as people write it without its value: `--output`.
fn name_of(written: &str) -> &str {
    written.split(' ').next().unwrap_or_default()
}

/// What was perhaps meant, or else this.
fn meant_or(meant: &[String], otherwise: &str) -> String {
    match meant {
        [] => otherwise.into(),
        meant => format!("did you mean {}?", listed(meant, "or")),
    }
}

/// `a`, `a and b`, `a, b and c`.
fn listed(names: &[String], conjunction: &str) -> String {
    match names {
        [first @ .., before, last] => {
            let begin: String = first.iter().map(|name| format!("{name}, ")).collect();
            format!("{begin}{before} {conjunction} {last}")
        }
        names => names.concat(),
    }
}

fn text(error: &Error, kind: ContextKind) -> Option<String> {
    match error.get(kind)? {
        ContextValue::String(text) => Some(text.clone()),
        ContextValue::StyledStr(text) => Some(text.to_string()),
        _ => None,
    }
}

fn strings(error: &Error, kind: ContextKind) -> Vec<String> {
    match error.get(kind) {
        Some(ContextValue::Strings(all)) => all.clone(),
        Some(ContextValue::String(one)) => vec![one.clone()],
        _ => Vec::new(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Protects first tries: each names the culprit as it is typed, and what to do.
    #[test]
    fn mistakes_are_sentences() {
        for (typed, wanted) in [
            (
                "bake",
                "bake needs HIGH, the detailed model, and LOW, the coarse one, or --triangles COUNT instead of LOW",
            ),
            (
                "bake a.glb",
                "there is no low-poly to bake onto: give LOW, or --triangles COUNT, which makes one of HIGH",
            ),
            ("bake a.glb b.glb -t 100", "--triangles COUNT and LOW do not go together; give one of them"),
            ("bake a.glb b.glb --sead 3", "bake has no option --sead; did you mean --seed?"),
            ("bake a.glb b.glb --parallax foo", "--parallax cannot be foo: it may be none, tangent or sh"),
            ("bake a.glb b.glb --parallax", "--parallax needs a value: none, tangent or sh"),
            ("bake a.glb b.glb --views", "--views COUNT needs a value"),
            ("bake a.glb b.glb --views -3", "--views cannot be -3: give 0 or more"),
            ("bake a.glb b.glb --views x", "--views cannot be x: give a whole number, such as 8"),
            ("bake a.glb -t 2", "--triangles cannot be 2: it may be 4 or more"),
            ("bake a.glb b.glb --texture-quality 101", "--texture-quality cannot be 101: it may be 1 to 100"),
            ("bake a.glb b.glb --seed 1 --seed 2", "--seed is given twice; leave one out"),
            ("bake a.glb b.glb c.glb", "c.glb is one argument too many for bake; see parbake bake --help"),
            ("bakee", "there is no command bakee; did you mean bake?"),
            ("unheard-of", "there is no command unheard-of; parbake --help lists the commands"),
            (
                "--texture-size 512 bake a b",
                "--texture-size is an option of a command and comes after it, as in parbake bake --texture-size",
            ),
            ("--xyzzy", "there is no option --xyzzy; parbake --help lists the commands"),
            ("bake a.glb b.glb --xyzzy", "bake has no option --xyzzy; parbake bake --help lists them all"),
            (
                "batch models --command compress --preset fast",
                "batch has no option --preset; options of the command that it runs come after --",
            ),
            ("bake a.glb b.glb --strict=1", "--strict takes no value; give it alone"),
            ("bake a.glb b.glb --seed=", "--seed NUMBER needs a value"),
            (
                "bake a.glb b.glb --seed 99999999999999999999",
                "--seed cannot be 99999999999999999999: give a smaller number",
            ),
            ("bake a.glb -t 5000000000", "--triangles cannot be 5000000000: it may be 4 to 4294967295"),
            ("simplify a.glb -o b.glb --subdivide 9", "--subdivide cannot be 9: it may be 1 to 6"),
            ("lod", "lod needs MODEL; parbake lod --help says more"),
            ("lod a.glb --screen-size a", "--screen-size cannot be a: give a number, such as 0.5"),
            ("simplify a.glb", "simplify needs --output FILE; parbake simplify --help says more"),
            ("demo foo", "foo is one argument too many for demo; see parbake demo --help"),
            ("eval", "eval needs HIGH and LOW; parbake eval --help says more"),
        ] {
            let arguments = std::iter::once("parbake").chain(typed.split(' '));
            let error = crate::arguments::command().try_get_matches_from(arguments).unwrap_err();
            assert_eq!(sentence(&error).as_deref(), Some(wanted), "{typed}");
        }
    }

    /// Protects help from being taken for a mistake.
    #[test]
    fn help_is_no_mistake() {
        for typed in ["--help", "--version", "bake --help", "help bake"] {
            let arguments = std::iter::once("parbake").chain(typed.split(' '));
            let error = crate::arguments::command().try_get_matches_from(arguments).unwrap_err();
            assert_eq!(sentence(&error), None, "{typed}");
        }
    }
}
