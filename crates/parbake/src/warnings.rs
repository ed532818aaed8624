//! What the user is told of a pair of models, as it is found and again in the report.

use crate::options::BakeOptions;
use parbake_image::MapKind;
use parbake_model::Model;
use parbake_progress::{Message, Watcher};
use parbake_views::high_poly::HighPoly;

/// What the user is told of as it is found, and reads again in the report.
pub(crate) struct Warnings<'a> {
    watcher: &'a dyn Watcher,
    /// All so far.
    pub told: Vec<String>,
}

impl<'a> Warnings<'a> {
    /// None yet.
    pub fn new(watcher: &'a dyn Watcher) -> Self {
        Self { watcher, told: Vec::new() }
    }

    /// Tells the watcher, and remembers.
    pub fn tell(&mut self, found: impl IntoIterator<Item = String>) {
        for warning in found {
            self.watcher.message(Message::Warning(warning.clone()));
            self.told.push(warning);
        }
    }
}

/// A low-poly has more triangles than its high-poly by more than this factor only where the two are swapped.
const SWAPPED: usize = 2;

/// A word about models that are likely in each other's place. A plain low-poly for a textured high-poly is
/// not, however fine it is: a scan with its colours on a coarser mesh than the model's own is a good pair.
pub(crate) fn swapped(high: &HighPoly, low: &Model) -> Option<String> {
    let (of_low, of_high) = (low.mesh.triangles.len(), high.triangles);
    let has_pictures = low.materials.iter().any(|material| material.base_color_texture.is_some());
    let only_high = high.scene.has(MapKind::BaseColor) && !has_pictures;
    (of_low > SWAPPED * of_high && !only_high).then(|| {
        format!(
            "the low-poly {} has {of_low} triangles and the high-poly {} {of_high}: are they swapped?",
            low.name, high.name
        )
    })
}

/// A word about options that act on plain materials alone, where whole ones are fitted.
pub(crate) fn for_plain_materials(model: &str, options: &BakeOptions) -> Option<String> {
    let own = BakeOptions::default();
    let has_silhouette = options.silhouette.is_some();
    let has_background = options.silhouette_background != own.silhouette_background;
    let is_flat = options.parallax_plan().is_none();
    let idle = [
        (options.robust_scale.is_some(), "--robust-scale"),
        (has_silhouette && is_flat, "--silhouette"),
        (has_background && is_flat, "--silhouette-background"),
    ];
    let idle: Vec<&str> = idle.into_iter().filter(|(is_idle, _)| *is_idle).map(|(_, name)| name).collect();
    (!idle.is_empty()).then(|| {
        format!(
            "{model}: whole materials are fitted here, and only plain ones follow {}; for these give --shading lambert",
            idle.join(" and ")
        )
    })
}

/// Share of the texels on the surface that no view saw from which on it is worth a word.
const UNSEEN_WORTH_A_WORD: f64 = 0.05;

/// A word about texels that no training view saw.
pub(crate) fn unseen(model: &str, unseen: usize, covered: usize) -> Option<String> {
    let share = unseen as f64 / covered.max(1) as f64;
    (share > UNSEEN_WORTH_A_WORD).then(|| {
        format!(
            "{model}: no training view saw {:.0} % of the texels on the surface, which are as projected or filled from \
             their neighbours; parts that nothing shows are no loss, else try more --views, a larger --view-size \
             or --time-budget, or a smaller --texture-size",
            100.0 * share
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Parallax;

    /// Protects time spent on options that do nothing: those that whole materials do not follow are named, and those of
    /// the outline act on parallax maps.
    #[test]
    fn idle_options_are_named() {
        let own = BakeOptions::default;
        let told = |options: BakeOptions| for_plain_materials("m", &options);
        assert_eq!(told(own()), None);
        let both = told(BakeOptions { robust_scale: Some(0.5), silhouette: Some(1.0), ..own() });
        assert!(both.is_some_and(|text| text.contains("follow --robust-scale and --silhouette;")));
        let parallax = BakeOptions { silhouette: Some(1.0), parallax: Parallax::Tangent, ..own() };
        assert_eq!(told(parallax), None);
    }
}
