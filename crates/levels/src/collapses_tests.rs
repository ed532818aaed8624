//! Tests of `collapses.rs`.

#![allow(clippy::unwrap_used)]

use super::*;
use parbake_model::glam::{Vec3, vec2, vec3};

/// Protects the search: it goes on from the best with the same seams, tries nothing twice, and leaves seams alone that show far
/// less; it ends.
#[test]
fn the_search_climbs_from_the_best_with_the_same_seams() {
    let of = |seams| COLLAPSES.into_iter().find(|own| own.seams == seams).unwrap_or(BEGIN);
    let [kept, of_textures, crossed] = [Seams::Kept, Seams::OfTextures, Seams::Crossed].map(of);
    let mut tried = vec![(kept, 40.0), (of_textures, 45.0), (crossed, 44.0)];
    assert_eq!(next(&tried, Seams::Kept), None);
    assert_eq!(next(&[(kept, f64::NEG_INFINITY)], Seams::Kept), None);
    for (seams, best) in [(Seams::OfTextures, of_textures), (Seams::Crossed, crossed)] {
        let mut steps = 0;
        while let Some(found) = next(&tried, seams) {
            assert!(found.seams == seams && tried.iter().all(|(known, _)| *known != found));
            assert!(neighbours(best).contains(&found));
            tried.push((found, 43.5));
            steps += 1;
        }
        assert_eq!(steps, neighbours(best).len());
    }
    tried.push((Collapses { normal_weight: 1.0, ..crossed }, 46.0));
    assert_eq!(next(&tried, Seams::Crossed).map(|own| own.normal_weight), Some(1.0));
    tried.push((Collapses { normal_weight: 1.0, ..of_textures }, 61.0));
    assert_eq!(next(&tried, Seams::OfTextures), None);
}

/// Protects time: ways to collapse a large mesh share what they begin with, which still leaves much to choose from.
#[test]
fn large_meshes_are_collapsed_once_for_all_ways() {
    let mesh = sheet(40);
    assert!(matches!(begun(&mesh, mesh.triangles.len().div_ceil(MANY)), Cow::Borrowed(_)));
    let few = begun(&mesh, 10).triangles.len();
    assert!((320..=640).contains(&few), "{few}");
}

/// Finds all copies alike and lists them.
struct Looks<'l>(&'l mut Vec<u64>);

impl Judge for Looks<'_> {
    type Made = Mesh;
    type Error = ();

    fn judged(&mut self, copy: Mesh) -> Result<(Mesh, f64), ()> {
        self.0.push(fingerprint(&copy));
        Ok((copy, 30.0))
    }

    fn lost(&mut self, _: &Mesh, finer: &Mesh) -> Vec<Lost> {
        (0..finer.triangles.len() as u32).map(|of_finer| Lost { of_copy: 0, of_finer, error: 1.0 }).collect()
    }

    fn mesh(made: &Mesh) -> &Mesh {
        made
    }
}

/// Protects time: a mesh that several ways make is looked at once, and one that is anyhow different is not taken for it.
#[test]
fn the_same_mesh_is_looked_at_once() {
    let mesh = Mesh {
        positions: vec![vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(1.0, 1.0, 0.0)],
        normals: vec![vec3(0.0, 0.0, 1.0); 4],
        uvs: vec![vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(1.0, 1.0)],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        triangle_materials: vec![0; 2],
        ..Mesh::default()
    };
    let mut looked = Vec::new();
    let best = best_collapsed(&mesh, 1, true, &|| false, Looks(&mut looked));
    looked.sort_unstable();
    let count = looked.len();
    looked.dedup();
    assert!(count == looked.len() && count < FIRST_WAYS && best.is_ok_and(|best| best.is_some()), "{count}");
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

/// A wavy sheet of so many cells along a side.
fn sheet(cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
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
    mesh
}

/// Whether a vertex is where one was, or has moved by less than a third of a cell of [`sheet`]`(20)`.
fn is_near(copy: &Mesh, place: Vec3) -> bool {
    copy.positions.iter().any(|p| p.distance(place) < 0.015)
}

/// Says that a copy lacks what it has not of these vertices, and that each of them is worth a decibel.
struct Wants(Vec<u32>);

impl Judge for Wants {
    type Made = Mesh;
    type Error = ();

    fn judged(&mut self, copy: Mesh) -> Result<(Mesh, f64), ()> {
        let finer = sheet(20);
        let has = |v: &&u32| is_near(&copy, finer.positions[**v as usize]);
        let count = self.0.iter().filter(has).count();
        Ok((copy, 30.0 + count as f64))
    }

    fn lost(&mut self, made: &Mesh, finer: &Mesh) -> Vec<Lost> {
        let lacks = |v: &u32| !is_near(made, finer.positions[*v as usize]);
        let around = |(of_copy, v): (usize, u32)| {
            let triangles = (0..).zip(&finer.triangles).filter(move |(_, triangle)| triangle.contains(&v));
            triangles.map(move |(of_finer, _)| Lost { of_copy: of_copy as u32, of_finer, error: 1.0 })
        };
        self.0.clone().into_iter().filter(lacks).enumerate().flat_map(around).collect()
    }

    fn mesh(made: &Mesh) -> &Mesh {
        made
    }
}

/// Protects what pictures ask for: vertices that copies lack where they are wrong come back, and the number of triangles
/// holds.
#[test]
fn vertices_come_back_where_pictures_miss_them() {
    let mesh = sheet(20);
    let plain = COLLAPSES.map(|way| simplify_in_layout(&mesh, 150, way, &[]));
    let lacks = |v: &u32| plain.iter().all(|copy| !is_near(copy, mesh.positions[*v as usize]));
    let inside = |v: &u32| (2..19).contains(&(v / 21)) && (2..19).contains(&(v % 21));
    let wanted: Vec<u32> = (0..441).filter(inside).filter(lacks).step_by(20).collect();
    let best = best_collapsed(&mesh, 150, true, &|| false, Wants(wanted.clone())).unwrap().unwrap();
    assert!(wanted.len() > 3, "{}", wanted.len());
    assert!(best.1 > 30.0 + 0.6 * wanted.len() as f64, "{} of {}", best.1 - 30.0, wanted.len());
    assert!((75..=150).contains(&best.0.triangles.len()));
}
