//! Table 11: kinds of parallax mapping and of displacement on the coarsest level.

use super::drawn::Drawn;
use super::methods::Moves;
use super::scores::{gain, score};
use crate::catalogue::{Level, ModelFolder};
use crate::experiment::{Experiment, Recipe, Subject};
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use crate::variants::{VariantFigures, VariantsOptions};
use parbake::{BakeOptions, Convention, ShapeMode};

/// How to read it.
pub const LEAD: &str = "LOD-3, on black. Ours in the first table are bakes: what is named moves, all else stays. \
Ours in the second are fitted alike on kept vertices and coordinates, and cannot be written to files but for SH; gains \
there are over the same fit without any parallax.";

/// Ours and the paper's columns.
const MOVES: [Moves; 6] = [
    Moves::All,
    Moves::ShiftsAndVertices,
    Moves::Vertices,
    Moves::Shifts,
    Moves::Coordinates,
    Moves::Textures,
];

/// Variants by the names that the comparison gives them, with the paper's columns.
const VARIANTS: [(&str, &str); 5] = [
    ("parallax", "Parallax"),
    ("offset limiting", "PMOL"),
    ("SH, order 3", "Ours_SH"),
    ("steep parallax", "SPM"),
    ("parallax occlusion", "POM"),
];

/// Displacement along normals after one subdivision, and free vertices with a Laplacian term.
fn displaced(scope: &Scope, model: &ModelFolder, subdivided: bool) -> Option<Experiment> {
    let subject = Subject::pair(model, Level::Three)?;
    let shape = if subdivided { ShapeMode::Normal } else { ShapeMode::Laplacian };
    let options = Box::new(BakeOptions { shape, ..scope.fixed(scope.shown_size()) });
    let label = if subdivided { "one subdivision" } else { "Laplacian" };
    Some(Experiment {
        subject,
        recipe: Recipe::Bake { options, start: None, subdivided },
        label: label.into(),
    })
}

/// All kinds of parallax mapping on a model's coarsest level.
fn compared(scope: &Scope, model: &ModelFolder) -> Option<Experiment> {
    let evaluate = scope.options.evaluate();
    let options = VariantsOptions {
        texture_size: scope.shown_size(),
        convention: Convention::Paper,
        held_out: evaluate.views,
        resolution: evaluate.resolution,
        ..VariantsOptions::default()
    };
    Some(Experiment {
        subject: Subject::pair(model, Level::Three)?,
        recipe: Recipe::Variants { options },
        label: "parallax variants".into(),
    })
}

/// All of them.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    let of_model = |model: &ModelFolder| {
        let moves = MOVES.map(|moves| moves.on(scope, model, Level::Three, scope.shown_size()));
        let displaced = [true, false].map(|subdivided| displaced(scope, model, subdivided));
        moves.into_iter().chain(displaced).chain([compared(scope, model)]).flatten().collect::<Vec<_>>()
    };
    scope.catalogue.models.iter().flat_map(of_model).collect()
}

/// Draws both tables.
pub fn draw(scope: &Scope, results: &Results) -> Drawn {
    let size = scope.shown_size();
    let mut columns = vec!["model".to_string()];
    let mut bakes: Vec<(&str, Option<&str>)> =
        MOVES.iter().map(|moves| (moves.label(), moves.papers())).collect();
    bakes.extend([("one subdivision", Some("Subdivision")), ("Laplacian", Some("NV*"))]);
    for (label, papers) in &bakes {
        columns.push((*label).into());
        columns.extend(papers.map(|papers| format!("paper: {papers}")));
    }
    let mut table =
        Table { caption: format!("What moves, LOD-3, {size}², on black"), columns, rows: Vec::new() };
    let mut columns = vec!["model".to_string(), "no parallax".into()];
    for (ours, _) in VARIANTS {
        columns.extend([ours.to_string(), "gain".into(), "paper's gain".into()]);
    }
    columns.push("network".into());
    let mut kinds =
        Table { caption: format!("Kinds of parallax mapping, LOD-3, {size}²"), columns, rows: Vec::new() };
    for model in &scope.catalogue.models {
        let papers = |method: &str| paper::figure(11, &model.name, size, method);
        let mut made: Vec<Option<&Outcome>> =
            MOVES.iter().map(|m| results.of(&m.on(scope, model, Level::Three, size)?)).collect();
        made.extend([true, false].map(|split| results.of(&displaced(scope, model, split)?)));
        let mut cells = Vec::new();
        for (outcome, (_, method)) in made.iter().zip(&bakes) {
            cells.push(score(*outcome));
            if let Some(method) = method {
                cells.push(Cell::or_missing(papers(method).map(|f| Cell::Paper(f.psnr, f.ms_ssim))));
            }
        }
        table.push(&model.name, cells);
        let Some(variants) = compared(scope, model).and_then(|e| results.of(&e)).map(|o| &o.variants) else {
            continue;
        };
        let figure = |v: &VariantFigures| Cell::Score(v.psnr, v.ms_ssim);
        let named = |name: &str| variants.iter().find(|v| v.name == name);
        let plain = named("no parallax");
        let mut cells = vec![Cell::or_missing(plain.map(figure))];
        for (ours, theirs) in VARIANTS {
            let variant = named(ours);
            cells.push(Cell::or_missing(variant.map(figure)));
            cells.push(Cell::or_missing(variant.zip(plain).map(|(v, p)| Cell::Gain(v.psnr - p.psnr))));
            let gain = papers(theirs).zip(papers("NV")).map(|(a, b)| Cell::PaperGain(a.psnr - b.psnr));
            cells.push(Cell::or_missing(gain));
        }
        cells.push(Cell::or_missing(named("small network").map(figure)));
        kinds.push(&model.name, cells);
    }
    let mut gains = Vec::new();
    for model in &scope.catalogue.models {
        let made = |moves: Moves| results.of(&moves.on(scope, model, Level::Three, size)?);
        for moves in [Moves::Vertices, Moves::Shifts] {
            let gain = gain(Outcome::psnr, made(moves), made(Moves::Textures));
            gains.extend(
                gain.map(|gain| (format!("{} LOD-3 {size} {} alone", model.name, moves.label()), gain)),
            );
        }
    }
    Drawn { tables: vec![table, kinds], gains, ..Drawn::default() }
}
