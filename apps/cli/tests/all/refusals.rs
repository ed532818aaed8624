//! What the command says before it works: help in groups, and one sentence for each wrong usage.

use crate::common::{PLAIN, SMALL, demo_pair, json, parbake, run, text};
use parbake::{Limits, read_model};
use std::fs;
use std::path::Path;

/// Exit code and error of a command.
fn refusal(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = parbake(folder).args(arguments).output().unwrap();
    (output.status.code(), text(&output.stderr))
}

/// The options under each heading of a command's help: (heading, lines below it).
fn groups(command: &str) -> Vec<(String, String)> {
    let folder = tempfile::tempdir().unwrap();
    let help = text(&run(folder.path(), &[command, "-h"]).stdout);
    let mut groups: Vec<(String, String)> = Vec::new();
    for line in help.lines() {
        match line.strip_suffix(':') {
            Some(heading) if !line.starts_with(' ') => groups.push((heading.into(), String::new())),
            _ => {
                if let Some((_, below)) = groups.last_mut() {
                    *below += &format!("{line}\n");
                }
            }
        }
    }
    groups
}

fn group(groups: &[(String, String)], heading: &str) -> String {
    let found = groups.iter().find(|(name, _)| name == heading);
    found.unwrap_or_else(|| panic!("no heading {heading}")).1.clone()
}

/// Protects services: with `--confine` a model cannot make any command read a file outside its folder.
#[test]
fn confined_commands_refuse_files_outside() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("in");
    fs::create_dir(&inside).unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl a\n").unwrap();
    let obj = "mtllib ../a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n";
    fs::write(inside.join("m.obj"), obj).unwrap();
    run(folder.path(), &["check", "in/m.obj"]);
    for command in [
        &["check", "in/m.obj"][..],
        &["bake", "in/m.obj", "in/m.obj"],
        &["raycast", "in/m.obj", "in/m.obj"],
        &["compress", "in/m.obj"],
        &["eval", "in/m.obj", "in/m.obj"],
        &["variants", "in/m.obj", "in/m.obj"],
        &["turntable", "in/m.obj", "in/m.obj"],
        &["simplify", "in/m.obj", "-o", "s.glb"],
    ] {
        let (code, error) = refusal(folder.path(), &[command, &["--confine"]].concat());
        assert!(code == Some(1) && error.contains("outside the model's folder"), "{command:?}: {error}");
    }
}

/// Protects people who choose options: each is in its group, in one order, and research switches stand
/// apart.
#[test]
fn help_of_bake_has_groups() {
    let groups = groups("bake");
    let headings: Vec<&str> = groups.iter().map(|(name, _)| name.as_str()).collect();
    let wanted = ["Input and output", "Quality", "UV", "Shape", "Parallax", "Advanced", "Research"];
    let found: Vec<&str> = headings.iter().copied().filter(|name| wanted.contains(name)).collect();
    assert_eq!(found, wanted, "{headings:?}");
    for (heading, options) in [
        ("Input and output", &["--output", "--options", "--json", "--report", "--strict", "--quiet"][..]),
        ("Quality", &["--texture-size", "--preset", "--time-budget"]),
        ("UV", &["--uv", "--gutter", "--uv-steps"]),
        ("Shape", &["--shape", "--silhouette"]),
        ("Parallax", &["--parallax", "--cutout-size", "--no-cutout"]),
        ("Advanced", &["--normal-y", "--seed", "--threads"]),
        ("Research", &["--method", "--no-content-aware", "--robust-scale"]),
    ] {
        let below = group(&groups, heading);
        for option in options {
            assert!(
                below.contains(&format!("{option} ")) || below.contains(&format!("{option}\n")),
                "{option}"
            );
        }
    }
    let all: String = groups.iter().map(|(_, below)| below.as_str()).collect();
    assert!(!all.contains("tutte") && !all.contains("laplacian"), "research values are not offered: {all}");
    assert!(!all.contains("--more-triangles"), "it acts in compress only");
}

/// Protects users of `compress` and `image` from options that do nothing there.
#[test]
fn help_shows_what_acts() {
    let groups_of_compress = groups("compress");
    let all: String = groups_of_compress.iter().map(|(_, below)| below.as_str()).collect();
    for absent in
        ["--shape", "--parallax", "--cutout", "--silhouette", "--silhouette-background", "--max-distance"]
    {
        assert!(!all.contains(absent), "{absent}");
    }
    assert!(group(&groups_of_compress, "UV").contains("--more-triangles"));
    assert!(group(&groups_of_compress, "Models with more than colour").contains("--views"));
    assert!(group(&groups("image"), "Research").contains("--method"));
}

/// Protects from options without effect: each is named, with what to do, before any file is read.
#[test]
fn options_without_effect_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("maps.json"), r#"{"parallax_size": 32}"#).unwrap();
    fs::write(folder.join("shape.json"), r#"{"shape": "keep"}"#).unwrap();
    let bake = ["bake", "high.glb", "low.glb", "-o", "never.glb"];
    let compress = ["compress", "model.glb", "-o", "never.glb"];
    let image = ["image", "picture.png", "-o", "never.glb"];
    let lod = ["lod", "model.glb", "-o", "never"];
    let eval = ["eval", "high.glb", "low.glb"];
    let raycast = ["raycast", "high.glb", "low.glb", "-o", "never.glb"];
    let cases: [(&[&str], &[&str], &str); 35] = [
        (&bake, &["--uv", "keep", "--gutter", "2"], "--gutter does nothing with --uv keep"),
        (
            &bake,
            &["--shading", "pbr", "--robust-scale", "1"],
            "--robust-scale does nothing with --shading pbr",
        ),
        (&bake, &["--shading", "pbr", "--silhouette", "1"], "--silhouette does nothing with --shading pbr"),
        (&raycast, &["--uv", "keep", "--gutter", "2"], "--gutter does nothing with --uv keep"),
        (&["stats", "model.glb"], &["--samples", "100"], "--samples does nothing without --against"),
        (
            &["simplify", "model.glb", "-o", "never.glb"],
            &["--texture-quality", "20"],
            "--texture-quality does nothing with a lossless",
        ),
        (&["demo"], &["--keep-parts", "x"], "--keep-parts does nothing in demo"),
        (&bake, &["--keep-parts", "x"], "give --triangles instead of LOW"),
        (
            &compress,
            &["--uv", "repair", "--more-triangles", "3"],
            "--more-triangles does nothing without --uv optimize",
        ),
        (&bake, &["--rounds", "0", "--keep-normals"], "--keep-normals does nothing with --rounds 0"),
        (&lod, &["--texture-quality", "50"], "--texture-quality does nothing with a lossless"),
        (&eval, &["--ortho", "1", "--fov", "40"], "--fov does nothing with --ortho"),
        (&bake, &["--gutter", "x"], "--gutter cannot be x: give a number, such as 0.5"),
        (&bake, &["--parallax-order", "2"], "--parallax-order does nothing without --parallax"),
        (&bake, &["--parallax-size", "64"], "--parallax-size does nothing without --parallax"),
        (&bake, &["--no-cutout"], "--no-cutout does nothing without --parallax"),
        (&bake, &["--cutout-order", "3"], "--cutout-order does nothing without --parallax"),
        (&bake, &["--cutout-size", "32"], "--cutout-size does nothing without --parallax"),
        (&bake, &["--options", "maps.json"], "maps.json: --parallax-size does nothing"),
        (&bake, &["--parallax", "sh", "--no-cutout", "--cutout-size", "32"], "with --no-cutout"),
        (&bake, &["--parallax", "sh", "--method", "paper", "--cutout-size", "32"], "with --method paper"),
        (&bake, &["--no-content-aware"], "without --method paper"),
        (&bake, &["--port", "8000"], "--port does nothing without --watch"),
        (&bake, &["--no-open"], "--no-open does nothing without --watch"),
        (&bake, &["--uv", "keep", "--uv-steps", "3"], "without --uv optimize"),
        (
            &bake,
            &["--silhouette", "0", "--silhouette-background", "white"],
            "--silhouette-background does nothing with --silhouette 0; leave one of the two out",
        ),
        (&bake, &["--more-triangles", "3"], "acts in compress only"),
        (&compress, &["--shape", "free"], "--shape does nothing in compress"),
        (&compress, &["--silhouette", "1"], "--silhouette does nothing in compress"),
        (&compress, &["--parallax", "sh"], "--parallax does nothing in compress"),
        (&compress, &["--options", "shape.json"], "shape.json: --shape does nothing in compress"),
        (&image, &["--uv", "keep", "--steps", "3"], "--steps does nothing with --uv keep"),
        (&image, &["--uv", "keep", "--animation", "a.gif"], "--animation does nothing with --uv keep"),
        (&image, &["--no-content-aware"], "without --method paper"),
        (&image, &["--shape", "keep"], "--shape"),
    ];
    for (command, more, words) in cases {
        let (code, said) = refusal(folder, &[command, more].concat());
        assert_eq!(code, Some(2), "{more:?}: {said}");
        assert!(said.starts_with("error: ") && said.contains(words), "{more:?}: {said}");
    }
}

/// Protects from a parser's words: names, sizes and options files are answered with sentences.
#[test]
fn wrong_values_get_sentences() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    fs::write(folder.join("text.json"), "texture_size = 64").unwrap();
    fs::write(folder.join("empty.json"), "").unwrap();
    fs::write(folder.join("run.sh"), "echo a\necho b\n").unwrap();
    let bake = |more: &[&'static str]| {
        [&["bake", "demo_high.glb", "demo_low.glb", "-o", "never.glb"][..], more].concat()
    };
    for (arguments, words) in [
        (vec!["bake", "-", "demo_low.glb", "-o", "never.glb"], "standard input is not supported"),
        (vec!["compress", "-", "-o", "never.glb"], "standard input is not supported"),
        (vec!["image", "-", "-o", "never.glb"], "standard input is not supported"),
        (vec!["eval", "demo_high.glb", "-"], "standard input is not supported"),
        (bake(&["--options", "-"]), "standard input is not supported"),
        (bake(&["--report", "-"]), "cannot go to standard output"),
        (vec!["lod", "demo_high.glb", "-o", "-"], "several files cannot go to standard output"),
        (vec!["demo", "-o", "-"], "several files cannot go to standard output"),
        (bake(&["--texture-size", "huge"]), "such as 512, or 1k"),
        (bake(&["--texture-size", "16k"]), "16 to 8192"),
        (bake(&["--options", "text.json"]), "text.json: line 1, column 2: this is not JSON"),
        (bake(&["--options", "empty.json"]), "empty.json: the file is empty; expected a JSON object"),
        (
            bake(&["--options", "demo_high.glb"]),
            "demo_high.glb: this is not a text file; expected a JSON object",
        ),
        (vec!["bake", "demo_high.glb"], "give LOW, or --triangles COUNT, which makes one of HIGH"),
        (vec!["check", "demo_low.glb", "--gutter", "-1"], "--gutter cannot be -1: it may be 0 or more"),
        (bake(&["--importance", "foo=2", "--texture-size", "16"]), "--importance cannot be foo: it may be"),
        (bake(&["--rounds", "-1"]), "give 0 or more"),
        (vec!["batch", "run.sh"], "line 1, column 6: "),
    ] {
        let (code, said) = refusal(folder, &arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
}

/// Protects minutes of work: a place that cannot be written, and a time budget that cannot hold, are found
/// before the models are read.
#[test]
fn outputs_are_checked_first() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("taken.glb")).unwrap();
    fs::create_dir(folder.join("taken.html")).unwrap();
    fs::create_dir(folder.join("beside_base_color.png")).unwrap();
    let bake = |output: &'static str, more: &[&'static str]| {
        [&["bake", "missing.glb", "missing.glb", "-o", output][..], more].concat()
    };
    for (arguments, words) in [
        (bake("taken.glb", &[]), "this is a folder"),
        (bake("nowhere/a.glb", &[]), "there is no folder nowhere"),
        (bake("a.fbx", &[]), ".glb or .obj"),
        (bake("beside.obj", &[]), "the folder beside_base_color.png has the name of a file that is written"),
        (bake("a.glb", &["--report", "taken.html"]), "this is a folder"),
        (bake("a.glb", &["--report", "a.pdf"]), ".html or .htm"),
        (bake("a.glb", &["--report", "nowhere/a.html"]), "there is no folder nowhere"),
        (bake("a.glb", &["--json", "a.txt"]), ".json"),
        (bake("a.glb", &["--json", "nowhere/a.json"]), "there is no folder nowhere"),
        (vec!["compress", "missing.glb", "-o", "a.glb", "--report", "nowhere/a.html"], "no folder"),
        (vec!["eval", "missing.glb", "missing.glb", "--json", "nowhere/a.json"], "no folder"),
        (vec!["image", "missing.png", "-o", "a.glb", "--animation", "a.mp4"], "must end in .gif"),
        (bake("a.glb", &["--texture-size", "8k", "--time-budget", "10"]), "94 s"),
    ] {
        let (code, said) = refusal(folder, &arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
    if cfg!(target_os = "linux") {
        // A folder that takes no file from anybody, root included.
        let (code, said) = refusal(folder, &bake("/proc/a.glb", &[]));
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains("nothing can be written to this folder"), "{said}");
    }
    assert_eq!(fs::read_dir(folder).unwrap().count(), 3, "nothing is left behind");
}

/// Protects artists' only copies: what an input names is not written over, neither a material file nor a picture.
#[test]
fn files_of_inputs_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";
    fs::write(folder.join("look.mtl"), "newmtl m\nmap_Kd w_base_color.png\nmap_Ke v_occlusion.png\n")
        .unwrap();
    fs::write(folder.join("high.obj"), format!("mtllib look.mtl\n{square}")).unwrap();
    for name in ["w_base_color.png", "v_occlusion.png"] {
        fs::write(folder.join(name), name).unwrap();
    }
    let pair = ["high.obj", "high.obj", "-o"];
    for (command, output, more, file) in [
        ("bake", "look.obj", &[][..], "look.mtl"),
        ("bake", "w.obj", &[], "w_base_color.png"),
        ("raycast", "v.glb", &["--maps", "occlusion"], "v_occlusion.png"),
    ] {
        let (code, said) = refusal(folder, &[&[command][..], &pair, &[output], more].concat());
        let wanted = format!("this would overwrite {file}, which high.obj names; choose another name");
        assert!(code == Some(2) && said.contains(&wanted), "{command} {output}: {said}");
    }
    assert_eq!(fs::read(folder.join("w_base_color.png")).unwrap(), b"w_base_color.png");
}

/// Protects pipelines from grey models: with `--strict` a missing texture is an error, else a warning.
#[test]
fn strict_wants_all_textures() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    fs::write(folder.join("high.mtl"), "newmtl m\nmap_Kd lost.png\n").unwrap();
    let high = format!("mtllib high.mtl\n{square}usemtl m\nf 1/1 2/2 3/3 4/4\n");
    fs::write(folder.join("high.obj"), high).unwrap();
    fs::write(folder.join("low.obj"), format!("{square}f 1/1 2/2 3/3 4/4\n")).unwrap();
    let bake = [&["bake", "high.obj", "low.obj", "-o", "a.glb"][..], &SMALL].concat();
    let compress = ["compress", "high.obj", "-o", "b.glb", "--texture-size", "16"];
    assert_eq!(refusal(folder, &bake).0, Some(0));
    fs::remove_file(folder.join("a.glb")).unwrap();
    for command in [&bake[..], &compress] {
        let (code, said) = refusal(folder, &[command, &["--strict"]].concat());
        assert_eq!(code, Some(1), "{said}");
        let error = said.lines().find(|line| line.starts_with("error: ")).unwrap();
        assert!(error.contains("lost.png") && error.contains("--strict"), "{said}");
    }
    fs::remove_file(folder.join("high.mtl")).unwrap();
    let (code, said) = refusal(folder, &[&bake[..], &["--strict"]].concat());
    assert!(code == Some(1) && said.contains("high.mtl"), "a missing material library: {said}");
    assert!(!folder.join("a.glb").exists() && !folder.join("b.glb").exists());
}

/// Protects engines with −Y: the green channel of the written normal map is inverted, the material says
/// so, and nothing else changes.
#[test]
fn normal_maps_can_point_down() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let bake = |name: &str, direction: &str| {
        let arguments = ["bake", "demo_high.glb", "demo_low.glb", "-q", "-o", name, "--json", "a.json"];
        run(folder, &[&arguments[..], &SMALL, &PLAIN, &["--normal-y", direction]].concat());
        assert_eq!(json(&folder.join("a.json"))["options"]["normal_y"], direction);
        read_model(&folder.join(name), &Limits::default()).unwrap().model
    };
    let (up, down) = (bake("up.glb", "up"), bake("down.glb", "down"));
    let slot = |model: &parbake::Model| model.materials[0].normal_texture.unwrap().image;
    let (a, b) = (&up.images[slot(&up)].pixels, &down.images[slot(&down)].pixels);
    assert!(a.iter().zip(b).all(|(a, b)| [a[0], 255 - a[1], a[2], a[3]] == *b));
    assert!(down.materials[0].name.contains("-Y") && !up.materials[0].name.contains("-Y"));
    let base = |model: &parbake::Model| model.materials[0].base_color_texture.unwrap().image;
    assert!(up.images[base(&up)].pixels == down.images[base(&down)].pixels);
}
