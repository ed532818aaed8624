//! Runs the paper's experiments (Knodt et al. 2023) and draws its tables and figures beside the
//! paper's own numbers.
//!
//! ```text
//! data folder ─ catalogue ─┐
//! options ─────────────────┴ scope ─ exhibits ─ experiments ─ run ⇄ cache
//!                                       │                      │
//!                paper (its figures) ───┴─ tables, figures ────┴─ report, guard
//! ```
//!
//! An *exhibit* is a table or a figure of the paper: it names the experiments that it needs and
//! draws what came of them. An *experiment* is one run of the product on one subject with one
//! recipe; several exhibits may need the same one, and it is made once.
//!
//! Contract: an experiment's outcome is kept under the content of its files, its recipe and the
//! program's own bytes, so a run that was stopped goes on where it was, and nothing old is taken
//! for new. Only finished experiments are kept.

mod cache;
mod catalogue;
mod error;
mod exhibit;
mod exhibits;
mod experiment;
mod guard;
mod observer;
mod options;
mod outcome;
mod paper;
mod perform;
mod plane;
mod relighting;
mod report;
mod reproduce;
mod results;
mod scope;
mod table;
pub mod variants;

pub use error::ReproduceError;
pub use exhibit::Exhibit;
pub use guard::{Fall, Record};
pub use observer::{Event, Observer};
pub use options::ReproduceOptions;
pub use reproduce::{Reproduced, reproduce};
