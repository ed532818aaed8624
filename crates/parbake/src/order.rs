//! What the stages of one bake have in common: the high-poly, what was asked for, what follows from that, and
//! what computes.

use crate::options::BakeOptions;
use crate::plan::Plan;
use crate::work::Work;
use parbake_fit::backend::Cpu;
use parbake_views::high_poly::HighPoly;

/// The implementation of the coarse operations ([`Backend`](parbake_fit::backend::Backend)) that bakes use. This is
/// the only place that names it.
pub(crate) type BakeBackend = Cpu;

/// What is to be done.
#[derive(Clone, Copy)]
pub(crate) struct Order<'a> {
    pub high: &'a HighPoly,
    pub plan: &'a Plan,
    pub options: &'a BakeOptions,
    pub work: Work,
    /// Computes the coarse operations.
    pub backend: &'a BakeBackend,
}
