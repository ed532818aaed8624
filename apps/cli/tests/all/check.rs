//! `parbake check` as scripts and people meet it.

use crate::common::{SMALL, demo_pair, json, parbake, run, text};
use std::fs;
use std::path::Path;

/// Two squares of two triangles in a row, the second one's place in the texture given
/// by the shift along u; both are a quarter of the texture wide.
fn two_squares(folder: &Path, name: &str, shift: f64) {
    let mut obj = String::new();
    for (x, u) in [(0.0, 0.125), (2.0, 0.125 + shift)] {
        for (a, b) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            obj += &format!("v {} {b} 0\nvt {} {}\n", x + a, u + 0.25 * a, 0.25 + 0.25 * b);
        }
    }
    obj += "f 1/1 2/2 3/3 4/4\nf 5/5 6/6 7/7 8/8\n";
    fs::write(folder.join(name), obj).unwrap();
}

/// Runs `check` with these arguments: the exit code, and what it printed.
fn check(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = parbake(folder).arg("check").args(arguments).output().unwrap();
    let said = text(&output.stderr);
    assert!(!said.contains("panicked"), "{said}");
    (output.status.code().unwrap(), text(&output.stdout) + &said)
}

/// Protects the proof of a sound model: exit code 0, a table for people, figures for
/// scripts.
#[test]
fn a_sound_model_passes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let (code, table) = check(folder, &["demo_low.glb", "--texture-size", "512", "--json", "low.json"]);
    assert_eq!(code, 0, "{table}");
    for row in ["triangles", "charts", "utilisation", "area scale", "anisotropy"] {
        assert!(table.contains(row), "{table}");
    }
    assert!(table.ends_with("\nsound\n"), "{table}");
    let figures = json(&folder.join("low.json"));
    assert_eq!(figures["sound"], true);
    assert_eq!(figures["layouts"][0]["uv"]["texture_size"], 512);
    assert_eq!(check(folder, &["demo_low.glb", "-q"]), (0, String::new()));
    let (_, printed) = check(folder, &["demo_low.glb", "--json", "-", "-q"]);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&printed).unwrap()["sound"], true);
}

/// Protects continuous integration from layouts that are not sound: exit code 3, and
/// the problem in words; a gutter counts only where it is asked for.
#[test]
fn problems_are_told_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // 8 of 64 texels between the squares, and half of one square on the other one.
    two_squares(folder, "apart.obj", 0.375);
    two_squares(folder, "over.obj", 0.125);
    fs::write(folder.join("bare.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let size =
        |model, more: &[&'static str]| check(folder, &[&[model, "--texture-size", "64"][..], more].concat());
    let (code, said) = size("apart.obj", &[]);
    assert!(code == 0 && said.contains("gutter       8.00 texels at 64 × 64"), "{said}");
    assert_eq!(size("apart.obj", &["--gutter", "8"]).0, 0);
    let (code, said) = size("apart.obj", &["--gutter", "9"]);
    assert!(code == 3 && said.contains("8.00 texels apart"), "{said}");
    let (code, said) = size("over.obj", &["--json", "over.json"]);
    assert!(code == 3 && said.contains("128.0 texels in all") && said.contains("not sound"), "{said}");
    let figures = json(&folder.join("over.json"));
    assert_eq!(figures["layouts"][0]["uv"]["overlaps"]["texels"], 128.0);
    let (code, said) = size("over.obj", &["-q"]);
    assert!(code == 3 && said.lines().count() == 1, "{said}");
    let (code, said) = size("bare.obj", &[]);
    assert!(code == 3 && said.contains("no texture coordinates"), "{said}");
}

/// Protects scripts from taking a mistake for a verdict.
#[test]
fn mistakes_have_other_codes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    two_squares(folder, "a.obj", 0.375);
    for (arguments, code, words) in [
        (&["nothing.glb"][..], 1, "nothing.glb"),
        (&["a.obj", "--texture-size", "0"], 2, "1 to 65536"),
        (&["a.obj", "--gutter=-1"], 2, "0 or more"),
        (&["a.obj", "--gutter", "nan"], 2, "0 or more"),
        (&["a.obj", "--json", "a.obj"], 2, "overwrite"),
    ] {
        let (found, said) = check(folder, arguments);
        assert!(found == code && said.contains(words), "{arguments:?}: {found} {said}");
    }
}

/// Protects the bake's own proof: it stands in the report, and the user is warned of a
/// layout that is not sound.
#[test]
fn a_bake_proves_its_layout() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    two_squares(folder, "over.obj", 0.125);
    let bake = |high: &str, low: &str, name: &str| {
        let json = format!("{name}.json");
        let output = format!("{name}.glb");
        let arguments = ["bake", high, low, "-o", &output, "--json", &json, "--uv", "keep"];
        text(&run(folder, &[&arguments[..], &SMALL, &["--no-comparison"]].concat()).stderr)
    };
    let said = bake("demo_high.glb", "demo_low.glb", "good");
    assert!(!said.contains("one to one"), "{said}");
    let good = json(&folder.join("good.json"));
    assert_eq!(good["uv"]["overlaps"]["pairs"], 0);
    assert_eq!(good["uv"]["texture_size"], 64);
    let said = bake("over.obj", "over.obj", "bad");
    assert!(said.contains("not one to one") && said.contains("overlap"), "{said}");
    assert_eq!(json(&folder.join("bad.json"))["uv"]["overlaps"]["texels"], 128.0);
    assert_eq!(check(folder, &["good.glb"]).0, 0);
    assert_eq!(check(folder, &["bad.glb"]).0, 3);
}
