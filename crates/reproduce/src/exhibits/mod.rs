//! The paper's tables and figures: each names the experiments that it needs and draws what came
//! of them.
//!
//! ```text
//! methods      what moves: the columns of most tables
//! lods         Tables 8, 9, 10      low-polys of three levels
//! compress     Table 7              the same model with a smaller texture
//! pictures     Table 6              pictures on a plane
//! content      Table 3              the content-aware term, with and without
//! timings      Table 2              seconds
//! parallax     Table 11             kinds of parallax and of displacement
//! violins      Figures 6, 9         gains of all models
//! side_by_side Figures 7, 8         levels and texture sizes to look at
//! layouts      Figures 10, 18       texture coordinates over pictures and from other starts
//! wall         Figures 11, 12       the brick wall, heights fitted and measured
//! convergence  Figure 15            the paper's method, iteration by iteration
//! ablation     Figures 16, 17       one thing at a time, and SH orders
//! ```

mod ablation;
mod compress;
mod content;
mod convergence;
mod layouts;
mod lods;
mod methods;
mod parallax;
mod photos;
mod pictures;
mod side_by_side;
mod timings;
mod violins;
mod wall;

use crate::catalogue::Level;
use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use crate::scope::Scope;
use crate::table::Table;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A table or a figure of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "clap", value(rename_all = "lowercase"))]
pub enum Exhibit {
    /// Low-polys close to their high-polys.
    Table8,
    /// Low-polys at moderate distance.
    Table9,
    /// The coarsest low-polys.
    Table10,
    /// Kinds of parallax and displacement.
    Table11,
    /// The same model with a smaller texture.
    Table7,
    /// Pictures on a plane.
    Table6,
    /// The content-aware term in the paper's method.
    Table3,
    /// What it costs.
    Table2,
    /// Gains by level and texture size.
    Figure6,
    /// Levels side by side.
    Figure7,
    /// Texture sizes side by side.
    Figure8,
    /// Gains of smaller textures.
    Figure9,
    /// Texture coordinates over pictures.
    Figure10,
    /// The brick wall.
    Figure11,
    /// Measured depth.
    Figure12,
    /// Convergence of the paper's method.
    Figure15,
    /// One thing at a time.
    Figure16,
    /// Orders of spherical harmonics.
    Figure17,
    /// Starts of the texture coordinates.
    Figure18,
}

/// What an exhibit shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Its tables.
    pub tables: Vec<Table>,
    /// Charts and pictures for the page.
    pub html: String,
    /// Gains that the guard looks at, by name.
    pub gains: Vec<(String, f64)>,
}

impl Drawn {
    /// Whether anything was made of it.
    pub fn has_something(&self) -> bool {
        !self.html.is_empty() || self.tables.iter().any(|table| !table.rows.is_empty())
    }
}

/// Outcomes with their experiments and places.
#[derive(Clone, Debug, Default)]
pub struct Results(Vec<(Experiment, PathBuf, Outcome)>);

impl Results {
    /// Takes one in.
    pub fn add(&mut self, experiment: Experiment, place: PathBuf, outcome: Outcome) {
        self.0.push((experiment, place, outcome));
    }

    /// What came of an experiment, if it was made.
    pub fn of(&self, wanted: &Experiment) -> Option<&Outcome> {
        self.found(wanted).map(|(_, outcome)| outcome)
    }

    /// The folder of its files.
    pub fn place(&self, wanted: &Experiment) -> Option<&Path> {
        self.found(wanted).map(|(place, _)| place)
    }

    fn found(&self, wanted: &Experiment) -> Option<(&Path, &Outcome)> {
        let same = |e: &Experiment| e.subject == wanted.subject && e.recipe == wanted.recipe;
        self.0.iter().find(|(e, ..)| same(e)).map(|(_, place, outcome)| (place.as_path(), outcome))
    }

    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &Outcome> {
        self.0.iter().map(|(_, _, outcome)| outcome)
    }
}

impl Exhibit {
    /// All, in the order in which they are made: what most others build on comes first, what takes
    /// longest last.
    pub const ALL: [Exhibit; 19] = [
        Exhibit::Table10,
        Exhibit::Table6,
        Exhibit::Table7,
        Exhibit::Table8,
        Exhibit::Table9,
        Exhibit::Table11,
        Exhibit::Figure6,
        Exhibit::Figure7,
        Exhibit::Figure8,
        Exhibit::Figure9,
        Exhibit::Figure10,
        Exhibit::Figure11,
        Exhibit::Figure12,
        Exhibit::Figure16,
        Exhibit::Figure17,
        Exhibit::Figure18,
        Exhibit::Table3,
        Exhibit::Figure15,
        Exhibit::Table2,
    ];

    /// Those of a quick run.
    pub const QUICK: [Exhibit; 5] =
        [Exhibit::Table10, Exhibit::Table6, Exhibit::Table7, Exhibit::Figure6, Exhibit::Figure9];

    /// "Table 8".
    pub fn name(self) -> &'static str {
        match self {
            Exhibit::Table2 => "Table 2",
            Exhibit::Table3 => "Table 3",
            Exhibit::Table6 => "Table 6",
            Exhibit::Table7 => "Table 7",
            Exhibit::Table8 => "Table 8",
            Exhibit::Table9 => "Table 9",
            Exhibit::Table10 => "Table 10",
            Exhibit::Table11 => "Table 11",
            Exhibit::Figure6 => "Figure 6",
            Exhibit::Figure7 => "Figure 7",
            Exhibit::Figure8 => "Figure 8",
            Exhibit::Figure9 => "Figure 9",
            Exhibit::Figure10 => "Figure 10",
            Exhibit::Figure11 => "Figure 11",
            Exhibit::Figure12 => "Figure 12",
            Exhibit::Figure15 => "Figure 15",
            Exhibit::Figure16 => "Figure 16",
            Exhibit::Figure17 => "Figure 17",
            Exhibit::Figure18 => "Figure 18",
        }
    }

    /// What it is about, and how to read it.
    pub fn lead(self) -> &'static str {
        match self {
            Exhibit::Table2 => timings::LEAD,
            Exhibit::Table3 => content::LEAD,
            Exhibit::Table6 => pictures::LEAD,
            Exhibit::Table7 => compress::LEAD,
            Exhibit::Table8 | Exhibit::Table9 | Exhibit::Table10 => lods::LEAD,
            Exhibit::Table11 => parallax::LEAD,
            Exhibit::Figure6 | Exhibit::Figure9 => violins::LEAD,
            Exhibit::Figure7 | Exhibit::Figure8 => side_by_side::LEAD,
            Exhibit::Figure10 => layouts::LEAD_PICTURES,
            Exhibit::Figure11 => wall::LEAD_FITTED,
            Exhibit::Figure12 => wall::LEAD_MEASURED,
            Exhibit::Figure15 => convergence::LEAD,
            Exhibit::Figure16 => ablation::LEAD_PARTS,
            Exhibit::Figure17 => ablation::LEAD_ORDERS,
            Exhibit::Figure18 => layouts::LEAD_STARTS,
        }
    }

    /// What has to be made for it.
    pub fn experiments(self, scope: &Scope) -> Vec<Experiment> {
        match self {
            Exhibit::Table2 => timings::experiments(scope),
            Exhibit::Table3 => content::experiments(scope),
            Exhibit::Table6 => pictures::experiments(scope),
            Exhibit::Table7 | Exhibit::Figure9 => compress::experiments(scope),
            Exhibit::Table8 => lods::experiments(scope, Level::One),
            Exhibit::Table9 => lods::experiments(scope, Level::Two),
            Exhibit::Table10 => lods::experiments(scope, Level::Three),
            Exhibit::Table11 => parallax::experiments(scope),
            Exhibit::Figure6 => violins::experiments(scope),
            Exhibit::Figure7 => side_by_side::level_experiments(scope),
            Exhibit::Figure8 => side_by_side::size_experiments(scope),
            Exhibit::Figure10 => layouts::picture_experiments(scope),
            Exhibit::Figure11 => vec![wall::run(scope, false)],
            Exhibit::Figure12 => vec![wall::run(scope, true)],
            Exhibit::Figure15 => convergence::experiments(scope),
            Exhibit::Figure16 => ablation::part_experiments(scope),
            Exhibit::Figure17 => ablation::order_experiments(scope),
            Exhibit::Figure18 => layouts::start_experiments(scope),
        }
    }

    /// Draws what was made of it.
    ///
    /// # Errors
    /// Where a result's file cannot be read again.
    pub fn draw(self, scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
        match self {
            Exhibit::Table2 => Ok(timings::draw(scope, results)),
            Exhibit::Table3 => Ok(content::draw(scope, results)),
            Exhibit::Table6 => Ok(pictures::draw(scope, results)),
            Exhibit::Table7 => Ok(compress::draw(scope, results)),
            Exhibit::Table8 => Ok(lods::draw(scope, results, Level::One, 8)),
            Exhibit::Table9 => Ok(lods::draw(scope, results, Level::Two, 9)),
            Exhibit::Table10 => Ok(lods::draw(scope, results, Level::Three, 10)),
            Exhibit::Table11 => Ok(parallax::draw(scope, results)),
            Exhibit::Figure6 => Ok(violins::draw_levels(scope, results)),
            Exhibit::Figure7 => side_by_side::draw_levels(scope, results),
            Exhibit::Figure8 => side_by_side::draw_sizes(scope, results),
            Exhibit::Figure9 => Ok(violins::draw_compressed(scope, results)),
            Exhibit::Figure10 => layouts::draw_pictures(scope, results),
            Exhibit::Figure11 => wall::draw(scope, results, false),
            Exhibit::Figure12 => wall::draw(scope, results, true),
            Exhibit::Figure15 => Ok(convergence::draw(scope, results)),
            Exhibit::Figure16 => ablation::draw_parts(scope, results),
            Exhibit::Figure17 => ablation::draw_orders(scope, results),
            Exhibit::Figure18 => layouts::draw_starts(scope, results),
        }
    }
}
