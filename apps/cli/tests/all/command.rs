//! The command as scripts and people meet it: files, exit codes, words, bytes.

use crate::common::{PLAIN, SMALL, demo_pair, json, parbake, run, text};
use std::fs;

/// Protects the first minute: everything from nothing, and better than projected.
#[test]
fn demo_makes_bakes_and_reports() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, &[&["demo", "--pictures", "pictures"][..], &SMALL].concat());
    // README's pictures: one file with the four bakes side by side, small enough for a repository.
    let file = fs::read(folder.join("pictures/demo.webp")).unwrap();
    assert!(file.len() < 300_000 && file.starts_with(b"RIFF"), "{} bytes", file.len());
    let out = folder.join("out");
    assert_eq!(fs::read(out.join("demo.glb")).unwrap()[..4], *b"glTF");
    assert!(fs::read_to_string(out.join("demo.html")).unwrap().contains("</html>"));
    let report = json(&out.join("demo.json"));
    let losses = report["losses"].as_array().unwrap();
    let loss = |i: usize| losses[i]["mean_square"].as_f64().unwrap();
    assert!(loss(losses.len() - 1) < 0.8 * loss(0), "{losses:?}");
}

/// Protects reproducible builds: the same bytes whatever the number of threads, and
/// from a report's options; other bytes from another seed.
#[test]
fn the_same_question_has_the_same_answer() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let bake = |name: &str, more: &[&str]| {
        let arguments = ["bake", "demo_high.glb", "demo_low.glb", "-q", "-o", name];
        run(folder, &[&arguments[..], more].concat());
        fs::read(folder.join(name)).unwrap()
    };
    let one =
        bake("1.glb", &[&SMALL[..], &["--threads", "1", "--json", "1.json", "--no-comparison"]].concat());
    assert!(one == bake("5.glb", &[&SMALL[..], &["--threads", "5"]].concat()));
    assert!(one == bake("again.glb", &["--options", "1.json"]));
    assert!(one != bake("seed.glb", &["--options", "1.json", "--seed", "7"]));
}

/// Protects downloads: formats come from options files and from reports as all options do; JSON and page list what
/// each texture and the mesh lost; the same bytes for any number of threads.
#[test]
fn formats_are_options_and_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let formats = r#"{"texture_format": "ktx2-etc1s", "texture_quality": 80, "mesh_compression": "meshopt", "uv": "repair", "shape": "keep"}"#;
    fs::write(folder.join("formats.json"), formats).unwrap();
    let bake = |name: &str, more: &[&str]| {
        let arguments = ["bake", "demo_high.glb", "demo_low.glb", "-o", name];
        let output = run(folder, &[&arguments[..], more].concat());
        (fs::read(folder.join(name)).unwrap(), text(&output.stderr))
    };
    let reports = ["--options", "formats.json", "--threads", "1", "--json", "1.json", "--report", "1.html"];
    let (one, said) = bake("1.glb", &[&SMALL[..], &reports].concat());
    assert!(one == bake("2.glb", &["--options", "1.json", "--threads", "2", "--no-comparison"]).0);
    assert!(said.contains("as KTX2 (ETC1S)") && said.contains("positions within"), "{said}");
    let written = &json(&folder.join("1.json"))["written"];
    assert_eq!((&written["mesh"]["compression"], &written["bytes"]), (&"meshopt".into(), &one.len().into()));
    let textures = written["textures"].as_array().unwrap();
    let of = |key: &str| textures.iter().map(|texture| texture[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("format"), ["ktx2-etc1s", "ktx2"], "normals stay UASTC");
    assert!(of("psnr").iter().all(|psnr| psnr.as_f64().unwrap() > 15.0), "{textures:?}");
    assert!(fs::read_to_string(folder.join("1.html")).unwrap().contains("KTX2 (ETC1S)"));
    // The command line wins, and what cannot be KTX2 says why.
    let odd = ["--options", "1.json", "--texture-size", "30", "--texture-format", "ktx2", "--json", "3.json"];
    let (_, said) = bake("3.glb", &[&odd[..], &["--no-comparison"]].concat());
    assert!(said.contains("as PNG, without loss: KTX2 in glTF has sides of 4, 8, 12"), "{said}");
    let textures = &json(&folder.join("3.json"))["written"]["textures"];
    assert!(textures[0]["reason"].as_str().unwrap().contains("30 × 30"), "{textures}");
}

/// Protects bytes and texels: a copy has the JPEGs of its model, unless another format is asked for.
#[test]
fn simplified_models_keep_their_jpegs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let simplify = |from: &str, to: &str, more: &[&str]| {
        let arguments = ["simplify", from, "-o", to, "--triangles", "300", "--closest-in", "shape", "-q"];
        run(folder, &[&arguments[..], more].concat());
        let glb = fs::read(folder.join(to)).unwrap();
        String::from_utf8_lossy(&glb).contains("image/jpeg")
    };
    assert!(simplify("demo_high.glb", "jpeg.glb", &["--texture-format", "jpeg"]));
    assert!(simplify("jpeg.glb", "kept.glb", &[]));
    assert!(!simplify("jpeg.glb", "png.glb", &["--texture-format", "png"]));
    assert!(!simplify("demo_high.glb", "packed.glb", &[]));
}

/// Protects scripts: one sentence that names the culprit, the right exit code, and
/// nothing left behind.
#[test]
fn mistakes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    fs::write(folder.join("bad.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n").unwrap();
    fs::write(folder.join("bare.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let far = "v 900 0 0\nv 901 0 0\nv 900 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    fs::write(folder.join("far.obj"), far).unwrap();
    fs::write(folder.join("typo.json"), r#"{"texture_sise": 64}"#).unwrap();
    let pair = |a: &'static str, b: &'static str| vec!["bake", a, b, "-o", "never.glb"];
    let good = || pair("demo_high.glb", "demo_low.glb");
    let with = |more: &[&'static str]| [&good()[..], more].concat();
    let cases = [
        (pair("nothing.obj", "demo_low.glb"), 1, "nothing.obj"),
        (pair("bad.obj", "demo_low.glb"), 1, "bad.obj, line 3"),
        ([&pair("demo_high.glb", "bare.obj")[..], &["--uv", "keep"]].concat(), 1, "no texture coordinates"),
        (with(&["--texture-size", "3"]), 2, "16 to 8192"),
        (with(&["--texture-quality", "50"]), 2, "does nothing with a lossless --texture-format"),
        (with(&["--options", "typo.json"]), 2, "texture_sise"),
        (with(&["--no-such-option"]), 2, "--no-such-option"),
        (vec!["bake", "demo_high.glb", "demo_low.glb", "-o", "never.fbx"], 2, ".glb or .obj"),
        (vec!["bake", "demo_high.glb", "demo_low.glb", "-o", "nowhere/never.glb"], 2, "nowhere"),
        (vec!["bake", "demo_high.glb", "demo_low.glb", "-o", "demo_low.glb"], 2, "overwrite"),
        (vec!["simplify", "bad.obj", "-o", "./bad.obj"], 2, "overwrite"),
        (
            vec!["simplify", "demo_high.glb", "-o", "never.glb", "--subdivide", "1", "--closest-in", "shape"],
            2,
            "--closest-in",
        ),
        (with(&["--json", "nowhere/never.json"]), 2, "nowhere"),
        (with(&["--json", "never.glb"]), 2, "two outputs"),
        (with(&["--no-comparison", "--report", "never.html"]), 2, "--report"),
        (with(&["--threads", "99999"]), 2, "0 to 256"),
        (with(&["--max-distance", "-1"]), 2, "0 to 1"),
        ([&pair("demo_high.glb", "far.obj")[..], &SMALL].concat(), 1, "outside of every view"),
        (vec!["eval", "demo_high.glb", "demo_low.glb", "--background", "1,red,0"], 2, "R,G,B"),
    ];
    for (arguments, code, words) in cases {
        let output = parbake(folder).args(&arguments).output().unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(words) && said.contains("error: "), "{arguments:?}: {said}");
        assert!(!said.contains("panicked"), "{said}");
    }
    let left = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    assert!(left.into_iter().all(|name| !name.contains("never")), "nothing half done is left");
}

/// Protects pipelines with a deadline: a budget that is spent at once still gives a
/// whole model, the projection.
#[test]
fn a_spent_budget_gives_the_projection() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let arguments = ["bake", "demo_high.glb", "demo_low.glb", "-o", "a.glb", "--texture-size", "64"];
    run(folder, &[&arguments[..], &["--time-budget", "0", "--json", "a.json"]].concat());
    let report = json(&folder.join("a.json"));
    assert_eq!(report["stopped_early"], true);
    // The comparison is made all the same.
    assert!(report["comparison"]["backgrounds"].is_array());
    run(folder, &["simplify", "a.glb", "-o", "b.glb", "--triangles", "100"]);
}

/// Protects who bakes thousands of props: the comparison at the end can be left out, and then nothing claims figures.
#[test]
fn a_comparison_may_be_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let bake = ["bake", "demo_high.glb", "demo_low.glb", "-o", "a.glb", "--json", "a.json"];
    let said = text(&run(folder, &[&bake[..], &SMALL, &PLAIN].concat()).stderr);
    assert!(said.lines().any(|line| line.starts_with("a.glb: ")) && !said.contains("dB"), "{said}");
    assert!(json(&folder.join("a.json"))["comparison"].is_null());
    let compress =
        ["compress", "a.glb", "-o", "b.glb", "--preset", "fast", "--texture-size", "32", "--uv", "repair"];
    let printed = text(&run(folder, &[&compress[..], &["--no-comparison"]].concat()).stdout);
    assert!(printed.starts_with("b.glb: ") && !printed.contains("dB"), "{printed}");
}

/// Protects people who lose patience: Ctrl-C writes the best state so far.
#[cfg(unix)]
#[test]
fn an_interrupt_writes_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let mut child = parbake(folder)
        .args(["bake", "demo_high.glb", "demo_low.glb", "-o", "a.glb", "-q"])
        .args(["--rounds", "100", "--views", "64", "--json", "a.json", "--no-comparison"])
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(1500));
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(fs::read(folder.join("a.glb")).unwrap()[..4], *b"glTF");
    assert_eq!(json(&folder.join("a.json"))["stopped_early"], true);
}

/// Protects other tools' users: OBJ out is read again, with the same look.
#[test]
fn obj_and_glb_look_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    for name in ["a.glb", "a.obj"] {
        let arguments = ["bake", "demo_high.glb", "demo_low.glb", "-q", "-o", name];
        run(folder, &[&arguments[..], &SMALL, &PLAIN].concat());
    }
    let same = crate::common::psnr(folder, "a.glb".as_ref(), "a.obj".as_ref());
    assert!(same > 60.0, "{same} dB");
}

/// Protects who compares models: a page besides the figures, which go where they went before, and views that have one number in both.
#[test]
fn eval_writes_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let small = ["--views", "3", "--resolution", "32", "--no-flip", "--report", "page.html"];
    let eval = |more: &[&str]| {
        text(&run(folder, &[&["eval", "demo_high.glb", "demo_low.glb"][..], &small, more].concat()).stdout)
    };
    let table = eval(&["--per-view"]);
    let psnr = |view: usize| {
        let row = table.lines().find(|line| line.trim_start().starts_with(&format!("{view} "))).unwrap();
        row.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap()
    };
    let page = fs::read_to_string(folder.join("page.html")).unwrap();
    for view in 1..=3 {
        assert!(page.contains(&format!("view {view}: {:.2} dB", psnr(view))), "{table}");
    }
    fs::remove_file(folder.join("page.html")).unwrap();
    let figures: serde_json::Value = serde_json::from_str(&eval(&["--json", "-"])).unwrap();
    assert_eq!(figures["views"].as_array().unwrap().len(), 3);
    assert!(folder.join("page.html").exists());
}
