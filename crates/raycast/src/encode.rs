//! Maps of shape as numbers of 16 bits, and what black and white stand for.
//!
//! A stored share s of 0 … 1 (the number over 65535) stands for black + s · (white − black), in each channel.
//! Directions and ρ H have −1 … 1, occlusion 0 … 1; thickness goes from 0 to what 95 % of texels on the
//! surface stay below, since the rims of thin sheets, which are as deep as those are wide, would leave all else dark; height goes as far
//! to either side as its largest, so that half grey is 0; positions have the high-poly's cube, whose sides are
//! as long as its longest and whose centre is the centre of its box.

use crate::map::GeometryMap;
use parbake_image::FloatImage;
use parbake_model::Placement;
use parbake_model::glam::{Vec3, Vec4};

/// A map as numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoded {
    /// Texels along a side.
    pub size: usize,
    /// 1 or 3.
    pub channels: usize,
    /// size² · channels numbers, row 0 on top.
    pub samples: Vec<u16>,
    /// What 0 stands for in each channel; lengths in the model's unit.
    pub black: Vec<f32>,
    /// What 65535 stands for.
    pub white: Vec<f32>,
}

/// Encodes a map that was cast in this frame, of whose texels those that are `known` lie on the surface.
pub fn encode(map: GeometryMap, image: &FloatImage<Vec4>, known: &[bool], frame: &Placement) -> Encoded {
    let largest = image.texels.iter().fold(0.0f32, |most, texel| most.max(texel.x.abs()));
    let largest = if map == GeometryMap::Thickness { most_stay_below(image, known) } else { largest };
    // A map of nothing has a range all the same.
    let largest = if largest > 0.0 { largest } else { 1.0 };
    let [low, high] = match map {
        GeometryMap::Occlusion => [0.0, 1.0],
        GeometryMap::Thickness => [0.0, largest],
        GeometryMap::Height => [-largest, largest],
        GeometryMap::BentNormal
        | GeometryMap::ObjectNormal
        | GeometryMap::Curvature
        | GeometryMap::Position => [-1.0, 1.0],
    };
    let channels = map.channels();
    let stored = |x: f32| (((x - low) / (high - low)).clamp(0.0, 1.0) * 65535.0 + 0.5) as u16;
    let samples =
        image.texels.iter().flat_map(|texel| texel.to_array().into_iter().take(channels)).map(stored);
    let ends = |end: f32| match map {
        GeometryMap::Position => (Vec3::splat(end) / frame.scale + frame.centre).to_array().to_vec(),
        GeometryMap::Thickness | GeometryMap::Height => vec![end / frame.scale],
        _ => vec![end; channels],
    };
    Encoded { size: image.width, channels, samples: samples.collect(), black: ends(low), white: ends(high) }
}

/// The value in x that 95 % of these texels do not exceed.
fn most_stay_below(image: &FloatImage<Vec4>, known: &[bool]) -> f32 {
    let own = image.texels.iter().zip(known).filter(|(_, known)| **known);
    let mut values: Vec<f32> = own.map(|(texel, _)| texel.x).collect();
    let place = (values.len() * 95 / 100).min(values.len().saturating_sub(1));
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(place, f32::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects who reads the numbers: the range that is told gives the lengths of the model back.
    #[test]
    fn ranges_give_lengths_back() {
        let frame = Placement { centre: Vec3::new(10.0, 0.0, 0.0), scale: 0.5 };
        let image = FloatImage::square(1, vec![Vec4::new(-0.25, 0.5, 1.0, 0.0)]);
        let decoded = |map| {
            let Encoded { samples, black, white, .. } = encode(map, &image, &[true], &frame);
            let ends = black.into_iter().zip(white);
            samples
                .iter()
                .zip(ends)
                .map(|(&s, (b, w))| b + f32::from(s) / 65535.0 * (w - b))
                .collect::<Vec<_>>()
        };
        let near = |found: Vec<f32>, wanted: &[f32]| {
            assert_eq!(found.len(), wanted.len());
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?} {wanted:?}");
        };
        near(decoded(GeometryMap::Position), &[9.5, 1.0, 2.0]);
        near(decoded(GeometryMap::Height), &[-0.5]);
        near(decoded(GeometryMap::ObjectNormal), &[-0.25, 0.5, 1.0]);
        near(decoded(GeometryMap::Curvature), &[-0.25]);
    }

    /// Protects thickness from a few deep rims, and from what gutters repeat of them.
    #[test]
    fn thickness_is_scaled_by_most_of_the_surface() {
        let depth = |i: usize| if i.is_multiple_of(30) { 5.0 } else { 0.001 * i as f32 };
        let image = FloatImage::square(10, (0..100).map(|i| Vec4::splat(depth(i))).collect());
        let known: Vec<bool> = (0..100).map(|i| i < 60).collect();
        let frame = Placement { centre: Vec3::ZERO, scale: 2.0 };
        let Encoded { black, white, samples, .. } = encode(GeometryMap::Thickness, &image, &known, &frame);
        assert!(black == [0.0] && (white[0] - 0.0295).abs() < 1e-6, "{black:?} {white:?}");
        assert_eq!((samples[0], samples[59]), (65535, 65535));
        assert!(samples[1] < 1200);
    }
}
