//! A texture layout: a mesh's triangles as they lie in the texture, apart from what
//! else the mesh carries.
//!
//! Points are corners welded by (position, texture coordinate): vertices that are
//! split for their normals alone are one point and move together, seams are two.
//! The charts are the layout's connected pieces.
//!
//! Inside a [`Mesh`] v points down, so a triangle that is seen from the front and not
//! mirrored runs clockwise in the texture. Layouts swap two corners of each triangle:
//! **here an unmirrored triangle has a positive signed area**, in the same
//! coordinates.

use glam::{DMat2, DVec2, Vec2, dvec2};
use parbake_mesh::charts::{charts, weld_by_position_and_uv};
use parbake_model::Mesh;

/// Triangles in the texture, with the shapes they have in space.
///
/// Contract: indices are in range; coordinates are finite; each coordinate is a
/// number that `f32` can hold, so that what is decided about a layout holds for the
/// file as well ([`Layout::round`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// P points; the texture is the square from (0, 0) to (1, 1), v down.
    pub points: Vec<DVec2>,
    /// F triangles, counter-clockwise (see above) where not mirrored; the mesh's order.
    pub triangles: Vec<[u32; 3]>,
    /// F rest shapes: the second and the third corner relative to the first one, laid
    /// flat without distortion, in the mesh's unit; a determinant of 0 for a triangle
    /// that has no area in space.
    pub rest: Vec<DMat2>,
    /// F chart indices, numbered in the order of their first triangles.
    pub charts: Vec<u32>,
    /// For each of the mesh's V vertices its point.
    pub point_of_vertex: Vec<u32>,
}

impl Layout {
    /// The layout of a mesh; without texture coordinates all points are (0, 0).
    pub fn new(mesh: &Mesh) -> Self {
        let welded = weld_by_position_and_uv(mesh);
        let mut points = Vec::new();
        let mut point_of_vertex = vec![u32::MAX; welded.len()];
        for (vertex, &first) in welded.iter().enumerate() {
            if first as usize == vertex {
                point_of_vertex[vertex] = points.len() as u32;
                points.push(mesh.uvs.get(vertex).copied().unwrap_or_default().as_dvec2());
            } else {
                point_of_vertex[vertex] = point_of_vertex[first as usize];
            }
        }
        let triangles =
            mesh.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|v| point_of_vertex[v as usize])).collect();
        let rest = (0..mesh.triangles.len())
            .map(|t| {
                let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
                flattened(c - a, b - a)
            })
            .collect();
        Self { points, triangles, rest, charts: charts(mesh), point_of_vertex }
    }

    /// The three points of a triangle.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [DVec2; 3] {
        self.triangles[triangle].map(|i| self.points[i as usize])
    }

    /// Twice the signed area of a triangle in the texture, positive where it is not
    /// mirrored. Rounded; `parbake_atlas::predicates` decides signs exactly.
    #[inline]
    pub fn doubled_area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle);
        (b - a).perp_dot(c - a)
    }

    /// Area of a triangle in space, in the mesh's unit squared.
    #[inline]
    pub fn rest_area(&self, triangle: usize) -> f64 {
        0.5 * self.rest[triangle].determinant()
    }

    /// Rounds all points to the numbers that a file can hold.
    pub fn round(&mut self) {
        for p in &mut self.points {
            *p = p.as_vec2().as_dvec2();
        }
    }

    /// The texture coordinates of the mesh's V vertices.
    pub fn uvs(&self) -> Vec<Vec2> {
        self.point_of_vertex.iter().map(|&p| self.points[p as usize].as_vec2()).collect()
    }

    /// The boundary edges: those that one triangle alone has, in the direction in which
    /// that triangle runs, with its index. Sorted by triangle.
    ///
    /// Triangles with a point twice have no sides and count as absent.
    pub fn boundary(&self) -> Vec<BoundaryEdge> {
        self.boundary_among(|_| true)
    }

    /// The boundary edges of those triangles that `is_there` accepts by their indices.
    pub(crate) fn boundary_among(&self, is_there: impl Fn(usize) -> bool) -> Vec<BoundaryEdge> {
        let mut edges: Vec<([u32; 2], u32, [u32; 2])> = Vec::with_capacity(3 * self.triangles.len());
        for (t, corners) in self.triangles.iter().enumerate() {
            // Such a triangle goes along one edge to and fro, and would hide that its
            // neighbour ends there.
            let [a, b, c] = *corners;
            if a == b || b == c || c == a || !is_there(t) {
                continue;
            }
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                edges.push(([a.min(b), a.max(b)], t as u32, [a, b]));
            }
        }
        edges.sort_unstable();
        let mut boundary: Vec<BoundaryEdge> = edges
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|run| run.len() == 1)
            .map(|run| BoundaryEdge { points: run[0].2, triangle: run[0].1 })
            .collect();
        boundary.sort_unstable_by_key(|e| (e.triangle, e.points));
        boundary
    }
}

/// An edge with a triangle on one side only, which lies to its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryEdge {
    /// From, to.
    pub points: [u32; 2],
    /// The triangle that it belongs to.
    pub triangle: u32,
}

/// Two edges of a triangle in space laid flat: the first along x, the second above it.
fn flattened(first: glam::DVec3, second: glam::DVec3) -> DMat2 {
    let length = first.length();
    if length == 0.0 {
        return DMat2::ZERO;
    }
    let x = second.dot(first) / length;
    let y = second.cross(first).length() / length;
    DMat2::from_cols(dvec2(length, 0.0), dvec2(x, y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    /// Two triangles of a square in space and texture, split along the diagonal.
    fn square() -> Mesh {
        let corners = [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)];
        Mesh {
            positions: corners.iter().map(|&(x, y)| Vec3::new(2.0 * x as f32, 2.0 * y as f32, 0.0)).collect(),
            uvs: corners.iter().map(|&(x, y)| Vec2::new(x as f32, 1.0 - y as f32)).collect(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        }
    }

    /// Protects the sign convention, the welding and the rest shapes.
    #[test]
    fn a_front_facing_square_has_positive_area() {
        let layout = Layout::new(&square());
        assert_eq!(layout.points.len(), 4);
        assert_eq!(layout.charts, [0, 0]);
        for t in 0..2 {
            assert_eq!(layout.doubled_area(t), 1.0);
            assert!((layout.rest_area(t) - 2.0).abs() < 1e-12);
        }
        assert_eq!(layout.boundary().len(), 4);
        assert_eq!(layout.uvs(), square().uvs);
    }

    /// Protects a chart's boundary next to a triangle with a point twice.
    #[test]
    fn folded_triangles_hide_no_boundary() {
        let mut layout = Layout::new(&square());
        let boundary = layout.boundary();
        let [from, to] = boundary[0].points;
        for folded in [[from, from, to], [to, from, to], [from, from, from]] {
            layout.triangles.push(folded);
            layout.rest.push(DMat2::ZERO);
            layout.charts.push(0);
        }
        assert_eq!(layout.boundary(), boundary);
    }

    /// Protects meshes without texture coordinates and triangles without area.
    #[test]
    fn odd_meshes_have_layouts() {
        let mut mesh = square();
        mesh.uvs.clear();
        mesh.triangles[1] = [3, 3, 3];
        let layout = Layout::new(&mesh);
        assert_eq!(layout.rest_area(1), 0.0);
        assert_eq!(layout.points[0], DVec2::ZERO);
    }
}
