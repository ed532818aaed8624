//! Table 7: a model against itself with a smaller texture.

use super::drawn::Drawn;
use super::scores::{gain, score};
use crate::catalogue::ModelFolder;
use crate::experiment::{Experiment, Recipe, Subject};
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use parbake::{BakeOptions, UvMode};

/// How to read it.
pub const LEAD: &str = "The high-poly itself with a texture of 128², 256² or 512² instead of its own. Fixed UV is the \
least-squares texture on the delivered coordinates, UV is with coordinates moved for it. Starts differ: the paper \
unwrapped its models anew for its own method, here both begin with the delivered layout.";

/// Kept coordinates, and moved ones.
pub fn run(scope: &Scope, model: &ModelFolder, size: usize, uv: UvMode) -> Experiment {
    let options = Box::new(BakeOptions { uv, ..scope.bake(size) });
    let label = if uv == UvMode::Keep { "fixed UV" } else { "UV" };
    Experiment { subject: Subject::model(model), recipe: Recipe::Compress { options }, label: label.into() }
}

/// Both of each model and size.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    let mut all = Vec::new();
    for &size in scope.sizes() {
        for model in &scope.catalogue.models {
            all.extend([UvMode::Keep, UvMode::Optimize].map(|uv| run(scope, model, size, uv)));
        }
    }
    all
}

/// Draws the table.
pub fn draw(scope: &Scope, results: &Results) -> Drawn {
    let columns = [
        "model, texture",
        "fixed UV",
        "paper: NV",
        "UV",
        "paper: Ours_UV",
        "paper: Ours",
        "paper: UVAtlas",
        "gain",
        "paper's gain of UV",
        "bytes",
    ];
    let mut table = Table::new("The same model with a smaller texture, on black", &columns);
    let mut gains = Vec::new();
    for &size in scope.sizes() {
        for model in &scope.catalogue.models {
            let [kept, moved] =
                [UvMode::Keep, UvMode::Optimize].map(|uv| results.of(&run(scope, model, size, uv)));
            let papers = |method: &str| paper::figure(7, &model.name, size, method);
            let cell = |method| Cell::or_missing(papers(method).map(|f| Cell::Paper(f.psnr, f.ms_ssim)));
            let ours = gain(Outcome::psnr, moved, kept);
            gains.extend(ours.map(|gain| (format!("{} itself {size} UV", model.name), gain)));
            let theirs = papers("Ours_UV").zip(papers("NV")).map(|(a, b)| Cell::PaperGain(a.psnr - b.psnr));
            let bytes = moved.map(|o| Cell::Number(o.bytes as f64, 0));
            table.push(
                &format!("{}, {size}²", model.name),
                vec![
                    score(kept),
                    cell("NV"),
                    score(moved),
                    cell("Ours_UV"),
                    cell("Ours"),
                    cell("UVAtlas"),
                    Cell::or_missing(ours.map(Cell::Gain)),
                    Cell::or_missing(theirs),
                    Cell::or_missing(bytes),
                ],
            );
        }
    }
    table.push_medians("median");
    Drawn { tables: vec![table], gains, ..Drawn::default() }
}
