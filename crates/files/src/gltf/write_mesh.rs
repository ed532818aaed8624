//! A mesh in a GLB file: one primitive for each material in use, all on the same vertices, or one
//! for each run of triangles that repeat ([`super::runs`]).
//!
//! Coordinates that are all 65535ths, as [`parbake_model::short_uv`] makes them, take half the bytes where
//! they are many, and come back to the bit.

use super::binary::Binary;
use super::runs::{Run, runs};
use crate::unit::{unit, unit_tangent};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Mesh, Model};
use parbake_model::{is_short, nearest_short, short_uvs_pay};
use serde_json::{Value, json};

/// The primitives of a model's mesh; `used` are the materials that its triangles name, which
/// primitives name by their places there.
pub fn primitives(binary: &mut Binary, model: &Model, used: &[usize]) -> Vec<Value> {
    let mesh = repaired(model);
    let sets = [&mesh.uvs, &mesh.uvs1].map(|uvs| short_uvs_pay(uvs.len()) && uvs.iter().all(is_short));
    match runs(&mesh, stride(&mesh, sets)) {
        None => whole(binary, &mesh, sets, used),
        Some(runs) => in_runs(binary, &mesh, sets, &runs),
    }
}

fn whole(binary: &mut Binary, mesh: &Mesh, sets: [bool; 2], used: &[usize]) -> Vec<Value> {
    let attributes = attributes(binary, mesh, sets);
    let primitive = |(place, &material): (usize, &usize)| {
        let indices = binary.indices(&triangles_of(mesh, material), mesh.positions.len());
        json!({ "attributes": attributes, "indices": indices, "material": place })
    };
    used.iter().enumerate().map(primitive).collect()
}

/// Runs, which have one material; indices that an earlier run has are its.
fn in_runs(binary: &mut Binary, mesh: &Mesh, sets: [bool; 2], runs: &[Run]) -> Vec<Value> {
    let mut written: Vec<(&Run, usize)> = Vec::new();
    let mut primitives = Vec::with_capacity(runs.len());
    for run in runs {
        let same = written.iter().find(|(before, _)| before.triangles == run.triangles);
        let indices = match same {
            Some(&(_, indices)) => indices,
            None => binary.indices(&run.triangles, run.vertices.len()),
        };
        written.push((run, indices));
        let attributes = attributes(binary, &part(mesh, &run.vertices), sets);
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
}

fn triangles_of(mesh: &Mesh, material: usize) -> Vec<[u32; 3]> {
    let of = mesh.triangles.iter().zip(&mesh.triangle_materials);
    of.filter(|&(_, &m)| m as usize == material).map(|(t, _)| *t).collect()
}

/// The attributes of some of the vertices.
fn part(mesh: &Mesh, vertices: &[u32]) -> Mesh {
    fn picked<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
        if values.is_empty() { Vec::new() } else { vertices.iter().map(|&v| values[v as usize]).collect() }
    }
    Mesh {
        positions: picked(&mesh.positions, vertices),
        normals: picked(&mesh.normals, vertices),
        tangents: picked(&mesh.tangents, vertices),
        uvs: picked(&mesh.uvs, vertices),
        uvs1: picked(&mesh.uvs1, vertices),
        colors: picked(&mesh.colors, vertices),
        ..Mesh::default()
    }
}

fn attributes(binary: &mut Binary, mesh: &Mesh, sets: [bool; 2]) -> Value {
    let mut attributes = json!({ "POSITION": positions(binary, &mesh.positions) });
    if !mesh.normals.is_empty() {
        attributes["NORMAL"] = binary.floats("VEC3", mesh.normals.iter().map(|n| n.to_array())).into();
    }
    if !mesh.tangents.is_empty() {
        attributes["TANGENT"] = binary.floats("VEC4", mesh.tangents.iter().map(|t| t.to_array())).into();
    }
    for (set, uvs) in [&mesh.uvs, &mesh.uvs1].into_iter().enumerate().filter(|(_, uvs)| !uvs.is_empty()) {
        let accessor = if sets[set] {
            binary.normalised_shorts(uvs.iter().map(|uv| uv.to_array().map(nearest_short)))
        } else {
            binary.floats("VEC2", uvs.iter().map(|uv| uv.to_array()))
        };
        attributes[format!("TEXCOORD_{set}")] = accessor.into();
    }
    if !mesh.colors.is_empty() {
        attributes["COLOR_0"] = binary.floats("VEC4", mesh.colors.iter().map(|c| c.to_array())).into();
    }
    attributes
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
