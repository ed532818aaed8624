//! Table 3: the paper's method on pictures of 64² texels, with its content-aware term and with the
//! image loss alone.

use super::drawn::Drawn;
use super::scores::{gain, score};
use crate::experiment::{Experiment, Recipe, Subject, stem};
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use parbake::{ImageOptions, Method};
use std::path::Path;

/// How to read it.
pub const LEAD: &str = "The paper's own alternation of Adam and L-BFGS on a plane of 50 × 50 cells and a texture of 64² \
texels; without the term, coordinates follow the image loss alone.";

/// Texels along a side, and cells.
const SIZE: usize = 64;
const CELLS: usize = 50;

/// The paper's method on a picture.
pub fn run(scope: &Scope, picture: &Path, with: bool) -> Experiment {
    let steps = scope.options.quick.then_some(60);
    let options = ImageOptions {
        method: Method::Paper,
        no_content_aware: !with,
        grid: Some(CELLS),
        steps,
        ..scope.picture(SIZE)
    };
    let label = if with { "with L_I∘UV" } else { "without L_I∘UV" };
    let recipe = Recipe::Picture { options };
    Experiment { subject: Subject::picture(picture), recipe, label: label.into() }
}

/// Both of each picture.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    scope.catalogue.pictures.iter().flat_map(|p| [true, false].map(|with| run(scope, p, with))).collect()
}

/// Draws the table.
pub fn draw(scope: &Scope, results: &Results) -> Drawn {
    let columns =
        ["picture", "without", "paper's", "with", "paper's", "effect of the term", "paper's effect"];
    let mut table = Table::new("The content-aware term at 64²", &columns);
    for picture in &scope.catalogue.pictures {
        let name = stem(picture);
        let [with, without] = [true, false].map(|with| results.of(&run(scope, picture, with)));
        let papers = |method: &str| paper::figure(3, &name, SIZE, method);
        let cell = |method| Cell::or_missing(papers(method).map(|f| Cell::Paper(f.psnr, f.ms_ssim)));
        let theirs = papers("with").zip(papers("without")).map(|(a, b)| Cell::PaperGain(a.psnr - b.psnr));
        table.push(
            &name,
            vec![
                score(without),
                cell("without"),
                score(with),
                cell("with"),
                Cell::or_missing(gain(Outcome::psnr, with, without).map(Cell::Gain)),
                Cell::or_missing(theirs),
            ],
        );
    }
    Drawn { tables: vec![table], ..Drawn::default() }
}
