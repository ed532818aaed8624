//! Runs the built command as a user would, in a folder of its own.

#![allow(dead_code, clippy::unwrap_used)]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use tempfile::TempDir;

/// Options with which a bake takes a fraction of a second.
pub const SMALL: [&str; 10] =
    ["--texture-size", "64", "--preset", "fast", "--views", "12", "--view-size", "64", "--rounds", "1"];

/// A bake of which only what is written matters: nothing moves, and nothing is compared.
pub const PLAIN: [&str; 5] = ["--uv", "repair", "--shape", "keep", "--no-comparison"];

/// The command in this folder.
pub fn parbake(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_parbake"));
    command.current_dir(folder);
    command
}

/// Runs it and wants success.
pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    let output = parbake(folder).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    output
}

/// What it printed.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// The built-in pair, with a tenth of the high-poly's triangles and a quarter of its textures' sides, as files in this
/// folder: `demo_high.glb` and `demo_low.glb`.
pub fn demo_pair(folder: &Path) {
    demo_files(folder, &["demo_high.glb", "demo_low.glb"]);
}

/// These of the built-in pair's files, or `demo.glb`, a small bake of it.
pub fn demo_files(folder: &Path, names: &[&str]) {
    // Made once a program.
    static PAIR: OnceLock<TempDir> = OnceLock::new();
    static BAKED: OnceLock<()> = OnceLock::new();
    let made = PAIR.get_or_init(|| {
        let made = tempfile::tempdir().unwrap();
        let (high, low) = parbake::demo_pair();
        let mut high = parbake::simplified(&high, 6000);
        high.images.iter_mut().for_each(|image| *image = coarser(image));
        for (name, model) in [("demo_high.glb", &high), ("demo_low.glb", &low)] {
            parbake::write_glb(&made.path().join(name), model).unwrap();
        }
        made
    });
    if names.contains(&"demo.glb") {
        BAKED.get_or_init(|| {
            let bake = ["bake", "demo_high.glb", "demo_low.glb", "-o", "demo.glb", "-q"];
            run(made.path(), &[&bake[..], &SMALL].concat());
        });
    }
    for name in names {
        std::fs::copy(made.path().join(name), folder.join(name)).unwrap();
    }
}

/// Every fourth texel in each direction.
fn coarser(image: &parbake::Picture) -> parbake::Picture {
    let (width, height) = (image.width / 4, image.height / 4);
    let texel = |i: usize| image.pixels[4 * (i / width) * image.width + 4 * (i % width)];
    let pixels = (0..width * height).map(texel).collect();
    parbake::Picture { name: image.name.clone(), width, height, pixels }
}

/// The folder of real models, or none with a word about it.
pub fn real_models() -> Option<PathBuf> {
    let folder = std::env::var_os("PARBAKE_DATA").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("skipped: set PARBAKE_DATA to the folder of real models to run this test");
    }
    folder
}

/// PSNR of a comparison by the paper's convention.
pub fn psnr(folder: &Path, high: &Path, low: &Path) -> f64 {
    let arguments = ["eval", high.to_str().unwrap(), low.to_str().unwrap()];
    let output = run(
        folder,
        &[
            &arguments[..],
            &[
                "--convention",
                "paper",
                "--views",
                "12",
                "--resolution",
                "256",
                "--no-flip",
                "--json",
                "-",
                "-q",
            ],
        ]
        .concat(),
    );
    let evaluation: Value = serde_json::from_slice(&output.stdout).unwrap();
    evaluation["mean"]["psnr"].as_f64().unwrap()
}
