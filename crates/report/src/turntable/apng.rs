//! The film as an animated PNG: true colour, lossless. Each frame holds the rectangle that
//! changed since the one before; viewers that know no animation show the first one.

use super::TurntableOptions;
use super::layout::Layout;
use super::reel::Reel;
use super::sheet::{Rectangle, Sheet};
use png::{BitDepth, ColorType, Compression, Writer};
use std::io::{self, Write};

/// Ticks of a frame's time in a second.
const TICKS: u16 = 1000;

/// An animated PNG that is being written.
pub(super) struct Apng<'a> {
    writer: Writer<&'a mut (dyn Write + Send)>,
    options: &'a TurntableOptions,
    before: Option<Sheet>,
    index: usize,
}

impl<'a> Apng<'a> {
    /// Begins the file.
    pub fn new(
        file: &'a mut (dyn Write + Send),
        options: &'a TurntableOptions,
        layout: &Layout,
    ) -> io::Result<Self> {
        let mut encoder = png::Encoder::new(file, side(layout.width)?, side(layout.height)?);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        // Slower ones were measured to give larger files of rendered pictures.
        encoder.set_compression(Compression::Fast);
        // No plays for "again and again".
        encoder.set_animated(side(options.frames)?, 0)?;
        Ok(Self { writer: encoder.write_header()?, options, before: None, index: 0 })
    }
}

impl Reel for Apng<'_> {
    fn add(&mut self, sheet: Sheet) -> io::Result<()> {
        let part = match &self.before {
            None => Rectangle::whole(sheet.width, sheet.height),
            Some(before) => Rectangle::changed(sheet.width, &before.pixels, &sheet.pixels),
        };
        self.writer.set_frame_delay(self.options.ticks(self.index, f64::from(TICKS)), TICKS)?;
        if self.before.is_some() {
            // In this order, for the place is checked against the size and the size against the place.
            self.writer.reset_frame_position()?;
            self.writer.set_frame_dimension(side(part.width)?, side(part.height)?)?;
            self.writer.set_frame_position(side(part.left)?, side(part.top)?)?;
        }
        let mut pixels = Vec::with_capacity(part.width * part.height * 3);
        part.rows(sheet.width).for_each(|row| pixels.extend_from_slice(sheet.pixels[row].as_flattened()));
        self.writer.write_image_data(&pixels)?;
        self.before = Some(sheet);
        self.index += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        Ok(self.writer.finish()?)
    }
}

/// As the format counts.
fn side(length: usize) -> io::Result<u32> {
    u32::try_from(length).map_err(io::Error::other)
}
