//! Whole materials in comparisons: when they are shown, and what each channel's figure says.

use crate::jar;
use parbake_evaluate::channels::Channel;
use parbake_evaluate::conventions::Shading;
use parbake_evaluate::evaluate::{Evaluation, evaluate};
use parbake_evaluate::options::EvaluateOptions;
use parbake_model::{Clearcoat, Image, Model, TextureSlot, Transmission};

fn options() -> EvaluateOptions {
    EvaluateOptions { views: 3, resolution: 64, ..EvaluateOptions::default() }
}

fn psnr(of: &Evaluation, channel: Channel) -> f64 {
    of.channels.iter().find(|c| c.channel == channel).map_or(f64::NAN, |c| c.mean.psnr)
}

/// Protects what a figure points to: a fault of one map is found in its channel and in no other, outlines count in
/// opacity alone.
#[test]
fn a_fault_is_found_in_its_channel() {
    let high = jar(0.5, 1.0, 1.0);
    let rougher = evaluate(&high, &jar(0.6, 1.0, 1.0), &options(), &()).unwrap();
    assert_eq!(rougher.shading, Shading::Pbr);
    assert!((psnr(&rougher, Channel::Roughness) - 20.0).abs() < 0.01, "{:?}", rougher.channels);
    for channel in [Channel::BaseColor, Channel::Normal, Channel::Metallic, Channel::Opacity] {
        assert_eq!(psnr(&rougher, channel), 100.0, "{channel:?}");
    }
    // It is seen, too.
    assert!(rougher.mean.psnr < 60.0);
    let smaller = evaluate(&high, &jar(0.6, 1.0, 0.9), &options(), &()).unwrap();
    assert!((psnr(&smaller, Channel::Roughness) - 20.0).abs() < 0.01, "{:?}", smaller.channels);
    assert!(psnr(&smaller, Channel::BaseColor) > 90.0);
    assert!(psnr(&smaller, Channel::Opacity) < 20.0);
    // FLIP is for colours.
    let flip = |of: Channel| smaller.channels.iter().find(|c| c.channel == of).and_then(|c| c.mean.flip);
    assert!(flip(Channel::BaseColor).is_some() && flip(Channel::Roughness).is_none());
}

/// Protects the figures of plain models: by default they are those under a headlight, without channels; metal in
/// the high-poly brings the whole material, unless another shading is asked for, which the paper's convention does
/// not know.
#[test]
fn the_high_poly_decides_what_is_shown() {
    let shaded = |high: &Model, shading| {
        let found = evaluate(high, high, &EvaluateOptions { shading, ..options() }, &()).unwrap();
        (found.shading, found.channels.len())
    };
    let (plain, metal) = (jar(1.0, 0.0, 1.0), jar(0.5, 1.0, 1.0));
    assert_eq!(shaded(&plain, Shading::Auto), (Shading::Lambert, 0));
    assert_eq!(shaded(&metal, Shading::Auto), (Shading::Pbr, 5));
    // As a bake does, which writes the coat.
    let mut coated = jar(1.0, 0.0, 1.0);
    coated.materials[0].extensions.clearcoat = Some(Clearcoat { factor: 1.0, ..Clearcoat::default() });
    assert_eq!(shaded(&coated, Shading::Auto), (Shading::Pbr, 5));
    assert_eq!(shaded(&metal, Shading::Lambert), (Shading::Lambert, 0));
    assert_eq!(shaded(&plain, Shading::Pbr), (Shading::Pbr, 5));
    let paper = EvaluateOptions { views: 1, ..EvaluateOptions::paper() };
    assert_eq!(evaluate(&metal, &metal, &paper, &()).unwrap().shading, Shading::Lambert);
    let both = EvaluateOptions { shading: Shading::Pbr, ..paper };
    assert!(evaluate(&metal, &metal, &both, &()).is_err());
}

/// Protects figures of glass: a model is shown alike whether a file says with a factor or with an image how much
/// light passes.
#[test]
fn glass_is_shown_alike_however_it_is_written() {
    let mut factor = jar(0.2, 0.0, 1.0);
    factor.materials[0].extensions.transmission = Some(Transmission { factor: 0.5, texture: None });
    let mut image = factor.clone();
    let white = image.images.len();
    image.images.push(Image::solid("passes", 4, 4, [255; 4]));
    let slot = Some(TextureSlot { image: white, ..TextureSlot::default() });
    image.materials[0].extensions.transmission = Some(Transmission { factor: 0.5, texture: slot });
    assert_eq!(evaluate(&factor, &image, &options(), &()).unwrap().mean.psnr, 100.0);
}
