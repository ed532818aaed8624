//! What can go wrong while a layout is made. Each message says what to do instead.

/// Why a layout could not be made or packed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AtlasError {
    /// The gutters alone need more room than the texture has.
    #[error(
        "{charts} charts with {gutter_texels} texels between them do not fit into a texture of \
         {texture_size} × {texture_size}; take a larger texture or a smaller gutter"
    )]
    NoRoom {
        /// Pieces that were to be packed.
        charts: usize,
        /// Side of the texture, in texels.
        texture_size: usize,
        /// Gutter that was asked for, in texels.
        gutter_texels: f64,
    },
    /// An option has a value that makes no sense.
    #[error("{name} must be {wanted}")]
    InvalidOption {
        /// The option's name.
        name: &'static str,
        /// The values that are possible.
        wanted: &'static str,
    },
    /// Triangles so thin that 32-bit coordinates cannot hold them.
    #[error(
        "{} triangles, the first being number {}, are too thin for 32-bit texture coordinates; \
         unwrap the model afresh",
        triangles.len(), triangles.first().copied().unwrap_or_default()
    )]
    TooThin {
        /// Indices of the triangles, ascending.
        triangles: Vec<u32>,
    },
    /// A connected piece of the surface is not a disk.
    #[error("the piece that holds triangle {triangle} {problem}; {remedy}")]
    NotADisk {
        /// First triangle of the piece.
        triangle: usize,
        /// What is the matter with the piece.
        problem: &'static str,
        /// What to use instead.
        remedy: &'static str,
    },
    /// A layout stayed unsound. This is a fault in this program.
    #[error("no sound layout was found for {triangles} triangles; please report this model")]
    Unsound {
        /// Triangles that are still mirrored or overlap.
        triangles: usize,
    },
}
