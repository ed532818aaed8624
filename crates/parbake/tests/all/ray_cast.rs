//! What a bake is compared with: a ray-cast bake of the low-poly as it was delivered.

use crate::small_pair;
use parbake::{BakeOptions, EvaluateOptions, Preset, ShapeMode, UvMode};
use parbake::{Detail, Metrics, bake, compare_bake, compared_as, evaluate_on};

fn quick() -> BakeOptions {
    BakeOptions {
        texture_size: 64,
        preset: Preset::Fast,
        views: Some(24),
        view_size: Some(64),
        rounds: Some(1),
        ..BakeOptions::default()
    }
}

/// Protects the comparison from flattery: whatever moves in a bake, the other side of the comparison is
/// what a plain bake of the delivered low-poly gives, to the bit.
#[test]
fn the_baseline_is_a_plain_bake() {
    let (high, low) = small_pair();
    let plain = BakeOptions { uv: UvMode::Keep, shape: ShapeMode::Keep, rounds: Some(0), ..quick() };
    let plain = bake(&high, &low, &plain, &()).unwrap();
    let moved = bake(&high, &low, &quick(), &()).unwrap();
    assert_ne!(moved.model.mesh.positions, low.mesh.positions, "vertices move");
    assert_eq!(moved.ray_cast.mesh.positions, low.mesh.positions);
    assert_eq!(moved.ray_cast.mesh.uvs, low.mesh.uvs);
    assert!(moved.ray_cast.images == plain.ray_cast.images, "the same maps");
}

/// Protects low-polys without coordinates: the baseline gets those that `repair` makes, and its own vertices.
#[test]
fn a_baseline_without_coordinates_is_repaired() {
    let (high, mut low) = small_pair();
    low.mesh.uvs.clear();
    let moved = bake(&high, &low, &quick(), &()).unwrap();
    assert_eq!(moved.ray_cast.mesh.triangles.len(), low.mesh.triangles.len());
    assert!(!moved.ray_cast.mesh.uvs.is_empty());
    let is_delivered = |p| low.mesh.positions.contains(p);
    assert!(moved.ray_cast.mesh.positions.iter().all(is_delivered), "vertices are the delivered ones");
}

/// Protects one figure everywhere: what terminal, report and JSON show is what `evaluate` gives.
#[test]
fn the_figures_are_those_of_evaluate() {
    let (high, low) = small_pair();
    let baked = bake(&high, &low, &quick(), &()).unwrap();
    let comparison = compare_bake(
        &high,
        &baked,
        Detail { metrics: Metrics { ms_ssim: true, flip: false }, channels: false },
        &(),
    )
    .unwrap();
    let options = EvaluateOptions { no_flip: true, ..compared_as(&baked.report.options) };
    let names: Vec<&str> = comparison.backgrounds.iter().map(|on| on.background.as_str()).collect();
    let own = evaluate_on(&high, &baked.model, &options, &names, &()).unwrap();
    for (on, own) in comparison.backgrounds.iter().zip(own) {
        assert_eq!(on.mean.baked, own.mean, "{}", on.background);
    }
}
