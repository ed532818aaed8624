//! What can keep a bake or an evaluation from a result.

use parbake_evaluate::EvaluateError;
use parbake_files::FileError;
use parbake_mesh::parts::PartsError;
use parbake_views::importance::ImportanceError;

/// One clear sentence, and what to do next where there is something to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// Reading or writing a file.
    #[error(transparent)]
    File(#[from] FileError),
    /// Texture coordinates could not be made or repaired.
    #[error(transparent)]
    Atlas(#[from] parbake_atlas::AtlasError),
    /// An option is out of range.
    #[error("--{option} cannot be {value}: it may be {range}")]
    Option {
        /// Its name on the command line.
        option: &'static str,
        /// What was asked.
        value: String,
        /// What may be asked.
        range: String,
    },
    /// Parts that cannot stay apart.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// Importances that a model cannot have.
    #[error(transparent)]
    Importance(ImportanceError),
    /// Triangles that cannot be shared by all parts.
    #[error(
        "--triangles {triangles} is too few for {model} with its parts apart, of which none may vanish; give {least} or \
         more, or fewer --keep-parts"
    )]
    FewTriangles {
        /// What was asked for.
        triangles: usize,
        /// The model.
        model: String,
        /// How many it takes.
        least: usize,
    },
    /// A time budget that a texture's size cannot keep.
    #[error(
        "--time-budget {budget} cannot hold with --texture-size {size}: projecting and writing alone take about {least} s; \
         give it {least} s or more, or take --texture-size {largest}"
    )]
    Budget {
        /// Seconds that were asked for.
        budget: f64,
        /// Texels along a side.
        size: usize,
        /// Seconds that hold with that size.
        least: f64,
        /// A size that holds with that budget.
        largest: usize,
    },
    /// A picture that a library caller made is not one.
    #[error("{image}: the picture has no pixels, or not as many as its width and height say")]
    BrokenImage {
        /// Its name.
        image: String,
    },
    /// Models could not be compared.
    #[error(transparent)]
    Evaluate(EvaluateError),
    /// A model could not be made ready.
    #[error(transparent)]
    Prepare(#[from] parbake_views::PrepareError),
    /// A high-poly was prepared for bakes of another kind.
    #[error(
        "{model} was prepared with another convention or --max-distance; prepare it with the options of the bake"
    )]
    OtherConventions {
        /// The high-poly's name.
        model: String,
    },
    /// No training view shows any of the low-poly.
    #[error(
        "{low} lies outside of every view of {high}; give both the same unit, origin and axes, so that they overlap"
    )]
    OutOfView {
        /// The low-poly's name.
        low: String,
        /// The high-poly's name.
        high: String,
    },
    /// The moves of texture coordinates could not be encoded.
    #[error("cannot make an animation of the texture coordinates' moves: {reason}")]
    Animation {
        /// What the encoder said.
        reason: String,
    },
    /// A film could not be encoded or written.
    #[error("cannot write the film: {source}")]
    Film {
        /// What the writer said.
        source: std::io::Error,
    },
    /// The watcher stopped a run that has no use for half a result.
    #[error("stopped before the end: nothing was written")]
    Stopped,
    /// The operating system refused to start threads.
    #[error("could not start {threads} threads: {source}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// Why not.
        source: rayon::ThreadPoolBuildError,
    },
}

impl From<EvaluateError> for BakeError {
    fn from(error: EvaluateError) -> Self {
        match error {
            EvaluateError::Option { option, value, range } => Self::Option { option, value, range },
            EvaluateError::Prepare(error) => Self::Prepare(error),
            other => Self::Evaluate(other),
        }
    }
}

impl From<ImportanceError> for BakeError {
    fn from(error: ImportanceError) -> Self {
        match error {
            // As of any option that is out of range.
            ImportanceError::NoMaterial { name, range } => {
                Self::Option { option: "importance", value: name, range }
            }
            other => Self::Importance(other),
        }
    }
}
