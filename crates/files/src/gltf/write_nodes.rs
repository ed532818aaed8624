//! Nodes of a GLB file that is being written: those of a hierarchy, and meshes that hang on nodes.

use super::quantise::Grid;
use parbake_model::glam::{DAffine3, DMat4};
use parbake_model::{Node, NodeTransform};
use serde_json::{Value, json};

/// The nodes of a hierarchy, the first of which is the document's `first`, and the indices of those without a parent.
pub fn nodes_of(nodes: &[Node], first: usize) -> (Vec<Value>, Vec<Value>) {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    let mut roots = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
        match node.parent {
            Some(parent) => children[parent].push(first + index),
            None => roots.push(Value::from(first + index)),
        }
    }
    let node = |(node, children): (&Node, Vec<usize>)| {
        let mut out = json!({});
        if !node.name.is_empty() {
            out["name"] = node.name.clone().into();
        }
        if !children.is_empty() {
            out["children"] = children.into();
        }
        match node.rest {
            rest if rest == NodeTransform::IDENTITY => {}
            NodeTransform::Parts { translation, rotation, scale } => {
                out["translation"] = json!(translation.to_array());
                out["rotation"] = json!(rotation.to_array());
                out["scale"] = json!(scale.to_array());
            }
            NodeTransform::Matrix(own) => out["matrix"] = json!(matrix(own)),
        }
        out
    };
    (nodes.iter().zip(children).map(node).collect(), roots)
}

/// Columns of a matrix.
pub fn matrix(affine: DAffine3) -> [f64; 16] {
    DMat4::from(affine).to_cols_array()
}

/// Hangs a mesh on a node; one whose positions are on a grid that has to be placed goes on a child that places it,
/// unless the node `is_free` to do so.
pub fn hang(nodes: &mut Vec<Value>, node: usize, mesh: usize, grid: Option<&Grid>, is_free: bool) {
    let Some(grid) = grid else {
        nodes[node]["mesh"] = mesh.into();
        return;
    };
    if is_free {
        nodes[node]["mesh"] = mesh.into();
        grid.place(&mut nodes[node]);
        return;
    }
    let mut child = json!({ "mesh": mesh });
    grid.place(&mut child);
    let index = nodes.len();
    add_children(&mut nodes[node], vec![index.into()]);
    nodes.push(child);
}

/// Adds the indices of children to a node.
pub fn add_children(node: &mut Value, children: Vec<Value>) {
    match node.get_mut("children").and_then(Value::as_array_mut) {
        Some(own) => own.extend(children),
        None => node["children"] = children.into(),
    }
}
