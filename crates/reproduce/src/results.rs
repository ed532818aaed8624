//! What came of the experiments, for exhibits to look up.

use crate::experiment::Experiment;
use crate::outcome::Outcome;
use std::path::{Path, PathBuf};

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
