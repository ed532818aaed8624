//! The paper's UV method through whole bakes of the built-in pair.

use parbake::{BakeOptions, Method};
use parbake::{bake, demo_pair};

/// Protects the paper's method on models: coordinates move, by as many rounds as asked,
/// and what comes out is bijective.
#[test]
fn coordinates_move_and_stay_sound() {
    let (high, low) = demo_pair();
    let options = BakeOptions {
        texture_size: 32,
        method: Method::Paper,
        uv_steps: Some(4),
        views: Some(4),
        view_size: Some(32),
        rounds: Some(0),
        ..BakeOptions::default()
    };
    let baked = bake(&high, &low, &options, &()).unwrap();
    let report = baked.report.uv_stage.unwrap();
    assert_eq!(report.steps, 4);
    assert!(report.relative_error.iter().all(|e| e.is_finite()));
    assert!(baked.report.uv.is_bijective());
    let frames = baked.uv_moves.unwrap().frames;
    assert_ne!(frames.first(), frames.last());
}
