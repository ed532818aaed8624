//! What came of a batch, and of each of its jobs.
//!
//! Contract: only finished jobs have a record.

use crate::job::Job;
use crate::record::Record;
use std::path::PathBuf;

/// What came of a job.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It was finished before.
    Kept(Record),
    /// It has been finished now.
    Made(Record),
    /// It failed: why, in a sentence.
    Failed(String),
    /// The batch was stopped before its end.
    Waiting,
}

impl Outcome {
    /// Of a finished job.
    pub fn record(&self) -> Option<&Record> {
        match self {
            Self::Kept(record) | Self::Made(record) => Some(record),
            Self::Failed(_) | Self::Waiting => None,
        }
    }
}

/// A job, and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// The job.
    pub job: Job,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// All jobs, in the order in which they were given.
    pub jobs: Vec<Ended>,
    /// Whether it was stopped.
    pub stopped: bool,
    /// The page; none where single jobs were asked for.
    pub page: Option<PathBuf>,
}
