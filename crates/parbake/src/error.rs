//! What can keep a bake or an evaluation from a result.

use parbake_files::FileError;

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
    #[error("--{option} {value} is out of range: it may be {range}")]
    Option {
        /// Its name on the command line.
        option: &'static str,
        /// What was asked.
        value: String,
        /// What may be asked.
        range: String,
    },
    /// A pattern that fits no node.
    #[error("--{option} {pattern:?}: {model} has no node of that name with triangles; {has}")]
    NoNode {
        /// The option that names it.
        option: &'static str,
        /// What was asked for.
        pattern: String,
        /// The model.
        model: String,
        /// What there is.
        has: String,
    },
    /// A model that was read without what is painted on it.
    #[error(
        "--importance-attribute {attribute}: {model} was read without it; read it by read_painted_model with the same name"
    )]
    NotPainted {
        /// The model.
        model: String,
        /// The attribute.
        attribute: String,
    },
    /// Parts of a model that moves.
    #[error(
        "--keep-parts: {model} has skins, morph targets or animations, and so becomes one mesh with a skeleton, in which \
         nodes that move stay as joints; leave --keep-parts out, or take a copy of the model that nothing moves"
    )]
    PartsOfRig {
        /// The model.
        model: String,
    },
    /// A node of which positions cannot be told in its own space.
    #[error(
        "--keep-parts: node {node:?} of {model} is scaled to nothing along an axis, so that it cannot keep its pivot; \
         apply its scale to its mesh"
    )]
    FlatPart {
        /// The model.
        model: String,
        /// The node.
        node: String,
    },
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
