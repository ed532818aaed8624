//! Normals of a coarse copy: those that its model has at the same places.
//!
//! Where edges collapse across seams of normals, a vertex keeps one position and loses track of its normals: smooth ones
//! would round off every hard edge of the model, and normal maps would be read in frames that they were not made for. So
//! each corner of a triangle looks at the model a little way into the triangle, and takes that normal of the model's
//! vertices at its position which is nearest to what it sees there. Where all of them look elsewhere, since what was
//! between has collapsed, it takes what it sees.
//!
//! Contract: vertices of the copy are the model's own, and are split where their corners take several normals; positions,
//! texture coordinates and the order of triangles stay. Corners that see nothing keep their normals.

use crate::projection::HighSurface;
use crate::vertices::{drop_unused, push_copy};
use crate::weld::ordered_bits;
use parbake_model::Mesh;
use parbake_model::glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// How far into the triangle a corner looks: share of the way to its middle.
const INWARDS: f32 = 0.3;
/// Cosine of the angle at which a vertex's normal looks elsewhere: 60°.
const ELSEWHERE: f32 = 0.5;

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
            let seen = seen_from(corners.map(&place), model, surface);
            std::array::from_fn(|k| {
                let seen = seen[k]?;
                let own = at.get(&bits(corners[k])).into_iter().flatten();
                let nearest = own.copied().max_by(|a, b| a.dot(seen).total_cmp(&b.dot(seen)));
                nearest.filter(|normal| normal.dot(seen) > ELSEWHERE).or(Some(seen))
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

/// The model's unit normals as the corners of a triangle see them.
fn seen_from(corners: [Vec3; 3], model: &Mesh, surface: &HighSurface) -> [Option<Vec3>; 3] {
    /// How far outside its triangles the model is looked for, in lengths of its longest side.
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
    fn nothing_is_taken_where_nothing_is_seen() {
        let mut coarse = roof(true);
        let before = coarse.clone();
        let empty = Mesh::default();
        take_normals(&mut coarse, &empty, &HighSurface::new(&empty), |p| p);
        assert_eq!(coarse.normals, before.normals);
    }
}
