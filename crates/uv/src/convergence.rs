//! The paper's method as a curve: its two losses at each iteration, and where its stages end.

use crate::paper::PaperHistory;
use serde::{Deserialize, Serialize};

/// How the paper's method went through its three stages (Fig. 15).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// Iterations, L_diff (mean squared error) and L_I∘UV.
    pub points: Vec<(usize, f64, f64)>,
    /// Iterations at which coordinates began to move and ended.
    pub moved: [usize; 2],
}

impl From<PaperHistory> for Convergence {
    fn from(history: PaperHistory) -> Self {
        let points = history.points.iter().map(|p| (p.iteration, p.loss, p.content)).collect();
        Self { points, moved: history.moved }
    }
}
