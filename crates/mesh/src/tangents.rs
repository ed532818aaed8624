//! Tangents by MikkTSpace (Mikkelsen, "Simulation of Wrinkled Surfaces
//! Revisited", 2008), the tangent space that bakers and engines agree on.
//!
//! Convention (glTF 2.0, 3.7.2.1 and 3.9.3): the tangent points towards growing
//! u, the bitangent w · n × t towards *decreasing* v, since our v grows downwards
//! and a normal map's green grows upwards. MikkTSpace is therefore fed (u, −v),
//! as exporters feed it (u, 1 − v): tangents do not see the difference.
//!
//! Contract: tangents are unit vectors with w = ±1; triangles keep their order,
//! and vertices their indices; a vertex whose corners need different tangents gets
//! copies at the end.

use crate::normals::ensure_normals;
use crate::union_find::UnionFind;
use crate::vertices::{any_orthogonal, push_copy};
use crate::weld::{ordered_bits, weld_by};
use mikktspace::Geometry;
use parbake_model::Mesh;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Fills `mesh.tangents`, and `mesh.normals` where there are none. Corners that
/// MikkTSpace says nothing of (no texture coordinates, no area in space or
/// texture) take over their vertex's tangent, or any one orthogonal to its normal,
/// with w = 1.
pub fn compute_tangents(mesh: &mut Mesh) {
    if mesh.normals.len() != mesh.positions.len() {
        ensure_normals(mesh);
    }
    mesh.tangents.clear();
    let corners = corner_tangents(mesh, PART);
    assign(mesh, &corners);
}

/// Triangles of a part at least, but for the last one.
const PART: usize = 4096;

/// One tangent for each corner of each triangle, where there is one. Parts of at least `part` triangles are worked on at the same time.
fn corner_tangents(mesh: &Mesh, part: usize) -> Vec<[Option<Vec4>; 3]> {
    let mut tangents = vec![[None; 3]; mesh.triangles.len()];
    if mesh.uvs.len() != mesh.positions.len() {
        return tangents;
    }
    let scaled = Scaled::new(mesh);
    // The reference implementation searches all triangles for each degenerate
    // one, to copy a tangent from its vertex, which `assign` does at once.
    let solid: Vec<u32> = (0..mesh.triangles.len() as u32)
        .filter(|&t| {
            let [a, b, c] = mesh.triangles[t as usize].map(|vertex| scaled.position(vertex as usize));
            a != b && b != c && c != a
        })
        .collect();
    let triangles_at = triangles_at_vertices(mesh);
    let parts = independent_parts(&scaled, &solid, part);
    let of_part = |(index, part): (usize, &Vec<u32>)| -> Vec<[Option<Vec4>; 3]> {
        let mut faces = part.clone();
        // MikkTSpace leaves the edges of its last vertex unsorted, and may not pair them. A triangle of another part takes that place.
        faces.extend(parts.get(index + 1).and_then(|next| next.first()));
        let mut own = vec![[None; 3]; faces.len()];
        let mut corners = Corners { scaled: &scaled, faces: &faces, tangents: &mut own };
        // It also walks round each vertex recursively, a stack frame per triangle.
        let at_corner =
            faces.iter().flat_map(|&t| mesh.triangles[t as usize]).map(|v| triangles_at[v as usize]);
        let frames = at_corner.max().unwrap_or(0) * 256;
        if frames < 256 * 1024 {
            mikktspace::generate_tangents(&mut corners);
        } else {
            std::thread::scope(|scope| {
                let thread = std::thread::Builder::new().stack_size(4 * frames + 1024 * 1024);
                // Without a thread there are no tangents but the fallback's.
                let _ = thread
                    .spawn_scoped(scope, || mikktspace::generate_tangents(&mut corners))
                    .map(|handle| handle.join());
            });
        }
        own
    };
    let each: Vec<_> = parts.par_iter().enumerate().map(of_part).collect();
    for (part, corners) in parts.iter().zip(each) {
        part.iter().zip(corners).for_each(|(&triangle, corners)| tangents[triangle as usize] = corners);
    }
    tangents
}

/// Triangles apart from each other to MikkTSpace, which looks only from a corner to others of the same position, normal and
/// coordinate: each part, of `least` triangles or more but for the last one, can be worked on alone. In each they keep their order.
fn independent_parts(scaled: &Scaled, solid: &[u32], least: usize) -> Vec<Vec<u32>> {
    if solid.len() < 2 * least {
        return if solid.is_empty() { Vec::new() } else { vec![solid.to_vec()] };
    }
    let mesh = scaled.mesh;
    let welded = weld_by(mesh.positions.len(), |i| {
        let ([x, y, z], [a, b, c]) = (scaled.position(i).to_array(), mesh.normals[i].to_array());
        let [u, v] = scaled.uv(i).to_array();
        [x, y, z, a, b, c, u, v].map(ordered_bits)
    });
    let mut sets = UnionFind::new(mesh.positions.len());
    for &triangle in solid {
        let [a, b, c] = mesh.triangles[triangle as usize].map(|vertex| welded[vertex as usize]);
        sets.union(a, b);
        sets.union(b, c);
    }
    let set_of = |triangle: u32, sets: &mut UnionFind| {
        sets.find(welded[mesh.triangles[triangle as usize][0] as usize]) as usize
    };
    let mut sizes = vec![0usize; mesh.positions.len()];
    solid.iter().for_each(|&triangle| sizes[set_of(triangle, &mut sets)] += 1);
    // Sets are put together by where they begin, until a part is large enough.
    let mut part_of = vec![usize::MAX; mesh.positions.len()];
    let mut parts: Vec<Vec<u32>> = Vec::new();
    let mut room = 0;
    for &triangle in solid {
        let set = set_of(triangle, &mut sets);
        if part_of[set] == usize::MAX {
            if room == 0 {
                parts.push(Vec::new());
                room = least;
            }
            part_of[set] = parts.len() - 1;
            room = room.saturating_sub(sizes[set]);
        }
        parts[part_of[set]].push(triangle);
    }
    parts
}

/// A power of two, which rounds nothing, that keeps products of three
/// coordinates from overflowing and those of ordinary meshes as they are.
fn taming_scale(largest: f32) -> f32 {
    if largest > 1e9 { 2f32.powi(-100) } else { 1.0 }
}

/// How many corners of triangles each vertex has, with those at the same position: vertices of equal attributes are one to
/// MikkTSpace.
fn triangles_at_vertices(mesh: &Mesh) -> Vec<usize> {
    let welded = crate::weld::weld_by_position(&mesh.positions);
    let mut counts = vec![0; mesh.positions.len()];
    for &vertex in mesh.triangles.iter().flatten() {
        counts[welded[vertex as usize] as usize] += 1;
    }
    welded.into_iter().map(|first| counts[first as usize]).collect()
}

/// A mesh whose coordinates are scaled so that MikkTSpace's products do not overflow.
struct Scaled<'a> {
    mesh: &'a Mesh,
    position_scale: f32,
    uv_scale: f32,
}

impl<'a> Scaled<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let largest = |values: &mut dyn Iterator<Item = f32>| values.fold(0.0, |m: f32, x| m.max(x.abs()));
        Self {
            mesh,
            position_scale: taming_scale(largest(&mut mesh.positions.iter().flat_map(|p| p.to_array()))),
            uv_scale: taming_scale(largest(&mut mesh.uvs.iter().flat_map(|uv| uv.to_array()))),
        }
    }

    fn position(&self, vertex: usize) -> Vec3 {
        self.mesh.positions[vertex] * self.position_scale
    }

    fn uv(&self, vertex: usize) -> Vec2 {
        self.mesh.uvs[vertex] * self.uv_scale
    }
}

/// Triangles as MikkTSpace wants them.
struct Corners<'a> {
    scaled: &'a Scaled<'a>,
    /// Indices of triangles with three different corners.
    faces: &'a [u32],
    /// Theirs, in the same order.
    tangents: &'a mut [[Option<Vec4>; 3]],
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.scaled.mesh.triangles[self.faces[face] as usize][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.faces.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.scaled.position(self.vertex(face, corner)).to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.scaled.mesh.normals[self.vertex(face, corner)].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.scaled.uv(self.vertex(face, corner));
        [uv.x, -uv.y]
    }

    fn set_tangent(
        &mut self,
        tangent: [f32; 3],
        bitangent: [f32; 3],
        length_u: f32,
        length_v: f32,
        preserves_orientation: bool,
        face: usize,
        corner: usize,
    ) {
        // What MikkTSpace leaves where it has nothing to say; no real tangent
        // space is an isometry to the last bit, and if one is, it is mirrored.
        let untouched = tangent == [1.0, 0.0, 0.0]
            && bitangent == [0.0, 1.0, 0.0]
            && (length_u, length_v, preserves_orientation) == (1.0, 1.0, false);
        let uvs = self.scaled.mesh.corner_uvs(self.faces[face] as usize);
        let no_area = (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]) == 0.0;
        let sign = if preserves_orientation { 1.0 } else { -1.0 };
        let unit = Vec3::from(tangent).try_normalize().filter(|_| !(untouched && no_area));
        self.tangents[face][corner] = unit.map(|t| t.extend(sign));
    }
}

/// Writes the corners' tangents to their vertices, copying a vertex for each
/// further tangent that its corners have.
fn assign(mesh: &mut Mesh, corners: &[[Option<Vec4>; 3]]) {
    const NONE: u32 = u32::MAX;
    let originals = mesh.positions.len();
    let mut tangents: Vec<Option<Vec4>> = vec![None; originals];
    // A chain through each vertex's copies.
    let mut next_copy = vec![NONE; originals];
    for (index, corner_tangents) in corners.iter().enumerate() {
        for (k, &tangent) in corner_tangents.iter().enumerate() {
            let Some(tangent) = tangent else { continue };
            let mut vertex = mesh.triangles[index][k];
            loop {
                let slot = &mut tangents[vertex as usize];
                if *slot.get_or_insert(tangent) == tangent {
                    break;
                }
                if next_copy[vertex as usize] == NONE {
                    let copy = push_copy(mesh, vertex);
                    tangents.push(Some(tangent));
                    next_copy.push(NONE);
                    next_copy[vertex as usize] = copy;
                }
                vertex = next_copy[vertex as usize];
            }
            mesh.triangles[index][k] = vertex;
        }
    }
    mesh.tangents = tangents
        .iter()
        .zip(&mesh.normals)
        .map(|(tangent, &normal)| tangent.unwrap_or_else(|| any_orthogonal(normal).extend(1.0)))
        .collect();
}

#[cfg(test)]
#[path = "tangents_tests.rs"]
mod tests;
