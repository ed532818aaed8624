//! What can keep models from being compared.

use parbake_views::PrepareError;

/// One clear sentence, and what to do next.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// An option is out of range.
    #[error("--{option} cannot be {value}: it may be {range}")]
    Option {
        /// Its name on the command line.
        option: &'static str,
        /// What was asked.
        value: String,
        /// What may be asked.
        range: String,
    },
    /// A model has no extent.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
}
