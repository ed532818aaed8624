//! Tiny KTX2 files made by hand.

use crate::{Limits, decode_image};

/// A UASTC block of one colour (mode 8 of its specification).
fn solid([r, g, b, a]: [u8; 4]) -> [u8; 16] {
    let color = [r, g, b, a].iter().rev().fold(0u128, |bits, &c| bits << 8 | u128::from(c));
    (0x17 | color << 5).to_le_bytes()
}

/// What a KTX2 file says of itself; the defaults are a UASTC picture of one level.
struct Ktx2 {
    format: u32,
    size: [u32; 3],
    layers_faces_levels: [u32; 3],
    scheme: u32,
    model: u8,
    channel: u8,
    data: Vec<u8>,
    /// Bytes before supercompression.
    whole: Option<u64>,
}

impl Ktx2 {
    fn uastc(width: u32, height: u32, blocks: &[[u8; 16]]) -> Self {
        let data = blocks.as_flattened().to_vec();
        Self {
            format: 0,
            size: [width, height, 0],
            layers_faces_levels: [0, 1, 1],
            scheme: 0,
            model: 166,
            channel: 3,
            data,
            whole: None,
        }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut out = super::MAGIC.to_vec();
        let descriptor = 104u32;
        let sizes = [self.format, 1].into_iter().chain(self.size).chain(self.layers_faces_levels);
        // The last four words are the codebooks' place, which UASTC does not have.
        let words = sizes.chain([self.scheme, descriptor, 44, 0, 0, 0, 0, 0, 0]);
        out.extend(words.flat_map(u32::to_le_bytes));
        let length = self.data.len() as u64;
        out.extend([148, length, self.whole.unwrap_or(length)].into_iter().flat_map(u64::to_le_bytes));
        assert_eq!(out.len(), descriptor as usize);
        // The whole, version and block size, then the model with its primaries and transfer.
        let model = u32::from(self.model) | 1 << 8 | 1 << 16;
        let sample = u32::from(self.channel) << 24 | 127 << 16;
        out.extend(
            [44, 0, 2 | 40 << 16, model, 0x0303, 16, 0, sample, 0, 0, u32::MAX]
                .map(u32::to_le_bytes)
                .as_flattened(),
        );
        out.extend(&self.data);
        out
    }
}

fn read(bytes: &[u8]) -> Result<Vec<[u8; 4]>, String> {
    decode_image("a.ktx2", bytes, &Limits::default()).map(|image| image.pixels).map_err(|e| e.to_string())
}

/// A Zstandard frame (RFC 8878) that holds `data` as it is.
fn zstd(data: &[u8]) -> Vec<u8> {
    let block = 1 | (data.len() as u32) << 3;
    let head = [0x28, 0xb5, 0x2f, 0xfd, 0x20, data.len() as u8];
    [head.as_slice(), &block.to_le_bytes()[..3], data].concat()
}

/// Protects the order of blocks and of rows, and sizes that are no multiple of four.
#[test]
fn uastc_comes_back() {
    let (red, green) = ([250, 10, 20, 255], [3, 200, 7, 90]);
    let file = Ktx2::uastc(6, 3, &[solid(red), solid(green)]).bytes();
    let row = [red, red, red, red, green, green];
    assert_eq!(read(&file).unwrap(), [row, row, row].concat());
}

/// Protects supercompressed pictures.
#[test]
fn zstandard_is_undone() {
    let mut file = Ktx2::uastc(4, 4, &[solid([1, 2, 3, 4])]);
    file.data = zstd(&file.data);
    (file.scheme, file.whole) = (2, Some(16));
    assert_eq!(read(&file.bytes()).unwrap(), [[1, 2, 3, 4]; 16]);
}

/// Protects normal maps of two channels, the second of which stands in alpha.
#[test]
fn red_and_green_are_put_in_their_places() {
    let mut file = Ktx2::uastc(4, 4, &[solid([120, 120, 120, 60])]);
    file.channel = 5;
    assert_eq!(read(&file.bytes()).unwrap(), [[120, 60, 0, 255]; 16]);
}

/// Protects memory and the reader from files that are cut off anywhere.
#[test]
fn cut_files_are_refused() {
    let whole = Ktx2::uastc(4, 8, &[solid([9; 4]); 2]).bytes();
    for length in 12..whole.len() {
        let error = read(&whole[..length]).unwrap_err();
        assert!(error.starts_with("a.ktx2: the ") && error.contains("KTX2"), "{length}: {error}");
    }
}

/// Protects memory from headers that lie, and says what is not a glTF picture.
#[test]
fn lying_headers_are_refused() {
    let file = || Ktx2::uastc(4, 4, &[solid([9; 4])]);
    let refused = |file: Ktx2, reason: &str| {
        let error = read(&file.bytes()).unwrap_err();
        assert!(error.contains(reason), "{error}");
    };
    refused(Ktx2 { size: [16_000, 16_000, 0], ..file() }, "16000 × 16000 texels have 256000000");
    refused(Ktx2 { size: [u32::MAX, 4, 0], ..file() }, "declares 16 bytes");
    refused(Ktx2 { size: [0, 4, 0], ..file() }, "no pixels");
    refused(Ktx2 { size: [4, 4, 4], ..file() }, "two-dimensional");
    refused(Ktx2 { layers_faces_levels: [7, 1, 1], ..file() }, "two-dimensional");
    refused(Ktx2 { layers_faces_levels: [0, 6, 1], ..file() }, "two-dimensional");
    refused(Ktx2 { layers_faces_levels: [0, 1, 0], ..file() }, "0 mip levels");
    refused(Ktx2 { layers_faces_levels: [0, 1, 30], ..file() }, "cut off");
    refused(Ktx2 { format: 37, ..file() }, "vkFormat 37");
    refused(Ktx2 { model: 1, ..file() }, "neither ETC1S nor UASTC");
    refused(Ktx2 { scheme: 3, ..file() }, "supercompression 3");
    refused(Ktx2 { scheme: 1, model: 163, ..file() }, "codebooks");
    refused(Ktx2 { scheme: 2, whole: Some(1 << 40), ..file() }, "declares 1099511627776 bytes");
    refused(Ktx2 { scheme: 2, ..file() }, "damaged");
    // No colour has the block's first bits.
    refused(Ktx2::uastc(4, 4, &[[0x45; 16]]), "damaged");
    let small = Limits { max_image_side: 2, ..Limits::default() };
    let error = decode_image("a.ktx2", &file().bytes(), &small).unwrap_err().to_string();
    assert!(error.contains("longer side: 4, and the limit is 2"), "{error}");
}
