//! A whole material, from model to written file.

use crate::small_pair;
use parbake::{BakeOptions, Limits, Model, Preset, Shading, ShapeMode};
use parbake::{bake, read_model, write_glb};
use parbake_fit::material_problem::MaterialProblem;
use parbake_fit::problem::Problem;
use parbake_image::display::{Curve, Display};
use parbake_image::quantise::from_image;
use parbake_image::{FloatImage, MapKind, MapSet};
use parbake_model::glam::Vec4;
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;
use parbake_views::alpha_layers::{alpha_layers, layer_kinds};
use parbake_views::high_poly::{Conventions, HighPoly, ViewSet};
use parbake_views::low_poly::LowPoly;
use parbake_views::material_sampler::MaterialSampler;
use parbake_views::pool::Rig;
use parbake_views::reference::Sampling;

/// Protects metal, roughness and emission beyond 1: a shiny high-poly gives a shiny low-poly, also by
/// default, and files carry it; `lambert` leaves it out.
#[test]
fn a_shiny_model_stays_shiny() {
    let (mut high, low) = small_pair();
    for material in &mut high.materials {
        (material.metallic, material.roughness) = (1.0, 0.3);
        (material.emissive, material.emissive_strength) = ([0.0, 0.5, 0.0], 4.0);
    }
    let options = BakeOptions {
        texture_size: 64,
        preset: Preset::Fast,
        shape: ShapeMode::Keep,
        views: Some(24),
        ..BakeOptions::default()
    };
    let baked = bake(&high, &low, &options, &()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shiny.glb");
    write_glb(&path, &baked.model).unwrap();
    let read = read_model(&path, &Limits::default()).unwrap().model;
    let [material] = &read.materials[..] else { panic!("one material") };
    assert!(material.metallic > 0.99 && (material.roughness - 0.3).abs() < 0.01, "{material:?}");
    let emitted = material.emissive[1] * material.emissive_strength;
    assert!((emitted - 2.0).abs() < 0.05, "{emitted}");

    let matte = BakeOptions { shading: Shading::Lambert, ..options };
    let matte = bake(&high, &low, &matte, &()).unwrap().model;
    assert_eq!((matte.materials[0].metallic, matte.materials[0].roughness), (0.0, 1.0));
}

/// Protects models without colours, as sculptures are: their one colour stays a factor, which costs no texture and is right under any
/// light. `lambert` paints what a headlight shows of their shape.
#[test]
fn a_model_of_one_color_stays_so() {
    let (mut high, low) = small_pair();
    for material in &mut high.materials {
        (material.base_color_texture, material.base_color) = (None, [0.5, 0.2, 0.1, 1.0]);
    }
    let options = BakeOptions {
        texture_size: 64,
        preset: Preset::Fast,
        shape: ShapeMode::Keep,
        views: Some(24),
        ..BakeOptions::default()
    };
    let plain = bake(&high, &low, &options, &()).unwrap().model;
    let [material] = &plain.materials[..] else { panic!("one material") };
    assert!(material.base_color_texture.is_none() && material.normal_texture.is_some(), "{material:?}");
    let apart = |k: usize| (material.base_color[k] - [0.5, 0.2, 0.1][k]).abs();
    assert!((0..3).all(|k| apart(k) < 0.01), "{material:?}");
    let painted = BakeOptions { shading: Shading::Lambert, ..options };
    let painted = bake(&high, &low, &painted, &()).unwrap().model;
    assert!(painted.materials[0].base_color_texture.is_some());
}

/// How far the normals of a bake are from those that views see of the high-poly: their mean squared
/// difference.
fn error_of_normals(high: &Model, baked: &Model) -> f64 {
    let conventions = Conventions {
        interpretation: Interpretation::default(),
        display: Display { gain: 1.0, curve: Curve::Srgb },
        whole_material: Some(true),
        rig: Rig { radius: 3.5, projection: Projection::Perspective(0.4) },
        max_distance: 0.1,
    };
    let high = HighPoly::new(high, conventions).expect("it has an extent");
    let slot = baked.materials[0].normal_texture.expect("it has normals");
    let image = &baked.images[slot.image];
    let low = LowPoly::new(baked, &high.frame, image.width).expect("it has coordinates");
    let layers = alpha_layers(&layer_kinds(&low.placed, baked, &high), &high);
    let sampling = Sampling { size: 64, filter: 0.5, samples: 1 };
    let set = ViewSet { count: 24, seed: 7, jitter: true, sampling };
    let sampler = MaterialSampler { high: &high, low: &low.placed, layers: &layers, shift: None };
    let (samples, _) = sampler.samples(&set, image.width, &());
    let problem = MaterialProblem::new(&samples, &low.atlas, [MapKind::Normal].into_iter());
    let map = from_image(MapKind::Normal, image, true);
    let mut maps = MapSet::of(FloatImage::solid(image.width, Vec4::ONE), map);
    maps.insert(MapKind::MetallicRoughness, FloatImage::solid(image.width, Vec4::ONE));
    problem.loss(&maps).square / samples.len() as f64
}

/// Protects normals under any light: by default they are closer to the high-poly's than those that were
/// fitted to a headlight, and than projected ones.
#[test]
fn normals_are_those_of_the_high_poly() {
    let (high, low) = small_pair();
    let error = |options: BakeOptions| {
        let options = BakeOptions {
            texture_size: 64,
            preset: Preset::Fast,
            shape: ShapeMode::Keep,
            views: Some(96),
            ..options
        };
        error_of_normals(&high, &bake(&high, &low, &options, &()).unwrap().model)
    };
    let own = error(BakeOptions::default());
    let headlight = error(BakeOptions { shading: Shading::Lambert, ..BakeOptions::default() });
    let projected = error(BakeOptions { keep_normals: true, ..BakeOptions::default() });
    assert!(own < 0.9 * headlight && own < 0.9 * projected, "{own} {headlight} {projected}");
}
