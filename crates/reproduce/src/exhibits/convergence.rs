//! Figure 15: the paper's method, iteration by iteration.

use super::content;
use super::drawn::Drawn;
use crate::experiment::{Experiment, stem};
use crate::outcome::{Outcome, Point};
use crate::results::Results;
use crate::scope::Scope;
use parbake_report::page::charts::{LineChart, Series};

/// How to read it.
pub const LEAD: &str = "The paper's method on pictures at 64²: textures alone, then textures and coordinates in turns, \
then textures alone. The third stage begins at the best round, so curves may fall where it begins.";

/// Those of Table 3 with the term.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    scope.catalogue.pictures.iter().map(|picture| content::run(scope, picture, true)).collect()
}

/// Draws both losses.
pub fn draw(scope: &Scope, results: &Results) -> Drawn {
    let made: Vec<(String, &Outcome)> = (scope.catalogue.pictures.iter())
        .filter_map(|picture| Some((stem(picture), results.of(&content::run(scope, picture, true))?)))
        .collect();
    let moving = |outcome: &Outcome| {
        let mut moves = outcome.convergence.iter().filter(|p| p.moving).map(|p| p.iteration as f64);
        let first = moves.next()?;
        Some((first, moves.next_back().unwrap_or(first)))
    };
    let boundaries = (made.iter().find_map(|(_, outcome)| moving(outcome)))
        .map(|(begin, end)| vec![(begin, "coordinates move".into()), (end, "textures alone".into())])
        .unwrap_or_default();
    let chart = |title: &str, y_title: &str, of: fn(&Point) -> f64| {
        let series = made.iter().map(|(name, outcome)| Series {
            name: name.clone(),
            points: outcome.convergence.iter().map(|p| (p.iteration as f64, of(p))).collect(),
        });
        let chart = LineChart {
            title: title.into(),
            x_title: "iterations".into(),
            y_title: y_title.into(),
            series: series.collect(),
            boundaries: boundaries.clone(),
            logarithmic: true,
        };
        chart.html()
    };
    let html = format!(
        r#"<div class="pair"><div><h3>L_diff</h3>{}</div><div><h3>L_I∘UV</h3>{}</div></div>"#,
        chart("L_diff by iteration", "mean squared error", |p| p.loss),
        chart("L_I∘UV by iteration", "L_I∘UV", |p| p.content)
    );
    Drawn { html, ..Drawn::default() }
}
