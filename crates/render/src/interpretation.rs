//! How a file is to be read where viewers differ.

/// What a file's numbers mean when they are rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpretation {
    /// Decode base colour from sRGB to linear light before shading, as glTF says.
    /// Off: shade the stored numbers as they are (the paper's pictures).
    pub decode_srgb: bool,
    /// Fetch through mip levels; off: bilinear on the finest level.
    pub trilinear: bool,
    /// Shift texture coordinates where a material has a parallax map, and leave out what its
    /// cutout does; off: as viewers see the model that know no such maps.
    pub parallax: bool,
    /// Show clearcoat, sheen, specular, index of refraction, transmission and volume, in pictures of whole materials;
    /// off: of sheen and transmission what base colour and opacity can show of them.
    pub extensions: bool,
}

impl Default for Interpretation {
    fn default() -> Self {
        Self { decode_srgb: true, trilinear: true, parallax: true, extensions: false }
    }
}
