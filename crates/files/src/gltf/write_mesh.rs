//! A mesh in a GLB file: one primitive for each material in use, all on the same vertices, or one
//! for each run of triangles that repeat ([`super::runs`]), if nothing moves them.
//!
//! Coordinates that are all 65535ths, as [`parbake_model::short_uv`] makes them, take half the bytes where
//! they are many, and come back to the bit.

use super::binary::Binary;
use super::parallax::OFFSETS;
use super::quantise::{Grid, byte, signed_byte};
use super::runs::{Run, runs};
use super::write_rig;
use crate::unit::{unit, unit_tangent};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Mesh, Model};
use parbake_model::{is_short, nearest_short, short_uvs_pay};
use serde_json::{Value, json};

/// The primitives of a model's mesh; `used` are the materials that its triangles name, which
/// primitives name by their places there. With a grid, vertices are quantised.
pub fn primitives(binary: &mut Binary, model: &Model, used: &[usize], grid: Option<&Grid>) -> Vec<Value> {
    let mesh = repaired(model);
    let short = |uvs: &Vec<Vec2>| match grid {
        None => short_uvs_pay(uvs.len()) && uvs.iter().all(is_short),
        // Coordinates that tile stay floats.
        Some(_) => uvs.iter().all(|uv| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()),
    };
    let stored = Stored { short_sets: [&mesh.uvs, &mesh.uvs1].map(short), grid };
    if let Some(rig) = &model.rig {
        let mut primitives = whole(binary, &mesh, stored, used);
        write_rig::add_to_primitives(binary, &mut primitives, rig, mesh.positions.len(), grid);
        return primitives;
    }
    match runs(&mesh, stride(&mesh, stored.short_sets)) {
        None => whole(binary, &mesh, stored, used),
        Some(runs) => in_runs(binary, &mesh, stored, &runs),
    }
}

/// How vertices are stored.
#[derive(Clone, Copy)]
struct Stored<'a> {
    /// Which sets of texture coordinates take two bytes a channel.
    short_sets: [bool; 2],
    /// The grid of positions; all other attributes are bytes then.
    grid: Option<&'a Grid>,
}

fn whole(binary: &mut Binary, mesh: &Mesh, stored: Stored<'_>, used: &[usize]) -> Vec<Value> {
    let attributes = attributes(binary, mesh, stored);
    let primitive = |(place, &material): (usize, &usize)| {
        let indices = binary.indices(&triangles_of(mesh, material), mesh.positions.len());
        json!({ "attributes": attributes, "indices": indices, "material": place })
    };
    used.iter().enumerate().map(primitive).collect()
}

/// Runs, which have one material; indices that an earlier run has are its.
fn in_runs(binary: &mut Binary, mesh: &Mesh, stored: Stored<'_>, runs: &[Run]) -> Vec<Value> {
    let mut written: Vec<(&Run, usize)> = Vec::new();
    let mut primitives = Vec::with_capacity(runs.len());
    for run in runs {
        let same = written.iter().find(|(before, _)| before.triangles == run.triangles);
        let indices = match same {
            Some(&(_, indices)) => indices,
            None => binary.indices(&run.triangles, run.vertices.len()),
        };
        written.push((run, indices));
        let attributes = attributes(binary, &picked(mesh, &run.vertices), stored);
        primitives.push(json!({ "attributes": attributes, "indices": indices, "material": 0 }));
    }
    primitives
}

/// The mesh as it is written: normals and tangents of unit length, texture coordinates that a
/// material needs and the mesh lacks zeros, as
/// [`Mesh::corner_uvs`](parbake_model::Mesh::corner_uvs) has them.
fn repaired(model: &Model) -> Mesh {
    let mut mesh = model.mesh.clone();
    mesh.normals.iter_mut().for_each(|n| *n = unit(*n).unwrap_or(Vec3::Y));
    // Tangents without normals mean nothing.
    mesh.tangents.truncate(mesh.normals.len());
    mesh.tangents.iter_mut().zip(&mesh.normals).for_each(|(t, &n)| *t = unit_tangent(*t, n));
    let zeros = vec![Vec2::ZERO; mesh.positions.len()];
    let needed =
        |set: u8| model.materials.iter().flat_map(|m| m.all_texture_slots()).any(|s| s.uv_set >= set);
    if mesh.uvs1.is_empty() && needed(1) {
        mesh.uvs1.clone_from(&zeros);
    }
    // Sets are numbered without gaps, so that set 1 brings set 0 along.
    if mesh.uvs.is_empty() && (needed(0) || !mesh.uvs1.is_empty()) {
        mesh.uvs = zeros;
    }
    mesh.colors.iter_mut().for_each(|c| *c = c.clamp(Vec4::ZERO, Vec4::ONE));
    mesh
}

/// Bytes of a vertex; `sets` says which coordinates take two bytes each.
fn stride(mesh: &Mesh, sets: [bool; 2]) -> usize {
    let has = |length: usize, bytes: usize| if length > 0 { bytes } else { 0 };
    let uv = |short: bool| if short { 4 } else { 8 };
    12 + has(mesh.normals.len(), 12)
        + has(mesh.tangents.len(), 16)
        + has(mesh.uvs.len(), uv(sets[0]))
        + has(mesh.uvs1.len(), uv(sets[1]))
        + has(mesh.colors.len(), 16)
        + has(mesh.parallax_offsets.len(), 12)
}

fn triangles_of(mesh: &Mesh, material: usize) -> Vec<[u32; 3]> {
    let of = mesh.triangles.iter().zip(&mesh.triangle_materials);
    of.filter(|&(_, &m)| m as usize == material).map(|(t, _)| *t).collect()
}

/// The attributes of some of the vertices.
pub fn picked(mesh: &Mesh, vertices: &[u32]) -> Mesh {
    fn of<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
        if values.is_empty() { Vec::new() } else { vertices.iter().map(|&v| values[v as usize]).collect() }
    }
    Mesh {
        positions: of(&mesh.positions, vertices),
        normals: of(&mesh.normals, vertices),
        tangents: of(&mesh.tangents, vertices),
        uvs: of(&mesh.uvs, vertices),
        uvs1: of(&mesh.uvs1, vertices),
        colors: of(&mesh.colors, vertices),
        parallax_offsets: of(&mesh.parallax_offsets, vertices),
        ..Mesh::default()
    }
}

fn attributes(binary: &mut Binary, mesh: &Mesh, Stored { short_sets, grid }: Stored<'_>) -> Value {
    let small = grid.is_some();
    let positions = match grid {
        Some(grid) => quantised_positions(binary, &mesh.positions, grid),
        None => positions(binary, &mesh.positions),
    };
    let mut attributes = json!({ "POSITION": positions });
    if !mesh.normals.is_empty() {
        let normals = &mesh.normals;
        let accessor = if small {
            let rows = normals.iter().map(|n| n.extend(0.0).to_array().map(signed_byte));
            binary.normalised_bytes("VEC3", true, rows)
        } else {
            binary.floats("VEC3", normals.iter().map(|n| n.to_array()))
        };
        attributes["NORMAL"] = accessor.into();
    }
    if !mesh.tangents.is_empty() {
        let rows = mesh.tangents.iter().map(|t| t.to_array());
        let accessor = if small {
            binary.normalised_bytes("VEC4", true, rows.map(|t| t.map(signed_byte)))
        } else {
            binary.floats("VEC4", rows)
        };
        attributes["TANGENT"] = accessor.into();
    }
    for (set, uvs) in [&mesh.uvs, &mesh.uvs1].into_iter().enumerate().filter(|(_, uvs)| !uvs.is_empty()) {
        let accessor = if short_sets[set] {
            binary.normalised_shorts(uvs.iter().map(|uv| uv.to_array().map(nearest_short)))
        } else {
            binary.floats("VEC2", uvs.iter().map(|uv| uv.to_array()))
        };
        attributes[format!("TEXCOORD_{set}")] = accessor.into();
    }
    if !mesh.colors.is_empty() {
        let rows = mesh.colors.iter().map(|c| c.to_array());
        let accessor = if small {
            binary.normalised_bytes("VEC4", false, rows.map(|c| c.map(byte)))
        } else {
            binary.floats("VEC4", rows)
        };
        attributes["COLOR_0"] = accessor.into();
    }
    if !mesh.parallax_offsets.is_empty() {
        // In the unit of positions, which nodes or joints place.
        let unit = grid.map_or(1.0, Grid::unit);
        let rows = mesh.parallax_offsets.iter().map(|&offset| (offset / unit).to_array());
        attributes[OFFSETS] = binary.floats("VEC3", rows).into();
    }
    attributes
}

/// Positions as integers, and the bounds of these.
fn quantised_positions(binary: &mut Binary, positions: &[Vec3], grid: &Grid) -> usize {
    let integers: Vec<[u16; 3]> = positions.iter().map(|&p| grid.integers(p)).collect();
    let bound = |start: u16, fold: fn(u16, u16) -> u16| {
        integers.iter().fold([start; 3], |a, b| [fold(a[0], b[0]), fold(a[1], b[1]), fold(a[2], b[2])])
    };
    let bounds = [bound(u16::MAX, u16::min), bound(0, u16::max)];
    let accessor = binary.short_positions(integers.into_iter());
    binary.accessors[accessor]["min"] = json!(bounds[0]);
    binary.accessors[accessor]["max"] = json!(bounds[1]);
    accessor
}

/// Positions, which alone must have their bounds said.
fn positions(binary: &mut Binary, positions: &[Vec3]) -> usize {
    let accessor = binary.floats("VEC3", positions.iter().map(|p| p.to_array()));
    let bounds = |start: f32, fold: fn(Vec3, Vec3) -> Vec3| {
        let bound = positions.iter().fold(Vec3::splat(start), |a, &b| fold(a, b));
        // As doubles they are the very numbers in the buffer.
        json!(bound.to_array().map(f64::from))
    };
    let (min, max) = (bounds(f32::INFINITY, Vec3::min), bounds(f32::NEG_INFINITY, Vec3::max));
    binary.accessors[accessor]["min"] = min;
    binary.accessors[accessor]["max"] = max;
    accessor
}
