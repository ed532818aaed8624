//! What a model's files hold and the model that was read no longer tells: how many draw calls they ask for,
//! how their pictures are stored, and what was left out.

use crate::ktx2;
use image::ImageFormat;
use serde::Serialize;

/// How a picture is stored, by its first bytes; TGA, which has none of its own, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PictureFormat {
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
    /// WebP, lossy or lossless.
    Webp,
    /// KTX2 with Basis Universal.
    Ktx2,
    /// BMP.
    Bmp,
    /// GIF, of which the first frame is read.
    Gif,
    /// TGA.
    Tga,
}

impl PictureFormat {
    /// What to call it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Webp => "WebP",
            Self::Ktx2 => "KTX2",
            Self::Bmp => "BMP",
            Self::Gif => "GIF",
            Self::Tga => "TGA",
        }
    }

    /// Whether glTF, or an extension of it that is read, has pictures in this format.
    pub(crate) fn is_of_gltf(self) -> bool {
        matches!(self, Self::Png | Self::Jpeg | Self::Webp | Self::Ktx2)
    }

    /// None for bytes that no reader here takes; `name` is the picture's file name, if it has one.
    pub(crate) fn of(name: &str, bytes: &[u8]) -> Option<Self> {
        if ktx2::is_ktx2(bytes) {
            return Some(Self::Ktx2);
        }
        match image::guess_format(bytes) {
            Ok(format) => Self::ALL_BUT_KTX2.into_iter().find(|own| own.decoder() == Some(format)),
            Err(_) => name.to_ascii_lowercase().ends_with(".tga").then_some(Self::Tga),
        }
    }

    const ALL_BUT_KTX2: [Self; 6] = [Self::Png, Self::Jpeg, Self::Webp, Self::Bmp, Self::Gif, Self::Tga];

    /// What reads it; none where that is `ktx2.rs`.
    pub(crate) fn decoder(self) -> Option<ImageFormat> {
        match self {
            Self::Png => Some(ImageFormat::Png),
            Self::Jpeg => Some(ImageFormat::Jpeg),
            Self::Webp => Some(ImageFormat::WebP),
            Self::Ktx2 => None,
            Self::Bmp => Some(ImageFormat::Bmp),
            Self::Gif => Some(ImageFormat::Gif),
            Self::Tga => Some(ImageFormat::Tga),
        }
    }
}

/// A picture as it is stored.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StoredPicture {
    /// Its name in the file, or that of its own file.
    pub name: String,
    /// Its format.
    pub format: PictureFormat,
    /// Width in texels.
    pub width: usize,
    /// Height in texels.
    pub height: usize,
    /// Encoded bytes; those of mip levels included, where they are stored.
    pub bytes: u64,
}

impl StoredPicture {
    /// Bytes that a graphics card takes for it as uncompressed 8-bit RGBA with all mip levels, each half as large
    /// as the one before, rounded down.
    pub fn rgba_bytes(&self) -> u64 {
        let (mut width, mut height) = (self.width.max(1) as u64, self.height.max(1) as u64);
        let mut texels = width * height;
        while width > 1 || height > 1 {
            (width, height) = ((width / 2).max(1), (height / 2).max(1));
            texels += width * height;
        }
        4 * texels
    }
}

/// What the files of a model hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// Draw calls of a viewer that merges nothing: for glTF one for each primitive at each node of the scene,
    /// however many instances the node has; for OBJ one for each material that faces have.
    pub draw_calls: usize,
    /// Triangles that were left out because they have no area.
    pub degenerate_triangles: usize,
    /// The pictures that materials use, each once.
    pub pictures: Vec<StoredPicture>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the memory figure: 8 × 2 texels have levels of 16, 4, 2 and 1 texels.
    #[test]
    fn mip_levels_count() {
        let picture =
            StoredPicture { name: String::new(), format: PictureFormat::Png, width: 8, height: 2, bytes: 1 };
        assert_eq!(picture.rgba_bytes(), 4 * (16 + 4 + 2 + 1));
    }
}
