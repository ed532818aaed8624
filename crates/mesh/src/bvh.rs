//! The hierarchy under `projection.rs`: obvhs builds it, this file lays the
//! triangles out in its leaves' order and answers for single triangles.
//!
//! Traversal is our own, since obvhs offers none for closest points, nor for the
//! hit nearest to the middle of a segment.

use crate::wide_nodes::{WIDTH, WideNode};
use obvhs::aabb::Aabb;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use parbake_model::Mesh;
use parbake_model::glam::{Vec3, Vec3A};
use rayon::prelude::*;

/// How far outside a triangle, in barycentric weights, a ray may still hit it.
const EDGE_TOLERANCE: f32 = 1e-6;

/// A tree of boxes over triangles.
#[derive(Clone)]
pub(crate) struct Bvh {
    nodes: Vec<WideNode>,
    /// In the order of the leaves.
    triangles: Vec<Corners>,
    /// Each triangle's index in the mesh.
    sources: Vec<u32>,
}

/// A triangle with an area.
#[derive(Clone, Copy)]
pub(crate) struct Corners {
    a: Vec3A,
    ab: Vec3A,
    ac: Vec3A,
}

/// A point of a triangle near another.
#[derive(Clone, Copy, Default)]
pub(crate) struct Near {
    /// Weights of corners 1 and 2.
    pub(crate) barycentric: [f32; 2],
    /// Squared distance.
    pub(crate) square: f32,
}

impl Bvh {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let solid: Vec<u32> = (0..mesh.triangles.len() as u32)
            .into_par_iter()
            .filter(|&t| {
                let [a, b, c] = mesh.corners(t as usize);
                let normal = (b - a).cross(c - a).length_squared();
                // Underflow of either would divide by zero later on.
                let shortest = (b - a).length_squared().min((c - a).length_squared());
                let shortest = shortest.min((c - b).length_squared());
                normal > 0.0 && normal.is_finite() && shortest > 0.0
            })
            .collect();
        let corners: Vec<Corners> =
            solid.par_iter().map(|&t| Corners::new(mesh.corners(t as usize))).collect();
        let boxes = boxes(&corners);
        let indices = (0..solid.len() as u32).collect();
        // obvhs's "very fast" preset, by measurement: a million triangles take a
        // third of a second. Without reinsertion queries are a quarter slower;
        // longer searches build longer for queries that are no faster.
        let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
            PlocSearchDistance::Minimum,
            &boxes,
            indices,
            SortPrecision::U64,
            0,
        );
        ReinsertionOptimizer::default().run(&mut tree, 0.01, None);
        collapse(&mut tree, 8, 3.0);
        Self {
            triangles: tree.primitive_indices.par_iter().map(|&i| corners[i as usize]).collect(),
            sources: tree.primitive_indices.par_iter().map(|&i| solid[i as usize]).collect(),
            nodes: WideNode::of(&tree.nodes),
        }
    }

    /// All nodes, the root first.
    pub(crate) fn nodes(&self) -> &[WideNode] {
        &self.nodes
    }

    /// A triangle in the order of the leaves.
    pub(crate) fn triangle(&self, slot: u32) -> &Corners {
        &self.triangles[slot as usize]
    }

    /// Its index in the mesh.
    pub(crate) fn source(&self, slot: u32) -> u32 {
        self.sources[slot as usize]
    }
}

/// The triangles' boxes, each side moved outwards by 1 … 8 millionths of the
/// largest coordinate. That covers the rounding of box tests; and it differs from
/// side to side, since PLOC merges only pairs that agree to be each other's
/// nearest: among boxes that are all alike, one pair at a time.
fn boxes(triangles: &[Corners]) -> Vec<Aabb> {
    let ends = |t: &Corners| (t.a, t.a + t.ab, t.a + t.ac);
    let largest = triangles.iter().fold(Vec3A::ZERO, |m, t| {
        let (a, b, c) = ends(t);
        m.max(a.abs()).max(b.abs()).max(c.abs())
    });
    let unit = largest.max_element() * 1e-6;
    let mut state = 1u32;
    let mut margin = || {
        let [x, y, z] = [(); 3].map(|()| {
            // Marsaglia's xorshift.
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state as f32 / u32::MAX as f32
        });
        (Vec3A::new(x, y, z) * 7.0 + 1.0) * unit
    };
    triangles
        .iter()
        .map(|t| {
            let (a, b, c) = ends(t);
            Aabb::new(a.min(b).min(c) - margin(), a.max(b).max(c) + margin())
        })
        .collect()
}

impl Corners {
    fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3A::from);
        Self { a, ab: b - a, ac: c - a }
    }

    /// Where a line meets the triangle: its parameter (negative behind the
    /// origin), the weights of corners 1 and 2, and whether the triangle's normal
    /// is within 90° of the direction.
    #[inline]
    pub(crate) fn intersect(&self, origin: Vec3A, direction: Vec3A) -> Option<(f32, [f32; 2], bool)> {
        let normal = self.ab.cross(self.ac);
        let determinant = normal.dot(direction);
        let inverse = 1.0 / determinant;
        let to_corner = self.a - origin;
        let moment = to_corner.cross(direction);
        let u = moment.dot(self.ac) * inverse;
        let v = -moment.dot(self.ab) * inverse;
        let limit = -EDGE_TOLERANCE;
        // Also false for the NaNs of a parallel line.
        if !(u >= limit && v >= limit && u + v <= 1.0 + EDGE_TOLERANCE) {
            return None;
        }
        let t = normal.dot(to_corner) * inverse;
        let (u, v) = (u.clamp(0.0, 1.0), v.max(0.0));
        t.is_finite().then_some((t, [u, v.min(1.0 - u)], determinant > 0.0))
    }

    /// The normal, as long as twice the area.
    #[inline]
    pub(crate) fn normal(&self) -> Vec3A {
        self.ab.cross(self.ac)
    }

    /// The nearest point of the triangle.
    #[inline]
    pub(crate) fn closest(&self, point: Vec3A) -> Near {
        let (ab, ac, ap) = (self.ab, self.ac, point - self.a);
        let (d1, d2) = (ab.dot(ap), ac.dot(ap));
        let near =
            |u: f32, v: f32| Near { barycentric: [u, v], square: (ap - ab * u - ac * v).length_squared() };
        if d1 <= 0.0 && d2 <= 0.0 {
            return near(0.0, 0.0);
        }
        let bp = ap - ab;
        let (d3, d4) = (ab.dot(bp), ac.dot(bp));
        if d3 >= 0.0 && d4 <= d3 {
            return near(1.0, 0.0);
        }
        let vc = d1 * d4 - d3 * d2;
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return near((d1 / (d1 - d3)).clamp(0.0, 1.0), 0.0);
        }
        let cp = ap - ac;
        let (d5, d6) = (ab.dot(cp), ac.dot(cp));
        if d6 >= 0.0 && d5 <= d6 {
            return near(0.0, 1.0);
        }
        let vb = d5 * d2 - d1 * d6;
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return near(0.0, (d2 / (d2 - d6)).clamp(0.0, 1.0));
        }
        let va = d3 * d6 - d5 * d4;
        let (along, back) = (d4 - d3, d5 - d6);
        if va <= 0.0 && along >= 0.0 && back >= 0.0 {
            let w = (along / (along + back)).clamp(0.0, 1.0);
            return near(1.0 - w, w);
        }
        let sum = va + vb + vc;
        // Rounding on needles may leave no sign to go by.
        if sum > 0.0 {
            let u = (vb / sum).clamp(0.0, 1.0);
            near(u, (vc / sum).clamp(0.0, 1.0 - u))
        } else {
            near(0.0, 0.0)
        }
    }
}

/// Children of nodes still to visit, and how near each is. Deep trees (many triangles in one
/// place) spill to the heap.
pub(crate) struct Stack {
    inline: [(u32, f32); 64],
    used: usize,
    spilled: Vec<(u32, f32)>,
}

impl Default for Stack {
    fn default() -> Self {
        Self { inline: [(0, 0.0); 64], used: 0, spilled: Vec::new() }
    }
}

impl Stack {
    /// Puts those children of a node that have a bit on top, the nearest last.
    #[inline]
    pub(crate) fn push_nearest_last(&mut self, node: u32, distances: [f32; WIDTH], mut bits: u32) {
        let mut order = [(0u32, 0.0f32); WIDTH];
        let mut count = 0;
        while bits != 0 {
            let k = bits.trailing_zeros();
            bits &= bits - 1;
            let own = (node * WIDTH as u32 + k, distances[k as usize]);
            let mut place = count;
            while place > 0 && order[place - 1].1 < own.1 {
                order[place] = order[place - 1];
                place -= 1;
            }
            order[place] = own;
            count += 1;
        }
        for &(child, distance) in &order[..count] {
            self.push(child, distance);
        }
    }

    #[inline]
    fn push(&mut self, node: u32, distance: f32) {
        if self.used < self.inline.len() {
            self.inline[self.used] = (node, distance);
            self.used += 1;
        } else {
            self.spilled.push((node, distance));
        }
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<(u32, f32)> {
        if let Some(last) = self.spilled.pop() {
            return Some(last);
        }
        self.used = self.used.checked_sub(1)?;
        Some(self.inline[self.used])
    }
}
