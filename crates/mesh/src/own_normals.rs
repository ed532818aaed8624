//! Normals of a coarse copy: those that its model has at the same places.
//!
//! A vertex on a hard edge has several normals, one for each side. Where collapses merge them, the copy would be smooth there,
//! and its normal map would be read in tangent frames that it was not made for. So each corner of a triangle is projected
//! onto the model, from a point a little way into the triangle. Of the normals that the model has at the corner's position,
//! the corner takes the one that is nearest to the model's interpolated normal at that point. Where all of them are more
//! than 60° away, since what they belonged to has collapsed, it takes the interpolated normal.
//!
//! Contract: vertices of the copy are the model's own, and are split where their corners take several normals; positions,
//! texture coordinates and the order of triangles stay. Corners of triangles without area keep their normals. Normals that are
//! taken have unit length.

use crate::projection::HighSurface;
use crate::vertices::{drop_unused, push_copy};
use crate::weld::ordered_bits;
use parbake_model::Mesh;
use parbake_model::glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Where a corner is projected from: share of the way to the triangle's centroid.
const INWARDS: f32 = 0.3;
/// Cosine of the angle beyond which a normal of the vertex is not taken: 60°.
const NEAR: f32 = 0.5;

/// Gives each corner of `coarse` a normal of `model`. `surface` is the model's, and both lie in `place`'s frame, in which
/// the model's longest side is 1.
pub(crate) fn take_normals(
    coarse: &mut Mesh,
    model: &Mesh,
    surface: &HighSurface,
    place: impl Fn(Vec3) -> Vec3 + Sync,
) {
    let mut at: HashMap<[u32; 3], Vec<Vec3>> = HashMap::new();
    for (&position, &normal) in model.positions.iter().zip(&model.normals) {
        let own = at.entry(bits(position)).or_default();
        if let Some(unit) = normal.try_normalize().filter(|unit| !own.contains(unit)) {
            own.push(unit);
        }
    }
    let taken: Vec<[Option<Vec3>; 3]> = (0..coarse.triangles.len())
        .into_par_iter()
        .map(|triangle| {
            let corners = coarse.corners(triangle);
            let beside = normals_beside(corners.map(&place), model, surface);
            std::array::from_fn(|k| {
                let beside = beside[k]?;
                let own = at.get(&bits(corners[k])).into_iter().flatten();
                let nearest = own.copied().max_by(|a, b| a.dot(beside).total_cmp(&b.dot(beside)));
                nearest.filter(|normal| normal.dot(beside) > NEAR).or(Some(beside))
            })
        })
        .collect();
    let mut split: HashMap<(u32, [u32; 3]), u32> = HashMap::new();
    for (triangle, taken) in taken.iter().enumerate() {
        for (k, normal) in taken.iter().enumerate() {
            let vertex = coarse.triangles[triangle][k];
            let Some(normal) = *normal else { continue };
            let own = *split.entry((vertex, bits(normal))).or_insert_with(|| {
                let copy = push_copy(coarse, vertex);
                coarse.normals[copy as usize] = normal;
                copy
            });
            coarse.triangles[triangle][k] = own;
        }
    }
    drop_unused(coarse);
}

/// The model's interpolated unit normals beside the corners of a triangle, whose corners lie in the frame of `surface`.
fn normals_beside(corners: [Vec3; 3], model: &Mesh, surface: &HighSurface) -> [Option<Vec3>; 3] {
    /// How far along the triangle's normal the model is looked for, in lengths of its longest side.
    const REACH: f32 = 0.05;
    let middle = corners.into_iter().sum::<Vec3>() / 3.0;
    let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    corners.map(|corner| {
        let direction = face.try_normalize()?;
        let hit = surface.project_facing(corner.lerp(middle, INWARDS), direction, face, REACH)?;
        let [a, b, c] = model.triangles[hit.triangle as usize].map(|v| model.normals[v as usize]);
        let [second, third] = hit.barycentric;
        (a * (1.0 - second - third) + b * second + c * third).try_normalize()
    })
}

fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(ordered_bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simplify::{SimplifyOptions, simplify};
    use crate::smooth_normals;

    const CELLS: u32 = 16;

    /// A roof of two sheets that meet at a ridge along y, in facets of `CELLS`² squares; its normals are those of its sheets, or smooth.
    fn roof(is_smooth: bool) -> Mesh {
        let mut mesh = Mesh::default();
        for sheet in 0..2u32 {
            let first = mesh.positions.len() as u32;
            for (row, column) in (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| (row, column))) {
                let x = (sheet * CELLS + column) as f32 / CELLS as f32 - 1.0;
                mesh.positions.push(Vec3::new(x, row as f32 / CELLS as f32, 1.0 - x.abs()));
                mesh.normals.push(Vec3::new(sheet as f32 * 2.0 - 1.0, 0.0, 1.0).normalize());
            }
            for (row, column) in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column))) {
                let a = first + row * (CELLS + 1) + column;
                mesh.triangles.extend([[a, a + 1, a + CELLS + 2], [a, a + CELLS + 2, a + CELLS + 1]]);
            }
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        if is_smooth {
            mesh.normals = smooth_normals(&mesh);
        }
        mesh
    }

    fn coarse(mesh: &Mesh) -> Mesh {
        let mut coarse =
            simplify(mesh, SimplifyOptions { target_triangles: 40, ..SimplifyOptions::default() });
        coarse.normals = smooth_normals(&coarse);
        let surface = HighSurface::new(mesh);
        take_normals(&mut coarse, mesh, &surface, |p| p);
        coarse
    }

    /// Protects hard edges: on either side of the ridge triangles have the normal of their own sheet, and no texel or place moves.
    #[test]
    fn both_sides_of_a_hard_edge_keep_their_normals() {
        let coarse = coarse(&roof(false));
        for triangle in 0..coarse.triangles.len() {
            let face = coarse.area_normal(triangle).normalize();
            for vertex in coarse.triangles[triangle] {
                assert!((coarse.normals[vertex as usize] - face).length() < 1e-4, "{face}");
            }
        }
    }

    /// Protects what a modeller made smooth: there each vertex keeps one normal, the model's own, also on the ridge.
    #[test]
    fn smooth_edges_stay_smooth() {
        let model = roof(true);
        let coarse = coarse(&model);
        assert!(coarse.triangles.len() < 100);
        for (position, normal) in coarse.positions.iter().zip(&coarse.normals) {
            let own = model.positions.iter().zip(&model.normals).find(|(p, _)| *p == position);
            let (_, own) = own.expect("vertices are the model's own");
            assert!((*own - *normal).length() < 1e-4, "{normal} at {position}");
        }
    }

    /// Protects copies of parts that are gone: without a surface nothing is taken.
    #[test]
    fn nothing_is_taken_without_a_surface() {
        let mut coarse = roof(true);
        let before = coarse.clone();
        let empty = Mesh::default();
        take_normals(&mut coarse, &empty, &HighSurface::new(&empty), |p| p);
        assert_eq!(coarse.normals, before.normals);
    }
}
