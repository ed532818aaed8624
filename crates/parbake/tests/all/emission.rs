//! Emission from glTF to glTF: fitted from views as every other map, written, and read back.

use crate::small_pair;
use parbake::{BakeOptions, EvaluateOptions, Limits, Model, Parallax, Preset};
use parbake::{bake, evaluate, read_model, write_glb};
use parbake_model::TextureSlot;

/// The small pair; the high-poly glows where its colours are bright.
fn glowing_pair() -> (Model, Model) {
    let (mut high, low) = small_pair();
    let mut glow = high.images[0].clone();
    for [r, g, b, _] in &mut glow.pixels {
        let bright = (u32::from(*r) + u32::from(*g) + u32::from(*b)) / 3 > 110;
        [*r, *g, *b] = if bright { [200, 60, 20] } else { [0; 3] };
    }
    high.images.push(glow);
    let material = &mut high.materials[0];
    material.emissive_texture = Some(TextureSlot { image: 1, ..TextureSlot::default() });
    material.emissive = [1.0; 3];
    (high, low)
}

fn quick(parallax: Parallax) -> BakeOptions {
    BakeOptions {
        texture_size: 64,
        preset: Preset::Fast,
        parallax,
        parallax_size: 16,
        cutout_size: 32,
        views: Some(24),
        view_size: Some(64),
        rounds: Some(2),
        ..BakeOptions::default()
    }
}

/// Protects what shines: it is written as emission and read back, looks closer to the high-poly than
/// the same bake without it, with parallax maps and without, and costs nothing where nothing shines.
#[test]
fn emission_is_fitted_written_and_read_back() {
    let (high, low) = glowing_pair();
    let options = EvaluateOptions { views: 6, resolution: 96, no_flip: true, ..EvaluateOptions::default() };
    let folder = tempfile::tempdir().expect("a folder can be made");
    for parallax in [Parallax::None, Parallax::Sh] {
        let baked = bake(&high, &low, &quick(parallax), &()).expect("the pair can be baked");
        let path = folder.path().join("glow.glb");
        write_glb(&path, &baked.model).expect("it can be written");
        let read = read_model(&path, &Limits::default()).expect("it can be read").model;
        let material = &read.materials[0];
        assert!(material.emissive_texture.is_some() && material.emissive == [1.0; 3]);
        let mut dark = read.clone();
        (dark.materials[0].emissive, dark.materials[0].emissive_texture) = ([0.0; 3], None);
        let psnr = |model: &Model| evaluate(&high, model, &options, &()).expect("it is seen").mean.psnr;
        let (with, without) = (psnr(&read), psnr(&dark));
        assert!(with > without + 3.0, "{parallax:?}: {with} {without}");
        assert!(baked.report.losses.iter().any(|loss| loss.moved == "emissive"));
    }
    let (plain, low) = small_pair();
    let baked = bake(&plain, &low, &quick(Parallax::None), &()).expect("the pair can be baked");
    assert!(baked.model.materials[0].emissive_texture.is_none());
}
