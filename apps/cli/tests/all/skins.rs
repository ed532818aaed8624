//! Skins, morph targets and animations through whole commands: levels move as the original does.

use crate::common::{run, text};
use parbake::{Limits, Model, StatsOptions, model_distance, read_model};
use parbake_model::glam::{DAffine3, DQuat, DVec3, Quat, Vec3};
use parbake_model::{NodeTransform, Property};
use serde_json::json;
use std::fs;
use std::path::Path;

/// Rings of the arm and corners of a ring.
const ARM: (u32, u32) = (24, 12);

/// Writes an arm along y from 0 to 2 that bends at its middle by a right angle and swells at its end, and beside its
/// upper half, a hair away, a post that stands still.
fn write_arm(folder: &Path) {
    let (mut positions, mut joints, mut weights, mut swelling) = (vec![], vec![], vec![], vec![]);
    let mut indices: Vec<[Vec<u16>; 1]> = Vec::new();
    for (x, radius) in [(0.0, 0.2), (0.45, 0.2)] {
        let (rings, corners) = ARM;
        let own = (0..rings - 1).flat_map(|ring| {
            (0..corners).flat_map(move |k| {
                let [a, b] = [k, (k + 1) % corners].map(|k| (ring * corners + k) as u16);
                let [c, d] = [a + corners as u16, b + corners as u16];
                [a, c, b, b, c, d]
            })
        });
        indices.push([own.collect()]);
        for ring in 0..rings {
            for k in 0..corners {
                let y = 2.0 * ring as f32 / (rings - 1) as f32;
                let (sin, cos) = (std::f32::consts::TAU * k as f32 / corners as f32).sin_cos();
                positions.extend([x + radius * cos, y, radius * sin]);
                let bent = ((y - 0.8) / 0.4).clamp(0.0, 1.0);
                joints.extend([0u8, 1, 0, 0]);
                weights.extend([1.0 - bent, bent, 0.0, 0.0]);
                let swells = if y > 1.6 { 0.1 } else { 0.0 };
                swelling.extend([swells * cos, 0.0, swells * sin]);
            }
        }
    }
    let half = positions.len() / 2;
    let bytes = |values: &[f32]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let turn = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
    let binds = [[0.0, 0.0], [0.0, -1.0]]
        .map(|[x, y]| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, 0.0, 1.0]);
    let turns = [Quat::IDENTITY.to_array(), turn.to_array()].concat();
    let short = |indices: &[u16]| indices.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<u8>>();
    // Kind, component type, elements, bytes.
    let count = half / 3;
    let blocks: [(&str, u32, usize, Vec<u8>); 10] = [
        ("VEC3", 5126, count, bytes(&positions[..half])),
        ("VEC3", 5126, count, bytes(&positions[half..])),
        ("SCALAR", 5123, indices[0][0].len(), short(&indices[0][0])),
        ("VEC4", 5121, count, joints[..4 * count].to_vec()),
        ("VEC4", 5126, count, bytes(&weights[..4 * count])),
        ("VEC3", 5126, count, bytes(&swelling[..half])),
        ("MAT4", 5126, 2, bytes(&binds.concat())),
        ("SCALAR", 5126, 2, bytes(&[0.0, 1.0])),
        ("VEC4", 5126, 2, bytes(&turns)),
        ("SCALAR", 5126, 2, bytes(&[0.0, 1.0])),
    ];
    let (mut binary, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    for (view, (kind, component, count, bytes)) in blocks.iter().enumerate() {
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() }));
        accessors
            .push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        binary.extend_from_slice(bytes);
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    let arm = json!({
        "attributes": { "POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 4 }, "indices": 2,
        "targets": [{ "POSITION": 5 }],
    });
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1, 3] }],
        "nodes": [
            { "mesh": 0, "skin": 0 },
            { "name": "shoulder", "children": [2] },
            { "name": "elbow", "translation": [0, 1, 0] },
            { "mesh": 1, "name": "post" },
        ],
        "meshes": [
            { "primitives": [arm], "extras": { "targetNames": ["swell"] } },
            { "primitives": [{ "attributes": { "POSITION": 1 }, "indices": 2 }] },
        ],
        "skins": [{ "joints": [1, 2], "inverseBindMatrices": 6 }],
        "animations": [{
            "name": "bend",
            "samplers": [{ "input": 7, "output": 8 }, { "input": 7, "output": 9 }],
            "channels": [
                { "sampler": 0, "target": { "node": 2, "path": "rotation" } },
                { "sampler": 1, "target": { "node": 0, "path": "weights" } },
            ],
        }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": binary.len(), "uri": "arm.bin" }],
    });
    fs::write(folder.join("arm.gltf"), document.to_string()).unwrap();
    fs::write(folder.join("arm.bin"), binary).unwrap();
}

/// The model at the end of its first animation: linear blend skinning after morphing, as glTF says.
fn at_the_end(path: &Path) -> Model {
    let mut model = read_model(path, &Limits::default()).unwrap().model;
    let rig = model.rig.clone().expect("a rig");
    let skeleton = &rig.skeleton;
    let mut rests: Vec<NodeTransform> = skeleton.nodes.iter().map(|node| node.rest).collect();
    let mut morph_weights: Vec<f32> = skeleton.targets.iter().map(|target| target.weight).collect();
    for track in &skeleton.animations[0].tracks {
        let width = track.property.width(morph_weights.len());
        let last: Vec<f64> = track.values[track.values.len() - width..].iter().map(|&x| x.into()).collect();
        match track.property {
            Property::Rotation(node) => {
                let NodeTransform::Parts { rotation, .. } = &mut rests[node] else { panic!("parts") };
                *rotation = DQuat::from_slice(&last);
            }
            Property::MorphWeights => morph_weights = last.iter().map(|&x| x as f32).collect(),
            _ => panic!("nothing else moves"),
        }
    }
    let mut worlds: Vec<DAffine3> = Vec::new();
    for (node, rest) in skeleton.nodes.iter().zip(&rests) {
        let above = node.parent.map_or(DAffine3::IDENTITY, |parent| worlds[parent]);
        worlds.push(above * rest.to_parent());
    }
    for (vertex, position) in model.mesh.positions.iter_mut().enumerate() {
        let morphs = rig.morphs.iter().zip(&morph_weights);
        let delta: Vec3 =
            morphs.filter_map(|(morph, &weight)| Some(weight * morph.of(vertex as u32)?.0)).sum();
        let morphed = (*position + delta).as_dvec3();
        let moved: DVec3 = (rig.influences[vertex].used())
            .map(|(joint, weight)| {
                let joint = &skeleton.joints[joint as usize];
                let matrix = worlds[joint.node] * joint.inverse_bind;
                f64::from(weight) * matrix.transform_point3(morphed)
            })
            .sum();
        *position = moved.as_vec3();
    }
    model
}

/// How far two posed surfaces are apart at most; the arm is 2 long and 0.4 thick.
fn apart(original: &Model, level: &Model) -> f64 {
    model_distance(original, level, &StatsOptions { samples: 20_000, ..StatsOptions::default() })
        .unwrap()
        .hausdorff
}

/// Protects animated models: each level, bent and swollen, is where the original is; nothing is drawn from the arm to
/// the post beside it; compressed files and simplified ones move as well; and an OBJ says what it loses.
#[test]
fn levels_move_as_the_original() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_arm(folder);
    let original = at_the_end(&folder.join("arm.gltf"));
    // The bend is real: at rest the arm reaches up to 2.
    let arm = &original.mesh.positions[..(ARM.0 * ARM.1) as usize];
    assert!(arm.iter().map(|p| p.y).fold(0.0, f32::max) < 1.4);
    // A budget that is long spent: levels move whatever way they are made.
    let small = ["--screen-size", "32,16", "--triangles", "500,250", "--time-budget", "0.1"];
    run(folder, &[&["lod", "arm.gltf", "-o", "lods", "--mesh-compression", "meshopt"], &small[..]].concat());
    for (file, most) in [("arm_lod0.glb", 0.06), ("arm_lod1.glb", 0.2), ("arm_lods.glb", 0.06)] {
        let level = at_the_end(&folder.join("lods").join(file));
        let found = apart(&original, &level);
        assert!(found < most, "{file}: {found}");
    }
    let said = run(folder, &["simplify", "arm.gltf", "-t", "400", "-o", "simple.glb"]);
    assert!(!text(&said.stderr).contains("warning"), "{}", text(&said.stderr));
    let found = apart(&original, &at_the_end(&folder.join("simple.glb")));
    assert!(found < 0.2, "simple.glb: {found}");
    // A low-poly without a rig takes the high-poly's, one with a rig keeps it.
    let bake =
        ["--texture-size", "32", "--views", "12", "--view-size", "64", "--rounds", "1", "--preset", "fast"];
    let said = run(folder, &["simplify", "arm.gltf", "-t", "400", "--closest-in", "shape", "-o", "low.obj"]);
    assert!(text(&[said.stdout, said.stderr].concat()).contains("OBJ has no place for skins"));
    run(folder, &[&["bake", "-q", "arm.gltf", "low.obj", "-o", "baked.glb"], &bake[..]].concat());
    let own = ["bake", "-q", "low.obj", "simple.glb", "-o", "own.glb", "--shape", "keep"];
    run(folder, &[&own[..], &bake[..]].concat());
    for file in ["baked.glb", "own.glb"] {
        let found = apart(&original, &at_the_end(&folder.join(file)));
        assert!(found < 0.2, "{file}: {found}");
    }
}
