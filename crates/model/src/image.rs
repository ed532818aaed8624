//! An 8-bit RGBA picture as a file holds it.

/// 8-bit RGBA pixels, row 0 on top. How the numbers are to be understood (sRGB
/// colour, tangent-space normal, …) is the [`Material`](crate::Material)'s matter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Where it came from, to show to people.
    pub name: String,
    /// Width in texels, at least 1.
    pub width: usize,
    /// Height in texels, at least 1.
    pub height: usize,
    /// `width * height` RGBA texels.
    pub pixels: Vec<[u8; 4]>,
}

impl Image {
    /// A picture of one colour.
    pub fn solid(name: &str, width: usize, height: usize, rgba: [u8; 4]) -> Self {
        Self { name: name.into(), width, height, pixels: vec![rgba; width * height] }
    }

    /// Whether it has pixels, and as many as its width and height say.
    pub fn is_whole(&self) -> bool {
        !self.pixels.is_empty() && self.width.checked_mul(self.height) == Some(self.pixels.len())
    }
}
