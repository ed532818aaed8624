//! How the command ends: exit codes that a script can act on.

use parbake::BakeError;
use parbake_reproduce::ReproduceError;
use std::fmt;
use std::process::ExitCode;

/// A run that ended as it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All work is done (or the time budget is spent): 0.
    Finished,
    /// `check` found problems in a layout: 3.
    Problems,
    /// `reproduce` found gains that fell below the record: 4.
    Fallen,
    /// `lod` found no file that reaches `--target-psnr`; the best is written: 4.
    Missed,
    /// Ctrl-C: the best state so far was written: 130.
    Interrupted,
}

impl Ending {
    /// The process's exit code.
    pub fn exit_code(self) -> ExitCode {
        match self {
            Ending::Finished => ExitCode::SUCCESS,
            Ending::Problems => ExitCode::from(3),
            Ending::Fallen | Ending::Missed => ExitCode::from(4),
            Ending::Interrupted => ExitCode::from(130),
        }
    }
}

/// A run that has no result.
#[derive(Debug)]
pub enum Failure {
    /// An input or an option is wrong: 2 for options, 1 for everything else.
    Bake(BakeError),
    /// Something on the command line that clap could not see: 2.
    Usage(String),
    /// The report or JSON could not be made or written: 1.
    Output(String),
    /// A texture or material is missing, and `--strict` was given: 1.
    Strict(String),
    /// The paper's experiments could not be run: 2 for options, 1 for everything else.
    Reproduce(ReproduceError),
}

impl Failure {
    /// The process's exit code.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Usage(_)
            | Failure::Bake(BakeError::Option { .. } | BakeError::Budget { .. })
            | Failure::Reproduce(ReproduceError::Bake(BakeError::Option { .. })) => ExitCode::from(2),
            Failure::Bake(_) | Failure::Output(_) | Failure::Strict(_) | Failure::Reproduce(_) => {
                ExitCode::from(1)
            }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Bake(error) => error.fmt(f),
            Failure::Reproduce(error) => error.fmt(f),
            Failure::Strict(warning) => write!(f, "{warning} (an error because of --strict)"),
            Failure::Usage(text) | Failure::Output(text) => f.write_str(text),
        }
    }
}

impl From<BakeError> for Failure {
    fn from(error: BakeError) -> Self {
        Failure::Bake(error)
    }
}

impl From<ReproduceError> for Failure {
    fn from(error: ReproduceError) -> Self {
        Failure::Reproduce(error)
    }
}

impl From<parbake::FileError> for Failure {
    fn from(error: parbake::FileError) -> Self {
        Failure::Bake(error.into())
    }
}

impl From<parbake::EvaluateError> for Failure {
    fn from(error: parbake::EvaluateError) -> Self {
        Failure::Bake(error.into())
    }
}
