//! The functions of the direction of view whose coefficients parallax maps and cutouts hold.
//!
//! Harmonics are functions of the direction to the viewer in the mesh's own axes. All others are functions
//! of the *line of sight* in the surface's tangent frame: w = ±d, with the sign for which w·n ≥ 0. A point
//! that is seen from behind along a line shows what it shows from the front, so half of the directions do,
//! and since the frame turns with the surface, such maps are safe under instancing, skins and batching.
//! The formulas are in the renderer's `directions.rs` and in `docs/parallax_format.md`.

/// A set of functions, and how their coefficients are packed into images.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Basis {
    /// Real spherical harmonics up to this order, 0 to 7 (Knodt et al. 2023). Three channels an image.
    Harmonics(usize),
    /// What shifts are made of: x, y, xz, yz of the line of sight. Four channels a layer.
    TangentShift,
    /// What cutouts are made of. Four channels a layer.
    TangentCutout,
}

impl Basis {
    /// The highest order of harmonics.
    pub const HIGHEST_ORDER: usize = 7;

    /// How many functions there are.
    pub const fn count(self) -> usize {
        match self {
            Self::Harmonics(order) => (order + 1) * (order + 1),
            Self::TangentShift => 4,
            Self::TangentCutout => 12,
        }
    }

    /// Whether directions are lines of sight in the tangent frame.
    pub const fn is_tangent(self) -> bool {
        !matches!(self, Self::Harmonics(_))
    }

    /// Channels that an image holds side by side.
    pub const fn channels_of_image(self) -> usize {
        if self.is_tangent() { 4 } else { 3 }
    }

    /// Images of so many channels. Those of the tangent frame are one picture, a layer below the other.
    pub const fn image_count(self, channels: usize) -> usize {
        if self.is_tangent() { 1 } else { channels.div_ceil(3) }
    }

    /// Layers in one image, from top to bottom.
    pub const fn layers(self, channels: usize) -> usize {
        if self.is_tangent() { channels.div_ceil(4) } else { 1 }
    }
}
