//! Many runs of the `parbake` command: one after the other or side by side, each in a process of its own.
//!
//! ```text
//! jobs.toml ─ jobs_file ─┐                 ┌ worker (a process), as memory allows
//! folder ──── folder ────┴ job ─ key ─ run ┤
//!                           │      ⇅       └ record ─ page
//!                         openjd  records
//! ```
//!
//! A *job* is one command line. Its *key* is a digest of the program, the arguments and the content of all files
//! that go in. Results are written to a temporary folder and renamed when the job has ended well; its *record* is
//! written last. A job whose record has its key is finished: that is all there is to going on after a stop.
//!
//! Contract: whatever ends this process at whatever time, results that have a record are whole, and only jobs that
//! were running are lost. Files depend on the jobs alone, not on how many run at once or how often they were stopped.

mod digest;
mod error;
mod folder;
mod job;
mod jobs_file;
mod memory;
mod observer;
mod openjd;
mod options;
mod outcome;
mod page;
mod place;
mod record;
mod run;
mod worker;

pub use error::BatchError;
pub use folder::jobs_of_folder;
pub use job::{Abilities, Commands, Job};
pub use jobs_file::{JobsFile, read_jobs};
pub use observer::{Event, Observer};
pub use openjd::{TaskCommand, openjd_template};
pub use options::BatchOptions;
pub use outcome::{Batch, Ended, Outcome};
pub use page::summary;
pub use run::run_batch;

/// A variable of a worker's environment: where it is set, the program ends when its standard input does, so that no
/// worker outlives a batch that was killed.
pub const LEASH: &str = "PARBAKE_ENDS_WITH_STDIN";
