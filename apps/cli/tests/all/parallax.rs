//! Parallax maps in files, as `eval` shows them.

use crate::common::{SMALL, demo_pair, parbake, run, text};
use parbake::{Limits, Model, read_model, write_glb};
use parbake_model::{Basis, CutoutMap};
use serde_json::Value;
use std::path::Path;

/// Gives every material a map of order 0 that shifts by `shift` texture widths along u where
/// the surface is seen face on.
fn add_map(model: &mut Model, shift: f32) {
    let mut image = model.images[0].clone();
    (image.name, image.width, image.height, image.pixels) =
        ("parallax".into(), 2, 2, vec![[255, 0, 0, 255]; 4]);
    model.images.push(image);
    let last = model.images.len() - 1;
    for material in &mut model.materials {
        let map = material.parallax.get_or_insert_default();
        map.images = vec![last];
        // The function of order 0 is √(1 / 4π).
        map.scale = vec![shift / 0.282_094_8, 0.0];
        map.offset = vec![0.0; 2];
    }
}

/// Gives every map a cutout of order 1 with these coefficients everywhere, of the functions 1,
/// y, z and x but for factors.
fn add_cutout(model: &mut Model, coefficients: [f32; 4]) {
    for map in model.materials.iter_mut().filter_map(|m| m.parallax.as_mut()) {
        let image = map.images[0];
        map.cutout = Some(CutoutMap {
            basis: Basis::Harmonics(1),
            images: vec![image; 2],
            scale: vec![0.0; 4],
            offset: coefficients.to_vec(),
        });
    }
}

fn psnr(folder: &Path, high: &str, low: &str, more: &[&str]) -> f64 {
    let arguments =
        ["eval", high, low, "--views", "4", "--resolution", "64", "--no-flip", "--json", "-", "-q"];
    let output = run(folder, &[&arguments[..], more].concat());
    let evaluation: Value = serde_json::from_slice(&output.stdout).unwrap();
    evaluation["mean"]["psnr"].as_f64().unwrap()
}

/// Protects whoever asks what a file looks like in viewers with and without the extension:
/// the map is read from the file and shown, and with `--no-parallax` it is not.
#[test]
fn eval_shows_a_file_both_ways() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let mut model = read_model(&folder.join("demo_high.glb"), &Limits::default()).unwrap().model;
    add_map(&mut model, 0.05);
    write_glb(&folder.join("shifted.glb"), &model).unwrap();
    let (with, without) = (
        psnr(folder, "demo_high.glb", "shifted.glb", &[]),
        psnr(folder, "demo_high.glb", "shifted.glb", &["--no-parallax"]),
    );
    assert_eq!(without, 100.0, "the same pictures");
    assert!(with < 40.0, "{with} dB");
    assert_eq!(psnr(folder, "shifted.glb", "shifted.glb", &[]), 100.0);
}

/// Protects whoever asks what a cutout does to a file's silhouettes: what it leaves out is
/// background, of whichever colour, and with `--no-parallax` nothing is.
#[test]
fn eval_shows_cutouts_both_ways() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let mut model = read_model(&folder.join("demo_high.glb"), &Limits::default()).unwrap().model;
    add_map(&mut model, 0.0);
    let cuts =
        [("whole", [1.0, 0.0, 0.0, 0.0]), ("above", [0.0, 1.0, 0.0, 0.0]), ("none", [-1.0, 0.0, 0.0, 0.0])];
    for (name, coefficients) in cuts {
        add_cutout(&mut model, coefficients);
        write_glb(&folder.join(format!("{name}.glb")), &model).unwrap();
    }
    let figures = |name: &str, more: &[&str]| psnr(folder, "demo_high.glb", &format!("{name}.glb"), more);
    assert_eq!(figures("whole", &[]), 100.0);
    for (name, _) in cuts {
        assert_eq!(figures(name, &["--no-parallax"]), 100.0, "{name}: the same pictures");
    }
    for background in ["black", "1,0,1"] {
        let [above, none] = ["above", "none"].map(|name| figures(name, &["--background", background]));
        // Some of the views, and all of them.
        assert!(none < 20.0 && none + 10.0 < above && above < 90.0, "{background}: {none} and {above} dB");
    }
}

/// Protects users from a map that is dropped in silence: they are told, and the rest of the
/// model is evaluated.
#[test]
fn a_broken_map_is_mentioned() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let mut model = read_model(&folder.join("demo_high.glb"), &Limits::default()).unwrap().model;
    add_map(&mut model, 0.05);
    write_glb(&folder.join("broken.glb"), &model).unwrap();
    let mut bytes = std::fs::read(folder.join("broken.glb")).unwrap();
    let at = bytes.windows(9).position(|w| w == b"\"order\":0").unwrap();
    bytes[at + 8] = b'9';
    std::fs::write(folder.join("broken.glb"), bytes).unwrap();
    let arguments =
        ["eval", "demo_high.glb", "broken.glb", "--views", "2", "--resolution", "32", "--no-flip"];
    let output = parbake(folder).args(arguments).output().unwrap();
    assert!(output.status.success());
    let said = text(&output.stderr);
    assert!(said.contains("was left out: its order is 9"), "{said}");
    assert!(text(&output.stdout).contains("100.000"), "{}", text(&output.stdout));
}

/// Protects `bake --parallax`: the file holds the map and its cutout, and shows them.
#[test]
fn a_bake_writes_maps_that_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let arguments = ["bake", "demo_high.glb", "demo_low.glb", "-o", "deep.glb", "-q"];
    let maps =
        ["--parallax", "tangent", "--parallax-size", "16", "--cutout-size", "32", "--json", "deep.json"];
    run(folder, &[&arguments[..], &maps, &SMALL, &["--no-comparison"]].concat());
    let model = read_model(&folder.join("deep.glb"), &Limits::default()).unwrap().model;
    let map = model.materials[0].parallax.as_ref().unwrap();
    let cutout = map.cutout.as_ref().unwrap();
    assert_eq!((map.basis, cutout.basis), (Basis::TangentShift, Basis::TangentCutout));
    assert_eq!(map.images.len() + cutout.images.len(), 2, "one texture each");
    let report = crate::common::json(&folder.join("deep.json"));
    assert!(report["parallax_maps"]["steps"].as_u64().unwrap() > 0);
    assert!(report["shape"]["moved"][1].as_f64().unwrap() > 0.0);
    let shown = psnr(folder, "demo_high.glb", "deep.glb", &[]);
    assert!(shown != psnr(folder, "demo_high.glb", "deep.glb", &["--no-parallax"]));
}

/// Protects an hour's work: what an OBJ cannot hold is refused before it is made, and so is a
/// map for a surface that stays.
#[test]
fn maps_are_refused_where_there_is_no_place_for_them() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    for arguments in [
        ["bake", "demo_high.glb", "demo_low.glb", "-o", "deep.obj", "--parallax", "tangent"].as_slice(),
        ["compress", "demo_high.glb", "-o", "small.glb", "--parallax", "sh"].as_slice(),
    ] {
        let output = parbake(folder).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("parallax"), "{}", text(&output.stderr));
    }
}
