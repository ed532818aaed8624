//! The paper's tables and figures: each names the experiments that it needs and draws what came
//! of them.
//!
//! ```text
//! methods      what moves: the columns of most tables
//! scores       how outcomes are shown and compared
//! lods         Tables 8, 9, 10      low-polys of three levels
//! compress     Table 7              the same model with a smaller texture
//! pictures     Table 6              pictures on a plane
//! content      Table 3              the content-aware term, with and without
//! timings      Table 2              seconds
//! dataset      Table 5, Figures 4, 5 what the models are like, and how far levels are from them
//! parallax     Table 11             kinds of parallax and of displacement
//! violins      Figures 6, 9         gains of all models
//! side_by_side Figures 7, 8         levels and texture sizes to look at
//! layouts      Figures 10, 18       texture coordinates over pictures and from other starts
//! wall         Figures 11, 12       the brick wall, heights fitted and measured
//! relit        Figure 14            metal and roughness under random lights
//! convergence  Figure 15            the paper's method, iteration by iteration
//! ablation     Figures 16, 17       one thing at a time, and SH orders
//! ```

mod ablation;
mod compress;
mod content;
mod convergence;
mod dataset;
pub mod drawn;
mod layouts;
mod lods;
mod methods;
mod parallax;
mod photos;
mod pictures;
mod relit;
mod scores;
mod side_by_side;
mod timings;
mod violins;
mod wall;

use crate::catalogue::Level;
use crate::error::ReproduceError;
use crate::exhibit::Exhibit;
use crate::experiment::Experiment;
use crate::results::Results;
use crate::scope::Scope;
use drawn::Drawn;

impl Exhibit {
    /// What it is about, and how to read it.
    pub fn lead(self) -> &'static str {
        match self {
            Exhibit::Table2 => timings::LEAD,
            Exhibit::Table3 => content::LEAD,
            Exhibit::Table5 => dataset::LEAD_EACH,
            Exhibit::Table6 => pictures::LEAD,
            Exhibit::Table7 => compress::LEAD,
            Exhibit::Table8 | Exhibit::Table9 | Exhibit::Table10 => lods::LEAD,
            Exhibit::Table11 => parallax::LEAD,
            Exhibit::Figure4 => dataset::LEAD_DISTANCES,
            Exhibit::Figure5 => dataset::LEAD_ALL,
            Exhibit::Figure6 | Exhibit::Figure9 => violins::LEAD,
            Exhibit::Figure7 | Exhibit::Figure8 => side_by_side::LEAD,
            Exhibit::Figure10 => layouts::LEAD_PICTURES,
            Exhibit::Figure11 => wall::LEAD_FITTED,
            Exhibit::Figure12 => wall::LEAD_MEASURED,
            Exhibit::Figure14 => relit::LEAD,
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
            // They measure the data itself.
            Exhibit::Table5 | Exhibit::Figure4 | Exhibit::Figure5 => Vec::new(),
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
            Exhibit::Figure14 => relit::experiments(scope),
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
            Exhibit::Table5 => Ok(dataset::draw_each(scope)),
            Exhibit::Table6 => Ok(pictures::draw(scope, results)),
            Exhibit::Table7 => Ok(compress::draw(scope, results)),
            Exhibit::Table8 => Ok(lods::draw(scope, results, Level::One, 8)),
            Exhibit::Table9 => Ok(lods::draw(scope, results, Level::Two, 9)),
            Exhibit::Table10 => Ok(lods::draw(scope, results, Level::Three, 10)),
            Exhibit::Table11 => Ok(parallax::draw(scope, results)),
            Exhibit::Figure4 => Ok(dataset::draw_distances(scope)),
            Exhibit::Figure5 => Ok(dataset::draw_all(scope)),
            Exhibit::Figure6 => Ok(violins::draw_levels(scope, results)),
            Exhibit::Figure7 => side_by_side::draw_levels(scope, results),
            Exhibit::Figure8 => side_by_side::draw_sizes(scope, results),
            Exhibit::Figure9 => Ok(violins::draw_compressed(scope, results)),
            Exhibit::Figure10 => layouts::draw_pictures(scope, results),
            Exhibit::Figure11 => wall::draw(scope, results, false),
            Exhibit::Figure12 => wall::draw(scope, results, true),
            Exhibit::Figure14 => relit::draw(scope, results),
            Exhibit::Figure15 => Ok(convergence::draw(scope, results)),
            Exhibit::Figure16 => ablation::draw_parts(scope, results),
            Exhibit::Figure17 => ablation::draw_orders(scope, results),
            Exhibit::Figure18 => layouts::draw_starts(scope, results),
        }
    }
}
