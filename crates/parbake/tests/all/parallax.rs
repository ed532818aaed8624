//! Parallax maps and cutouts through whole bakes of the built-in pair.

use crate::small_pair;
use parbake::{BakeOptions, Parallax, Preset};
use parbake::{Baked, EvaluateOptions, bake, demo_pair, evaluate, with_threads};
use parbake_model::glam::Vec3;
use parbake_model::{Model, TextureSlot};

fn quick(parallax: Parallax) -> BakeOptions {
    BakeOptions {
        texture_size: 32,
        preset: Preset::Fast,
        parallax,
        parallax_size: 16,
        cutout_size: 32,
        views: Some(48),
        view_size: Some(64),
        rounds: Some(1),
        ..BakeOptions::default()
    }
}

/// With enough that what maps gain does not hang on the seed.
fn baked(high: &Model, low: &Model, parallax: Parallax) -> Baked {
    let options = BakeOptions { texture_size: 64, views: Some(96), ..quick(parallax) };
    bake(high, low, &options, &()).expect("the pair can be baked")
}

/// Protects bytes, which must not depend on the number of threads.
#[test]
fn maps_do_not_depend_on_the_number_of_threads() {
    let (high, low) = small_pair();
    let baked = |threads| {
        let on = with_threads(threads, || bake(&high, &low, &quick(Parallax::Tangent), &()));
        on.expect("threads start").expect("the pair can be baked").model
    };
    assert!(baked(1) == baked(3), "threads change the result");
}

/// Protects what maps are for: on any background the model looks better with them.
#[test]
fn maps_improve_the_look() {
    let (high, low) = small_pair();
    let with = baked(&high, &low, Parallax::Tangent);
    let without = baked(&high, &low, Parallax::None);
    assert!(without.model.materials[0].parallax.is_none());
    for background in ["white", "0.9,0.1,0.2"] {
        let options = EvaluateOptions {
            views: 6,
            resolution: 96,
            background: background.into(),
            no_flip: true,
            ..EvaluateOptions::default()
        };
        let psnr = |low: &Model| evaluate(&high, low, &options, &()).unwrap().mean.psnr;
        let (better, worse) = (psnr(&with.model), psnr(&without.model));
        assert!(better > worse, "{background}: {better} {worse}");
    }
    assert_fallback_is_a_bake(&high, &with, &without);
    let report = with.report.parallax_maps.unwrap();
    let [before, after] = report.misplaced.unwrap();
    assert!(after < before && report.cross_chart[1] <= report.cross_chart[0]);
    assert!(report.mean_square.iter().all(|[first, last]| last < first));
    let [exact, rounded] = report.rounding;
    assert!(exact > 0.0 && rounded < 1.1 * exact, "8 bits do: {exact} {rounded}");
}

/// Protects viewers without the maps: they show the bake without maps, vertex by vertex, with textures that show no less.
fn assert_fallback_is_a_bake(high: &Model, with: &Baked, without: &Baked) {
    let (model, plain) = (&with.model, &without.model);
    let corners = |model: &Model| -> Vec<Vec3> {
        model.mesh.triangles.iter().flatten().map(|&v| model.mesh.positions[v as usize]).collect()
    };
    assert_eq!(corners(model), corners(plain));
    let material = &model.materials[0];
    let report = with.report.fallback.as_ref().expect("there are other viewers");
    let map = material.parallax.as_ref().expect("a map");
    let side = |slot: Option<TextureSlot>| slot.map(|slot| model.images[slot.image].width);
    // Many triangles in a small texture need all of its texels, be they their own or the maps'.
    assert!(report.tried.len() == 3 && report.side.is_none_or(|side| side == 64), "{report:?}");
    assert_eq!(side(material.base_color_texture), Some(64));
    assert_eq!(side(map.base_color_texture), report.side);
    let options = EvaluateOptions {
        views: 6,
        resolution: 96,
        no_parallax: true,
        no_flip: true,
        ..EvaluateOptions::default()
    };
    let psnr = |low: &Model| evaluate(high, low, &options, &()).expect("it has an extent").mean.psnr;
    let (fallback, plain) = (psnr(model), psnr(plain));
    assert!(fallback > plain - 0.3, "{fallback} {plain}");
}

/// Protects textures from maps that only make up for a coarse one's blur: where high-poly and low-poly
/// are the same there is no depth to show, and the finer pass begins anew; where they are not,
/// what the coarse pass found is kept.
#[test]
fn a_map_without_depth_to_show_begins_anew() {
    let (high, low) = demo_pair();
    // More than the first pass's 128 texels, so that there is a finer texture; a map that is fine enough for the relief.
    let options =
        BakeOptions { texture_size: 256, parallax_size: 32, view_size: Some(96), ..quick(Parallax::Tangent) };
    let begun_anew = |high: &Model, low: &Model| {
        let baked = bake(high, low, &options, &()).unwrap();
        baked.report.parallax_maps.unwrap().begun_anew
    };
    assert_eq!(begun_anew(&high, &low), 0);
    assert_eq!(begun_anew(&low, &low), 1);
}
