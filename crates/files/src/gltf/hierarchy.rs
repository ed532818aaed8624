//! The nodes of the scene as a model has them ([`Hierarchy`]).
//!
//! A node without a name goes by its mesh's.

use super::buffers::Buffers;
use super::scene::{local, walk};
use crate::FileError;
use parbake_model::{Hierarchy, Node};

/// The scene's nodes; `of_triangles` has for each triangle the document's node that places it. None where the document
/// has no nodes.
pub(super) fn hierarchy(
    buffers: &Buffers<'_>,
    mut of_triangles: Vec<u32>,
) -> Result<Option<Hierarchy>, FileError> {
    let document = buffers.document;
    if document.nodes.is_empty() {
        return Ok(None);
    }
    let mut nodes: Vec<Node> = Vec::new();
    let mut places: Vec<Option<usize>> = vec![None; document.nodes.len()];
    walk(buffers, &mut |placed| {
        let node = &document.nodes[placed.index];
        let mesh = node.mesh.and_then(|mesh| document.meshes.get(mesh));
        let name = match (node.name.as_str(), mesh) {
            ("", Some(mesh)) => mesh.name.clone(),
            (name, _) => name.into(),
        };
        places[placed.index] = Some(nodes.len());
        let parent = placed.parent.and_then(|parent| places[parent]);
        nodes.push(Node { name, parent, rest: local(node) });
        Ok(())
    })?;
    for node in &mut of_triangles {
        let place = places.get(*node as usize).copied().flatten();
        *node = place.map_or(Hierarchy::NONE, |place| place as u32);
    }
    Ok(Some(Hierarchy { nodes, of_triangles }))
}
