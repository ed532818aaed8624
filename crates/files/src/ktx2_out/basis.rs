//! Texels to Basis Universal's blocks: ETC1S with its codebooks, and UASTC. The encoder is Binomial's, by the
//! crate `basis-universal`; the layout of the .basis file that it makes is that of `basisu_file_headers.h` and
//! of Basis Universal's specification (.basis file format).
//!
//! Contract: the same bytes for any number of threads. The encoder's own threads would make its codebooks depend
//! on their number, so each call of it has one; UASTC's blocks do not depend on each other, so bands of them are
//! encoded beside each other. All `unsafe` of this crate is in [`compress`].

use basis_universal::{BasisTextureFormat, ColorSpace, Compressor, CompressorParams};
use parbake_model::Image;
use rayon::prelude::*;

/// The longest side that the encoder takes.
pub(crate) const LONGEST_SIDE: usize = 16_384;

/// Rows of texels of a band of UASTC: enough work for a thread, little memory.
const BAND: usize = 128;

/// A chain of mip levels in ETC1S.
pub(super) struct Etc1s {
    pub endpoint_count: u16,
    pub selector_count: u16,
    pub endpoints: Vec<u8>,
    pub selectors: Vec<u8>,
    pub tables: Vec<u8>,
    /// Slices of colour and, where any texel is not opaque, of alpha; the largest level first.
    pub levels: Vec<(Vec<u8>, Option<Vec<u8>>)>,
}

/// Encodes a chain, the largest level first. `quality` is 1 to 255; `srgb` tells whether errors count as the eye
/// sees them.
pub(super) fn etc1s(levels: &[Image], quality: u32, srgb: bool) -> Option<Etc1s> {
    let mut params = CompressorParams::new();
    params.set_basis_format(BasisTextureFormat::ETC1S);
    params.set_etc1s_quality_level(quality.clamp(1, 255));
    params.set_color_space(if srgb { ColorSpace::Srgb } else { ColorSpace::Linear });
    // What these would save costs most where neighbours are alike but not the same.
    params.set_no_selector_rdo(!srgb);
    params.set_no_endpoint_rdo(!srgb);
    Basis(compress(params, levels)?).etc1s()
}

/// Blocks of one level in UASTC, row by row. `careful` takes about twice the time.
pub(super) fn uastc(level: &Image, careful: bool) -> Option<Vec<u8>> {
    let band = |pixels: &[[u8; 4]]| {
        let height = pixels.len() / level.width;
        let band = Image { name: String::new(), width: level.width, height, pixels: pixels.to_vec() };
        let mut params = CompressorParams::new();
        params.set_basis_format(BasisTextureFormat::UASTC4x4);
        if careful {
            params.set_uastc_quality_level(3);
        }
        Basis(compress(params, std::slice::from_ref(&band))?).slices().map(|slices| slices.concat())
    };
    level
        .pixels
        .par_chunks(BAND * level.width)
        .map(band)
        .collect::<Option<Vec<_>>>()
        .map(|bands| bands.concat())
}

/// Runs the encoder over a picture and its mip levels; none where it fails.
#[expect(unsafe_code, reason = "the encoder is C++, and does not check what it is told")]
fn compress(mut params: CompressorParams, levels: &[Image]) -> Option<Vec<u8>> {
    for (i, level) in levels.iter().enumerate() {
        let sides = [level.width, level.height].map(u32::try_from);
        let [Ok(width), Ok(height)] = sides else { return None };
        if !level.is_whole() || level.width.max(level.height) > LONGEST_SIDE {
            return None;
        }
        let mut image = match i.checked_sub(1) {
            None => params.source_image_mut(0),
            Some(mip) => params.source_mipmap_image_mut(0, mip as u32),
        };
        // Copies; it reads four bytes for each texel.
        image.init(level.pixels.as_flattened(), width, height, 4);
    }
    let mut compressor = Compressor::new(1);
    // SAFETY: the encoder counts on settings within its ranges and on pictures that are there. The settings come
    // from the two functions above: a format, a quality within 1 to 255 or a UASTC level of 2 or 3, and a colour
    // space; all else is at its default. The picture and its levels were copied above, each with as many texels
    // as its sides say and with sides of at most `LONGEST_SIDE`. `params` lives until the work is done.
    let done = unsafe { compressor.init(&params) && compressor.process().is_ok() };
    // An empty file may have no address, of which no slice may be made.
    (done && compressor.basis_file_size() > 0).then(|| compressor.basis_file().to_vec())
}

/// A .basis file.
struct Basis(Vec<u8>);

impl Basis {
    /// A number of up to four bytes, the lowest first.
    fn number(&self, at: usize, bytes: usize) -> Option<usize> {
        let bytes = self.0.get(at..at.checked_add(bytes)?)?;
        Some(bytes.iter().rev().fold(0, |number, &byte| number << 8 | usize::from(byte)))
    }

    fn part(&self, offset: usize, length: usize) -> Option<&[u8]> {
        self.0.get(offset..offset.checked_add(length)?)
    }

    /// The encoded pictures in the file's order: of ETC1S with alpha a slice of colour and one of alpha for each
    /// level, else one for each level, the largest first.
    fn slices(&self) -> Option<Vec<&[u8]>> {
        const BYTES: usize = 23;
        let (count, first) = (self.number(14, 3)?, self.number(65, 4)?);
        (0..count)
            .map(|i| {
                let description = first + BYTES * i;
                self.part(self.number(description + 13, 4)?, self.number(description + 17, 4)?)
            })
            .collect()
    }

    fn etc1s(&self) -> Option<Etc1s> {
        const HAS_ALPHA: usize = 4;
        let has_alpha = self.number(21, 2)? & HAS_ALPHA != 0;
        let slices = self.slices()?;
        let levels = slices.chunks(if has_alpha { 2 } else { 1 });
        let level = |of: &[&[u8]]| (of[0].to_vec(), of.get(1).map(|alpha| alpha.to_vec()));
        Some(Etc1s {
            endpoint_count: self.number(39, 2)? as u16,
            selector_count: self.number(48, 2)? as u16,
            endpoints: self.part(self.number(41, 4)?, self.number(45, 3)?)?.to_vec(),
            selectors: self.part(self.number(50, 4)?, self.number(54, 3)?)?.to_vec(),
            tables: self.part(self.number(57, 4)?, self.number(61, 4)?)?.to_vec(),
            levels: levels.map(level).collect(),
        })
    }
}
