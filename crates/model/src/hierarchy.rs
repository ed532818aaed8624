//! The node hierarchy of a file (glTF 2.0, 3.5.2), and which node each triangle of the one mesh hangs on.
//!
//! Contract ([`Hierarchy::fault`] checks it): nodes come after their parents; their transforms are finite; there is one
//! node for each triangle, or [`Hierarchy::NONE`].

use crate::Node;
use glam::DAffine3;

/// Nodes, and the triangles that hang on them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hierarchy {
    /// Nodes, parents first.
    pub nodes: Vec<Node>,
    /// For each of F triangles the index of its node, or [`Hierarchy::NONE`].
    pub of_triangles: Vec<u32>,
}

impl Hierarchy {
    /// No node.
    pub const NONE: u32 = u32::MAX;

    /// From the space of each node to the world.
    pub fn worlds(&self) -> Vec<DAffine3> {
        let mut worlds: Vec<DAffine3> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let above = node.parent.and_then(|parent| worlds.get(parent)).copied().unwrap_or_default();
            worlds.push(above * node.rest.to_parent());
        }
        worlds
    }

    /// For each node the number of triangles that hang on it, without those of nodes below.
    pub fn counts(&self) -> Vec<usize> {
        let mut counts = vec![0; self.nodes.len()];
        for &node in &self.of_triangles {
            if let Some(count) = counts.get_mut(node as usize) {
                *count += 1;
            }
        }
        counts
    }

    /// The first thing that breaks the contract, for a mesh of so many triangles, in words that follow "the parts have".
    pub fn fault(&self, triangles: usize) -> Option<&'static str> {
        let is_late = |(index, node): (usize, &Node)| node.parent.is_some_and(|parent| parent >= index);
        let is_known = |&node: &u32| node == Self::NONE || (node as usize) < self.nodes.len();
        match () {
            () if self.nodes.iter().enumerate().any(is_late) => Some("a node before its parent"),
            () if !self.nodes.iter().all(|node| node.rest.to_parent().is_finite()) => {
                Some("a transform that is not finite")
            }
            () if self.of_triangles.len() != triangles => Some("not one node for each triangle"),
            () if !self.of_triangles.iter().all(is_known) => Some("a triangle whose node is not there"),
            () => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NodeTransform;
    use glam::{DQuat, DVec3};

    fn node(parent: Option<usize>, x: f64) -> Node {
        let parts = (DVec3::X * x, DQuat::IDENTITY, DVec3::splat(2.0));
        let (translation, rotation, scale) = parts;
        Node { name: String::new(), parent, rest: NodeTransform::Parts { translation, rotation, scale } }
    }

    /// Protects pivots: a node's world is its parents' times its own.
    #[test]
    fn worlds_follow_the_parents() {
        let nodes = vec![node(None, 1.0), node(Some(0), 3.0), node(None, 5.0)];
        let hierarchy = Hierarchy { nodes, of_triangles: vec![1, 1, Hierarchy::NONE, 2] };
        let places: Vec<DVec3> = hierarchy.worlds().iter().map(|world| world.translation).collect();
        assert_eq!(places, [DVec3::X, DVec3::X * 7.0, DVec3::X * 5.0]);
        assert_eq!(hierarchy.counts(), [0, 2, 1]);
        assert_eq!((hierarchy.fault(4), hierarchy.fault(3).is_some()), (None, true));
    }
}
