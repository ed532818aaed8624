//! The node hierarchy (glTF 2.0, 3.5): which mesh stands where.
//!
//! The default scene is used; failing that the first; failing that all nodes that
//! are no node's child; failing that all meshes as they are. The hierarchy must be
//! a forest: a node reached twice is an error. Transforms are carried in doubles.

use super::accessor::Accessor;
use super::buffers::{Buffers, pointer};
use super::json::{InstancingAttributes, Node};
use crate::FileError;
use parbake_model::NodeTransform;
use parbake_model::glam::{DAffine3, DMat4, DQuat, DVec3};

/// A node of the scene.
pub(super) struct Placed {
    pub index: usize,
    pub parent: Option<usize>,
    /// From the node's space to the world.
    pub world: DAffine3,
}

/// One placing of a mesh.
pub(super) struct Instance {
    pub mesh: usize,
    /// The node that places it; none in a document without nodes.
    pub node: Option<usize>,
    /// Where the mesh is named, for messages.
    pub from: String,
    /// From the mesh's space to the world.
    pub world: DAffine3,
}

/// The children of one node that are yet to be visited. One of these for each level
/// is all that waits: lists of children may be long and say the same again and again.
struct Level<'d> {
    /// `None`: the scene, whose children are its roots.
    parent: Option<usize>,
    children: &'d [usize],
    next: usize,
    /// From the parent's space to the world.
    world: DAffine3,
}

/// Calls `each` for every placing of a mesh, in the document's order.
pub(super) fn visit(
    buffers: &Buffers<'_>,
    each: &mut dyn FnMut(Instance) -> Result<(), FileError>,
) -> Result<(), FileError> {
    let document = buffers.document;
    if document.scenes.is_empty() && document.nodes.is_empty() {
        for mesh in 0..document.meshes.len() {
            let from = format!("/meshes/{mesh}");
            each(Instance { mesh, node: None, from, world: DAffine3::IDENTITY })?;
        }
        return Ok(());
    }
    walk(buffers, &mut |Placed { index, world, .. }| {
        let node = &document.nodes[index];
        let Some(mesh) = node.mesh else { return Ok(()) };
        let from = format!("/nodes/{index}/mesh");
        match node.extensions.as_deref().and_then(|e| e.instancing.as_ref()) {
            Some(instancing) => {
                let here = format!("/nodes/{index}/extensions/EXT_mesh_gpu_instancing/attributes");
                for_instances(buffers, &instancing.attributes, &here, &mut |local| {
                    each(Instance { mesh, node: Some(index), from: from.clone(), world: world * local })
                })
            }
            None => each(Instance { mesh, node: Some(index), from, world }),
        }
    })
}

/// Calls `each` for every visible node of the scene, parents first, in the document's order.
pub(super) fn walk(
    buffers: &Buffers<'_>,
    each: &mut dyn FnMut(Placed) -> Result<(), FileError>,
) -> Result<(), FileError> {
    let document = buffers.document;
    let (scene, roots) = roots(buffers)?;
    let mut visited = vec![false; document.nodes.len()];
    let mut levels = vec![Level { parent: None, children: &roots, next: 0, world: DAffine3::IDENTITY }];
    while let Some(level) = levels.last_mut() {
        let (k, parent, parent_world) = (level.next, level.parent, level.world);
        let Some(&index) = level.children.get(k) else {
            levels.pop();
            continue;
        };
        level.next += 1;
        let from = || match parent {
            Some(parent) => format!("/nodes/{parent}/children/{k}"),
            None => format!("/scenes/{scene}/nodes/{k}"),
        };
        let Some(node) = document.nodes.get(index) else {
            return Err(buffers.missing(&from(), "node", index, document.nodes.len()));
        };
        if std::mem::replace(&mut visited[index], true) {
            let reason = format!("node {index} is reached twice: it has two parents or is its own ancestor");
            return Err(buffers.context.invalid(pointer(from()), reason));
        }
        if node.extensions.as_deref().and_then(|e| e.visibility.as_ref()).is_some_and(|v| !v.visible) {
            buffers.context.warn("nodes that are marked invisible were left out");
            continue;
        }
        let world = parent_world * local(node).to_parent();
        each(Placed { index, parent, world })?;
        levels.push(Level { parent: Some(index), children: &node.children, next: 0, world });
    }
    Ok(())
}

/// The scene, and its root nodes.
fn roots(buffers: &Buffers<'_>) -> Result<(usize, Vec<usize>), FileError> {
    let document = buffers.document;
    let index = document.scene.unwrap_or(0);
    if let Some(scene) = document.scenes.get(index) {
        return Ok((index, scene.nodes.clone()));
    }
    if document.scene.is_some() {
        return Err(buffers.missing("/scene", "scene", index, document.scenes.len()));
    }
    let mut is_child = vec![false; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|n| &n.children) {
        if let Some(flag) = is_child.get_mut(child) {
            *flag = true;
        }
    }
    buffers.context.warn("the document has no scene; all its nodes are used");
    Ok((0, (0..document.nodes.len()).filter(|&n| !is_child[n]).collect()))
}

/// How a node is placed in its parent.
pub(super) fn local(node: &Node) -> NodeTransform {
    match &node.matrix {
        Some(matrix) => NodeTransform::Matrix(DAffine3::from_mat4(DMat4::from_cols_array(matrix))),
        None => parts(
            node.translation.unwrap_or([0.0; 3]),
            node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            node.scale.unwrap_or([1.0; 3]),
        ),
    }
}

fn parts(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> NodeTransform {
    let quaternion = DQuat::from_array(rotation);
    let length = quaternion.length();
    let rotation = match length {
        // As written where it is a unit already: dividing would blur the last bits.
        l if (l - 1.0).abs() < 1e-15 => quaternion,
        l if l > 0.0 && l.is_finite() => quaternion / l,
        _ => DQuat::IDENTITY,
    };
    NodeTransform::Parts { translation: DVec3::from(translation), rotation, scale: DVec3::from(scale) }
}

/// EXT_mesh_gpu_instancing: one transform for each element of its accessors.
fn for_instances(
    buffers: &Buffers<'_>,
    attributes: &InstancingAttributes,
    here: &str,
    each: &mut dyn FnMut(DAffine3) -> Result<(), FileError>,
) -> Result<(), FileError> {
    let open = |index: Option<usize>, name: &str, width: usize| {
        let from = format!("{here}/{name}");
        index.map(|index| Accessor::new(buffers, index, &from, &[width])).transpose()
    };
    let translation = open(attributes.translation, "TRANSLATION", 3)?;
    let rotation = open(attributes.rotation, "ROTATION", 4)?;
    let scale = open(attributes.scale, "SCALE", 3)?;
    let mut counts = [&translation, &rotation, &scale].into_iter().flatten().map(|a| a.count);
    let count = counts.next().unwrap_or(0);
    if counts.any(|other| other != count) {
        return Err(buffers.context.invalid(pointer(here.into()), "the attributes differ in number"));
    }
    for i in 0..count {
        let t = translation.as_ref().map_or([0.0; 3], |a| a.read(i, [0.0; 3]));
        let r = rotation.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |a| a.read(i, [0.0; 4]));
        let s = scale.as_ref().map_or([1.0; 3], |a| a.read(i, [1.0; 3]));
        each(parts(t.map(f64::from), r.map(f64::from), s.map(f64::from)).to_parent())?;
    }
    Ok(())
}
