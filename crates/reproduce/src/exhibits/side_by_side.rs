//! Figures 7 and 8: levels, and texture sizes, side by side.

use super::drawn::Drawn;
use super::methods::Moves;
use super::photos::{Plate, row};
use crate::catalogue::{Level, ModelFolder};
use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::results::Results;
use crate::scope::Scope;

/// How to read them.
pub const LEAD: &str = "The same view of each, on dark grey. Below it the part in which all that moves gains most \
over projection. Figures are means over all views, on black.";

/// What is shown of each.
const SHOWN: [Moves; 4] = [Moves::Nothing, Moves::Textures, Moves::Plain, Moves::All];

fn shown(scope: &Scope, model: &ModelFolder, level: Level, size: usize) -> Vec<Experiment> {
    SHOWN.iter().filter_map(|moves| moves.on(scope, model, level, size)).collect()
}

/// All models on all levels.
pub fn level_experiments(scope: &Scope) -> Vec<Experiment> {
    let of_model = |model| {
        let size = scope.shown_size();
        scope.levels().iter().flat_map(move |&level| shown(scope, model, level, size)).collect::<Vec<_>>()
    };
    scope.catalogue.models.iter().flat_map(of_model).collect()
}

/// The level on which texture sizes are compared.
fn level(scope: &Scope) -> Level {
    if scope.options.quick { Level::Three } else { Level::Two }
}

/// All models in all sizes.
pub fn size_experiments(scope: &Scope) -> Vec<Experiment> {
    let of_model = |model| {
        let size = |&size| shown(scope, model, level(scope), size);
        scope.sizes().iter().flat_map(size).collect::<Vec<_>>()
    };
    scope.catalogue.models.iter().flat_map(of_model).collect()
}

fn one_row(
    scope: &Scope,
    results: &Results,
    model: &ModelFolder,
    level: Level,
    size: usize,
) -> Result<String, ReproduceError> {
    let experiments = shown(scope, model, level, size);
    let plates: Vec<Plate> = (experiments.iter())
        .filter_map(|experiment| {
            let (place, outcome) = (results.place(experiment)?, results.of(experiment)?);
            Some(Plate { name: experiment.label.clone(), place, outcome })
        })
        .collect();
    row(&format!("{} {}, {size}²", model.name, level.name()), &model.high, &plates)
}

/// Figure 7.
///
/// # Errors
/// Where a file cannot be read again.
pub fn draw_levels(scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
    let mut html = String::new();
    for model in &scope.catalogue.models {
        for &level in scope.levels() {
            html += &one_row(scope, results, model, level, scope.shown_size())?;
        }
    }
    Ok(Drawn { html, ..Drawn::default() })
}

/// Figure 8.
///
/// # Errors
/// Where a file cannot be read again.
pub fn draw_sizes(scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
    let mut html = String::new();
    for model in &scope.catalogue.models {
        for &size in scope.sizes() {
            html += &one_row(scope, results, model, level(scope), size)?;
        }
    }
    Ok(Drawn { html, ..Drawn::default() })
}
