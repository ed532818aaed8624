//! Skins, morph targets and animations in and out.

use super::*;
use crate::glb_bytes;
use crate::gltf::write::write_lod_glb;
use crate::{MeshCompression, WriteOptions};
use parbake_model::glam::{DAffine3, DVec3};
use parbake_model::{Interpolation, Property, Rig};

fn rig_of(document: &Value) -> (Model, Rig, Vec<String>) {
    let Loaded { model, warnings, .. } = read_value(document).unwrap();
    let rig = model.rig.clone().expect("something moves");
    assert_eq!(rig.fault(model.mesh.positions.len()), None);
    (model, rig, warnings.into_iter().map(|w| w.text).collect())
}

/// Nodes of a rig in the world, at rest.
fn worlds(rig: &Rig) -> Vec<DAffine3> {
    let mut worlds: Vec<DAffine3> = Vec::new();
    for node in &rig.skeleton.nodes {
        let above = node.parent.map_or(DAffine3::IDENTITY, |parent| worlds[parent]);
        worlds.push(above * node.rest.to_parent());
    }
    worlds
}

/// Where a vertex is shown at rest.
fn shown(model: &Model, rig: &Rig, vertex: usize) -> DVec3 {
    let worlds = worlds(rig);
    let position = model.mesh.positions[vertex].as_dvec3();
    let of = |(joint, weight): (u32, f32)| {
        let joint = &rig.skeleton.joints[joint as usize];
        f64::from(weight) * (worlds[joint.node] * joint.inverse_bind).transform_point3(position)
    };
    rig.influences[vertex].used().map(of).sum()
}

/// The triangle, skinned to two joints of which the second turns: node 0 places the mesh, which must not matter.
fn skinned() -> Value {
    let mut document = document(&TRIANGLE);
    let joints = add(&mut document, "VEC4", 5121, 3, &[0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0]);
    let weights = floats(&[1.0, 0.0, 0.0, 0.0, 0.8, 0.2, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let weights = add(&mut document, "VEC4", 5126, 3, &weights);
    let at = |x: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0];
    let binds = add(&mut document, "MAT4", 5126, 2, &floats(&[at(0.0), at(-1.0)].concat()));
    let times = add(&mut document, "SCALAR", 5126, 2, &floats(&[0.0, 2.0]));
    let turns = add(&mut document, "VEC4", 5126, 2, &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]));
    let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    document["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [0, 0, 9] },
        { "name": "root", "translation": [0, 5, 0], "children": [2] },
        { "name": "tip", "translation": [1, 0, 0] },
        { "name": "lamp" },
    ]);
    document["scenes"] = json!([{ "nodes": [0, 1, 3] }]);
    document["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": binds }]);
    document["animations"] = json!([{
        "name": "wave",
        "samplers": [{ "input": times, "output": turns, "interpolation": "STEP" }],
        "channels": [{ "sampler": 0, "target": { "node": 2, "path": "rotation" } }],
    }]);
    document
}

/// Protects skins: joints, weights, nodes and animations are kept; the mesh stands where viewers show it, not where
/// its own node is.
#[test]
fn skins_are_read() {
    let (model, rig, warnings) = rig_of(&skinned());
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(model.mesh.positions[1], Vec3::new(1.0, 5.0, 0.0));
    let names: Vec<&str> = rig.skeleton.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["root", "tip"]);
    assert_eq!((rig.influences[1].weights, rig.influences[1].joints[..2].len()), ([0.8, 0.2, 0.0, 0.0], 2));
    assert_eq!(rig.skeleton.joints[rig.influences[2].joints[0] as usize].node, 1);
    for vertex in 0..3 {
        assert!(shown(&model, &rig, vertex).distance(model.mesh.positions[vertex].as_dvec3()) < 1e-6);
    }
    let [animation] = &rig.skeleton.animations[..] else { panic!("one animation") };
    let [track] = &animation.tracks[..] else { panic!("one track") };
    assert_eq!((animation.name.as_str(), track.property), ("wave", Property::Rotation(1)));
    assert_eq!((track.interpolation, &track.times[..]), (Interpolation::Step, &[0.0, 2.0][..]));
}

/// Protects rigid parts: what hangs on a node that moves follows it, what stands still follows a joint that does not;
/// a model in which nothing moves has no rig.
#[test]
fn nodes_that_move_are_joints() {
    let mut document = document(&TRIANGLE);
    let times = add(&mut document, "SCALAR", 5126, 2, &floats(&[0.0, 1.0]));
    let places = add(&mut document, "VEC3", 5126, 2, &floats(&[0.0, 0.0, 0.0, 0.0, 3.0, 0.0]));
    document["nodes"] = json!([
        { "mesh": 0 },
        { "name": "wheel", "translation": [2, 0, 0], "scale": [2, 2, 2], "children": [2] },
        { "name": "hub", "mesh": 0 },
    ]);
    document["scenes"] = json!([{ "nodes": [0, 1] }]);
    assert_eq!(read_value(&document).unwrap().model.rig, None);
    document["animations"] = json!([{
        "samplers": [{ "input": times, "output": places }],
        "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
    }]);
    let (model, rig, _) = rig_of(&document);
    assert_eq!(model.mesh.positions[4], Vec3::new(4.0, 0.0, 0.0));
    let names: Vec<&str> = rig.skeleton.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["wheel", "hub", "still"]);
    let node = |vertex: usize| rig.skeleton.joints[rig.influences[vertex].joints[0] as usize].node;
    assert_eq!((node(0), node(4)), (2, 0));
    assert!((0..6).all(|v| shown(&model, &rig, v).distance(model.mesh.positions[v].as_dvec3()) < 1e-6));
    // Animations of what no triangle follows do not make a rig.
    document["animations"][0]["channels"][0]["target"]["node"] = 9.into();
    assert_eq!(read_value(&document).unwrap().model.rig, None);
}

/// The triangle with a morph target that lifts its second vertex, on a node that doubles it.
fn morphed() -> Value {
    let mut document = document(&TRIANGLE);
    let lift = add(&mut document, "VEC3", 5126, 3, &floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0]));
    let times = add(&mut document, "SCALAR", 5126, 2, &floats(&[0.0, 1.0]));
    let weights = add(&mut document, "SCALAR", 5126, 2, &floats(&[0.0, 1.0]));
    document["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": lift }]);
    document["meshes"][0]["weights"] = json!([0.25]);
    document["meshes"][0]["extras"] = json!({ "targetNames": ["lift"] });
    document["nodes"] = json!([{ "mesh": 0, "scale": [2, 2, 2] }]);
    document["animations"] = json!([{
        "samplers": [{ "input": times, "output": weights }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }],
    }]);
    document
}

/// Protects morph targets: displacements go along with the node's transform, names and weights are kept.
#[test]
fn morph_targets_are_read() {
    let (_, rig, _) = rig_of(&morphed());
    assert!(rig.influences.is_empty());
    let [target] = &rig.skeleton.targets[..] else { panic!("one target") };
    assert_eq!((target.name.as_str(), target.weight), ("lift", 0.25));
    assert_eq!((&rig.morphs[0].vertices[..], rig.morphs[0].positions[0]), (&[1][..], Vec3::Z * 3.0));
    assert_eq!(rig.skeleton.animations[0].tracks[0].property, Property::MorphWeights);
}

/// Protects what is written: it is read again as the same rig, compressed or not, alone or as levels of detail.
#[test]
fn rigs_come_back() {
    let folder = tempfile::tempdir().unwrap();
    for document in [skinned(), morphed()] {
        let (model, rig, _) = rig_of(&document);
        let again = |bytes: &[u8]| {
            let loaded =
                read_gltf_bytes(Path::new("a.glb"), bytes, &NoResources, &Limits::default()).unwrap();
            assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
            loaded.model
        };
        assert_eq!(again(&glb_bytes(&model).unwrap()).rig, Some(rig.clone()));
        let path = folder.path().join("a.glb");
        for mesh_compression in [MeshCompression::Quantized, MeshCompression::Meshopt] {
            let options = WriteOptions { mesh_compression, ..WriteOptions::default() };
            write_lod_glb(&path, &[&model, &model], &[0.5, 0.0], &options).unwrap();
            let back = again(&std::fs::read(&path).unwrap());
            let found = back.rig.clone().unwrap();
            assert_eq!(found.skeleton.animations, rig.skeleton.animations);
            assert_eq!(found.skeleton.targets, rig.skeleton.targets);
            for vertex in 0..3 {
                let at_rest = back.mesh.positions[vertex].as_dvec3();
                let far = |p: DVec3| p.distance(model.mesh.positions[vertex].as_dvec3());
                if rig.influences.is_empty() {
                    assert!(far(at_rest) < 1e-4);
                } else {
                    let shown = shown(&back, &found, vertex);
                    assert!(far(shown) < 1e-2 && shown.distance(at_rest) < 1e-2, "{shown}");
                }
            }
            let moved = |rig: &Rig| rig.morphs.first().and_then(|m| m.of(1)).map_or(Vec3::ZERO, |(p, _)| p);
            assert!(moved(&found).distance(moved(&rig)) < 1e-3);
        }
    }
}

/// Protects readers from what is broken: it is left out with a sentence, and the model is read all the same.
#[test]
fn broken_motion_is_left_out() {
    type Breakage = (fn(&mut Value), &'static str);
    let breakages: [Breakage; 7] = [
        (|d| d["skins"][0]["joints"] = json!([1, 7]), "skin 0 was left out"),
        (|d| d["skins"][0]["joints"] = json!([]), "skin 0 was left out"),
        (|d| d["scenes"][0]["nodes"] = json!([0]), "skin 0 was left out"),
        (|d| d["nodes"][0]["skin"] = 4.into(), "skin 4 was left out"),
        (|d| d["skins"][0]["inverseBindMatrices"] = 99.into(), "accessor 99"),
        (|d| d["animations"][0]["samplers"][0]["output"] = 99.into(), "/animations/0/channels/0"),
        (
            |d| d["animations"][0]["channels"][0]["target"]["path"] = "scale".into(),
            "/animations/0/channels/0",
        ),
    ];
    for (breakage, expected) in breakages {
        let mut document = skinned();
        breakage(&mut document);
        let loaded = read_value(&document).unwrap();
        let warned = loaded.warnings.iter().any(|warning| warning.text.contains(expected));
        assert!(warned, "{expected}: {:?}", loaded.warnings);
        assert_eq!(loaded.model.mesh.triangles.len(), 1);
    }
    // A joint out of range and weights that are no numbers leave the skin's first joint.
    let mut document = skinned();
    let weights = add(&mut document, "VEC4", 5126, 3, &floats(&[f32::NAN; 12]));
    document["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = weights.into();
    let (_, rig, warnings) = rig_of(&document);
    assert!(warnings[0].contains("without a weight"), "{warnings:?}");
    assert!(rig.influences.iter().all(|i| i.weights[0] == 1.0));
    let mut document = skinned();
    document["nodes"][2]["children"] = json!([1]);
    assert!(read_value(&document).unwrap_err().contains("reached twice"));
}

/// Protects two skins with the same joints: a skin names a node once, so the other one gets a node beside it.
#[test]
fn joints_are_named_once() {
    let mut document = skinned();
    document["nodes"][3] = json!({ "mesh": 0, "skin": 1 });
    document["skins"].as_array_mut().unwrap().push(json!({ "joints": [1, 2] }));
    let (model, rig, _) = rig_of(&document);
    assert_eq!((model.mesh.positions.len(), rig.skeleton.joints.len()), (6, 3));
    let (tip, beside) = (&rig.skeleton.nodes[1], &rig.skeleton.nodes[2]);
    assert_eq!((beside.parent, beside.name.as_str()), (Some(1), tip.name.as_str()));
    let bytes = glb_bytes(&model).unwrap();
    let again = read_gltf_bytes(Path::new("a.glb"), &bytes, &NoResources, &Limits::default()).unwrap();
    assert_eq!(again.model.rig, Some(rig));
}
