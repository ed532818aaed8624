//! `parbake reproduce` on a folder of data as a user might have it.

use crate::common::{demo_pair, json, parbake, text};
use std::path::Path;
use std::process::Output;

/// A model with one level in a layout of one's own, and a picture.
fn data(folder: &Path) {
    let pair = folder.join("data/pairs/my_jar");
    std::fs::create_dir_all(pair.join("high")).unwrap();
    std::fs::create_dir_all(pair.join("lod3")).unwrap();
    std::fs::create_dir_all(folder.join("data/images2d")).unwrap();
    demo_pair(folder);
    let high = parbake::simplified(&parbake::demo_pair().0, 400);
    parbake::write_glb(&pair.join("high/jar.glb"), &high).unwrap();
    std::fs::rename(folder.join("demo_low.glb"), pair.join("lod3/jar.glb")).unwrap();
    picture(folder, 3);
}

fn picture(folder: &Path, factor: usize) {
    let pixel = |i: usize| {
        [(i % 96 * factor) as u8, (i / 96) as u8, ((i % 96 / 8 + i / 96 / 8) % 2 * 200) as u8, 255]
    };
    let image = parbake::Picture {
        name: "p".into(),
        width: 96,
        height: 96,
        pixels: (0..96 * 96).map(pixel).collect(),
    };
    std::fs::write(folder.join("data/images2d/checks.png"), parbake::encode_png(&image).unwrap()).unwrap();
}

fn reproduce(folder: &Path, more: &[&str]) -> Output {
    let arguments =
        ["reproduce", "data", "-o", "out", "--quick", "--views", "3", "--resolution", "64", "--only"];
    parbake(folder).args(arguments).args(["table6,table7,figure9"]).args(more).output().unwrap()
}

/// Protects the promise of the command: tables and page come out of a user's own folder, a second
/// run takes what is there, and what changed is made anew.
#[test]
fn a_users_folder_is_run_once() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    data(folder);
    let first = reproduce(folder, &[]);
    assert!(first.status.success(), "{}", text(&first.stderr));
    assert!(text(&first.stderr).contains("5 made, 0 kept"), "{}", text(&first.stderr));
    for part in ["my_jar, 128²", "checks", "Table 6", "Table 7"] {
        assert!(text(&first.stdout).contains(part), "{part}: {}", text(&first.stdout));
    }
    let page = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(page.contains("Figure 9") && page.contains("<svg") && !page.contains("NaN"));
    assert!(std::fs::read_to_string(folder.join("out/tables.md")).unwrap().contains("| my_jar, 128² |"));
    let second = reproduce(folder, &[]);
    assert!(text(&second.stderr).contains("0 made, 5 kept"), "{}", text(&second.stderr));
    assert_eq!(first.stdout, second.stdout);
    picture(folder, 2);
    let third = reproduce(folder, &[]);
    assert!(text(&third.stderr).contains("3 made, 2 kept"), "{}", text(&third.stderr));
}

/// Protects quality: a gain below the record ends with exit code 4 and names what fell.
#[test]
fn the_guard_sees_a_fall() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    data(folder);
    // Pictures alone have gains as well.
    std::fs::remove_dir_all(folder.join("data/pairs")).unwrap();
    let record = ["--record", "record.json"];
    let written = reproduce(folder, &[&record[..], &["--update-record"]].concat());
    assert!(written.status.success(), "{}", text(&written.stderr));
    assert_eq!(reproduce(folder, &record).status.code(), Some(0));
    let mut gains = json(&folder.join("record.json"));
    let name = "checks picture 64 UV";
    gains[name] = (gains[name].as_f64().unwrap() + 0.5).into();
    gains["a model that is not here"] = 1.0.into();
    std::fs::write(folder.join("record.json"), gains.to_string()).unwrap();
    let fallen = reproduce(folder, &record);
    assert_eq!(fallen.status.code(), Some(4));
    assert!(text(&fallen.stderr).contains(name), "{}", text(&fallen.stderr));
    assert!(text(&fallen.stderr).contains("1 gain fell"), "{}", text(&fallen.stderr));
}

/// Protects from hours of work for nothing: what is wrong is said at once, with exit codes that
/// scripts can act on.
#[test]
fn mistakes_are_told_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("empty")).unwrap();
    for (arguments, code, part) in [
        (&["reproduce", "empty"][..], 1, "nothing to reproduce"),
        (&["reproduce", "nowhere"], 1, "nowhere"),
        (&["reproduce", "empty", "--views", "0"], 2, "views"),
        (&["reproduce", "empty", "--record", "none.json"], 1, "none.json"),
        (&["reproduce", "empty", "--update-record"], 2, "--update-record does nothing without --record"),
        (&["reproduce"], 2, "PARBAKE_DATA"),
    ] {
        let output = parbake(folder).args(arguments).env_remove("PARBAKE_DATA").output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", text(&output.stderr));
        assert!(text(&output.stderr).contains(part), "{arguments:?}: {}", text(&output.stderr));
    }
}

/// Protects Figure 14: a model with roughness as a texture is found in its folder, one without is passed over, and
/// the fit of all maps is ahead of the fit without them under random lights.
#[test]
fn further_maps_are_shown_under_random_lights() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut high = parbake::simplified(&parbake::demo_pair().0, 400);
    let place = |name: &str| {
        let place = folder.join("data/pbr").join(name);
        std::fs::create_dir_all(&place).unwrap();
        place.join("jar.glb")
    };
    parbake::write_glb(&place("a_plain"), &high).unwrap();
    let stripes = (0..64).map(|i| [255, if i % 8 < 4 { 60 } else { 200 }, 255, 255]).collect();
    let image = parbake::Picture { name: "rough".into(), width: 8, height: 8, pixels: stripes };
    for material in &mut high.materials {
        (material.metallic, material.roughness) = (1.0, 1.0);
        material.metallic_roughness_texture =
            Some(parbake_model::TextureSlot { image: high.images.len(), ..Default::default() });
    }
    high.images.push(image);
    parbake::write_glb(&place("b_metal"), &high).unwrap();
    let arguments =
        ["reproduce", "data", "-o", "out", "--quick", "--views", "6", "--resolution", "64", "--only"];
    let out = parbake(folder).args(arguments).arg("figure14").output().unwrap();
    assert!(out.status.success(), "{}", text(&out.stderr));
    let tables = std::fs::read_to_string(folder.join("out/tables.md")).unwrap();
    assert!(tables.contains("b_metal") && !tables.contains("a_plain"), "{tables}");
    let row = tables.lines().find(|line| line.contains("b_metal")).unwrap();
    let gain = row.trim_end_matches(['|', ' ']).rsplit('|').next().unwrap().trim().to_string();
    assert!(gain.starts_with('+'), "{row}");
    let page = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    // Three pictures of four models, and the maps.
    assert!(page.matches("data:image/png;base64,").count() >= 3 * 4 + 2);
}
