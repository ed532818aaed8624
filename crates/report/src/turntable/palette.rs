//! 256 colours for a whole film: those of background, gap and text exactly, one that is
//! transparent, and for the models what NeuQuant (Dekker 1994) finds in some of the frames.

use super::layout::Colors;
use color_quant::NeuQuant;

/// The index of pixels that stay as they are.
pub(super) const TRANSPARENT: u8 = 255;

/// Colours that are not the models'.
const EXACT: usize = 3;

/// More samples than these only take time.
const MOST_SAMPLES: usize = 1 << 17;

/// A film's colours.
pub(super) struct Palette {
    exact: [[u8; 3]; EXACT],
    found: NeuQuant,
}

impl Palette {
    /// For a film of such pixels, of which those of the background do not count.
    pub fn new(colors: &Colors, seen: &[[u8; 3]]) -> Self {
        let exact = [colors.background, colors.gap, colors.text];
        let models: Vec<[u8; 3]> = seen.iter().copied().filter(|c| *c != colors.background).collect();
        let step = models.len().div_ceil(MOST_SAMPLES).max(1);
        let samples: Vec<[u8; 4]> = models.iter().step_by(step).map(|&[r, g, b]| [r, g, b, 255]).collect();
        let found = NeuQuant::new(1, usize::from(TRANSPARENT) - EXACT, samples.as_flattened());
        Self { exact, found }
    }

    /// 256 RGB colours in a row, the transparent one's last.
    pub fn bytes(&self) -> Vec<u8> {
        [self.exact.as_flattened(), &self.found.color_map_rgb(), &[0; 3]].concat()
    }

    /// The nearest colour's index, never the transparent one's.
    pub fn index(&self, color: [u8; 3]) -> u8 {
        let [r, g, b] = color;
        let index = (self.exact.iter().position(|&c| c == color))
            .unwrap_or_else(|| EXACT + self.found.index_of(&[r, g, b, 255]));
        index.min(usize::from(TRANSPARENT) - 1) as u8
    }
}
