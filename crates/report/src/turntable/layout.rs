//! How a frame is laid out: pictures side by side, names below them.
//!
//! ```text
//! ┌─────────┐ ┌─────────┐ ┌─────────┐
//! │  high   │g│  low    │g│  low    │   resolution × resolution each, a gap of g pixels between
//! └─────────┘ └─────────┘ └─────────┘
//!   caption     caption     caption     below them if wanted
//! ```

use super::caption;
use super::sheet::{Sheet, bytes};
use parbake_metric::Rgb;

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
