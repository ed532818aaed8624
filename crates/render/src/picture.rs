//! What a camera sees.

/// A square picture in linear light: premultiplied RGB and coverage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Pixels along a side.
    pub size: usize,
    /// size² pixels, row 0 on top.
    pub rgba: Vec<[f32; 4]>,
}
