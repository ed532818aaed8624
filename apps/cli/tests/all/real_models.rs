//! Whole bakes of real models, by the figures that users would measure. Needs
//! PARBAKE_DATA; the floors lie 0.3 dB below what was measured, since another
//! machine's mathematics may differ in the last digit, not in decibels.

use crate::common::{psnr, real_models, run};
use std::path::{Path, PathBuf};

fn obj_in(folder: &Path) -> PathBuf {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    files.into_iter().find(|p| p.extension().is_some_and(|e| e == "obj")).unwrap()
}

/// Protects the product's first promise: on a coarse low-poly a bake looks far more like the high-poly than a
/// projection. The gains of all four pairs are guarded by `.ci/run` (`docs/quick_record.json`).
#[test]
fn a_coarse_level_reaches_its_figures() {
    let Some(data) = real_models() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (name, floor, gain) = ("lego_figure", 25.3, 2.5);
    let pair = data.join("pairs").join(name);
    let (high, low) = (pair.join("high/hp.obj"), obj_in(&pair.join("low_simplygon50")));
    let bake = |output: &str, more: &[&str]| {
        let arguments = ["bake", high.to_str().unwrap(), low.to_str().unwrap(), "-q", "-o", output];
        let quick = ["--preset", "fast", "--texture-size", "256"];
        run(folder, &[&arguments[..], &quick, more].concat());
        psnr(folder, &high, output.as_ref())
    };
    let plain = ["--rounds", "0", "--uv", "keep", "--shape", "keep"];
    let (baked, projected) = (bake("baked.glb", &[]), bake("projected.glb", &plain));
    eprintln!("{name}: {projected:.2} dB projected, {baked:.2} dB baked");
    assert!(baked >= floor && baked - projected >= gain, "{name}: {projected} {baked}");
}

/// Protects the way of a modern asset: a GLB with several textures is simplified,
/// baked and compared, GLB to GLB.
#[test]
fn a_glb_goes_the_whole_way() {
    let Some(data) = real_models() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let high = data.join("pbr/ExplodingBarrel/ExplodingBarrel.glb");
    let name = high.to_str().unwrap();
    run(folder, &["simplify", name, "-o", "low.glb", "--triangles", "400", "--closest-in", "shape", "-q"]);
    let small = ["--preset", "fast", "--texture-size", "128", "--views", "60", "--no-comparison", "-q"];
    run(folder, &[&["bake", name, "low.glb", "-o", "baked.glb"], &small[..]].concat());
    let (before, after) =
        (psnr(folder, &high, "low.glb".as_ref()), psnr(folder, &high, "baked.glb".as_ref()));
    eprintln!("{before:.2} dB with the original's textures, {after:.2} dB baked");
    assert!(after > before);
}
