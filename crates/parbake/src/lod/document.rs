//! `lods.json`: what an importer needs to know of a chain, and what people want to.
//!
//! One number says where levels switch: the share of the screen's height that the model's longest side spans. From
//! it follow distances: with the vertical field of view φ the model spans that share at
//! `length / (2 · share · tan(φ / 2))`.
//!
//! Contract: the format has a version; fields are only added under the same version.

use super::level::LevelReport;
use super::options::LodOptions;
use parbake_evaluate::screen_size::AtSize;
use parbake_model::{Bounds, Model};
use serde::{Deserialize, Serialize};

/// Of the format.
const VERSION: u32 = 1;

/// What `lods.json` holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LodDocument {
    /// Of the format.
    pub version: u32,
    /// The model's name.
    pub name: String,
    /// Triangles of the original.
    pub source_triangles: usize,
    /// Length of the model's longest side in the files' unit.
    pub longest_side: f64,
    /// Centre of the model's box in the files' unit.
    pub centre: [f32; 3],
    /// Radius of the sphere around that box.
    pub radius: f64,
    /// Height in pixels of the screen that coverages are shares of.
    pub viewport_height: f64,
    /// PSNR in dB from which on a level cannot be told from the one before.
    pub switch_psnr: f64,
    /// The file that holds all levels, with `MSFT_lod`.
    pub all_levels: String,
    /// Of the whole run until all levels were written. Those of levels overlap: while one is baked, the next one is begun.
    #[serde(default)]
    pub seconds: f64,
    /// From fine to coarse.
    pub levels: Vec<LodEntry>,
}

/// A level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LodEntry {
    /// Its file, beside this one.
    pub file: String,
    /// The file's size.
    pub bytes: u64,
    /// The least share of the screen's height at which it is shown: the one at which the next level takes over, 0
    /// for the last.
    pub min_coverage: f64,
    /// PSNR, MS-SSIM and FLIP against the original where the next level takes over; none for the last.
    pub at_switch: Option<AtSize>,
    /// All else.
    #[serde(flatten)]
    pub report: LevelReport,
}

impl LodDocument {
    /// Of a chain whose levels were written to these files, in so many seconds.
    pub fn new(
        model: &Model,
        options: &LodOptions,
        all_levels: String,
        seconds: f64,
        levels: Vec<(String, u64, LevelReport)>,
    ) -> Self {
        let bounds = Bounds::of(&model.mesh);
        let (size, centre) = bounds.map_or_else(Default::default, |b| (b.size(), (b.min + b.max) * 0.5));
        let coverages = coverages(&levels.iter().map(|(_, _, report)| report.clone()).collect::<Vec<_>>());
        let switches: Vec<Option<AtSize>> =
            levels.iter().skip(1).map(|(_, _, next)| next.against_before).collect();
        let entry = |(index, (file, bytes, report)): (usize, (String, u64, LevelReport))| LodEntry {
            file,
            bytes,
            min_coverage: coverages[index],
            at_switch: switches.get(index).copied().flatten(),
            report,
        };
        Self {
            version: VERSION,
            name: model.name.clone(),
            source_triangles: model.mesh.triangles.len(),
            longest_side: f64::from(size.max_element()),
            centre: centre.to_array(),
            radius: f64::from(0.5 * size.length()),
            viewport_height: options.viewport_height,
            switch_psnr: options.switch_psnr,
            all_levels,
            seconds,
            levels: levels.into_iter().enumerate().map(entry).collect(),
        }
    }
}

/// For each level the share of the screen's height at which the next one takes over; 0 for the last. A level that can
/// always be told from the one before takes over where it would be smaller than a pixel's row of details: at the
/// least size that was tried.
pub fn coverages(levels: &[LevelReport]) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::new();
    for next in levels.iter().skip(1) {
        let own = next.switch_coverage.unwrap_or(MIN_COVERAGE);
        // Sizes descend, whatever was measured.
        let most = out.last().map_or(1.0, |last: &f64| 0.95 * last);
        out.push(own.min(most));
    }
    out.push(0.0);
    out
}

/// Where nothing that was measured says when to switch.
const MIN_COVERAGE: f64 = 0.005;
