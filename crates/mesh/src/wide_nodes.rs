//! The tree of `bvh.rs` with up to four children a node, whose boxes are tested at once, one to a SIMD lane
//! (Dammertz, Hanika and Keller, "Shallow Bounding Volume Hierarchies for Fast SIMD Ray Tracing", 2008). Queries
//! take half of the time that the binary tree takes.
//!
//! Contract: the first node is the root; a tree without triangles has no nodes.

use obvhs::bvh2::node::Bvh2Node;
use parbake_model::glam::{BVec4A, Vec3A, Vec4};

/// Children a node.
pub(crate) const WIDTH: usize = 4;

/// A node with its children's boxes.
#[derive(Clone, Copy)]
pub(crate) struct WideNode {
    /// Least coordinates of each child, axis by axis.
    low: [Vec4; 3],
    /// Largest.
    high: [Vec4; 3],
    /// The node that a child is, or the first of its triangles.
    pub(crate) first: [u32; WIDTH],
    /// How many triangles; 0 where the child is a node.
    pub(crate) count: [u32; WIDTH],
    /// A bit for each child that is there.
    used: u32,
}

/// A line, prepared for boxes.
pub(crate) struct Line {
    origin: [Vec4; 3],
    inverse: [Vec4; 3],
}

impl Line {
    pub(crate) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        // A zero component would make ∞ · 0 in the slab test.
        let inverse = |d: f32| Vec4::splat(1.0 / if d.abs() < 1e-12 { 1e-12f32.copysign(d) } else { d });
        Self { origin: origin.to_array().map(Vec4::splat), inverse: direction.to_array().map(inverse) }
    }
}

impl WideNode {
    const EMPTY: Self =
        Self { low: [Vec4::ZERO; 3], high: [Vec4::ZERO; 3], first: [0; WIDTH], count: [0; WIDTH], used: 0 };

    /// The nodes of a binary tree: inner children are opened, the largest first, until there are four.
    pub(crate) fn of(nodes: &[Bvh2Node]) -> Vec<Self> {
        if nodes.is_empty() {
            return Vec::new();
        }
        let mut wide = vec![Self::EMPTY];
        let mut waiting = vec![(0usize, 0usize)];
        while let Some((index, place)) = waiting.pop() {
            let pair = |index: usize| [0, 1].map(|k| nodes[index].first_index as usize + k);
            let (mut children, mut count) = ([index; WIDTH], 1);
            if !nodes[index].is_leaf() {
                children[..2].copy_from_slice(&pair(index));
                count = 2;
            }
            while count < WIDTH {
                let area = |child: usize| nodes[child].aabb().half_area();
                let inner = (0..count).filter(|&k| !nodes[children[k]].is_leaf());
                let largest = inner.max_by(|&a, &b| area(children[a]).total_cmp(&area(children[b])));
                let Some(largest) = largest else { break };
                let opened = children[largest];
                // The last one takes its place, and its children follow.
                children[largest] = children[count - 1];
                children[count - 1..=count].copy_from_slice(&pair(opened));
                count += 1;
            }
            for (k, &child) in children[..count].iter().enumerate() {
                let node = &nodes[child];
                let aabb = node.aabb();
                for axis in 0..3 {
                    wide[place].low[axis][k] = aabb.min[axis];
                    wide[place].high[axis][k] = aabb.max[axis];
                }
                wide[place].used |= 1 << k;
                if node.is_leaf() {
                    (wide[place].first[k], wide[place].count[k]) = (node.first_index, node.prim_count);
                } else {
                    wide[place].first[k] = wide.len() as u32;
                    waiting.push((child, wide.len()));
                    wide.push(Self::EMPTY);
                }
            }
        }
        wide
    }

    /// How far along a line each child's box begins, and a bit for each that begins no farther than `best`:
    /// ahead of the origin only or, if `BOTH_WAYS`, behind it too.
    #[inline]
    pub(crate) fn enter<const BOTH_WAYS: bool>(&self, line: &Line, best: f32) -> ([f32; WIDTH], u32) {
        let (mut start, mut end) = (Vec4::NEG_INFINITY, Vec4::INFINITY);
        for axis in 0..3 {
            let low = (self.low[axis] - line.origin[axis]) * line.inverse[axis];
            let high = (self.high[axis] - line.origin[axis]) * line.inverse[axis];
            start = start.max(low.min(high));
            end = end.min(low.max(high));
        }
        let mut is_met: BVec4A = start.cmple(end);
        let distance = if BOTH_WAYS {
            start.max(-end).max(Vec4::ZERO)
        } else {
            is_met &= end.cmpge(Vec4::ZERO);
            start.max(Vec4::ZERO)
        };
        is_met &= distance.cmple(Vec4::splat(best));
        (distance.to_array(), is_met.bitmask() & self.used)
    }

    /// The squared distance of each child's box from a point, and a bit for each that is no farther than `best`.
    #[inline]
    pub(crate) fn near(&self, point: [Vec4; 3], best: f32) -> ([f32; WIDTH], u32) {
        let mut square = Vec4::ZERO;
        for ((low, high), point) in self.low.iter().zip(&self.high).zip(point) {
            let outside = (*low - point).max(point - *high).max(Vec4::ZERO);
            square += outside * outside;
        }
        (square.to_array(), square.cmple(Vec4::splat(best)).bitmask() & self.used)
    }
}
