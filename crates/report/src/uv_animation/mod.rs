//! The way of a texture layout through a run, as a moving picture.
//!
//! ```text
//! UvMoves ─ evenly chosen ─ drawing (levels of chart colours) ─ changes ─ GIF
//!                                palette ────────────────────────────────┘
//! ```
//!
//! A GIF, since every browser and nearly every picture viewer plays it. All frames share
//! one palette, so none has to be quantised, and hold only what changed since the one
//! before: a layout that settles costs little.
//!
//! Contract: the bytes depend on the arguments only, not on the number of threads;
//! points that are not finite and triangles without such points are left out.

mod drawing;
mod palette;

use drawing::{Canvas, Drawing};
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use parbake::{BakeError, UvMoves};
use rayon::prelude::*;
use std::borrow::Cow;

/// Time from the first to the last frame and how long a frame stays, in hundredths of
/// a second.
const PLAYING_TIME: usize = 400;
const SHORTEST: usize = 6;
const LONGEST: usize = 40;
/// How long the first and the last frame stay.
const FIRST: u16 = 60;
const LAST: u16 = 220;

/// How to draw [`UvMoves`].
#[derive(Clone, Debug, PartialEq)]
pub struct UvAnimationOptions {
    /// Pixels along a side of the texture's square, 16 to 2048; a margin comes to it.
    pub side: usize,
    /// Frames to show at most, 1 or more, chosen evenly with the first and the last one.
    pub most_frames: usize,
    /// Bytes that the file should keep within: fewer frames are shown where it would
    /// not, but never fewer than 8 of them for that.
    pub most_bytes: usize,
}

impl Default for UvAnimationOptions {
    fn default() -> Self {
        Self { side: 480, most_frames: 60, most_bytes: 2_000_000 }
    }
}

/// Frames that a file has at least before its size counts.
const FEWEST_FRAMES: usize = 8;

/// Draws layouts as an animated GIF that plays again and again. Charts have colours of
/// their own, flipped triangles are red, and a bar below tells how far the run is.
/// Without layouts the square stays empty.
///
/// Runs on rayon's current thread pool.
///
/// # Errors
/// When the encoder refuses a frame, which none of these options leads to.
pub fn uv_animation(moves: &UvMoves, options: &UvAnimationOptions) -> Result<Vec<u8>, BakeError> {
    let drawing = Drawing::new(moves, options.side.clamp(16, 2048));
    let mut count = options.most_frames.max(1).min(moves.frames.len());
    loop {
        let gif = encoded(&drawing, moves, &chosen(moves.frames.len(), count))?;
        if gif.len() <= options.most_bytes || count <= FEWEST_FRAMES {
            return Ok(gif);
        }
        // A frame that stands for more moves holds more changes: aim lower than the share.
        let share = 0.85 * options.most_bytes as f64 / gif.len() as f64;
        count = ((count as f64 * share) as usize).clamp(FEWEST_FRAMES, count - 1);
    }
}

/// `count` of `all` indices, evenly, with the first and the last one.
fn chosen(all: usize, count: usize) -> Vec<usize> {
    match (all, count) {
        (0, _) | (_, 0) => Vec::new(),
        (_, 1) => vec![all - 1],
        _ => (0..count).map(|i| (i * (all - 1) + (count - 1) / 2) / (count - 1)).collect(),
    }
}

fn encoded(drawing: &Drawing, moves: &UvMoves, shown: &[usize]) -> Result<Vec<u8>, BakeError> {
    let failed = |error: gif::EncodingError| BakeError::Animation { reason: error.to_string() };
    let last = moves.frames.len().saturating_sub(1).max(1) as f64;
    let mut canvases: Vec<Canvas> =
        shown.par_iter().map(|&index| drawing.frame(&moves.frames[index], index as f64 / last)).collect();
    if canvases.is_empty() {
        canvases.push(drawing.frame(&[], 0.0));
    }
    let delay = (PLAYING_TIME / canvases.len()).clamp(SHORTEST, LONGEST) as u16;
    let frames: Vec<Frame> = (0..canvases.len())
        .into_par_iter()
        .map(|i| {
            let before = i.checked_sub(1).map(|i| &canvases[i]);
            let mut frame = changed(before, &canvases[i]);
            frame.delay = match i {
                _ if i + 1 == canvases.len() => LAST,
                0 => FIRST,
                _ => delay,
            };
            frame.make_lzw_pre_encoded();
            frame
        })
        .collect();
    let extent = drawing.extent() as u16;
    let mut encoder = Encoder::new(Vec::new(), extent, extent, &palette::bytes()).map_err(failed)?;
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    for frame in &frames {
        encoder.write_lzw_pre_encoded_frame(frame).map_err(failed)?;
    }
    encoder.into_inner().map_err(failed)
}

/// The smallest rectangle that holds all changes; inside it, what did not change is
/// transparent.
fn changed(before: Option<&Canvas>, now: &Canvas) -> Frame<'static> {
    let mut frame = Frame { dispose: DisposalMethod::Keep, ..Frame::default() };
    let extent = now.extent;
    let Some(before) = before else {
        (frame.width, frame.height) = (extent as u16, extent as u16);
        frame.buffer = Cow::Owned(now.pixels.clone());
        return frame;
    };
    let differs = |x: usize, y: usize| now.pixels[y * extent + x] != before.pixels[y * extent + x];
    // Empty pictures are forbidden: where nothing changed, one transparent pixel is shown.
    let (mut low, mut high) = ([extent; 2], [0; 2]);
    for y in 0..extent {
        for x in (0..extent).filter(|&x| differs(x, y)) {
            (low, high) = ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]);
        }
    }
    let low = [low[0].min(high[0]), low[1].min(high[1])];
    let mut pixels = Vec::with_capacity((high[0] + 1 - low[0]) * (high[1] + 1 - low[1]));
    for y in low[1]..=high[1] {
        pixels.extend(
            (low[0]..=high[0])
                .map(|x| if differs(x, y) { now.pixels[y * extent + x] } else { palette::TRANSPARENT }),
        );
    }
    [frame.left, frame.top] = low.map(|x| x as u16);
    [frame.width, frame.height] = [0, 1].map(|k| (high[k] + 1 - low[k]) as u16);
    frame.transparent = Some(palette::TRANSPARENT);
    frame.buffer = Cow::Owned(pixels);
    frame
}

#[cfg(test)]
mod tests;
