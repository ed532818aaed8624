//! Vertices through whole bakes of the built-in pair.

use crate::small_pair;
use parbake::{BakeOptions, Method, Preset, ShapeMode, UvMode};
use parbake::{bake, with_threads};
use parbake_model::Mesh;

fn quick(shape: ShapeMode) -> BakeOptions {
    BakeOptions {
        texture_size: 32,
        preset: Preset::Fast,
        uv: UvMode::Keep,
        shape,
        views: Some(12),
        view_size: Some(48),
        rounds: Some(0),
        ..BakeOptions::default()
    }
}

/// Seams are closed and no triangle has turned over.
fn is_sane(before: &Mesh, after: &Mesh) -> bool {
    let closed = (0..before.positions.len()).all(|i| {
        (0..i).all(|j| before.positions[i] != before.positions[j] || after.positions[i] == after.positions[j])
    });
    let facing = |t| before.area_normal(t).dot(after.area_normal(t)) > 0.0;
    closed && (0..before.triangles.len()).all(facing)
}

/// Protects the mesh: vertices move, and it stays what it was.
#[test]
fn vertices_move_and_the_mesh_stays_sane() {
    let (high, low) = small_pair();
    for (method, shape) in
        [(Method::Fit, ShapeMode::Free), (Method::Fit, ShapeMode::Normal), (Method::Paper, ShapeMode::Normal)]
    {
        let options = BakeOptions { method, uv_steps: Some(0), ..quick(shape) };
        let baked = bake(&high, &low, &options, &()).unwrap();
        assert_ne!(baked.model.mesh.positions, low.mesh.positions);
        assert!(is_sane(&low.mesh, &baked.model.mesh), "{shape:?}");
        let report = baked.report.shape.unwrap();
        assert!(report.steps > 0 && report.moved[1] > report.moved[0] && report.moved[0] > 0.0);
    }
}

/// Protects views of half the size, with which vertices that are far off begin: they bring outlines
/// closer, the mesh stays what it was, and threads change nothing.
#[test]
fn coarse_views_bring_outlines_closer_whatever_the_number_of_threads() {
    let (high, mut low) = small_pair();
    low.mesh.positions.iter_mut().for_each(|p| *p *= 1.06);
    let options = BakeOptions { view_size: Some(160), ..quick(ShapeMode::Free) };
    let baked = |threads| with_threads(threads, || bake(&high, &low, &options, &())).unwrap().unwrap();
    let one = baked(1);
    assert!(one.model == baked(3).model, "threads change the result");
    assert!(is_sane(&low.mesh, &one.model.mesh));
    let report = one.report.shape.unwrap();
    // In pixels, of which 160 show 1.4 times the model's length: coarse views are used at all.
    assert!(160.0 / 1.4 * report.gap[0] > 1.5, "{:?}", report.gap);
    assert!(report.gap[1] < 0.8 * report.gap[0], "{:?}", report.gap);
}

/// Protects who wants their vertices as they are.
#[test]
fn kept_vertices_are_kept_to_the_bit() {
    let (high, low) = small_pair();
    let baked = bake(&high, &low, &quick(ShapeMode::Keep), &()).unwrap();
    assert_eq!(baked.model.mesh.positions, low.mesh.positions);
    assert!(baked.report.shape.is_none());
}
