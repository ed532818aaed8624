//! Tables 8, 9 and 10: low-polys of three levels, three texture sizes, on black as in the
//! paper, and on other backgrounds, where carving with black texels shows.

use super::drawn::Drawn;
use super::methods::Moves;
use super::scores::{gain, score};
use crate::catalogue::Level;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};

/// How to read them.
pub const LEAD: &str = "PSNR in dB and MS-SSIM, on black. Each column of ours stands before the paper's that comes \
closest: projection beside Blender's ray casting, the fit of textures with fixed coordinates beside NVDiffModeling. \
Gains are over the fixed coordinates of the same row. The paper's setting is not fully known: compare gains, not \
absolute decibels.";

/// All columns of a level.
pub fn experiments(scope: &Scope, level: Level) -> Vec<Experiment> {
    let mut all = Vec::new();
    for &size in scope.sizes() {
        for model in &scope.catalogue.models {
            all.extend(Moves::LEVELS.iter().filter_map(|moves| moves.on(scope, model, level, size)));
        }
    }
    all
}

/// Draws the tables of a level; `number` is the paper's.
pub fn draw(scope: &Scope, results: &Results, level: Level, number: u8) -> Drawn {
    let black = format!("{}, on black", level.name());
    let mut head = vec!["model, texture".to_string()];
    for moves in Moves::LEVELS {
        head.push(moves.label().into());
        if let Some(papers) = moves.papers() {
            head.push(format!("paper: {papers}"));
        }
    }
    head.extend(["gain of plain", "gain of all", "paper's gain"].map(String::from));
    let mut table = Table { caption: black, columns: head, rows: Vec::new() };
    let others =
        ["model, texture", "fixed UV", "UV, SH", "plain glTF", "all", "gain of plain", "gain of all"];
    let mut elsewhere = Table::new(&format!("{}, mean on white, grey and red", level.name()), &others);
    let mut gains = Vec::new();
    for &size in scope.sizes() {
        for model in &scope.catalogue.models {
            let made = |moves: Moves| results.of(&moves.on(scope, model, level, size)?);
            let papers = |method: &str| paper::figure(number, &model.name, size, method);
            let name = format!("{}, {size}²", model.name);
            let mut cells = Vec::new();
            for moves in Moves::LEVELS {
                cells.push(score(made(moves)));
                if let Some(method) = moves.papers() {
                    cells.push(Cell::or_missing(papers(method).map(|f| Cell::Paper(f.psnr, f.ms_ssim))));
                }
            }
            let fixed = made(Moves::Textures);
            let mut row_gain = |of: fn(&Outcome) -> f64, moves: Moves, background: &str| {
                let gain = gain(of, made(moves), fixed);
                let what = if moves == Moves::All { "all" } else { "plain" };
                let key = format!("{} {} {size} {what} on {background}", model.name, level.name());
                gains.extend(gain.map(|gain| (key, gain)));
                Cell::or_missing(gain.map(Cell::Gain))
            };
            cells.push(row_gain(Outcome::psnr, Moves::Plain, "black"));
            cells.push(row_gain(Outcome::psnr, Moves::All, "black"));
            let theirs = papers("Ours").zip(papers("NV")).map(|(a, b)| Cell::PaperGain(a.psnr - b.psnr));
            cells.push(Cell::or_missing(theirs));
            table.push(&name, cells);
            let mut other: Vec<Cell> =
                [Moves::Textures, Moves::CoordinatesAndShifts, Moves::Plain, Moves::All]
                    .map(|moves| Cell::or_missing(made(moves).map(|o| Cell::Number(o.psnr_elsewhere(), 2))))
                    .into();
            other.push(row_gain(Outcome::psnr_elsewhere, Moves::Plain, "others"));
            other.push(row_gain(Outcome::psnr_elsewhere, Moves::All, "others"));
            elsewhere.push(&name, other);
        }
    }
    for table in [&mut table, &mut elsewhere] {
        table.push_medians("median");
    }
    Drawn { tables: vec![table, elsewhere], gains, ..Drawn::default() }
}
