//! The ways to shift texture coordinates of Table 1 and Fig. 19 (Knodt et al. 2023), side by
//! side: the same low-poly, texture coordinates, views and schedule for each.
//!
//! ```text
//! models ─ ground (views, samples, start) ─┬─ fit a map ─ keep it ─ solve for textures ─ render
//!                                          └─ … for each variant
//! ```
//!
//! Contract: maps and textures are rendered as they come back from 8 bits; figures are those of
//! views that no fit has seen. Asked to stop, it leaves out the variants that are left.

mod ground;
mod html;
mod look;
mod measured_heights;
mod options;
mod report;
mod stored;

pub use html::variants_html;
pub use options::VariantsOptions;
pub use report::{VariantFigures, VariantsReport};

use ground::Ground;
use parbake::{BakeError, Watcher};
use parbake_metric::Rgb;
use parbake_model::{Basis, Model};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::parallax_variants::height::{HeightParallax, Variant};
use parbake_render::parallax_variants::heights::Heights;
use parbake_render::parallax_variants::neural::NeuralParallax;
use parbake_render::parallax_variants::shift_map::Unshifted;

/// A comparison with its pictures.
#[derive(Clone, Debug)]
pub struct ComparedVariants {
    /// All figures.
    pub report: VariantsReport,
    /// The high-poly from each of the sides to look at, display-referred.
    pub high: Vec<Rgb>,
    /// Each variant from the same sides.
    pub pictures: Vec<Vec<Rgb>>,
}

/// Fits and compares all variants. Runs on rayon's current thread pool.
///
/// # Errors
/// Options out of range; a high-poly without extent; a low-poly without texture coordinates,
/// with flat ones, or outside of all views.
pub fn compare_variants(
    high: &Model,
    low: &Model,
    options: &VariantsOptions,
    watcher: &dyn Watcher,
) -> Result<ComparedVariants, BakeError> {
    options.check()?;
    let subject = ground::Subject::new(high, low, options, watcher)?;
    let ground = Ground::new(&subject, options, watcher);
    let heights = |variant| {
        let flat = HeightParallax::flat(variant, options.height_size, options.height_scale);
        match &subject.heights {
            Some(measured) => {
                let heights = Heights { level: measured.heights.clone(), ..flat.heights };
                HeightParallax { heights, scale: measured.scale, ..flat }
            }
            None => flat,
        }
    };
    let harmonics = |order| ParallaxCoefficients::zeros(Basis::Harmonics(order), options.parallax_size);
    let variants = [
        Some(ground.variant("no parallax", Unshifted, watcher)),
        ground.next("parallax", || heights(Variant::Parallax), watcher),
        ground.next("offset limiting", || heights(Variant::OffsetLimited), watcher),
        ground.next("steep parallax", || heights(Variant::Steep), watcher),
        ground.next("parallax occlusion", || heights(Variant::Occlusion), watcher),
        ground.next("SH, order 3", || harmonics(3), watcher),
        ground.next("SH, order 7", || harmonics(7), watcher),
        ground.next("small network", NeuralParallax::default, watcher),
    ];
    let (variants, pictures) = variants.into_iter().flatten().unzip();
    let report = VariantsReport {
        options: options.clone(),
        variants,
        views: options.held_out,
        stopped_early: watcher.stopped(),
    };
    Ok(ComparedVariants { report, high: ground.high_sides(), pictures })
}

#[cfg(test)]
mod tests;
