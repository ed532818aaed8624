//! Figures 16 and 17: what each thing that moves is worth by itself, and each order of the
//! spherical harmonics.

use super::drawn::Drawn;
use super::methods::Moves;
use super::photos::{Plate, row};
use super::scores::gain;
use crate::catalogue::{Level, ModelFolder};
use crate::error::ReproduceError;
use crate::experiment::{Experiment, Subject};
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use parbake::BakeOptions;
use parbake_report::page::charts::{Bar, BarChart, BarGroup, LineChart, Series};

/// How to read Figure 16.
pub const LEAD_PARTS: &str = "LOD-3, on black: decibels over the fit of textures alone. SH without vertices has no \
cutout; all of it has one. The paper's gains over NVDiffModeling are ticks, where they are known.";
/// How to read Figure 17.
pub const LEAD_ORDERS: &str = "LOD-3, on black, by the order of the spherical harmonics: SH alone, without cutout, \
on kept vertices and coordinates; and everything together on the first model.";

/// What moves, from little to much.
const PARTS: [Moves; 7] = [
    Moves::Textures,
    Moves::Coordinates,
    Moves::Shifts,
    Moves::Vertices,
    Moves::CoordinatesAndShifts,
    Moves::ShiftsAndVertices,
    Moves::All,
];

/// Highest order.
const ORDERS: usize = 7;

/// Every part on every model.
pub fn part_experiments(scope: &Scope) -> Vec<Experiment> {
    let of_model = |model| {
        let part = move |moves: &Moves| moves.on(scope, model, Level::Three, scope.shown_size());
        PARTS.iter().filter_map(part).collect::<Vec<_>>()
    };
    scope.catalogue.models.iter().flat_map(of_model).collect()
}

fn of_order(scope: &Scope, model: &ModelFolder, moves: Moves, order: usize) -> Option<Experiment> {
    let options = BakeOptions { parallax_order: order, ..moves.options(scope, scope.shown_size()) };
    let label = format!("{}, order {order}", moves.label());
    Some(Experiment::bake(Subject::pair(model, Level::Three)?, &label, options))
}

/// Curves of Figure 17: the model, what moves, whether it is the first model's.
fn curves(scope: &Scope) -> Vec<(&ModelFolder, Moves)> {
    let models = &scope.catalogue.models;
    let alone = models.iter().map(|model| (model, Moves::Shifts));
    alone.chain(models.first().map(|model| (model, Moves::All))).collect()
}

/// Every order.
pub fn order_experiments(scope: &Scope) -> Vec<Experiment> {
    let orders = |(model, moves)| {
        let fixed = Moves::Textures.on(scope, model, Level::Three, scope.shown_size());
        let orders = (0..=ORDERS).map(move |order| of_order(scope, model, moves, order));
        orders.chain([fixed]).flatten().collect::<Vec<_>>()
    };
    curves(scope).into_iter().flat_map(orders).collect()
}

/// Figure 16: bars of all models, pictures of the first.
///
/// # Errors
/// Where a file cannot be read again.
pub fn draw_parts(scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
    let size = scope.shown_size();
    let group = |model: &ModelFolder| {
        let made = |moves: Moves| results.of(&moves.on(scope, model, Level::Three, size)?);
        let papers = |moves: Moves| {
            // Ours with UV and SH stands in Table 10, the others in Table 11.
            let table = if moves == Moves::CoordinatesAndShifts { 10 } else { 11 };
            let figure = |table, method| paper::figure(table, &model.name, size, method);
            Some(figure(table, moves.papers()?)?.psnr - figure(table, "NV")?.psnr)
        };
        let bar = |&moves: &Moves| {
            let value = gain(Outcome::psnr, made(moves), made(Moves::Textures))?;
            Some(Bar { name: moves.label().into(), value, reference: papers(moves) })
        };
        BarGroup { name: model.name.clone(), bars: PARTS[1..].iter().filter_map(bar).collect() }
    };
    let chart = BarChart {
        title: "What each part is worth".into(),
        y_title: "gain in dB".into(),
        groups: scope.catalogue.models.iter().map(group).collect(),
    };
    let mut html = chart.html();
    if let Some(model) = scope.catalogue.models.first() {
        let experiments: Vec<Experiment> =
            PARTS.iter().filter_map(|moves| moves.on(scope, model, Level::Three, size)).collect();
        let plates: Vec<Plate> = (experiments.iter())
            .filter_map(|e| {
                Some(Plate { name: e.label.clone(), place: results.place(e)?, outcome: results.of(e)? })
            })
            .collect();
        html += &row(&model.name, &model.high, &plates)?;
    }
    Ok(Drawn { html, ..Drawn::default() })
}

/// Figure 17: curves of all models, pictures of the first.
///
/// # Errors
/// Where a file cannot be read again.
pub fn draw_orders(scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
    let series = |(model, moves): (&ModelFolder, Moves)| {
        let fixed = Moves::Textures.on(scope, model, Level::Three, scope.shown_size());
        let fixed = fixed.and_then(|e| results.of(&e));
        let point = |order: usize| {
            let made = of_order(scope, model, moves, order).and_then(|e| results.of(&e));
            Some((order as f64, gain(Outcome::psnr, made, fixed)?))
        };
        let what = if moves == Moves::All { ", all" } else { "" };
        Series { name: format!("{}{what}", model.name), points: (0..=ORDERS).filter_map(point).collect() }
    };
    let chart = LineChart {
        title: "Gain by the order of the spherical harmonics".into(),
        x_title: "order".into(),
        y_title: "gain in dB".into(),
        series: curves(scope).into_iter().map(series).collect(),
        boundaries: Vec::new(),
        logarithmic: false,
    };
    let mut html = chart.html();
    if let Some(model) = scope.catalogue.models.first() {
        let experiments: Vec<Experiment> =
            (0..=ORDERS).filter_map(|order| of_order(scope, model, Moves::Shifts, order)).collect();
        let plates: Vec<Plate> = (experiments.iter().enumerate())
            .filter_map(|(order, e)| {
                let (place, outcome) = (results.place(e)?, results.of(e)?);
                Some(Plate { name: format!("order {order}"), place, outcome })
            })
            .collect();
        html += &row(&model.name, &model.high, &plates)?;
    }
    Ok(Drawn { html, ..Drawn::default() })
}
