//! Parts that stay apart, on their way through files.
//!
//! Where `$PARBAKE_GLB_OUT` names a folder, the GLB files stay there, for the
//! Khronos validator to look at (`tools/validate_gltf`).

#![allow(clippy::unwrap_used)]

use crate::common::{check_model, keep};
use parbake_files::{
    Limits, Loaded, MeshCompression, WriteOptions, read_model, write_glb_with, write_lod_glb,
};
use parbake_model::glam::{DAffine3, DQuat, DVec3, Vec2, Vec3, Vec4};
use parbake_model::{Hierarchy, Material, MaterialExtensions, Mesh, Model, Node, NodeTransform, Volume};
use std::path::Path;

/// A floor of no node, a door on hinges that are turned and stretched, and a mirrored knob below it.
fn house() -> Model {
    let (mut mesh, mut of_triangles) = (Mesh::default(), Vec::new());
    for (k, node) in [Hierarchy::NONE, 1, 2, 1].into_iter().enumerate() {
        let first = mesh.positions.len() as u32;
        let at = Vec3::new(2.0 * k as f32, 0.5, -1.0);
        mesh.positions.extend([at, at + Vec3::X, at + Vec3::new(0.2, 1.0, 0.4)]);
        let normal = Vec3::new(0.0, -0.4, 1.0).normalize();
        mesh.normals.extend([normal; 3]);
        mesh.tangents.extend([Vec4::new(1.0, 0.0, 0.0, 1.0); 3]);
        mesh.uvs.extend([Vec2::ZERO, Vec2::X, Vec2::Y]);
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.triangle_materials.push(u32::from(node == 2));
        of_triangles.push(node);
    }
    let parts = |translation: [f64; 3], angle: f64, scale: [f64; 3]| NodeTransform::Parts {
        translation: translation.into(),
        rotation: DQuat::from_rotation_y(angle),
        scale: scale.into(),
    };
    let matrix = DAffine3::from_scale_rotation_translation(
        DVec3::new(-1.0, 2.0, 1.0),
        DQuat::from_rotation_x(0.5),
        DVec3::new(0.5, 0.0, 0.1),
    );
    let node = |name: &str, parent, rest| Node { name: name.into(), parent, rest };
    let nodes = vec![
        node("hinges", None, parts([2.0, 0.0, 0.0], 0.7, [2.0; 3])),
        node("door", Some(0), parts([0.0, 1.0, 0.0], 0.0, [1.5, 1.0, 1.0])),
        node("knob", Some(1), NodeTransform::Matrix(matrix)),
    ];
    let volume = Some(Volume { thickness: 0.25, ..Volume::default() });
    let extensions = MaterialExtensions { volume, ..MaterialExtensions::default() };
    let glass = Material { name: "glass".into(), extensions, ..Material::default() };
    Model {
        name: "house".into(),
        mesh,
        materials: vec![Material { name: "wood".into(), ..Material::default() }, glass],
        parts: Some(Hierarchy { nodes, of_triangles }),
        ..Model::default()
    }
}

/// For each triangle of a model its node's name, its material, its corners and their normals, in an order that does
/// not depend on the file's.
fn shown(model: &Model, nodes: &Hierarchy) -> Vec<(String, String, [Vec3; 6])> {
    let mesh = &model.mesh;
    let mut out: Vec<_> = (0..mesh.triangles.len())
        .map(|t| {
            let node = nodes.nodes.get(nodes.of_triangles[t] as usize).map_or("", |node| &node.name);
            let material = &model.materials[mesh.triangle_materials[t] as usize].name;
            let triangle = mesh.triangles[t];
            let lowest = (0..3).min_by(|&a, &b| {
                let x = |k: usize| mesh.positions[triangle[k] as usize].x;
                x(a).total_cmp(&x(b))
            });
            let turned = [0, 1, 2].map(|k| triangle[(k + lowest.unwrap_or(0)) % 3] as usize);
            let [a, b, c] = turned;
            let corners = [a, b, c].map(|v| mesh.positions[v]);
            let normals = turned.map(|v| mesh.normals[v]);
            let all = [corners, normals].concat();
            (node.to_string(), material.clone(), std::array::from_fn(|k| all[k]))
        })
        .collect();
    out.sort_by(|a, b| a.2[0].x.total_cmp(&b.2[0].x));
    out
}

fn assert_same(loaded: &Loaded, wanted: &Model, rest: &str, tolerance: f32) {
    let parts = wanted.parts.as_ref().unwrap();
    let (found, wanted) = (shown(&loaded.model, loaded.model.nodes.as_ref().unwrap()), shown(wanted, parts));
    assert_eq!(found.len(), wanted.len());
    for ((node, material, corners), (own, own_material, own_corners)) in found.iter().zip(&wanted) {
        let own = if own.is_empty() { rest } else { own };
        assert_eq!((node.as_str(), material), (own, own_material));
        for (a, b) in corners.iter().zip(own_corners) {
            assert!(a.distance(*b) < tolerance, "{node}: {corners:?} {own_corners:?}");
        }
    }
}

fn read(path: &Path) -> Loaded {
    let loaded = read_model(path, &Limits::default()).unwrap();
    check_model(path, &loaded);
    loaded
}

/// Protects parts: each comes back on its node, whose transform is the same, where it stood and of what it
/// was, plain and on grids; the rest is on the first node.
#[test]
fn parts_keep_their_nodes() {
    let folder = tempfile::tempdir().unwrap();
    let model = house();
    let kinds = [MeshCompression::None, MeshCompression::Quantized, MeshCompression::Meshopt];
    for (mesh_compression, name) in kinds.into_iter().zip(["plain", "quantised", "meshopt"]) {
        let path = folder.path().join(format!("parts_{name}.glb"));
        let options = WriteOptions { mesh_compression, ..WriteOptions::default() };
        let written = write_glb_with(&path, &model, &options).unwrap();
        keep(&path, &format!("parts_{name}.glb")).unwrap();
        assert!(written.mesh.position_error < 1e-3);
        let loaded = read(&path);
        assert_eq!(loaded.contents.draw_calls, 3);
        let nodes = &loaded.model.nodes.as_ref().unwrap().nodes;
        for own in &model.parts.as_ref().unwrap().nodes {
            let found = nodes.iter().find(|node| node.name == own.name).unwrap();
            assert!(found.rest.to_parent().abs_diff_eq(own.rest.to_parent(), 1e-15), "{found:?} {own:?}");
        }
        if mesh_compression == MeshCompression::None {
            assert_same(&loaded, &model, "house", 1e-5);
        }
        // A glass of a quarter of a unit stays that, however its node stretches it.
        let glass = loaded.model.materials.iter().find(|m| m.name == "glass").unwrap();
        let thickness = glass.extensions.volume.as_ref().unwrap().thickness;
        assert!((thickness - 0.25).abs() < 1e-4, "{thickness}");
    }
}

/// Protects levels of detail: each has parts of its own below its own node, and readers that know no levels see the first.
#[test]
fn each_level_has_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("parts_lods.glb");
    let (fine, mut coarse) = (house(), house());
    coarse.name = "coarse".into();
    for mesh_compression in [MeshCompression::None, MeshCompression::Quantized] {
        let options = WriteOptions { mesh_compression, ..WriteOptions::default() };
        write_lod_glb(&path, &[&fine, &coarse], &[0.5, 0.0], &options).unwrap();
        keep(&path, &format!("parts_lods_{mesh_compression:?}.glb")).unwrap();
        let loaded = read(&path);
        assert_eq!(loaded.model.mesh.triangles.len(), 4);
        if mesh_compression == MeshCompression::None {
            assert_same(&loaded, &fine, "house", 1e-5);
        }
    }
}

/// Protects files from parts that cannot be written: without a size, of another mesh, with a rig.
#[test]
fn parts_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |change: fn(&mut Model)| {
        let mut model = house();
        change(&mut model);
        let path = folder.path().join("refused.glb");
        write_glb_with(&path, &model, &WriteOptions::default()).unwrap_err().to_string()
    };
    assert!(refused(|m| m.parts.as_mut().unwrap().of_triangles.truncate(2)).contains("not one node"));
    assert!(
        refused(|m| m.parts.as_mut().unwrap().nodes[1].rest = NodeTransform::Matrix(DAffine3::ZERO))
            .contains("without size")
    );
    assert!(refused(|m| m.rig = Some(parbake_model::Rig::default())).contains("rig"));
}
