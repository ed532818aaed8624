//! A coarser copy of a mesh with its own layout: of many ways to collapse its edges, the one whose pictures are closest.
//!
//! How far seams may move, and how much normals and texture coordinates count beside positions, has no best answer for
//! all models. So a few ways are tried, each judged by pictures, and what lies beside the best ones.
//!
//! Contract: no more triangles than were asked for. Deterministic, as long as `is_over` says no; what was tried until it says
//! yes counts.

use crate::search::INVISIBLE;
use parbake_mesh::{Collapses, Seams, simplify_in_layout};
use parbake_model::Mesh;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// A model with more than so many triangles for each wanted one is first collapsed to a quarter of that number, once for all ways.
/// This saves time. What it costs: from 16 for each wanted one up to half a decibel was lost, from 64 it was not measured.
const MANY: usize = 256;
/// How many ways to collapse edges are tried first.
pub const FIRST_WAYS: usize = 9;
const COLLAPSES: [Collapses; FIRST_WAYS] = [
    Collapses { seams: Seams::Kept, normal_weight: 0.5, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.1, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.1, uv_weight: 0.5, moves: true },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.3, uv_weight: 0.2, moves: true },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.5, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.5, uv_weight: 0.5, moves: true },
    Collapses { seams: Seams::Crossed, normal_weight: 0.1, uv_weight: 0.5, moves: true },
    Collapses { seams: Seams::Crossed, normal_weight: 0.5, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::Crossed, normal_weight: 0.5, uv_weight: 0.5, moves: true },
];
/// Weights of normals and of texture coordinates that are tried around the best of these.
const NORMAL_WEIGHTS: [f32; 6] = [0.03, 0.1, 0.2, 0.3, 0.5, 1.0];
const UV_WEIGHTS: [f32; 4] = [0.05, 0.2, 0.5, 1.0];
/// Ways that are tried around the best one with the same seams, at most; only where that is at most so many decibels below
/// the best one of all, and that still shows what it lacks.
const MOST_SEARCHED: usize = 8;
const PROMISING: f64 = 2.0;

/// The mesh with at most `triangles` triangles whose pictures are closest to the original's, as `judged` returned it, with
/// its PSNR in dB: the best of nine first ways, or with `searches` what a search from there finds. None where seams leave
/// too many triangles.
///
/// # Errors
/// Those of `judged`.
pub fn best_collapsed<T, E>(
    mesh: &Mesh,
    triangles: usize,
    searches: bool,
    is_over: &dyn Fn() -> bool,
    mut judged: impl FnMut(Mesh) -> Result<(T, f64), E>,
) -> Result<Option<(T, f64)>, E> {
    let fine = begun(mesh, triangles);
    let mut best: Option<(T, f64)> = None;
    let mut tried: Vec<(Collapses, f64)> = Vec::new();
    // Of few triangles many ways make the same, whose pictures are known.
    let mut known: BTreeMap<u64, f64> = BTreeMap::new();
    let mut weigh = |tried: &mut Vec<(Collapses, f64)>, own: Collapses| -> Result<(), E> {
        let mesh = simplify_in_layout(&fine, triangles, own);
        if mesh.triangles.is_empty() || mesh.triangles.len() > triangles {
            tried.push((own, f64::NEG_INFINITY));
            return Ok(());
        }
        let fingerprint = fingerprint(&mesh);
        if let Some(&psnr) = known.get(&fingerprint) {
            tried.push((own, psnr));
            return Ok(());
        }
        let (made, psnr) = judged(mesh)?;
        known.insert(fingerprint, psnr);
        tried.push((own, psnr));
        if best.as_ref().is_none_or(|(_, most)| psnr > *most) {
            best = Some((made, psnr));
        }
        Ok(())
    };
    // With all triangles there is nothing to choose.
    let has_choice = mesh.triangles.len() > triangles;
    for own in COLLAPSES.into_iter().take(if has_choice { COLLAPSES.len() } else { 1 }) {
        if is_over() {
            break;
        }
        weigh(&mut tried, own)?;
    }
    for seams in
        [Seams::Kept, Seams::OfTextures, Seams::Crossed].into_iter().filter(|_| has_choice && searches)
    {
        for _ in 0..MOST_SEARCHED {
            let Some(next) = next(&tried, seams).filter(|_| !is_over()) else { break };
            weigh(&mut tried, next)?;
        }
    }
    Ok(best)
}

/// A number that meshes share whose triangles and vertices are the same to the bit.
fn fingerprint(mesh: &Mesh) -> u64 {
    let Mesh {
        positions,
        normals,
        tangents,
        uvs,
        uvs1,
        colors,
        parallax_offsets,
        triangles,
        triangle_materials,
    } = mesh;
    let mut hasher = DefaultHasher::new();
    for values in [positions, normals, parallax_offsets] {
        values.iter().for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    for values in [tangents, colors] {
        values.iter().for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    for values in [uvs, uvs1] {
        values.iter().for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    (triangles, triangle_materials).hash(&mut hasher);
    hasher.finish()
}

/// The mesh that all ways to collapse to so many triangles begin with: `mesh`, or a coarser one ([`MANY`]).
fn begun(mesh: &Mesh, triangles: usize) -> Cow<'_, Mesh> {
    if mesh.triangles.len() <= MANY * triangles {
        return Cow::Borrowed(mesh);
    }
    let coarser = simplify_in_layout(mesh, MANY / 4 * triangles, COLLAPSES[4]);
    if coarser.triangles.is_empty() { Cow::Borrowed(mesh) } else { Cow::Owned(coarser) }
}

/// What to try after all that was, with these seams: what is beside the best one. None where others are far better, nothing is left
/// to be gained, or all beside it were tried.
fn next(tried: &[(Collapses, f64)], seams: Seams) -> Option<Collapses> {
    let best =
        |own: &mut dyn Iterator<Item = &(Collapses, f64)>| own.copied().max_by(|a, b| a.1.total_cmp(&b.1));
    let (_, most) = best(&mut tried.iter())?;
    let (own, psnr) = best(&mut tried.iter().filter(|(own, _)| own.seams == seams))?;
    let is_known = |other: &Collapses| tried.iter().any(|(known, _)| known == other);
    (psnr.is_finite() && psnr >= most - PROMISING && most < INVISIBLE)
        .then(|| neighbours(own).into_iter().find(|other| !is_known(other)))
        .flatten()
}

/// Collapses with the same seams that differ in one thing, by a step.
fn neighbours(own: Collapses) -> Vec<Collapses> {
    let moved = Collapses { moves: !own.moves, ..own };
    let normals = beside(&NORMAL_WEIGHTS, own.normal_weight).into_iter();
    let uvs = beside(&UV_WEIGHTS, own.uv_weight).into_iter();
    (uvs.map(|uv_weight| Collapses { uv_weight, ..own }))
        .chain(normals.map(|normal_weight| Collapses { normal_weight, ..own }))
        .chain([moved])
        .collect()
}

/// The weights beside one of `weights`.
fn beside(weights: &[f32], own: f32) -> Vec<f32> {
    let place = weights.iter().position(|&weight| weight == own).unwrap_or(0);
    (0..weights.len()).filter(|k| k.abs_diff(place) == 1).map(|k| weights[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{vec2, vec3};

    /// Protects the search: it goes on from the best with the same seams, tries nothing twice, and leaves seams alone that show far
    /// less; it ends.
    #[test]
    fn the_search_climbs_from_the_best_with_the_same_seams() {
        let mut tried = vec![(COLLAPSES[0], 40.0), (COLLAPSES[2], 45.0), (COLLAPSES[8], 44.0)];
        assert_eq!(next(&tried, Seams::Kept), None);
        assert_eq!(next(&[(COLLAPSES[0], f64::NEG_INFINITY)], Seams::Kept), None);
        for (seams, best) in [(Seams::OfTextures, COLLAPSES[2]), (Seams::Crossed, COLLAPSES[8])] {
            let mut steps = 0;
            while let Some(found) = next(&tried, seams) {
                assert!(found.seams == seams && tried.iter().all(|(known, _)| *known != found));
                assert!(neighbours(best).contains(&found));
                tried.push((found, 43.5));
                steps += 1;
            }
            assert_eq!(steps, neighbours(best).len());
        }
        tried.push((Collapses { uv_weight: 1.0, ..COLLAPSES[8] }, 46.0));
        assert_eq!(next(&tried, Seams::Crossed).map(|own| own.uv_weight), Some(1.0));
        tried.push((Collapses { moves: false, ..COLLAPSES[2] }, 61.0));
        assert_eq!(next(&tried, Seams::OfTextures), None);
    }

    /// Protects time: ways to collapse a large mesh share what they begin with, which still leaves much to choose from.
    #[test]
    fn large_meshes_are_collapsed_once_for_all_ways() {
        let (cells, mut mesh) = (40u32, Mesh::default());
        for (row, column) in (0..=cells).flat_map(|row| (0..=cells).map(move |column| (row, column))) {
            let (x, y) = (column as f32 / cells as f32, row as f32 / cells as f32);
            mesh.positions.push(vec3(x, y, 0.1 * (9.0 * x).sin() * (7.0 * y).cos()));
            mesh.uvs.push(vec2(x, y));
        }
        for (row, column) in (0..cells).flat_map(|row| (0..cells).map(move |column| (row, column))) {
            let a = row * (cells + 1) + column;
            mesh.triangles.extend([[a, a + 1, a + cells + 2], [a, a + cells + 2, a + cells + 1]]);
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        mesh.normals = parbake_mesh::smooth_normals(&mesh);
        assert!(matches!(begun(&mesh, mesh.triangles.len().div_ceil(MANY)), Cow::Borrowed(_)));
        let few = begun(&mesh, 10).triangles.len();
        assert!((320..=640).contains(&few), "{few}");
    }

    /// Protects time: a mesh that several ways make is looked at once, and one that is anyhow different is not taken for it.
    #[test]
    fn the_same_mesh_is_looked_at_once() {
        let mesh = Mesh {
            positions: vec![
                vec3(0.0, 0.0, 0.0),
                vec3(1.0, 0.0, 0.0),
                vec3(0.0, 1.0, 0.0),
                vec3(1.0, 1.0, 0.0),
            ],
            normals: vec![vec3(0.0, 0.0, 1.0); 4],
            uvs: vec![vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(1.0, 1.0)],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        let mut looked = Vec::new();
        let judged = |mesh: Mesh| {
            looked.push(fingerprint(&mesh));
            Ok::<_, ()>((mesh.triangles.len(), 30.0))
        };
        let best = best_collapsed(&mesh, 1, true, &|| false, judged);
        looked.sort_unstable();
        let count = looked.len();
        looked.dedup();
        assert!(count == looked.len() && count < FIRST_WAYS, "{count} {best:?}");
        let mut other = mesh.clone();
        other.uvs[3].y += 1e-7;
        assert_ne!(fingerprint(&other), fingerprint(&mesh));
    }

    /// Protects it from weights that lie beside none.
    #[test]
    fn first_ways_have_weights_that_are_searched() {
        for own in COLLAPSES {
            assert!(NORMAL_WEIGHTS.contains(&own.normal_weight) && UV_WEIGHTS.contains(&own.uv_weight));
        }
    }
}
