//! Commands that repair, make and move texture coordinates, as scripts and people meet them.

use crate::common::{demo_pair, parbake, psnr, run, text};
use std::fs;
use std::path::Path;

/// Exit code and what was printed by `check`, for 64 texels.
fn check(folder: &Path, model: &str, gutter: &str) -> (Option<i32>, String) {
    let arguments = ["check", model, "--texture-size", "64", "--gutter", gutter];
    let output = parbake(folder).args(arguments).output().unwrap();
    (output.status.code(), text(&output.stdout) + &text(&output.stderr))
}

/// Options of a small bake. Layouts need no views.
const SMALL_FAST: [&str; 4] = ["--texture-size", "64", "--preset", "fast"];
const FEW_VIEWS: [&str; 5] = ["--views", "24", "--view-size", "64", "--no-comparison"];

/// Protects each way of dealing with texture coordinates: what is not merely kept is sound.
#[test]
fn bakes_have_sound_layouts() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    for mode in ["keep", "repair", "unwrap", "optimize"] {
        let output = format!("{mode}.glb");
        let bake = ["bake", "demo_high.glb", "demo_low.glb", "-q", "-o", &output, "--uv", mode];
        run(folder, &[&bake[..], &SMALL_FAST, &FEW_VIEWS].concat());
        let (code, said) = check(folder, &output, "0");
        assert!(mode == "keep" || code == Some(0), "{mode}: {said}");
    }
}

/// Protects models without texture coordinates: they are unwrapped, and people are told;
/// with `--uv keep` one sentence says why there is no result.
#[test]
fn bare_models_are_unwrapped() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
    fs::write(folder.join("bare.obj"), format!("{square}f 1 2 3 4\n")).unwrap();
    let mapped = format!("{square}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    fs::write(folder.join("high.obj"), mapped).unwrap();
    let bake = ["bake", "high.obj", "bare.obj", "-o", "baked.glb"];
    let told = run(folder, &[&bake[..], &SMALL_FAST, &FEW_VIEWS].concat());
    let told = text(&told.stdout) + &text(&told.stderr);
    assert!(told.contains("no texture coordinates"), "{told}");
    let (code, said) = check(folder, "baked.glb", "0");
    assert_eq!(code, Some(0), "{said}");
    let kept = ["bake", "high.obj", "bare.obj", "-o", "kept.glb", "--uv", "keep"];
    let output = parbake(folder).args(kept).args(SMALL_FAST).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("error: ") && said.contains("no texture coordinates"), "{said}");
    assert!(!folder.join("kept.glb").exists());
}

/// Protects `compress`: a sound layout with a gutter, bytes before and after, and with `--verbose` what stages took.
#[test]
fn compressed_models_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let simplify = ["simplify", "demo_high.glb", "-o", "few.glb", "--triangles", "500"];
    run(folder, &[&simplify[..], &["--closest-in", "shape", "-q"]].concat());
    let compress = ["compress", "few.glb", "-o", "small.glb", "-v"];
    let output = run(folder, &[&compress[..], &SMALL_FAST, &FEW_VIEWS].concat());
    let (printed, said) = (text(&output.stdout), text(&output.stderr));
    assert!(said.contains("moving texture coordinates "), "{said}");
    assert!(printed.contains(" bytes → "), "{printed}");
    let (code, said) = check(folder, "small.glb", "1");
    assert_eq!(code, Some(0), "{said}");
}

/// Protects what a user fixes: triangles are added only where they may be, and are told about.
#[test]
fn triangles_are_added_as_asked() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let simplify = ["simplify", "demo_high.glb", "-o", "few.glb", "--triangles", "120"];
    run(folder, &[&simplify[..], &["--closest-in", "shape", "-q"]].concat());
    // With a gutter the coordinates that were delivered are not weighed against the new ones.
    let compress = ["compress", "few.glb", "-o", "small.glb", "--json", "report.json", "--gutter", "1"];
    let triangles = |more: &str| {
        let options = [&compress[..], &SMALL_FAST, &FEW_VIEWS, &["--more-triangles", more]].concat();
        let printed = text(&run(folder, &options).stdout);
        let report: serde_json::Value =
            serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap();
        let [given, now] = ["high_triangles", "low_triangles"].map(|name| report[name].as_u64().unwrap());
        assert_eq!(printed.contains("--more-triangles 0 keeps them"), now > given, "{printed}");
        let (code, said) = check(folder, "small.glb", "0");
        assert_eq!(code, Some(0), "{said}");
        now - given
    };
    assert_eq!(triangles("0"), 0);
    let more = triangles("500");
    assert!((1..=500).contains(&more), "{more}");
}

/// Protects `image`: from a picture to a plane that is sound and can be compared, whether its
/// texture coordinates move or not.
#[test]
fn pictures_become_planes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    // A picture from an OBJ's material: the textures of the demo.
    let simplify = ["simplify", "demo_high.glb", "-o", "demo.obj", "--triangles", "100"];
    run(folder, &[&simplify[..], &["--closest-in", "shape", "-q"]].concat());
    let mut pictures: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    pictures.retain(|path| path.extension().is_some_and(|e| e == "png"));
    pictures.sort();
    let picture = pictures.first().unwrap().to_str().unwrap();
    for (output, mode) in [("moved.glb", "optimize"), ("kept.glb", "keep")] {
        let image = ["image", picture, "-o", output, "--uv", mode, "--texture-size", "64", "--grid", "12"];
        let printed = text(&run(folder, &image).stdout);
        assert!(printed.contains("bytes"), "{printed}");
        let (code, said) = check(folder, output, "0");
        assert_eq!(code, Some(0), "{said}");
    }
    assert!(psnr(folder, "kept.glb".as_ref(), "moved.glb".as_ref()) > 10.0);
}
