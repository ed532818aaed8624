//! Checks of output files before any work is done.
//!
//! Contract: what passes here can be written unless the disk changes or fills meanwhile. No file that
//! stands there is touched.

use crate::failure::Failure;
use parbake::{BakeOptions, Parallax, named_files, replaced_files};
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};

/// The name that means standard output, for JSON alone.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Refuses the name of standard output for a folder of files.
pub fn check_folder(path: &Path) -> Result<(), Failure> {
    match is_stdout(path) {
        false => Ok(()),
        true => Err(Failure::Usage("several files cannot go to standard output; give a folder".into())),
    }
}

/// Makes a folder for files, and those above it.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path).map_err(|error| {
        Failure::Output(format!(
            "{}: the folder cannot be made ({error}); choose another one",
            path.display()
        ))
    })
}

/// Refuses a model that cannot be written.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    check_extension(path, &["glb", "obj"], "the output")?;
    check_place(path)?;
    match replaced_files(path).iter().find(|beside| beside.is_dir()) {
        None => Ok(()),
        Some(folder) => Err(Failure::Usage(format!(
            "{}: the folder {} has the name of a file that is written with it; choose another name",
            path.display(),
            folder.display()
        ))),
    }
}

/// Refuses a film of moving UVs that is no GIF.
pub fn check_animation(path: &Path) -> Result<(), Failure> {
    check_extension(path, &["gif"], "the animation")?;
    check_place(path)
}

fn check_extension(path: &Path, allowed: &[&str], what: &str) -> Result<(), Failure> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if allowed.contains(&extension.as_str()) {
        return Ok(());
    }
    let allowed: Vec<String> = allowed.iter().map(|extension| format!(".{extension}")).collect();
    Err(Failure::Usage(format!("{}: {what} must end in {}", path.display(), allowed.join(" or "))))
}

/// Refuses maps that the output's format has no place for.
pub fn check_maps(output: &Path, options: &BakeOptions) -> Result<(), Failure> {
    if options.parallax == Parallax::None || !is_obj(output) {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{}: an OBJ cannot hold a parallax map; write a .glb, or leave --parallax out",
        output.display()
    )))
}

/// Whether the file is to be an OBJ.
pub fn is_obj(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"))
}

/// Refuses a file that has no folder to lie in, would take a folder's place, or lies in a folder that
/// cannot be written.
pub fn check_place(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::Usage(format!("{}: this is a folder; give it a file's name", path.display())));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        let (path, folder) = (path.display(), folder.display());
        return Err(Failure::Usage(format!("{path}: there is no folder {folder}; make it first")));
    }
    check_writable(path, folder.unwrap_or(Path::new(".")))
}

/// Files are written beside their place and renamed, so the folder must take a new file. Whether it does
/// depends on more than its permissions, so a file is made and removed again.
fn check_writable(path: &Path, folder: &Path) -> Result<(), Failure> {
    let probe = folder.join(format!(".parbake-{}", std::process::id()));
    match OpenOptions::new().write(true).create_new(true).open(&probe) {
        Ok(_) => {
            // It is empty and hidden: if it cannot be removed, nothing is lost.
            let _ = std::fs::remove_file(&probe);
            Ok(())
        }
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => Ok(()),
        Err(error) => Err(Failure::Output(format!(
            "{}: nothing can be written to this folder ({error}); choose another one",
            path.display()
        ))),
    }
}

/// Refuses to write over an input, or over a file that an input names: artists keep their only copy in such files.
pub fn check_not_input(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    let whole = |path: &Path| path.canonicalize().ok();
    let written = replaced_files(output);
    let hits = |read: &Path| {
        whole(read).is_some_and(|read| written.iter().any(|w| whole(w).as_ref() == Some(&read)))
    };
    let refuse = |what: String| {
        Err(Failure::Usage(format!("{}: this would overwrite {what}; choose another name", output.display())))
    };
    if let Some(input) = inputs.iter().find(|input| hits(input)) {
        return refuse(format!("the input {}", input.display()));
    }
    if written.iter().all(|path| is_named_by_no_model(path)) {
        return Ok(());
    }
    for input in inputs {
        // An input that cannot be read has an error of its own.
        let named = named_files(input).unwrap_or_default();
        if let Some(file) = named.iter().find(|file| hits(file)) {
            return refuse(format!("{}, which {} names", file.display(), input.display()));
        }
    }
    Ok(())
}

/// Whether a file is of a kind that is part of no other model, so that inputs need not be searched for its name.
fn is_named_by_no_model(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    ["glb", "obj", "json", "html", "htm"].contains(&extension.as_str())
}

/// Checks the JSON file of a command that writes nothing else.
pub fn check_json(json: Option<&PathBuf>, inputs: &[&Path]) -> Result<(), Failure> {
    check_beside(None, json, None, inputs)
}

/// Checks JSON and HTML files: their extensions, their places, and that no two outputs have one name.
pub fn check_beside(
    output: Option<&Path>,
    json: Option<&PathBuf>,
    report: Option<&PathBuf>,
    inputs: &[&Path],
) -> Result<(), Failure> {
    let json = json.filter(|path| !is_stdout(path));
    let mut taken: Vec<&Path> = output.into_iter().collect();
    let all = [(json, &["json"][..], "figures"), (report, &["html", "htm"][..], "the report")];
    for (path, extensions, what) in all {
        let Some(path) = path else { continue };
        if is_stdout(path) {
            return Err(Failure::Usage(format!(
                "{what} cannot go to standard output, as --json - can; give a file"
            )));
        }
        if taken.contains(&path.as_path()) {
            return Err(Failure::Usage(format!("{}: two outputs have this name", path.display())));
        }
        // That a file would be lost is said before anything else about its name.
        check_not_input(path, inputs)?;
        check_extension(path, extensions, what)?;
        check_place(path)?;
        taken.push(path);
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Protects the folder: the check leaves nothing there, and files of other kinds are named.
    #[test]
    fn checks_leave_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        assert!(check_output(&at("a.glb")).is_ok());
        assert!(check_beside(Some(&at("a.glb")), Some(&at("a.json")), Some(&at("a.html")), &[]).is_ok());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let wrong = |json: Option<&str>, report: Option<&str>| {
            check_beside(Some(&at("a.glb")), json.map(at).as_ref(), report.map(at).as_ref(), &[])
                .unwrap_err()
                .to_string()
        };
        assert!(wrong(Some("a.glb"), None).contains("two outputs"));
        assert!(wrong(Some("a.txt"), None).contains("must end in .json"));
        assert!(wrong(None, Some("a.pdf")).contains("must end in .html or .htm"));
    }
}
