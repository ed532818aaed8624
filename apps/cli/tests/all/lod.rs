//! `parbake lod` and `parbake bake --triangles` as people meet them.

use crate::common::{demo_pair, json, parbake, run, text};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The JSON of a GLB file.
fn document(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// Protects the chain: each level is a file of its own within its budget, all are in one file as `MSFT_lod`, and
/// lods.json tells of what is there.
#[test]
fn a_chain_is_written_for_engines() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    // A budget that is long spent cuts every step short and leaves out no level.
    let levels = [
        "--screen-size",
        "48,24",
        "--triangles",
        "300,60",
        "--layout",
        "three",
        "--time-budget",
        "3",
        "--report",
        "lods.html",
    ];
    run(folder, &[&["lod", "demo_high.glb", "-o", "lods"], &levels[..]].concat());
    let lods = folder.join("lods");
    let chain = json(&lods.join("lods.json"));
    let told = chain["levels"].as_array().unwrap();
    assert_eq!(told.len(), 2);
    for (level, most) in told.iter().zip([300, 60]) {
        let file = lods.join(level["file"].as_str().unwrap());
        assert_eq!(fs::metadata(&file).unwrap().len(), level["bytes"].as_u64().unwrap());
        let triangles = level["triangles"].as_u64().unwrap();
        assert!(triangles <= most && triangles + 4 > most, "{triangles} of {most}");
        let glb = document(&file);
        let accessor = glb["meshes"][0]["primitives"][0]["indices"].as_u64().unwrap() as usize;
        assert_eq!(glb["accessors"][accessor]["count"], 3 * triangles);
        assert!(level["at_screen_size"]["psnr"].as_f64().unwrap() > 20.0, "{level}");
    }
    let all = document(&lods.join(chain["all_levels"].as_str().unwrap()));
    assert_eq!(all["nodes"][0]["extensions"]["MSFT_lod"]["ids"], serde_json::json!([1]));
    assert_eq!(all["extensionsUsed"], serde_json::json!(["MSFT_lod"]));
    let coverages = &all["nodes"][0]["extras"]["MSFT_screencoverage"];
    assert_eq!(coverages[0], told[0]["min_coverage"]);
    assert_eq!((coverages[1].as_f64(), coverages[2].as_f64()), (Some(0.0), None));
    assert!(lods.join("parbake_lods.js").exists());
    let page = fs::read_to_string(folder.join("lods.html")).unwrap();
    assert!(page.contains("At its size: 48 pixels") && page.contains("Level 1"));
    // The file with all levels shows the finest to readers that know no levels.
    run(folder, &["check", "lods/demo_high_lods.glb"]);
}

/// Protects `--target-psnr`: the file of the level is the one that was chosen among those that lods.json tells of, it has
/// the figure that was measured and the maps that were left; a target that is out of reach is told by the exit code, and
/// the best file is there all the same.
#[test]
fn a_level_is_the_smallest_file_of_a_psnr() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    // Bakes are many, and those that reach for a target in vain have as many triangles as there are.
    run(folder, &["simplify", "demo_high.glb", "-t", "12", "--closest-in", "shape", "-o", "model.glb"]);
    let small = ["--screen-size", "24", "--max-texture-size", "24"];
    let level = |model: &str, output: &str, code: i32, more: &[&str]| {
        let ended = parbake(folder)
            .args(["lod", model])
            .args(small)
            .args(["-o", output])
            .args(more)
            .output()
            .unwrap();
        assert_eq!(ended.status.code(), Some(code), "{}", text(&ended.stderr));
        (json(&folder.join(output).join("lods.json"))["levels"][0].clone(), text(&ended.stderr))
    };
    let (found, _) = level("model.glb", "found", 0, &["--target-psnr", "30"]);
    let trials = found["target"]["trials"].as_array().unwrap();
    let chosen: Vec<&Value> = trials.iter().filter(|trial| trial["chosen"] == true).collect();
    assert_eq!(chosen.len(), 1);
    assert_eq!(chosen[0]["bytes"], found["bytes"]);
    assert_eq!(chosen[0]["triangles"], found["triangles"]);
    let psnr = [chosen[0], &found["at_screen_size"]].map(|of| of["psnr"].as_f64().unwrap());
    assert!(psnr[0] >= 30.0 && (psnr[0] - psnr[1]).abs() < 1e-6, "{psnr:?}");
    // One that ends closer to the target may be a little larger.
    let bytes = |of: &Value| of["bytes"].as_u64().unwrap();
    let smaller = |trial: &&Value| trial["reached"] == true && 103 * bytes(trial) < 100 * bytes(&found);
    assert_eq!(trials.iter().filter(smaller).count(), 0);
    assert!(trials.len() > 1 && found["target"]["bakes"].as_u64().unwrap() <= 8, "{trials:?}");
    let glb = document(&folder.join("found").join(found["file"].as_str().unwrap()));
    let sizes = chosen[0]["maps"].as_array().unwrap().iter().filter(|map| map["size"] != 0);
    assert_eq!(glb["images"].as_array().map_or(0, Vec::len), sizes.count());
    let (missed, told) = level("model.glb", "missed", 4, &["--target-psnr", "60"]);
    assert_eq!(missed["target"]["verdict"], "missed");
    assert!(told.contains("60 dB cannot be reached"), "{told}");
    let both = parbake(folder)
        .args(["lod", "model.glb", "--target-psnr", "30", "--triangles", "90"])
        .output()
        .unwrap();
    assert_eq!(both.status.code(), Some(2));
    assert!(text(&both.stderr).contains("--triangles"), "{}", text(&both.stderr));
}

/// Protects who has no low-poly: one is made, within its budget, and it has a sound layout.
#[test]
fn a_bake_makes_its_low_poly() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    // Whatever time there is, the number of triangles and the layout are as promised.
    let small = [
        "--texture-size",
        "64",
        "--preset",
        "fast",
        "--views",
        "24",
        "--time-budget",
        "4",
        "--no-comparison",
    ];
    run(
        folder,
        &[&["bake", "demo_high.glb", "-t", "80", "-o", "out.glb", "--json", "out.json"], &small[..]].concat(),
    );
    assert!((76..=80).contains(&json(&folder.join("out.json"))["low_triangles"].as_u64().unwrap()));
    run(folder, &["check", "out.glb"]);
    let both = parbake(folder).args(["bake", "demo_high.glb", "demo_low.glb", "-t", "80"]).output().unwrap();
    assert_eq!(both.status.code(), Some(2));
    let none = parbake(folder).args(["bake", "demo_high.glb"]).output().unwrap();
    assert_eq!(none.status.code(), Some(2));
    assert!(text(&none.stderr).contains("LOW"), "{}", text(&none.stderr));
    let wrong = parbake(folder).args(["lod", "demo_high.glb", "--screen-size", "50,100"]).output().unwrap();
    assert!(text(&wrong.stderr).contains("descending"), "{}", text(&wrong.stderr));
}

/// Protects folders from being made for nothing: where the model is not there, neither is the output.
#[test]
fn a_model_that_is_missing_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let try_it = || parbake(folder.path()).args(["lod", "nothing.glb", "-o", "lods"]).output().unwrap();
    let output = try_it();
    assert!(!output.status.success() && text(&output.stderr).contains("nothing.glb"));
    assert!(!folder.path().join("lods").exists());
    fs::create_dir(folder.path().join("lods")).unwrap();
    try_it();
    assert!(folder.path().join("lods").exists(), "a folder that was there stays");
}
