//! KTX2 pictures as glTF has them (KHR_texture_basisu): one two-dimensional picture in ETC1S with
//! BasisLZ, or in UASTC, as it is or under Zstandard. Only the largest mip level is decoded.
//!
//! The container is the KTX 2.0 specification's (section 3); texels are decoded by the crate
//! `basisu`, a port of the Basis Universal transcoder.
//!
//! Contract: what the header declares is checked here before the decoder sees it: it reserves
//! memory for the sizes that it is told, and trusts some offsets.

use crate::guard::guarded;
use crate::image_trouble::ImageTrouble;
use basisu::{DecodeFlags, TargetFormat, Transcoder};

/// The first bytes of a KTX2 file.
pub(crate) const MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Bytes of the header and the index, before the levels' own entries.
pub(crate) const HEADER: usize = 80;

/// Bytes of a level's entry.
pub(crate) const LEVEL: usize = 24;

/// Bytes of a block of 4 × 4 texels in UASTC.
pub(crate) const BLOCK: u64 = 16;

/// Khronos Data Format models (KDF 1.3, table 4).
pub(crate) const ETC1S: u32 = 163;
pub(crate) const UASTC: u32 = 166;

/// What a texel's channels stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channels {
    /// Red, green, blue and alpha, or as many of these as there are.
    Color,
    /// Red, and green where alpha stands: KHR_texture_basisu's two-channel pictures.
    RedGreen,
}

/// A header that has been checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Header {
    /// Texels in a row.
    pub width: u32,
    /// Rows of texels.
    pub height: u32,
    channels: Channels,
}

/// Whether these are the first bytes of a KTX2 file.
pub(crate) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

fn bad<T>(reason: impl Into<String>) -> Result<T, ImageTrouble> {
    Err(ImageTrouble::Damaged(reason.into()))
}

fn word(bytes: &[u8], at: u64) -> Result<u32, ImageTrouble> {
    let rest = usize::try_from(at).ok().and_then(|at| bytes.get(at..));
    match rest.and_then(|rest| rest.first_chunk()) {
        Some(four) => Ok(u32::from_le_bytes(*four)),
        None => bad("the KTX2 picture is cut off"),
    }
}

fn long(bytes: &[u8], at: usize) -> Result<u64, ImageTrouble> {
    let (low, high) = (word(bytes, at as u64)?, word(bytes, at as u64 + 4)?);
    Ok(u64::from(high) << 32 | u64::from(low))
}

/// Holds the header against the format; costs next to nothing.
pub(crate) fn header(bytes: &[u8]) -> Result<Header, ImageTrouble> {
    let field = |number: u64| word(bytes, MAGIC.len() as u64 + 4 * number);
    let (format, width, height, depth) = (field(0)?, field(2)?, field(3)?, field(4)?);
    let (layers, faces, levels, scheme) = (field(5)?, field(6)?, field(7)?, field(8)?);
    if depth > 0 || height == 0 || layers > 1 || faces != 1 {
        return bad("the KTX2 file is no single two-dimensional picture");
    }
    if width == 0 {
        return bad("the picture has no pixels");
    }
    let (descriptor, descriptor_bytes) = (u64::from(field(9)?), field(10)?);
    let model = word(bytes, descriptor + 12)? & 0xff;
    if format != 0 || !matches!(model, ETC1S | UASTC) {
        return bad(format!(
            "the KTX2 picture (vkFormat {format}, color model {model}) is neither ETC1S nor UASTC, as glTF asks"
        ));
    }
    match (model, scheme) {
        (ETC1S, 1) | (UASTC, 0 | 2) => {}
        _ => {
            return bad(format!(
                "the KTX2 picture has supercompression {scheme}, which its texels cannot have"
            ));
        }
    }
    if !(1..=32).contains(&levels) {
        return bad(format!("the KTX2 picture declares {levels} mip levels"));
    }
    if bytes.len() < HEADER + LEVEL * levels as usize {
        return bad("the KTX2 picture is cut off");
    }
    level(bytes, width, height, model, scheme)?;
    if model == ETC1S {
        global_data(bytes, levels)?;
    }
    // The type of the last sample: of the second slice where ETC1S has two, else of UASTC's only one.
    let two = model == ETC1S && descriptor_bytes == 60;
    let channel = word(bytes, descriptor + if two { 44 } else { 28 })? >> 24 & 15;
    let channels = match (model, two, channel) {
        (ETC1S, true, 4) | (UASTC, _, 5) => Channels::RedGreen,
        _ => Channels::Color,
    };
    Ok(Header { width, height, channels })
}

/// The largest level: all of it must be there, and be as large as its texels ask.
fn level(bytes: &[u8], width: u32, height: u32, model: u32, scheme: u32) -> Result<(), ImageTrouble> {
    let (offset, length, whole) = (long(bytes, HEADER)?, long(bytes, HEADER + 8)?, long(bytes, HEADER + 16)?);
    if offset.checked_add(length).is_none_or(|end| end > bytes.len() as u64) {
        return bad("the KTX2 picture is cut off");
    }
    if model == UASTC {
        let texels = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4)) * BLOCK;
        let found = if scheme == 2 { whole } else { length };
        if found != texels {
            return bad(format!(
                "the KTX2 picture declares {found} bytes where {width} × {height} texels have {texels}"
            ));
        }
    }
    Ok(())
}

/// BasisLZ's codebooks and tables: the sum of their parts must lie in the file. The decoder adds
/// these lengths without a check.
fn global_data(bytes: &[u8], levels: u32) -> Result<(), ImageTrouble> {
    let start = long(bytes, 64)?;
    let inside = usize::try_from(start).is_ok_and(|start| start < bytes.len());
    if !inside {
        return bad("the KTX2 picture's codebooks lie beyond its end");
    }
    let lengths = [word(bytes, start + 4)?, word(bytes, start + 8)?, word(bytes, start + 12)?];
    let parts = lengths.iter().map(|&n| u64::from(n)).sum::<u64>() + 20 + 20 * u64::from(levels);
    if start + parts > bytes.len() as u64 {
        return bad("the KTX2 picture's codebooks reach beyond its end");
    }
    Ok(())
}

/// The largest level's texels. `header` is what [`header`] said of the same bytes.
pub(crate) fn decode(bytes: &[u8], header: Header) -> Result<Vec<[u8; 4]>, ImageTrouble> {
    // The decoder promises errors, but it is young, and its tables are indexed by what it reads.
    let decoded = guarded(|| {
        let transcoder = Transcoder::new(bytes)?;
        if transcoder.base_dimensions() != (header.width, header.height) {
            return Err(basisu::Error::InvalidData);
        }
        transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE)
    });
    let texels = match decoded {
        Some(Ok(texels)) => texels,
        Some(Err(basisu::Error::VideoRequiresState)) => return bad("the KTX2 file is a video"),
        Some(Err(_)) | None => {
            return bad("the picture cannot be decoded: its Basis Universal data is damaged");
        }
    };
    let (texels, rest) = texels.as_chunks::<4>();
    if !rest.is_empty() || texels.len() as u64 != u64::from(header.width) * u64::from(header.height) {
        return bad("the picture cannot be decoded: its texels are not all there");
    }
    let channels = |&[r, g, b, a]: &[u8; 4]| match header.channels {
        Channels::Color => [r, g, b, a],
        Channels::RedGreen => [r, a, 0, 255],
    };
    Ok(texels.iter().map(channels).collect())
}

#[cfg(test)]
#[path = "ktx2_tests.rs"]
mod tests;
