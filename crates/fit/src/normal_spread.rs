//! Roughness for what normals do within a texel.
//!
//! A texel has one normal where the high-poly has many: scratches, scales, creases. Their highlights lie beside each
//! other; that of their mean alone is too small and too bright, as that of a rougher surface is not. With the spread
//! ⟨|Δ|²⟩ of the samples' normals about the fitted one,
//!
//! α'² = α² + c ⟨|Δ|²⟩, α = roughness²,
//!
//! after Olano and Baker 2010 (LEAN mapping) and Kaplanyan et al. 2016 (filtering distributions of normals). There c is 1
//! for Beckmann's distribution; GGX has wide tails as it is, and c = 0.2 was measured best under skies and lamps
//! (docs/algorithms/materials.md). The spread is what the training views see: what their pixels filter, as those of
//! viewers do, is not in it.
//!
//! Contract: roughness is only raised. Where it is one value all over, and so is metal, it stays one and costs no texture.
//! Bands are summed by themselves (`parbake_solve::grid`), so nothing depends on the number of threads.

use crate::problem::{footprint, local_places};
use parbake_image::{FloatImage, MapKind};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_solve::grid::gather;
use parbake_views::material_sample::MaterialSample;
use parbake_views::samples::{Fetched, SampleSet};
use rayon::prelude::*;

/// Share of the spread that widens a GGX highlight.
const SHARE: f32 = 0.2;

/// A sample whose normal is farther from the fitted one, as the length of the difference, shows another surface.
const ANOTHER: f32 = 0.7;

/// Values that differ by less are one.
const ROUNDING: f32 = 1.5 / 255.0;

/// Raises the roughness that samples ask for by the spread of their normals about these, which were fitted to them.
pub(crate) fn widen_highlights(samples: &mut SampleSet<MaterialSample>, normals: &FloatImage<Vec4>) {
    if is_one_value(samples) {
        return;
    }
    let spread = spread(samples, normals);
    let size = samples.size;
    samples.update(|sample| {
        let (texels, weights) = footprint(sample, size);
        let spread: f32 = texels.iter().zip(weights).map(|(texel, w)| spread[*texel] * w).sum();
        let roughness = sample.target(MapKind::MetallicRoughness).y;
        let raised = (roughness.powi(4) + SHARE * spread).sqrt().sqrt();
        sample.set_roughness(raised.clamp(roughness, 1.0));
    });
}

/// Whether all samples ask for the same roughness and metal, give or take rounding.
fn is_one_value(samples: &SampleSet<MaterialSample>) -> bool {
    let values =
        |band: usize| samples.band(band).iter().map(|sample| sample.target(MapKind::MetallicRoughness));
    let narrow = |[low, high]: [Vec4; 2], value: Vec4| [low.min(value), high.max(value)];
    let [low, high] = (0..samples.bands())
        .into_par_iter()
        .map(|band| values(band).fold([Vec4::ONE, Vec4::ZERO], narrow))
        .reduce(|| [Vec4::ONE, Vec4::ZERO], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    (high - low).max_element() < ROUNDING
}

/// Mean square of the difference in each texel.
fn spread(samples: &SampleSet<MaterialSample>, normals: &FloatImage<Vec4>) -> Vec<f32> {
    let size = samples.size;
    let mut sums = Vec::new();
    gather(
        size,
        &mut sums,
        |band, first, local: &mut [Vec2]| {
            for sample in samples.band(band) {
                let (texels, weights) = footprint(sample, size);
                let normal: Vec3 =
                    texels.iter().zip(weights).map(|(t, w)| normals.texels[*t].truncate() * w).sum();
                let difference = sample.target(MapKind::Normal).truncate() - normal.normalize_or(Vec3::Z);
                let square = difference.length_squared();
                if square > ANOTHER * ANOTHER {
                    continue;
                }
                for (place, w) in local_places(texels, first, size).into_iter().zip(weights) {
                    local[place] += Vec2::new(square, 1.0) * w * sample.weight();
                }
            }
        },
        |a, b| *a += *b,
    );
    sums.iter().map(|sum| if sum.y > 0.0 { sum.x / sum.y } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_image::MapValues;
    use parbake_model::glam::vec2;

    const SIZE: usize = 8;

    /// Every texel seen twice, with normals that lean by this much to either side, in the upper half of metal if `is_mixed`,
    /// and the roughness asked for after.
    fn roughness_after(lean: f32, roughness: f32, is_mixed: bool) -> Vec<f32> {
        let mut band = Vec::new();
        for texel in 0..SIZE * SIZE {
            let uv = vec2((texel % SIZE) as f32 + 0.5, (texel / SIZE) as f32 + 0.5) / SIZE as f32;
            let metal = f32::from(u8::from(is_mixed && texel < SIZE * SIZE / 2));
            for side in [-lean, lean] {
                let mut values = MapValues::NEUTRAL;
                values[MapKind::Normal] = Vec3::new(side, 0.0, 1.0).normalize().extend(0.0);
                values[MapKind::MetallicRoughness] = Vec4::new(0.0, roughness, metal, 0.0);
                band.push(MaterialSample::new(uv, SIZE, &values, [1.0, 0.0]));
            }
        }
        let mut samples = SampleSet::new(SIZE, &[band]);
        widen_highlights(&mut samples, &FloatImage::solid(SIZE, Vec4::Z));
        samples.iter().map(|sample| sample.target(MapKind::MetallicRoughness).y).collect()
    }

    /// Protects the look of rough ground from afar: normals that one texel cannot show make it rougher, by the formula.
    #[test]
    fn normals_within_a_texel_make_it_rougher() {
        let expected = (0.3f32.powi(4) + SHARE * 0.04).powf(0.25);
        assert!(roughness_after(0.2, 0.3, true).iter().all(|r| (r - expected).abs() < 2e-3), "{expected}");
    }

    /// Protects smooth surfaces from noise, other surfaces from being averaged, and factors from becoming textures.
    #[test]
    fn smooth_folded_and_plain_surfaces_keep_their_roughness() {
        for (lean, is_mixed) in [(0.0, true), (0.01, true), (3.0, true), (0.2, false)] {
            assert!(roughness_after(lean, 0.5, is_mixed).iter().all(|r| (r - 0.5).abs() < 1e-4), "{lean}");
        }
    }
}
