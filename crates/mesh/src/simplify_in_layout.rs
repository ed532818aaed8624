//! Simplification that leaves a model its own texture coordinates, normals, tangents and colours (meshoptimizer:
//! Garland and Heckbert 1997, with attributes after Hoppe 1999).
//!
//! Where a level keeps a good part of its model's triangles, nothing shows the model as well as its own vertices with
//! its own textures. Edges collapse, and positions and attributes follow the quadrics.
//!
//! Contract: corners keep their material; the result has the attributes that the mesh has. It may have more triangles
//! than were asked for, where seams are in the way.

use crate::corner_vertices::{ToldApart, corner_vertices};
use crate::simplify::{UnitBox, texture_scale};
use crate::vertices::drop_unused;
use crate::weld::{ordered_bits, weld_by_position};
use meshopt::{SimplifyOptions as Flags, SimplifyVertex};
use parbake_model::Mesh;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use std::collections::BTreeSet;

/// Per vertex: texture coordinate, normal, colour.
const ATTRIBUTES: usize = 9;
/// How bad colours are that differ by 1, compared with a surface that moves by the longest side of its bounding box.
const COLOR_WEIGHT: f32 = 0.5;

/// What may become of seams, where vertices at one point differ in their attributes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seams {
    /// All stay, those of normals alone as well.
    Kept,
    /// Those of textures and materials stay; edges collapse across those of normals.
    OfTextures,
    /// Edges collapse across all but those of materials.
    Crossed,
}

/// How edges collapse. Weights are 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collapses {
    /// What becomes of seams.
    pub seams: Seams,
    /// How bad normals are that turn by a radian, compared with a surface that moves by the longest side of its bounding
    /// box.
    pub normal_weight: f32,
    /// How bad a texture is that slips along the surface, compared with a surface that moves by as much.
    pub uv_weight: f32,
    /// Whether vertices move to where the quadrics want them; else each is one of the mesh's own.
    pub moves: bool,
    /// Whether triangles become more even in size and shape, which costs positions and attributes a little.
    pub evens: bool,
}

/// A coarser mesh of about `triangles` triangles, at least 1; the mesh itself where it has no more than that. `favoured` are vertices of
/// `mesh`: they, and those at the same places, resist as if their own surface had to stay in place, and others make room.
pub fn simplify_in_layout(mesh: &Mesh, triangles: usize, collapses: Collapses, favoured: &[u32]) -> Mesh {
    let Collapses { seams, normal_weight, uv_weight, moves, evens } = collapses;
    let Some(unit) = UnitBox::of(mesh).filter(|_| mesh.triangles.len() > triangles) else {
        return mesh.clone();
    };
    let (mut work, materials) =
        corner_vertices(mesh, ToldApart { seams: true, normals: true, tangents: true });
    // They belong to maps of an earlier bake.
    work.parallax_offsets.clear();
    let mut positions: Vec<[f32; 3]> = work.positions.iter().map(|&p| unit.place(p).to_array()).collect();
    let scale = scale_of_texture(&work, &positions);
    let mut values = values(&work, scale);
    let mut weights = [0.0; ATTRIBUTES];
    weights[..2].fill(if scale > 0.0 { uv_weight } else { 0.0 });
    weights[2..5].fill(if work.normals.is_empty() { 0.0 } else { normal_weight });
    weights[5..].fill(if work.colors.is_empty() { 0.0 } else { COLOR_WEIGHT });
    let mut locks = locks(&work, &materials, seams);
    favour(&mut locks, &work, favoured.iter().map(|&vertex| mesh.positions[vertex as usize]));
    let mut indices = work.triangles.as_flattened().to_vec();
    let (count, stride) = (3 * triangles.max(1), ATTRIBUTES * size_of::<f32>());
    let mut flags = if seams == Seams::Kept { Flags::None } else { Flags::Permissive };
    flags.set(Flags::RegularizeLight, evens);
    if moves {
        let (positions, values) = (&mut positions, &mut values);
        let kept = meshopt::simplify_with_update(
            &mut indices,
            positions,
            values,
            &weights,
            stride,
            Some(&locks),
            count,
            1.0,
            flags,
            None,
        );
        indices.truncate(kept);
        work.positions = positions.iter().map(|&p| unit.back(Vec3::from(p))).collect();
        take_values(&mut work, values, scale);
    } else {
        indices = meshopt::simplify_with_attributes_and_locks_decoder(
            &indices, &positions, &values, &weights, stride, &locks, count, 1.0, flags, None,
        );
    }
    work.triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    work.triangle_materials = work.triangles.iter().map(|t| materials[t[0] as usize]).collect();
    drop_unused(&mut work);
    work
}

/// The scale at which texture coordinates count; none where they are absurd.
fn scale_of_texture(mesh: &Mesh, positions: &[[f32; 3]]) -> f64 {
    let scale = texture_scale(mesh, positions);
    let greatest = mesh.uvs.iter().map(|uv| f64::from(uv.abs().max_element())).fold(0.0, f64::max);
    if scale * greatest < 1e6 { scale } else { 0.0 }
}

/// The attributes of all vertices, [`ATTRIBUTES`] each; texture coordinates times `scale`.
fn values(mesh: &Mesh, scale: f64) -> Vec<f32> {
    let mut values = Vec::with_capacity(ATTRIBUTES * mesh.positions.len());
    for v in 0..mesh.positions.len() {
        let uv = (mesh.uvs.get(v).copied().unwrap_or_default().as_dvec2() * scale).as_vec2();
        let color = mesh.colors.get(v).copied().unwrap_or(Vec4::ONE);
        values.extend(uv.to_array());
        values.extend(mesh.normals.get(v).copied().unwrap_or_default().to_array());
        values.extend(color.to_array());
    }
    values
}

/// Takes over attributes that moved; normals and tangents become unit vectors again.
fn take_values(mesh: &mut Mesh, values: &[f32], scale: f64) {
    let of = |v: usize| &values[ATTRIBUTES * v..ATTRIBUTES * (v + 1)];
    if scale > 0.0 {
        for (v, uv) in mesh.uvs.iter_mut().enumerate() {
            *uv = (Vec2::from_slice(of(v)).as_dvec2() / scale).as_vec2();
        }
    }
    for (v, normal) in mesh.normals.iter_mut().enumerate() {
        *normal = Vec3::from_slice(&of(v)[2..]).try_normalize().unwrap_or(*normal);
    }
    for (v, color) in mesh.colors.iter_mut().enumerate() {
        *color = Vec4::from_slice(&of(v)[5..]).clamp(Vec4::ZERO, Vec4::ONE);
    }
    for (tangent, normal) in mesh.tangents.iter_mut().zip(&mesh.normals) {
        let across = tangent.truncate().reject_from_normalized(*normal);
        *tangent = across.try_normalize().unwrap_or(tangent.truncate()).extend(tangent.w);
    }
}

/// Which vertices lie on a seam that stays.
fn locks(mesh: &Mesh, materials: &[u32], seams: Seams) -> Vec<SimplifyVertex> {
    let mut locks = vec![SimplifyVertex::None; mesh.positions.len()];
    if seams == Seams::Kept {
        return locks;
    }
    let has_uvs = seams == Seams::OfTextures && !mesh.uvs.is_empty();
    for (vertex, &first) in weld_by_position(&mesh.positions).iter().enumerate() {
        let first = first as usize;
        let differs =
            materials[vertex] != materials[first] || (has_uvs && mesh.uvs[vertex] != mesh.uvs[first]);
        if differs {
            locks[vertex] = SimplifyVertex::Protect;
            locks[first] = SimplifyVertex::Protect;
        }
    }
    locks
}

/// Marks the vertices at these places to be kept where that can be.
fn favour(locks: &mut [SimplifyVertex], mesh: &Mesh, places: impl Iterator<Item = Vec3>) {
    let bits = |place: Vec3| place.to_array().map(ordered_bits);
    let favoured: BTreeSet<[u32; 3]> = places.map(bits).collect();
    for (lock, &place) in locks.iter_mut().zip(&mesh.positions).filter(|_| !favoured.is_empty()) {
        if favoured.contains(&bits(place)) {
            *lock |= SimplifyVertex::Priority;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::vec2;

    const CELLS: u32 = 12;

    /// A wavy sheet of two halves along x, each a chart and a material of its own; texture coordinates are linear in x and
    /// y, in the second half mirrored and shifted. Colours follow y.
    fn sheet() -> Mesh {
        let mut mesh = Mesh::default();
        for half in 0..2u32 {
            let first = mesh.positions.len() as u32;
            for (row, column) in (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| (row, column))) {
                let (x, y) = ((half * CELLS + column) as f32 / CELLS as f32, row as f32 / CELLS as f32);
                mesh.positions.push(Vec3::new(x, y, 0.02 * (9.0 * x).sin() * (7.0 * y).cos()));
                mesh.normals.push(Vec3::Z);
                mesh.tangents.push(Vec3::X.extend(1.0 - 2.0 * half as f32));
                mesh.uvs.push(uv_at(half, x, y));
                mesh.colors.push(Vec3::splat(0.5 * y).extend(1.0));
            }
            for (row, column) in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column))) {
                let a = first + row * (CELLS + 1) + column;
                mesh.triangles.extend([[a, a + 1, a + CELLS + 2], [a, a + CELLS + 2, a + CELLS + 1]]);
            }
            mesh.triangle_materials.resize(mesh.triangles.len(), half);
        }
        mesh
    }

    fn uv_at(half: u32, x: f32, y: f32) -> Vec2 {
        if half == 0 { vec2(0.4 * x, 0.4 * y) } else { vec2(0.4 * (2.0 - x), 0.5 + 0.4 * y) }
    }

    fn ways() -> Vec<Collapses> {
        let seams = [Seams::Kept, Seams::OfTextures, Seams::Crossed];
        let switches = [(false, false), (true, false), (true, true)];
        let of = |seams| {
            switches.map(|(moves, evens)| Collapses {
                seams,
                normal_weight: 0.1,
                uv_weight: 0.5,
                moves,
                evens,
            })
        };
        seams.into_iter().flat_map(of).collect()
    }

    /// Protects textures: a coarser surface shows the same texels, charts and materials at the same places, however edges
    /// collapse, and tangents keep their side.
    #[test]
    fn attributes_follow_the_surface() {
        let mesh = sheet();
        for way in ways() {
            let coarse = simplify_in_layout(&mesh, 120, way, &[]);
            assert!((60..=120).contains(&coarse.triangles.len()), "{way:?}: {}", coarse.triangles.len());
            for (triangle, &half) in coarse.triangles.iter().zip(&coarse.triangle_materials) {
                for v in triangle.map(|v| v as usize) {
                    let p = coarse.positions[v];
                    assert!((coarse.uvs[v] - uv_at(half, p.x, p.y)).length() < 1e-3, "{way:?} at {p}");
                    assert!((coarse.colors[v].x - 0.5 * p.y).abs() < 0.01, "{way:?} at {p}");
                    assert_eq!(coarse.tangents[v].w, 1.0 - 2.0 * half as f32);
                    assert!((half == 0 && p.x < 1.001) || (half == 1 && p.x > 0.999), "{way:?} at {p}");
                }
            }
        }
    }

    /// Protects outlines in viewers that take few samples a pixel: where vertices do not move, each is the model's own.
    #[test]
    fn vertices_stay_in_place() {
        let mesh = sheet();
        for way in ways() {
            let coarse = simplify_in_layout(&mesh, 120, way, &[]);
            let is_own = |p: &Vec3| mesh.positions.contains(p);
            assert_eq!(coarse.positions.iter().all(is_own), !way.moves, "{way:?}");
        }
    }

    /// Protects details that pictures ask for: most favoured vertices stay where others would have been kept, and the number of
    /// triangles holds.
    #[test]
    fn favoured_vertices_stay() {
        let mesh = sheet();
        let way = ways()[3];
        let has = |coarse: &Mesh, v: u32| coarse.positions.contains(&mesh.positions[v as usize]);
        let without = simplify_in_layout(&mesh, 120, way, &[]);
        let inside = |v: &u32| mesh.uvs[*v as usize].x % 0.4 > 0.05 && mesh.uvs[*v as usize].y % 0.5 > 0.05;
        let lost = (0..mesh.positions.len() as u32).filter(|&v| !has(&without, v));
        let favoured: Vec<u32> = lost.filter(inside).step_by(9).collect();
        let with = simplify_in_layout(&mesh, 120, way, &favoured);
        let kept = favoured.iter().filter(|&&v| has(&with, v)).count();
        assert!(10 * kept >= 8 * favoured.len() && kept >= 8, "{kept} of {}", favoured.len());
        assert!((60..=120).contains(&with.triangles.len()));
    }

    /// Protects models that nothing is asked of, and meshes without attributes.
    #[test]
    fn little_is_asked_of_little() {
        let mesh = sheet();
        let way = ways()[7];
        assert_eq!(simplify_in_layout(&mesh, mesh.triangles.len(), way, &[]), mesh);
        assert!(simplify_in_layout(&Mesh::default(), 5, way, &[]).triangles.is_empty());
        let Mesh { positions, triangles, triangle_materials, .. } = mesh;
        let bare = Mesh { positions, triangles, triangle_materials, ..Mesh::default() };
        let coarse = simplify_in_layout(&bare, 120, way, &[]);
        assert!(coarse.triangles.len() <= 120 && coarse.uvs.is_empty() && coarse.normals.is_empty());
    }
}
