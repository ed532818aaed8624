//! How skins, morph targets and animations come along.
//!
//! A low-poly that is made here, or has no rig of its own, takes the high-poly's (`rig_transfer.rs`); one that
//! has its own keeps it. Stages after that cut seams and move vertices, but leave triangles in their order, so a vertex of
//! the result moves as the corner that it came from.

use crate::rig_transfer::transfer_rig;
use parbake_model::{Mesh, Model, Rig};
use std::borrow::Cow;

/// No vertex.
const NONE: u32 = u32::MAX;

/// The rig of a surface that was made of a model's, in the same space. `parts` is what
/// [`parts_of_materials`](crate::parts::parts_of_materials) says of the surface's materials, or nothing.
pub fn transferred(model: &Model, mesh: &Mesh, parts: &[u32]) -> Option<Rig> {
    let rig = model.rig.as_ref()?;
    let of_triangles: Option<Vec<u32>> =
        mesh.triangle_materials.iter().map(|&material| parts.get(material as usize).copied()).collect();
    Some(transfer_rig(&model.mesh, rig, mesh, of_triangles.as_deref()))
}

/// The low-poly with the high-poly's rig, where it has none itself.
pub fn rigged<'l>(high: &Model, low: &'l Model) -> Cow<'l, Model> {
    match low.rig.is_none().then(|| transferred(high, &low.mesh, &[])).flatten() {
        Some(rig) => Cow::Owned(Model { rig: Some(rig), ..low.clone() }),
        None => Cow::Borrowed(low),
    }
}

/// The rig of what stages made of a low-poly: that of the corners that its vertices came from, or of the closest points
/// where triangles are no longer the same.
pub fn carried(low: &Model, mesh: &Mesh) -> Option<Rig> {
    let rig = low.rig.as_ref()?;
    match sources(&low.mesh, mesh) {
        Some(sources) => Some(rig.picked(&sources)),
        None => transferred(low, mesh, &[]),
    }
}

/// For each vertex the one that it came from, if triangles are still the same ones.
fn sources(before: &Mesh, after: &Mesh) -> Option<Vec<u32>> {
    if before.triangles.len() != after.triangles.len() {
        return None;
    }
    let mut sources = vec![NONE; after.positions.len()];
    let corners = after.triangles.as_flattened().iter().zip(before.triangles.as_flattened());
    for (&vertex, &source) in corners {
        let own = sources.get_mut(vertex as usize)?;
        let is_other = *own != NONE && before.positions[*own as usize] != before.positions[source as usize];
        if is_other {
            return None;
        }
        if *own == NONE {
            *own = source;
        }
    }
    // Vertices that no triangle uses may move with any other.
    sources.iter_mut().filter(|source| **source == NONE).for_each(|source| *source = 0);
    Some(sources)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::{parts_of_materials, with_parted_materials};
    use parbake_model::glam::{DAffine3, Vec3};
    use parbake_model::{Influences, Joint, Material, Node, NodeTransform, Skeleton};
    use std::sync::Arc;

    /// Two triangles apart, each of its own joint, both of one material.
    fn two_triangles() -> Model {
        let node = Node { name: String::new(), parent: None, rest: NodeTransform::IDENTITY };
        let joint = |node| Joint { node, inverse_bind: DAffine3::IDENTITY };
        let skeleton =
            Skeleton { nodes: vec![node; 2], joints: vec![joint(0), joint(1)], ..Skeleton::default() };
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let positions = [triangle, triangle.map(|p| p + Vec3::Z)].concat();
        let mesh = Mesh {
            positions,
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            triangle_materials: vec![0, 0],
            ..Mesh::default()
        };
        let influences = [0, 0, 0, 1, 1, 1].map(Influences::of).to_vec();
        let rig = Rig { skeleton: Arc::new(skeleton), influences, morphs: Vec::new() };
        Model { mesh, materials: vec![Material::default()], rig: Some(rig), ..Model::default() }
    }

    /// Protects parts from being joined: each has a material of its own while triangles are chosen.
    #[test]
    fn parts_are_told_by_their_materials() {
        let model = two_triangles();
        assert!(parts_of_materials(&model).is_empty());
        let parted = with_parted_materials(&model);
        assert_eq!(parted.mesh.triangle_materials, [0, 1]);
        assert_eq!(parts_of_materials(&parted), [0, 1]);
        let rig = transferred(&parted, &parted.mesh, &[0, 1]);
        assert_eq!(rig, model.rig);
    }

    /// Protects rigs of delivered low-polys: vertices that were cut apart and moved keep what they had.
    #[test]
    fn corners_keep_their_weights() {
        let model = two_triangles();
        let mut mesh = model.mesh.clone();
        mesh.triangles = vec![[5, 4, 3], [0, 1, 2]];
        mesh.positions.iter_mut().for_each(|p| p.x += 0.25);
        let rig = carried(&model, &mesh).unwrap_or_default();
        assert_eq!(rig.influences, [1, 1, 1, 0, 0, 0].map(Influences::of));
        // With another triangle, closest points decide.
        mesh.triangles.push([0, 1, 2]);
        mesh.triangle_materials.push(0);
        let rig = carried(&model, &mesh).unwrap_or_default();
        assert_eq!(rig.influences, [0, 0, 0, 1, 1, 1].map(Influences::of));
    }
}
