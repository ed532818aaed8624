//! What can keep a model from being prepared.

/// One clear sentence, and what to do next.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// A texture cannot be baked without texture coordinates.
    #[error(
        "{model}: the low-poly has no texture coordinates, so there is no place for a texture; let --uv unwrap make some"
    )]
    NoTextureCoordinates {
        /// The low-poly's name.
        model: String,
    },
    /// All texture coordinates fall together.
    #[error("{model}: the low-poly's texture coordinates cover no area; let --uv unwrap make new ones")]
    FlatTextureCoordinates {
        /// The low-poly's name.
        model: String,
    },
    /// Nothing to look at.
    #[error("{model}: its vertices lie in one point or beyond all measure, so there is nothing to render")]
    NoExtent {
        /// The model's name.
        model: String,
    },
}
