//! One frame of the film: pictures side by side, names below them.
//!
//! ```text
//! ┌─────────┐ ┌─────────┐ ┌─────────┐
//! │  high   │g│  low    │g│  low    │   resolution × resolution each, a gap of g pixels between
//! └─────────┘ └─────────┘ └─────────┘
//!   caption     caption     caption     below them if wanted
//! ```

use super::caption;
use parbake_metric::Rgb;

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

/// Where pictures and captions lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    side: usize,
    gap: usize,
    captions: bool,
    pub width: usize,
    pub height: usize,
}

/// The colours that are not the models'.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors {
    pub background: [u8; 3],
    pub gap: [u8; 3],
    pub text: [u8; 3],
}

impl Colors {
    /// Gap and text that stand out from this background.
    pub fn before(background: [u8; 3]) -> Self {
        let bright = background.iter().map(|&c| u32::from(c)).sum::<u32>() > 3 * 127;
        let end = if bright { 0 } else { 255 };
        let towards = |share: f32| {
            background.map(|c| (f32::from(c) + share * (end as f32 - f32::from(c))).round() as u8)
        };
        Self { background, gap: towards(0.2), text: towards(0.8) }
    }
}

impl Layout {
    /// For pictures of this side.
    pub fn new(side: usize, models: usize, captions: bool) -> Self {
        let gap = (side / 96).max(1);
        let strip = if captions { caption::height(side) } else { 0 };
        Self {
            side,
            gap,
            captions,
            width: models * side + models.saturating_sub(1) * gap,
            height: side + strip,
        }
    }

    /// The sheet without any picture.
    pub fn blank(&self, colors: &Colors, names: &[String]) -> Sheet {
        let (width, height) = (self.width, self.height);
        let mut sheet = Sheet { width, height, pixels: vec![colors.background; width * height] };
        for row in sheet.pixels.chunks_exact_mut(width) {
            for (x, pixel) in row.iter_mut().enumerate() {
                if x % (self.side + self.gap) >= self.side {
                    *pixel = colors.gap;
                }
            }
        }
        if self.captions {
            for (column, name) in names.iter().enumerate() {
                let place = [column * (self.side + self.gap), self.side];
                caption::write(&mut sheet, place, self.side, name, colors.text);
            }
        }
        sheet
    }

    /// Puts a picture of the layout's side into a column.
    pub fn place(&self, sheet: &mut Sheet, column: usize, picture: &Rgb) {
        let left = column * (self.side + self.gap);
        for (to, from) in
            sheet.pixels.chunks_exact_mut(self.width).zip(picture.pixels.chunks_exact(self.side))
        {
            for (to, from) in to[left..left + self.side].iter_mut().zip(from) {
                *to = bytes(*from);
            }
        }
    }
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
