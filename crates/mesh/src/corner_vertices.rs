//! A mesh's vertices made anew from its corners, for collapses of edges: corners that are equal in all that counts share a
//! vertex, whatever vertices the file has.
//!
//! Contract: a vertex has one material, so that the materials of triangles can be told from their vertices; it has the
//! attributes of its first corner, whose order vertices have.

use crate::weld::{ordered_bits, weld_by};
use parbake_model::Mesh;

/// Which attributes tell corners apart, besides position and material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToldApart {
    /// Texture coordinates of both sets, and colours.
    pub seams: bool,
    /// Normals.
    pub normals: bool,
    /// Tangents; the result has none otherwise.
    pub tangents: bool,
}

/// The mesh with vertices of its corners, without the materials of its triangles, and the material of each vertex.
pub(crate) fn corner_vertices(mesh: &Mesh, told_apart: ToldApart) -> (Mesh, Vec<u32>) {
    let ToldApart { seams, normals, tangents } = told_apart;
    let corners: Vec<(u32, u32)> = (mesh.triangles.iter().zip(&mesh.triangle_materials))
        .flat_map(|(triangle, &material)| triangle.map(|vertex| (vertex, material)))
        .collect();
    fn bits<const N: usize>(values: Option<[f32; N]>) -> [u32; 4] {
        let mut key = [0; 4];
        key.iter_mut().zip(values.iter().flatten()).for_each(|(k, &x)| *k = ordered_bits(x));
        key
    }
    let first = weld_by(corners.len(), |corner| {
        let (vertex, material) = corners[corner];
        let v = vertex as usize;
        [
            [material; 4],
            bits(Some(mesh.positions[v].to_array())),
            bits(mesh.uvs.get(v).filter(|_| seams).map(|x| x.to_array())),
            bits(mesh.uvs1.get(v).filter(|_| seams).map(|x| x.to_array())),
            bits(mesh.colors.get(v).filter(|_| seams).map(|x| x.to_array())),
            bits(mesh.normals.get(v).filter(|_| normals).map(|x| x.to_array())),
            bits(mesh.tangents.get(v).filter(|_| tangents).map(|x| x.to_array())),
        ]
    });
    // First corners become the vertices.
    let mut vertex_of = vec![0; corners.len()];
    let mut sources = Vec::new();
    for corner in 0..corners.len() {
        vertex_of[corner] = if first[corner] as usize == corner {
            sources.push(corners[corner]);
            sources.len() as u32 - 1
        } else {
            vertex_of[first[corner] as usize]
        };
    }
    fn pick<T: Copy>(values: &[T], sources: &[(u32, u32)]) -> Vec<T> {
        sources.iter().filter_map(|&(v, _)| values.get(v as usize).copied()).collect()
    }
    let made = Mesh {
        positions: pick(&mesh.positions, &sources),
        normals: pick(&mesh.normals, &sources),
        tangents: if tangents { pick(&mesh.tangents, &sources) } else { Vec::new() },
        uvs: pick(&mesh.uvs, &sources),
        uvs1: pick(&mesh.uvs1, &sources),
        colors: pick(&mesh.colors, &sources),
        parallax_offsets: pick(&mesh.parallax_offsets, &sources),
        triangles: vertex_of.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        triangle_materials: Vec::new(),
    };
    (made, sources.into_iter().map(|(_, material)| material).collect())
}
