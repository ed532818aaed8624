//! An indexed triangle mesh with per-vertex attributes; a vertex is split where
//! any of its attributes differs (normals, texture coordinates, …).

use glam::{Vec2, Vec3, Vec4};

/// Triangles over split vertices.
///
/// Contract: all per-vertex vectors have `positions.len()` entries or, where the
/// field says "or empty", none; indices are in range; all numbers are finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// V positions.
    pub positions: Vec<Vec3>,
    /// V unit normals, or empty when the file has none.
    pub normals: Vec<Vec3>,
    /// V tangents, or empty; `w` = ±1, bitangent = w · n × t (MikkTSpace, glTF).
    pub tangents: Vec<Vec4>,
    /// V texture coordinates of set 0, v down; or empty.
    pub uvs: Vec<Vec2>,
    /// V texture coordinates of set 1, or empty.
    pub uvs1: Vec<Vec2>,
    /// V linear RGBA vertex colours that multiply the base colour, or empty.
    pub colors: Vec<Vec4>,
    /// V offsets, or empty: what to add to positions where the parallax maps of their materials are shown. Cutouts take
    /// away and cannot add, so the surface that they are cut from reaches further than the one without.
    pub parallax_offsets: Vec<Vec3>,
    /// F triangles, counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
    /// F material indices.
    pub triangle_materials: Vec<u32>,
}

impl Mesh {
    /// Moves vertices to where parallax maps are shown.
    pub fn apply_parallax_offsets(&mut self) {
        for (position, offset) in self.positions.iter_mut().zip(std::mem::take(&mut self.parallax_offsets)) {
            *position += offset;
        }
    }

    /// The three positions of a triangle.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// The three texture coordinates of a triangle; zero where the mesh has none.
    #[inline]
    pub fn corner_uvs(&self, triangle: usize) -> [Vec2; 3] {
        self.triangles[triangle].map(|i| self.uvs.get(i as usize).copied().unwrap_or_default())
    }

    /// Cross product of two edges: twice the area, along the geometric normal.
    #[inline]
    pub fn area_normal(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Area of all triangles.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| 0.5 * f64::from(self.area_normal(t).length())).sum()
    }
}
