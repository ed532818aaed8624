//! One frame of the film as pixels, and the parts of it that an animation has to store.

/// Pixels of one frame, 8-bit sRGB, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sheet {
    /// Pixels along a row, at least 1.
    pub width: usize,
    /// Rows, at least 1.
    pub height: usize,
    /// `width * height` pixels.
    pub pixels: Vec<[u8; 3]>,
}

/// A part of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub left: usize,
    pub top: usize,
    /// At least 1.
    pub width: usize,
    /// At least 1.
    pub height: usize,
}

/// A display-referred colour in 8 bits.
pub(super) fn bytes(color: [f32; 3]) -> [u8; 3] {
    color.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
}

impl Rectangle {
    /// All of a picture of this size.
    pub fn whole(width: usize, height: usize) -> Self {
        Self { left: 0, top: 0, width, height }
    }

    /// The smallest rectangle with all differences of two pictures of this width; one pixel where
    /// there are none, since formats know no empty frame.
    pub fn changed<T: PartialEq>(width: usize, before: &[T], now: &[T]) -> Self {
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        for (y, (before, now)) in before.chunks_exact(width).zip(now.chunks_exact(width)).enumerate() {
            let differs = |x: &usize| before[*x] != now[*x];
            let Some(first) = (0..width).find(differs) else { continue };
            let last = (first..width).rev().find(differs).unwrap_or(first);
            (low, high) = ([low[0].min(first), low[1].min(y)], [high[0].max(last), y]);
        }
        let low = [low[0].min(high[0]), low[1].min(high[1])];
        Self { left: low[0], top: low[1], width: high[0] + 1 - low[0], height: high[1] + 1 - low[1] }
    }

    /// Its indices into a picture of this width, row by row.
    pub fn rows(self, width: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
        (self.top..self.top + self.height).map(move |y| {
            let from = y * width + self.left;
            from..from + self.width
        })
    }
}
