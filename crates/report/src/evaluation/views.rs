//! Which views of a comparison are looked at, and their pictures.
//!
//! Contract: those that differ most come first, then the one in the middle and the best, none twice; of views that are
//! alike the first one. Where all are alike one is shown.

use crate::html::pictures::AMPLIFIED;
use crate::page::amplified_difference;
use parbake::{BakeError, EvaluateOptions, PlacedModel, Renderer, ViewFigures};
use parbake_metric::Rgb;

/// Names of the views that differ most, as many as are shown.
const WORST: [&str; 6] =
    ["worst", "second worst", "third worst", "fourth worst", "fifth worst", "sixth worst"];

/// A view that is looked at.
pub struct ChosenView {
    /// Which, from 0.
    pub index: usize,
    /// Where it stands among all.
    pub why: &'static str,
    /// Decibels.
    pub psnr: f64,
}

/// Its pictures.
pub struct ShownView {
    /// Which, and where it stands.
    pub name: String,
    /// Decibels, as they were measured.
    pub psnr: f64,
    pub high: Rgb,
    pub low: Rgb,
    /// Amplified.
    pub difference: Rgb,
}

/// The views to look at.
pub fn chosen(views: &[ViewFigures]) -> Vec<ChosenView> {
    let mut order: Vec<usize> = (0..views.len()).collect();
    order.sort_by(|&a, &b| views[a].psnr.total_cmp(&views[b].psnr));
    let places = WORST.into_iter().enumerate();
    let others = [(views.len() / 2, "in the middle"), (views.len().saturating_sub(1), "best")];
    if let [first, .., last] = order[..]
        && views[first].psnr == views[last].psnr
    {
        return vec![ChosenView { index: first, why: "as close as all others", psnr: views[first].psnr }];
    }
    let mut chosen: Vec<ChosenView> = Vec::new();
    for (place, why) in places.chain(others) {
        let Some(&index) = order.get(place) else { continue };
        if chosen.iter().all(|own| own.index != index) {
            chosen.push(ChosenView { index, why, psnr: views[index].psnr });
        }
    }
    chosen
}

/// Renders a view, one of the options', of high-poly and low-poly on the background that they were compared on.
///
/// # Errors
/// A background that is none.
pub fn shown(
    renderer: &Renderer,
    [high, low]: &[PlacedModel; 2],
    options: &EvaluateOptions,
    view: &ChosenView,
) -> Result<ShownView, BakeError> {
    let background = options.checked_background()?;
    let direction = options.directions()[view.index];
    let picture = |model: &PlacedModel| renderer.tonemap(&renderer.render(model, direction), background);
    let (high, low) = (picture(high), picture(low));
    Ok(ShownView {
        name: format!("View {}, {}", view.index + 1, view.why),
        psnr: view.psnr,
        difference: amplified_difference(&high, &low, AMPLIFIED),
        high,
        low,
    })
}
