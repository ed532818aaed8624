//! How tables and figures show an outcome, and two of them compared.

use crate::outcome::Outcome;
use crate::table::Cell;

/// The score as a cell.
pub fn score(outcome: Option<&Outcome>) -> Cell {
    Cell::or_missing(outcome.map(|o| Cell::Score(o.psnr(), o.ms_ssim())))
}

/// How much more decibels one has than the other.
pub fn gain(of: impl Fn(&Outcome) -> f64, better: Option<&Outcome>, base: Option<&Outcome>) -> Option<f64> {
    Some(of(better?) - of(base?))
}
