//! How a GLB file is written, and what came of it: the image format of textures, the compression of
//! the mesh, and for each of them bytes and loss.

use serde::Serialize;

/// The image format of textures in a GLB file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureFormat {
    /// Lossless; every viewer reads it.
    #[default]
    Png,
    /// Lossy; every viewer reads it. Textures with alpha, and maps of spherical harmonics, stay PNG.
    Jpeg,
    /// Lossless WebP (`EXT_texture_webp`), often larger than the packed PNG. No lossy encoder of a permissive licence is
    /// in use here.
    Webp,
}

/// How vertices and indices are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshCompression {
    /// Floats, without loss and without extensions.
    #[default]
    None,
    /// `KHR_mesh_quantization`: positions in 16 bits, normals, tangents and colours in 8, texture
    /// coordinates of the unit square in 16.
    Quantized,
    /// Quantised, then encoded losslessly with `EXT_meshopt_compression`.
    Meshopt,
}

/// Quality of JPEG that is hard to tell from the original.
pub const DEFAULT_TEXTURE_QUALITY: u8 = 92;
/// Least quality of JPEG for normal maps and for metal, roughness and occlusion, whose errors light
/// makes visible. Such maps are written as if no lower quality had been asked for.
pub const LEAST_DATA_QUALITY: u8 = 95;

/// How a GLB file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriteOptions {
    /// Image format of textures.
    pub texture_format: TextureFormat,
    /// Quality of JPEG, 1 to 100; values outside are clamped.
    pub texture_quality: u8,
    /// Compression of the mesh.
    pub mesh_compression: MeshCompression,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            texture_format: TextureFormat::Png,
            texture_quality: DEFAULT_TEXTURE_QUALITY,
            mesh_compression: MeshCompression::None,
        }
    }
}

/// What a written GLB file holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Written {
    /// Bytes of the file.
    pub bytes: u64,
    /// Bytes of vertices and indices.
    pub mesh_bytes: u64,
    /// Largest distance of a written position from the model's, in the model's units.
    pub position_error: f64,
    /// The textures, in the order of the file.
    pub textures: Vec<WrittenTexture>,
}

/// A texture of a written file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrittenTexture {
    /// The image's name.
    pub name: String,
    /// Its media type.
    pub mime_type: &'static str,
    /// Its bytes in the file.
    pub bytes: u64,
    /// PSNR in dB of what readers decode, over all channels that it has; none where nothing is lost.
    pub psnr: Option<f64>,
}
