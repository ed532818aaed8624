//! How a GLB file is written, and what came of it: the image format of textures, the compression of
//! the mesh, and for each of them bytes and loss.
//!
//! Names and ranges here are those of the command line, of options files and of JSON outputs.

use serde::{Deserialize, Serialize};

/// The image format of textures in a GLB file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum TextureFormat {
    /// Lossless; every viewer reads it
    #[default]
    Png,
    /// Lossy; every viewer reads it. Textures with alpha stay PNG
    Jpeg,
    /// Lossy colours at two thirds of JPEG's size; alpha, normal maps and data maps are lossless; viewers need
    /// EXT_texture_webp
    Webp,
    /// Lossless, a seventh smaller than PNG; viewers need EXT_texture_webp
    WebpLossless,
    /// Stays compressed on the GPU, with mip levels: UASTC under Zstandard, high quality, about 1.2 bytes
    /// a texel; viewers need KHR_texture_basisu
    Ktx2,
    /// As ktx2, but colours in ETC1S: small files, visible loss; normal maps and data maps stay UASTC
    Ktx2Etc1s,
}

impl TextureFormat {
    /// Whether texels are kept as they are, whatever quality is asked for.
    pub fn is_lossless(self) -> bool {
        matches!(self, Self::Png | Self::WebpLossless)
    }

    /// Its media type.
    pub fn media_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Jpeg => "image/jpeg",
            Self::Webp | Self::WebpLossless => "image/webp",
            Self::Ktx2 | Self::Ktx2Etc1s => "image/ktx2",
        }
    }

    /// What to call it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Webp => "WebP",
            Self::WebpLossless => "lossless WebP",
            Self::Ktx2 => "KTX2 (UASTC)",
            Self::Ktx2Etc1s => "KTX2 (ETC1S)",
        }
    }
}

/// How vertices and indices are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum MeshCompression {
    /// Floats, without loss and without extensions
    #[default]
    None,
    /// 16-bit positions, 8-bit normals: KHR_mesh_quantization
    Quantized,
    /// Quantised, then encoded without loss: EXT_meshopt_compression
    Meshopt,
}

impl MeshCompression {
    /// What to call it.
    pub fn label(self) -> &'static str {
        match self {
            Self::None => "floats",
            Self::Quantized => "quantized",
            Self::Meshopt => "quantized, meshopt",
        }
    }
}

/// Quality of lossy formats that is hard to tell from the original.
pub const DEFAULT_TEXTURE_QUALITY: u8 = 92;
/// Least quality of JPEG for normal maps and for metal, roughness and occlusion, whose errors light
/// makes visible. Such maps are written as if no lower quality had been asked for.
pub const LEAST_DATA_QUALITY: u8 = 95;

/// How a GLB file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct WriteOptions {
    /// Image format of the textures in a GLB file. Parallax maps stay lossless; textures for viewers without parallax maps
    /// are JPEG also where others are lossless
    #[cfg_attr(feature = "clap", arg(long, value_enum, value_name = "FORMAT", default_value_t = TextureFormat::Png, help_heading = HEADING))]
    pub texture_format: TextureFormat,

    /// Quality of JPEG, WebP and ETC1S, 1 to 100; in JPEG, normal maps and data maps have at least 95, except those for
    /// viewers without parallax maps. UASTC files have about the same size at any quality; from 96 on it is encoded with more care
    #[cfg_attr(feature = "clap", arg(long, value_name = "QUALITY", default_value_t = DEFAULT_TEXTURE_QUALITY, value_parser = clap::value_parser!(u8).range(1..=100), help_heading = HEADING))]
    pub texture_quality: u8,

    /// Compression of the mesh in a GLB file
    #[cfg_attr(feature = "clap", arg(long, value_enum, value_name = "COMPRESSION", default_value_t = MeshCompression::None, help_heading = HEADING))]
    pub mesh_compression: MeshCompression,

    /// Write PNG fast instead of small: up to twice the bytes (9.9 instead of 5.7 MB for three maps of 2048²), about 50 times as
    /// fast. Default: false
    #[cfg_attr(feature = "clap", arg(skip))]
    #[serde(skip)]
    pub is_urgent: bool,
}

/// Heading in `--help`.
#[cfg(feature = "clap")]
const HEADING: &str = "Formats";

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            texture_format: TextureFormat::Png,
            texture_quality: DEFAULT_TEXTURE_QUALITY,
            mesh_compression: MeshCompression::None,
            is_urgent: false,
        }
    }
}

/// What a written GLB file holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Written {
    /// Bytes of the file.
    pub bytes: u64,
    /// The mesh.
    pub mesh: WrittenMesh,
    /// The textures, in the order of the file.
    pub textures: Vec<WrittenTexture>,
}

/// The mesh of a written file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrittenMesh {
    /// How it is stored.
    pub compression: MeshCompression,
    /// Bytes of vertices and indices.
    pub bytes: u64,
    /// Largest distance of a written position from the model's, in the model's units.
    pub position_error: f64,
}

/// A texture of a written file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrittenTexture {
    /// The image's name.
    pub name: String,
    /// The format that it was written in.
    pub format: TextureFormat,
    /// Its bytes in the file, mip levels included.
    pub bytes: u64,
    /// PSNR in dB of what readers decode, over all channels that it has; none where nothing is lost.
    pub psnr: Option<f64>,
    /// Why it is not in the format that was asked for; none where it is.
    pub reason: Option<String>,
}
