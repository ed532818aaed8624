//! How a time budget is shared out.

/// The shares of stages in the time that a budget leaves them: textures are worth most, and
/// what reference pictures show must be solved for.
pub(crate) mod shares {
    /// Of moving vertices.
    pub const SHAPE: f64 = 0.2;
    /// Of optimising texture coordinates.
    pub const UV: f64 = 0.15;
    /// Of rendering the high-poly.
    pub const REFERENCE: f64 = 0.25;
    /// Of fitting parallax map and cutout.
    pub const PARALLAX: f64 = 0.35;
}
