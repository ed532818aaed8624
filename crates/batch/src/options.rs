//! How a batch is run.

use crate::error::BatchError;
use serde::{Deserialize, Serialize};

/// Options of a batch; none changes what is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct BatchOptions {
    /// Jobs that run at once, 1 to 256; they share the cores
    #[cfg_attr(feature = "clap", arg(short, long, value_name = "COUNT", default_value_t = 1))]
    pub workers: usize,

    /// Memory that all jobs together may take, in GB; a further job waits where it might not fit [default: what is
    /// available]
    #[cfg_attr(feature = "clap", arg(long, value_name = "GB"))]
    pub memory: Option<f64>,

    /// Run these jobs only, by name, and write no page
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", value_delimiter = ','))]
    pub only: Vec<String>,
}

impl Default for BatchOptions {
    fn default() -> Self {
        Self { workers: 1, memory: None, only: Vec::new() }
    }
}

impl BatchOptions {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the option and what it may be.
    pub fn check(&self) -> Result<(), BatchError> {
        if !(1..=256).contains(&self.workers) {
            let text = format!("--workers cannot be {}: it may be 1 to 256", self.workers);
            return Err(BatchError::Option(text));
        }
        match self.memory {
            Some(memory) if !(memory > 0.0 && memory <= 1e6) => {
                Err(BatchError::Option(format!("--memory cannot be {memory}: it may be above 0 to 1000000")))
            }
            _ => Ok(()),
        }
    }
}
