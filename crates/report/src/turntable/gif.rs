//! The film as a GIF. All frames share one palette, so that colours do not flicker and what
//! did not change can stay transparent; a frame holds the rectangle that changed.

use super::TurntableOptions;
use super::layout::Layout;
use super::palette::{Palette, TRANSPARENT};
use super::reel::Reel;
use super::sheet::{Rectangle, Sheet};
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use rayon::prelude::*;
use std::borrow::Cow;
use std::io::{self, Write};

/// Ticks of a frame's time in a second.
const TICKS: f64 = 100.0;

/// A GIF that is being written.
pub(super) struct Gif<'a> {
    encoder: Encoder<&'a mut (dyn Write + Send)>,
    options: &'a TurntableOptions,
    palette: Palette,
    before: Option<Vec<u8>>,
    index: usize,
}

impl<'a> Gif<'a> {
    /// Begins the file.
    pub fn new(
        file: &'a mut (dyn Write + Send),
        options: &'a TurntableOptions,
        layout: &Layout,
        palette: Palette,
    ) -> io::Result<Self> {
        let mut encoder = Encoder::new(file, side(layout.width)?, side(layout.height)?, &palette.bytes())
            .map_err(failure)?;
        encoder.set_repeat(Repeat::Infinite).map_err(failure)?;
        Ok(Self { encoder, options, palette, before: None, index: 0 })
    }
}

impl Reel for Gif<'_> {
    fn add(&mut self, sheet: Sheet) -> io::Result<()> {
        let now: Vec<u8> = sheet.pixels.par_iter().map(|&color| self.palette.index(color)).collect();
        let (part, transparent) = match &self.before {
            None => (Rectangle::whole(sheet.width, sheet.height), None),
            Some(before) => (Rectangle::changed(sheet.width, before, &now), Some(TRANSPARENT)),
        };
        let mut pixels = Vec::with_capacity(part.width * part.height);
        for row in part.rows(sheet.width) {
            match &self.before {
                None => pixels.extend_from_slice(&now[row]),
                Some(before) => pixels.extend(
                    (before[row.clone()].iter().zip(&now[row]))
                        .map(|(before, &now)| if *before == now { TRANSPARENT } else { now }),
                ),
            }
        }
        let frame = Frame {
            delay: self.options.ticks(self.index, TICKS),
            dispose: DisposalMethod::Keep,
            transparent,
            left: side(part.left)?,
            top: side(part.top)?,
            width: side(part.width)?,
            height: side(part.height)?,
            buffer: Cow::Owned(pixels),
            ..Frame::default()
        };
        self.encoder.write_frame(&frame).map_err(failure)?;
        self.before = Some(now);
        self.index += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.encoder.into_inner().map(|_| ()).map_err(failure)
    }
}

/// As the format counts.
fn side(length: usize) -> io::Result<u16> {
    u16::try_from(length).map_err(io::Error::other)
}

fn failure(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}
