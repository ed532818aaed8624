//! `parbake stats` as scripts and people meet it.

use crate::common::{demo_pair, json, parbake, run, text};
use std::fs;
use std::path::Path;

/// A cube of side 2 without its top, of five squares that share no vertices.
fn open_box(folder: &Path, name: &str, shift: f64) {
    let faces = [
        [(0, 0, 0), (0, 2, 0), (2, 2, 0), (2, 0, 0)],
        [(0, 0, 0), (2, 0, 0), (2, 0, 2), (0, 0, 2)],
        [(2, 0, 0), (2, 2, 0), (2, 2, 2), (2, 0, 2)],
        [(2, 2, 0), (0, 2, 0), (0, 2, 2), (2, 2, 2)],
        [(0, 2, 0), (0, 0, 0), (0, 0, 2), (0, 2, 2)],
    ];
    let mut obj = String::new();
    for (i, face) in faces.iter().enumerate() {
        for (x, y, z) in face {
            obj += &format!("v {x} {y} {}\n", f64::from(*z) + shift);
        }
        obj += &format!("f {0} {1} {2} {3}\n", 4 * i + 1, 4 * i + 2, 4 * i + 3, 4 * i + 4);
    }
    fs::write(folder.join(name), obj).unwrap();
}

/// The cells of the row with this name.
fn cells<'a>(table: &'a str, name: &str) -> Vec<&'a str> {
    let row = table.lines().find_map(|line| line.trim_start().strip_prefix(name));
    row.unwrap_or_else(|| panic!("{name}: {table}")).split_whitespace().collect()
}

/// Protects the table and the distance: a box that is open above, and the same moved up by half a unit, so that its
/// floor is 0.5 above the other's and its rim too.
#[test]
fn two_boxes_are_measured() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    open_box(folder, "a.obj", 0.0);
    open_box(folder, "b.obj", 0.5);
    let out = run(folder, &["stats", "a.obj", "--against", "b.obj", "--json", "s.json"]);
    let table = text(&out.stdout);
    assert_eq!(cells(&table, "components"), ["1", "1"]);
    assert_eq!(cells(&table, "holes (boundary loops)"), ["1", "1"]);
    assert_eq!(cells(&table, "manifold"), ["yes", "yes"]);
    assert_eq!(cells(&table, "genus"), ["0", "0"]);
    assert_eq!(cells(&table, "area"), ["20", "20"]);
    assert_eq!(cells(&table, "volume of closed components"), ["-", "-"]);
    assert_eq!(cells(&table, "draw calls"), ["1", "1"]);
    let found = json(&folder.join("s.json"));
    let distance = &found["distance"];
    let close = |name: &str, want: f64| {
        let value = distance[name].as_f64().unwrap();
        assert!((value - want).abs() < 2e-3, "{name}: {value}, not {want}");
    };
    close("hausdorff", 0.5);
    close("diagonal", 12f64.sqrt());
    // Of each box a band of 0.5 of the walls is away by 0.25 in the mean. The lower floor is away by 0.5; the upper one
    // is nearer to the lower box's walls where it is less than 0.5 from its own border.
    let (lower, upper) = ((4.0 * 0.5 + 4.0 * 0.25) / 20.0, (4.0 * (0.125 + 1.0 / 6.0) + 4.0 * 0.25) / 20.0);
    close("chamfer", 0.5 * (lower + upper));
    assert_eq!(found["model"]["topology"]["vertices"], 8);
    assert_eq!(found["model"]["file"]["bytes"], fs::metadata(folder.join("a.obj")).unwrap().len());
    let again = run(folder, &["stats", "a.obj", "--against", "b.obj", "--json", "-", "--threads", "1"]);
    let again: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["distance"], found["distance"]);
}

/// Protects the figures of textures: name, format and bytes as the file has them, and what a card takes.
#[test]
fn textures_are_counted_as_they_are_stored() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    run(folder, &["stats", "demo_high.glb", "--json", "s.json", "-q"]);
    let found = json(&folder.join("s.json"));
    let textures = found["model"]["file"]["textures"].as_array().unwrap();
    assert!(!textures.is_empty());
    for texture in textures {
        let [width, height] = ["width", "height"].map(|side| texture[side].as_u64().unwrap());
        let whole = 4 * width * height;
        let gpu = texture["gpu_bytes"].as_u64().unwrap();
        assert!(gpu > whole && 3 * gpu < 4 * whole + 200, "{texture}");
        assert!(texture["bytes"].as_u64().unwrap() < whole, "{texture}");
        assert_eq!(texture["format"], "png");
    }
    assert!(found["model"]["layouts"][0]["texel_density"]["mean"].as_f64().unwrap() > 0.0);
    assert!(found["against"].is_null() && found["distance"].is_null());
}

/// Protects scripts: what is wrong has its exit code and a sentence.
#[test]
fn mistakes_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    open_box(folder, "a.obj", 0.0);
    for (arguments, code, words) in [
        (&["stats", "nothing.glb"][..], 1, "nothing.glb"),
        (&["stats", "a.obj", "--against", "nothing.glb"], 1, "nothing.glb"),
        (&["stats", "a.obj", "--against", "a.obj", "--samples", "1"], 2, "1000 to 100000000"),
        (&["stats", "a.obj", "--json", "a.obj"], 2, "overwrite"),
    ] {
        let out = parbake(folder).args(arguments).output().unwrap();
        let said = text(&out.stderr);
        assert!(out.status.code() == Some(code) && said.contains(words), "{arguments:?}: {said}");
    }
}
