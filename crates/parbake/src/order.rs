//! What the stages of one bake have in common: the high-poly, what was asked for, and what follows from that.

use crate::options::BakeOptions;
use crate::plan::Plan;
use crate::work::Work;
use parbake_views::high_poly::HighPoly;

/// What is to be done.
#[derive(Clone, Copy)]
pub(crate) struct Order<'a> {
    pub high: &'a HighPoly,
    pub plan: &'a Plan,
    pub options: &'a BakeOptions,
    pub work: Work,
}
