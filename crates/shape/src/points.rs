//! What moves: points, each being all vertices at one position, so that seams stay closed.
//!
//! Forward: `v = rest + δ n` along the normal (Knodt et al. 2023, section 4.3), or
//! `v = rest + (δ_x, δ_y, δ_z)` for free motion. Adjoint: a point's gradient is the sum of
//! its vertices', projected on n where it may only move along it.
//!
//! Contract: one value of four lanes a point; the lanes that a motion does not use are 0.

use glam::{Vec3, Vec4};
use parbake_mesh::weld_by_position;

/// Where vertices may go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    /// Along their normal, as in the paper.
    Normal,
    /// Anywhere.
    #[default]
    Free,
}

/// The points of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// V entries: each vertex's point.
    pub of_vertex: Vec<u32>,
    /// P positions before anything moved.
    pub rest: Vec<Vec3>,
    /// P unit normals: the direction of the mean of the vertices' normals.
    pub normals: Vec<Vec3>,
    /// F triangles of points.
    pub triangles: Vec<[u32; 3]>,
}

impl Points {
    /// Welds equal positions.
    pub fn new(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let first = weld_by_position(positions);
        let mut out = Self::default();
        let mut index = vec![u32::MAX; positions.len()];
        for (vertex, &first) in first.iter().enumerate() {
            let point = &mut index[first as usize];
            if *point == u32::MAX {
                *point = out.rest.len() as u32;
                out.rest.push(positions[vertex]);
                out.normals.push(Vec3::ZERO);
            }
            out.normals[*point as usize] += normals[vertex];
            out.of_vertex.push(*point);
        }
        for (normal, vertex) in out.normals.iter_mut().zip(&first) {
            *normal = normal.try_normalize().unwrap_or_else(|| normals[*vertex as usize]);
        }
        out.triangles = triangles.iter().map(|t| t.map(|v| out.of_vertex[v as usize])).collect();
        out
    }

    /// Forward: where the points are.
    pub fn displaced(&self, motion: Motion, values: &[Vec4]) -> Vec<Vec3> {
        let way = |i: usize, value: &Vec4| match motion {
            Motion::Normal => self.normals[i] * value.x,
            Motion::Free => value.truncate(),
        };
        values.iter().enumerate().map(|(i, value)| self.rest[i] + way(i, value)).collect()
    }

    /// The values that bring the points there, as far as the motion can.
    pub fn values(&self, motion: Motion, points: &[Vec3]) -> Vec<Vec4> {
        let ways: Vec<Vec3> = points.iter().zip(&self.rest).map(|(point, rest)| *point - *rest).collect();
        self.lanes(motion, &ways)
    }

    /// Adjoint of [`Points::displaced`] and [`Points::vertices`] together.
    pub fn adjoint(&self, motion: Motion, to_vertices: &[Vec3]) -> Vec<Vec4> {
        let mut to_points = vec![Vec3::ZERO; self.rest.len()];
        for (&point, gradient) in self.of_vertex.iter().zip(to_vertices) {
            to_points[point as usize] += *gradient;
        }
        self.lanes(motion, &to_points)
    }

    /// Adjoint of [`Points::displaced`] alone.
    pub fn lanes(&self, motion: Motion, to_points: &[Vec3]) -> Vec<Vec4> {
        let lanes = |i: usize, g: Vec3| match motion {
            Motion::Normal => Vec4::new(g.dot(self.normals[i]), 0.0, 0.0, 0.0),
            Motion::Free => g.extend(0.0),
        };
        to_points.iter().enumerate().map(|(i, &g)| lanes(i, g)).collect()
    }

    /// Each vertex's position.
    pub fn vertices(&self, points: &[Vec3]) -> Vec<Vec3> {
        self.of_vertex.iter().map(|&point| points[point as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seam() -> Points {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X, Vec3::Y, Vec3::ONE];
        let normals = [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::X, Vec3::Z, Vec3::Z];
        Points::new(&positions, &normals, &[[0, 1, 2], [3, 5, 4]])
    }

    /// Protects seams: vertices at one position are one point and stay together.
    #[test]
    fn seams_stay_closed() {
        let points = seam();
        assert_eq!(points.of_vertex, [0, 1, 2, 1, 2, 3]);
        assert_eq!(points.triangles, [[0, 1, 2], [1, 3, 2]]);
        let values: Vec<Vec4> = (0..4).map(|i| Vec4::new(i as f32, 0.5, -0.25, 0.0)).collect();
        let vertices = points.vertices(&points.displaced(Motion::Free, &values));
        assert_eq!((vertices[1], vertices[2]), (vertices[3], vertices[4]));
    }

    /// Protects the gradient: ⟨J a, b⟩ = ⟨a, Jᵀ b⟩ for both motions.
    #[test]
    fn adjoint_is_the_transpose() {
        let points = seam();
        for motion in [Motion::Normal, Motion::Free] {
            let values: Vec<Vec4> = (0..4)
                .map(|i| Vec4::new(i as f32 - 1.5, 0.5 * i as f32, 0.25, 0.0))
                .map(|v| if motion == Motion::Normal { Vec4::new(v.x, 0.0, 0.0, 0.0) } else { v })
                .collect();
            let weights: Vec<Vec3> = (0..6).map(|i| Vec3::new(1.0, i as f32, -0.5 * i as f32)).collect();
            let moved = points.vertices(&points.displaced(motion, &values));
            let rest = points.vertices(&points.rest);
            let left: f32 = moved.iter().zip(&rest).zip(&weights).map(|((m, h), w)| (*m - *h).dot(*w)).sum();
            let right: f32 =
                points.adjoint(motion, &weights).iter().zip(&values).map(|(g, v)| g.dot(*v)).sum();
            assert!((left - right).abs() < 1e-4, "{left} {right}");
            assert_eq!(points.values(motion, &points.displaced(motion, &values)).len(), 4);
        }
    }
}
