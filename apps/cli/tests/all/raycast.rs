//! `raycast`: what it writes, says and refuses.

use crate::common::{demo_pair, json, parbake, run, text};
use parbake::{Limits, read_model};
use std::fs;
use std::path::Path;

const PAIR: [&str; 3] = ["raycast", "demo_high.glb", "demo_low.glb"];
const SMALL: [&str; 4] = ["--texture-size", "64", "--samples", "2"];

/// Protects artists: one command writes the model and a 16-bit picture of each map, and says what black and white
/// of each are; all of it the same bytes for any number of threads.
#[test]
fn maps_are_written_beside_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let names = ["occlusion", "bent_normal", "curvature", "position", "thickness", "height", "object_normal"];
    let list = names.map(|name| name.replace('_', "-")).join(",");
    let bake = |stem: &str, threads: &str| {
        let output = format!("{stem}.glb");
        let more =
            ["-o", &output, "--rays", "8", "--maps", &list, "--threads", threads, "--json", "out.json"];
        let said = text(&run(folder, &[&PAIR[..], &SMALL, &more].concat()).stdout);
        let png = |name: &&str| fs::read(folder.join(format!("{stem}_{name}.png"))).unwrap();
        (said, fs::read(folder.join(&output)).unwrap(), names.iter().map(png).collect::<Vec<_>>())
    };
    let (said, model, pictures) = bake("one", "1");
    for (name, png) in names.iter().zip(&pictures) {
        assert!(said.contains(&format!("one_{name}.png: black is ")), "{said}");
        assert_eq!(png[24], 16, "bits of {name}");
    }
    let report = json(&folder.join("out.json"));
    assert_eq!(report["maps"].as_array().unwrap().len(), names.len());
    assert_eq!(report["maps"][0]["file"], "one_occlusion.png");
    assert_eq!((&report["maps"][0]["white"][0], &report["missed_texels"]), (&1.0.into(), &0.into()));
    let many = bake("five", "5");
    assert!(model == many.1 && pictures == many.2);
}

/// Protects materials: occlusion that is asked for is in the model, not occluded where it is convex and dark
/// somewhere; normals of either direction differ in green alone.
#[test]
fn occlusion_goes_into_the_material() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let bake = |name: &str, more: &[&str]| {
        run(folder, &[&PAIR[..], &SMALL, &["-q", "-o", name], more].concat());
        read_model(&folder.join(name), &Limits::default()).unwrap().model
    };
    let model = bake("a.glb", &["--occlusion-texture"]);
    let slot = model.materials[0].occlusion_texture.expect("an occlusion texture");
    let values = || model.images[slot.image].pixels.iter().map(|pixel| pixel[0]);
    assert!(values().max() > Some(240) && values().min() < Some(160));
    assert!(bake("b.glb", &[]).materials[0].occlusion_texture.is_none());
    let down = bake("c.glb", &["--normal-y", "down", "--occlusion-texture"]);
    let normals = |model: &parbake::Model| {
        model.images[model.materials[0].normal_texture.unwrap().image].pixels.clone()
    };
    let same = normals(&model)
        .iter()
        .zip(normals(&down))
        .all(|(up, down)| up[0] == down[0] && up[1] == 255 - down[1] && up[2] == down[2]);
    assert!(same);
}

/// Protects low-polys without UVs, and those whose UVs are to stay.
#[test]
fn missing_uvs_are_made_and_others_may_stay() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let bare = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
    fs::write(folder.join("bare.obj"), bare).unwrap();
    let uvs = |arguments: &[&str]| {
        run(folder, &[&["raycast"], arguments, &SMALL, &["-q", "-o", "out.glb"]].concat());
        read_model(&folder.join("out.glb"), &Limits::default()).unwrap().model.mesh.uvs
    };
    assert_eq!(uvs(&["bare.obj", "bare.obj"]).len(), 4);
    let own = read_model(&folder.join("demo_low.glb"), &Limits::default()).unwrap().model.mesh.uvs;
    let kept = uvs(&[&PAIR[1..], &["--uv", "keep"]].concat());
    assert!(own.iter().all(|uv| kept.contains(uv)));
    let output = parbake(folder).args(["raycast", "bare.obj", "bare.obj", "--uv", "keep"]).output().unwrap();
    assert!(output.status.code() == Some(1) && text(&output.stderr).contains("no texture coordinates"));
}

/// Protects people who choose options: what would do nothing, and what is out of range, is named.
#[test]
fn options_without_effect_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |more: &[&str], words: &str| {
        let output = parbake(folder.path()).args(PAIR).args(more).output().unwrap();
        let said = text(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(words), "{more:?}: {said}");
    };
    refused(&["--rays", "8"], "--rays does nothing without --maps");
    refused(&["--occlusion-distance", "0.1", "--maps", "height"], "--occlusion-distance does nothing");
    refused(&["--curvature-radius", "0.1"], "--curvature-radius does nothing without --maps curvature");
    refused(&["--match", "closest-point", "--ray-normals", "own"], "--ray-normals does nothing");
    refused(&["--samples", "0"], "--samples cannot be 0: it may be 1 to 64");
    refused(&["-o", "x.png"], "must end in .glb or .obj");
    assert!(!Path::new("baked.glb").exists());
}
