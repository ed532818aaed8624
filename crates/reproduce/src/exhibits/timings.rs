//! Table 2: what it costs. The paper counts milliseconds an iteration; a user counts seconds a
//! model, which is what stands here beside the product of the paper's two numbers.

use super::drawn::Drawn;
use super::methods::Moves;
use super::scores::{gain, score};
use crate::catalogue::{Level, ModelFolder};
use crate::experiment::{Experiment, Subject};
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table, median};
use parbake::{BakeOptions, Method};

/// How to read it.
pub const LEAD: &str = "Seconds a model at LOD-3, from reading the files to writing the result, the median over the \
models. The paper's are its milliseconds an iteration times its iterations, on a Titan XP. Figures of ours are of this \
machine, and only as good as it was idle.";

/// Columns of Table 10 with their rows in the paper's table.
const ROWS: [(Moves, &str); 3] =
    [(Moves::Textures, "NV"), (Moves::CoordinatesAndShifts, "Ours_UV,SH"), (Moves::All, "Ours")];

/// The paper's Algorithm 1 with its counts of steps.
fn algorithm(scope: &Scope, model: &ModelFolder) -> Option<Experiment> {
    let size = scope.shown_size();
    let options = BakeOptions { method: Method::Paper, parallax_order: 3, ..scope.all(size) };
    Some(Experiment::bake(Subject::pair(model, Level::Three)?, "Algorithm 1", options))
}

fn of_methods<'a>(scope: &'a Scope, moves: Moves, size: usize) -> impl Iterator<Item = Experiment> + 'a {
    scope.catalogue.models.iter().filter_map(move |model| moves.on(scope, model, Level::Three, size))
}

/// Those columns of Table 10, and Algorithm 1.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    let mut all = Vec::new();
    for &size in scope.sizes() {
        all.extend(ROWS.iter().flat_map(|(moves, _)| of_methods(scope, *moves, size)));
    }
    all.extend(scope.catalogue.models.iter().filter_map(|model| algorithm(scope, model)));
    all
}

/// Draws both tables.
pub fn draw(scope: &Scope, results: &Results) -> Drawn {
    let columns = ["what moves, texture", "seconds", "slowest model", "paper's seconds", "times as fast"];
    let mut table = Table::new("Seconds a model at LOD-3", &columns);
    for (moves, method) in ROWS {
        for &size in scope.sizes() {
            let made: Vec<f64> = of_methods(scope, moves, size)
                .filter_map(|experiment| results.of(&experiment).map(|outcome| outcome.seconds))
                .collect();
            let papers = (paper::TIMINGS.iter())
                .find(|(m, s, ..)| *m == method && *s == size)
                .map(|(.., milliseconds, iterations)| milliseconds * iterations / 1000.0);
            let seconds = median(&made);
            let number = |n: Option<f64>, decimals| Cell::or_missing(n.map(|n| Cell::Number(n, decimals)));
            let slowest = made.iter().copied().reduce(f64::max);
            let faster = papers.zip(seconds).map(|(theirs, ours)| theirs / ours);
            let theirs = Cell::or_missing(papers.map(|p| Cell::Text(format!("{p:.0}"))));
            table.push(
                &format!("{}, {size}²", moves.label()),
                vec![number(seconds, 1), number(slowest, 1), theirs, number(faster, 0)],
            );
        }
    }
    let columns =
        ["model", "fixed UV", "Algorithm 1", "gain", "paper's gain", "iterations", "ms / iteration"];
    let size = scope.shown_size();
    let caption = format!("The paper's Algorithm 1 as we read it, LOD-3, {size}², on black");
    let mut literal = Table::new(&caption, &columns);
    for model in &scope.catalogue.models {
        let made = algorithm(scope, model).and_then(|e| results.of(&e));
        let fixed = Moves::Textures.on(scope, model, Level::Three, size).and_then(|e| results.of(&e));
        let papers = |method: &str| paper::figure(10, &model.name, size, method).map(|f| f.psnr);
        let gain = gain(Outcome::psnr, made, fixed);
        let each = made.map(|o| 1000.0 * o.seconds / o.iterations.max(1) as f64);
        let row = vec![
            score(made.and(fixed)),
            score(made),
            Cell::or_missing(gain.map(Cell::Gain)),
            Cell::or_missing(papers("Ours").zip(papers("NV")).map(|(a, b)| Cell::PaperGain(a - b))),
            Cell::or_missing(made.map(|o| Cell::Number(o.iterations as f64, 0))),
            Cell::or_missing(each.map(|ms| Cell::Number(ms, 1))),
        ];
        literal.push(&model.name, row);
    }
    Drawn { tables: vec![table, literal], ..Drawn::default() }
}
