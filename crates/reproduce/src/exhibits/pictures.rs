//! Table 6: pictures on a plane with smaller textures.

use super::drawn::Drawn;
use super::scores::{gain, score};
use crate::experiment::{Experiment, Recipe, Subject, stem};
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use parbake::{ImageOptions, PictureUv};
use std::path::Path;

/// How to read it.
pub const LEAD: &str = "A picture at its own resolution against the same on a plane with a texture of 64², 128² or 256² \
texels. Fixed UV is the least-squares texture, UV moves coordinates besides; minified gains are the means of half and \
quarter size with trilinear filtering. Downsampled is a triangle filter, shown with bilinear filtering.";

/// Kept coordinates, or moved ones.
pub fn run(scope: &Scope, picture: &Path, size: usize, uv: PictureUv) -> Experiment {
    let options = ImageOptions { uv, ..scope.picture(size) };
    let label = if uv == PictureUv::Keep { "fixed UV" } else { "UV" };
    let recipe = Recipe::Picture { options };
    Experiment { subject: Subject::picture(picture), recipe, label: label.into() }
}

fn downsampled(picture: &Path, texture_size: usize) -> Experiment {
    let recipe = Recipe::Downsample { texture_size };
    Experiment { subject: Subject::picture(picture), recipe, label: "downsampled".into() }
}

/// All of each picture and size.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    let mut all = Vec::new();
    for &size in scope.picture_sizes() {
        for picture in &scope.catalogue.pictures {
            all.push(downsampled(picture, size));
            all.extend([PictureUv::Keep, PictureUv::Optimize].map(|uv| run(scope, picture, size, uv)));
        }
    }
    all
}

/// Draws a table for each size.
pub fn draw(scope: &Scope, results: &Results) -> Drawn {
    let columns = [
        "picture",
        "downsampled",
        "paper's",
        "fixed UV",
        "paper: NV",
        "UV",
        "paper: Ours_UV",
        "gain",
        "paper's gain",
        "gain minified",
        "seconds",
    ];
    let mut drawn = Drawn::default();
    for &size in scope.picture_sizes() {
        let mut table = Table::new(&format!("Pictures with textures of {size}²"), &columns);
        let mut all = Vec::new();
        for picture in &scope.catalogue.pictures {
            let name = stem(picture);
            let [kept, moved] =
                [PictureUv::Keep, PictureUv::Optimize].map(|uv| results.of(&run(scope, picture, size, uv)));
            let papers = |method: &str| paper::figure(6, &name, size, method);
            let cell = |method| Cell::or_missing(papers(method).map(|f| Cell::Paper(f.psnr, f.ms_ssim)));
            let ours = gain(Outcome::psnr, moved, kept);
            drawn.gains.extend(ours.map(|gain| (format!("{name} picture {size} UV"), gain)));
            all.extend(ours);
            let theirs = papers("Ours_UV").zip(papers("NV")).map(|(a, b)| Cell::PaperGain(a.psnr - b.psnr));
            let small = gain(Outcome::psnr_elsewhere, moved, kept);
            table.push(
                &name,
                vec![
                    score(results.of(&downsampled(picture, size))),
                    cell("Downsample"),
                    score(kept),
                    cell("NV"),
                    score(moved),
                    cell("Ours_UV"),
                    Cell::or_missing(ours.map(Cell::Gain)),
                    Cell::or_missing(theirs),
                    Cell::or_missing(small.map(Cell::Gain)),
                    Cell::or_missing(moved.map(|o| Cell::Number(o.seconds, 1))),
                ],
            );
        }
        if all.len() > 1 {
            let mut mean = vec![Cell::Text(String::new()); columns.len() - 1];
            mean[6] = Cell::Gain(all.iter().sum::<f64>() / all.len() as f64);
            table.push("mean", mean);
        }
        drawn.tables.push(table);
    }
    drawn
}
