//! Figures 6 and 9: gains of all models over the fit with fixed coordinates, as violins.

use super::drawn::Drawn;
use super::methods::Moves;
use super::scores::gain;
use super::{compress, lods};
use crate::catalogue::Level;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use crate::paper;
use crate::results::Results;
use crate::scope::Scope;
use parbake::UvMode;
use parbake_report::page::charts::{Violin, ViolinChart, ViolinGroup};

/// How to read them.
pub const LEAD: &str = "A dot is a model, a violin the spread of all, its mark the median: decibels over the fit of \
textures with fixed coordinates, which is the line at 0. The paper's are those of the same models over NVDiffModeling, \
as far as they are known.";

/// What stands in each group.
const SHOWN: [Moves; 4] = [Moves::Nothing, Moves::CoordinatesAndShifts, Moves::Plain, Moves::All];

/// The experiments of all levels.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    scope.levels().iter().flat_map(|&level| lods::experiments(scope, level)).collect()
}

/// Figure 6, on black and on other backgrounds.
pub fn draw_levels(scope: &Scope, results: &Results) -> Drawn {
    let chart = |title: &str, of: fn(&Outcome) -> f64, with_papers: bool| {
        let mut groups = Vec::new();
        for &level in scope.levels() {
            for &size in scope.sizes() {
                let made = |moves: Moves| -> Vec<f64> {
                    let gain = |model| {
                        let made = |moves: Moves| results.of(&moves.on(scope, model, level, size)?);
                        gain(of, made(moves), made(Moves::Textures))
                    };
                    scope.catalogue.models.iter().filter_map(gain).collect()
                };
                let mut violins: Vec<Violin> = SHOWN
                    .iter()
                    .map(|&moves| Violin { name: moves.label().into(), values: made(moves) })
                    .collect();
                if with_papers {
                    let papers = |name: &str| {
                        let figure = |method| paper::figure(number(level), name, size, method);
                        Some(figure("Ours")?.psnr - figure("NV")?.psnr)
                    };
                    let values = scope.catalogue.models.iter().filter_map(|m| papers(&m.name)).collect();
                    violins.push(Violin { name: "the paper's Ours".into(), values });
                }
                groups.push(ViolinGroup { name: format!("{}, {size}²", level.name()), violins });
            }
        }
        let (title, y_title) = (title.into(), "gain in dB".into());
        ViolinChart { title, y_title, groups, baseline: Some("fixed UV".into()) }.html()
    };
    let html = format!(
        "<h3>On black</h3>{}<h3>Mean on white, grey and red</h3>{}",
        chart("Gains by level and texture size, on black", Outcome::psnr, true),
        chart("Gains by level and texture size, other backgrounds", Outcome::psnr_elsewhere, false)
    );
    Drawn { html, ..Drawn::default() }
}

/// The paper's table of a level.
fn number(level: Level) -> u8 {
    match level {
        Level::One => 8,
        Level::Two => 9,
        Level::Three => 10,
    }
}

/// Figure 9.
pub fn draw_compressed(scope: &Scope, results: &Results) -> Drawn {
    let group = |&size: &usize| {
        let ours = |model| {
            let made = |uv| results.of(&compress::run(scope, model, size, uv));
            gain(Outcome::psnr, made(UvMode::Optimize), made(UvMode::Keep))
        };
        let papers = |name: &str, method: &str| {
            let figure = |method| paper::figure(7, name, size, method);
            Some(figure(method)?.psnr - figure("NV")?.psnr)
        };
        let models = &scope.catalogue.models;
        let theirs = |method: &str| models.iter().filter_map(|m| papers(&m.name, method)).collect();
        let violin = |name: &str, values| Violin { name: name.into(), values };
        ViolinGroup {
            name: format!("{size}²"),
            violins: vec![
                violin("UV", models.iter().filter_map(ours).collect()),
                violin("the paper's Ours_UV", theirs("Ours_UV")),
                violin("the paper's UVAtlas", theirs("UVAtlas")),
            ],
        }
    };
    let chart = ViolinChart {
        title: "Gains of the same model with a smaller texture".into(),
        y_title: "gain in dB".into(),
        groups: scope.sizes().iter().map(group).collect(),
        baseline: Some("fixed UV".into()),
    };
    Drawn { html: chart.html(), ..Drawn::default() }
}
