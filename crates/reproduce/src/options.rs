//! What a reproduction is asked for.

use crate::exhibit::Exhibit;
use parbake::{BakeError, EvaluateOptions};
use serde::{Deserialize, Serialize};

/// Options of a reproduction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct ReproduceOptions {
    /// Only these tables and figures, by commas [default: all; with --quick those that the guard
    /// looks at]
    #[cfg_attr(feature = "clap", arg(long, value_enum, value_name = "EXHIBIT", value_delimiter = ','))]
    pub only: Vec<Exhibit>,

    /// Only models and pictures whose names contain one of these, by commas [default: all]
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", value_delimiter = ','))]
    pub models: Vec<String>,

    /// Minutes instead of hours: the smallest textures, the coarsest level, fast presets, fewer
    /// and smaller views
    #[cfg_attr(feature = "clap", arg(long))]
    pub quick: bool,

    /// Views that figures are means of, 1 to 4096 [default: 48, with --quick 12]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT"))]
    pub views: Option<usize>,

    /// Side of such a view in pixels, 16 to 4096 [default: 512, with --quick 256]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS"))]
    pub resolution: Option<usize>,

    /// Take outcomes that another build of this program has left; the report counts them
    #[cfg_attr(feature = "clap", arg(long))]
    pub any_build: bool,

    /// Threads to work with, 0 to 256, 0 for one a core
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0))]
    pub threads: usize,
}

impl ReproduceOptions {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the option and what it may be.
    pub fn check(&self) -> Result<(), BakeError> {
        Ok(self.evaluate().check()?)
    }

    /// How results are compared with the high-poly: by the paper's convention (`eval --convention paper`).
    pub fn evaluate(&self) -> EvaluateOptions {
        let (views, resolution) = if self.quick { (12, 256) } else { (48, 512) };
        EvaluateOptions {
            views: self.views.unwrap_or(views),
            resolution: self.resolution.unwrap_or(resolution),
            no_flip: true,
            ..EvaluateOptions::paper()
        }
    }
}
