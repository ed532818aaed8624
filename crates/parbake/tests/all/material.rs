//! A whole material, from model to written file.

use parbake::{BakeOptions, Limits, Preset, Shading, ShapeMode, bake, demo_pair, read_model, write_glb};

/// Protects metal, roughness and emission beyond 1: a shiny high-poly gives a shiny low-poly, also by
/// default, and files carry it; `lambert` leaves it out.
#[test]
fn a_shiny_model_stays_shiny() {
    let (mut high, low) = demo_pair();
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
