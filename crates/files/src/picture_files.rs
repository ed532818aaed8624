//! The files of a model's pictures, so that a picture that nobody changed is written as it came.
//!
//! A JPEG encoded anew is larger, as PNG, or loses more, as JPEG; a 16-bit PNG loses its lower 8 bits. 8-bit PNGs are not
//! kept: packed anew they lose nothing and are smaller.
//!
//! Contract: a file is found by a 64-bit fingerprint of its texels in 8 bits, so none is written for a picture that was
//! changed. Of two kept files with the same texels neither is written.

use crate::contents::PictureFormat;
use image::ImageDecoder;
use image::codecs::jpeg::JpegDecoder;
use image::metadata::Orientation;
use parbake_model::Image;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Cursor;

/// JPEGs and 16-bit PNGs by what they show; none where several files show the same. Other formats need extensions that
/// not every viewer has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureFiles(BTreeMap<Key, Option<PictureFile>>);

/// Width, height and a fingerprint of the texels.
type Key = (usize, usize, u64);

/// Where a PNG has the bits of a sample: in its first chunk, behind width and height.
const BIT_DEPTH_AT: usize = 24;

/// An encoded picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PictureFile {
    pub bytes: Vec<u8>,
    pub format: PictureFormat,
}

impl PictureFiles {
    /// Keeps a picture's file if it is a JPEG that every viewer shows alike, or a 16-bit PNG.
    pub(crate) fn keep(&mut self, image: &Image, bytes: &[u8]) {
        let format = match PictureFormat::of(&image.name, bytes) {
            Some(PictureFormat::Jpeg) if is_plain(bytes) => PictureFormat::Jpeg,
            Some(PictureFormat::Png) if bytes.get(BIT_DEPTH_AT) == Some(&16) => PictureFormat::Png,
            _ => return,
        };
        let own = PictureFile { bytes: bytes.to_vec(), format };
        match self.0.entry(key(image)) {
            Entry::Vacant(place) => {
                place.insert(Some(own));
            }
            Entry::Occupied(mut known) if known.get().as_ref() != Some(&own) => {
                known.insert(None);
            }
            Entry::Occupied(_) => {}
        }
    }

    /// The file that shows exactly these texels.
    pub(crate) fn of(&self, image: &Image) -> Option<&PictureFile> {
        if self.0.is_empty() { None } else { self.0.get(&key(image))?.as_ref() }
    }
}

/// Whether every viewer shows a JPEG as the reader does: grey or in three channels (not CMYK), and not rotated by its EXIF
/// orientation, which glTF ignores and browsers apply.
fn is_plain(jpeg: &[u8]) -> bool {
    let orientation = JpegDecoder::new(Cursor::new(jpeg)).and_then(|mut decoder| decoder.orientation());
    matches!(channels(jpeg), Some(1 | 3)) && matches!(orientation, Ok(Orientation::NoTransforms))
}

/// The number of channels in a JPEG's frame header (ITU-T T.81, annex B.2.2).
fn channels(jpeg: &[u8]) -> Option<u8> {
    let mut rest = jpeg.get(2..)?;
    loop {
        // Markers may have fill bytes in front.
        rest = &rest[rest.iter().position(|&byte| byte != 0xff)?..];
        let (&code, segment) = rest.split_first()?;
        if matches!(code, 0xc0..=0xcf) && !matches!(code, 0xc4 | 0xc8 | 0xcc) {
            return segment.get(7).copied();
        }
        let length = usize::from(u16::from_be_bytes(*segment.first_chunk()?));
        rest = segment.get(length..)?;
    }
}

fn key(image: &Image) -> Key {
    let mut hasher = DefaultHasher::new();
    image.pixels.as_flattened().hash(&mut hasher);
    (image.width, image.height, hasher.finish())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{
        TextureFormat, WriteOptions, decode_image, encode_png, read_model_with_pictures, write_glb_keeping,
    };
    use parbake_model::glam::{Vec2, Vec3};
    use parbake_model::{Material, Mesh, Model, TextureSlot};

    fn picture(name: &str) -> Image {
        let pixels = (0..64).map(|i: u8| [4 * i, 255 - i, i.wrapping_mul(37), 255]).collect();
        Image { name: name.into(), width: 8, height: 8, pixels }
    }

    /// A triangle with a JPEG, a PNG of 16 bits and one of 8.
    fn model() -> (Model, Vec<Vec<u8>>, PictureFiles) {
        let mut jpeg = Vec::new();
        let samples: Vec<u8> = picture("").pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut jpeg, 50);
        image::ImageEncoder::write_image(encoder, &samples, 8, 8, image::ExtendedColorType::Rgb8).unwrap();
        let samples: Vec<u16> = (0..192).map(|i| 341 * i).collect();
        let png = crate::encode_png16("fine", [8, 8], 3, &samples).unwrap();
        let simple = encode_png(&picture("simple")).unwrap();
        let read = |name: &str, bytes: &[u8]| decode_image(name, bytes, &crate::Limits::default()).unwrap();
        let images = vec![read("jpeg", &jpeg), read("fine", &png), read("simple", &simple)];
        let mut files = PictureFiles::default();
        images.iter().zip([&jpeg, &png, &simple]).for_each(|(image, bytes)| files.keep(image, bytes));
        let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
        let material = Material {
            base_color_texture: slot(0),
            normal_texture: slot(1),
            emissive_texture: slot(2),
            ..Material::default()
        };
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        };
        (
            Model { mesh, materials: vec![material], images, ..Model::default() },
            vec![jpeg, png, simple],
            files,
        )
    }

    fn contains(file: &[u8], part: &[u8]) -> bool {
        file.windows(part.len()).any(|window| window == part)
    }

    /// Protects bytes and the last bits: pictures that nobody changed are written as the files they were, through reading
    /// and writing; a PNG of 8 bits is packed anew, and so is what was changed.
    #[test]
    fn unchanged_pictures_stay_the_files_they_were() {
        let (model, originals, files) = model();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.glb");
        let options = WriteOptions::default();
        let written = write_glb_keeping(&path, &model, &options, &files).unwrap();
        let formats: Vec<_> = written.textures.iter().map(|texture| texture.format).collect();
        assert_eq!(formats, [TextureFormat::Jpeg, TextureFormat::Png, TextureFormat::Png]);
        assert!(written.textures.iter().all(|texture| texture.psnr.is_none()));

        let mut loaded = read_model_with_pictures(&path, &crate::Limits::default()).unwrap();
        assert_eq!(loaded.model.images, model.images);
        loaded.model.images[1].pixels[5][0] ^= 1;
        let other = folder.path().join("b.glb");
        write_glb_keeping(&other, &loaded.model, &options, &loaded.pictures).unwrap();
        let [first, second] = [&path, &other].map(|path| std::fs::read(path).unwrap());
        let kept =
            |file: &[u8]| originals.iter().map(|original| contains(file, original)).collect::<Vec<_>>();
        assert_eq!(kept(&first), [true, true, false]);
        assert_eq!(kept(&second), [true, false, false]);
    }

    /// Protects what people see: a JPEG with an EXIF orientation, or in CMYK, is not kept, and of two files
    /// with the same texels in 8 bits neither stands in for the other.
    #[test]
    fn only_files_that_all_show_alike_are_kept() {
        let (model, originals, _) = model();
        let kept = |image: usize, bytes: &[&[u8]]| {
            let mut files = PictureFiles::default();
            bytes.iter().for_each(|bytes| files.keep(&model.images[image], bytes));
            files.of(&model.images[image]).is_some()
        };
        assert!(kept(0, &[&originals[0]]) && kept(0, &[&originals[0], &originals[0]]));
        // Behind the first marker: Exif, big-endian, one entry: orientation 6, a quarter turn.
        let exif =
            b"\xff\xe1\x00\x22Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
        let turned = [&originals[0][..2], exif, &originals[0][2..]].concat();
        assert!(!kept(0, &[&turned]));
        let mut four = originals[0].clone();
        let frame = four.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
        assert_eq!(channels(&four), Some(3));
        four[frame + 9] = 4;
        assert_eq!(channels(&four), Some(4));
        assert!(!kept(0, &[&four]) && !kept(0, &[&originals[0][..20]]));
        let other: Vec<u16> = (0..192).map(|i| 341 * i + 1).collect();
        let other = crate::encode_png16("fine", [8, 8], 3, &other).unwrap();
        assert!(kept(1, &[&originals[1]]) && !kept(1, &[&originals[1], &other]));
    }

    /// Protects a format that was asked for.
    #[test]
    fn a_format_that_was_asked_for_is_written() {
        let (model, originals, files) = model();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.glb");
        let options = WriteOptions { texture_format: TextureFormat::WebpLossless, ..WriteOptions::default() };
        write_glb_keeping(&path, &model, &options, &files).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert!(originals.iter().all(|original| !contains(&bytes, original)));
    }
}
