//! KTX2 pictures out, as glTF has them (KHR_texture_basisu): one two-dimensional picture with all its mip levels,
//! in ETC1S with BasisLZ, or in UASTC under Zstandard.
//!
//! The container is that of the KTX 2.0 specification (section 3; BasisLZ's global data in section 5), the data
//! format descriptor that of the Khronos Data Format specification 1.3. Descriptors give the size of UASTC's blocks
//! also under Zstandard, as later revisions of the container ask; earlier ones asked for 0, and readers take both.
//! `mips.rs` makes the levels, `basis.rs` their blocks; `ktx2.rs` beside this folder reads.
//!
//! Contract: sides are multiples of four, as the extension asks, and at most [`LONGEST_SIDE`]; the same picture
//! gives the same bytes.

mod basis;
mod mips;
#[cfg(test)]
mod tests;

pub(crate) use basis::LONGEST_SIDE;
pub(crate) use mips::Content;

use crate::ktx2::{BLOCK, ETC1S, HEADER, LEVEL, MAGIC, UASTC};
use parbake_model::Image;

/// How texels are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Codec {
    /// Small files of less quality, 1 to 255.
    Etc1s(u32),
    /// A byte a texel; whether the encoder takes the time for the last tenths of a decibel.
    Uastc { careful: bool },
}

/// Whether KTX2 in glTF has a place for a picture of these sides.
pub(crate) fn fits(image: &Image) -> bool {
    let fits = |side: usize| side > 0 && side.is_multiple_of(4) && side <= LONGEST_SIDE;
    fits(image.width) && fits(image.height)
}

/// A picture as a KTX2 file; none where the encoder fails. `cutoff` is the alpha from which on a masked material
/// shows anything: coverage is kept at every level.
pub(crate) fn encode(image: &Image, content: Content, cutoff: Option<f32>, codec: Codec) -> Option<Vec<u8>> {
    if !fits(image) || !image.is_whole() {
        return None;
    }
    let levels = mips::levels(image, content, cutoff);
    let srgb = content == Content::Color;
    let file = match codec {
        Codec::Etc1s(quality) => {
            let encoded = basis::etc1s(&levels, quality, srgb)?;
            File::etc1s(&encoded, srgb)?
        }
        Codec::Uastc { careful } => {
            let has_alpha = levels.iter().flat_map(|level| &level.pixels).any(|p| p[3] != 255);
            let blocks = levels.iter().map(|level| basis::uastc(level, careful));
            File::uastc(&blocks.collect::<Option<Vec<_>>>()?, has_alpha, srgb)?
        }
    };
    Some(file.bytes(image))
}

/// A channel of the descriptor.
struct Sample {
    /// Its kind, of those of its model.
    channel: u32,
    bits: u32,
}

/// The parts of a file.
struct File {
    /// Supercompression: 1 for BasisLZ, 2 for Zstandard.
    scheme: u32,
    descriptor: Vec<u8>,
    global_data: Vec<u8>,
    /// The largest first; each with its length before supercompression, of which BasisLZ has none.
    levels: Vec<(Vec<u8>, usize)>,
}

/// How hard Zstandard tries, 1 to 22. Files of UASTC get 11 % smaller by 3, 13 % by 9 and 16 % by 19, which takes a
/// fifth of a second for a million texels: far less than the encoder of blocks.
const EFFORT: i32 = 19;

impl File {
    /// None where Zstandard fails.
    fn uastc(levels: &[Vec<u8>], has_alpha: bool, srgb: bool) -> Option<Self> {
        const RGB: u32 = 0;
        const RGBA: u32 = 3;
        let sample = Sample { channel: if has_alpha { RGBA } else { RGB }, bits: 128 };
        let descriptor = descriptor(UASTC, BLOCK as u32, &[sample], srgb);
        let level = |level: &Vec<u8>| Some((zstd::bulk::compress(level, EFFORT).ok()?, level.len()));
        let levels = levels.iter().map(level).collect::<Option<_>>()?;
        Some(Self { scheme: 2, descriptor, global_data: Vec::new(), levels })
    }

    /// None where the encoder's parts are longer than the file has room for.
    fn etc1s(encoded: &basis::Etc1s, srgb: bool) -> Option<Self> {
        const RGB: u32 = 0;
        const AAA: u32 = 15;
        let has_alpha = encoded.levels.iter().any(|(_, alpha)| alpha.is_some());
        let channels = if has_alpha { &[RGB, AAA][..] } else { &[RGB] };
        let samples: Vec<Sample> = channels.iter().map(|&channel| Sample { channel, bits: 64 }).collect();
        let mut data = Vec::new();
        data.extend(encoded.endpoint_count.to_le_bytes());
        data.extend(encoded.selector_count.to_le_bytes());
        let parts = [&encoded.endpoints, &encoded.selectors, &encoded.tables];
        for part in parts {
            data.extend(u32::try_from(part.len()).ok()?.to_le_bytes());
        }
        let no_extended_data = 0u32;
        data.extend(no_extended_data.to_le_bytes());
        for (color, alpha) in &encoded.levels {
            let (color, alpha) = (u32::try_from(color.len()).ok()?, alpha.as_ref().map_or(0, Vec::len));
            // No flags: a picture that depends on no other. Then offsets in the level, and lengths.
            let description = match u32::try_from(alpha).ok()? {
                0 => [0, 0, color, 0, 0],
                alpha => [0, 0, color, color, alpha],
            };
            data.extend(description.map(u32::to_le_bytes).as_flattened());
        }
        for part in parts {
            data.extend(part);
        }
        let level = |(color, alpha): &(Vec<u8>, Option<Vec<u8>>)| match alpha {
            Some(alpha) => [color.as_slice(), alpha].concat(),
            None => color.clone(),
        };
        Some(Self {
            scheme: 1,
            // The size of a block in planes is not known before BasisLZ is undone, and said to be 0.
            descriptor: descriptor(ETC1S, 0, &samples, srgb),
            global_data: data,
            levels: encoded.levels.iter().map(|encoded| (level(encoded), 0)).collect(),
        })
    }

    fn bytes(&self, image: &Image) -> Vec<u8> {
        let writer = concat!("Parbake ", env!("CARGO_PKG_VERSION"));
        let values = [key_value("KTXorientation", "rd"), key_value("KTXwriter", writer)].concat();
        let descriptor_at = HEADER + LEVEL * self.levels.len();
        let values_at = descriptor_at + self.descriptor.len();
        let mut end = values_at + values.len();
        let global_at = match self.global_data.len() {
            0 => 0,
            length => {
                let start = end.next_multiple_of(8);
                end = start + length;
                start
            }
        };
        // The smallest stands first, so that a stream shows something soon.
        let mut places = vec![0; self.levels.len()];
        for (place, (level, _)) in places.iter_mut().zip(&self.levels).rev() {
            *place = end;
            end += level.len();
        }
        let mut out = MAGIC.to_vec();
        // No Vulkan format, bytes of a datum, three sides, layers, faces.
        let header = [0, 1, image.width, image.height, 0, 0, 1, self.levels.len(), self.scheme as usize];
        let parts = [descriptor_at, self.descriptor.len(), values_at, values.len()];
        for word in header.into_iter().chain(parts) {
            out.extend((word as u32).to_le_bytes());
        }
        for long in [global_at, self.global_data.len()] {
            out.extend((long as u64).to_le_bytes());
        }
        for (place, (level, whole)) in places.iter().zip(&self.levels) {
            for long in [*place, level.len(), *whole] {
                out.extend((long as u64).to_le_bytes());
            }
        }
        out.extend(&self.descriptor);
        out.extend(&values);
        let mut put = |place: usize, bytes: &[u8]| {
            out.resize(place, 0);
            out.extend(bytes);
        };
        if !self.global_data.is_empty() {
            put(global_at, &self.global_data);
        }
        for (place, (level, _)) in places.iter().zip(&self.levels).rev() {
            put(*place, level);
        }
        out
    }
}

/// A basic data format descriptor, with its own length before it: blocks of 4 × 4 texels, colours in sRGB with
/// BT.709's primaries, or numbers as they are.
fn descriptor(model: u32, block_bytes: u32, samples: &[Sample], srgb: bool) -> Vec<u8> {
    const VERSION: u32 = 2;
    let (primaries, transfer) = if srgb { (1, 2) } else { (0, 1) };
    let length = 24 + 16 * samples.len() as u32;
    let mut words = vec![length + 4, 0, VERSION | length << 16];
    words.extend([model | primaries << 8 | transfer << 16, 3 | 3 << 8, block_bytes, 0]);
    let mut offset = 0;
    for Sample { channel, bits } in samples {
        // Where it begins, its last bit, what it is; no position; from 0 to all bits set.
        words.extend([offset | (bits - 1) << 16 | channel << 24, 0, 0, u32::MAX]);
        offset += bits;
    }
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// A pair of texts that end in zeros, padded to four bytes, with its length before it.
fn key_value(key: &str, value: &str) -> Vec<u8> {
    let text = [key.as_bytes(), b"\0", value.as_bytes(), b"\0"].concat();
    let mut out = (text.len() as u32).to_le_bytes().to_vec();
    out.extend(&text);
    out.resize(out.len().next_multiple_of(4), 0);
    out
}
