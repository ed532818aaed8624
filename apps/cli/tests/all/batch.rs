//! `parbake batch` as scripts and people meet it: processes that fail, are killed and go on.

use crate::common::{demo_pair, json, parbake, text};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A jobs file of four quick jobs over two models in this folder, and one that fails.
fn jobs(folder: &Path, with_failure: bool) {
    demo_pair(folder);
    // With all of its triangles, so that there is time to interrupt a job.
    parbake::write_glb(&folder.join("demo_high.glb"), &parbake::demo_pair().0).unwrap();
    fs::write(folder.join("broken.glb"), "glTF and no more").unwrap();
    let broken = "[[job]]\nname = 'broken'\ninputs = ['broken.glb']\n";
    let file = format!(
        "[defaults]\ncommand = 'simplify'\noptions = {{ triangles = 400, closest-in = 'shape' }}\n\
         [[job]]\ninputs = ['demo_high.glb']\n\
         [[job]]\nname = 'finer'\ninputs = ['demo_high.glb']\noptions = {{ triangles = 900 }}\n\
         {}[[job]]\nname = 'measured'\ncommand = 'stats'\ninputs = ['demo_low.glb']\noptions = {{ triangles = false, closest-in = false }}\n\
         [[job]]\nname = 'coarse'\ninputs = ['demo_high.glb']\narguments = ['--mesh-compression', 'meshopt']\n",
        if with_failure { broken } else { "" }
    );
    fs::write(folder.join("jobs.toml"), file).unwrap();
}

fn batch(folder: &Path, arguments: &[&str]) -> Output {
    let output = parbake(folder).arg("batch").args(arguments).output().unwrap();
    assert!(!text(&output.stderr).contains("panicked"), "{}", text(&output.stderr));
    output
}

/// Models and pictures of all jobs, whose bytes do not depend on the clock.
fn results(output: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in fs::read_dir(output).unwrap().flatten().filter(|entry| entry.path().is_dir()) {
        let name = folder.file_name().to_string_lossy().into_owned();
        for file in fs::read_dir(folder.path()).unwrap().flatten().filter(|_| !name.starts_with('.')) {
            let file_name = file.file_name().to_string_lossy().into_owned();
            if file_name.ends_with(".glb") || file_name.ends_with(".png") {
                found.insert(format!("{name}/{file_name}"), fs::read(file.path()).unwrap());
            }
        }
    }
    found
}

/// Protects the promise of the command: a failure is named and ends nothing, what is finished is not made again, a
/// changed input is, and the page has all of it.
#[test]
fn a_failure_ends_nothing_and_what_is_finished_stays() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    jobs(folder, true);
    let first = batch(folder, &["jobs.toml", "-o", "out"]);
    let said = text(&first.stderr);
    assert_eq!(first.status.code(), Some(1), "{said}");
    assert!(said.contains("4 made, 0 kept, 1 failed") && said.contains("1 of 5 jobs failed"), "{said}");
    assert!(said.contains("broken: ") && said.contains("broken.glb"), "{said}");
    let made = results(&folder.join("out"));
    let names: Vec<&str> = made.keys().map(String::as_str).collect();
    let wanted = ["coarse/coarse.glb", "demo_high/demo_high.glb", "finer/finer.glb"];
    assert_eq!(names.iter().filter(|name| name.ends_with(".glb")).copied().collect::<Vec<_>>(), wanted);
    assert_eq!(names.len(), 6, "{names:?}");
    let record = json(&folder.join("out/measured/job.json"));
    assert_eq!(record["command_line"][0], "stats");
    assert!(record["files"].as_array().unwrap().iter().any(|file| file["name"] == "figures.json"));
    let page = fs::read_to_string(folder.join("out/batch.html")).unwrap();
    assert!(page.contains("4 of 5 jobs") && page.contains("<b>broken</b> failed") && !page.contains(">NaN"));
    assert_eq!(page.matches("data:image/png;base64,").count(), 3);
    let all = json(&folder.join("out/batch.json"));
    assert_eq!(all["jobs"][2]["state"], "failed");

    jobs(folder, false);
    let second = batch(folder, &["jobs.toml", "-o", "out", "--workers", "2", "--memory", "64"]);
    assert!(second.status.success(), "{}", text(&second.stderr));
    assert!(text(&second.stderr).contains("0 made, 4 kept, 0 failed"), "{}", text(&second.stderr));
    assert_eq!(results(&folder.join("out")), made);

    fs::copy(folder.join("demo_high.glb"), folder.join("demo_low.glb")).unwrap();
    let third = batch(folder, &["jobs.toml", "-o", "out"]);
    assert!(text(&third.stderr).contains("1 made, 3 kept, 0 failed"), "{}", text(&third.stderr));
}

/// Protects work from the power failing: a batch that is killed at any time goes on where it was, its workers are gone,
/// and the results are the same bytes as in one go.
#[cfg(unix)]
#[test]
fn a_killed_batch_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    jobs(folder, false);
    assert!(batch(folder, &["jobs.toml", "-o", "whole"]).status.success());
    let finished = || {
        let all = ["demo_high", "finer", "measured", "coarse"];
        all.iter().filter(|name| folder.join("cut").join(name).join("job.json").exists()).count()
    };
    let mut before = 0;
    for pause in [40, 150, 300] {
        let mut child = parbake(folder);
        child.args(["batch", "jobs.toml", "-o", "cut", "--workers", "2", "-q"]).stderr(Stdio::null());
        let mut child = child.spawn().unwrap();
        let begin = Instant::now();
        // Once something more is finished, a little later, in the middle of the next.
        while finished() == before
            && begin.elapsed() < Duration::from_secs(60)
            && child.try_wait().unwrap().is_none()
        {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(pause));
        // SIGKILL: the batch can do nothing about it.
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(finished() >= before);
        before = finished();
    }
    if cfg!(target_os = "linux") {
        // Workers read the end of their standard input.
        let is_ours = |entry: &fs::DirEntry| {
            fs::read_link(entry.path().join("cwd")).is_ok_and(|cwd| cwd.starts_with(folder.join("cut")))
        };
        let begin = Instant::now();
        while fs::read_dir("/proc").unwrap().flatten().any(|entry| is_ours(&entry)) {
            assert!(begin.elapsed() < Duration::from_secs(20), "a worker goes on");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    let last = batch(folder, &["jobs.toml", "-o", "cut"]);
    assert!(last.status.success(), "{}", text(&last.stderr));
    assert!(
        text(&last.stderr).contains(&format!("{} made, {before} kept", 4 - before)),
        "{}",
        text(&last.stderr)
    );
    let (cut, whole) = (results(&folder.join("cut")), results(&folder.join("whole")));
    assert_eq!(cut.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>());
    assert!(cut == whole, "bytes differ");
    let left: Vec<_> = fs::read_dir(folder.join("cut/.batch")).unwrap().flatten().collect();
    assert!(left.iter().all(|entry| entry.path().is_file()), "{left:?}");
}

/// Protects the other way of asking: a folder of models and one command, with its options after `--`.
#[test]
fn a_folder_of_models_is_a_batch() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir_all(folder.join("models/sub")).unwrap();
    demo_pair(folder);
    fs::rename(folder.join("demo_high.glb"), folder.join("models/sub/high.glb")).unwrap();
    fs::rename(folder.join("demo_low.glb"), folder.join("models/low.glb")).unwrap();
    let arguments =
        ["models", "--command", "simplify", "-o", "out", "--", "--triangles", "100", "--closest-in", "shape"];
    let out = batch(folder, &arguments);
    assert!(out.status.success(), "{}", text(&out.stderr));
    for name in ["low/low.glb", "sub-high/sub-high.glb", "batch.html"] {
        assert!(folder.join("out").join(name).exists(), "{name}");
    }
    let measured = batch(folder, &["models", "--command", "stats", "-o", "figures", "-q"]);
    assert!(measured.status.success(), "{}", text(&measured.stderr));
    assert!(json(&folder.join("figures/low/figures.json"))["model"]["topology"]["components"].is_u64());
}

/// Protects from hours of work for nothing: what is wrong is said before any job begins.
#[test]
fn mistakes_are_told_before_any_job_begins() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    jobs(folder, false);
    fs::create_dir(folder.join("models")).unwrap();
    fs::copy(folder.join("demo_low.glb"), folder.join("models/low.glb")).unwrap();
    let bad = "[[job]]\ncommand = 'compress'\ninputs = ['demo_high.glb']\noptions = { texture-sise = 32 }\n";
    fs::write(folder.join("bad.toml"), bad).unwrap();
    for (arguments, code, part) in [
        (&["bad.toml"][..], 2, "--texture-sise"),
        (&["models"], 2, "needs --command"),
        (&["models", "--command", "batch"], 2, "no command that a batch can run"),
        (&["models", "--command", "bake"], 2, "job \"low\""),
        (&["jobs.toml", "--command", "bake"], 2, "go with a folder"),
        (&["jobs.toml", "--workers", "0"], 2, "1 to 256"),
        (&["jobs.toml", "--memory=-1"], 2, "above 0"),
        (&["jobs.toml", "--only", "nobody"], 2, "no job of this name"),
        (&["nowhere.toml"], 1, "nowhere.toml"),
    ] {
        let out = batch(folder, arguments);
        let said = text(&out.stderr);
        assert!(out.status.code() == Some(code) && said.contains(part), "{arguments:?}: {said}");
        assert!(!folder.join("batch/demo_high").exists());
    }
}

/// Protects farms: the template is one that OpenJD's own program takes, its tasks make the same bytes as a batch, and a
/// batch after them has nothing left to do.
#[test]
fn a_farm_makes_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    jobs(folder, false);
    let written = batch(folder, &["jobs.toml", "-o", "farm", "--openjd", "template.json"]);
    assert!(written.status.success(), "{}", text(&written.stderr));
    assert!(!folder.join("farm").exists());
    let step = &json(&folder.join("template.json"))["steps"][0];
    assert_eq!(step["parameterSpace"]["taskParameterDefinitions"][0]["range"].as_array().unwrap().len(), 4);
    let openjd = std::env::var_os("OPENJD").unwrap_or("openjd".into());
    let program = format!("Parbake={}", env!("CARGO_BIN_EXE_parbake"));
    let run = Command::new(&openjd)
        .current_dir(folder)
        .args(["run", "template.json", "--step", "Jobs", "-p", &program])
        .output();
    let Ok(run) = run else {
        eprintln!(
            "skipped: install openjd-cli (pip install openjd-cli), or set OPENJD to it, to run this test"
        );
        return;
    };
    assert!(run.status.success(), "{}{}", text(&run.stdout), text(&run.stderr));
    let after = batch(folder, &["jobs.toml", "-o", "farm"]);
    assert!(text(&after.stderr).contains("0 made, 4 kept"), "{}", text(&after.stderr));
    assert!(batch(folder, &["jobs.toml", "-o", "own"]).status.success());
    assert!(results(&folder.join("farm")) == results(&folder.join("own")), "bytes differ");
}

/// Protects what is finished from Ctrl-C, and the machine from what is not: the exit code says that it was stopped.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_what_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    jobs(folder, false);
    let mut command = parbake(folder);
    let mut child = command.args(["batch", "jobs.toml", "-o", "out"]).stderr(Stdio::null()).spawn().unwrap();
    let begin = Instant::now();
    while !folder.join("out/demo_high/job.json").exists() && begin.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    let page = fs::read_to_string(folder.join("out/batch.html")).unwrap();
    assert!(page.contains("was stopped"), "{page}");
    let rest = batch(folder, &["jobs.toml", "-o", "out"]);
    assert!(rest.status.success() && !text(&rest.stderr).contains("4 made"), "{}", text(&rest.stderr));
}
