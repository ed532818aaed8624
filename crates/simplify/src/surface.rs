//! A surface whose triangles come and go: points that are welded by position, triangles between them, and which
//! triangles lie around a point.
//!
//! Parts that move against each other do not share points. Any set of triangles will do: open, closed, several parts, edges with three triangles.
//!
//! Contract: an index once given is never given again, so a triangle that is gone cannot be taken for another one.
//! No triangle names a point twice. Lists around points are in ascending order, so results do not depend on the
//! order in which they came about.

use crate::change::Change;
use crate::triangle::Triangle;
use glam::Vec3;
use parbake_mesh::weld_by_position;
use parbake_model::Mesh;
use std::collections::HashMap;

/// Points and triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Positions of all points, also of those that no triangle uses any more.
    pub points: Vec<Vec3>,
    /// All triangles that ever were; none where they are gone.
    triangles: Vec<Option<Triangle>>,
    /// For each point the triangles around it.
    around: Vec<Vec<u32>>,
    count: usize,
    /// The part of each material; nothing where there is one part.
    parts: Vec<u32>,
    /// Triangles of each part.
    counts: Vec<usize>,
    /// Triangles that each part keeps at least; nothing where parts may go.
    floors: Vec<usize>,
    /// Lengths that parts span at least, corner to corner of their boxes, while they have few triangles.
    spans: Vec<f32>,
}

/// Triangles up to which a part is watched for its span, since that takes a look at all of them.
const WATCHED: usize = 128;
/// Share of its span that a part keeps: what is left shall be all of it, coarsely, and no crumb.
pub const KEPT_SPAN: f32 = 0.8;

impl Surface {
    /// Welds the vertices of a mesh by position; triangles without extent are left out.
    pub fn new(mesh: &Mesh) -> Self {
        Self::in_parts(mesh, &[])
    }

    /// The same, but only within each part: `parts` has each material's, or nothing where there is one. As no change
    /// joins what is not connected, parts stay apart.
    pub fn in_parts(mesh: &Mesh, parts: &[u32]) -> Self {
        let first = weld_by_position(&mesh.positions);
        let mut index: HashMap<(u32, u32), u32> = HashMap::with_capacity(first.len());
        let mut out = Self { parts: parts.to_vec(), ..Self::default() };
        for (corners, &material) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
            let welded = corners.map(|v| first[v as usize]);
            if welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0] {
                continue;
            }
            let part = out.part_of(material);
            let corners = welded.map(|v| {
                *index.entry((v, part)).or_insert_with(|| out.push_point(mesh.positions[v as usize]))
            });
            out.push(Triangle { corners, material });
        }
        out
    }

    /// The part of a material.
    fn part_of(&self, material: u32) -> u32 {
        self.parts.get(material as usize).copied().unwrap_or(0)
    }

    /// From now on each part keeps so many triangles, or all that it has if these are fewer, and most of its span.
    pub fn keep_of_each_part(&mut self, least: usize) {
        self.floors = self.counts.iter().map(|&count| count.min(least)).collect();
        if least > 0 {
            let nothing = Change::default();
            self.spans = (0..self.counts.len() as u32)
                .map(|part| KEPT_SPAN * self.span_after(part, &nothing))
                .collect();
        }
    }

    /// From now on parts may become shorter; returns whether they might not.
    pub fn forget_spans(&mut self) -> bool {
        !std::mem::take(&mut self.spans).is_empty()
    }

    /// Whether a change leaves its part what that has to keep. All its triangles are of one part.
    pub fn may(&self, change: &Change) -> bool {
        let first = change.removed.iter().find_map(|&triangle| self.get(triangle));
        let Some(part) = first.map(|triangle| self.part_of(triangle.material)) else { return true };
        let (count, floor) = (self.counts[part as usize], self.floors.get(part as usize).copied());
        let left = count + change.added.len() - change.removed.len();
        let span = self.spans.get(part as usize).filter(|_| count <= WATCHED);
        left >= floor.unwrap_or(0) && span.is_none_or(|&span| self.span_after(part, change) >= span)
    }

    /// Length from corner to corner of a part's box after a change.
    fn span_after(&self, part: u32, change: &Change) -> f32 {
        let kept = self.triangles().filter(|(index, triangle)| {
            self.part_of(triangle.material) == part && !change.removed.contains(index)
        });
        let kept = kept.map(|(_, triangle)| self.corners(triangle.corners));
        let added = change.added.iter().map(|triangle| self.corners_after(change, triangle));
        let boxed = kept.chain(added).flatten().fold(None, |boxed: Option<(Vec3, Vec3)>, point| {
            let (low, high) = boxed.unwrap_or((point, point));
            Some((low.min(point), high.max(point)))
        });
        boxed.map_or(0.0, |(low, high)| low.distance(high))
    }

    /// Adds a point that no triangle uses yet.
    pub fn push_point(&mut self, position: Vec3) -> u32 {
        self.points.push(position);
        self.around.push(Vec::new());
        self.points.len() as u32 - 1
    }

    fn push(&mut self, triangle: Triangle) -> u32 {
        let index = self.triangles.len() as u32;
        self.triangles.push(Some(triangle));
        triangle.corners.iter().for_each(|&point| self.around[point as usize].push(index));
        self.count += 1;
        let part = self.part_of(triangle.material) as usize;
        if part >= self.counts.len() {
            self.counts.resize(part + 1, 0);
        }
        self.counts[part] += 1;
        index
    }

    fn remove(&mut self, index: u32) {
        if let Some(triangle) = self.triangles[index as usize].take() {
            for point in triangle.corners {
                self.around[point as usize].retain(|&other| other != index);
            }
            self.count -= 1;
            let part = self.part_of(triangle.material) as usize;
            self.counts[part] -= 1;
        }
    }

    /// Does what a change says; returns the indices of the new triangles.
    pub fn apply(&mut self, change: &Change) -> Vec<u32> {
        change.removed.iter().for_each(|&triangle| self.remove(triangle));
        if let Some((point, position)) = change.moved {
            if point as usize == self.points.len() {
                self.push_point(position);
            }
            self.points[point as usize] = position;
        }
        change.added.iter().map(|&triangle| self.push(triangle)).collect()
    }

    /// How many triangles there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Indices given so far: every triangle's is below.
    pub fn indices(&self) -> usize {
        self.triangles.len()
    }

    /// A triangle, if it is still there.
    #[inline]
    pub fn get(&self, index: u32) -> Option<Triangle> {
        self.triangles[index as usize]
    }

    /// All triangles with their indices.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, Triangle)> + '_ {
        (0..).zip(&self.triangles).filter_map(|(index, triangle)| Some((index, (*triangle)?)))
    }

    /// The triangles around a point.
    #[inline]
    pub fn around(&self, point: u32) -> &[u32] {
        &self.around[point as usize]
    }

    /// Positions of three points.
    #[inline]
    pub fn corners(&self, points: [u32; 3]) -> [Vec3; 3] {
        points.map(|point| self.points[point as usize])
    }

    /// Corner positions of a triangle that a change adds.
    pub fn corners_after(&self, change: &Change, triangle: &Triangle) -> [Vec3; 3] {
        triangle.corners.map(|point| match change.moved {
            Some((moved, position)) if moved == point => position,
            _ => self.points[point as usize],
        })
    }

    /// The points that share a triangle with this one, ascending.
    pub fn neighbours(&self, point: u32) -> Vec<u32> {
        let corners = self.around(point).iter().filter_map(|&t| self.get(t)).flat_map(|t| t.corners);
        let mut out: Vec<u32> = corners.filter(|&other| other != point).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    /// The triangles that have both points.
    pub fn at_edge(&self, a: u32, b: u32) -> Vec<u32> {
        let has = |t: u32| self.get(t).is_some_and(|t| t.corners.contains(&b));
        self.around(a).iter().copied().filter(|&t| has(t)).collect()
    }

    /// All edges, each once with its lesser point first, ascending.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let of = |t: Triangle| {
            let [a, b, c] = t.corners;
            [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
        };
        let mut edges: Vec<[u32; 2]> = self.triangles().flat_map(|(_, t)| of(t)).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Whether an edge at this point has one triangle only.
    pub fn is_border(&self, point: u32) -> bool {
        self.neighbours(point).into_iter().any(|other| self.at_edge(point, other).len() == 1)
    }

    /// The mesh: the points in use, and the triangles in their order.
    pub fn to_mesh(&self) -> Mesh {
        let mut index = vec![u32::MAX; self.points.len()];
        let mut mesh = Mesh::default();
        for (_, triangle) in self.triangles() {
            let corners = triangle.corners.map(|point| {
                let vertex = &mut index[point as usize];
                if *vertex == u32::MAX {
                    *vertex = mesh.positions.len() as u32;
                    mesh.positions.push(self.points[point as usize]);
                }
                *vertex
            });
            mesh.triangles.push(corners);
            mesh.triangle_materials.push(triangle.material);
        }
        mesh
    }
}
