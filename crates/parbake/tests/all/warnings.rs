//! What a user is warned of in whole bakes of the built-in pair, and what is refused.

use parbake::{BakeError, BakeOptions, ShapeMode, UvMode, bake, demo_pair};

fn quick() -> BakeOptions {
    BakeOptions {
        texture_size: 64,
        uv: UvMode::Repair,
        shape: ShapeMode::Keep,
        views: Some(12),
        view_size: Some(64),
        rounds: Some(1),
        ..BakeOptions::default()
    }
}

/// Protects a user who gave the two models in the wrong order, and the one who did not from the warning.
#[test]
fn swapped_models_are_a_warning() {
    let (high, low) = demo_pair();
    let asks = |high, low| {
        let baked = bake(high, low, &quick(), &()).unwrap();
        baked.report.warnings.iter().any(|warning| warning.contains("are they swapped?"))
    };
    assert!(!asks(&high, &low));
    assert!(asks(&low, &high));
}

/// Protects from textures that nothing was learnt of: one view sees one side.
#[test]
fn many_unseen_texels_are_a_warning() {
    let (high, low) = demo_pair();
    let baked = bake(&high, &low, &BakeOptions { views: Some(1), ..quick() }, &()).unwrap();
    let warnings = &baked.report.warnings;
    assert!(warnings.iter().any(|warning| warning.contains("no training view saw")), "{warnings:?}");
}

/// Protects deadlines: a budget that cannot hold is refused before any work, with what is possible.
#[test]
fn a_budget_that_cannot_hold_is_refused() {
    let (high, low) = demo_pair();
    let options = BakeOptions { texture_size: 8192, time_budget: Some(10.0), ..quick() };
    let error = bake(&high, &low, &options, &()).unwrap_err();
    assert!(matches!(error, BakeError::Budget { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("94 s") && text.contains("--texture-size 2048"), "{text}");
}
